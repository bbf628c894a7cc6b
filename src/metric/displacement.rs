//! How far a drawn shadow edge lies from the exact one, in pixels (math note §5).
//!
//! A texel centre stands for every point of its texel, so an edge moves on the film by eᵀJ⁻¹d with d uniform on
//! [-½, ½]². With r_max ≥ r_min the magnitudes of the components of eᵀJ⁻¹:
//! E|displacement| = r_max/4 + r_min²/(12 r_max).

use super::EdgeSamples;
use crate::math::det3;
use glam::DVec3;

/// The two components of eᵀJ⁻¹ by magnitude, pixels of edge per texel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Displacement {
    /// The larger.
    pub r_max: f64,
    /// The smaller.
    pub r_min: f64,
}

impl Displacement {
    /// Expected magnitude, pixels.
    pub fn expected(&self) -> f64 {
        if self.r_max > 0.0 { self.r_max / 4.0 + self.r_min * self.r_min / (12.0 * self.r_max) } else { 0.0 }
    }

    /// Largest magnitude, pixels.
    pub fn largest(&self) -> f64 {
        0.5 * (self.r_max + self.r_min)
    }
}

/// Rows p1, p2 (in texels) and p4, with what all samples share.
#[derive(Clone, Copy, Debug)]
pub struct TexelRows {
    /// p1 × p4 / det and p2 × p4 / det.
    pub(super) cofactors: [DVec3; 2],
    pub(super) p4: DVec3,
}

impl TexelRows {
    /// Of rows p1, p2 (in texels) and p4.
    pub fn new(rows: &[DVec3; 3]) -> TexelRows {
        let [p1, p2, p4] = *rows;
        let inverse = 1.0 / det3(p1, p2, p4);
        TexelRows { cofactors: [p1.cross(p4) * inverse, p2.cross(p4) * inverse], p4 }
    }

    /// Displacement of one sample. Infinite where the light grazes the receiver.
    pub fn displacement(&self, samples: &EdgeSamples, i: usize) -> Displacement {
        let scale = (self.p4.dot(samples.q[i]) * samples.inverse_volume[i]).abs();
        let [a, b] = self.cofactors.map(|q| q.dot(samples.edge_vector[i]).abs() * scale);
        // Two selections: which is larger changes from sample to sample, and a branch would be guessed wrong.
        Displacement { r_max: if a > b { a } else { b }, r_min: if a > b { b } else { a } }
    }
}

/// ‖J⁻¹‖² of one sample: the summand of SOSM eq. 6 and 9.
pub fn inverse_jacobian_norm2(samples: &EdgeSamples, i: usize, rows: &TexelRows) -> f64 {
    let scale = rows.p4.dot(samples.q[i]) * samples.inverse_volume[i];
    let [q1, q2] = rows.cofactors;
    samples.footprint_vectors(i).iter().map(|c| (q1.dot(*c)).powi(2) + (q2.dot(*c)).powi(2)).sum::<f64>()
        * scale
        * scale
}

#[cfg(test)]
mod tests {
    use super::super::FilmEdge;
    use super::*;
    use glam::DVec2;

    /// A receiver seen head-on, lit head-on: one pixel is 0.1 units of the light plane, one texel 0.5 units.
    #[test]
    fn axis_aligned_texel_of_five_pixels() {
        let (q, t) = (DVec3::new(0.2, 0.3, 1.0), [DVec3::new(0.1, 0.0, 0.0), DVec3::new(0.0, 0.1, 0.0)]);
        let mut samples = EdgeSamples::default();
        let edge = FilmEdge { normal: DVec2::X, length_px: 1.0, room_px: 1.0, uncertain: false };
        samples.push(q, t, det3(q, t[0], t[1]), &edge);
        let rows = TexelRows::new(&[DVec3::new(2.0, 0.0, 0.0), DVec3::new(0.0, 2.0, 0.0), DVec3::Z]);
        let d = rows.displacement(&samples, 0);
        assert!((d.r_max - 5.0).abs() < 1e-12 && d.r_min.abs() < 1e-12);
        assert!((d.expected() - 1.25).abs() < 1e-12);
        assert!((inverse_jacobian_norm2(&samples, 0, &rows) - 50.0).abs() < 1e-10);
    }

    /// The closed form of E|r1 d1 + r2 d2| against a sum over a fine grid of d.
    #[test]
    fn expectation_of_a_uniform_texel() {
        for (r_max, r_min) in [(3.0, 3.0), (3.0, 1.0), (2.0, 0.0)] {
            let n = 400;
            let at = |k: i32| (f64::from(k) + 0.5) / f64::from(n) - 0.5;
            let mean: f64 =
                (0..n).flat_map(|i| (0..n).map(move |j| (r_max * at(i) + r_min * at(j)).abs())).sum::<f64>()
                    / f64::from(n * n);
            let closed = Displacement { r_max, r_min }.expected();
            assert!((mean / closed - 1.0).abs() < 1e-4, "{mean} {closed}");
        }
    }
}
