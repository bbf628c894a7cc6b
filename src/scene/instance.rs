//! Meshes kept once and placed many times, and which meshes those are.
//!
//! An instance is a promise about vertices: its triangles are, to the bit, those that [`super::bake`] would have listed.
//! Only the memory differs. So whoever asks for a triangle, draws or traces it gets the answer of a scene without
//! instances.

use super::bake::Bounds;
use super::marks::{Mark, Marks};
use super::mesh::has_area;
use super::model::{Mesh, Model, Part};
use super::params::InstanceRule;
use super::rig::{PartState, Rig};
use super::{SceneError, Triangle};
use glam::{DAffine3, DVec3, Vec3};
use rayon::prelude::*;

/// Triangles that sharing a still mesh must save before it is done: a shared triangle costs no memory of its own, but is
/// transformed whenever a ray looks at it (measured in `benches/README.md`).
const SAVED_MIN: u64 = 1 << 20;

/// Triangles of one mesh that must move rigidly before it is shared: sorting fewer anew every frame costs less than
/// slower rays (measured in `benches/README.md`).
const MOVING_MIN: u64 = 1 << 18;

/// Smallest mesh worth sharing: placing it takes about the memory of four triangles.
const MESH_MIN: u64 = 16;

/// Triangles looked at by one task.
const TRIANGLES_A_TASK: usize = 8192;

/// A mesh in its own space, for instances.
#[derive(Debug)]
pub struct SharedMesh {
    /// Finite; in the space of its nodes.
    pub vertices: Vec<DVec3>,
    /// Counter-clockwise from the front; at least one.
    pub triangles: Vec<[u32; 3]>,
    /// Of the triangles.
    pub marks: Marks,
}

/// A shared mesh, placed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instance {
    /// Index into [`Geometry::meshes`](super::Geometry::meshes).
    pub mesh: u32,
    /// Index of its first triangle within its list, still or moving: after the triangles of the list itself.
    pub first: u32,
    /// Number of its triangles.
    pub count: u32,
    /// World-from-mesh.
    pub world_from_mesh: DAffine3,
    /// World position of scene space's zero, metres.
    pub origin: DVec3,
    /// The matrix mirrors: the second and third corner of every triangle are exchanged, so that fronts stay fronts.
    pub mirrored: bool,
    /// Lower and upper corner of its triangles, scene space, metres.
    pub bounds: [Vec3; 2],
}

impl Instance {
    /// A vertex in scene space: the arithmetic of triangles in lists, in its order.
    #[inline]
    pub fn place(&self, vertex: DVec3) -> Vec3 {
        (self.world_from_mesh.transform_point3(vertex) - self.origin).as_vec3()
    }

    /// A triangle of the mesh in scene space.
    #[inline]
    pub fn triangle(&self, mesh: &SharedMesh, triangle: usize) -> Triangle {
        let [a, b, c] = mesh.triangles[triangle];
        let [b, c] = if self.mirrored { [c, b] } else { [b, c] };
        [a, b, c].map(|vertex| self.place(mesh.vertices[vertex as usize]))
    }

    /// The mark of a triangle of the mesh.
    #[inline]
    pub fn mark(&self, mesh: &SharedMesh, triangle: u32) -> Mark {
        let mark = mesh.marks.get(triangle);
        if self.mirrored { mark.turned() } else { mark }
    }
}

/// By mesh of a model: its place among the shared ones.
#[derive(Debug, Default)]
pub(super) struct Shared {
    /// Indices into `meshes`; `None` for a mesh that is not shared.
    pub of_mesh: Vec<Option<u32>>,
    /// Taken out of the model.
    pub meshes: Vec<SharedMesh>,
}

impl Shared {
    /// The shared mesh of a part.
    pub(super) fn of(&self, part: &Part) -> Option<(u32, &SharedMesh)> {
        let index = (*self.of_mesh.get(part.mesh)?)?;
        Some((index, &self.meshes[index as usize]))
    }

