//! The parts of a job that describe a shot: frames, image, camera, lights.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `[frames]`: which moments of the animation are planned.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct FramesParams {
    /// `"1-240"`, `"1-240x2"`, `"5,7,10-1"`; absent = the whole animation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub range: Option<String>,
    /// Frames per second; frame 1 is at t = 0. Absent = 24.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fps: Option<f64>,
}

/// `[image]`: the film.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ImageParams {
    /// Width and height in pixels; absent = 1920 wide at the camera's aspect ratio (16:9 where it has none).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub size: Option<[u32; 2]>,
}

/// `[camera]`: a camera of a glTF file by name, a view of everything, one pose, or keyframes of poses.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct CameraParams {
    /// Name of a camera (or of the node that holds it) in a glTF file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// A three-quarter view of the whole scene.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub frame_all: bool,
    /// Position, metres.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub position: Option<[f64; 3]>,
    /// The point looked at; y is up.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub look_at: Option<[f64; 3]>,
    /// World-from-camera quaternion x, y, z, w, instead of `look_at`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rotation: Option<[f64; 4]>,
    /// Vertical field of view, degrees. Absent = 45.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fov: Option<f64>,
    /// Near plane, metres.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub near: Option<f64>,
    /// Far plane, metres; absent = infinite.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub far: Option<f64>,
    /// Keyframes; values between keys are linear (rotations: shortest arc).
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub key: Vec<CameraKey>,
}

/// One `[[camera.key]]`.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CameraKey {
    /// Frame number, as in `[frames]`; may be fractional.
    pub frame: f64,
    /// Position, metres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position: Option<[f64; 3]>,
    /// The point looked at.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub look_at: Option<[f64; 3]>,
    /// World-from-camera quaternion x, y, z, w.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rotation: Option<[f64; 4]>,
    /// Vertical field of view, degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fov: Option<f64>,
    /// Near plane, metres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub near: Option<f64>,
    /// Far plane, metres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub far: Option<f64>,
}

/// A `kind` of light in a job.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum LightKindName {
    /// Parallel light, like the sun.
    Directional,
    /// A bare bulb.
    Point,
    /// A cone.
    Spot,
}

/// One `[[light]]`: with `kind`, a light defined here; with `name` alone, the light of that name in the scene's files.
/// When a job has any `[[light]]`, only those are planned.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LightParams {
    /// Unique.
    pub name: String,
    /// Absent = take the light of that name from the scene's files.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub kind: Option<LightKindName>,
    /// The way light travels (directional, spot); need not be unit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub direction: Option<[f64; 3]>,
    /// Metres (point, spot).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position: Option<[f64; 3]>,
    /// Half angle of the spot's outer cone, degrees, in (0, 90].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cone: Option<f64>,
    /// Metres; absent = unlimited.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub range: Option<f64>,
}
