//! Rays through a frame: the still triangles of the shot and the moving ones of the moment.

use glam::DVec3;

use super::bvh::Bvh;
use super::kernel::{Ray, dominant};
use super::simd::Simd;
use super::wide::BOX_MARGIN;
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
        let in_tree = |bvh: &Bvh, first: usize, t_max: f64| {
            let (ray, parameter) = local_ray(bvh, origin, direction, t_min, t_max)?;
            let found = self.simd.nearest(&bvh.wide, &ray)?;
            let triangle = first as u32 + found.triangle;
            let t = self.refine(triangle, origin, direction, parameter.to_scene(f64::from(found.t)));
            Some(Hit { triangle, t })
        };
        let still = in_tree(self.still, 0, t_max);
        let reached = still.map_or(t_max, |hit| hit.t);
        let moving = self.moving.and_then(|bvh| in_tree(bvh, self.geometry.still.len(), reached));
        match (still, moving) {
            (Some(a), Some(b)) => Some(if b.t < a.t { b } else { a }),
            (one, other) => one.or(other),
        }
    }

    /// True when any triangle, of either orientation, lies at `t_min ≤ t ≤ t_max`. False for a ray that is not finite.
    pub fn occluded(&self, origin: DVec3, direction: DVec3, t_min: f64, t_max: f64) -> bool {
        let in_tree = |bvh: &Bvh| {
            local_ray(bvh, origin, direction, t_min, t_max).is_some_and(|(ray, _)| self.simd.any(&bvh.wide, &ray))
        };
        in_tree(self.still) || self.moving.is_some_and(in_tree)
    }

    /// Where the ray meets the triangle's plane, in f64, kept within what the triangle spans along the ray's dominant
    /// axis: seen edge-on the plane is met anywhere.
    fn refine(&self, triangle: u32, origin: DVec3, direction: DVec3, t: f64) -> f64 {
        let corners = self.geometry.triangle_f64(triangle).map(|v| v - origin);
        let [a, b, c] = corners;
        let normal = (b - a).cross(c - a);
        let exact = normal.dot(a) / normal.dot(direction);
        if !exact.is_finite() {
            return t;
        }
        let axis = dominant(direction);
        let along = corners.map(|v| v[axis] / direction[axis]);
        let low = along.into_iter().fold(f64::INFINITY, f64::min);
        let high = along.into_iter().fold(f64::NEG_INFINITY, f64::max);
        exact.max(low).min(high)
    }
}

/// Takes the kernel's parameter back to the caller's: `t = start + local × step`.
#[derive(Clone, Copy)]
struct Parameter {
    start: f64,
    step: f64,
}

impl Parameter {
    fn to_scene(self, local: f64) -> f64 {
        self.start + local * self.step
    }
}

/// The ray in a tree's stored coordinates. An origin outside the tree's bounds is moved up to them in f64, so that f32
/// holds it to the bounds' own precision however far away it starts. `None` when the ray passes the bounds by, or is not
/// finite.
fn local_ray(bvh: &Bvh, origin: DVec3, direction: DVec3, t_min: f64, t_max: f64) -> Option<(Ray, Parameter)> {
    let [low, high] = bvh.bounds()?;
    let length = direction.abs().max_element();
    if !(origin.is_finite() && length.is_finite() && length > 0.0 && t_min <= t_max) {
        return None;
    }
    let inside = origin.cmpge(low).all() && origin.cmple(high).all();
    let start = if inside { 0.0 } else { entry(bvh, origin, direction, t_min, t_max)? };
    let scale = bvh.scale * length;
    let local_origin = (origin + direction * start) * bvh.scale;
    let ray = Ray::new(local_origin, direction / length, (t_min - start) * scale, (t_max - start) * scale);
    Some((ray, Parameter { start, step: 1.0 / scale }))
}

/// Where the ray enters the tree's bounds, grown as its boxes are; `None` when that is not within `t_min ..= t_max`.
fn entry(bvh: &Bvh, origin: DVec3, direction: DVec3, t_min: f64, t_max: f64) -> Option<f64> {
    let [low, high] = bvh.bounds()?;
    let margin = DVec3::splat(f64::from(BOX_MARGIN) / bvh.scale);
    // A component of zero gives ±∞, or NaN on the very plane, which max and min pass over.
    let a = (low - margin - origin) / direction;
    let b = (high + margin - origin) / direction;
    let enter = (0..3).fold(f64::NEG_INFINITY, |t, axis| t.max(a[axis].min(b[axis])));
    let leave = (0..3).fold(f64::INFINITY, |t, axis| t.min(a[axis].max(b[axis])));
    (enter.max(t_min) <= leave.min(t_max) && enter.is_finite()).then_some(enter)
}
