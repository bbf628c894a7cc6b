//! The parts of a job that describe a shot: frames, image, camera, lights.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

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

/// `[camera]`: a camera of a glTF file by name, a path from a file, a view of everything, one pose, or keyframes of poses.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct CameraParams {
    /// Name of a camera (or of the node that holds it) in a glTF file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// A file with the camera, relative to the job file: a path as .chan, or as .json or .csv with a matrix a frame, or
    /// another .gltf or .glb, of which only the cameras are taken.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<PathBuf>,
    /// Which rotation of a .chan line turns first, second, third. Absent = zxy.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rotation_order: Option<RotationOrder>,
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
    /// How values run between keys, of a file too. Absent = linear.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub interpolation: Option<KeyInterpolation>,
    /// Keyframes.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub key: Vec<CameraKey>,
}

/// How the values of a camera run between its keys.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum KeyInterpolation {
    /// Straight; rotations along the shortest arc.
    #[default]
    Linear,
    /// Smooth through all keys: at each the slope from the key before to the key after.
    CatmullRom,
    /// As at the last key.
    Constant,
}

/// Orders of rotations about fixed axes; the axis named first turns first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
#[expect(missing_docs, reason = "the name is the order")]
pub enum RotationOrder {
    Xyz,
    Xzy,
    Yxz,
    Yzx,
    #[default]
    Zxy,
    Zyx,
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

/// `[visibility]`: what is there to be seen and to cast shadows.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct VisibilityParams {
    /// What becomes of glTF materials with alphaMode BLEND, and of OBJ materials that are partly transparent (`d`, `Tr`).
    pub blend: BlendRule,
    /// Whether meshes that are placed several times, or move rigidly, are kept once.
    #[serde(skip_serializing_if = "InstanceRule::is_auto")]
    pub instances: InstanceRule,
}

/// What becomes of meshes that are placed several times, or move rigidly. Plans are the same but where two triangles lie at
/// the same depth to the bit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum InstanceRule {
    /// Kept once where that saves much memory, or much sorting of what moves.
    #[default]
    Auto,
    /// Every copy is kept: faster rays, more memory.
    Flatten,
    /// Every mesh without skin and morph targets is kept once: least memory.
    Share,
}

impl InstanceRule {
    fn is_auto(&self) -> bool {
        *self == InstanceRule::Auto
    }
}

/// What becomes of a material that is blended: shadow maps have no half shadows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize)]
#[serde(try_from = "String", into = "String")]
pub enum BlendRule {
    /// Casts and receives as if it were opaque.
    #[default]
    Opaque,
    /// Is not there: neither casts a shadow nor receives one.
    Ignore,
    /// Is there where its alpha is at least this, 0 to 1.
    Threshold(f64),
}

/// What a text needs before the alpha of [`BlendRule::Threshold`].
const THRESHOLD: &str = "threshold:";

impl TryFrom<String> for BlendRule {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        let threshold = || text.strip_prefix(THRESHOLD)?.trim().parse().ok().filter(|t| (0.0..=1.0).contains(t));
        match text.as_str() {
            "opaque" => Ok(BlendRule::Opaque),
            "ignore" => Ok(BlendRule::Ignore),
            _ => threshold().map(BlendRule::Threshold).ok_or_else(|| {
                format!("\"{text}\" is no rule; the rules are \"opaque\", \"ignore\" and \"threshold:0.5\" (0 to 1)")
            }),
        }
    }
}

impl From<BlendRule> for String {
    fn from(rule: BlendRule) -> Self {
        match rule {
            BlendRule::Opaque => "opaque".into(),
            BlendRule::Ignore => "ignore".into(),
            BlendRule::Threshold(alpha) => format!("{THRESHOLD}{alpha}"),
        }
    }
}

impl JsonSchema for BlendRule {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "BlendRule".into()
    }

    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({
            "description": "What becomes of a material that is blended: \"opaque\" = casts and receives as if it were opaque, \
                \"ignore\" = is not there, \"threshold:0.5\" = is there where its alpha is at least that, 0 to 1.",
            "type": "string",
            "pattern": "^(opaque|ignore|threshold: *[0-9.eE+-]+)$"
        })
    }
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
    /// What one of its wrong pixels counts under a budget, at least 0; absent = 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub importance: Option<f64>,
}
