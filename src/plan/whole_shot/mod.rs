//! Segments of constant matrix and size over a whole shot, each measured on all of its frames.
//!
//! The frames are gone through a few times, since what film resolution shows of all of them cannot be held at once:
//!
//! ```text
//! sample    every frame      → parts (`shot`), from which the segments are solved
//! polish    deciding frames  → other matrices near the segment's, by what they are measured to get wrong
//! range     every frame      → what the depth row of each segment has to hold; what moves in its maps
//! decide    deciding frames  → bias and smallest size on the frame predicted to need most
//! certify   every frame      → the size measured; where a frame fails the size grows, and the others are measured again
//! ```
//!
//! Where measured sizes are far from the predicted ones the shot is cut again with corrected costs, and segments that are
//! new are certified.

mod certify;
mod held;
mod hysteresis;
mod range;
mod sample;
mod window;

use super::light_entry::light_entry;
use super::make::frame_entry;
use super::stage::Stages;
use super::{FramePlan, LightPlan, LightTemporal, PlanError, Stage, Watch};
use crate::methods::Method;
use crate::resolution::AspectRule;
use crate::shot::{Asked, Hold, LightParts, Segmentation, Temporal, segments};
use held::Held;

/// Cuts of a shot at most: the first by prediction, the others with costs corrected by measurement.
const CUTS: u32 = 3;
/// Measured over predicted texels, or its inverse, from which a cut is made again. Predictions scale all intervals of a
/// light alike; a factor below this moves no border by much.
const STRONG: f64 = 1.5;

/// Plans the shot.
pub(super) fn plan(stages: &Stages, timings: bool, watch: &Watch) -> Result<Vec<FramePlan>, PlanError> {
    if stages.job.shot.temporal == Temporal::Hysteresis {
        return hysteresis::plan(stages, timings, watch);
    }
    let sampled = sample::sample(stages, watch)?;
    let count = stages.len();
    let mut planned: Vec<Vec<Option<LightPlan>>> = Vec::new();
    for light in &sampled.lights {
        let entries = match applies(stages, light) {
            Ok(()) => whole_light(stages, light, timings, watch)?,
            Err(reason) => alone(stages, light, &reason, timings, watch)?,
        };
        planned.push(entries);
    }
    let mut frames = Vec::with_capacity(count);
    for k in 0..count {
        let lights = planned.iter_mut().filter_map(|entries| entries[k].take()).collect();
        frames.push(frame_entry(stages.time(k), &sampled.cameras[k], stages.shot.film, lights));
    }
    Ok(frames)
}

/// Whether a light can have one matrix for several frames, or why not.
fn applies(stages: &Stages, _light: &LightParts) -> Result<(), String> {
    let method = stages.job.solver.method;
    if !matches!(method, Method::Lixel | Method::SceneOptimal) {
        return Err("the method places its matrix by one camera: no frame shares it with another".to_owned());
    }
    Ok(())
}

/// The entries of one light, frame by frame.
fn whole_light(
    stages: &Stages,
    light: &LightParts,
    timings: bool,
    watch: &Watch,
) -> Result<Vec<Option<LightPlan>>, PlanError> {
    let job = stages.job;
    // One size means one aspect for all segments.
    let mut map = job.map.clone();
    if job.shot.one_size {
        map.aspect = AspectRule::Fixed;
    }
    let asked = Asked { film: stages.shot.film, quality: &job.quality, map: &map, solver: &job.solver };
    let mut params = job.shot.clone();
    if params.temporal == Temporal::Snapped {
        params.hold = Some(Hold::Shot);
    }
    let mut correction = 1.0;
    let mut done: Vec<Held> = Vec::new();
    for cut in 0..CUTS {
        watch.check()?;
        let segmentation = match segments(&asked, light, &params, correction) {
            Ok(segmentation) => segmentation,
            Err(reason) => return alone(stages, light, &reason.to_string(), timings, watch),
        };
        let (kept, mut fresh) = sort(done, segmentation, &asked);
        done = kept;
        if fresh.is_empty() {
            break;
        }
        if params.temporal == Temporal::Snapped {
            for held in &mut fresh {
                if let Err(reason) = window::open(held, light, &asked) {
                    return alone(stages, light, &reason, timings, watch);
                }
            }
        }
        match certify::certify(stages, light, fresh, &asked, timings, watch)? {
            Ok(held) => done.extend(held),
            Err(reason) => return alone(stages, light, &reason, timings, watch),
        }
        let next = measured_over_predicted(&done);
        let strong = (next / correction).max(correction / next) > STRONG;
        if cut + 1 == CUTS || !(strong && params.hold.is_none()) {
            break;
        }
        correction = next;
    }
    done.sort_by_key(|held| held.segment.frames.start);
    if job.shot.one_size && done.len() > 1 {
        certify::one_size(stages, light, &mut done, timings, watch)?;
    }
    Ok(entries(stages, light, done))
}

