//! The stage that ends a round: the size that every frame of a segment is met at, and the plan once all is measured there.

use super::super::light_entry::no_map_needed;
use super::super::make::frame_entry;
use super::super::stage::Stages;
use super::super::whole_shot::Held;
use super::super::{FramePlan, LightPlan, LightTemporal};
use super::certify::is_pending;
use super::solve::one_size;
use super::{Draft, FrameLight, FrameState, LightDraft, Way};
use crate::shot::{LightPart, Temporal};

/// Takes the sizes that frames asked for into the draft. True when every frame was measured at its final size; else the
/// draft is that of another round.
pub(super) fn settle(stages: &Stages, draft: &mut Draft, frames: &[FrameState]) -> bool {
    for light in &mut draft.lights {
        let name = &light.name;
        let Way::Segments(segments) = &mut light.way else { continue };
        segments.iter_mut().for_each(|held| grow(held, name, frames));
        if stages.job.shot.one_size {
            one_size(light);
        }
    }
    if pending(stages, draft, frames).is_empty() {
        return true;
    }
    draft.round += 1;
    false
}

/// The frames, by place, that have something left to be answered.
pub(super) fn pending(stages: &Stages, draft: &Draft, frames: &[FrameState]) -> Vec<usize> {
    (0..frames.len()).filter(|place| is_pending(stages, draft, frames, *place)).collect()
}

/// The largest size that a frame of a segment asks for; of several such frames the first decides.
fn grow(held: &mut Held, name: &str, frames: &[FrameState]) {
    for place in held.segment.needing.clone() {
        let state = frames[place].lights.iter().find(|l| l.light.name == name);
        let Some(answer) = state.and_then(|s| s.answer.as_ref()) else { continue };
        held.missed |= answer.missed;
        if answer.place > held.size {
            (held.size, held.decided_by) = (answer.place, Some(place));
        }
    }
}

/// The frames of the plan, once all is settled.
pub(super) fn assembled(stages: &Stages, draft: &Draft, frames: &[FrameState]) -> Vec<FramePlan> {
    let mut drawn = vec![None; draft.lights.len()];
    let mut planned = Vec::with_capacity(frames.len());
    for state in frames {
        let mut lights = Vec::with_capacity(state.lights.len());
        for light in &state.lights {
            let Some(i) = draft.lights.iter().position(|l| l.name == light.light.name) else { continue };
            lights.push(entry(stages, &draft.lights[i], frames, (state.place, light), &mut drawn[i]));
        }
        planned.push(frame_entry(stages.time(state.place), &state.camera, stages.shot.film, lights));
    }
    planned
}

/// The last frame of a light that has maps, and the frame that they are drawn in.
type Drawn = Option<(usize, usize)>;

/// The entry of a light in a frame.
fn entry(
    stages: &Stages,
    light: &LightDraft,
    frames: &[FrameState],
    (place, state): (usize, &FrameLight),
    drawn: &mut Drawn,
) -> LightPlan {
    let number = |place: usize| stages.time(place).frame;
    let mut entry = match (&state.answer, &state.part) {
        (None, Some(part)) => needless(stages, part),
        (answer, _) => answer.as_ref().map_or_else(
            || LightPlan::unplanned(&state.light, stages.job.quality.epsilon()),
            |answer| answer.entry.clone(),
        ),
    };
    entry.flicker = state.flicker.and_then(|compared| compared.flicker);
    let alone = |reason| LightTemporal::alone(number(place), reason);
    entry.temporal = match &light.way {
        _ if stages.len() == 1 => None,
        Way::Each { reason } => {
            let has_maps = !entry.maps.is_empty();
            let alone = LightTemporal { same_as: state.same_as.map(number), ..alone(reason.clone()) };
            let from = if has_maps { drawn_before(&light.name, frames, place, drawn) } else { None };
            let drawn_at = (has_maps && from.is_none()).then(|| number(place));
            let says = has_maps || reason.is_some() || alone.same_as.is_some();
            says.then(|| LightTemporal { drawn_at, reused_from: from.map(number), ..alone })
        }
        _ if entry.maps.is_empty() => None,
        Way::Chosen => Some(LightTemporal { mode: Temporal::Hysteresis, ..alone(None) }),
        Way::Segments(_) => light.held(place).map(|held| {
            let needing = &held.segment.needing;
            let from = drawn.filter(|(last, _)| same_maps(light, held, frames, *last, place)).map(|(_, from)| from);
            *drawn = Some((place, from.unwrap_or(place)));
            LightTemporal {
                mode: stages.job.shot.temporal,
                reason: None,
                segment: Some([needing.first(), needing.last()].map(|f| number(f.copied().unwrap_or(place)))),
                decided_by: held.decided_by.map(number),
                drawn_at: from.is_none().then(|| number(place)),
                reused_from: from.map(number),
                same_as: None,
            }
        }),
    };
    entry
}

/// The frame that the maps of a light planned frame by frame were drawn in: maps stay at hand until others are drawn.
fn drawn_before(name: &str, frames: &[FrameState], place: usize, drawn: &mut Drawn) -> Option<usize> {
    let first = |place: usize| {
        let light = frames[place].lights.iter().find(|l| l.light.name == name);
        light.and_then(|l| l.same_as).unwrap_or(place)
    };
    let from = drawn.filter(|(last, _)| first(*last) == first(place)).map(|(_, from)| from);
    *drawn = Some((place, from.unwrap_or(place)));
    from
}

/// Whether two frames draw the same maps of a segment.
fn same_maps(light: &LightDraft, held: &Held, frames: &[FrameState], a: usize, b: usize) -> bool {
    let state = |place: usize| frames[place].lights.iter().find(|l| l.light.name == light.name);
    let (Some(then), Some(now)) = (state(a), state(b)) else { return false };
    let content = |s: &FrameLight| s.answer.as_ref().map(|answer| answer.content);
    held.segment.needing.contains(&a)
        && held.same_window(a, b)
        && then.pose == now.pose
        && content(then).is_some()
        && content(then) == content(now)
}

/// The entry of a frame that needs no map.
fn needless(stages: &Stages, part: &LightPart) -> LightPlan {
    let mut entry = LightPlan::unplanned(&part.light, stages.job.quality.epsilon());
    (entry.cost.samples, entry.cost.rays) = (part.samples, part.rays);
    no_map_needed(&mut entry, part.facing, stages.job);
    entry
}
