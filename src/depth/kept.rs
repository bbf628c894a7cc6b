//! What the depth range of a map has to hold: receivers that look it up, and casters between them and the light.

use crate::math::LightSpace;
use crate::scene::Geometry;
use glam::{DMat3, DVec3, DVec4};
use rayon::prelude::*;

/// Homogeneous vectors (q, e) of what is kept, e = 1 for point and spot lights and metres along the light for
/// directional ones, each with w = p4·q > 0.
#[derive(Clone, Debug, Default)]
pub struct Kept {
    /// Vectors (q, e).
    pub points: Vec<DVec4>,
    /// Smallest and largest depth along the light, metres from the light (point, spot) or from the plane's centre.
    pub range_m: [f64; 2],
    /// Triangles that hold a kept caster.
    pub casters: u64,
}

/// Directions in which the extremes of merged points are kept.
const DIRECTIONS: usize = 400;
/// Points between those directions may stand out of the hull of the extremes: it is widened by this part of its extent. A
/// smooth body stands out by 1 - cos of half the angle between neighbouring directions, 0.3 % for 400 of them.
const WIDENED: f64 = 0.01;

impl Kept {
    /// Adds what another frame keeps under the same homography, in the same light's frame. Of both only the extremes stay:
    /// what the depth row depends on is the convex hull of (q, e) / w.
    pub fn merge(&mut self, other: &Kept, h: &DMat3) {
        let p4 = h.row(2);
        if !other.points.is_empty() {
            self.points.extend(extremes(&other.points, p4));
            let [low, high] = if self.range_m == [0.0; 2] { other.range_m } else { self.range_m };
            self.range_m = [low.min(other.range_m[0]), high.max(other.range_m[1])];
        }
        self.casters = self.casters.max(other.casters);
    }
}

/// Extremes of points (q, e) / w, widened about their mean, which like all of them has w = 1.
fn extremes(points: &[DVec4], p4: DVec3) -> Vec<DVec4> {
    let scaled: Vec<DVec4> = points.iter().map(|v| *v / v.truncate().dot(p4)).collect();
    let low = scaled.iter().fold(DVec4::INFINITY, |m, v| m.min(*v));
    let high = scaled.iter().fold(DVec4::NEG_INFINITY, |m, v| m.max(*v));
    let mean = scaled.iter().fold(DVec4::ZERO, |s, v| s + *v / scaled.len() as f64);
    let scale = (high - low).map(|e| if e > 0.0 { 1.0 / e } else { 0.0 });
    let chosen: Vec<usize> = (0..DIRECTIONS)
        .into_par_iter()
        .filter_map(|k| {
            let direction = direction(k) * scale;
            let farther = |b: usize, i: usize| if scaled[i].dot(direction) > scaled[b].dot(direction) { i } else { b };
            (0..scaled.len()).reduce(farther)
        })
        .collect();
    let mut chosen = chosen;
    chosen.sort_unstable();
    chosen.dedup();
    // Of a point light e = 1/w: a widened far end stays in front of infinity.
    let least = if low.w > 0.0 { 0.5 * low.w } else { f64::NEG_INFINITY };
    let widened = |i: usize| {
        let v = mean + (scaled[i] - mean) * (1.0 + WIDENED);
        DVec4::new(v.x, v.y, v.z, v.w.max(least))
    };
    chosen.into_iter().map(widened).collect()
}

/// Directions spread over the 4-sphere: both signs of each axis, then a Weyl sequence through the normal distribution's
/// Box-Muller pairs.
fn direction(k: usize) -> DVec4 {
    if k < 8 {
        let mut axis = DVec4::ZERO;
        axis[k / 2] = if k.is_multiple_of(2) { 1.0 } else { -1.0 };
        return axis;
    }
    // Roberts 2018: powers of the root of x^5 = x + 1 spread best in four dimensions.
    const ROOT: f64 = 1.167_303_978_261_418_7;
    let u: [f64; 4] = std::array::from_fn(|i| (0.5 + k as f64 * ROOT.powi(-(i as i32 + 1))).fract());
    let pair = |a: f64, b: f64| {
        let radius = (-2.0 * (1.0 - a).ln()).sqrt();
        let (s, c) = (std::f64::consts::TAU * b).sin_cos();
        (radius * c, radius * s)
    };
    let ((x, y), (z, w)) = (pair(u[0], u[1]), pair(u[2], u[3]));
    DVec4::new(x, y, z, w).normalize_or(DVec4::X)
}

