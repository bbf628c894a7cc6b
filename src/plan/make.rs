//! From a job to a plan: its files before the stages (`pieces`), and the whole after them.

use std::path::Path;
use std::time::Instant;

use super::pieces::planned;
use super::stage::Stages;
use super::{
    FramePlan, LightPlan, Plan, PlanCamera, PlanError, PlannedJob, Stage, Timings, Watch, across, budget, hash_inputs,
    images, make_in, relative_path,
};
use crate::aov::Images;
use crate::job::{Job, LoadedJob};
use crate::math::rows_of;
use crate::scene::{Camera, Film, FrameTime, Shot, ShownByImages, VisibilitySource};

/// Reads the files of a job that is planned from geometry.
pub(crate) fn load_shot(job: &LoadedJob) -> Result<Shot, PlanError> {
    if job.job.visibility.source == VisibilitySource::Aov {
        return Err(PlanError::NoGeometry);
    }
    Ok(job.shot()?)
}

/// Reads the files of a job; with the images that are planned from, where it says so.
pub(super) fn load_either(job: &LoadedJob) -> Result<(Shot, Option<Images>), PlanError> {
    if job.job.visibility.source == VisibilitySource::Scene {
        return Ok((job.shot()?, None));
    }
    let images = images::open(job)?;
    let mut job = job.clone();
    let numbers: Vec<String> = images.frames.iter().map(ToString::to_string).collect();
    job.job.frames.range = Some(numbers.join(","));
    job.job.image.size = Some([images.film.width, images.film.height]);
    let shot = job.shot_with(Some(ShownByImages { cameras: &images.cameras, files: &images.files }))?;
    Ok((shot, Some(images)))
}

/// Loading, then sorting.
const LOAD_STEPS: u64 = 2;

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
    /// Planned from, where the job says so.
    images: Option<Images>,
    begin: Instant,
    load_s: f64,
}

/// When a job was opened, and what that took.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Opening {
    begin: Instant,
    load_s: f64,
    sort_s: f64,
}

impl<'a> Loaded<'a> {
    /// Reads the files of a job whose shot is to be planned.
    pub(super) fn new(given: &'a LoadedJob, watch: &Watch) -> Result<Loaded<'a>, PlanError> {
        let loaded = Loaded::read(given, watch)?;
        consecutive(&loaded.shot, &loaded.job)?;
        Ok(loaded)
    }

    fn read(given: &'a LoadedJob, watch: &Watch) -> Result<Loaded<'a>, PlanError> {
        let begin = Instant::now();
        watch.step(Stage::Load, 0, LOAD_STEPS)?;
        let (shot, images) = load_either(given)?;
        let load_s = begin.elapsed().as_secs_f64();
        watch.step(Stage::Load, 1, LOAD_STEPS)?;
        for note in &shot.scene.notes {
            watch.note(note);
        }
        if let Some(images) = &images {
            watch.note(images::NOTE);
            images.notes.iter().for_each(|note| watch.note(note));
        }
        Ok(Loaded { given, job: in_scene_space(&given.job, &shot), shot, images, begin, load_s })
    }

    /// Sorts the still triangles.
    pub(super) fn stages(&self, watch: &Watch) -> Result<(Stages<'_>, Opening), PlanError> {
        let start = Instant::now();
        let stages = Stages::new(&self.shot, &self.job, self.images.as_ref());
        let sort_s = start.elapsed().as_secs_f64();
        watch.step(Stage::Load, LOAD_STEPS, LOAD_STEPS)?;
        Ok((stages, Opening { begin: self.begin, load_s: self.load_s, sort_s }))
    }
}

/// Reads the files of a job, sets the stages of its frames and hands them over.
///
/// # Errors
/// When files cannot be read or used; and those of `work`.
pub(crate) fn open<R>(
    loaded: &LoadedJob,
    watch: &Watch,
    work: impl FnOnce(&Stages, &Opening) -> Result<R, PlanError>,
) -> Result<R, PlanError> {
    let loaded = Loaded::read(loaded, watch)?;
    let (stages, opening) = loaded.stages(watch)?;
    work(&stages, &opening)
}

/// Plans a shot on stages that were set for it, with wall times where its opening is given.
///
/// # Errors
/// As [`make`].
pub(crate) fn plan_on(
    loaded: &LoadedJob,
    stages: &Stages,
    plan_dir: &Path,
    opening: Option<&Opening>,
    watch: &Watch,
) -> Result<Plan, PlanError> {
    consecutive(stages.shot, stages.job)?;
    let frames = planned(stages, opening.is_some(), watch)?;
    finished(loaded, stages, frames, plan_dir, opening, watch)
}

/// Whether the frames are those that a renderer shows one after the other, where that is asked.
fn consecutive(shot: &Shot, job: &Job) -> Result<(), PlanError> {
    let gap = shot.frames.windows(2).find(|w| w[1].frame != w[0].frame + 1);
    match gap {
        Some(gap) if job.lookup.is_temporal() => {
            Err(PlanError::NotConsecutive { before: gap[0].frame, after: gap[1].frame })
        }
        _ => Ok(()),
    }
}

/// The plan of frames that were planned by epsilon: within the job's budget, and as a renderer shows them that blends answers
/// over time.
pub(super) fn finished(
    loaded: &LoadedJob,
    stages: &Stages,
    mut frames: Vec<FramePlan>,
    plan_dir: &Path,
    opening: Option<&Opening>,
    watch: &Watch,
) -> Result<Plan, PlanError> {
    let (shot, job) = (stages.shot, stages.job);
    if job.budget.is_given() {
        budget::within(stages, &mut frames, watch)?;
    }
    if frames.len() > 1 && (job.budget.is_given() || job.lookup.is_temporal()) {
        across::complete(stages, &mut frames, watch)?;
    }
    let inputs = hash_inputs(&shot.scene.inputs, plan_dir)?;
    let mut resolved = loaded.job.clone();
    resolved.scene = loaded.scene_files().iter().map(|f| f.at(relative_path(f.path(), plan_dir).into())).collect();
    resolved.camera.file = loaded.camera().file.map(|file| relative_path(&file, plan_dir).into());
    if let Some(aov) = &mut resolved.aov {
        aov.file = loaded.image_files().iter().map(|file| images::relative_pattern(file, plan_dir)).collect();
    }
    if !shot.scene.animations.is_empty() {
        resolved.animation = Some(shot.scene.animations.clone());
    }
    let mut plan = Plan::new(PlannedJob { job: resolved, inputs }, shot.scene.origin.to_array(), frames);
    if let Some(Opening { begin, load_s, sort_s }) = opening.copied() {
        let total_s = begin.elapsed().as_secs_f64();
        plan.timings = Some(Timings { load_s, sort_s, total_s, load_share: load_s / total_s });
    }
    Ok(plan)
}

/// A job whose settings in world space are in that of a shot's scene.
pub(crate) fn in_scene_space(job: &Job, shot: &Shot) -> Job {
    Job { solver: job.solver.in_scene_space(shot.scene.origin), ..job.clone() }
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
