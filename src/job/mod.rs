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
use std::path::Path;

use schemars::JsonSchema;
use serde::de::value::{MapAccessDeserializer, StrDeserializer};
use serde::de::{self, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

use crate::budget::BudgetParams;
use crate::measure::LookupParams;
use crate::methods::SolverParams;
use crate::resolution::{MapParams, QualityParams};
use crate::samples::SamplingParams;
use crate::scene::{CameraParams, FramesParams, ImageParams, LightParams, SceneFile, VisibilityParams};
use crate::shot::TemporalParams;

pub use check::{Problem, check, check_solver};
pub use error::{JobError, Located};
pub use layers::Preset;
pub(crate) use layers::lay_over;
pub use load::{LoadedJob, load};

/// A job file, as written by a user or as resolved from all layers.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
#[schemars(extend("required" = ["scene"]))]
pub struct Job {
    /// One or several scene files (.gltf, .glb, .obj), relative to the job file: names, or tables with `file`, `transform`,
    /// `up` and `unit`.
    #[serde(deserialize_with = "scene_files")]
    #[schemars(with = "OneOrMany<SceneFile>")]
    pub scene: Vec<SceneFile>,
    /// Which scene of glTF files that hold several; absent = each file's default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub active_scene: Option<String>,
    /// Names of the animations that play, one or a list; [] = none; absent = all that drive different things, in file order.
    #[serde(deserialize_with = "animations", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Option<OneOrMany<String>>")]
    pub animation: Option<Vec<String>>,
    /// Scene files may name files outside their own folders (buffers, images, material libraries).
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub allow_outside: bool,
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
    /// What is there to be seen and to cast shadows.
    pub visibility: VisibilityParams,
    /// The bound that maps have to meet.
    pub quality: QualityParams,
    /// What maps may look like.
    pub map: MapParams,
    /// What a renderer makes of the maps' answers.
    #[serde(skip_serializing_if = "is_plain")]
    pub lookup: LookupParams,
    /// How finely shadow edges are looked for.
    pub sampling: SamplingParams,
    /// How matrices are found.
    pub solver: SolverParams,
    /// How the maps of neighbouring frames hang together.
    pub shot: TemporalParams,
    /// Limits on texels, instead of the bound.
    #[serde(skip_serializing_if = "is_default")]
    pub budget: BudgetParams,
}

fn is_default(budget: &BudgetParams) -> bool {
    !budget.is_given()
}

fn is_plain(lookup: &LookupParams) -> bool {
    *lookup == LookupParams::default()
}

/// The two ways of writing `scene` and `animation`, for the schema only.
#[derive(JsonSchema)]
#[schemars(untagged)]
#[expect(dead_code, reason = "never built: it describes what `one_or_many` accepts")]
enum OneOrMany<T> {
    One(T),
    Many(Vec<T>),
}

/// `scene`.
fn scene_files<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<SceneFile>, D::Error> {
    one_or_many(deserializer, "a file name, a table with `file`, or a list of these")
}

/// `animation`; not called where the key is missing.
fn animations<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Vec<String>>, D::Error> {
    one_or_many(deserializer, "a name or a list of names").map(Some)
}

/// Reads one or a list of what is written as a string or a table. A visitor rather than an untagged enum: those lose the
/// line of an error.
fn one_or_many<'de, D, T>(deserializer: D, expected: &'static str) -> Result<Vec<T>, D::Error>
where
    D: Deserializer<'de>,
    T: Deserialize<'de>,
{
    struct Entries<T> {
        expected: &'static str,
        of: PhantomData<T>,
    }
    impl<'de, T: Deserialize<'de>> Visitor<'de> for Entries<T> {
        type Value = Vec<T>;

        fn expecting(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
            f.write_str(self.expected)
        }

        fn visit_str<E: de::Error>(self, text: &str) -> Result<Self::Value, E> {
            Ok(vec![T::deserialize(StrDeserializer::new(text))?])
        }

        fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
            Ok(vec![T::deserialize(MapAccessDeserializer::new(map))?])
        }

        fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Self::Value, A::Error> {
            let mut entries = Vec::new();
            while let Some(entry) = seq.next_element()? {
                entries.push(entry);
            }
            Ok(entries)
        }
    }
    deserializer.deserialize_any(Entries { expected, of: PhantomData })
}

/// Extensions of scene files, lower case.
pub const SCENE_EXTENSIONS: [&str; 3] = ["gltf", "glb", "obj"];

/// True for a path whose extension is a scene file's.
pub fn is_scene_file(path: &Path) -> bool {
    path.extension()
        .and_then(|e| e.to_str())
        .is_some_and(|e| SCENE_EXTENSIONS.contains(&e.to_ascii_lowercase().as_str()))
}
