//! A job: what is planned, how well, and how hard the planner tries. Each room's own parameters, composed; there is no
//! second set of options anywhere.
//!
//! Layers, lowest first: the built-in defaults, a preset, the job file, the command line. They are merged as TOML tables
//! and deserialised once, into [`Job`]. The job file is also read alone first, so that what is wrong in it is reported
//! with its line and column.

mod check;
mod error;
mod keys;
mod layers;
mod load;
mod locate;

use std::marker::PhantomData;
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::de::{self, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

use crate::methods::SolverParams;
use crate::resolution::{MapParams, QualityParams};
use crate::samples::SamplingParams;
use crate::scene::{CameraParams, FramesParams, ImageParams, LightParams};

pub use check::{Problem, check};
pub use error::{JobError, Located};
pub use layers::Preset;
pub use load::{LoadedJob, load};

/// A job file, as written by a user or as resolved from all layers.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
#[schemars(extend("required" = ["scene"]))]
pub struct Job {
    /// One or several scene files (.gltf, .glb, .obj), relative to the job file.
    #[serde(deserialize_with = "one_or_many")]
    #[schemars(with = "OneOrMany")]
    pub scene: Vec<PathBuf>,
    /// Which scene of glTF files that hold several; absent = each file's default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub active_scene: Option<String>,
    /// Names of the animations that play, one or a list; [] = none; absent = all that drive different things, in file order.
    #[serde(deserialize_with = "maybe_one_or_many", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Option<OneOrMany>")]
    pub animation: Option<Vec<String>>,
    /// The settings that the job and the command line are laid over.
    pub preset: Preset,
    /// Which moments are planned.
    pub frames: FramesParams,
    /// The film.
    pub image: ImageParams,
    /// The camera.
    pub camera: CameraParams,
    /// The lights; none = all lights of the scene's files.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub light: Vec<LightParams>,
    /// The bound that maps have to meet.
    pub quality: QualityParams,
    /// What maps may look like.
    pub map: MapParams,
    /// How finely shadow edges are looked for.
    pub sampling: SamplingParams,
    /// How matrices are found.
    pub solver: SolverParams,
}

/// The two ways of writing `scene` and `animation`, for the schema only.
#[derive(JsonSchema)]
#[schemars(untagged)]
#[expect(dead_code, reason = "never built: it describes what `one_or_many` accepts")]
enum OneOrMany {
    One(String),
    Many(Vec<String>),
}

/// Reads a string or a list of strings. A visitor rather than an untagged enum: those lose the line of an error.
fn one_or_many<'de, D: Deserializer<'de>, T: From<String>>(deserializer: D) -> Result<Vec<T>, D::Error> {
    struct Texts<T>(PhantomData<T>);
    impl<'de, T: From<String>> Visitor<'de> for Texts<T> {
        type Value = Vec<T>;

        fn expecting(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
            f.write_str("a name or a list of names")
        }

        fn visit_str<E: de::Error>(self, text: &str) -> Result<Self::Value, E> {
            Ok(vec![T::from(text.to_owned())])
        }

        fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Self::Value, A::Error> {
            let mut texts = Vec::new();
            while let Some(text) = seq.next_element::<String>()? {
                texts.push(T::from(text));
            }
            Ok(texts)
        }
    }
    deserializer.deserialize_any(Texts(PhantomData))
}

/// As [`one_or_many`], where a key may be missing.
fn maybe_one_or_many<'de, D: Deserializer<'de>, T: From<String>>(d: D) -> Result<Option<Vec<T>>, D::Error> {
    one_or_many(d).map(Some)
}

/// Extensions of scene files, lower case.
pub const SCENE_EXTENSIONS: [&str; 3] = ["gltf", "glb", "obj"];

/// True for a path whose extension is a scene file's.
pub fn is_scene_file(path: &Path) -> bool {
    path.extension()
        .and_then(|e| e.to_str())
        .is_some_and(|e| SCENE_EXTENSIONS.contains(&e.to_ascii_lowercase().as_str()))
}