/// Smallest w kept, relative to the largest among receivers. A caster nearer the light than this is cut at it: f32 depth
/// (24 bits) can not hold both it and the receivers.
const W_MIN: f64 = 1e-6;
/// Room left around the unit square for casters, so that a texel centre at the border still meets them.
const BORDER: f64 = 0.01;

/// Collects what a map keeps. `receivers` are the visible points that look the map up, lit ones too.
pub fn kept_points(geometry: Geometry, space: &LightSpace, h: &DMat3, receivers: &[DVec3]) -> Kept {
    let p4 = h.row(2);
    let vector = |p: DVec3| space.q(p).extend(if space.directional { space.along(p) } else { 1.0 });
    let depth = |v: DVec4| if space.directional { v.w } else { v.truncate().dot(p4) };
    let in_front: Vec<DVec4> = receivers.iter().map(|p| vector(*p)).filter(|v| v.truncate().dot(p4) > 0.0).collect();
    let farthest = in_front.iter().map(|v| depth(*v)).fold(f64::NEG_INFINITY, f64::max);
    let w_most = in_front.iter().map(|v| v.truncate().dot(p4)).fold(0.0, f64::max);
    if in_front.is_empty() {
        return Kept::default();
    }
    // Half-spaces on (q, e) inside which a caster counts: the map's square, in front of the light, not behind every
    // receiver.
    let (p1, p2) = (h.row(0), h.row(1));
    let grown = 1.0 + BORDER;
    let behind = if space.directional { DVec4::new(0.0, 0.0, farthest, -1.0) } else { (-p4).extend(farthest) };
    let planes: [DVec4; 6] = [
        p4.extend(if space.directional { 0.0 } else { -W_MIN * w_most }),
        (p1 + p4 * BORDER).extend(0.0),
        (p4 * grown - p1).extend(0.0),
        (p2 + p4 * BORDER).extend(0.0),
        (p4 * grown - p2).extend(0.0),
        behind,
    ];
    let triangles = 0..geometry.len() as u32;
    let chunks: Vec<(Vec<DVec4>, u64)> = triangles
        .into_par_iter()
        .with_min_len(8192)
        .fold(
            || (Vec::new(), 0),
            |(mut points, mut casters), index| {
                let corners = geometry.triangle_f64(index).map(vector);
                casters += u64::from(clip_into(corners, &planes, &mut points));
                (points, casters)
            },
        )
        .collect();
    let mut points = in_front;
    let mut casters = 0;
    for (found, count) in chunks {
        points.extend(found);
        casters += count;
    }
    points.retain(|v| v.is_finite() && v.truncate().dot(p4) > 0.0);
    // A point light's axes are orthonormal, so w / |p4| is in metres along the view axis.
    let range = |v: &DVec4| if space.directional { v.w } else { v.truncate().dot(p4) / p4.length() };
    let range_m =
        points.iter().map(range).fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], d| [lo.min(d), hi.max(d)]);
    Kept { points, range_m, casters }
}

/// Clips a triangle against half-spaces; pushes what is left. True when something is.
fn clip_into(corners: [DVec4; 3], planes: &[DVec4], out: &mut Vec<DVec4>) -> bool {
    let mut inside = true;
    for plane in planes {
        let d = corners.map(|c| plane.dot(c));
        if d.iter().all(|d| *d < 0.0) {
            return false;
        }
        inside &= d.iter().all(|d| *d >= 0.0);
    }
    if inside {
        out.extend(corners);
        return true;
    }
    let mut polygon = corners.to_vec();
    let mut clipped = Vec::with_capacity(9);
    for plane in planes {
        clipped.clear();
        for i in 0..polygon.len() {
            let (a, b) = (polygon[i], polygon[(i + 1) % polygon.len()]);
            let (da, db) = (plane.dot(a), plane.dot(b));
            if da >= 0.0 {
                clipped.push(a);
            }
            if (da >= 0.0) != (db >= 0.0) {
                clipped.push(a + (b - a) * (da / (da - db)));
            }
        }
        std::mem::swap(&mut polygon, &mut clipped);
        if polygon.is_empty() {
            return false;
        }
    }
    out.extend(polygon);
    true
}
