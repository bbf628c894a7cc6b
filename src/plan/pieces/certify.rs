//! The stage that measures: the entries of a frame, and its flicker since the frame before.

use super::super::light_entry::light_entry;
use super::super::remeasure::{Before, Seeing};
use super::super::stage::{FrameStage, Posed, Stages, measures};
use super::super::whole_shot::{Ready, SegmentFrame};
use super::super::{PlanError, Watch};
use super::looked_up::LookedUp;
use super::same::flicker_of_equals;
use super::{Answer, Compared, Draft, FrameLight, FrameState, LightDraft, Way};
use crate::measure::{Earlier, Receivers};
use crate::scene::{Light, SceneFrame};
use crate::shot::Content;
use crate::visibility::RayOffset;

/// Maps up to so many texels stay drawn from frame to frame: 128 MiB a light.
const TEXELS_HELD: u64 = 1 << 25;

/// A frame whose maps are drawn, for the one after it.
pub(super) struct Carried {
    place: usize,
    before: Before,
    maps: Vec<Kept>,
}

/// The maps of one light, drawn.
struct Kept {
    light: Light,
    maps: LookedUp,
    /// What moves in them; `None` where that was not asked.
    content: Option<Content>,
    ready: Ready,
}

/// Whether a frame has something left to be answered.
pub(super) fn is_pending(stages: &Stages, draft: &Draft, frames: &[FrameState], place: usize) -> bool {
    pends(stages, draft, frames, place, &frames[place])
}

/// The same of a frame that may be known further than it stands among `frames`.
fn pends(stages: &Stages, draft: &Draft, frames: &[FrameState], place: usize, frame: &FrameState) -> bool {
    frame.lights.iter().any(|state| {
        let Some(light) = draft.light(&state.light.name) else { return false };
        asks_entry(light, place, state) || asks_flicker(stages, light, frames, place, state)
    })
}

/// Whether a light's entry is missing, or was measured at another size.
fn asks_entry(light: &LightDraft, place: usize, state: &FrameLight) -> bool {
    match (&light.way, &state.answer) {
        (Way::Segments(_), _) if !state.needs_map() => false,
        (Way::Segments(_), Some(answer)) => light.held(place).is_some_and(|held| answer.place != held.size),
        (_, answer) => answer.is_none(),
    }
}

fn asks_flicker(stages: &Stages, light: &LightDraft, frames: &[FrameState], place: usize, state: &FrameLight) -> bool {
    if place == 0 || !measures(stages.job) {
        return false;
    }
    let Some(then) = frames[place - 1].lights.iter().find(|l| l.light.name == state.light.name) else { return false };
    let known = LookedUp::of(light, place - 1, then).zip(LookedUp::of(light, place, state));
    match (known, &state.flicker) {
        (Some((then, now)), Some(compared)) => compared.of != LookedUp::fingerprint(&then, &now),
        _ => true,
    }
}

/// Answers what a draft asks of a frame, by place. `carried` is the frame before, if it was at hand, and becomes this one.
pub(super) fn certify_frame(
    stages: &Stages,
    draft: &Draft,
    frames: &[FrameState],
    place: usize,
    carried: &mut Option<Carried>,
    timings: bool,
    watch: &Watch,
) -> Result<FrameState, PlanError> {
    let mut state = frames[place].clone();
    if !is_pending(stages, draft, frames, place) {
        return Ok(state);
    }
    flicker_of_equals(stages, frames, place, &mut state);
    if !pends(stages, draft, frames, place, &state) {
        *carried = None;
        return Ok(state);
    }
    let follows = place > 0 && measures(stages.job);
    let before = match carried.take() {
        Some(carried) if follows && carried.place + 1 == place => Some(carried),
        _ if follows => Some(posed_before(stages, place - 1)?),
        _ => None,
    };
    let alone = |s: &FrameLight| draft.light(&s.light.name).is_some_and(|l| !matches!(l.way, Way::Segments(_)));
    let grid = !measures(stages.job) || state.lights.iter().any(|s| s.answer.is_none() && alone(s));
    let ((maps, offset), posed) = stages.set(place, grid, |stage, scene| {
        let at = At { stages, draft, frames, stage, scene, place, before: before.as_ref(), timings };
        let earlier = at.earlier();
        let mut maps = Vec::new();
        for light in &mut state.lights {
            watch.check()?;
            maps.extend(at.answer(light, earlier.as_deref())?);
        }
        Ok((maps, stage.offset))
    })?;
    let before = Before { number: stages.time(place).frame, posed, offset, maps: Vec::new(), left: None };
    *carried = Some(Carried { place, before, maps });
    Ok(state)
}

/// A frame whose maps are not drawn yet.
fn posed_before(stages: &Stages, place: usize) -> Result<Carried, PlanError> {
    let time = stages.time(place);
    let posed = Posed::new(stages.shot, time.time_s)?;
    let offset = RayOffset::for_scene(&posed.tracer(stages.shot, &stages.still));
    let before = Before { number: time.frame, posed, offset, maps: Vec::new(), left: None };
    Ok(Carried { place, before, maps: Vec::new() })
}

