//! From an input named on the command line to a resolved job.

use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use serde::Deserialize;
use toml::{Table, Value};

use super::layers::lay_over;
use super::{Job, JobError, Preset, Problem, check, is_scene_file, locate};
use crate::resolution::Measure;
use crate::scene::{self, CameraParams, SceneError, SceneFile, Shot, ShotParams, ShownByImages, VisibilitySource};

/// Bytes a job file may have: room for a long camera path, and an end to reading a device.
const JOB_BYTES_MAX: u64 = 16 << 20;

/// A job with all layers resolved.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadedJob {
    /// The job; its values hold, epsilon included.
    pub job: Job,
    /// The job file; `None` when the input is a scene.
    pub file: Option<PathBuf>,
    /// The folder that `job.scene` is relative to.
    pub dir: PathBuf,
}

impl LoadedJob {
    /// The scene files, with paths that can be opened.
    pub fn scene_files(&self) -> Vec<SceneFile> {
        self.job.scene.iter().map(|scene| scene.at(self.dir.join(scene.path()))).collect()
    }

    /// The same job with settings laid over all of its own.
    ///
    /// # Errors
    /// [`JobError::Override`] for settings that no job may have, or that do not go with this one.
    pub fn with(&self, settings: &Table) -> Result<LoadedJob, JobError> {
        let unwritable = |e: toml::ser::Error| Problem {
            key: "job".to_owned(),
            message: format!("it cannot be written as TOML: {e}"),
            help: "please report this with the job".to_owned(),
        };
        let mut table = Table::try_from(&self.job).map_err(|e| JobError::Override(unwritable(e)))?;
        lay_over(&mut table, settings);
        let job = Job::deserialize(table).map_err(|e| JobError::Override(locate::table_problem(&e)))?;
        check(&job).map_err(JobError::Override)?;
        Ok(LoadedJob { job, ..self.clone() })
    }

    /// `[aov] file`, with paths that can be opened.
    pub fn image_files(&self) -> Vec<PathBuf> {
        self.job.aov.iter().flat_map(|aov| &aov.file).map(|file| self.dir.join(file)).collect()
    }

    /// `[camera]`, with a path that can be opened.
    pub fn camera(&self) -> CameraParams {
        let camera = self.job.camera.clone();
        CameraParams { file: camera.file.map(|file| self.dir.join(file)), ..camera }
    }

    /// Reads its scene files.
    ///
    /// # Errors
    /// As [`scene::load`].
    pub fn shot(&self) -> Result<Shot, SceneError> {
        self.shot_with(None)
    }

    /// The same with what images show instead of geometry.
    ///
    /// # Errors
    /// As [`scene::load`].
    pub(crate) fn shot_with(&self, images: Option<ShownByImages>) -> Result<Shot, SceneError> {
        let job = &self.job;
        scene::load(&ShotParams {
            scene: &self.scene_files(),
            active_scene: job.active_scene.as_deref(),
            animation: job.animation.as_deref(),
            frames: &job.frames,
            image: &job.image,
            camera: &self.camera(),
            lights: &job.light,
            visibility: &job.visibility,
            allow_outside: job.allow_outside,
            images,
        })
    }
}

/// Reads a job file, or takes a scene file as a job of its own, lays `overrides` over it and checks every value.
///
/// # Errors
/// [`JobError::InFile`] for what is wrong in the file itself, [`JobError::Override`] for what the overrides break.
pub fn load(input: &Path, overrides: &Table) -> Result<LoadedJob, JobError> {
    let dir = input.parent().map(Path::to_owned).unwrap_or_default();
    if is_scene_file(input) {
        let name = input.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let own = Table::from_iter([("scene".to_owned(), Value::String(name))]);
        return Ok(LoadedJob { job: resolve(&own, overrides)?, file: None, dir });
    }
    if !input.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml")) {
        return Err(JobError::Kind { path: input.to_owned() });
    }
    let text = read_text(input)?;
    let parse_error = |e: toml::de::Error| locate::parse_error(input, &text, &e);
    let own: Table = toml::from_str(&text).map_err(parse_error)?;
    // Read from the text for errors that know their place, and from the table for what that lets pass: surplus elements
    // of a list of fixed length.
    toml::from_str::<Job>(&text).map_err(parse_error)?;
    let refused = |problem: Problem| locate::problem(input, &text, problem);
    let mut alone = Job::deserialize(own.clone()).map_err(|e| refused(locate::table_problem(&e)))?;
    if alone.visibility.source == VisibilitySource::Aov && !says_measure(&own) {
        alone.quality.measure = Measure::Never;
    }
    check(&alone).map_err(refused)?;
    Ok(LoadedJob { job: resolve(&own, overrides)?, file: Some(input.to_owned()), dir })
}

/// Lays preset, file and overrides over each other. The file is known to be right by itself.
fn resolve(own: &Table, overrides: &Table) -> Result<Job, JobError> {
    let fault = |e: toml::de::Error| JobError::Override(locate::table_problem(&e));
    let preset = match overrides.get("preset").or_else(|| own.get("preset")) {
        Some(name) => Preset::deserialize(name.clone())
            .map_err(|e| JobError::Override(Problem { key: "preset".to_owned(), ..locate::table_problem(&e) }))?,
        None => Preset::default(),
    };
    let mut table: Table = toml::from_str(preset.text()).map_err(fault)?;
    lay_over(&mut table, own);
    lay_over(&mut table, overrides);
    let mut job = Job::deserialize(table).map_err(fault)?;
    if job.visibility.source == VisibilitySource::Aov && !says_measure(own) && !says_measure(overrides) {
        job.quality.measure = Measure::Never;
    }
    check(&job).map_err(JobError::Override)?;
    job.quality.epsilon = Some(job.quality.epsilon());
    Ok(job)
}

/// Whether a layer itself states `quality.measure`: presets do, for scenes.
fn says_measure(layer: &Table) -> bool {
    layer.get("quality").and_then(|quality| quality.get("measure")).is_some()
}

fn read_text(path: &Path) -> Result<String, JobError> {
    let failed = |source: io::Error| JobError::Read { path: path.to_owned(), source };
    let file = File::open(path).map_err(failed)?;
    if file.metadata().map_err(failed)?.is_dir() {
        return Err(failed(io::Error::from(io::ErrorKind::IsADirectory)));
    }
    let mut bytes = Vec::new();
    file.take(JOB_BYTES_MAX + 1).read_to_end(&mut bytes).map_err(failed)?;
    if bytes.len() as u64 > JOB_BYTES_MAX {
        return Err(JobError::TooLarge { path: path.to_owned(), limit: JOB_BYTES_MAX });
    }
    String::from_utf8(bytes).map_err(|e| {
        let at = e.utf8_error().valid_up_to();
        let text = String::from_utf8_lossy(e.as_bytes()).into_owned();
        locate::located(
            path,
            &text,
            at..at + 1,
            "this is not UTF-8".to_owned(),
            Some("save the file as UTF-8".to_owned()),
        )
    })
}
