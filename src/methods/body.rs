//! What the warping methods share: the body they fit to, the light's own image plane, and the last refit around the body
//! and the cover.

use super::focused::view_body;
use super::plane::Plane;
use super::region::{Region, Report};
use super::scene_optimal::{minimum_area_rectangle, oriented};
use super::{Inapplicable, Inputs};
use crate::fit::{Shape, unit_square_rows};
use crate::math::LightSpace;
use crate::scene::LightKind;
use glam::{DVec2, DVec3};

/// Widest half angle of a spot whose own axis carries its image plane; a wider one looks at the body instead.
const SPOT_MAX_RAD: f64 = 80.0 * std::f64::consts::PI / 180.0;

/// View frustum ∩ light frustum ∩ scene, and the light's plane around it and the cover.
pub(super) struct Body {
    /// Vertices in front of the light, scene space.
    pub(super) vertices: Vec<DVec3>,
    /// Normalised by a similarity, so that angles of the light plane are kept.
    pub(super) plane: Plane,
}

/// Which rectangle is fitted around what is covered.
pub(super) enum Rectangle {
    /// Along the base rows.
    Axes,
    /// The smallest in the plane of the base rows.
    MinimumArea,
}

/// The body of a warping method. A spot's image plane stands on its own axis, a point light's on that of the smallest
/// cone around the body, a cube face's on the face.
pub(super) fn body(inputs: &Inputs, axis: Option<DVec3>) -> Result<Body, Inapplicable> {
    body_of(inputs, axis, view_body(inputs, axis)?)
}

/// The same of other points than the vertices of view ∩ light ∩ scene.
pub(super) fn body_of(inputs: &Inputs, axis: Option<DVec3>, vertices: Vec<DVec3>) -> Result<Body, Inapplicable> {
    may_warp(inputs)?;
    let space = light_plane(inputs, axis, &vertices)?;
    let vertices: Vec<DVec3> = vertices.into_iter().filter(|p| space.q(*p).z > 0.0).collect();
    let held: Vec<DVec3> = vertices.iter().chain(inputs.covered).copied().collect();
    let plane = covering_plane(inputs, space, &held)?;
    Ok(Body { vertices, plane })
}

/// A warp needs something to cover and a renderer that carries it.
pub(super) fn may_warp(inputs: &Inputs) -> Result<(), Inapplicable> {
    if inputs.shape != Shape::Projective {
        return Err(Inapplicable::ShapeForbidsWarp);
    }
    if inputs.covered.is_empty() { Err(Inapplicable::Empty) } else { Ok(()) }
}

/// The image plane of a light for what it has to show.
pub(super) fn light_plane(inputs: &Inputs, axis: Option<DVec3>, points: &[DVec3]) -> Result<LightSpace, Inapplicable> {
    let centre = super::lixel::centre(points);
    Ok(match (axis, inputs.light.kind) {
        (Some(axis), LightKind::Point { position, .. } | LightKind::Spot { position, .. }) => {
            LightSpace::perspective(position, axis, centre)
        }
        (None, LightKind::Spot { position, direction, cone_rad, .. }) if cone_rad <= SPOT_MAX_RAD => {
            LightSpace::perspective(position, direction, centre)
        }
        _ => LightSpace::around(inputs.light, points)?,
    })
}

/// The plane around points that include the cover, all of which has to lie in front of it.
pub(super) fn covering_plane(inputs: &Inputs, space: LightSpace, held: &[DVec3]) -> Result<Plane, Inapplicable> {
    if !inputs.covered.iter().all(|p| space.q(*p).z > 0.0) {
        return Err(Inapplicable::CoveredBehindLight);
    }
    Plane::new(inputs, space, held, inputs.edges, true).ok_or(Inapplicable::NoFiniteFit)
}

impl Body {
    /// A point in the normalised coordinates of the plane.
    pub(super) fn flat(&self, point: DVec3) -> DVec2 {
        let q = self.plane.space.q(point);
        self.plane.normalisation.point(q.truncate() / q.z)
    }
}

/// Unit-square rows around the hull for base rows on normalised q, and the sides of the rectangle.
pub(super) fn square(
    hull: &[DVec2],
    base: &[DVec3; 3],
    rectangle: Rectangle,
) -> Result<([DVec3; 3], f64, f64), Inapplicable> {
    let w = |v: &DVec2| base[2].dot(v.extend(1.0));
    if !hull.iter().all(|v| w(v) > 0.0) {
        return Err(Inapplicable::StraddlesVanishingLine);
    }
    let found = match rectangle {
        Rectangle::MinimumArea => minimum_area_rectangle(hull, base),
        Rectangle::Axes => {
            let side = |row: DVec3| {
                let along = hull.iter().map(|v| row.dot(v.extend(1.0)) / w(v));
                along.clone().fold(f64::NEG_INFINITY, f64::max) - along.fold(f64::INFINITY, f64::min)
            };
            let rows = unit_square_rows(hull, base, [0.0, std::f64::consts::FRAC_PI_2]);
            rows.map(|rows| (rows, side(base[0]), side(base[1])))
        }
    };
    found.ok_or(Inapplicable::NoFiniteFit)
}

/// The region of a warp given by base rows on normalised q, refitted to the unit square.
pub(super) fn refit(
    inputs: &Inputs,
    plane: Plane,
    base: &[DVec3; 3],
    rectangle: Rectangle,
) -> Result<Region, Inapplicable> {
    let (rows, width, height) = square(&plane.hull, base, rectangle)?;
    let (rows, aspect) = oriented(rows, width, height, inputs.aspect);
    finished(plane, rows, aspect, 1)
}

/// The region of unit-square rows.
pub(super) fn finished(plane: Plane, rows: [DVec3; 3], aspect: f64, evaluations: u64) -> Result<Region, Inapplicable> {
    let report = Report::direct(&plane, evaluations);
    let region = Region::new(plane, rows, aspect, report);
    if region.h.is_finite() && aspect.is_finite() && aspect > 0.0 { Ok(region) } else { Err(Inapplicable::NoFiniteFit) }
}

/// Values closer than this part of the largest magnitude count as one: rounding of a body's vertices.
const TIE: f64 = 1e-9;

/// The point of least value; the mean of several.
pub(super) fn least(points: &[DVec3], value: impl Fn(DVec3) -> f64) -> Option<DVec3> {
    let values = || points.iter().map(|p| value(*p));
    let (lowest, most) = values().fold((f64::INFINITY, 0.0_f64), |(lo, hi), v| (lo.min(v), hi.max(v.abs())));
    let ties: Vec<DVec3> =
        points.iter().zip(values()).filter(|(_, v)| *v - lowest <= TIE * most).map(|(p, _)| *p).collect();
    (!ties.is_empty()).then(|| super::lixel::centre(&ties))
}
