//! A ray's way through instances: down the tree over them, into the tree of a mesh, and back to the scene at its leaves.
//!
//! The ray's parameter is the same in both spaces, up to a factor and a start that keep f32 numbers small in the mesh's.

use glam::{DVec3, Vec3};

use super::bvh::has_area;
use super::kernel::{GrownBoxes, Spread};
use super::lanes::Lanes;
use super::ray::{LocalRay, Ray, axes};
use super::shared::SharedTree;
use super::solid::Solid;
use super::top::{Placed, Top};
use super::walk::{Stack, visit};
use super::wide::{LEAF, Node, WIDTH};

/// Smallest component of a direction in a mesh's space, relative to the largest, so that its inverse is finite.
const SLOPE_MIN: f64 = 1.0 / (1u64 << 60) as f64;

/// Margin of a box that every ray meets, in sizes of the mesh; finite, so that absent children, which are boxes turned
/// inside out at infinity, are still met by none.
const MARGIN_MAX: f64 = (1u64 << 60) as f64;

/// A triangle of an instance that a ray meets.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    /// Index within the list, still or moving.
    pub(super) triangle: u32,
    /// Coordinates as stored in the tree over instances.
    pub(super) corners: [Vec3; 3],
    /// The ray's parameter there.
    pub(super) t: f32,
}

/// The nearest solid triangle along a ray that is `local` to the tree over instances, of two equally near the one of the
/// lower index; or any, with `ANY`.
#[inline(always)]
pub(super) fn first<L: Lanes, const ANY: bool>(
    top: &Top,
    meshes: &[SharedTree],
    local: &LocalRay,
    solid: &impl Solid,
) -> Option<Found> {
    let spread = Spread::<L>::new(&local.ray);
    let mut best = Found { triangle: u32::MAX, corners: [Vec3::ZERO; 3], t: local.ray.t_max };
    let mut stack = Stack::new();
    stack.push(visit(local.ray.t_min.max(0.0), 0));
    while let Some((enter, child)) = stack.pop_parts() {
        if enter > best.t {
            continue;
        }
        if child & LEAF == 0 {
            let node = &top.nodes[child as usize];
            let (hits, enter) = spread.boxes(&local.ray, node, best.t);
            push_hits(&mut stack, node, hits, enter.store());
            continue;
        }
        let placed = &top.instances[(child & !LEAF) as usize];
        let tree = &meshes[placed.instance.mesh as usize];
        into_mesh::<L, ANY>(placed, tree, top.scale as f32, local, &spread, solid, &mut best);
        if ANY && best.triangle != u32::MAX {
            break;
        }
    }
    (best.triangle != u32::MAX).then_some(best)
}

/// Puts the children hit on the stack, the nearest on top.
#[inline(always)]
fn push_hits(stack: &mut Stack, node: &Node, mut hits: u32, enter: [f32; WIDTH]) {
    let from = stack.len();
    while hits != 0 {
        let lane = hits.trailing_zeros() as usize;
        hits &= hits - 1;
        stack.push(visit(enter[lane], node.children[lane]));
    }
    stack.sort_from(from);
}

/// A ray in the stored coordinates of a mesh's tree.
struct MeshRay {
    ray: Ray,
    /// Local parameter = (that of the scene's ray - start) × factor.
    start: f64,
    factor: f64,
}

impl MeshRay {
    /// `None` for a ray that passes the mesh by, up to `t_max`.
    #[inline(always)]
    fn new(placed: &Placed, tree: &SharedTree, local: &LocalRay, scale: f64, t_max: f32) -> Option<(MeshRay, Vec3)> {
        let unit = 1.0 / scale;
        let origin = placed.mesh_from_scene.transform_point3(local.origin() * unit);
        let origin = (origin - tree.centre) * tree.scale;
        let slope = placed.mesh_from_scene.matrix3 * (local.direction() * (unit * tree.scale));
        let margin = (placed.margin * tree.scale).min(DVec3::splat(MARGIN_MAX));
        let longest = slope.abs().max_element();
        let (slope, factor) = if longest.is_normal() { (slope, longest) } else { (DVec3::X, 1.0) };
        let least = DVec3::splat(factor * SLOPE_MIN).copysign(slope);
        let slope = DVec3::select(slope.abs().cmplt(least.abs()), least, slope);
        let a = (tree.bounds[0] - margin - origin) / slope;
        let b = (tree.bounds[1] + margin - origin) / slope;
        let enter = a.min(b).max_element().max(f64::from(local.ray.t_min));
        let leave = a.max(b).min_element().min(f64::from(t_max));
        if enter > leave {
            return None;
        }
        let start = if enter.is_finite() { enter } else { 0.0 };
        let direction = slope / factor;
        let range = [0.0, (f64::from(t_max) - start) * factor];
        let ray = Ray::new(origin + slope * start, direction, axes(direction), range);
        Some((MeshRay { ray, start, factor }, margin.as_vec3()))
    }
}

#[inline(always)]
fn into_mesh<L: Lanes, const ANY: bool>(
    placed: &Placed,
    tree: &SharedTree,
    scale: f32,
    local: &LocalRay,
    spread: &Spread<L>,
    solid: &impl Solid,
    best: &mut Found,
) {
    let Some((mesh, margin)) = MeshRay::new(placed, tree, local, f64::from(scale), best.t) else { return };
    let boxes = GrownBoxes::<L>::new(&mesh.ray, margin);
    let mut t_max = mesh.ray.t_max;
    let mut stack = Stack::new();
    stack.push(visit(0.0, 0));
    while let Some((enter, child)) = stack.pop_parts() {
        if enter > t_max {
            continue;
        }
        if child & LEAF == 0 {
            let node = &tree.nodes[child as usize];
            let (hits, enter) = boxes.boxes(&mesh.ray, node, t_max);
            push_hits(&mut stack, node, hits, enter.store());
            continue;
        }
        let leaf = tree.leaves[(child & !LEAF) as usize].placed(&placed.instance, scale);
        let (mut hits, t) = spread.triangles(&local.ray, &leaf, best.t);
        let t = t.store();
        while hits != 0 {
            let lane = hits.trailing_zeros() as usize;
            hits &= hits - 1;
            let (t, triangle) = (t[lane], placed.instance.first + leaf.triangles[lane]);
            let corners = leaf.corners(lane);
            let nearer = t < best.t || (t == best.t && triangle < best.triangle);
            if nearer && has_area(&corners) && solid.is_hit(triangle) {
                *best = Found { triangle, corners, t };
                if ANY {
                    return;
                }
                t_max = ((f64::from(t) - mesh.start) * mesh.factor) as f32;
            }
        }
    }
}
