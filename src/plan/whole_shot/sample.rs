//! The first way through the frames: what is kept of each light.

use super::super::light_entry::no_map_needed;
use super::super::stage::{FrameStage, Stages};
use super::super::{FromImages, LightPlan, PlanError, Stage, Watch};
use crate::job::Job;
use crate::scene::{Camera, Light};
use crate::shot::{Content, LightPart, LightParts, light_part};

/// What is kept of a shot.
pub(super) struct Sampled {
    /// One a frame.
    pub(super) cameras: Vec<Camera>,
    /// One a light, in the order of the scene.
    pub(super) lights: Vec<LightParts>,
}

/// Samples every light of every frame.
pub(super) fn sample(stages: &Stages, watch: &Watch) -> Result<Sampled, PlanError> {
    let mut cameras = Vec::with_capacity(stages.len());
    let mut by_light: Vec<Vec<LightPart>> = Vec::new();
    for k in 0..stages.len() {
        watch.step(Stage::Samples, k as u64, stages.len() as u64)?;
        stages.with(k, |stage, frame| {
            by_light.resize_with(frame.lights.len(), Vec::new);
            for (parts, light) in by_light.iter_mut().zip(&frame.lights) {
                watch.check()?;
                parts.push(part(stage, light, stages.job));
            }
            cameras.push(frame.camera.clone());
            Ok(())
        })?;
    }
    watch.step(Stage::Samples, stages.len() as u64, stages.len() as u64)?;
    Ok(Sampled { cameras, lights: by_light.into_iter().filter_map(LightParts::new).collect() })
}

/// One light of one frame.
fn part(stage: &FrameStage, light: &Light, job: &Job) -> LightPart {
    let lit = stage.look(light, job);
    let mut part =
        light_part(light, stage.camera, &lit.samples, lit.film.as_ref(), job.map.outside, stage.tracer.geometry());
    part.rays = stage.rays_share + lit.rays;
    if stage.images.is_some() {
        part.content = Content::unknown(stage.place);
    }
    part
}

/// The entry of a frame that needs no map.
pub(super) fn needless(stages: &Stages, part: &LightPart) -> LightPlan {
    let mut entry = LightPlan::unplanned(&part.light, stages.job.quality.epsilon());
    (entry.cost.samples, entry.cost.rays) = (part.samples, part.rays);
    entry.images = stages.images.map(|_| FromImages::of(&part.light, stages.job));
    no_map_needed(&mut entry, part.facing, stages.job);
    entry
}
