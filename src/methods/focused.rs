//! The focused shadow map: the smallest rectangle, without a warp, around view frustum ∩ light frustum ∩ scene bounds
//! (SOSM §3, "Focused"; Mikkelsen's "fsm"). The body's vertices are found as the points where three of its planes meet.

use super::body::{Rectangle, refit};
use super::plane::Plane;
use super::region::Region;
use super::{Inapplicable, Inputs};
use crate::math::LightSpace;
use crate::scene::{LightKind, Projection};
use glam::{DMat3, DVec3, DVec4};

/// How far outside a plane a vertex of the body may lie, relative to the scene's size: rounding of plane intersections.
const INSIDE: f64 = 1e-9;
/// Sides of the pyramid around a spot's cone.
const CONE_SIDES: u32 = 8;

/// Solves one region.
pub(super) fn solve(inputs: &Inputs, axis: Option<DVec3>) -> Result<Region, Inapplicable> {
    around(inputs, axis, &view_body(inputs, axis)?)
}

/// The same around other points than the body's vertices.
pub(super) fn around(inputs: &Inputs, axis: Option<DVec3>, body: &[DVec3]) -> Result<Region, Inapplicable> {
    let space = match (axis, inputs.light.position()) {
        (Some(axis), Some(position)) => LightSpace::perspective(position, axis, inputs.bounds.center()),
        _ => LightSpace::around(inputs.light, body)?,
    };
    uniform_region(inputs, space, body, Rectangle::MinimumArea)
}

/// A region without a warp around a body: its minimum-area rectangle, or its box in the light's frame.
pub(super) fn uniform_region(
    inputs: &Inputs,
    space: LightSpace,
    body: &[DVec3],
    rectangle: Rectangle,
) -> Result<Region, Inapplicable> {
    let covered: Vec<DVec3> = body.iter().chain(inputs.covered).copied().collect();
    let plane = Plane::new(inputs, space, &covered, inputs.edges, true).ok_or(Inapplicable::NoFiniteFit)?;
    refit(inputs, plane, &[DVec3::X, DVec3::Y, DVec3::Z], rectangle)
}

/// Vertices of view frustum ∩ light frustum ∩ scene bounds ∩ the inputs' own half-spaces.
pub(super) fn view_body(inputs: &Inputs, axis: Option<DVec3>) -> Result<Vec<DVec3>, Inapplicable> {
    let mut planes = light_planes(inputs, axis, inputs.camera.world_from_camera.x_axis);
    planes.extend(view_planes(inputs));
    planes.extend(inputs.clip);
    let body = vertices(inputs, &planes);
    if body.is_empty() { Err(Inapplicable::NoCommonVolume) } else { Ok(body) }
}

/// What the light reaches of the scene's bounds.
pub(super) fn light_body(inputs: &Inputs, axis: Option<DVec3>) -> Vec<DVec3> {
    vertices(inputs, &light_planes(inputs, axis, DVec3::X))
}

/// Planes (n, d), inside where n·p + d ≥ 0: scene bounds, the spot's cone, and the cube face where there is one. The
/// pyramid around a cone has a side towards `side`, so that it turns with what that belongs to.
fn light_planes(inputs: &Inputs, axis: Option<DVec3>, side: DVec3) -> Vec<DVec4> {
    let bounds = inputs.bounds;
    let mut planes: Vec<DVec4> =
        DVec3::AXES.iter().flat_map(|a| [a.extend(-a.dot(bounds.min)), (-*a).extend(a.dot(bounds.max))]).collect();
    if let LightKind::Spot { position, direction, cone_rad, .. } = inputs.light.kind {
        let e1 = side.reject_from_normalized(direction);
        let e1 = e1.try_normalize().unwrap_or_else(|| direction.any_orthonormal_vector());
        let e2 = direction.cross(e1);
        for k in 0..CONE_SIDES {
            let (s, c) = (std::f64::consts::TAU * f64::from(k) / f64::from(CONE_SIDES)).sin_cos();
            let n = direction * cone_rad.sin() + (e1 * c + e2 * s) * cone_rad.cos();
            planes.push(n.extend(-n.dot(position)));
        }
    }
    if let (Some(axis), Some(position)) = (axis, inputs.light.position()) {
        let e1 = axis.any_orthonormal_vector();
        for side in [e1, -e1, axis.cross(e1), -axis.cross(e1)] {
            let n = (axis + side).normalize();
            planes.push(n.extend(-n.dot(position)));
        }
        // A sliver in front of the light keeps the apex out, where the plane has no point.
        let front = inputs.bounds.diagonal() * 1e-3;
        planes.push(axis.extend(-axis.dot(position) - front));
    }
    planes
}

fn view_planes(inputs: &Inputs) -> Vec<DVec4> {
    let camera = inputs.camera;
    let (w, h) = (f64::from(inputs.film.width), f64::from(inputs.film.height));
    let corners = [[0.0, 0.0], [0.0, h], [w, h], [w, 0.0]].map(|[x, y]| camera.ray(inputs.film, x, y));
    let forward = camera.forward();
    let mut planes = vec![forward.extend(-forward.dot(camera.position) - camera.near)];
    if let Some(far) = camera.far {
        planes.push((-forward).extend(forward.dot(camera.position) + far));
    }
    for i in 0..4 {
        let ((o, a), (p, b)) = (corners[i], corners[(i + 1) % 4]);
        let n = match camera.projection {
            Projection::Perspective { .. } => b.cross(a),
            Projection::Orthographic { .. } => (p - o).cross(a),
        };
        let middle = camera.ray(inputs.film, w * 0.5, h * 0.5);
        let inner = middle.0 + middle.1 * camera.near.max(1.0);
        let n = n.normalize_or_zero();
        let n = if n.dot(inner - o) < 0.0 { -n } else { n };
        planes.push(n.extend(-n.dot(o)));
    }
    planes
}

/// Vertices of the intersection of half-spaces.
fn vertices(inputs: &Inputs, planes: &[DVec4]) -> Vec<DVec3> {
    let tolerance = inputs.bounds.diagonal() * INSIDE;
    let mut found = Vec::new();
    for i in 0..planes.len() {
        for j in 0..i {
            for k in 0..j {
                let [a, b, c] = [planes[i], planes[j], planes[k]];
                let m = DMat3::from_cols(a.truncate(), b.truncate(), c.truncate()).transpose();
                let point = m.inverse() * -DVec3::new(a.w, b.w, c.w);
                let inside = |p: &DVec4| p.truncate().dot(point) + p.w >= -tolerance;
                if m.determinant().abs() > INSIDE && point.is_finite() && planes.iter().all(inside) {
                    found.push(point);
                }
            }
        }
    }
    found
}
