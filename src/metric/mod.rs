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

mod derivatives;
mod displacement;
mod minimax;
mod moments;
mod pass;
mod weights;

pub use displacement::{Displacement, TexelRows, inverse_jacobian_norm2};
pub use minimax::Lawson;
pub use moments::Moments;
pub use weights::{Metric, UNCERTAIN_WEIGHT, cost, cost_and_moments, moments_of, wrong_pixels};

use crate::samples::EdgePoint;
use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};

/// A piece of shadow edge on the film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmEdge {
    /// Unit normal.
    pub normal: DVec2,
    /// Length, pixels.
    pub length_px: f64,
    /// Distance to the nearest other shadow edge across this one, pixels.
    pub room_px: f64,
    /// The exact answers beside it are uncertain.
    pub uncertain: bool,
}

impl From<&EdgePoint> for FilmEdge {
    fn from(point: &EdgePoint) -> FilmEdge {
        let EdgePoint { normal, length_px, room_px, uncertain, .. } = *point;
        FilmEdge { normal, length_px, room_px, uncertain }
    }
}

/// Edge samples of one light in one light plane: structure of arrays, all of equal length. q and T are divided by q3
/// and in normalised coordinates, so that sums over them are well scaled. What sums need again and again is worked out
/// once, in [`EdgeSamples::push`].
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
pub struct EdgeSamples {
    /// Light-plane vectors with q3 = 1.
    pub q: Vec<DVec3>,
    /// ∂q/∂x and ∂q/∂y per film pixel.
    pub t: Vec<[DVec3; 2]>,
    /// 1/V, V = q·(T_1 × T_2): infinite where the light grazes the receiver.
    pub inverse_volume: Vec<f64>,
    /// c_e = (T_1 e⊥_x + T_2 e⊥_y) × q, e the unit normal of the shadow edge on the film.
    pub edge_vector: Vec<DVec3>,
    /// Length of shadow edge the sample stands for, pixels.
    pub length_px: Vec<f64>,
    /// Distance to the nearest other shadow edge across this one, pixels: a displacement wider than that costs no more.
    pub room_px: Vec<f64>,
    /// The exact answers beside it are uncertain: its wrong pixels count [`UNCERTAIN_WEIGHT`].
    pub uncertain: Vec<bool>,
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

    /// None, with room for `count`.
    pub fn with_capacity(count: usize) -> EdgeSamples {
        EdgeSamples {
            q: Vec::with_capacity(count),
            t: Vec::with_capacity(count),
            inverse_volume: Vec::with_capacity(count),
            edge_vector: Vec::with_capacity(count),
            length_px: Vec::with_capacity(count),
            room_px: Vec::with_capacity(count),
            uncertain: Vec::with_capacity(count),
        }
    }

    /// Adds a sample: q with its derivatives, their [`volume`], and the edge.
    #[inline(always)]
    pub fn push(&mut self, q: DVec3, t: [DVec3; 2], volume: f64, edge: &FilmEdge) {
        self.q.push(q);
        self.t.push(t);
        self.inverse_volume.push(1.0 / volume);
        self.edge_vector.push((t[1] * edge.normal.x - t[0] * edge.normal.y).cross(q));
        self.length_px.push(edge.length_px);
        self.room_px.push(edge.room_px);
        self.uncertain.push(edge.uncertain);
    }

    /// c_1 and c_2 of a sample.
    #[inline(always)]
    pub fn footprint_vectors(&self, i: usize) -> [DVec3; 2] {
        [self.t[i][0].cross(self.q[i]), self.t[i][1].cross(self.q[i])]
    }
}

/// |V| below this part of |q| |T_1| |T_2| is computed again with compensated products. Above it plain ones err by less
/// than 1e-12 of V.
const PLAIN_VOLUME: f64 = 1e-3;

/// V = q·(T_1 × T_2), accurate to 1e-12 of itself also where the light grazes the receiver. `size` = |q| |T_1| |T_2|.
#[inline(always)]
pub fn volume(q: DVec3, t: [DVec3; 2], size: f64) -> f64 {
    let plain = q.dot(t[0].cross(t[1]));
    // Compensated products cost a function call each on processors without fused multiply-add in the baseline.
    if plain.abs() > PLAIN_VOLUME * size { plain } else { crate::math::det3(q, t[0], t[1]) }
}
