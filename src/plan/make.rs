//! From a job to a plan: its files before the stages (`pieces`), and the whole after them.

use std::path::Path;

use super::stage::Stages;
use super::{
    FramePlan, LightPlan, Plan, PlanCamera, PlanError, PlannedJob, Stage, Watch, hash_inputs, make_in, relative_path,
};
use crate::job::{Job, LoadedJob};
use crate::math::rows_of;
use crate::scene::{self, Camera, Film, FrameTime, Shot, ShotParams};

/// Reads the files of a job.
pub(crate) fn load_shot(job: &LoadedJob) -> Result<Shot, PlanError> {
    let params = ShotParams {
        scene: &job.scene_files(),
        active_scene: job.job.active_scene.as_deref(),
        animation: job.job.animation.as_deref(),
        frames: &job.job.frames,
        image: &job.job.image,
        camera: &job.camera(),
        lights: &job.job.light,
        visibility: &job.job.visibility,
    };
    Ok(scene::load(&params)?)
}

/// Plans a shot. Paths in the plan are relative to `plan_dir`; `timings` puts wall times into the plan's costs.
///
/// # Errors
/// [`PlanError::Cancelled`] soon after the watch asks to stop; else what stands in the way.
pub fn make(loaded: &LoadedJob, plan_dir: &Path, timings: bool, watch: &Watch) -> Result<Plan, PlanError> {
    make_in(loaded, plan_dir, timings, None, watch)
}

/// A job with its files read.
pub(super) struct Loaded<'a> {
    /// As it was given.
    pub(super) given: &'a LoadedJob,
    /// In scene space.
    pub(super) job: Job,
    pub(super) shot: Shot,
}

impl<'a> Loaded<'a> {
    /// Reads the files.
    pub(super) fn new(given: &'a LoadedJob, watch: &Watch) -> Result<Loaded<'a>, PlanError> {
        watch.step(Stage::Load, 0, 1)?;
        let shot = load_shot(given)?;
        let solver = given.job.solver.in_scene_space(shot.scene.origin);
        let job = Job { solver, ..given.job.clone() };
        for note in &shot.scene.notes {
            watch.note(note);
        }
        Ok(Loaded { given, job, shot })
    }

    /// Sorts the still triangles.
    pub(super) fn stages(&self) -> Stages<'_> {
        Stages::new(&self.shot, &self.job)
    }
}

/// The plan of all frames.
pub(super) fn finished(loaded: &Loaded, plan_dir: &Path, frames: Vec<FramePlan>) -> Result<Plan, PlanError> {
    let Loaded { given, shot, .. } = loaded;
    let inputs = hash_inputs(&shot.scene.inputs, plan_dir)?;
    let mut resolved = given.job.clone();
    resolved.scene = given.scene_files().iter().map(|f| f.at(relative_path(f.path(), plan_dir).into())).collect();
    resolved.camera.file = given.camera().file.map(|file| relative_path(&file, plan_dir).into());
    if !shot.scene.animations.is_empty() {
        resolved.animation = Some(shot.scene.animations.clone());
    }
    Ok(Plan::new(PlannedJob { job: resolved, inputs }, shot.scene.origin.to_array(), frames))
}

/// A frame of the plan.
pub(super) fn frame_entry(time: FrameTime, camera: &Camera, film: Film, lights: Vec<LightPlan>) -> FramePlan {
    FramePlan {
        frame: time.frame,
        time_s: time.time_s,
        camera: PlanCamera {
            name: camera.name.clone(),
            clip_from_world: rows_of(&camera.clip_from_scene(film)),
            position: camera.position.to_array(),
            width: film.width,
            height: film.height,
        },
        lights,
    }
}
