//! Still and moving parts, the scene's origin, and triangles in scene space.

use super::marks::Marks;
use super::mesh::has_area;
use super::model::{Mesh, Model, Node, Part};
use super::pose::{Pose, animated_nodes};
use super::{FrameTime, SceneError, Triangle};
use glam::{DAffine3, DVec3};

/// Largest rounding of a vertex to f32 that is accepted, relative to the diagonal of the scene, before the scene is
/// moved to an origin of its own: 2^-20 ≈ 1e-6, a thousandth of a pixel in a view of the whole scene at 1000 pixels.
const MAX_ROUNDING_OF_DIAGONAL: f64 = 1.0 / (1 << 20) as f64;

/// Half a unit in the last place of f32, relative to the number: the most that rounding moves it.
const F32_ROUNDING: f64 = 1.0 / (1 << 24) as f64;

/// A box along the axes; empty when min > max.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    /// Least coordinates.
    pub min: DVec3,
    /// Greatest coordinates.
    pub max: DVec3,
}

impl Bounds {
    const EMPTY: Bounds = Bounds { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };

    fn of(points: impl IntoIterator<Item = DVec3>) -> Self {
        let mut bounds = Bounds::EMPTY;
        bounds.extend(points);
        bounds
    }

    fn extend(&mut self, points: impl IntoIterator<Item = DVec3>) {
        for point in points {
            self.min = self.min.min(point);
            self.max = self.max.max(point);
        }
    }

    /// All eight; of no meaning when empty.
    pub(super) fn corners(&self) -> [DVec3; 8] {
        std::array::from_fn(|k| {
            let pick = |axis: usize| if k >> axis & 1 == 0 { self.min[axis] } else { self.max[axis] };
            DVec3::new(pick(0), pick(1), pick(2))
        })
    }

    /// Corner to corner, metres.
    pub(super) fn diagonal(&self) -> f64 {
        (self.max - self.min).length()
    }

    /// Centre and radius of the sphere about the centre of the points' box that holds them all.
    pub(super) fn sphere<I: Iterator<Item = DVec3>>(points: impl Fn() -> I) -> (DVec3, f64) {
        let bounds = Bounds::of(points());
        let centre = bounds.min.midpoint(bounds.max);
        (centre, points().map(|p| p.distance_squared(centre)).fold(0.0, f64::max).sqrt())
    }
}

/// A model sorted by what moves.
#[derive(Debug)]
pub(super) struct Split {
    /// Parts whose world matrix is the same at all frames.
    pub still: Vec<Part>,
    /// The others.
    pub moving: Vec<Part>,
    /// Nodes to pose anew for a frame, parents first.
    pub animated: Vec<usize>,
    /// All nodes at the first frame.
    pub first: Pose,
    /// World bounds over all frames: of the vertices of still parts, of the boxes of moving ones.
    pub bounds: Bounds,
}

/// Poses the model at all frames to find out what moves. A part moves when its world matrix is not the same, bit by
/// bit, at all of them.
///
/// # Errors
/// [`SceneError::Pose`] from any frame.
pub(super) fn split(model: &Model, frames: &[FrameTime]) -> Result<Split, SceneError> {
    let first_s = frames.first().map_or(0.0, |frame| frame.time_s);
    let first = Pose::at(&model.nodes, first_s)?;
    let animated = animated_nodes(&model.nodes);
    let mut may_move = vec![false; model.nodes.len()];
    for &node in &animated {
        may_move[node] = true;
    }
    let candidates: Vec<Part> = model.parts.iter().copied().filter(|part| may_move[part.node]).collect();
    let boxes: Vec<[DVec3; 8]> =
        candidates.iter().map(|part| Bounds::of(model.meshes[part.mesh].vertices.iter().copied()).corners()).collect();
    let mut moves = vec![false; model.nodes.len()];
    let mut swept = vec![Bounds::EMPTY; candidates.len()];
    let mut pose = first.clone();
    for frame in frames {
        pose.move_to(&model.nodes, animated.iter().copied(), frame.time_s)?;
        for ((part, corners), swept) in candidates.iter().zip(&boxes).zip(&mut swept) {
            let world = &pose.world_from_node[part.node];
            moves[part.node] |= *world != first.world_from_node[part.node];
            swept.extend(corners.iter().map(|&corner| world.transform_point3(corner)));
        }
    }
    let (moving, still): (Vec<Part>, Vec<Part>) = model.parts.iter().partition(|part| moves[part.node]);
    let mut bounds = Bounds::EMPTY;
    for part in &still {
        let world = &first.world_from_node[part.node];
        bounds.extend(model.meshes[part.mesh].vertices.iter().map(|&v| world.transform_point3(v)));
    }
    for (part, swept) in candidates.iter().zip(&swept) {
        if moves[part.node] && !model.meshes[part.mesh].vertices.is_empty() {
            bounds.extend([swept.min, swept.max]);
        }
    }
    Ok(Split { still, moving, animated, first, bounds })
}