    /// Takes the meshes that are worth it out of a model: those without skin and morph targets that, placed as often as
    /// they are, would fill lists with more than the rule allows.
    pub(super) fn take(model: &mut Model, [still, moving]: [&[Part]; 2], rule: InstanceRule) -> Shared {
        let mut placed = vec![[0_u64; 2]; model.meshes.len()];
        let mut rigid = vec![true; model.meshes.len()];
        for (list, parts) in [still, moving].into_iter().enumerate() {
            for part in parts {
                placed[part.mesh][list] += 1;
                rigid[part.mesh] &= part.skin.is_none();
            }
        }
        let mut shared = Shared { of_mesh: vec![None; model.meshes.len()], meshes: Vec::new() };
        for (index, mesh) in model.meshes.iter_mut().enumerate() {
            let count = mesh.triangles.len() as u64;
            let [still, moving] = placed[index];
            let wanted = match rule {
                InstanceRule::Flatten => false,
                InstanceRule::Share => count > 0 && still + moving > 0,
                InstanceRule::Auto => {
                    count >= MESH_MIN && (still.saturating_sub(1) * count >= SAVED_MIN || moving * count >= MOVING_MIN)
                }
            };
            if wanted && rigid[index] && mesh.targets.is_empty() && mesh.influences.is_none() {
                let Mesh { vertices, triangles, marks, .. } = std::mem::take(mesh);
                shared.of_mesh[index] = Some(shared.meshes.len() as u32);
                shared.meshes.push(SharedMesh { vertices, triangles, marks });
            }
        }
        shared
    }
}

/// Places a part whose mesh is shared; `first` is left at zero. Also how many of its triangles have no area; `None` when
/// that is all of them.
///
/// # Errors
/// [`SceneError::Pose`] when a vertex overflows f32.
pub(super) fn place(
    rig: Rig<'_>,
    part: &Part,
    state: &PartState,
    (index, mesh): (u32, &SharedMesh),
    origin: DVec3,
    time_s: f64,
) -> Result<(Option<Instance>, usize), SceneError> {
    let world_from_mesh = state.matrices().first().copied().unwrap_or(DAffine3::IDENTITY);
    let instance = Instance {
        mesh: index,
        first: 0,
        count: mesh.triangles.len() as u32,
        world_from_mesh,
        origin,
        mirrored: state.mirrors(),
        bounds: [Vec3::ZERO; 2],
    };
    let look = |range: std::ops::Range<usize>| {
        let mut found = Look { bounds: Bounds::EMPTY, dropped: 0, finite: true };
        for k in range {
            let corners = instance.triangle(mesh, k).map(|v| v.as_dvec3());
            found.finite &= corners.iter().all(|v| v.is_finite());
            match has_area(corners) {
                true => found.bounds.extend(corners),
                false => found.dropped += 1,
            }
        }
        found
    };
    let count = mesh.triangles.len();
    let tasks = (0..count.div_ceil(TRIANGLES_A_TASK)).into_par_iter();
    let found = tasks
        .map(|task| look(task * TRIANGLES_A_TASK..((task + 1) * TRIANGLES_A_TASK).min(count)))
        .reduce(|| Look { bounds: Bounds::EMPTY, dropped: 0, finite: true }, Look::and);
    if !found.finite {
        return Err(rig.node(part).pose_error("a vertex overflows; check the scales above it", time_s));
    }
    let bounds = [found.bounds.min.as_vec3(), found.bounds.max.as_vec3()];
    let instance = (!found.bounds.is_empty()).then_some(Instance { bounds, ..instance });
    Ok((instance, found.dropped))
}

/// What there is to know of the triangles of an instance.
struct Look {
    bounds: Bounds,
    dropped: usize,
    finite: bool,
}

impl Look {
    fn and(mut self, other: Look) -> Look {
        self.bounds.extend(other.bounds.ends());
        Look { bounds: self.bounds, dropped: self.dropped + other.dropped, finite: self.finite && other.finite }
    }
}
