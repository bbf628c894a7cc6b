//! Triangles sorted for rays: a tree over those that are listed, and a tree over instances ([`super::top`]) of meshes with
//! trees of their own ([`super::shared`]).
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

use super::collapse::{Collapsed, collapse as eight_wide};
use super::pieces::{self, PIECE};
use super::shared::SharedTree;
use super::top::Top;
use super::wide::{DEPTH_MAX, LEAF, WIDTH, Wide};
use crate::scene::{Instance, Scene, SceneFrame, SharedMesh, Triangle};

/// Share of the nodes that one round of reinsertion tries to place better; 16 rounds of falling share follow.
const REINSERTION_SHARE: f32 = 0.05;

/// Rounds of PLOC that look at direct neighbours only; they find most pairs anyway.
const PLOC_WIDE_FROM_ROUND: usize = 3;

/// Cost of a node over that of a triangle, so high that every subtree small enough becomes a leaf: the kernel tests
/// eight triangles at once for about the price of a node.
const ALWAYS_LEAF: f32 = 1e6;

/// A bounding volume hierarchy over triangles, which it copies into its own order, and instances.
#[derive(Debug)]
pub struct Bvh {
    pub(super) wide: Wide,
    /// Stored coordinate = scale × scene coordinate; a power of two.
    scale: f64,
    /// Of the listed triangles.
    listed: Option<[DVec3; 2]>,
    /// Over instances.
    pub(super) top: Top,
    /// Of the meshes of all instances of the shot, in the still tree only.
    pub(super) meshes: Vec<SharedTree>,
}

impl Bvh {
    /// Builds over triangles in scene space, metres. Triangles with a non-finite vertex or without area are left out;
    /// the indices of the others stay what they are.
    pub fn build(triangles: &[Triangle]) -> Bvh {
        Bvh::with_instances(triangles, &[], &[])
    }

    /// Over what never moves in a scene. Also holds the trees of meshes that move rigidly.
    pub fn still(scene: &Scene) -> Bvh {
        let meshes: Vec<SharedTree> = scene.shared_meshes().iter().map(SharedTree::build).collect();
        let mut bvh = Bvh::with_instances(&scene.still, &scene.still_instances, scene.shared_meshes());
        bvh.meshes = meshes;
        bvh
    }

    /// Over what moves, posed for a frame; `None` when there is nothing. Instances are not sorted again inside.
    pub fn moving(scene: &Scene, frame: &SceneFrame) -> Option<Bvh> {
        let any = !frame.moving.is_empty() || !frame.moving_instances.is_empty();
        any.then(|| Bvh::with_instances(&frame.moving, &frame.moving_instances, scene.shared_meshes()))
    }

    fn with_instances(triangles: &[Triangle], instances: &[Instance], meshes: &[SharedMesh]) -> Bvh {
        let kept: Vec<u32> = (0u32..).zip(triangles).filter(|(_, t)| has_area(t)).map(|(i, _)| i).collect();
        let vertices = kept.iter().flat_map(|&i| triangles[i as usize]);
        let bounds = vertices.fold(None, |bounds: Option<[Vec3; 2]>, v| match bounds {
            None => Some([v, v]),
            Some([low, high]) => Some([low.min(v), high.max(v)]),
        });
        let top = Top::build(instances, meshes);
        let Some([low, high]) = bounds else {
            return Bvh { wide: Wide::default(), scale: 1.0, listed: None, top, meshes: Vec::new() };
        };
        let scale = unit_scale(low.abs().max_element().max(high.abs().max_element()));
        let wide = wide_tree(triangles, kept, scale as f32);
        Bvh { wide, scale, listed: Some([low.as_dvec3(), high.as_dvec3()]), top, meshes: Vec::new() }
    }

    /// What stored coordinates are multiplied by.
    pub(super) fn scale(&self) -> f64 {
        self.scale
    }

    /// Lower and upper corner of the listed triangles kept.
    pub(super) fn listed_bounds(&self) -> Option<[DVec3; 2]> {
        self.listed
    }

    /// Lower and upper corner of the triangles kept, scene space, metres; `None` when there is none.
    pub fn bounds(&self) -> Option<[DVec3; 2]> {
        match (self.listed, self.top.bounds) {
            (Some([a, b]), Some([c, d])) => Some([a.min(c), b.max(d)]),
            (one, other) => one.or(other),
        }
    }
}

