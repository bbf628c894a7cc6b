//! Rays through a frame: the still triangles of the shot and the moving ones of the moment.

use glam::DVec3;

use super::bvh::Bvh;
use super::ray::SceneRay;
use super::simd::Simd;
use super::solid::{Everything, InstancesWithHoles, WithHoles};
use crate::scene::Geometry;

/// What a ray meets first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Index through [`Geometry`]: still first, then moving.
    pub triangle: u32,
    /// Multiple of the ray's direction at which it meets the triangle's plane, in f64.
    pub t: f64,
}

/// One frame's rays. Which triangle a ray meets is decided in f32 by a watertight test; where it meets it, in f64.
#[derive(Clone, Copy, Debug)]
pub struct Tracer<'a> {
    geometry: Geometry<'a>,
    still: &'a Bvh,
    moving: Option<&'a Bvh>,
    simd: Simd,
}

impl<'a> Tracer<'a> {
    /// `still` must have been built over what is still in `geometry`, once for the shot; `moving` over what moves, for
    /// this frame.
    pub fn new(geometry: Geometry<'a>, still: &'a Bvh, moving: Option<&'a Bvh>) -> Self {
        Tracer { geometry, still, moving, simd: Simd::detect() }
    }

    /// The triangles.
    pub fn geometry(&self) -> Geometry<'a> {
        self.geometry
    }

    /// The trees of the still and of the moving triangles.
    pub(super) fn trees(&self) -> (&'a Bvh, Option<&'a Bvh>) {
        (self.still, self.moving)
    }

    /// Lower and upper corner of all triangles, scene space, metres; `None` when there is none.
    pub fn bounds(&self) -> Option<[DVec3; 2]> {
        let [a, b] = [self.still.bounds(), self.moving.and_then(Bvh::bounds)];
        match (a, b) {
            (Some([a, b]), Some([c, d])) => Some([a.min(c), b.max(d)]),
            (one, other) => one.or(other),
        }
    }

    /// The first triangle, of either orientation and there at the point, with `t_min ≤ t ≤ t_max` along `origin + t × direction`. The direction
    /// may have any length, `t_max` may be infinite. `None` also for a ray that is not finite.
    pub fn closest(&self, origin: DVec3, direction: DVec3, t_min: f64, t_max: f64) -> Option<Hit> {
        let ray = SceneRay { origin, direction, t_min, t_max };
        let still = self.closest_of(0, self.still, &ray);
        let Some(bvh) = self.moving else { return still };
        let moving = self.closest_of(1, bvh, &up_to(still, &ray));
        let moving = moving.map(|hit| Hit { triangle: hit.triangle + self.geometry.still_len() as u32, ..hit });
        nearer(still, moving)
    }

    /// True when any triangle, of either orientation and there at the point, lies at `t_min ≤ t ≤ t_max`. False for a ray that is not finite.
    pub fn occluded(&self, origin: DVec3, direction: DVec3, t_min: f64, t_max: f64) -> bool {
        let ray = SceneRay { origin, direction, t_min, t_max };
        self.occluded_by(0, self.still, &ray) || self.moving.is_some_and(|bvh| self.occluded_by(1, bvh, &ray))
    }

    /// What the kernel asks of hits in the still (0) or moving (1) triangles, where some have holes.
    fn with_holes<'b>(&'b self, list: usize, ray: &'b SceneRay) -> Option<WithHoles<'b>> {
        let marks = self.geometry.marks[list];
        let triangles = self.geometry.listed(list);
        (!marks.cut().is_empty()).then_some(WithHoles { ray, triangles, marks, masks: self.geometry.masks })
    }

    fn closest_of(&self, list: usize, bvh: &Bvh, ray: &SceneRay) -> Option<Hit> {
        let listed = match self.with_holes(list, ray) {
            None => self.simd.closest(bvh, ray, &Everything),
            Some(holes) => self.simd.closest(bvh, ray, &holes),
        };
        if bvh.top.instances.is_empty() {
            return listed;
        }
        nearer(listed, self.through::<false>(list, bvh, &up_to(listed, ray)))
    }

    fn occluded_by(&self, list: usize, bvh: &Bvh, ray: &SceneRay) -> bool {
        let listed = match self.with_holes(list, ray) {
            None => self.simd.occluded(bvh, ray, &Everything),
            Some(holes) => self.simd.occluded(bvh, ray, &holes),
        };
        listed || (!bvh.top.instances.is_empty() && self.through::<true>(list, bvh, ray).is_some())
    }

    /// The nearest, or with `ANY` any, triangle of a list's instances.
    fn through<const ANY: bool>(&self, list: usize, bvh: &Bvh, ray: &SceneRay) -> Option<Hit> {
        let instances = (&bvh.top, self.still.meshes.as_slice());
        if self.geometry.meshes.iter().all(|mesh| mesh.marks.cut().is_empty()) {
            return self.simd.through::<ANY>(instances, ray, &Everything);
        }
        let begin = if list == 0 { 0 } else { self.geometry.still_len() as u32 };
        self.simd.through::<ANY>(instances, ray, &InstancesWithHoles { ray, geometry: self.geometry, begin })
    }
}

/// A ray that ends at a hit.
fn up_to(hit: Option<Hit>, ray: &SceneRay) -> SceneRay {
    SceneRay { t_max: hit.map_or(ray.t_max, |hit| hit.t), ..*ray }
}

/// The nearer of two hits; the first of two equally near.
fn nearer(a: Option<Hit>, b: Option<Hit>) -> Option<Hit> {
    match (a, b) {
        (Some(a), Some(b)) => Some(if b.t < a.t { b } else { a }),
        (one, other) => one.or(other),
    }
}
