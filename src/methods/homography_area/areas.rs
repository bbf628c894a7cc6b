//! Σ (det J - det J⁻¹)² over points of the light plane.

use crate::math::det3;
use crate::metric::EdgeSamples;
use glam::DVec3;

/// Points that areas are compared at.
pub(super) struct Areas {
    /// Normalised light-plane vectors with q3 = 1.
    pub(super) q: Vec<DVec3>,
    /// |V|: area of the light plane per pixel.
    pub(super) volume: Vec<f64>,
    /// Weights; they sum to 1.
    pub(super) weight: Vec<f64>,
}

impl Areas {
    /// The edge samples, weighted by length; `None` without any.
    pub(super) fn of_samples(samples: &EdgeSamples) -> Option<Areas> {
        let volume = (0..samples.len()).map(|i| (1.0 / samples.inverse_volume[i]).abs()).collect();
        Areas::weighted(samples.q.clone(), volume, samples.length_px.clone())
    }

    /// Points with weights that need not sum to 1.
    pub(super) fn weighted(q: Vec<DVec3>, volume: Vec<f64>, mut weight: Vec<f64>) -> Option<Areas> {
        let sum: f64 = weight.iter().sum();
        weight.iter_mut().for_each(|k| *k /= sum);
        (sum > 0.0 && sum.is_finite()).then_some(Areas { q, volume, weight })
    }

    /// The mean of (det J - 1/det J)² for rows p1, p2 (in texels) and p4; infinite where a point has w ≤ 0.
    pub(super) fn cost(&self, rows: &[DVec3; 3]) -> f64 {
        let det = det3(rows[0], rows[1], rows[2]).abs();
        let term = |((q, volume), weight): ((&DVec3, &f64), &f64)| {
            let w = rows[2].dot(*q);
            let area = det * volume / (w * w * w);
            if w > 0.0 { weight * (area - 1.0 / area).powi(2) } else { f64::INFINITY }
        };
        self.q.iter().zip(&self.volume).zip(&self.weight).map(term).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A map that gives each point one texel a pixel costs nothing; twice the texels (2 - 1/2)².
    #[test]
    fn equal_areas_cost_nothing() {
        let q = vec![DVec3::new(0.1, 0.2, 1.0), DVec3::new(-0.5, 0.3, 1.0)];
        let areas = Areas::weighted(q, vec![0.01, 0.01], vec![1.0, 3.0]).unwrap();
        let rows = |s: f64| [DVec3::X * s, DVec3::Y * 10.0, DVec3::Z];
        assert!(areas.cost(&rows(10.0)) < 1e-24);
        assert!((areas.cost(&rows(20.0)) - 2.25).abs() < 1e-12);
    }
}
