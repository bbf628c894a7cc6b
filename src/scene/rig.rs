//! Where the vertices of a part are at a time: morph targets, then skin or node (glTF 2.0, section 3.7.2.2 and 3.7.3.3).
//!
//! ```text
//! v' = v + Σ_k weight_k target_k(v)
//! world position = Σ_j weight_j(v) (world_from_joint_j · joint_from_mesh_j) v'     a skinned part
//!                = world_from_node · node_from_instance · v'                       any other
//! ```
//! The transform of a skinned mesh's own node does not enter, as the specification asks; its visibility does. A vertex
//! of a skinned part without a joint moves with the node.

use super::bake::Bounds;
use super::model::{Mesh, Model, Node, Part, Skin};
use super::pose::Pose;
use super::tasks;
use glam::{DAffine3, DVec3};

/// What parts refer to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rig<'a> {
    /// All.
    pub nodes: &'a [Node],
    /// All.
    pub meshes: &'a [Mesh],
    /// All.
    pub skins: &'a [Skin],
    /// Node-from-instance.
    pub instances: &'a [DAffine3],
}

/// What decides where the vertices of a part are, apart from the part itself.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PartState {
    /// World-from-mesh: one, or one a joint and then the node's.
    matrices: Vec<DAffine3>,
    /// Of the morph targets.
    weights: Vec<f64>,
    /// True when the part is not there at all.
    pub hidden: bool,
}

impl<'a> Rig<'a> {
    /// Of a model.
    pub(super) fn of(model: &'a Model) -> Self {
        Rig { nodes: &model.nodes, meshes: &model.meshes, skins: &model.skins, instances: &model.instances }
    }

    /// The mesh of a part.
    pub(super) fn mesh(self, part: &Part) -> &'a Mesh {
        &self.meshes[part.mesh]
    }

    /// The node of a part.
    pub(super) fn node(self, part: &Part) -> &'a Node {
        &self.nodes[part.node]
    }

    /// True when the part could ever be elsewhere, or of another shape, than at first; `animated` says it of nodes.
    pub(super) fn may_move(self, part: &Part, animated: &[bool]) -> bool {
        animated[part.node]
            || !self.node(part).tracks.weights.is_empty()
            || part.skin.is_some_and(|skin| self.skins[skin].joints.iter().any(|&joint| animated[joint]))
    }

    /// The state of a part at the time of a pose.
    pub(super) fn state(self, part: &Part, pose: &Pose, time_s: f64) -> PartState {
        let world = pose.world_from_node[part.node];
        let mut matrices = Vec::new();
        if let Some(skin) = part.skin.map(|skin| &self.skins[skin]) {
            let joints = skin.joints.iter().zip(&skin.inverse_bind);
            matrices.extend(joints.map(|(&joint, inverse_bind)| pose.world_from_node[joint] * *inverse_bind));
        }
        matrices.push(part.instance.map_or(world, |instance| world * self.instances[instance]));
        PartState { matrices, weights: self.weights(part, time_s), hidden: pose.hidden[part.node] }
    }

    /// The weights of a part's morph targets at a time, one each.
    fn weights(self, part: &Part, time_s: f64) -> Vec<f64> {
        let (mesh, node) = (self.mesh(part), self.node(part));
        let mut weights = node.weights.as_ref().unwrap_or(&mesh.rest_weights).clone();
        weights.resize(mesh.targets.len(), 0.0);
        for (&target, track) in &node.tracks.weights {
            if let Some(weight) = weights.get_mut(target) {
                *weight = track.sample(time_s).x;
            }
        }
        weights
    }
}

impl PartState {
    /// The vertices of the part's mesh, in their order, as `wanted` makes them of their world positions.
    pub(super) fn vertices<T: Send>(&self, mesh: &Mesh, wanted: impl Fn(DVec3) -> T + Sync) -> Vec<T> {
        let morphed = self.morphed(mesh);
        let vertices = morphed.as_deref().unwrap_or(&mesh.vertices);
        let mut placed = Vec::new();
        tasks::extend(&mut placed, vertices.len(), |k| wanted(self.place(mesh, k, vertices[k])));
        placed
    }

    /// The box of the vertices of the part's mesh, world.
    pub(super) fn bounds(&self, mesh: &Mesh) -> Bounds {
        let morphed = self.morphed(mesh);
        let vertices = morphed.as_deref().unwrap_or(&mesh.vertices);
        let boxes = tasks::runs(vertices.len(), |run| Bounds::of(run.map(|k| self.place(mesh, k, vertices[k]))));
        Bounds::of(boxes.iter().flat_map(Bounds::ends))
    }

    /// Vertices with the morph targets laid on; `None` without any in use.
    fn morphed(&self, mesh: &Mesh) -> Option<Vec<DVec3>> {
        if self.weights.iter().all(|&weight| weight == 0.0) {
            return None;
        }
        let mut vertices = mesh.vertices.clone();
        for (target, &weight) in mesh.targets.iter().zip(&self.weights).filter(|(_, weight)| **weight != 0.0) {
            for &(index, delta) in target {
                vertices[index as usize] += weight * delta;
            }
        }
        Some(vertices)
    }

    #[inline(always)]
    fn place(&self, mesh: &Mesh, index: usize, vertex: DVec3) -> DVec3 {
        let Some((own, joints)) = self.matrices.split_last() else { return vertex };
        match mesh.influences.as_ref().filter(|_| !joints.is_empty()).map(|influences| influences.of(index)) {
            None | Some([]) => own.transform_point3(vertex),
            Some(entries) => entries.iter().map(|&(j, w)| w * joints[usize::from(j)].transform_point3(vertex)).sum(),
        }
    }

    /// True when fronts of triangles come out as backs. Of the joints the first decides: a skeleton is mirrored as a
    /// whole.
    pub(super) fn mirrors(&self) -> bool {
        self.matrices.first().is_some_and(|matrix| matrix.matrix3.determinant() < 0.0)
    }

    /// World-from-mesh matrices by index: joints as in [`Influences`](super::model::Influences), then the node's own.
    pub(super) fn matrices(&self) -> &[DAffine3] {
        &self.matrices
    }

    /// Weights of the morph targets.
    pub(super) fn weights(&self) -> &[f64] {
        &self.weights
    }
}
