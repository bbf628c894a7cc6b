//! Maps laid over a plane of the scene. With the film's own rows there, the homography from a light's image plane to the
//! film: as the map it makes the film sample that plane evenly (Chong and Gortler 2004, "A lixel for every pixel").
//!
//! The paper's conditions P·light = 0 and four plane points to their film positions have one solution, up to scale. It is
//! written down here, where a null space would be computed: the light's ray q meets the plane n·X + d = 0 at the
//! homogeneous point B q, and the film's rows act on that.
//!
//! ```text
//! point light:   X - L = -(n·L + d) Rᵀq                   with weight n·Rᵀq
//! directional:   X - C = (n·r3) r - (n·r + e q3) r3,      weight (n·r3) q3,    r = r1 q1 + r2 q2,  e = n·C + d
//! ```

use super::{Inapplicable, Inputs};
use crate::math::LightSpace;
use crate::scene::{Camera, Film, Projection};
use glam::{DVec3, DVec4};

/// Least sine, or distance relative to the scene, at which camera or light are off the plane: nine digits remain of f64.
pub(super) const OFF_PLANE: f64 = 1e-7;

/// Rows x, y (pixels, y up) and w on q for the plane n·X + d = 0, n unit; w > 0 at the scene point `inside`.
pub(super) fn film_rows(
    inputs: &Inputs,
    space: &LightSpace,
    (n, d): (DVec3, f64),
    inside: DVec3,
) -> Result<[DVec3; 3], Inapplicable> {
    let camera = inputs.camera;
    let on_plane = match camera.projection {
        Projection::Perspective { .. } => (n.dot(camera.position) + d).abs() <= OFF_PLANE * inputs.bounds.diagonal(),
        Projection::Orthographic { .. } => n.dot(camera.forward()).abs() <= OFF_PLANE,
    };
    if on_plane {
        return Err(Inapplicable::CameraOnPlane);
    }
    plane_rows(inputs, space, (n, d), film_functionals(camera, inputs.film), inside)
}

/// Rows on q that are, at the ray q, those of `functionals` on (X - camera position, 1) where it meets the plane
/// n·X + d = 0, n unit. Up to a common factor, with which the last is positive at the scene point `inside`.
pub(super) fn plane_rows(
    inputs: &Inputs,
    space: &LightSpace,
    (n, d): (DVec3, f64),
    functionals: [DVec4; 3],
    inside: DVec3,
) -> Result<[DVec3; 3], Inapplicable> {
    let [r1, r2, r3] = space.axes;
    // B's columns: (X - origin, weight) of q = x, y, z.
    let (origin, columns) = match inputs.light.position() {
        None => {
            let (slope, e) = (n.dot(r3), n.dot(space.center) + d);
            if slope.abs() <= OFF_PLANE {
                return Err(Inapplicable::LightOnPlane);
            }
            let flat = |r: DVec3| (r * slope - r3 * n.dot(r)).extend(0.0);
            (space.center, [flat(r1), flat(r2), (r3 * -e).extend(slope)])
        }
        Some(position) => {
            let off = n.dot(position) + d;
            if off.abs() <= OFF_PLANE * inputs.bounds.diagonal() {
                return Err(Inapplicable::LightOnPlane);
            }
            (position, [r1, r2, r3].map(|r| (r * -off).extend(n.dot(r))))
        }
    };
    let from_eye = origin - inputs.camera.position;
    let rows = functionals.map(|row| {
        let at_origin = row.dot(from_eye.extend(1.0));
        DVec3::from_array(columns.map(|b| row.truncate().dot(b.truncate()) + b.w * at_origin))
    });
    let sign = if rows[2].dot(space.q(inside)) < 0.0 { -1.0 } else { 1.0 };
    Ok(rows.map(|row| row * sign))
}

/// Rows x, y (pixels from the middle, y up) and w of the film on (X - camera position, 1).
fn film_functionals(camera: &Camera, film: Film) -> [DVec4; 3] {
    let m = camera.world_from_camera;
    let half = 0.5 * f64::from(film.height);
    let (pixels, w) = match camera.projection {
        Projection::Perspective { yfov_rad } => (half / (0.5 * yfov_rad).tan(), camera.forward().extend(0.0)),
        Projection::Orthographic { half_height } => (half / half_height, DVec4::W),
    };
    [(m.x_axis * pixels).extend(0.0), (m.y_axis * pixels).extend(0.0), w]
}
