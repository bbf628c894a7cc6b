//! Stable cascades: Valient 2008, *Stable Rendering of Cascaded Shadow Maps* (ShaderX6, 4.1).
//!
//! The map of a range is a square around the sphere that holds its part of the view frustum: of the same size however
//! the camera stands and turns. Its axes are the light's own, and its centre moves in whole texels of a grid that is at
//! rest in the scene. For that n is the camera's own, and f too, or the next power of two (metres) past the scene where
//! that is nearer: drawn in to the scene itself they would change with every frame.
//!
//! Deviation: the grid is 1/64 of the map, not one texel, so that a map of any multiple of 64 texels moves by whole ones;
//! the size need not be known here. That costs 1/64 of the width.

use super::super::body::finished;
use super::super::focused::view_body;
use super::super::plane::Plane;
use super::super::{Inapplicable, Inputs, Region};
use super::extent;
use crate::fit::Aspect;
use crate::math::LightSpace;
use crate::scene::Projection;
use glam::{DVec2, DVec3};

/// Grid steps along a side of the map.
const STEPS: f64 = 64.0;

/// n and f, metres.
pub(super) fn view_range(inputs: &Inputs, axis: Option<DVec3>) -> Result<(f64, f64), Inapplicable> {
    let past_scene = extent(inputs, &view_body(inputs, axis)?).1.log2().ceil().exp2();
    Ok((inputs.camera.near, inputs.camera.far.unwrap_or(f64::INFINITY).min(past_scene)))
}

/// Solves the range from depth `near` to `far`, metres.
pub(super) fn solve(inputs: &Inputs, near: f64, far: f64) -> Result<Region, Inapplicable> {
    if inputs.light.position().is_some() {
        return Err(Inapplicable::StableNeedsParallelLight);
    }
    let (depth, radius) = sphere(inputs, near, far);
    let side = 2.0 * radius * STEPS / (STEPS - 1.0);
    let centre = inputs.camera.position + inputs.camera.forward() * depth;
    // About the scene's zero, so that the frame and its grid do not follow the cover.
    let light = LightSpace { center: DVec3::ZERO, ..LightSpace::around(inputs.light, &[centre])? };
    let step = side / STEPS;
    let corner = ((light.q(centre).truncate() - 0.5 * side) / step).round() * step;
    let corners = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y].map(|c| {
        let at = corner + c * side;
        light.axes[0] * at.x + light.axes[1] * at.y
    });
    let plane = Plane::new(inputs, light, &corners, inputs.edges, true).ok_or(Inapplicable::NoFiniteFit)?;
    let unit = [DVec3::X, DVec3::Y].map(|e| (e - DVec3::Z * e.dot(corner.extend(0.0))) / side);
    let rows = [unit[0], unit[1], DVec3::Z].map(|row| plane.normalisation.row(row));
    let aspect = match inputs.aspect {
        Aspect::Free => 1.0,
        Aspect::Fixed(ratio) => ratio,
    };
    finished(plane, rows, aspect, 1)
}

/// Depth of the centre and radius of the smallest sphere around the view frustum from depth `near` to `far`, metres.
fn sphere(inputs: &Inputs, near: f64, far: f64) -> (f64, f64) {
    let film = inputs.film;
    let diagonal = (1.0 + (f64::from(film.width) / f64::from(film.height)).powi(2)).sqrt();
    let half = match inputs.camera.projection {
        // Half diagonal at depth 1: the corners at depth z lie t z off the axis.
        Projection::Perspective { yfov_rad } => {
            let t = diagonal * (0.5 * yfov_rad).tan();
            let depth = far.min(0.5 * (near + far) * (1.0 + t * t));
            return (depth, (far - depth).hypot(far * t).max((depth - near).hypot(near * t)));
        }
        Projection::Orthographic { half_height } => diagonal * half_height,
    };
    let depth = 0.5 * (near + far);
    (depth, (far - depth).hypot(half))
}
