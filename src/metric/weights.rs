//! What is minimised, and the quadratic that stands in for it in one round of reweighting (math note §5).

use super::{EdgeSamples, Moments, expected_displacement};
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
    (0..samples.len())
        .map(|i| {
            samples.length_px[i]
                * match metric {
                    Metric::L2 => super::inverse_jacobian_norm2(samples, i, rows),
                    Metric::Displacement => expected_displacement(samples, i, rows),
                    Metric::Saturating => saturated(expected_displacement(samples, i, rows), samples.room_px[i]),
                }
        })
        .sum()
}

/// A displacement that costs no more than the room beside the edge: d / (1 + d/room).
fn saturated(displacement_px: f64, room_px: f64) -> f64 {
    if displacement_px.is_finite() { displacement_px / (1.0 + displacement_px / room_px) } else { room_px }
}

/// Moments of a metric around given rows (p1, p2 in texels): with `rows`, weights of one reweighting round; without, the
/// base weights.
pub fn moments_of(samples: &EdgeSamples, metric: Metric, rows: Option<&[DVec3; 3]>) -> Moments {
    let mut moments = Moments::default();
    for i in 0..samples.len() {
        let (q, volume) = (samples.q[i], samples.volume(i));
        match metric {
            Metric::L2 => {
                for c in samples.footprint_vectors(i) {
                    moments.add(q, volume, c, samples.length_px[i]);
                }
            }
            Metric::Displacement | Metric::Saturating => {
                let weight = rows.map_or(1.0, |rows| weight(samples, i, metric, rows));
                moments.add(q, volume, samples.edge_vector(i), samples.length_px[i] * weight);
            }
        }
    }
    moments
}

/// Smallest displacement, pixels, that a weight distinguishes: nothing is gained below a hundredth of a pixel.
const DISPLACEMENT_MIN_PX: f64 = 0.01;

/// k_s / k0_s of math note §5: the quadratic that touches the metric's cost at the present displacement.
fn weight(samples: &EdgeSamples, i: usize, metric: Metric, rows: &[DVec3; 3]) -> f64 {
    let d = expected_displacement(samples, i, rows).max(DISPLACEMENT_MIN_PX);
    match metric {
        Metric::L2 => 1.0,
        Metric::Displacement => 1.0 / d,
        Metric::Saturating => {
            let s = 1.0 + d / samples.room_px[i];
            1.0 / (d * s * s)
        }
    }
}
