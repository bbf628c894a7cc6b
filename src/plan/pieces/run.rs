//! All stages in one process.

use super::super::make::{Loaded, finished};
use super::super::stage::Stages;
use super::super::{FramePlan, Plan, PlanError, Stage, Watch};
use super::certify::certify_frame;
use super::same::SameFrames;
use super::sample::sample_frame;
use super::settle::{assembled, pending, settle};
use super::solve::solve;
use super::work::Work;
use super::{Draft, FrameState};
use crate::job::LoadedJob;
use std::path::Path;

/// Plans a shot as [`super::super::make`] does. What is finished of frames is kept in the folder `work`, and taken from
/// there when the same job was interrupted before.
///
/// # Errors
/// As [`super::super::make`]; and [`PlanError::Part`] when the folder holds work of another job.
pub fn make_in(
    job: &LoadedJob,
    plan_dir: &Path,
    timings: bool,
    work: Option<&Path>,
    watch: &Watch,
) -> Result<Plan, PlanError> {
    let loaded = Loaded::new(job, watch)?;
    let (stages, opening) = loaded.stages(watch)?;
    let work = work.map(|dir| Work::open(dir, &loaded, timings, watch)).transpose()?;
    let frames = planned_in(&stages, timings, work.as_ref(), watch)?;
    finished(job, &stages, frames, plan_dir, timings.then_some(&opening), watch)
}

/// The frames of a shot, planned by epsilon.
pub(in crate::plan) fn planned(stages: &Stages, timings: bool, watch: &Watch) -> Result<Vec<FramePlan>, PlanError> {
    planned_in(stages, timings, None, watch)
}

/// The same; what is finished is kept in a folder.
fn planned_in(stages: &Stages, timings: bool, work: Option<&Work>, watch: &Watch) -> Result<Vec<FramePlan>, PlanError> {
    let mut frames = Vec::with_capacity(stages.len());
    let resumed = work.map(Work::draft).transpose()?.flatten();
    let mut draft = match resumed {
        Some((draft, states)) => {
            frames = states;
            draft
        }
        None => {
            let total = stages.len() as u64;
            let mut same = SameFrames::default();
            for place in 0..stages.len() {
                watch.step(Stage::Samples, place as u64, total)?;
                frames.push(sampled(stages, place, &mut same, timings, work, watch)?);
            }
            watch.step(Stage::Samples, total, total)?;
            let draft = solve(stages, &mut frames, timings, watch)?;
            keep(work, &draft, &frames)?;
            draft
        }
    };
    loop {
        round(stages, &draft, &mut frames, timings, work, watch)?;
        if settle(stages, &mut draft, &frames) {
            break;
        }
        keep(work, &draft, &frames)?;
    }
    Ok(assembled(stages, &draft, &frames))
}

/// A frame's sample, from the folder where it is there.
fn sampled(
    stages: &Stages,
    place: usize,
    same: &mut SameFrames,
    timings: bool,
    work: Option<&Work>,
    watch: &Watch,
) -> Result<FrameState, PlanError> {
    if let Some(found) = work.map(|w| w.sample(place)).transpose()?.flatten() {
        return Ok(found);
    }
    let state = sample_frame(stages, place, same, timings, watch)?;
    if let Some(work) = work {
        work.keep_sample(&state)?;
    }
    Ok(state)
}

fn keep(work: Option<&Work>, draft: &Draft, frames: &[FrameState]) -> Result<(), PlanError> {
    work.map_or(Ok(()), |work| work.keep_draft(draft, frames))
}

/// Answers all that a draft asks.
fn round(
    stages: &Stages,
    draft: &Draft,
    frames: &mut [FrameState],
    timings: bool,
    work: Option<&Work>,
    watch: &Watch,
) -> Result<(), PlanError> {
    let asked = pending(stages, draft, frames);
    let total = asked.len() as u64;
    let mut carried = None;
    for (done, place) in asked.into_iter().enumerate() {
        watch.step(Stage::Lights, done as u64, total)?;
        if let Some(found) = work.map(|w| w.answered(draft, place)).transpose()?.flatten() {
            frames[place] = found;
            continue;
        }
        frames[place] = certify_frame(stages, draft, frames, place, &mut carried, timings, watch)?;
        if let Some(work) = work {
            work.keep_answer(draft, &frames[place])?;
        }
    }
    watch.step(Stage::Lights, total, total)
}
