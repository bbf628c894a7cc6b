//! What the depth range of a map has to hold: receivers that look it up, and casters between them and the light.
//!
//! Kept is a polygon of each triangle: the part inside the map's square, in front of the light and not behind every
//! receiver. Receivers lie on triangles, so the polygons hold them. The polygons are never listed: what the depth row
//! asks for is the point with the largest value of a fraction, and whole boxes of triangles can be passed over that lie
//! outside or whose corners stay below the best point so far. Linear-fractional functions are largest at the corners of
//! convex sets, and α·v/β·v > r is the linear inequality (α - r β)·v > 0.

use super::visible::{Visible, most};
use crate::math::{Domain, LightSpace};
use crate::visibility::{Part, Tracer};
use glam::{DMat3, DVec3, DVec4};

/// What a map keeps, as homogeneous vectors v = (q, e) with w = p4·q > 0. e is the distance along the light from the
/// plane's centre, metres; the constant 1 is then a function of v too, (q3 - e) / (distance of the centre). Of a lamp 10¹²
/// scenes away, q3 alone would keep no digits of it. Where the centre does not lie before a lamp, e is 1.
#[derive(Clone, Debug)]
pub struct Kept<'a> {
    /// Absent when the points are all listed in `few`.
    tracer: Option<&'a Tracer<'a>>,
    pub(super) space: LightSpace,
    pub(super) p4: DVec3,
    /// Half-spaces on v inside which a point is kept.
    planes: [DVec4; 6],
    /// The same on (X, 1).
    scene_planes: [DVec4; 6],
    /// A thinned set of the receivers.
    pub(super) few: Vec<DVec4>,
    empty: bool,
}

/// Smallest w kept, relative to the largest among receivers. A caster nearer the light than this is cut at it: f32 depth
/// (24 bits) can not hold both it and the receivers.
const W_MIN: f64 = 1e-6;
/// Room left around the unit square for casters, so that a texel centre at the border still meets them.
const BORDER: f64 = 0.01;
/// Receivers that are looked at one by one. They only start the searches.
const FEW: usize = 1024;

/// Part of the way from a lamp to the plane's centre that has to run along the plane's axis for e to be the distance along
/// it: 1 is then known to within 16 roundings.
const AHEAD: f64 = 1.0 / 16.0;

/// Whether e is the distance along the light rather than 1.
fn e_is_along(space: &LightSpace) -> bool {
    space.directional || space.offset.z > AHEAD * space.offset.length()
}

/// The v of a scene point.
pub(super) fn vector(space: &LightSpace, p: DVec3) -> DVec4 {
    space.q(p).extend(if e_is_along(space) { space.along(p) } else { 1.0 })
}

/// The constant 1 as a row on v.
pub(super) fn constant(space: &LightSpace) -> DVec4 {
    match (space.directional, e_is_along(space)) {
        (true, _) => DVec4::Z,
        (false, true) => DVec4::new(0.0, 0.0, 1.0 / space.offset.z, -1.0 / space.offset.z),
        (false, false) => DVec4::W,
    }
}

/// v of the point on a lamp's ray through that of `v`, so many times as far from the lamp: q is proportional to the distance,
/// and e of the lamp is that where q3 is 0.
pub(super) fn along_its_ray(space: &LightSpace, v: DVec4, times: f64) -> DVec4 {
    let e = if e_is_along(space) { (v.w + space.offset.z) * times - space.offset.z } else { 1.0 };
    (v.truncate() * times).extend(e)
}

