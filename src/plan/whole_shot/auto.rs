//! `auto` over a shot: one rung of the ladder for each light, by the texels that `shot.minimise` counts.
//!
//! Segments are cut as for one map. Each rung with more maps is fitted to the same segments, which are decided like any
//! other: better maps near the fitted ones and the size are measured on the frame that needs most. So a further map is there
//! only where it saves its share of the shot's texels. What certifying the other frames adds is not known here, as nowhere
//! before it. `focused` places its map by one camera and is no rung.

use super::super::stage::Stages;
use super::super::{PlanError, Watch, choice};
use super::decide::{Decided, asked_map, by_method, decide};
use super::{Held, PLACED_BY_ONE_CAMERA};
use crate::job::Job;
use crate::methods::Method;
use crate::resolution::{Need, Rung, climb, rungs};
use crate::shot::{Asked, LightParts, Segment, fit_segment, minimised_texels};

/// The segments of one light by the rung that is taken. The inner error is the reason why it has none.
pub(super) fn by_ladder(
    stages: &Stages,
    light: &LightParts,
    timings: bool,
    watch: &Watch,
) -> Result<Result<Vec<Decided>, String>, PlanError> {
    let job = stages.job;
    let mut cut: Option<Vec<Segment>> = None;
    let of_rung = |rung: &Rung| {
        if rung.method == Method::Focused {
            return Ok::<_, PlanError>(Err(PLACED_BY_ONE_CAMERA.to_owned()));
        }
        let own = Job { solver: rung.solver(&job.solver), ..job.clone() };
        let stages = stages.with_job(&own);
        let decided = match &cut {
            None => by_method(&stages, light, timings, watch)?,
            Some(cut) => refitted(&stages, light, cut, timings, watch)?,
        };
        let decided = match decided {
            Ok(decided) => decided,
            Err(reason) => return Ok(Err(reason)),
        };
        if cut.is_none() {
            cut = Some(decided.iter().map(|d| d.held.segment.clone()).collect());
        }
        Ok(Ok((need(stages.job, light, &decided), decided)))
    };
    // Deciding has looked for better maps already.
    let (ladder, taken) = climb(&rungs(&job.solver), job.solver.min_saving, of_rung, |_, same| Ok(same))?;
    let choice = choice::of_ladder(&ladder, &job.solver, " over the shot");
    let Some(mut taken) = taken else {
        let reason = ladder.tried.into_iter().rev().find_map(|t| t.need.err());
        return Ok(Err(reason.unwrap_or(choice.reason)));
    };
    for decided in &mut taken {
        let report = decided.answer.as_mut().and_then(|answer| answer.entry.solver.as_mut());
        report.into_iter().for_each(|report| report.choice = Some(choice.clone()));
        decided.held.choice = Some(choice.clone());
    }
    Ok(Ok(taken))
}

/// The segments of a cut with matrices of a job's own method.
fn refitted(
    stages: &Stages,
    light: &LightParts,
    cut: &[Segment],
    timings: bool,
    watch: &Watch,
) -> Result<Result<Vec<Decided>, String>, PlanError> {
    let map = asked_map(stages.job);
    let asked = Asked { film: stages.shot.film, quality: &stages.job.quality, map: &map, solver: &stages.job.solver };
    let mut done = Vec::with_capacity(cut.len());
    for segment in cut {
        watch.check()?;
        let segment = match fit_segment(&asked, light, segment.frames.clone()) {
            Ok(segment) => segment,
            Err(reason) => return Ok(Err(reason.to_string())),
        };
        match decide(stages, light, Held::new(segment, &asked), &asked, timings)? {
            Ok(decided) => done.push(decided),
            Err(reason) => return Ok(Err(reason)),
        }
    }
    Ok(Ok(done))
}

/// What decided segments need.
fn need(job: &Job, light: &LightParts, decided: &[Decided]) -> Need {
    let texels = decided.iter().map(|d| (d.held.grid.texels(d.held.size), d.held.segment.needing.as_slice()));
    let answers = || decided.iter().filter_map(|d| d.answer.as_ref());
    Need {
        texels: minimised_texels(light, job.shot.minimise, texels),
        met: answers().all(|a| a.entry.met()),
        error: decided.iter().map(|d| d.error).fold(0.0, f64::max),
        maps: decided.iter().map(|d| d.held.fitted.regions.len()).max().unwrap_or(0),
    }
}
