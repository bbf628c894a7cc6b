//! Rays through a frame: the still triangles of the shot and the moving ones of the moment.

use glam::DVec3;

use super::bvh::Bvh;
use super::ray::SceneRay;
use super::simd::Simd;
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
    /// `still` must have been built over `geometry.still`, once for the shot; `moving` over `geometry.moving`, for this
    /// frame.
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

    /// The first triangle, of either orientation, with `t_min ≤ t ≤ t_max` along `origin + t × direction`. The direction
    /// may have any length, `t_max` may be infinite. `None` also for a ray that is not finite.
    pub fn closest(&self, origin: DVec3, direction: DVec3, t_min: f64, t_max: f64) -> Option<Hit> {
        let ray = SceneRay { origin, direction, t_min, t_max };
        let still = self.simd.closest(self.still, &ray);
        let Some(bvh) = self.moving else { return still };
        let up_to_still = SceneRay { t_max: still.map_or(t_max, |hit| hit.t), ..ray };
        let moving = self.simd.closest(bvh, &up_to_still);
        let moving = moving.map(|hit| Hit { triangle: hit.triangle + self.geometry.still.len() as u32, ..hit });
        match (still, moving) {
            (Some(a), Some(b)) => Some(if b.t < a.t { b } else { a }),
            (one, other) => one.or(other),
        }
    }

    /// True when any triangle, of either orientation, lies at `t_min ≤ t ≤ t_max`. False for a ray that is not finite.
    pub fn occluded(&self, origin: DVec3, direction: DVec3, t_min: f64, t_max: f64) -> bool {
        let ray = SceneRay { origin, direction, t_min, t_max };
        self.simd.occluded(self.still, &ray) || self.moving.is_some_and(|bvh| self.simd.occluded(bvh, &ray))
    }
}
