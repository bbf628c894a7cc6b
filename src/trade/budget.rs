//! Planning within a time: the point of a table that a budget for each light of a frame buys.
//!
//! The shipped table was measured on one scene and machine. So its times are corrected on the shot itself: the fastest
//! point is timed on the first frame with shadows, then the one that the budget would buy at that speed, and so on until
//! no better one is expected to fit. A table that the user measured ([`super::trade`]) is taken as it stands, and then no
//! clock decides.

use std::path::Path;

use super::pick::{Picked, by_table, by_timing};
use super::run::timed;
use super::{Model, TradeError};
use crate::job::{Job, LoadedJob};
use crate::plan::{Operating, Plan, PlanError, Stages, TimeModel, Watch, in_scene_space, open, plan_on};
use crate::resolution::Measure;

/// Lights of a frame that are timed, at most.
const LIGHTS_TIMED: usize = 4;

/// A time, and what it is spent by.
#[derive(Clone, Debug, PartialEq)]
pub struct Budget {
    /// Seconds for each light of each frame.
    pub seconds: f64,
    /// A table of the user's, which is taken as it stands; `None` = the shipped one, its times corrected on the shot.
    pub model: Option<Model>,
    /// Only points that measure so; `None` = any.
    pub measure: Option<Measure>,
}

/// Plans a shot with the settings that a budget buys; otherwise as [`crate::plan::make`].
///
/// # Errors
/// Those of planning, [`TradeError::Model`] and [`TradeError::NoPoint`] for a table that cannot be used, and
/// [`TradeError::Job`] for one that does not go with the job.
pub fn plan_within(
    loaded: &LoadedJob,
    budget: &Budget,
    plan_dir: &Path,
    timings: bool,
    watch: &Watch,
) -> Result<Plan, TradeError> {
    let (model, calibrates) = match &budget.model {
        Some(model) => (model.clone(), false),
        None => (Model::shipped()?, true),
    };
    let (mut seconds, mut names, mut jobs) = (Vec::new(), Vec::new(), Vec::new());
    for point in model.point {
        let job = loaded.with(&point.settings)?;
        if budget.measure.is_none_or(|wanted| job.job.quality.measure == wanted) {
            seconds.push(point.seconds);
            names.push(point.name);
            jobs.push(job);
        }
    }
    if jobs.is_empty() {
        return Err(TradeError::NoPoint { wanted: budget.measure.unwrap_or_default() });
    }
    let plan = open(loaded, watch, |stages, opening| {
        let in_scene: Vec<Job> = jobs.iter().map(|job| in_scene_space(&job.job, stages.shot)).collect();
        let timed = match calibrates {
            true => calibrated(stages, &in_scene, &seconds, budget.seconds, watch)?,
            false => None,
        };
        let Picked { index, seconds: expected } = timed.unwrap_or_else(|| by_table(&seconds, budget.seconds));
        let mut plan =
            plan_on(&jobs[index], &stages.with_job(&in_scene[index]), plan_dir, timings.then_some(opening), watch)?;
        plan.operating = Some(Operating {
            budget_ms: budget.seconds * 1e3,
            point: names[index].clone(),
            model: if timed.is_some() { TimeModel::FirstFrame } else { TimeModel::Table },
            expected_ms: expected * 1e3,
            within: expected <= budget.seconds,
            deterministic: timed.is_none(),
        });
        Ok(plan)
    })?;
    Ok(plan)
}

/// The choice by timing on the first frame on which the fastest point finds shadows; `None` where it finds none.
fn calibrated(
    stages: &Stages,
    jobs: &[Job],
    seconds: &[f64],
    budget: f64,
    watch: &Watch,
) -> Result<Option<Picked>, PlanError> {
    for frame in 0..stages.len() {
        // Also wakes caches and threads for the timings that count.
        let found = timed(&stages.with_job(&jobs[0]), frame, |_| true)?;
        let shadowed = found.iter().filter(|run| run.settled.is_some());
        let lights: Vec<usize> = shadowed.map(|run| run.light).take(LIGHTS_TIMED).collect();
        if lights.is_empty() {
            continue;
        }
        return by_timing(seconds, budget, |k| {
            watch.check()?;
            let runs = timed(&stages.with_job(&jobs[k]), frame, |i| lights.contains(&i))?;
            Ok(Some(runs.iter().map(|r| r.seconds).sum::<f64>() / lights.len() as f64))
        });
    }
    Ok(None)
}
