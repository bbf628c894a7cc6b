//! What is minimised, and the quadratic that stands in for it in one round of reweighting (math note §5).

use super::minimax::largest;
use super::pass::pass;
use super::{EdgeSamples, Moments, TexelRows, inverse_jacobian_norm2};
use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What a fit minimises over the edge samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Metric {
    /// Sum of ‖J⁻¹‖² (SOSM eq. 6).
    L2,
    /// Sum of the expected edge displacement.
    Displacement,
    /// Sum of the expected edge displacement, saturating where it grows wider than the room beside the edge.
    #[default]
    Saturating,
    /// The largest expected edge displacement.
    Minimax,
}

/// What a wrong pixel counts whose exact answer is uncertain, where one with a certain answer counts 1: a bound on wrong
/// pixels lets certain and uncertain ones together pass it by this part.
pub const UNCERTAIN_WEIGHT: f64 = 0.15;

/// Length of a sample as it counts in the metrics of wrong pixels. (SOSM's sum takes every sample alike.)
pub(super) fn counted_px(samples: &EdgeSamples, i: usize) -> f64 {
    samples.length_px[i] * if samples.uncertain[i] { UNCERTAIN_WEIGHT } else { 1.0 }
}

/// Cost of rows p1, p2 (in texels) and p4 by a metric, pixels (L2: pixels² per texel²).
pub fn cost(samples: &EdgeSamples, metric: Metric, rows: &[DVec3; 3]) -> f64 {
    if metric == Metric::L2 {
        let rows = TexelRows::new(rows);
        return (0..samples.len()).map(|i| samples.length_px[i] * inverse_jacobian_norm2(samples, i, &rows)).sum();
    }
    if metric == Metric::Minimax {
        return largest(samples, rows);
    }
    let [certain, uncertain] = wrong_pixels(samples, metric == Metric::Saturating, rows);
    certain + UNCERTAIN_WEIGHT * uncertain
}

/// Expected wrong pixels of rows p1, p2 (in texels) and p4, of certain and of uncertain answers apart: expected
/// displacement, saturating or not, times length.
pub fn wrong_pixels(samples: &EdgeSamples, saturating: bool, rows: &[DVec3; 3]) -> [f64; 2] {
    let rows = TexelRows::new(rows);
    let mut sums = [0.0; 2];
    for i in 0..samples.len() {
        let d = rows.displacement(samples, i).expected();
        let wide = if saturating { saturated(d, samples.room_px[i]) } else { d };
        sums[usize::from(samples.uncertain[i])] += samples.length_px[i] * wide;
    }
    sums
}

/// A displacement that costs no more than the room beside the edge: d / (1 + d/room).
fn saturated(displacement_px: f64, room_px: f64) -> f64 {
    if displacement_px.is_finite() { displacement_px / (1.0 + displacement_px / room_px) } else { room_px }
}

/// Moments of a metric with its base weights. (Compiled twice, for the reason that `pass` gives.)
pub fn moments_of(samples: &EdgeSamples, metric: Metric) -> Moments {
    #[cfg(target_arch = "x86_64")]
    if is_x86_feature_detected!("avx2") {
        #[expect(unsafe_code, reason = "AVX2 was just detected, which is all that the callee asks for")]
        return unsafe { moments_avx2(samples, metric) };
    }
    moments_here(samples, metric)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn moments_avx2(samples: &EdgeSamples, metric: Metric) -> Moments {
    moments_here(samples, metric)
}

#[inline(always)]
fn moments_here(samples: &EdgeSamples, metric: Metric) -> Moments {
    let mut moments = Moments::default();
    for i in 0..samples.len() {
        let (q, k) = (samples.q[i], samples.inverse_volume[i] * samples.inverse_volume[i]);
        match metric {
            Metric::L2 => {
                let [first, second] = samples.footprint_vectors(i);
                moments.add_scaled(q, first, k * samples.length_px[i]);
                moments.add_scaled(q, second, k * samples.length_px[i]);
            }
            Metric::Displacement | Metric::Saturating | Metric::Minimax => {
                moments.add_scaled(q, samples.edge_vector[i], k * counted_px(samples, i));
            }
        }
    }
    moments
}

/// [`cost`] of rows, and in the same pass the moments of the quadratic that touches it there: one round of reweighting. (The
/// largest displacement has none; it gets that of the sum of displacements, and [`super::Lawson`] to be minimised by.)
pub fn cost_and_moments(samples: &EdgeSamples, metric: Metric, rows: &[DVec3; 3]) -> (f64, Moments) {
    if metric == Metric::L2 {
        return (cost(samples, metric, rows), moments_of(samples, metric));
    }
    if metric == Metric::Minimax {
        let (_, moments) = cost_and_moments(samples, Metric::Displacement, rows);
        return (cost(samples, metric, rows), moments);
    }
    pass(samples, metric == Metric::Saturating, &TexelRows::new(rows))
}

#[cfg(test)]
mod tests {
    use super::super::FilmEdge;
    use super::*;
    use glam::DVec2;

    #[test]
    fn one_pass_gives_the_cost_and_weighted_moments() {
        let mut samples = EdgeSamples::default();
        for i in 0..30 {
            let f = f64::from(i);
            let q = DVec3::new((f * 1.3).sin(), (f * 0.7).cos(), 1.0);
            let t = [DVec3::new(0.01, 0.003, 0.0), DVec3::new(-0.002, 0.02 + 0.004 * f.cos(), 0.0)];
            let volume = crate::math::det3(q, t[0], t[1]);
            let edge =
                FilmEdge { normal: DVec2::from_angle(f), length_px: 1.0 + f, room_px: 3.0 + f, uncertain: i % 7 == 0 };
            samples.push(q, t, volume, &edge);
        }
        let rows = [DVec3::new(40.0, 2.0, 5.0), DVec3::new(-3.0, 30.0, 9.0), DVec3::new(0.2, -0.3, 1.0)];
        for metric in [Metric::Displacement, Metric::Saturating] {
            let (value, moments) = cost_and_moments(&samples, metric, &rows);
            let [certain, uncertain] = wrong_pixels(&samples, metric == Metric::Saturating, &rows);
            assert!(certain > 0.0 && uncertain > 0.0);
            assert!((value / (certain + 0.15 * uncertain) - 1.0).abs() < 1e-12);
            assert!((value / cost(&samples, metric, &rows) - 1.0).abs() < 1e-12);
            assert!(moments.is_finite() && moments.value(&rows) > 0.0);
            assert!(moments != moments_of(&samples, metric));
        }
        assert_eq!(cost_and_moments(&samples, Metric::L2, &rows).1, moments_of(&samples, Metric::L2));
    }
}
