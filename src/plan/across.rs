//! What holds from frame to frame in a finished plan: which maps are drawn and which are reused, and flicker.
//!
//! Flicker is measured from the plan's own matrices, as `verify` does; where the renderer blends answers over time, what it
//! shows is too.

use super::remeasure::{Before, Left, Seeing, remeasure};
use super::reproject::Steps;
use super::stage::{Posed, Stages, measures};
use super::{FramePlan, LightTemporal, PlanError, Stage, Watch, reproject};
use crate::visibility::{RayOffset, see};
use std::sync::Arc;

/// Completes the entries of a shot.
pub(super) fn complete(stages: &Stages, frames: &mut [FramePlan], watch: &Watch) -> Result<(), PlanError> {
    for frame in frames.iter_mut() {
        let number = frame.frame;
        for entry in frame.lights.iter_mut().filter(|entry| entry.temporal.is_none() && !entry.maps.is_empty()) {
            entry.temporal = Some(LightTemporal::alone(number, None));
        }
    }
    if !measures(stages.job) {
        return Ok(());
    }
    let (shot, params, temporal) = (stages.shot, &stages.job.map, stages.job.lookup.is_temporal());
    let mut before: Option<Before> = None;
    let total = frames.len() as u64;
    for (k, planned) in frames.iter_mut().enumerate() {
        watch.step(Stage::Flicker, k as u64, total)?;
        let posed = Posed::new(shot, planned.time_s)?;
        let (tracer, frame) = (posed.tracer(shot, &stages.still), &posed.frame);
        let view = see(&tracer, &frame.camera, shot.film);
        let offset = RayOffset::for_scene(&tracer);
        let seeing = Seeing { tracer: &tracer, camera: &frame.camera, view: &view, offset };
        let of_shot = (shot, stages.still.as_ref());
        let earlier = before.as_ref().map(|b| b.earlier(of_shot, &seeing));
        let (mut maps, mut caches) = (Vec::with_capacity(planned.lights.len()), Vec::new());
        let steps = Steps {
            shot,
            still: &stages.still,
            job: stages.job,
            seeing,
            before: before.as_ref(),
            earlier: earlier.as_deref(),
        };
        for entry in &mut planned.lights {
            watch.check()?;
            let Some(light) = frame.lights.iter().find(|l| l.name == entry.light) else { continue };
            let reused = entry.temporal.as_ref().is_some_and(|t| t.reused_from.is_some());
            let same =
                before.as_ref().filter(|_| reused).and_then(|b| b.maps_of(&entry.light)).filter(|m| !m.is_empty());
            let mut measured = remeasure(&seeing, light, &entry.maps, params, same.map(Arc::clone))?;
            if temporal {
                if let Some(smaller) = steps.smaller(stages, light, entry, &measured)? {
                    (*entry, measured) = smaller;
                }
                let (shown, cache) = steps.shown(light, &measured);
                reproject::enter(entry, shown);
                caches.push((entry.light.clone(), cache));
            }
            if let (Some(before), Some(earlier)) = (&before, &earlier) {
                entry.flicker = before.flicker(of_shot, earlier, &entry.light, &measured, params.outside);
            }
            maps.push((entry.light.clone(), measured.drawn));
        }
        before = Some(Before {
            number: planned.frame,
            posed,
            offset,
            maps,
            left: temporal.then_some(Left { view, caches }),
        });
    }
    watch.step(Stage::Flicker, total, total)
}
