//! Samples + homography → score. Pure functions; no triangle, no shadow is known here.
//!
//! Everything is a function of a homography H on the light plane, rows p1, p2, p4 (math note §2-5; SOSM eq. 6, 9). With
//! T_j the derivative of q per film pixel, c_j = T_j × q, q_i' = p_i × p4, w = p4·q and V = q·(T_1 × T_2):
//!
//! ```text
//! J_ij  = (q_i'·c_j) / w²                      texels per pixel
//! det J = det(H) V / w³
//! r_i   = |q_i'·c_e| w / (|det H| |V|)         components of eᵀJ⁻¹: pixels of shadow edge per texel, c_e = (T e⊥) × q
//! ```

mod displacement;
mod moments;
mod weights;

pub use displacement::{Displacement, displacement, expected_displacement, inverse_jacobian_norm2};
pub use moments::Moments;
pub use weights::{Metric, cost, moments_of};

use glam::{DVec2, DVec3};

/// Edge samples of one light in one light plane: structure of arrays, all of equal length. q and T are divided by q3
/// and in normalised coordinates, so that sums over them are well scaled.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EdgeSamples {
    /// Light-plane vectors with q3 = 1.
    pub q: Vec<DVec3>,
    /// ∂q/∂x and ∂q/∂y per film pixel.
    pub t: Vec<[DVec3; 2]>,
    /// Unit normal of the shadow edge on the film.
    pub edge_normal: Vec<DVec2>,
    /// Length of shadow edge the sample stands for, pixels.
    pub length_px: Vec<f64>,
    /// Distance to the nearest other shadow edge across this one, pixels: a displacement wider than that costs no more.
    pub room_px: Vec<f64>,
}

impl EdgeSamples {
    /// Number of samples.
    pub fn len(&self) -> usize {
        self.q.len()
    }

    /// True without samples.
    pub fn is_empty(&self) -> bool {
        self.q.is_empty()
    }

    /// V = q·(T_1 × T_2) of a sample: zero where the light grazes the receiver.
    pub fn volume(&self, i: usize) -> f64 {
        crate::math::det3(self.q[i], self.t[i][0], self.t[i][1])
    }

    /// c_e = (T_1 e⊥_x + T_2 e⊥_y) × q of a sample.
    pub fn edge_vector(&self, i: usize) -> DVec3 {
        let along = DVec2::new(-self.edge_normal[i].y, self.edge_normal[i].x);
        (self.t[i][0] * along.x + self.t[i][1] * along.y).cross(self.q[i])
    }

    /// c_1 and c_2 of a sample.
    pub fn footprint_vectors(&self, i: usize) -> [DVec3; 2] {
        [self.t[i][0].cross(self.q[i]), self.t[i][1].cross(self.q[i])]
    }

    /// Every k-th sample, so that at most `cap` remain, with lengths scaled to keep the sum.
    pub fn thinned(&self, cap: usize) -> EdgeSamples {
        if self.len() <= cap || cap == 0 {
            return self.clone();
        }
        let pick = |k: usize| k * self.len() / cap;
        let scale = self.len() as f64 / cap as f64;
        EdgeSamples {
            q: (0..cap).map(|k| self.q[pick(k)]).collect(),
            t: (0..cap).map(|k| self.t[pick(k)]).collect(),
            edge_normal: (0..cap).map(|k| self.edge_normal[pick(k)]).collect(),
            length_px: (0..cap).map(|k| self.length_px[pick(k)] * scale).collect(),
            room_px: (0..cap).map(|k| self.room_px[pick(k)]).collect(),
        }
    }
}