/// Of the segments of a new cut, those certified before and those that are new.
fn sort(done: Vec<Held>, cut: Segmentation, asked: &Asked) -> (Vec<Held>, Vec<Held>) {
    let mut done: Vec<Option<Held>> = done.into_iter().map(Some).collect();
    let (mut kept, mut fresh) = (Vec::new(), Vec::new());
    for segment in cut.segments {
        let same = done.iter_mut().find(|held| held.as_ref().is_some_and(|h| h.segment.needing == segment.needing));
        match same.and_then(Option::take) {
            Some(mut held) => {
                held.segment.frames = segment.frames;
                kept.push(held);
            }
            None => fresh.push(Held::new(segment, asked)),
        }
    }
    (kept, fresh)
}

/// The geometric mean over segments of measured over predicted texels.
fn measured_over_predicted(done: &[Held]) -> f64 {
    let logs: Vec<f64> = done.iter().map(|held| held.measured_over_predicted().ln()).collect();
    (logs.iter().sum::<f64>() / logs.len().max(1) as f64).exp()
}

/// The entries that segments came to, with the frames they are drawn in, and those of frames that need no map.
fn entries(stages: &Stages, light: &LightParts, done: Vec<Held>) -> Vec<Option<LightPlan>> {
    let mut entries: Vec<Option<LightPlan>> =
        light.parts.iter().map(|part| Some(sample::needless(stages, part))).collect();
    let number = |k: usize| stages.time(k).frame;
    for mut held in done {
        let mut drawn: Option<usize> = None;
        let frames = &held.segment.needing;
        let ends = [frames.first(), frames.last()].map(|f| f.map_or(0, |f| number(*f)));
        let decided_by = held.decided_by.map(number);
        let mut last: Option<usize> = None;
        for (frame, mut entry) in std::mem::take(&mut held.entries) {
            let from = drawn.filter(|_| last.is_some_and(|l| held.same_maps(l, frame, held.size, light)));
            let temporal = LightTemporal {
                mode: stages.job.shot.temporal,
                reason: None,
                segment: Some(ends),
                decided_by,
                drawn_at: from.is_none().then(|| number(frame)),
                reused_from: from.map(number),
            };
            drawn = from.or(Some(frame));
            last = Some(frame);
            entry.temporal = Some(temporal);
            entries[frame] = Some(entry);
        }
    }
    entries
}

/// Each frame of a light for itself, with the reason why.
fn alone(
    stages: &Stages,
    light: &LightParts,
    reason: &str,
    timings: bool,
    watch: &Watch,
) -> Result<Vec<Option<LightPlan>>, PlanError> {
    let mut entries = Vec::with_capacity(stages.len());
    for k in 0..stages.len() {
        watch.step(Stage::Lights, k as u64, stages.len() as u64)?;
        let name = &light.light.name;
        let entry = stages.with(k, |stage, frame| match frame.lights.iter().find(|l| l.name == *name) {
            Some(light) => light_entry(stage, light, stages.job, timings, None).map(Some),
            None => Ok(None),
        })?;
        let temporal = LightTemporal::alone(stages.time(k).frame, Some(reason.to_owned()));
        entries.push(entry.map(|entry| LightPlan { temporal: Some(temporal), ..entry }));
    }
    Ok(entries)
}
