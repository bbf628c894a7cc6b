//! Light space perspective shadow maps: Wimmer, Scherzer and Purgathofer 2004, with the general n_opt of the 2006
//! revision for all kinds of light.
//!
//! In the light's image plane, z runs along the view direction projected into it. B is view ∩ scene ∩ light, e its point
//! nearest to the camera, d the extent of B along z. With z0 the eye depth where the light's ray at (e_x, near end of B)
//! meets the plane through e across the view, and z1 the eye depth at the same depth from the light at the far end:
//!
//! ```text
//! n = d / (√(z1/z0) - 1)          distance of the centre of projection before the near end of B
//! ```
//!
//! for a directional light at the angle γ to the view z0 = z_n and z1 = z_n + d sin γ, so that
//! n = (z_n + √(z_n (z_n + d sin γ))) / sin γ. With s = 1/n this tends to no warp as γ → 0 without a case of its own.
//!
//! Eye depth at a fixed depth from the light is linear over the image plane with its gradient along z, and e is the
//! nearest point of B; from both follows z1 ≥ z0 > 0, so the method has an answer for every light that has a plane.
//!
//! Where the paper leaves it open: of several nearest points e is their mean. A camera without perspective needs no warp.
//! Looking exactly along the light, z is the camera's up: the box of the map, not its density, turns there. A light that
//! passes the eye depth of e makes n jump, as in the paper.

use super::along::{Warp, across, extent, region};
use super::body::{Body, body, body_of, least};
use super::{Inapplicable, Inputs, Region};
use crate::scene::Projection;
use glam::{DVec2, DVec3};

/// Sine of the angle to the light below which the direction of the projected view is rounding.
const ALONG_LIGHT: f64 = 1e-9;

/// Solves one region.
pub(super) fn solve(inputs: &Inputs, axis: Option<DVec3>) -> Result<Region, Inapplicable> {
    fitted(inputs, body(inputs, axis)?)
}

/// The same around other points than the body's vertices.
pub(super) fn around(inputs: &Inputs, axis: Option<DVec3>, points: Vec<DVec3>) -> Result<Region, Inapplicable> {
    fitted(inputs, body_of(inputs, axis, points)?)
}

fn fitted(inputs: &Inputs, body: Body) -> Result<Region, Inapplicable> {
    let warp = warp(inputs, &body)?;
    region(inputs, body, &warp)
}

fn warp(inputs: &Inputs, body: &Body) -> Result<Warp, Inapplicable> {
    let axes = body.plane.space.axes;
    let in_plane = |v: DVec3| {
        let v = DVec2::new(axes[0].dot(v), axes[1].dot(v));
        v.try_normalize().filter(|_| v.length() > ALONG_LIGHT)
    };
    let camera = inputs.camera;
    let up = camera.world_from_camera.y_axis;
    let along = in_plane(camera.forward()).or(in_plane(up)).ok_or(Inapplicable::NoFiniteFit)?;
    let e = least(&body.vertices, |p| eye_depth(inputs, p)).ok_or(Inapplicable::NoCommonVolume)?;
    let near = extent(body.vertices.iter().map(|p| body.flat(*p)), along);
    let strength = match camera.projection {
        Projection::Orthographic { .. } => 0.0,
        Projection::Perspective { .. } => {
            inverse_n(inputs, body, e, near.1 - near.0).ok_or(Inapplicable::NoOptimalNear)?
        }
    };
    // From w = 1 at the body's near end to w = 1 at the hull's, which also holds covered points beyond the body.
    let (top, _) = extent(body.plane.hull.iter().copied(), along);
    let strength = strength / (1.0 + strength * (top - near.0));
    Ok(Warp { along, centre: across(along).dot(body.flat(e)), top, strength })
}

fn eye_depth(inputs: &Inputs, point: DVec3) -> f64 {
    inputs.camera.forward().dot(point - inputs.camera.position)
}

/// 1/n for a body of extent `depth` along z, both in normalised units of the light plane.
///
/// g·(v, 1), the view component of the light's ray through v, is least at the near end, so the ray there meets the plane
/// through e at the depth q_e.z · (g·v_e) / min(g·v) from the light.
fn inverse_n(inputs: &Inputs, body: &Body, e: DVec3, depth: f64) -> Option<f64> {
    let space = &body.plane.space;
    let view = space.dq(inputs.camera.forward());
    let along_view = |p: DVec3| {
        let q = space.q(p);
        view.dot(q) / q.z
    };
    let light_depth = if space.directional {
        1.0
    } else {
        let near = body.vertices.iter().map(|p| along_view(*p)).fold(f64::INFINITY, f64::min);
        space.q(e).z * along_view(e) / near
    };
    // Rise of eye depth per normalised unit of z at that depth from the light.
    let slope = light_depth * view.truncate().length() / body.plane.scale();
    let z0 = eye_depth(inputs, e);
    // (√(z1/z0) - 1) / d without the difference of nearly equal numbers.
    let inverse = slope / (z0 * ((1.0 + slope * depth / z0).sqrt() + 1.0));
    (z0 > 0.0 && light_depth > 0.0 && inverse.is_finite()).then_some(inverse)
}
