//! The largest displacement, made small by reweighting (Lawson 1961): the weights of a sum of squares are multiplied by the
//! displacements that its minimum leaves, round after round, until those that are still wide carry all of it.
//!
//! Uncertain samples have no say: a single one nearly edge-on to the light would decide alone.

use super::{EdgeSamples, Moments, TexelRows};
use glam::DVec3;

/// Weights of one search for the smallest largest displacement.
#[derive(Clone, Debug)]
pub struct Lawson {
    /// One for each sample, of largest 1.
    weights: Vec<f64>,
}

impl Lawson {
    /// Before the first round.
    pub fn new(samples: &EdgeSamples) -> Lawson {
        Lawson { weights: samples.uncertain.iter().map(|uncertain| if *uncertain { 0.0 } else { 1.0 }).collect() }
    }

    /// Moments of the weighted sum of squared displacements.
    pub fn moments(&self, samples: &EdgeSamples) -> Moments {
        let mut moments = Moments::default();
        for (i, weight) in self.weights.iter().enumerate() {
            let k = weight * samples.inverse_volume[i] * samples.inverse_volume[i];
            moments.add_scaled(samples.q[i], samples.edge_vector[i], k);
        }
        moments
    }

    /// Reweights by what rows p1, p2 (in texels) and p4 leave.
    pub fn heed(&mut self, samples: &EdgeSamples, rows: &[DVec3; 3]) {
        let rows = TexelRows::new(rows);
        let mut largest = 0.0_f64;
        for (i, weight) in self.weights.iter_mut().enumerate() {
            *weight *= rows.displacement(samples, i).expected().min(f64::MAX);
            largest = largest.max(*weight);
        }
        if largest > 0.0 {
            self.weights.iter_mut().for_each(|weight| *weight /= largest);
        }
    }
}

/// The largest expected displacement of a certain sample, pixels.
pub(super) fn largest(samples: &EdgeSamples, rows: &[DVec3; 3]) -> f64 {
    let rows = TexelRows::new(rows);
    let certain = (0..samples.len()).filter(|i| !samples.uncertain[*i]);
    certain.map(|i| rows.displacement(samples, i).expected()).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::super::FilmEdge;
    use super::*;
    use glam::DVec2;

    #[test]
    fn weights_gather_where_displacements_stay_wide() {
        let mut samples = EdgeSamples::default();
        for scale in [1.0, 3.0, 9.0] {
            let (q, t) = (DVec3::new(0.1 * scale, 0.2, 1.0), [DVec3::X / scale, DVec3::Y / scale]);
            let edge = FilmEdge { normal: DVec2::X, length_px: 1.0, room_px: 1.0, uncertain: scale == 9.0 };
            samples.push(q, t, crate::math::det3(q, t[0], t[1]), &edge);
        }
        let rows = [DVec3::X, DVec3::Y, DVec3::Z];
        // A texel of a unit stands for `scale` pixels, a quarter of which is the mean displacement.
        assert!((largest(&samples, &rows) - 0.75).abs() < 1e-12, "the uncertain one has no say");
        let mut lawson = Lawson::new(&samples);
        for round in 1..5 {
            lawson.heed(&samples, &rows);
            assert!((lawson.weights[0] - 3.0_f64.powi(-round)).abs() < 1e-12);
            assert_eq!(lawson.weights[1..], [1.0, 0.0]);
        }
        let alone = lawson.moments(&samples).value(&rows);
        assert!((alone - 9.0 - 3.0_f64.powi(-4)).abs() < 1e-9, "{alone}");
    }
}
