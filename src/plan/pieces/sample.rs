//! The first stage: what is kept of a frame.

use super::super::light_entry::light_entry;
use super::super::stage::{FrameStage, Stages};
use super::super::{PlanError, Watch, whole_shot};
use super::same::{SameFrames, is_asked};
use super::{Answer, FrameLight, FrameState};
use crate::depth::{Visible, reach};
use crate::resolution::fit_light;
use crate::scene::Light;
use crate::shot::{Content, LightPart, Temporal, light_part};
use crate::visibility::Answer as Seen;
use glam::DVec3;

/// Samples a frame, by place. Where its lights are planned each frame for itself, they are planned here, but for those for
/// which the frame is the `same` as an earlier one.
pub(super) fn sample_frame(
    stages: &Stages,
    place: usize,
    same: &mut SameFrames,
    timings: bool,
    watch: &Watch,
) -> Result<FrameState, PlanError> {
    let first = if alone(stages) && is_asked(stages) { same.first(stages, place)? } else { Vec::new() };
    let first_of = |k: usize| first.get(k).copied().flatten();
    if !first.is_empty() && first.iter().all(Option::is_some) {
        let scene = stages.shot.scene.frame(stages.time(place).time_s)?;
        let refers = |(light, same_as)| FrameLight { same_as, ..FrameLight::new(light) };
        let lights = scene.lights.into_iter().zip(first).map(refers).collect();
        return Ok(FrameState { place, camera: scene.camera, lights });
    }
    stages.with(place, |stage, scene| {
        let mut lights = Vec::with_capacity(scene.lights.len());
        for (k, light) in scene.lights.iter().enumerate() {
            watch.check()?;
            lights.push(match first_of(k) {
                Some(first) => FrameLight { same_as: Some(first), ..FrameLight::new(light.clone()) },
                None => sampled(stages, stage, light, timings)?,
            });
        }
        Ok(FrameState { place, camera: scene.camera.clone(), lights })
    })
}

/// Whether each frame is planned for itself, whatever it shows.
fn alone(stages: &Stages) -> bool {
    match stages.mode() {
        Temporal::PerFrame => true,
        Temporal::Hysteresis => stages.images.is_some(),
        Temporal::Shot | Temporal::Snapped => whole_shot::refused(stages).is_some(),
    }
}

fn sampled(stages: &Stages, stage: &FrameStage, light: &Light, timings: bool) -> Result<FrameLight, PlanError> {
    let job = stages.job;
    let mut state = FrameLight::new(light.clone());
    if alone(stages) {
        let entry = light_entry(stage, light, job, timings, None)?;
        state.answer = Some(Answer::alone(entry));
        return Ok(state);
    }
    let lit = stage.look(light, job);
    let film = lit.film.as_ref();
    let mut part = light_part(light, stage.camera, &lit.samples, film, job.map.outside, stage.tracer.geometry());
    part.rays = stage.rays_share + lit.rays;
    if part.needed == 0 {
        state.part = Some(LightPart { edges: Vec::new(), cover: Vec::new(), ..part });
        return Ok(state);
    }
    if stages.mode() == Temporal::Hysteresis {
        let fitted = fit_light(&stage.question(light, job), &lit.samples, film).ok();
        state.fresh = fitted.map(|mut fitted| {
            fitted.covered.clone_from(&part.cover);
            fitted.regions.iter_mut().for_each(|r| *r = r.over(&[], 0));
            fitted
        });
    } else {
        let from_grid = || grid_positions(stage, &lit.answers);
        let visible = film.map_or_else(from_grid, |film| film.positions.clone());
        part.reach = reach(stage.tracer, light, &part.cover, &Visible::new(&visible));
    }
    state.part = Some(part);
    Ok(state)
}

/// The planning-grid positions that look a light's maps up.
fn grid_positions(stage: &FrameStage, answers: &[Seen]) -> Vec<DVec3> {
    let facing = (0..answers.len()).filter(|i| answers[*i] != Seen::Unlit);
    facing.filter_map(|i| stage.grid.surface(stage.tracer, stage.camera, i)).map(|s| s.position).collect()
}

impl Answer {
    /// Of a frame that was planned for itself.
    pub(super) fn alone(entry: crate::plan::LightPlan) -> Answer {
        Answer { entry, place: 0, tried: Vec::new(), missed: false, content: Content::default() }
    }
}