/// True for three finite vertices that span a plane. Products of two f32 differences are exact enough in f64 that only
/// truly collinear vertices (and those closer to it than 2⁻⁵² of their size) give zero.
pub(super) fn has_area(triangle: &Triangle) -> bool {
    let [a, b, c] = triangle.map(|v| v.as_dvec3());
    let cross = (b - a).cross(c - a);
    cross.is_finite() && cross != DVec3::ZERO
}

/// The power of two that takes a magnitude into [1/2, 1); for magnitudes below the normal numbers of f32 the largest one
/// that f32 holds.
pub(super) fn unit_scale(magnitude: f32) -> f64 {
    let exponent = f64::from(magnitude).log2().floor() + 1.0;
    (-exponent).exp2().min(SCALE_MAX)
}

/// 2¹²⁶.
const SCALE_MAX: f64 = (1u128 << 126) as f64;

/// The tree over kept triangles; that of many is built piece by piece, so that what building takes is bounded.
fn wide_tree(triangles: &[Triangle], mut kept: Vec<u32>, scale: f32) -> Wide {
    let bounds_of = |i: u32| Aabb::from_points(&triangles[i as usize].map(|v| Vec3A::from(v * scale)));
    let mut wide = Wide::default();
    let pieces = pieces::split(&mut kept, triangles);
    if let [_] = pieces[..] {
        let boxes: Vec<Aabb> = kept.par_iter().map(|&i| bounds_of(i)).collect();
        wide.append(&tree_of_triangles(&boxes, DEPTH_MAX), &kept, triangles, scale);
        return wide;
    }
    let around = |piece: &[u32]| piece.par_iter().map(|&i| bounds_of(i)).reduce(Aabb::empty, |a, b| a.union(&b));
    let top = tree_of_boxes(&pieces.iter().map(|piece| around(&kept[piece.clone()])).collect::<Vec<_>>());
    wide.nodes.extend(top.nodes.iter().cloned());
    let mut roots = vec![0; pieces.len()];
    for (piece, root) in pieces.iter().zip(&mut roots) {
        let kept = &kept[piece.clone()];
        let boxes: Vec<Aabb> = kept.par_iter().map(|&i| bounds_of(i)).collect();
        *root = wide.append(&tree_of_triangles(&boxes, DEPTH_MAX - TOP_DEPTH), kept, triangles, scale);
    }
    for child in wide.nodes[..top.nodes.len()].iter_mut().flat_map(|node| &mut node.children) {
        if *child != u32::MAX && *child & LEAF != 0 {
            *child = roots[top.order[top.runs[(*child & !LEAF) as usize].start] as usize];
        }
    }
    wide
}

/// Levels kept for the tree over pieces, of which there are at most 2³² / [`PIECE`].
const TOP_DEPTH: usize = 16;
const _: () = assert!(PIECE >= 1 << 16, "a tree over pieces has at most eleven levels and five more");

/// PLOC, subtrees of up to [`WIDTH`] triangles made leaves, and reinsertion; in stored coordinates.
pub(super) fn tree_of_triangles(boxes: &[Aabb], depth_max: usize) -> Collapsed {
    let mut tree = ploc(boxes);
    collapse(&mut tree, WIDTH as u32, ALWAYS_LEAF);
    ReinsertionOptimizer::default().run(&mut tree, REINSERTION_SHARE, None);
    eight_wide(&tree, boxes, WIDTH, depth_max)
}

/// The same with every box a leaf of its own, for few boxes.
pub(super) fn tree_of_boxes(boxes: &[Aabb]) -> Collapsed {
    let mut tree = ploc(boxes);
    ReinsertionOptimizer::default().run(&mut tree, REINSERTION_SHARE, None);
    eight_wide(&tree, boxes, 1, TOP_DEPTH)
}

fn ploc(boxes: &[Aabb]) -> Bvh2 {
    PlocBuilder::with_capacity(boxes.len()).build(
        PlocSearchDistance::Medium,
        boxes,
        (0..boxes.len() as u32).collect(),
        SortPrecision::U64,
        PLOC_WIDE_FROM_ROUND,
    )
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