impl<'a> Kept<'a> {
    /// What the map `h` keeps when `visible` points in its domain and square look it up, lit ones too.
    pub fn new(tracer: &'a Tracer<'a>, space: &LightSpace, h: &DMat3, visible: &Visible, domain: &Domain) -> Kept<'a> {
        let (p1, p2, p4) = (h.row(0), h.row(1), h.row(2));
        let holds = |p: DVec3| {
            let m = *h * space.q(p);
            domain.holds(p) && m.z > 0.0 && m.x >= 0.0 && m.x <= m.z && m.y >= 0.0 && m.y <= m.z
        };
        let square = [p4, p1, p4 - p1, p2, p4 - p2].map(|row| space.row_from_q(row));
        let few = visible.few(FEW, &holds);
        let depth_row = if space.directional { space.along_row() } else { space.row_from_q(p4) };
        let farthest = visible.largest(depth_row, &square, &holds, f64::NEG_INFINITY);
        let w_most = visible.largest(space.row_from_q(p4), &square, &holds, 0.0);
        let grown = 1.0 + BORDER;
        let one = constant(space);
        let behind = if space.directional { one * farthest - DVec4::W } else { (-p4).extend(0.0) + one * farthest };
        let planes = [
            behind,
            (p1 + p4 * BORDER).extend(0.0),
            (p4 * grown - p1).extend(0.0),
            (p2 + p4 * BORDER).extend(0.0),
            (p4 * grown - p2).extend(0.0),
            p4.extend(0.0) - if space.directional { DVec4::ZERO } else { one * (W_MIN * w_most) },
        ];
        let mut kept = Kept {
            tracer: Some(tracer),
            space: *space,
            p4,
            planes,
            scene_planes: planes,
            few: Vec::new(),
            empty: w_most <= 0.0,
        };
        if !kept.empty {
            kept.scene_planes = planes.map(|plane| kept.scene_row(plane));
            kept.few = few.iter().map(|p| kept.vector(*p)).filter(|v| kept.w(*v) > 0.0).collect();
        }
        kept
    }

    /// What lies in the hull of points v/w, v/w under the same homography.
    pub fn of_points(space: &LightSpace, h: &DMat3, points: Vec<DVec4>) -> Kept<'a> {
        let planes = [DVec4::ZERO; 6];
        let empty = points.is_empty();
        Kept { tracer: None, space: *space, p4: h.row(2), planes, scene_planes: planes, few: points, empty }
    }

    /// True when nothing visible looks the map up.
    pub fn is_empty(&self) -> bool {
        self.empty
    }

    pub(super) fn w(&self, v: DVec4) -> f64 {
        v.truncate().dot(self.p4)
    }

    fn vector(&self, p: DVec3) -> DVec4 {
        vector(&self.space, p)
    }

    /// The constant 1 as a row on v.
    pub(super) fn one(&self) -> DVec4 {
        constant(&self.space)
    }

    /// A row on (X, 1) from one on v.
    pub(super) fn scene_row(&self, row: DVec4) -> DVec4 {
        let e_row = if e_is_along(&self.space) { self.space.along_row() } else { DVec4::W };
        self.space.row_from_q(row.truncate()) + e_row * row.w
    }

    /// The kept point with the largest α·v/β·v, β·v > 0, if that is above `least`; `slack` is a gain that does not matter.
    pub(super) fn largest(&self, alpha: DVec4, beta: DVec4, least: f64, slack: f64) -> Option<(f64, DVec4)> {
        let mut best: Option<(f64, DVec4)> = None;
        let mut bar = least;
        let Some(tracer) = self.tracer else {
            for v in &self.few {
                let value = alpha.dot(*v) / beta.dot(*v);
                if value > bar {
                    (bar, best) = (value, Some((value, *v)));
                }
            }
            return best;
        };
        let (top, bottom) = (self.scene_row(alpha), self.scene_row(beta));
        let mut row = if bar.is_finite() { top - bottom * (bar + slack) } else { DVec4::ZERO };
        let mut polygon = Polygon::default();
        let geometry = tracer.geometry();
        tracer.walk(|part| match part {
            Part::Box(corners) => {
                (!bar.is_finite() || most(row, corners) > 0.0)
                    && self.scene_planes.iter().all(|plane| most(*plane, corners) >= 0.0)
            }
            Part::Triangle(index) => {
                polygon.clip(geometry.triangle_f64(index).map(|p| self.vector(p)), &self.planes);
                for v in &polygon.corners {
                    let value = alpha.dot(*v) / beta.dot(*v);
                    if value > bar && value.is_finite() && self.w(*v) > 0.0 {
                        bar = value;
                        best = Some((value, *v));
                        row = top - bottom * (bar + slack);
                    }
                }
                true
            }
        });
        best
    }
}

#[cfg(test)]
impl Kept<'_> {
    /// Every kept corner of every triangle.
    pub(super) fn list(&self) -> Vec<DVec4> {
        let Some(tracer) = self.tracer else { return self.few.clone() };
        let geometry = tracer.geometry();
        let mut polygon = Polygon::default();
        let mut all = Vec::new();
        for index in 0..geometry.len() as u32 {
            polygon.clip(geometry.triangle_f64(index).map(|p| self.vector(p)), &self.planes);
            all.extend(polygon.corners.iter().filter(|v| self.w(**v) > 0.0));
        }
        all
    }
}

/// Scratch of clipping.
#[derive(Default)]
pub(super) struct Polygon {
    pub(super) corners: Vec<DVec4>,
    clipped: Vec<DVec4>,
}

impl Polygon {
    /// The part of a triangle inside half-spaces.
    pub(super) fn clip(&mut self, triangle: [DVec4; 3], planes: &[DVec4]) {
        self.corners.clear();
        self.corners.extend(triangle);
        for plane in planes {
            if self.corners.iter().all(|c| plane.dot(*c) >= 0.0) {
                continue;
            }
            self.clipped.clear();
            for i in 0..self.corners.len() {
                let (a, b) = (self.corners[i], self.corners[(i + 1) % self.corners.len()]);
                let (da, db) = (plane.dot(a), plane.dot(b));
                if da >= 0.0 {
                    self.clipped.push(a);
                }
                if (da >= 0.0) != (db >= 0.0) {
                    self.clipped.push(a + (b - a) * (da / (da - db)));
                }
            }
            std::mem::swap(&mut self.corners, &mut self.clipped);
        }
    }
}
