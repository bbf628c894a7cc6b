//! Trapezoidal shadow maps: Martin and Tan 2004.
//!
//! In the light's image plane the centre line is the projected view axis, from the near to the far end of the view. Top
//! and base are the lines across it that touch the hull, λ apart. A focus δ = `tsm_depth` · λ from the top gets the share
//! p = `tsm_focus` of the map (the paper's "80 % line", ξ = 1 - 2p), which places the centre of projection Q on the
//! centre line, η above the top; the sides are the tangents from Q to the hull, and the trapezoid fills the unit square:
//!
//! ```text
//! η = λ δ (1 + ξ) / (λ (1 - ξ) - 2 δ),       1/η = (p - f) / (λ f (1 - p)),   f = δ/λ
//! ```
//!
//! The second form has no pole at δ = pλ, where there is no warp; past it Q stands below the base. The paper leaves δ to
//! the user, as a distance along the view; 0.52 λ is the default of the public sample code. Deviation: the hull is that
//! of view ∩ scene ∩ light, not of the view alone. The paper's advice to keep z from before the warp is not followed: it
//! is no linear row, and the depth row comes later for all methods alike.

use super::along::{Warp, across, extent, region};
use super::body::{Body, body};
use super::{Inapplicable, Inputs, Region};
use glam::DVec3;

/// Shortest projected view direction, relative to its length, that still tells the centre line: at a millionth of a
/// degree to the light its direction is rounding.
const CENTRE_LINE_MIN: f64 = 1e-8;

/// Solves one region.
pub(super) fn solve(inputs: &Inputs, axis: Option<DVec3>) -> Result<Region, Inapplicable> {
    let body = body(inputs, axis)?;
    let warp = warp(inputs, &body)?;
    region(inputs, body, &warp)
}

fn warp(inputs: &Inputs, body: &Body) -> Result<Warp, Inapplicable> {
    let space = &body.plane.space;
    // The view axis as a line of the light plane: through its points at the camera and at infinity.
    let (eye, view) = (space.q(inputs.camera.position), space.dq(inputs.camera.forward()));
    let towards = view.truncate() * eye.z - eye.truncate() * view.z;
    let least = CENTRE_LINE_MIN * if space.directional { 1.0 } else { eye.length() };
    let along = towards.try_normalize().filter(|_| towards.length() > least).ok_or(Inapplicable::NoCentreLine)?;
    let line = eye.cross(view);
    let aside = across(along);
    let on_line = aside * (-line.z / line.truncate().dot(aside));
    let (top, base) = extent(body.plane.hull.iter().copied(), along);
    let (f, p) = (inputs.solver.tsm_depth, inputs.solver.tsm_focus);
    let strength = (p - f) / ((base - top) * f * (1.0 - p));
    Ok(Warp { along, centre: aside.dot(body.plane.normalisation.point(on_line)), top, strength })
}
