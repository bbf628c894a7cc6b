//! Triangles sorted for rays.
//!
//! The topology comes from `obvhs` (PLOC, Meister and Bittner 2018, then parallel reinsertion, Meister and Bittner
//! 2018) as a binary tree over boxes; [`super::wide`] collapses it to eight children a node.
//!
//! Everything is stored scaled by a power of two that takes the largest coordinate into [1/2, 1). The scaling is exact, so
//! the answers do not depend on units, and neither the builder's areas nor the kernel's products overflow.

use glam::{DVec3, Vec3, Vec3A};
use obvhs::{
    aabb::Aabb,
    bvh2::{Bvh2, leaf_collapser::collapse, reinsertion::ReinsertionOptimizer},
    ploc::{PlocBuilder, PlocSearchDistance, SortPrecision},
};

use rayon::prelude::*;

use super::wide::{WIDTH, Wide};
use crate::scene::Triangle;

/// Share of the nodes that one round of reinsertion tries to place better; 16 rounds of falling share follow.
const REINSERTION_SHARE: f32 = 0.05;

/// Rounds of PLOC that look at direct neighbours only; they find most pairs anyway.
const PLOC_WIDE_FROM_ROUND: usize = 3;

/// Cost of a node over that of a triangle, so high that every subtree small enough becomes a leaf: the kernel tests
/// eight triangles at once for about the price of a node.
const ALWAYS_LEAF: f32 = 1e6;

/// A bounding volume hierarchy over triangles, which it copies into its own order.
#[derive(Debug)]
pub struct Bvh {
    pub(super) wide: Wide,
    /// Stored coordinate = scale × scene coordinate; a power of two.
    scale: f64,
    bounds: Option<[DVec3; 2]>,
}

impl Bvh {
    /// Builds over triangles in scene space, metres. Triangles with a non-finite vertex or without area are left out;
    /// the indices of the others stay what they are.
    pub fn build(triangles: &[Triangle]) -> Bvh {
        let kept: Vec<u32> = (0u32..).zip(triangles).filter(|(_, t)| has_area(t)).map(|(i, _)| i).collect();
        let vertices = kept.iter().flat_map(|&i| triangles[i as usize]);
        let bounds = vertices.fold(None, |bounds: Option<[Vec3; 2]>, v| match bounds {
            None => Some([v, v]),
            Some([low, high]) => Some([low.min(v), high.max(v)]),
        });
        let Some([low, high]) = bounds else {
            return Bvh { wide: Wide::default(), scale: 1.0, bounds: None };
        };
        let scale = unit_scale(low.abs().max_element().max(high.abs().max_element()));
        let binary = binary_tree(triangles, &kept, scale as f32);
        let wide = Wide::collapse(&binary, &kept, triangles, scale as f32);
        Bvh { wide, scale, bounds: Some([low.as_dvec3(), high.as_dvec3()]) }
    }

    /// What stored coordinates are multiplied by.
    pub(super) fn scale(&self) -> f64 {
        self.scale
    }

    /// Lower and upper corner of the triangles kept, scene space, metres; `None` when there is none.
    pub fn bounds(&self) -> Option<[DVec3; 2]> {
        self.bounds
    }
}

/// True for three finite vertices that span a plane. Products of two f32 differences are exact enough in f64 that only
/// truly collinear vertices (and those closer to it than 2⁻⁵² of their size) give zero.
fn has_area(triangle: &Triangle) -> bool {
    let [a, b, c] = triangle.map(|v| v.as_dvec3());
    let cross = (b - a).cross(c - a);
    cross.is_finite() && cross != DVec3::ZERO
}

/// The power of two that takes a magnitude into [1/2, 1); for magnitudes below the normal numbers of f32 the largest one
/// that f32 holds.
fn unit_scale(magnitude: f32) -> f64 {
    let exponent = f64::from(magnitude).log2().floor() + 1.0;
    (-exponent).exp2().min(SCALE_MAX)
}

/// 2¹²⁶.
const SCALE_MAX: f64 = (1u128 << 126) as f64;

/// PLOC, subtrees of up to [`WIDTH`] triangles made leaves, and reinsertion; in stored coordinates. Leaves count through
/// `kept`.
fn binary_tree(triangles: &[Triangle], kept: &[u32], scale: f32) -> Bvh2 {
    let stored = |v: Vec3| Vec3A::from(v * scale);
    let boxes: Vec<Aabb> = kept.par_iter().map(|&i| Aabb::from_points(&triangles[i as usize].map(stored))).collect();
    let indices = (0..boxes.len() as u32).collect();
    let mut tree = PlocBuilder::with_capacity(boxes.len()).build(
        PlocSearchDistance::Medium,
        &boxes,
        indices,
        SortPrecision::U64,
        PLOC_WIDE_FROM_ROUND,
    );
    collapse(&mut tree, WIDTH as u32, ALWAYS_LEAF);
    ReinsertionOptimizer::default().run(&mut tree, REINSERTION_SHARE, None);
    tree
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scale_is_a_power_of_two_into_the_unit_interval() {
        for magnitude in [1e-30_f32, 0.3, 0.5, 1.0, 1.5, 7.0, 3e38] {
            let scaled = unit_scale(magnitude) * f64::from(magnitude);
            assert!((0.5..1.0).contains(&scaled), "{magnitude} -> {scaled}");
            assert_eq!(unit_scale(magnitude).log2().fract(), 0.0);
        }
    }

    #[test]
    fn bad_triangles_are_left_out() {
        let nan = [Vec3::NAN, Vec3::X, Vec3::Y];
        let infinite = [Vec3::INFINITY, Vec3::X, Vec3::Y];
        let line = [Vec3::ZERO, Vec3::X, Vec3::X * 2.0];
        assert!(Bvh::build(&[nan, infinite, line]).bounds().is_none());
        let good = [Vec3::ZERO, Vec3::X, Vec3::Y];
        assert_eq!(Bvh::build(&[nan, good]).bounds(), Some([DVec3::ZERO, DVec3::new(1.0, 1.0, 0.0)]));
    }
}