/// Triangles in scene space, and their marks.
#[derive(Debug, Default)]
pub(super) struct Placed {
    /// In the order of their parts.
    pub triangles: Vec<Triangle>,
    /// Of the triangles.
    pub marks: Marks,
}

/// Where scene space has its zero, world metres. Along each axis it is the world's, unless f32 vertices would then be
/// rounded by more than [`MAX_ROUNDING_OF_DIAGONAL`]; else the centre of the bounds, rounded to a multiple of the
/// greatest power of two that is at most the diagonal: such a number is short in decimal and exact in f32.
pub(super) fn origin(bounds: &Bounds) -> DVec3 {
    let diagonal = bounds.diagonal();
    let step = diagonal.log2().floor().exp2();
    let along = |axis: usize| {
        let (min, max) = (bounds.min[axis], bounds.max[axis]);
        let rounding = min.abs().max(max.abs()) * F32_ROUNDING;
        let centre = (min.midpoint(max) / step).round() * step;
        if rounding > MAX_ROUNDING_OF_DIAGONAL * diagonal && centre.is_finite() { centre } else { 0.0 }
    };
    DVec3::new(along(0), along(1), along(2))
}

/// Appends the triangles of a part in scene space; returns how many were dropped because rounding to f32 (or a scale of
/// zero) left them without area. Under a mirroring matrix the winding is turned, so that fronts stay fronts.
///
/// # Errors
/// [`SceneError::Pose`] when a vertex overflows f32.
pub(super) fn place_part(
    node: &Node,
    mesh: &Mesh,
    world_from_node: &DAffine3,
    origin: DVec3,
    time_s: f64,
    out: &mut Placed,
) -> Result<usize, SceneError> {
    let placed: Vec<_> =
        mesh.vertices.iter().map(|&v| (world_from_node.transform_point3(v) - origin).as_vec3()).collect();
    if !placed.iter().all(|v| v.is_finite()) {
        return Err(node.pose_error("a vertex overflows; check the scales above it", time_s));
    }
    let mirrored = world_from_node.matrix3.determinant() < 0.0;
    let before = out.triangles.len();
    for (&[a, b, c], k) in mesh.triangles.iter().zip(0_u32..) {
        let [b, c] = if mirrored { [c, b] } else { [b, c] };
        let corners = [a, b, c].map(|index| placed[index as usize]);
        if has_area(corners.map(|v| v.as_dvec3())) {
            out.triangles.push(corners);
            let mark = mesh.marks.get(k);
            out.marks.push(if mirrored { mark.turned() } else { mark });
        }
    }
    Ok(mesh.triangles.len() - (out.triangles.len() - before))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_origin_moves_only_for_far_scenes() {
        let bounds = |centre: DVec3, half: f64| Bounds { min: centre - half, max: centre + half };
        assert_eq!(origin(&bounds(DVec3::ZERO, 10.0)), DVec3::ZERO);
        assert_eq!(origin(&bounds(DVec3::new(100.0, 0.0, 0.0), 10.0)), DVec3::ZERO);
        let far = DVec3::new(500_123.4, -20.0, 4_800_456.7);
        let moved = origin(&bounds(far, 10.0));
        assert!((moved - far).abs().max_element() <= 20.0);
        assert_eq!(moved, DVec3::new(500_128.0, 0.0, 4_800_448.0));
        assert_eq!(moved.as_vec3().as_dvec3(), moved);
        assert_eq!(origin(&Bounds::EMPTY), DVec3::ZERO);
    }
}
