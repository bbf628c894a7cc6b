//! The normal shadow map: the light's own frustum over the whole scene, without knowledge of the camera (SOSM §3,
//! "Normal"; Mikkelsen's "ssm"). Directional: an axis-aligned box in a fixed frame of the light. Point and spot: a
//! frustum around the scene as seen from the light, no wider than the spot's cone or the cube face.

use super::body::Rectangle;
use super::focused::{light_body, uniform_region};
use super::{Inapplicable, Inputs, Region};
use crate::math::LightSpace;
use glam::DVec3;

/// Solves one region.
pub(super) fn solve(inputs: &Inputs, axis: Option<DVec3>) -> Result<Region, Inapplicable> {
    let body = light_body(inputs, axis);
    if body.is_empty() {
        return Err(Inapplicable::NoCommonVolume);
    }
    let space = match (axis, inputs.light.position()) {
        (Some(axis), Some(position)) => LightSpace::perspective(position, axis, inputs.bounds.center()),
        _ => LightSpace::around(inputs.light, &body)?,
    };
    uniform_region(inputs, space, &body, Rectangle::Axes)
}
