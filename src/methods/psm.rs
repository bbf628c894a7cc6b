//! Perspective shadow maps: Stamminger and Drettakis 2002, with the pull-back and the light behind the camera of Kozlov,
//! GPU Gems 2004, chapter 14.
//!
//! The camera, or one slid back along its axis until its plane at infinity lies at a depth of `psm_infinity` (0 near, 1
//! far: zf / (zf - zn)), maps view ∩ scene ∩ light onto the unit cube [-1, 1]³. There the light is the image ℓ of its
//! position or direction, and a light camera that looks at the cube's centre gives the map:
//!
//! ```text
//! Y = C (X, 1),   ℓ = C (L, 1) or C (direction, 0)
//! p1, p2: e1·Y, e2·Y  with e1, e2 ⟂ ℓ_xyz,      p4: Y_w - (ℓ_w / |ℓ_xyz|²) ℓ_xyz·Y_xyz
//! ```
//!
//! All three rows vanish at ℓ, so they are rows of the light plane. ℓ_w = 0 is an orthographic light camera, ℓ_w > 0 a
//! perspective one; ℓ_w < 0 is the light behind the camera, a sink instead of a source, for which Kozlov inverts near and
//! far. That concerns depth alone: rows 1, 2, 4 are the same, and the depth row fitted later keeps casters before
//! receivers. So light kinds change without a switch. The light camera's up, and so the box of the map, is the view axis;
//! where it looks exactly along that, the camera's up.

use super::body::{Rectangle, body, refit};
use super::{Inapplicable, Inputs, Region};
use crate::math::LightSpace;
use crate::scene::{LightKind, Projection};
use glam::{DVec3, DVec4, Vec4Swizzles};

/// Sine of the angle between light and view axis in the cube below which its direction is rounding.
const ALONG_VIEW: f64 = 1e-9;

/// Solves one region.
pub(super) fn solve(inputs: &Inputs, axis: Option<DVec3>) -> Result<Region, Inapplicable> {
    let body = body(inputs, axis)?;
    let held: Vec<DVec3> = body.vertices.iter().chain(inputs.covered).copied().collect();
    let cube = unit_cube(inputs, &held).ok_or(Inapplicable::NoCommonVolume)?;
    let eye = inputs.camera.position;
    // Of either sign: a lamp far away counts as the direction in which its light travels.
    let light = match inputs.light.kind {
        LightKind::Directional { direction } => cube.map(|row| row.truncate().dot(direction)),
        LightKind::Point { position, .. } | LightKind::Spot { position, .. } => {
            cube.map(|row| -row.dot((position - eye).extend(1.0)))
        }
    };
    let light = DVec4::from_array(light);
    let rows = light_camera(&cube, light).ok_or(Inapplicable::LightInView)?;
    let plane = body.plane;
    let base = rows.map(|row| plane.normalisation.row(row_on_q(&plane.space, eye, row)));
    match refit(inputs, plane, &base, Rectangle::Axes) {
        Err(Inapplicable::StraddlesVanishingLine) => Err(Inapplicable::LightInView),
        other => other,
    }
}

/// Rows X, Y, Z, W of clip space on (X - camera position, 1) for the camera slid back, with the points' box as the unit
/// cube. `None` when the points have no extent in depth, width or height.
fn unit_cube(inputs: &Inputs, points: &[DVec3]) -> Option<[DVec4; 4]> {
    let camera = inputs.camera;
    let m = camera.world_from_camera;
    let depth = camera.forward().extend(0.0);
    let at = |row: DVec4, p: &DVec3| row.dot((*p - camera.position).extend(1.0));
    let range = |f: &dyn Fn(&DVec3) -> f64| {
        points.iter().map(f).fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)))
    };
    let (near, far) = range(&|p| at(depth, p));
    let (w, z) = match camera.projection {
        Projection::Perspective { .. } => {
            let back = (inputs.solver.psm_infinity * (far - near) - far).max(0.0);
            let w = depth + DVec4::W * back;
            let (near, far) = (near + back, far + back);
            (w, (w * (far + near) - DVec4::W * (2.0 * far * near)) / (far - near))
        }
        Projection::Orthographic { .. } => (DVec4::W, (depth * 2.0 - DVec4::W * (far + near)) / (far - near)),
    };
    let fitted = |row: DVec4| {
        let (lo, hi) = range(&|p| at(row, p) / at(w, p));
        (row * 2.0 - w * (lo + hi)) / (hi - lo)
    };
    let rows = [fitted(m.x_axis.extend(0.0)), fitted(m.y_axis.extend(0.0)), z, w];
    (near > 0.0 || w == DVec4::W).then_some(rows).filter(|rows| rows.iter().all(|r| r.is_finite()))
}

/// Rows 1, 2, 4 of the light camera at the image ℓ of the light; `None` for a light at the centre of the cube.
fn light_camera(cube: &[DVec4; 4], light: DVec4) -> Option<[DVec4; 3]> {
    let towards = light.xyz().try_normalize()?;
    let on_cube = |e: DVec3| cube[0] * e.x + cube[1] * e.y + cube[2] * e.z;
    let right = |up: DVec3| {
        let right = up.cross(towards);
        right.try_normalize().filter(|_| right.length() > ALONG_VIEW)
    };
    let e1 = right(DVec3::Z).or(right(DVec3::Y))?;
    let w = cube[3] - on_cube(towards) * (light.w / light.xyz().length());
    Some([on_cube(e1), on_cube(towards.cross(e1)), w])
}

/// A row on (X - eye, 1) that vanishes at the light, as a row on q.
fn row_on_q(space: &LightSpace, eye: DVec3, row: DVec4) -> DVec3 {
    let [r1, r2, r3] = space.axes.map(|axis| row.truncate().dot(axis));
    DVec3::new(r1, r2, if space.directional { row.dot((space.center - eye).extend(1.0)) } else { r3 })
}
