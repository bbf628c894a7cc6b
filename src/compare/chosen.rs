//! The rows of `auto` and `best`, which choose among other methods light by light.

use super::entry::{Case, Mask, alone};
use super::{CompareParams, PerLight, Question, Variant};
use crate::job::Job;
use crate::methods::{Method, SolverParams};
use crate::plan::PlanError;
use crate::resolution::{SINGLE_MAP, auto};
use std::time::Instant;

/// The rung that `auto` takes for the job's bound, whatever is held equal here, as a row.
pub(super) fn by_ladder(
    case: &Case,
    variant: &Variant,
    job: &Job,
    params: &CompareParams,
) -> Result<(PerLight, Mask), PlanError> {
    let start = Instant::now();
    let (ladder, _) = auto(&case.question(&variant.solver, job), case.samples, &case.on_film())?;
    // Without a rung that has maps, the row of one map says why.
    let rung = ladder.chosen.map(|k| ladder.tried[k].rung);
    let solver = rung.map_or_else(
        || SolverParams { method: Method::Lixel, ..variant.solver.clone() },
        |rung| rung.solver(&variant.solver),
    );
    let (mut row, mask) = alone(case, &solver, job, params)?;
    row.chosen = rung.map(|rung| match rung.method {
        Method::Partitioned => format!("{}:{}", rung.method.name(), rung.maps),
        method => method.name(),
    });
    row.seconds = start.elapsed().as_secs_f64();
    Ok((row, mask))
}

/// The row of the method with one map that does best in what is compared, of equals the first of the list.
pub(super) fn best(
    case: &Case,
    variant: &Variant,
    job: &Job,
    params: &CompareParams,
) -> Result<(PerLight, Mask), PlanError> {
    let start = Instant::now();
    // Over the bound stands behind what meets it; then fewer texels or fewer wrong pixels.
    let worth = |row: &PerLight| {
        let measured = row.measured.as_ref()?;
        Some(match (params.question, measured.needed) {
            (Question::Epsilon, Some(needed)) => (!needed.met, needed.texels),
            _ => (false, measured.misclassified),
        })
    };
    let mut best: Option<(PerLight, Mask)> = None;
    for method in SINGLE_MAP {
        let solver = SolverParams { method, ..variant.solver.clone() };
        let (mut row, mask) = alone(case, &solver, job, params)?;
        row.chosen = row.measured.is_some().then(|| method.name());
        let better = match (worth(&row), best.as_ref().map(|b| worth(&b.0))) {
            (_, None) => true,
            (Some(here), Some(before)) => before.is_none_or(|before| here < before),
            (None, Some(_)) => false,
        };
        if better {
            best = Some((row, mask));
        }
    }
    let (mut row, mask) = match best {
        Some(best) => best,
        None => alone(case, &SolverParams { method: Method::Lixel, ..variant.solver.clone() }, job, params)?,
    };
    row.seconds = start.elapsed().as_secs_f64();
    Ok((row, mask))
}
