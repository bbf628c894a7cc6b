//! The tree over instances, and the way from the scene into the space of a mesh's tree.
//!
//! Which triangles a ray meets is decided in the scene (see [`super::shared`]), so in the mesh's space boxes only have to
//! err on the safe side. What the decision can err by, [`BOX_MARGIN`] of the unit cube, is a box of half side m about a
//! point of the scene; mapped by the linear part L of mesh-from-scene it lies within Σⱼ |Lᵢⱼ| m on axis i. The boxes of the
//! mesh are grown by that, whatever L scales, shears or mirrors. m also takes in what inverting the matrix and
//! mapping the ray in f64 err by: the residual of the inverse, times how far out things lie. A matrix without an inverse
//! gives an infinite margin: every leaf is looked at.

use glam::{DAffine3, DMat3, DVec3, Vec3A};
use obvhs::aabb::Aabb;

use super::bvh::{tree_of_boxes, unit_scale};
use super::wide::{BOX_MARGIN, Node};
use crate::scene::{Instance, SharedMesh};

/// Rounding of f64 in a few dozen operations, relative.
const F64_ROUNDING: f64 = 1.0 / (1u64 << 47) as f64;

/// Instances sorted for rays.
#[derive(Debug, Default)]
pub(super) struct Top {
    /// Node 0 is the root; leaves count through `instances`.
    pub(super) nodes: Vec<Node>,
    /// In the order of the leaves.
    pub(super) instances: Vec<Placed>,
    /// Stored coordinate = scale × scene coordinate; a power of two.
    pub(super) scale: f64,
    /// Lower and upper corner, scene space, metres; `None` without instances.
    pub(super) bounds: Option<[DVec3; 2]>,
}

/// An instance, and the way to its mesh.
#[derive(Debug)]
pub(super) struct Placed {
    pub(super) instance: Instance,
    /// Mesh's space from scene space.
    pub(super) mesh_from_scene: DAffine3,
    /// What boxes are grown by, mesh's space.
    pub(super) margin: DVec3,
}

impl Top {
    /// Over instances with their bounds.
    pub(super) fn build(instances: &[Instance], meshes: &[SharedMesh]) -> Top {
        let corners = |i: &Instance| i.bounds.map(|v| v.as_dvec3());
        let bounds = instances.iter().map(corners).reduce(|[a, b], [c, d]| [a.min(c), b.max(d)]);
        let Some([low, high]) = bounds else { return Top::default() };
        let largest = low.abs().max(high.abs()).max_element();
        let scale = unit_scale(largest as f32);
        let stored = |i: &Instance| i.bounds.map(|v| Vec3A::from(v * scale as f32));
        let tree = tree_of_boxes(&instances.iter().map(|i| Aabb::from_points(&stored(i))).collect::<Vec<_>>());
        let placed = |run: &std::ops::Range<usize>| {
            let instance = instances[tree.order[run.start] as usize];
            Placed::new(instance, &meshes[instance.mesh as usize], scale)
        };
        Top { instances: tree.runs.iter().map(placed).collect(), nodes: tree.nodes, scale, bounds }
    }
}

impl Placed {
    fn new(instance: Instance, mesh: &SharedMesh, scale: f64) -> Placed {
        let DAffine3 { matrix3: forth, translation } = instance.world_from_mesh;
        let back = forth.inverse();
        let shift = instance.origin - translation;
        let mesh_from_scene = DAffine3 { matrix3: back, translation: back * shift };
        let absolute = |m: DMat3| DMat3::from_cols(m.x_axis.abs(), m.y_axis.abs(), m.z_axis.abs());
        let residual = forth * back - DMat3::IDENTITY;
        let residual = [residual.x_axis, residual.y_axis, residual.z_axis].map(|c| c.abs().max_element());
        let residual = residual[0].max(residual[1]).max(residual[2]);
        let reach = mesh.vertices.first().map_or(0.0, |v| (absolute(forth) * v.abs()).max_element());
        let far = 4.0 / scale + translation.abs().max_element() + instance.origin.abs().max_element() + reach;
        let metres = 2.0 * f64::from(BOX_MARGIN) / scale + (3.0 * residual + F64_ROUNDING) * far;
        let margin = absolute(back) * DVec3::splat(metres);
        if margin.is_finite() && mesh_from_scene.is_finite() {
            return Placed { instance, mesh_from_scene, margin };
        }
        let nowhere = DAffine3 { matrix3: DMat3::ZERO, translation: DVec3::ZERO };
        Placed { instance, mesh_from_scene: nowhere, margin: DVec3::INFINITY }
    }
}
