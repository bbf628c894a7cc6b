//! Flags that override keys of a job. They become a TOML table, the last layer of the job.

use clap::Args;
use lixel::job::Preset;
use lixel::methods::Method;
use lixel::resolution::{Bound, Measure};
use lixel::shot::Temporal;
use toml::{Table, Value};

use super::exit::Failure;
use super::values::{budget, integer, size, values};

/// Flags over a job file, or over the defaults of a scene file.
#[derive(Clone, Args)]
#[command(next_help_heading = "Over the job")]
pub(super) struct JobFlags {
    /// Frames: 12, 1-240, 1-240x2, or several with commas
    #[arg(long, value_name = "RANGE", allow_hyphen_values = true)]
    frames: Option<String>,
    /// Image size in pixels
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<[u32; 2]>,
    /// Camera of the scene's files, by name
    #[arg(long, value_name = "NAME")]
    camera: Option<String>,
    /// Scene of the glTF files that hold several, by name
    #[arg(long, value_name = "NAME")]
    active_scene: Option<String>,
    /// Animation that plays, by name; may be given several times [default: all that go together]
    #[arg(long, value_name = "NAME")]
    animation: Vec<String>,
    /// Scene files may name files outside their own folders
    #[arg(long)]
    allow_outside: bool,
    /// The bound: a share of the image's pixels, or pixels
    #[arg(long, value_name = "E", allow_negative_numbers = true)]
    epsilon: Option<f64>,
    /// Most texels instead of a bound: N drawn over the shot; or KEY=N of [budget], several with commas
    ///
    /// Keys are texels_total, texels_per_frame and bytes; N may end in k, M or G (thousands), or in Ki, Mi or Gi (1024s).
    #[arg(long, value_name = "N", conflicts_with = "epsilon", value_parser = budget)]
    budget: Option<toml::Table>,
    /// What epsilon bounds
    #[arg(long, value_parser = values::<Bound>())]
    bound: Option<String>,
    /// How the matrix is chosen
    #[arg(long, value_parser = values::<Method>())]
    method: Option<String>,
    /// Most maps of a light with --method auto
    #[arg(long, value_name = "N")]
    max_maps: Option<u32>,
    /// Largest width and height of a map, texels
    #[arg(long, value_name = "N")]
    max_resolution: Option<u32>,
    /// Whether sizes are measured
    #[arg(long, value_parser = values::<Measure>())]
    measure: Option<String>,
    /// How the maps of neighbouring frames hang together; `compare` takes several, with commas
    #[arg(long, value_parser = values::<Temporal>(), value_delimiter = ',', value_name = "MODE")]
    pub(super) temporal: Vec<String>,
    /// The settings below the job's own
    #[arg(long, value_parser = values::<Preset>())]
    preset: Option<String>,
}

impl JobFlags {
    /// Every flag: its name, its key, and its value if it was given.
    fn entries(&self) -> [(&'static str, &'static str, Option<Value>); 15] {
        let one = |values: &[String]| match values {
            [value] => Some(Value::String(value.clone())),
            _ => None,
        };
        let text = |value: &Option<String>| value.clone().map(Value::String);
        let names = |names: &[String]| Value::Array(names.iter().cloned().map(Value::String).collect());
        [
            ("--frames", "frames.range", text(&self.frames)),
            ("--size", "image.size", self.size.map(|s| Value::Array(s.map(integer).into()))),
            ("--camera", "camera.name", text(&self.camera)),
            ("--active-scene", "active_scene", text(&self.active_scene)),
            ("--animation", "animation", (!self.animation.is_empty()).then(|| names(&self.animation))),
            ("--allow-outside", "allow_outside", self.allow_outside.then_some(Value::Boolean(true))),
            ("--epsilon", "quality.epsilon", self.epsilon.map(Value::Float)),
            ("--budget", "budget", self.budget.clone().map(Value::Table)),
            ("--bound", "quality.bound", text(&self.bound)),
            ("--method", "solver.method", text(&self.method)),
            ("--max-maps", "solver.max_maps", self.max_maps.map(integer)),
            ("--max-resolution", "map.max", self.max_resolution.map(integer)),
            ("--measure", "quality.measure", text(&self.measure)),
            ("--temporal", "shot.temporal", one(&self.temporal)),
            ("--preset", "preset", text(&self.preset)),
        ]
    }

    /// The flags as the last layer of a job.
    pub(super) fn overrides(&self) -> Table {
        let mut table = Table::new();
        for (_, key, value) in self.entries() {
            let Some(value) = value else { continue };
            match key.split_once('.') {
                None => {
                    table.insert(key.to_owned(), value);
                }
                Some((section, key)) => {
                    let section = table.entry(section).or_insert_with(|| Value::Table(Table::new()));
                    if let Value::Table(section) = section {
                        section.insert(key.to_owned(), value);
                    }
                }
            }
        }
        table
    }

    /// For a command whose `--frames` are those of a piece: the flags with the whole shot's frames, and the piece's.
    pub(super) fn of_shot(&self, shot: Option<&str>) -> (JobFlags, Option<&str>) {
        (JobFlags { frames: shot.map(str::to_owned), ..self.clone() }, self.frames.as_deref())
    }

    /// Refuses several temporal modes, for commands that plan once.
    pub(super) fn one_temporal(&self) -> Result<(), Failure> {
        match self.temporal.len() {
            0 | 1 => Ok(()),
            n => Err(Failure::Setup(format!(
                "--temporal names {n} modes; give one, or compare them with `lixel compare`"
            ))),
        }
    }

    /// The flags that were given, with their keys.
    pub(super) fn given(&self) -> Vec<(&'static str, &'static str)> {
        self.entries().into_iter().filter(|e| e.2.is_some()).map(|(flag, key, _)| (flag, key)).collect()
    }
}