/// A frame that is asked.
struct At<'a> {
    stages: &'a Stages<'a>,
    draft: &'a Draft,
    frames: &'a [FrameState],
    stage: &'a FrameStage<'a>,
    scene: &'a SceneFrame,
    place: usize,
    before: Option<&'a Carried>,
    timings: bool,
}

impl At<'_> {
    /// Where the pixels were in the frame before.
    fn earlier(&self) -> Option<Vec<Option<Earlier>>> {
        let (before, view) = (self.before?, self.stage.view?);
        let FrameStage { tracer, camera, offset, .. } = *self.stage;
        let seeing = Seeing { tracer, camera, view, offset };
        Some(before.before.earlier((self.stages.shot, self.stages.still.as_ref()), &seeing))
    }

    /// Answers for one light; gives back its maps, where they were drawn.
    fn answer(&self, state: &mut FrameLight, earlier: Option<&[Option<Earlier>]>) -> Result<Option<Kept>, PlanError> {
        let Some(light) = self.draft.light(&state.light.name) else { return Ok(None) };
        let Some(here) = self.scene.lights.iter().find(|l| l.name == light.name) else { return Ok(None) };
        let FrameStage { tracer, camera, view, offset, .. } = *self.stage;
        let film = view.map(|view| Receivers::classify(tracer, view, camera, here, offset));
        let mut ready = None;
        if asks_entry(light, self.place, state) {
            (state.answer, ready) = self.entry(light, here, state, film.as_ref())?;
        }
        let (Some(film), Some(now)) = (film, LookedUp::of(light, self.place, state)) else { return Ok(None) };
        let ready = match ready.or_else(|| self.drawn_before(light, here, state, &now)) {
            Some(ready) => ready,
            None => now.draw(tracer, here, self.stages.job.map.single_sided)?,
        };
        if let (Some(before), Some(earlier)) = (self.before, earlier) {
            self.flicker(before, earlier, light, state, (&film, &now, &ready))?;
        }
        let content = state.answer.as_ref().filter(|_| matches!(light.way, Way::Segments(_))).map(|a| a.content);
        let texels: u64 = ready.drawn.iter().map(|d| d.map.depth.len() as u64).sum();
        Ok((texels <= TEXELS_HELD).then(|| Kept { light: here.clone(), maps: now, content, ready }))
    }

    /// The entry of a light, with its maps as drawn at the draft's size.
    fn entry(
        &self,
        light: &LightDraft,
        here: &Light,
        state: &FrameLight,
        film: Option<&Receivers>,
    ) -> Result<(Option<Answer>, Option<Ready>), PlanError> {
        let (Some(held), Some(part)) = (light.held(self.place), &state.part) else {
            let entry = light_entry(self.stage, here, self.stages.job, self.timings, state.fresh.as_ref())?;
            return Ok((Some(Answer::alone(entry)), None));
        };
        let frame = SegmentFrame {
            stage: self.stage,
            job: self.stages.job,
            frame: self.place,
            here,
            state,
            part,
            film,
            timings: self.timings,
        };
        let now = LookedUp::of(light, self.place, state);
        let content = frame.content(held);
        let same =
            |kept: &&Kept| kept.light == *here && Some(&kept.maps) == now.as_ref() && kept.content == Some(content);
        let drawn = self.before.and_then(|b| b.maps.iter().find(same)).map(|kept| kept.ready.clone());
        let entered = frame.enter(held, drawn)?;
        let ready = entered.ready.filter(|_| entered.answer.place == held.size);
        Ok((Some(entered.answer), ready))
    }

    /// The maps of the frame before, where they are this frame's too.
    fn drawn_before(&self, light: &LightDraft, here: &Light, state: &FrameLight, now: &LookedUp) -> Option<Ready> {
        let content = Some(state.answer.as_ref().filter(|_| matches!(light.way, Way::Segments(_)))?.content);
        let same = |kept: &&Kept| kept.light == *here && kept.maps == *now && kept.content == content;
        self.before?.maps.iter().find(same).map(|kept| kept.ready.clone())
    }

    /// Compares a light's answers with those of the frame before.
    fn flicker(
        &self,
        before: &Carried,
        earlier: &[Option<Earlier>],
        light: &LightDraft,
        state: &mut FrameLight,
        (film, now, ready): (&Receivers, &LookedUp, &Ready),
    ) -> Result<(), PlanError> {
        let named = |s: &&FrameLight| s.light.name == light.name;
        let Some(then) = self.frames[before.place].lights.iter().find(named) else { return Ok(()) };
        let Some(maps_then) = LookedUp::of(light, before.place, then) else { return Ok(()) };
        let of = LookedUp::fingerprint(&maps_then, now);
        if state.flicker.is_some_and(|known| known.of == of) {
            return Ok(());
        }
        let kept = before.maps.iter().find(|kept| kept.light == then.light && kept.maps == maps_then);
        let Stages { shot, job, still, .. } = self.stages;
        let drawn_then = match kept {
            Some(kept) => kept.ready.clone(),
            None => maps_then.draw(&before.before.posed.tracer(shot, still), &then.light, job.map.single_sided)?,
        };
        let flicker = before.before.flicker_of(
            (shot, still),
            earlier,
            (&light.name, &drawn_then.drawn),
            (film, &ready.drawn),
            job.map.outside,
        );
        state.flicker = Some(Compared { of, flicker });
        Ok(())
    }
}
