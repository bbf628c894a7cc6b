//! Frames that are equal to an earlier one, decided from the scene, so that nothing is computed for them.
//!
//! Two frames are equal for a light when its camera, the light and every moving triangle are, bit by bit; what is still is
//! the same in all frames of a shot. What planning, measuring and flicker come to hangs on nothing else. The first frame of
//! equal ones is computed and the others refer to it, so that it does not matter which frames were asked, or where.

use super::super::stage::{Stages, measures};
use super::super::{LightPlan, PlanError};
use super::{Answer, FrameState};
use crate::resolution::Measure;
use crate::scene::Light;
use crate::shot::Content;
use sha2::{Digest, Sha256};

/// What the frames of a shot show, as far as it was asked.
#[derive(Default)]
pub(super) struct SameFrames {
    shown: Vec<Shown>,
}

/// What a frame shows.
struct Shown {
    /// Of camera and moving triangles.
    of_all: [u8; 32],
    lights: Vec<Vec<u8>>,
}

impl SameFrames {
    /// For each light of a frame, by place, the place of the first frame that is equal for it, if that is an earlier one.
    ///
    /// # Errors
    /// When a frame has no pose.
    pub(super) fn first(&mut self, stages: &Stages, place: usize) -> Result<Vec<Option<usize>>, PlanError> {
        while self.shown.len() <= place {
            self.shown.push(shown(stages, self.shown.len())?);
        }
        let now = &self.shown[place];
        let equal = |light: &Vec<u8>| {
            self.shown[..place].iter().position(|then| then.of_all == now.of_all && then.lights.contains(light))
        };
        Ok(now.lights.iter().map(equal).collect())
    }
}

/// Whether equal frames refer to one another. A budget and answers that are blended over time give equal frames different
/// maps; and `measure = "full"` takes nothing for granted.
pub(super) fn is_asked(stages: &Stages) -> bool {
    let job = stages.job;
    let later = job.budget.is_given() || job.lookup.is_temporal();
    stages.len() > 1 && stages.images.is_none() && !later && job.quality.measure != Measure::Full
}

fn shown(stages: &Stages, place: usize) -> Result<Shown, PlanError> {
    let scene = &stages.shot.scene;
    let frame = scene.frame(stages.time(place).time_s)?;
    let mut hasher = Sha256::new();
    // Debug prints f64 so that it reads back the same, and never fails.
    hasher.update(format!("{:?} {:?}", frame.camera, Content::of(scene.geometry(&frame), |_| true)).as_bytes());
    let lights = frame.lights.iter().map(|light: &Light| format!("{light:?}").into_bytes()).collect();
    Ok(Shown { of_all: hasher.finalize().into(), lights })
}

/// Gives the lights of equal frames the answers of the first of them; what they cost was said there.
pub(super) fn refer(frames: &mut [FrameState]) {
    for place in 0..frames.len() {
        let (before, now) = frames.split_at_mut(place);
        let Some(now) = now.first_mut() else { continue };
        for light in &mut now.lights {
            let Some(first) = light.same_as.and_then(|first| before.get(first)) else { continue };
            let there = first.lights.iter().find(|l| l.light.name == light.light.name);
            light.answer =
                there.and_then(|l| l.answer.clone()).map(|answer| Answer { entry: free(answer.entry), ..answer });
        }
    }
}

/// An entry that took nothing.
fn free(entry: LightPlan) -> LightPlan {
    LightPlan { cost: crate::plan::Cost::default(), ..entry }
}

/// Gives the lights of a frame, by place, the flicker of an earlier pair of frames that is equal to this one and the one
/// before it.
pub(super) fn flicker_of_equals(stages: &Stages, frames: &[FrameState], place: usize, state: &mut FrameState) {
    if !measures(stages.job) || place == 0 {
        return;
    }
    let first = |place: usize, name: &str| {
        let light = frames[place].lights.iter().find(|l| l.light.name == name)?;
        Some(light.same_as.unwrap_or(place))
    };
    for light in state.lights.iter_mut().filter(|light| light.flicker.is_none()) {
        let name = light.light.name.as_str();
        let pair = |place: usize| Some((first(place - 1, name)?, first(place, name)?));
        let Some(here) = pair(place) else { continue };
        let equal = (1..place).find(|earlier| pair(*earlier) == Some(here));
        let known = equal.and_then(|k| frames[k].lights.iter().find(|l| l.light.name == name)?.flicker);
        light.flicker = known.map(|mut compared| {
            if let Some(flicker) = &mut compared.flicker {
                flicker.since = stages.time(place - 1).frame;
            }
            compared
        });
    }
}
