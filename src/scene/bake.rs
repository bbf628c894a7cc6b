//! The scene's origin, and triangles in scene space.

use super::instance::{self, Instance, Shared};
use super::marks::Marks;
use super::mesh::has_area;
use super::model::Part;
use super::pose::Pose;
use super::rig::Rig;
use super::{SceneError, Triangle, tasks};
use glam::DVec3;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering::Relaxed};

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
    pub(super) const EMPTY: Bounds = Bounds { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };

    /// The least box that holds points.
    pub(super) fn of(points: impl IntoIterator<Item = DVec3>) -> Self {
        let mut bounds = Bounds::EMPTY;
        bounds.extend(points);
        bounds
    }

    /// Takes points in.
    pub(super) fn extend(&mut self, points: impl IntoIterator<Item = DVec3>) {
        for point in points {
            self.min = self.min.min(point);
            self.max = self.max.max(point);
        }
    }

    /// True when nothing has been taken in.
    pub(super) fn is_empty(&self) -> bool {
        self.min.x > self.max.x
    }

    /// Least and greatest corner; none when empty.
    pub(super) fn ends(&self) -> Vec<DVec3> {
        if self.is_empty() { Vec::new() } else { vec![self.min, self.max] }
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
}

/// Triangles in scene space, and their marks.
#[derive(Debug, Default)]
pub(super) struct Placed {
    /// In the order of their parts.
    pub triangles: Vec<Triangle>,
    /// Of the triangles.
    pub marks: Marks,
    /// Shared meshes.
    pub instances: Vec<Instance>,
    /// Triangles left out because they have no area, by rounding to f32, a scale of zero or a deformation.
    pub dropped: usize,
}

impl Placed {
    /// Numbers the triangles of instances, after those listed.
    pub(super) fn number(&mut self) {
        let mut first = self.triangles.len() as u32;
        for instance in &mut self.instances {
            instance.first = first;
            first += instance.count;
        }
    }
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

/// Appends the triangles of a part in scene space, or its instance where its mesh is shared. A hidden part has none. Under a
/// mirroring matrix the winding is turned, so that fronts stay fronts.
///
/// # Errors
/// [`SceneError::Pose`] when a vertex overflows f32.
pub(super) fn place_part(
    rig: Rig<'_>,
    shared: &Shared,
    part: &Part,
    pose: &Pose,
    origin: DVec3,
    time_s: f64,
    out: &mut Placed,
) -> Result<(), SceneError> {
    let (state, mesh) = (rig.state(part, pose, time_s), rig.mesh(part));
    if state.hidden {
        return Ok(());
    }
    if let Some(mesh) = shared.of(part) {
        let (instance, dropped) = instance::place(rig, part, &state, mesh, origin, time_s)?;
        out.instances.extend(instance);
        out.dropped += dropped;
        return Ok(());
    }
    let overflows = AtomicBool::new(false);
    let placed = state.vertices(mesh, |v| {
        let v = (v - origin).as_vec3();
        if !v.is_finite() {
            overflows.store(true, Relaxed);
        }
        v
    });
    if overflows.into_inner() {
        let problem = "a vertex overflows; check the scales above it, its joints and its morph weights";
        return Err(rig.node(part).pose_error(problem, time_s));
    }
    let mirrored = state.mirrors();
    let before = out.triangles.len();
    let dropped = AtomicUsize::new(0);
    tasks::extend(&mut out.triangles, mesh.triangles.len(), |k| {
        let [a, b, c] = mesh.triangles[k];
        let [b, c] = if mirrored { [c, b] } else { [b, c] };
        let [a, b, c] = [placed[a as usize], placed[b as usize], placed[c as usize]];
        if !has_area([a.as_dvec3(), b.as_dvec3(), c.as_dvec3()]) {
            dropped.fetch_add(1, Relaxed);
        }
        [a, b, c]
    });
    let dropped = dropped.into_inner();
    out.dropped += dropped;
    if dropped == 0 {
        out.marks.append(&mesh.marks, mirrored);
        return Ok(());
    }
    let mut kept = before;
    for (k, number) in (before..out.triangles.len()).zip(0_u32..) {
        let corners = out.triangles[k];
        if has_area(corners.map(|v| v.as_dvec3())) {
            out.triangles[kept] = corners;
            kept += 1;
            let mark = mesh.marks.get(number);
            out.marks.push(if mirrored { mark.turned() } else { mark });
        }
    }
    out.triangles.truncate(kept);
    Ok(())
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
