//! Plane-optimal shadow maps: Chong and Gortler 2004, "A lixel for every pixel", for one plane.
//!
//! The map is the film's own image of the plane, as large as the cover asks, so that every pixel of the plane gets the
//! same texels. The plane is the user's, or the one that holds most shadow edge. What does not lie on it is carried along
//! the light onto it; where that brings covered points to both sides of the camera's horizon there is no single map. The
//! rectangle stands along the film's axes.

use super::body::{Rectangle, covering_plane, light_plane, may_warp, refit};
use super::on_plane::film_rows;
use super::plane_fit::plane_of_most_edges;
use super::{Inapplicable, Inputs, Region};
use glam::DVec3;

/// Solves one region.
pub(super) fn solve(inputs: &Inputs, axis: Option<DVec3>) -> Result<Region, Inapplicable> {
    may_warp(inputs)?;
    let (n, d) = match inputs.solver.plane {
        Some([a, b, c, d]) => {
            let length = DVec3::new(a, b, c).length();
            (DVec3::new(a, b, c) / length, d / length)
        }
        None => plane_of_most_edges(inputs)?,
    };
    if !(n.is_finite() && d.is_finite()) {
        return Err(Inapplicable::NoPlane);
    }
    let space = light_plane(inputs, axis, inputs.covered)?;
    let rows = film_rows(inputs, &space, (n, d), inputs.covered[0])?;
    let plane = covering_plane(inputs, space, inputs.covered)?;
    let base = rows.map(|row| plane.normalisation.row(row));
    refit(inputs, plane, &base, Rectangle::Axes)
}
