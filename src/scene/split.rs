//! What moves during a shot, what stands still, and how far either reaches.

use super::bake::Bounds;
use super::model::{Mesh, Model, Part};
use super::pose::{Pose, animated_nodes};
use super::rig::{PartState, Rig};
use super::{FrameTime, SceneError};
use glam::DVec3;

/// A model sorted by what moves.
#[derive(Debug)]
pub(super) struct Split {
    /// Parts that are the same at all frames.
    pub still: Vec<Part>,
    /// The others.
    pub moving: Vec<Part>,
    /// Nodes to pose anew for a frame, parents first.
    pub animated: Vec<usize>,
    /// All nodes at the first frame.
    pub first: Pose,
    /// World bounds over all frames: of the vertices of still parts, of boxes about moving ones.
    pub bounds: Bounds,
}

/// Poses the model at all frames to find out what moves. A part moves when its matrices, weights or visibility are not
/// the same, bit by bit, at all of them. Parts that are hidden at all of them are left out.
///
/// # Errors
/// [`SceneError::Pose`] from any frame.
pub(super) fn split(model: &Model, frames: &[FrameTime]) -> Result<Split, SceneError> {
    let rig = Rig::of(model);
    let first_s = frames.first().map_or(0.0, |frame| frame.time_s);
    let first = Pose::at(&model.nodes, first_s)?;
    let animated = animated_nodes(&model.nodes);
    let mut is_animated = vec![false; model.nodes.len()];
    for &node in &animated {
        is_animated[node] = true;
    }
    let (candidates, mut still): (Vec<Part>, Vec<Part>) =
        model.parts.iter().partition(|part| rig.may_move(part, &is_animated));
    let mut watched: Vec<Watched> = candidates.iter().map(|part| Watched::new(rig, part, &first, first_s)).collect();
    let mut pose = first.clone();
    for frame in frames {
        pose.move_to(&model.nodes, animated.iter().copied(), frame.time_s)?;
        watched.iter_mut().for_each(|watched| watched.look(rig, &pose, frame.time_s));
    }
    let mut bounds = Bounds::EMPTY;
    let mut moving = Vec::new();
    for watched in watched {
        if watched.moves {
            moving.push(*watched.part);
            bounds.extend(watched.swept.ends());
        } else {
            still.push(*watched.part);
        }
    }
    still.retain(|part| !first.hidden[part.node]);
    for part in &still {
        bounds.extend(rig.state(part, &first, first_s).bounds(rig.mesh(part)).ends());
    }
    Ok(Split { still, moving, animated, first, bounds })
}

/// A part that may move.
struct Watched<'a> {
    part: &'a Part,
    first: PartState,
    hulls: Hulls,
    moves: bool,
    /// Holds all vertices at all frames looked at.
    swept: Bounds,
}

impl<'a> Watched<'a> {
    fn new(rig: Rig<'_>, part: &'a Part, pose: &Pose, time_s: f64) -> Self {
        let first = rig.state(part, pose, time_s);
        Watched { part, hulls: Hulls::of(rig.mesh(part), &first), first, moves: false, swept: Bounds::EMPTY }
    }

    fn look(&mut self, rig: Rig<'_>, pose: &Pose, time_s: f64) {
        let state = rig.state(self.part, pose, time_s);
        self.moves |= state != self.first;
        if !state.hidden {
            self.hulls.sweep(&state, &mut self.swept);
        }
    }
}

/// Boxes in mesh space that hold all that a matrix moves. A skinned vertex is a mean of its joints' images of it, so it
/// lies within the union of the images of the joints' boxes; a morphed one within its box widened by weighted boxes of
/// the targets' deltas.
struct Hulls {
    /// By matrix; empty where a matrix moves nothing.
    boxes: Vec<Bounds>,
    /// By morph target, the box of its deltas and of zero.
    deltas: Vec<Bounds>,
}

impl Hulls {
    fn of(mesh: &Mesh, state: &PartState) -> Self {
        let own = state.matrices().len() - 1;
        let mut boxes = vec![Bounds::EMPTY; own + 1];
        for (index, &vertex) in mesh.vertices.iter().enumerate() {
            match mesh.influences.as_ref().filter(|_| own > 0).map(|influences| influences.of(index)) {
                None | Some([]) => boxes[own].extend([vertex]),
                Some(entries) => entries.iter().for_each(|&(joint, _)| boxes[usize::from(joint)].extend([vertex])),
            }
        }
        let delta = |target: &Vec<(u32, DVec3)>| Bounds::of(target.iter().map(|&(_, d)| d).chain([DVec3::ZERO]));
        Hulls { boxes, deltas: mesh.targets.iter().map(delta).collect() }
    }

    fn sweep(&self, state: &PartState, swept: &mut Bounds) {
        let (mut low, mut high) = (DVec3::ZERO, DVec3::ZERO);
        for (delta, &weight) in self.deltas.iter().zip(state.weights()) {
            let [a, b] = [weight * delta.min, weight * delta.max];
            (low, high) = (low + a.min(b), high + a.max(b));
        }
        for (hull, matrix) in self.boxes.iter().zip(state.matrices()).filter(|(hull, _)| !hull.is_empty()) {
            let hull = Bounds { min: hull.min + low, max: hull.max + high };
            swept.extend(hull.corners().map(|corner| matrix.transform_point3(corner)));
        }
    }
}
