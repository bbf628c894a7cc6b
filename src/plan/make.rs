//! From a job to a plan: the stages in order, frame by frame.

use std::path::Path;

use super::light_entry::light_entry;
use super::stage::Stages;
use super::{
    FramePlan, LightPlan, Plan, PlanCamera, PlanError, PlannedJob, Stage, Watch, across, hash_inputs, images,
    relative_path, whole_shot,
};
use crate::aov::Images;
use crate::job::{Job, LoadedJob};
use crate::math::rows_of;
use crate::scene::{self, Camera, Film, FrameTime, Shot, ShotParams, ShownByImages, VisibilitySource};
use crate::shot::Temporal;

/// Reads the files of a job that is planned from geometry.
pub(crate) fn load_shot(job: &LoadedJob) -> Result<Shot, PlanError> {
    if job.job.visibility.source == VisibilitySource::Aov {
        return Err(PlanError::NoGeometry);
    }
    load(job, None)
}

/// Reads the files of a job; with the images that are planned from, where it says so.
pub(super) fn load_either(job: &LoadedJob) -> Result<(Shot, Option<Images>), PlanError> {
    if job.job.visibility.source == VisibilitySource::Scene {
        return Ok((load(job, None)?, None));
    }
    let images = images::open(job)?;
    Ok((load(job, Some(&images))?, Some(images)))
}

fn load(job: &LoadedJob, images: Option<&Images>) -> Result<Shot, PlanError> {
    let (mut frames, mut image) = (job.job.frames.clone(), job.job.image.clone());
    if let Some(images) = images {
        let numbers: Vec<String> = images.frames.iter().map(ToString::to_string).collect();
        frames.range = Some(numbers.join(","));
        image.size = Some([images.film.width, images.film.height]);
    }
    let params = ShotParams {
        scene: &job.scene_files(),
        active_scene: job.job.active_scene.as_deref(),
        animation: job.job.animation.as_deref(),
        frames: &frames,
        image: &image,
        camera: &job.camera(),
        lights: &job.job.light,
        visibility: &job.job.visibility,
        images: images.map(|images| ShownByImages { cameras: &images.cameras, files: &images.files }),
    };
    Ok(scene::load(&params)?)
}

/// Plans a shot. Paths in the plan are relative to `plan_dir`; `timings` puts wall times into the plan's costs.
///
/// # Errors
/// [`PlanError::Cancelled`] soon after the watch asks to stop; else what stands in the way.
pub fn make(loaded: &LoadedJob, plan_dir: &Path, timings: bool, watch: &Watch) -> Result<Plan, PlanError> {
    watch.step(Stage::Load, 0, 1)?;
    let (shot, images) = load_either(loaded)?;
    let solver = loaded.job.solver.in_scene_space(shot.scene.origin);
    let job = &Job { solver, ..loaded.job.clone() };
    for note in &shot.scene.notes {
        watch.note(note);
    }
    if let Some(images) = &images {
        watch.note(images::NOTE);
        images.notes.iter().for_each(|note| watch.note(note));
    }
    let stages = Stages::new(&shot, job, images.as_ref());
    watch.step(Stage::Load, 1, 1)?;
    let mode = if shot.frames.len() > 1 { job.shot.temporal } else { Temporal::PerFrame };
    let mut frames = match mode {
        Temporal::PerFrame => per_frame(&stages, timings, watch)?,
        _ => whole_shot::plan(&stages, timings, watch)?,
    };
    if shot.frames.len() > 1 {
        across::complete(&stages, &mut frames, watch)?;
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
    Ok(Plan::new(PlannedJob { job: resolved, inputs }, shot.scene.origin.to_array(), frames))
}

/// Each frame for itself.
fn per_frame(stages: &Stages, timings: bool, watch: &Watch) -> Result<Vec<FramePlan>, PlanError> {
    let mut done = 0;
    let mut frame_plan = |k: usize| {
        stages.with(k, |stage, frame| {
            let total = (stages.len() * frame.lights.len()) as u64;
            let mut lights = Vec::with_capacity(frame.lights.len());
            for light in &frame.lights {
                watch.step(Stage::Lights, done, total)?;
                lights.push(light_entry(stage, light, stages.job, timings, None)?);
                done += 1;
            }
            watch.step(Stage::Lights, done, total)?;
            Ok(frame_entry(stages.time(k), &frame.camera, stage.film, lights))
        })
    };
    (0..stages.len()).map(&mut frame_plan).collect()
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
