//! The lights of a frame.

use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Where light comes from.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
pub enum LightKind {
    /// Parallel light.
    Directional {
        /// Unit, the way light travels.
        direction: DVec3,
    },
    /// Light from a point in all directions.
    Point {
        /// Scene space, metres.
        position: DVec3,
        /// Metres; points farther away are unlit.
        range: Option<f64>,
    },
    /// Light from a point into a cone.
    Spot {
        /// Scene space, metres.
        position: DVec3,
        /// Unit axis, the way light travels.
        direction: DVec3,
        /// Half angle of the outer cone, radians, in (0, π/2]; points outside are unlit.
        cone_rad: f64,
        /// Metres; points farther away are unlit.
        range: Option<f64>,
    },
}

/// A light in scene space.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct Light {
    /// As in the file or job; unique within a scene.
    pub name: String,
    /// Kind, with its placement.
    pub kind: LightKind,
}

impl Light {
    /// Position of a point or spot light.
    pub fn position(&self) -> Option<DVec3> {
        match self.kind {
            LightKind::Directional { .. } => None,
            LightKind::Point { position, .. } | LightKind::Spot { position, .. } => Some(position),
        }
    }

    /// Vector from a point towards the light, not normalised: to the light's position, or against a directional
    /// light's direction (unit).
    pub fn towards(&self, point: DVec3) -> DVec3 {
        match self.kind {
            LightKind::Directional { direction } => -direction,
            LightKind::Point { position, .. } | LightKind::Spot { position, .. } => position - point,
        }
    }

    /// True when the light reaches a point at all: inside the cone and range. Occlusion and facing are not looked at.
    pub fn reaches(&self, point: DVec3) -> bool {
        let in_range =
            |position: DVec3, range: Option<f64>| range.is_none_or(|r| point.distance_squared(position) <= r * r);
        match self.kind {
            LightKind::Directional { .. } => true,
            LightKind::Point { position, range } => in_range(position, range),
            LightKind::Spot { position, direction, cone_rad, range } => {
                let v = point - position;
                in_range(position, range) && v.dot(direction) >= cone_rad.cos() * v.length()
            }
        }
    }
}
