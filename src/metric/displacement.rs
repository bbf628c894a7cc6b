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

/// Displacement of one sample under rows p1, p2 (in texels) and p4. Infinite where the light grazes the receiver.
pub fn displacement(samples: &EdgeSamples, i: usize, rows: &[DVec3; 3]) -> Displacement {
    let [p1, p2, p4] = *rows;
    let scale = (p4.dot(samples.q[i]) / (det3(p1, p2, p4) * samples.volume(i))).abs();
    let c = samples.edge_vector(i);
    let (a, b) = (p1.cross(p4).dot(c).abs() * scale, p2.cross(p4).dot(c).abs() * scale);
    Displacement { r_max: a.max(b), r_min: a.min(b) }
}

/// Expected displacement of one sample, pixels.
pub fn expected_displacement(samples: &EdgeSamples, i: usize, rows: &[DVec3; 3]) -> f64 {
    displacement(samples, i, rows).expected()
}

/// ‖J⁻¹‖² of one sample: the summand of SOSM eq. 6 and 9.
pub fn inverse_jacobian_norm2(samples: &EdgeSamples, i: usize, rows: &[DVec3; 3]) -> f64 {
    let [p1, p2, p4] = *rows;
    let scale = p4.dot(samples.q[i]) / (det3(p1, p2, p4) * samples.volume(i));
    let (q1, q2) = (p1.cross(p4), p2.cross(p4));
    samples.footprint_vectors(i).iter().map(|c| (q1.dot(*c)).powi(2) + (q2.dot(*c)).powi(2)).sum::<f64>()
        * scale
        * scale
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    /// A receiver seen head-on, lit head-on: one pixel is 0.1 units of the light plane, one texel 0.5 units.
    #[test]
    fn axis_aligned_texel_of_five_pixels() {
        let samples = EdgeSamples {
            q: vec![DVec3::new(0.2, 0.3, 1.0)],
            t: vec![[DVec3::new(0.1, 0.0, 0.0), DVec3::new(0.0, 0.1, 0.0)]],
            edge_normal: vec![DVec2::X],
            length_px: vec![1.0],
            room_px: vec![1.0],
        };
        let rows = [DVec3::new(2.0, 0.0, 0.0), DVec3::new(0.0, 2.0, 0.0), DVec3::Z];
        let d = displacement(&samples, 0, &rows);
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
