//! One shadow map of a plan.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Rows;
use crate::methods::Method;
use crate::raster::Bias;

/// A shadow map: its matrix, its size, and how to draw it and look it up.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
pub struct MapPlan {
    /// The method that chose the matrix.
    pub method: Method,
    /// Which points look this map up.
    pub domain: Domain,
    /// The shadow matrix: clip space of the map from the world.
    pub clip_from_world: Rows,
    /// Texels.
    pub width: u32,
    /// Texels.
    pub height: u32,
    /// Distance of the nearest thing the depth range keeps, metres: from the light along the map's axis, or for a
    /// directional light along its direction from the origin (may be negative).
    pub near: f64,
    /// Distance of the farthest thing the depth range keeps, metres, measured like `near`.
    pub far: f64,
    /// The depth bias the map is drawn with.
    pub bias: MapBias,
    /// The same matrix as a camera at the light; null where no such camera exists.
    pub light_camera: Option<LightCamera>,
    /// Why there is no light camera.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub light_camera_reason: Option<String>,
    /// Points to check an importer with: at least 6, not coplanar, extremes of the covered set among them.
    pub witnesses: Vec<Witness>,
    /// Why the witnesses are fewer, or coplanar.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub witnesses_reason: Option<String>,
    /// Largest shift of a covered point, texels, when the matrix is rounded to f32. Of the covered points this and the bias in
    /// other units take at most 4096, evenly thinned.
    pub f32_roundtrip_texels: f64,
}

impl MapPlan {
    /// Width times height.
    pub fn texels(&self) -> u64 {
        u64::from(self.width) * u64::from(self.height)
    }
}

/// Which points look a map up. More kinds may come; a reader that does not know one cannot use the plan.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Domain {
    /// Every point.
    All,
    /// Points on one side of a plane, those on it included.
    HalfSpace {
        /// a, b, c, d: a point x, y, z relative to the origin belongs here when a * x + b * y + c * z + d >= 0.
        plane: [f64; 4],
    },
    /// Points within a range of depth along the view axis of a camera. With p = forward * (point - position), a dot
    /// product, a point belongs here when from <= p and p < to.
    ViewDepth {
        /// The camera, relative to the origin, metres.
        position: [f64; 3],
        /// The way it looks, unit.
        forward: [f64; 3],
        /// Metres; absent = no lower end.
        #[serde(skip_serializing_if = "Option::is_none")]
        from: Option<f64>,
        /// Metres; absent = no upper end.
        #[serde(skip_serializing_if = "Option::is_none")]
        to: Option<f64>,
    },
    /// Points in a rectangle of the light's image plane. With (x, y, w) = plane_from_world * (point, 1), a point belongs
    /// here when w > 0 and min <= (x / w, y / w) and (x / w, y / w) < max, in both coordinates.
    LightPlaneRectangle {
        /// 3 rows of 4; the point is relative to the origin.
        plane_from_world: [[f64; 4]; 3],
        /// Smallest x / w and y / w.
        min: [f64; 2],
        /// Past the largest x / w and y / w.
        max: [f64; 2],
    },
    /// Points in a convex polygon, bounded or not, of the light's image plane. With (x, y, w) = plane_from_world *
    /// (point, 1), a point belongs here when w > 0 and a * x + b * y + c * w >= 0 for each side.
    LightPlanePolygon {
        /// 3 rows of 4; the point is relative to the origin.
        plane_from_world: [[f64; 4]; 3],
        /// a, b, c of each side.
        sides: Vec<[f64; 3]>,
    },
    /// Points that belong to every one of several domains.
    Intersection {
        /// The domains.
        of: Vec<Domain>,
    },
    /// Points in one pyramid of the six around a point or spot light.
    CubeFace {
        /// Apex, relative to the origin, metres.
        position: [f64; 3],
        /// Rows: the cube's x, y and z axes, unit, in the world.
        axes: [[f64; 3]; 3],
        /// The face. With p = axes * (point - position), a point belongs to the face of p's component of largest
        /// magnitude and that component's sign; ties go to x before y before z.
        face: CubeFace,
    },
}

/// A face of a cube, by the axis it looks along.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
pub enum CubeFace {
    /// Along x.
    #[serde(rename = "+x")]
    PositiveX,
    /// Against x.
    #[serde(rename = "-x")]
    NegativeX,
    /// Along y.
    #[serde(rename = "+y")]
    PositiveY,
    /// Against y.
    #[serde(rename = "-y")]
    NegativeY,
    /// Along z.
    #[serde(rename = "+z")]
    PositiveZ,
    /// Against z.
    #[serde(rename = "-z")]
    NegativeZ,
}

/// Depth bias: stored = depth + constant + min(slope * max(|z_u|, |z_v|), clamp).
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
pub struct MapBias {
    /// Window depth.
    pub constant: f64,
    /// Factor on the larger of the caster's depth slopes per texel.
    pub slope: f64,
    /// Largest slope part, window depth; absent = none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub clamp: Option<f64>,
    /// The largest bias over the covered receivers, as a distance in texels.
    pub texels: f64,
    /// The largest bias over the covered receivers, metres along the light.
    pub world: f64,
}

impl MapBias {
    /// As maps are drawn with it.
    pub(crate) fn drawn(&self) -> Bias {
        Bias { constant: self.constant, slope: self.slope, clamp: self.clamp.unwrap_or(f64::INFINITY) }
    }
}

/// A shadow matrix as a camera: placement, off-centre frustum, skew.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
pub struct LightCamera {
    /// Perspective for point and spot lights, orthographic for directional ones.
    pub projection: LightProjection,
    /// Eye, relative to the origin, metres.
    pub position: [f64; 3],
    /// World-from-camera quaternion x, y, z, w; the camera looks along -z.
    pub rotation: [f64; 4],
    /// The sides of the view volume.
    pub frustum: Frustum,
    /// Shear: x of the camera becomes x + skew * y before the frustum is applied.
    pub skew: f64,
}

/// How a light camera projects.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum LightProjection {
    /// Rays through the eye; left, right, bottom, top lie on the near plane.
    Perspective,
    /// Parallel rays.
    Orthographic,
}

/// The sides of a view volume, as for glFrustum or glOrtho.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
pub struct Frustum {
    /// Metres.
    pub left: f64,
    /// Metres.
    pub right: f64,
    /// Metres.
    pub bottom: f64,
    /// Metres.
    pub top: f64,
    /// Metres along the view axis.
    pub near: f64,
    /// Metres along the view axis.
    pub far: f64,
}

/// A point, what the matrix gives it, and whether it is in shadow: of the frame's surfaces, between one of them and the
/// light, or, where few are seen, anywhere in what the map holds.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
pub struct Witness {
    /// Relative to the origin, metres.
    pub world: [f64; 3],
    /// Map coordinates, in [0, 1] inside the map.
    pub uv: [f64; 2],
    /// Window depth, before clamping and bias.
    pub depth: f64,
    /// The exact answer.
    pub shadowed: bool,
}
