//! The stage from all frames' parts to what is settled over the shot.

use super::super::stage::Stages;
use super::super::whole_shot::{self, Decided};
use super::super::{PlanError, Stage, Watch};
use super::same::refer;
use super::{Draft, FrameLight, FrameState, LightDraft, Way};
use crate::scene::Light;
use crate::shot::{LightPart, LightParts, Temporal, carry};

/// Solves the shot. `frames` are all of them, in order; their parts stay, carried into the lights' frames, for what
/// certifying asks of them.
pub(super) fn solve(
    stages: &Stages,
    frames: &mut [FrameState],
    timings: bool,
    watch: &Watch,
) -> Result<Draft, PlanError> {
    refer(frames);
    let mut names: Vec<String> = Vec::new();
    for light in frames.iter().flat_map(|f| &f.lights) {
        if !names.contains(&light.light.name) {
            names.push(light.light.name.clone());
        }
    }
    let total = names.len() as u64;
    let mut lights = Vec::with_capacity(names.len());
    for (done, name) in names.into_iter().enumerate() {
        watch.step(Stage::Solve, done as u64, total)?;
        let way = match stages.mode() {
            Temporal::PerFrame => Way::Each { reason: None },
            Temporal::Hysteresis if stages.images.is_none() => {
                whole_shot::choose(of_light(frames, &name), &stages.job.shot);
                of_light(frames, &name).filter_map(|l| l.part.as_mut()).for_each(slim);
                Way::Chosen
            }
            Temporal::Hysteresis | Temporal::Shot | Temporal::Snapped => match whole_shot::refused(stages) {
                Some(reason) => Way::Each { reason: Some(reason) },
                None => segments(stages, frames, &name, timings, watch)?,
            },
        };
        lights.push(LightDraft { name, way });
    }
    let mut draft = Draft { round: 1, lights };
    if stages.job.shot.one_size {
        draft.lights.iter_mut().for_each(one_size);
    }
    watch.step(Stage::Solve, total, total)?;
    Ok(draft)
}

/// A light in the frames that it is on in.
fn of_light<'a>(frames: &'a mut [FrameState], name: &'a str) -> impl Iterator<Item = &'a mut FrameLight> {
    frames.iter_mut().filter_map(move |f| f.lights.iter_mut().find(|l| l.light.name == name))
}

/// The segments of a light, its parts carried into its frame; or why each frame goes for itself.
fn segments(
    stages: &Stages,
    frames: &mut [FrameState],
    name: &str,
    timings: bool,
    watch: &Watch,
) -> Result<Way, PlanError> {
    let Some(light) = carried(frames, name) else { return Ok(Way::Each { reason: None }) };
    let decided = whole_shot::decided(stages, &light, timings, watch)?;
    let LightParts { parts, poses, .. } = light;
    let place = |frames: &mut [FrameState], frame: usize, part: LightPart| {
        let Some(state) = frames[frame].lights.iter_mut().find(|l| l.light.name == name) else { return };
        (state.pose, state.motion) = (Some(poses[frame]), carry(&poses[frame], &poses[0]));
        state.part = Some(part);
    };
    for (frame, mut part) in parts.into_iter().enumerate() {
        slim(&mut part);
        place(frames, frame, part);
    }
    let decided = match decided {
        Ok(decided) => decided,
        Err(reason) => return Ok(Way::Each { reason: Some(reason) }),
    };
    let mut segments = Vec::with_capacity(decided.len());
    for Decided { held, frame, answer, .. } in decided {
        if let Some(state) = frames[frame].lights.iter_mut().find(|l| l.light.name == name) {
            state.answer = answer;
        }
        segments.push(held.settled());
    }
    Ok(Way::Segments(segments))
}

/// Takes the parts of a light out of its frames and carries them into its own. In frames that it is not on in, it stands
/// where it stood before.
fn carried(frames: &mut [FrameState], name: &str) -> Option<LightParts> {
    let mut last: Light = of_light(frames, name).next()?.light.clone();
    let mut parts = Vec::with_capacity(frames.len());
    for frame in frames.iter_mut() {
        let camera = &frame.camera;
        let state = frame.lights.iter_mut().find(|l| l.light.name == name);
        if let Some(state) = &state {
            last.clone_from(&state.light);
        }
        let part = state.and_then(|s| s.part.take());
        parts.push(part.unwrap_or_else(|| LightPart::blank(last.clone(), camera.clone())));
    }
    LightParts::new(parts)
}

/// Drops what only solving asks for.
fn slim(part: &mut LightPart) {
    (part.cover, part.reach) = (Vec::new(), Vec::new());
}

/// Gives all segments of a light the size of the largest. Segments are fitted for one aspect, so that places on their grids
/// are the same sizes; with several maps a light, the same texels in all.
pub(super) fn one_size(light: &mut LightDraft) {
    let Way::Segments(segments) = &mut light.way else { return };
    let largest = segments.iter().map(|h| h.size).max().unwrap_or(0);
    let decided_by = segments.iter().find(|h| h.size == largest).and_then(|h| h.decided_by);
    for held in segments {
        held.size = largest.min(held.grid.len().saturating_sub(1));
        held.decided_by = decided_by;
    }
}
