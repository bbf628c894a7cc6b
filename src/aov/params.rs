//! The part of a job that says what a renderer's images hold.

use crate::scene::{LengthUnit, UpAxis};
use schemars::JsonSchema;
use serde::de::{self, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use std::path::PathBuf;

/// `[aov]`: a renderer's images, for `[visibility] source = "aov"`. A layer is a channel of that name, or the channels
/// `layer.X`, or a part of that name.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct AovParams {
    /// One or several OpenEXR files of a frame, relative to the job file; `####` or `%04d` stands for the frame number. A
    /// layer is taken from the first file that has it.
    #[serde(deserialize_with = "files")]
    #[schemars(with = "Files")]
    pub file: Vec<PathBuf>,
    /// How far away what is seen is; this or `position`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub depth: Option<DepthLayer>,
    /// Where what is seen is, in the world; this or `depth`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub position: Option<PositionLayer>,
    /// Which way it faces; absent = from differences of neighbouring pixels.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub normal: Option<NormalLayer>,
    /// What is in shadow, a layer a light.
    pub shadow: ShadowLayer,
    /// The unit of depths, positions and the header's camera.
    pub unit: LengthUnit,
    /// The axis that points up in positions, normals and the header's camera.
    pub up: UpAxis,
}

/// `[aov] depth`.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DepthLayer {
    /// Absent = "Z".
    #[serde(default = "layer_z")]
    pub layer: String,
    /// What is measured.
    pub kind: DepthKind,
}

/// What a depth layer measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum DepthKind {
    /// Along the view axis: the same all over a wall that the camera faces.
    Planar,
    /// Along the ray of the pixel, from the centre of projection.
    Distance,
}

/// `[aov] position`.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PositionLayer {
    /// Three channels. Absent = "P".
    #[serde(default = "layer_p")]
    pub layer: String,
}

/// `[aov] normal`.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NormalLayer {
    /// Three channels, -1 to 1. Absent = "N".
    #[serde(default = "layer_n")]
    pub layer: String,
    /// Whose axes. Absent = world.
    #[serde(default)]
    pub space: NormalSpace,
}

/// Whose axes a normal is given in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum NormalSpace {
    /// The world's.
    #[default]
    World,
    /// Right, up, backward of the camera.
    Camera,
}

/// `[aov] shadow`.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ShadowLayer {
    /// The layer's name; `{light}` stands for the light's. `[[light]] aov` names that of one light.
    pub layer: String,
    /// What the value 1 stands for.
    pub one: ShadowValue,
}

/// What 1 means in a shadow layer. Where a surface is turned away from the light, the layer is not looked at.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum ShadowValue {
    /// In shadow: a shadow matte.
    #[default]
    Shadowed,
    /// Lit: a visibility pass.
    Lit,
}

impl Default for ShadowLayer {
    fn default() -> Self {
        Self { layer: format!("shadow_{LIGHT_NAME}"), one: ShadowValue::default() }
    }
}

/// In [`ShadowLayer::layer`]: the light's name.
pub(super) const LIGHT_NAME: &str = "{light}";

fn layer_z() -> String {
    "Z".to_owned()
}

fn layer_p() -> String {
    "P".to_owned()
}

fn layer_n() -> String {
    "N".to_owned()
}

/// The two ways of writing `file`, for the schema only.
#[derive(JsonSchema)]
#[schemars(untagged)]
#[expect(dead_code, reason = "never built: it describes what `files` accepts")]
enum Files {
    One(PathBuf),
    Many(Vec<PathBuf>),
}

/// One name or a list of names. A visitor rather than an untagged enum: those lose the line of an error.
fn files<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<PathBuf>, D::Error> {
    struct Names;
    impl<'de> Visitor<'de> for Names {
        type Value = Vec<PathBuf>;

        fn expecting(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
            f.write_str("a file name or a list of these")
        }

        fn visit_str<E: de::Error>(self, name: &str) -> Result<Self::Value, E> {
            Ok(vec![name.into()])
        }

        fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Self::Value, A::Error> {
            let mut names = Vec::new();
            while let Some(name) = seq.next_element()? {
                names.push(name);
            }
            Ok(names)
        }
    }
    deserializer.deserialize_any(Names)
}
