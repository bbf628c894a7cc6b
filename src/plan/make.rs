//! From a job to a plan: the stages in order, frame by frame.

use std::path::Path;

use super::light_entry::{FrameStage, light_entry, measures};
use super::{FramePlan, Plan, PlanCamera, PlanError, PlannedJob, Stage, Watch, hash_inputs, relative_path};
use crate::job::{Job, LoadedJob};
use crate::math::{Bounds, rows_of};
use crate::samples::{Grid, GridView};
use crate::scene::{self, Shot, ShotParams};
use crate::visibility::{Bvh, RayOffset, Tracer, see};

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
    watch.step(Stage::Load, 0, 1)?;
    let shot = load_shot(loaded)?;
    let solver = loaded.job.solver.in_scene_space(shot.scene.origin);
    let job = &Job { solver, ..loaded.job.clone() };
    for note in &shot.scene.notes {
        watch.note(note);
    }
    let still = Bvh::build(&shot.scene.still);
    let still_bounds = Bounds::of(shot.scene.still.iter().flatten().map(|v| v.as_dvec3()));
    watch.step(Stage::Load, 1, 1)?;

    let mut frames = Vec::with_capacity(shot.frames.len());
    let mut done = 0;
    for time in &shot.frames {
        let frame = shot.scene.frame(time.time_s)?;
        let geometry = shot.scene.geometry(&frame);
        let moving = (!frame.moving.is_empty()).then(|| Bvh::build(&frame.moving));
        let tracer = Tracer::new(geometry, &still, moving.as_ref());
        let bounds = still_bounds.union(Bounds::of(frame.moving.iter().flatten().map(|v| v.as_dvec3())));
        let view = measures(job).then(|| see(&tracer, &frame.camera, shot.film));
        let grid = GridView::see(&tracer, &frame.camera, Grid::new(shot.film, job.sampling.grid), view.as_ref());
        let primary = match &view {
            Some(_) if grid.grid.is_film() => shot.film.pixels(),
            Some(_) => grid.grid.len() + shot.film.pixels(),
            None => grid.grid.len(),
        };
        let stage = FrameStage {
            tracer: &tracer,
            camera: &frame.camera,
            film: shot.film,
            grid: &grid,
            view: view.as_ref(),
            bounds,
            offset: RayOffset::for_scene(&tracer),
            rays_share: (primary / frame.lights.len().max(1)) as u64,
        };
        let total = (shot.frames.len() * frame.lights.len()) as u64;
        let mut lights = Vec::with_capacity(frame.lights.len());
        for light in &frame.lights {
            watch.step(Stage::Lights, done, total)?;
            lights.push(light_entry(&stage, light, job, timings)?);
            done += 1;
        }
        watch.step(Stage::Lights, done, total)?;
        frames.push(FramePlan {
            frame: time.frame,
            time_s: time.time_s,
            camera: PlanCamera {
                name: frame.camera.name.clone(),
                clip_from_world: rows_of(&frame.camera.clip_from_scene(shot.film)),
                position: frame.camera.position.to_array(),
                width: shot.film.width,
                height: shot.film.height,
            },
            lights,
        });
    }
    let inputs = hash_inputs(&shot.scene.inputs, plan_dir)?;
    let mut resolved = loaded.job.clone();
    resolved.scene = loaded.scene_files().iter().map(|f| f.at(relative_path(f.path(), plan_dir).into())).collect();
    resolved.camera.file = loaded.camera().file.map(|file| relative_path(&file, plan_dir).into());
    if !shot.scene.animations.is_empty() {
        resolved.animation = Some(shot.scene.animations.clone());
    }
    Ok(Plan::new(PlannedJob { job: resolved, inputs }, shot.scene.origin.to_array(), frames))
}
