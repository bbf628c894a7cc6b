//! What is minimised, and the quadratic that stands in for it in one round of reweighting (math note §5).

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
}

/// Cost of rows p1, p2 (in texels) and p4 by a metric, pixels (L2: pixels² per texel²).
pub fn cost(samples: &EdgeSamples, metric: Metric, rows: &[DVec3; 3]) -> f64 {
    let rows = TexelRows::new(rows);
    (0..samples.len())
        .map(|i| {
            samples.length_px[i]
                * match metric {
                    Metric::L2 => inverse_jacobian_norm2(samples, i, &rows),
                    Metric::Displacement => rows.displacement(samples, i).expected(),
                    Metric::Saturating => saturated(rows.displacement(samples, i).expected(), samples.room_px[i]),
                }
        })
        .sum()
}

/// A displacement that costs no more than the room beside the edge: d / (1 + d/room).
fn saturated(displacement_px: f64, room_px: f64) -> f64 {
    if displacement_px.is_finite() { displacement_px / (1.0 + displacement_px / room_px) } else { room_px }
}

/// Moments of a metric with its base weights.
pub fn moments_of(samples: &EdgeSamples, metric: Metric) -> Moments {
    let mut moments = Moments::default();
    for i in 0..samples.len() {
        let (q, k) = (samples.q[i], samples.length_px[i] * samples.inverse_volume[i] * samples.inverse_volume[i]);
        match metric {
            Metric::L2 => {
                for c in samples.footprint_vectors(i) {
                    moments.add_scaled(q, c, k);
                }
            }
            Metric::Displacement | Metric::Saturating => moments.add_scaled(q, samples.edge_vector[i], k),
        }
    }
    moments
}

/// [`cost`] of rows, and in the same pass the moments of the quadratic that touches it there: one round of reweighting.
pub fn cost_and_moments(samples: &EdgeSamples, metric: Metric, rows: &[DVec3; 3]) -> (f64, Moments) {
    if metric == Metric::L2 {
        return (cost(samples, metric, rows), moments_of(samples, metric));
    }
    let rows = TexelRows::new(rows);
    let (mut sum, mut moments) = (0.0, Moments::default());
    for i in 0..samples.len() {
        let (room, length) = (samples.room_px[i], samples.length_px[i]);
        let d = rows.displacement(samples, i).expected();
        let at_least = if d > DISPLACEMENT_MIN_PX { d } else { DISPLACEMENT_MIN_PX };
        let (cost, weight) = match metric {
            // With s = 1 + d/room: cost d/s and weight 1/(d s²), by a single division.
            Metric::Saturating if d.is_finite() => {
                let inverse = 1.0 / (at_least * (room + at_least));
                let cost = if d == at_least { d * d * room * inverse } else { saturated(d, room) };
                (cost, at_least * (room * inverse) * (room * inverse))
            }
            Metric::Saturating => (room, 0.0),
            Metric::Displacement | Metric::L2 => (d, 1.0 / at_least),
        };
        sum += length * cost;
        let k = length * weight * samples.inverse_volume[i] * samples.inverse_volume[i];
        moments.add_scaled(samples.q[i], samples.edge_vector[i], k);
    }
    (sum, moments)
}

/// Smallest displacement, pixels, that a weight k_s / k0_s of math note §5 distinguishes: nothing is gained below a
/// hundredth of a pixel.
const DISPLACEMENT_MIN_PX: f64 = 0.01;

#[cfg(test)]
mod tests {
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
            samples.push(q, t, volume, DVec2::from_angle(f), [1.0 + f, 3.0 + f]);
        }
        let rows = [DVec3::new(40.0, 2.0, 5.0), DVec3::new(-3.0, 30.0, 9.0), DVec3::new(0.2, -0.3, 1.0)];
        for metric in [Metric::Displacement, Metric::Saturating] {
            let (value, moments) = cost_and_moments(&samples, metric, &rows);
            assert!((value / cost(&samples, metric, &rows) - 1.0).abs() < 1e-12);
            assert!(moments.is_finite() && moments.value(&rows) > 0.0);
            assert!(moments != moments_of(&samples, metric));
        }
        assert_eq!(cost_and_moments(&samples, Metric::L2, &rows).1, moments_of(&samples, Metric::L2));
    }
}
