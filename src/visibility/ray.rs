//! Rays in the coordinates of a tree: f64 in, f32 for the kernel, and f64 again where the triangle found is met.

use glam::{DVec3, Vec3, Vec4};

use super::wide::BOX_MARGIN;

/// The smallest slope of a ray against the planes of boxes, so that its inverse is finite. A ray would have to be 2⁶⁰
/// scene sizes long for it to matter.
const SLOPE_MIN: f32 = 1.0 / (1u64 << 60) as f32;

/// Shorter directions are as good as none; their inverse would overflow.
const LENGTH_MIN: f64 = 4.0 * f64::MIN_POSITIVE;

/// Largest coordinate of an origin that is left where it is: the kernel's rounding is worked out for it.
const ORIGIN_MAX: f64 = 2.0;

/// A ray as the kernel wants it, in the unit cube of the tree's stored coordinates. Its direction has ±1 on its dominant
/// axis, so its parameter is the distance along that axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ray {
    pub(super) origin: [f32; 3],
    /// 1 / direction.
    pub(super) inverse: [f32; 3],
    /// By axis: the row of a node's nearer plane; the farther one is `row ^ 1`.
    pub(super) near_row: [usize; 3],
    /// The two shear axes and the dominant one.
    pub(super) axes: [usize; 3],
    /// Direction along the shear axes over the dominant one.
    pub(super) shear: [f32; 2],
    /// ±1: the direction along the dominant axis.
    pub(super) sign: f32,
    pub(super) t_min: f32,
    pub(super) t_max: f32,
}

impl Ray {
    /// The direction has ±1 on the last of its axes.
    #[inline(always)]
    pub(super) fn new(origin: DVec3, direction: DVec3, axes: [usize; 3], [t_min, t_max]: [f64; 2]) -> Ray {
        let slope = direction.as_vec3().extend(1.0);
        let smallest = Vec4::splat(SLOPE_MIN).copysign(slope);
        let inverse = Vec4::select(slope.abs().cmplt(Vec4::splat(SLOPE_MIN)), smallest, slope).recip();
        let negative = inverse.is_negative_bitmask() as usize;
        let [kx, ky, kz] = axes;
        Ray {
            origin: origin.as_vec3().to_array(),
            inverse: [inverse.x, inverse.y, inverse.z],
            near_row: [negative & 1, 2 + (negative >> 1 & 1), 4 + (negative >> 2 & 1)],
            axes,
            shear: [slope[kx] * slope[kz], slope[ky] * slope[kz]],
            sign: slope[kz],
            t_min: t_min as f32,
            t_max: t_max as f32,
        }
    }
}

/// A caller's ray: `origin + t × direction`, `t_min ≤ t ≤ t_max`, scene space.
#[derive(Clone, Copy, Debug)]
pub(super) struct SceneRay {
    pub(super) origin: DVec3,
    pub(super) direction: DVec3,
    pub(super) t_min: f64,
    pub(super) t_max: f64,
}

/// A caller's ray brought to a tree: `t = start + local × step`.
#[derive(Clone, Copy, Debug)]
pub(super) struct LocalRay {
    pub(super) ray: Ray,
    /// What `ray` is rounded from.
    origin: DVec3,
    direction: DVec3,
    start: f64,
    step: f64,
}

impl LocalRay {
    /// An origin far outside the tree is moved up to its bounds in f64, so that f32 holds it to the bounds' own precision
    /// however far away it starts. Bounds are in scene space; stored coordinates are `stored_scale` times those. `None` when such a ray passes the bounds by, or when a ray is not finite.
    #[inline(always)]
    pub(super) fn new([low, high]: [DVec3; 2], stored_scale: f64, scene: &SceneRay) -> Option<LocalRay> {
        let &SceneRay { origin, direction, t_min, t_max } = scene;
        let axes = axes(direction);
        let length = direction[axes[2]].abs();
        if !(origin.is_finite() && direction.is_finite() && length >= LENGTH_MIN && t_min <= t_max) {
            return None;
        }
        let near_enough = (origin.abs() * stored_scale).max_element() <= ORIGIN_MAX;
        let start = if near_enough { 0.0 } else { entry([low, high], stored_scale, scene)? };
        let mut unit = direction * length.recip();
        unit[axes[2]] = 1f64.copysign(direction[axes[2]]);
        let local_origin = (origin + direction * start) * stored_scale;
        let scale = length * stored_scale;
        let range = [(t_min - start) * scale, (t_max - start) * scale];
        let ray = Ray::new(local_origin, unit, axes, range);
        Some(LocalRay { ray, origin: local_origin, direction: unit, start, step: 1.0 / scale })
    }

    /// The origin in stored coordinates, before rounding.
    pub(super) fn origin(&self) -> DVec3 {
        self.origin
    }

    /// The direction, ±1 along its dominant axis, before rounding.
    pub(super) fn direction(&self) -> DVec3 {
        self.direction
    }

    /// The caller's parameter where the ray meets the plane of the triangle found, by its stored corners and `t`, in f64; kept within what the triangle
    /// spans along the ray's dominant axis, because seen edge-on its plane is met anywhere.
    #[inline(always)]
    pub(super) fn meet(&self, corners: [Vec3; 3], t: f32) -> f64 {
        let [a, b, c] = corners;
        let (a, b, c) = (a.as_dvec3() - self.origin, b.as_dvec3() - self.origin, c.as_dvec3() - self.origin);
        let normal = (b - a).cross(c - a);
        let axis = self.ray.axes[2];
        let sign = self.direction[axis];
        let (low, high) = (a.min(b).min(c)[axis] * sign, a.max(b).max(c)[axis] * sign);
        let plane = normal.dot(a) / normal.dot(self.direction);
        let local = if plane.is_finite() { plane.max(low.min(high)).min(low.max(high)) } else { f64::from(t) };
        self.start + local * self.step
    }
}

/// Where the ray enters bounds, grown as the tree's boxes are; `None` when that is not within `t_min ..= t_max`.
#[inline(always)]
fn entry([low, high]: [DVec3; 2], scale: f64, ray: &SceneRay) -> Option<f64> {
    let margin = DVec3::splat(f64::from(BOX_MARGIN) / scale);
    // A component of zero gives ±∞, or NaN on the very plane, which max and min pass over.
    let inverse = ray.direction.recip();
    let a = (low - margin - ray.origin) * inverse;
    let b = (high + margin - ray.origin) * inverse;
    let (near, far) = (a.min(b), a.max(b));
    let enter = near.x.max(near.y).max(near.z);
    let leave = far.x.min(far.y).min(far.z);
    (enter.max(ray.t_min) <= leave.min(ray.t_max) && enter.is_finite()).then_some(enter)
}

/// The two lesser axes of a direction in cyclic order, and the dominant one.
#[inline(always)]
pub(super) fn axes(direction: DVec3) -> [usize; 3] {
    let size = direction.abs();
    if size.x >= size.y && size.x >= size.z {
        [1, 2, 0]
    } else if size.y >= size.z {
        [2, 0, 1]
    } else {
        [0, 1, 2]
    }
}
