//! A climb of `auto` or a contest of `best`, as a plan tells it.

use super::{Alternative, Choice};
use crate::methods::{Method, SolverParams};
use crate::resolution::{Contest, Entrant, Ladder, Standing, Stop, TriedRung};

/// Of a climb. `whose` says whose texels are counted.
pub(super) fn of_ladder(ladder: &Ladder, solver: &SolverParams, whose: &str) -> Choice {
    let tried = ladder.tried.iter().map(alternative).collect();
    Choice { tried, reason: why(ladder, solver, whose) }
}

fn alternative(tried: &TriedRung) -> Alternative {
    let need = tried.need.as_ref();
    let texels = need.ok().map(|n| n.texels.round() as u64);
    Alternative {
        method: tried.rung.method,
        maps: need.ok().map(|n| n.maps as u64),
        texels,
        met: need.ok().map(|n| n.met),
        error: need.ok().map(|n| n.error).filter(|e| e.is_finite()),
        misclassified: None,
        improved: tried.improved.map(|t| t.round() as u64).filter(|t| Some(*t) != texels),
        saving: tried.saving.filter(|s| s.is_finite()),
        reason: need.err().cloned(),
    }
}

/// `lixel`, `partitioned` with 3 maps.
fn named(tried: &TriedRung) -> String {
    match (tried.rung.method, &tried.need) {
        (Method::Partitioned, Ok(need)) => format!("`partitioned` with {} maps", need.maps),
        (Method::Partitioned, Err(_)) => format!("`partitioned` with up to {} maps", tried.rung.maps),
        (method, _) => format!("`{}`", method.name()),
    }
}

fn why(ladder: &Ladder, solver: &SolverParams, whose: &str) -> String {
    let Some(chosen) = ladder.chosen.and_then(|k| ladder.tried.get(k)) else {
        return "no method of the ladder has maps".to_owned();
    };
    let (taken, last) = (named(chosen), ladder.tried.last().unwrap_or(chosen));
    let next = named(last);
    let least = format!("the {} % of solver.min_saving", percent(solver.min_saving));
    let needs = chosen.improved.or(chosen.need.as_ref().ok().map(|n| n.texels)).unwrap_or(0.0).round();
    match ladder.stop {
        Stop::Saving => {
            let saving = last.saving.unwrap_or(0.0);
            let saves = if saving < 0.0 {
                format!("need {} % more", percent(-saving))
            } else {
                format!("save {} % of them", percent(saving))
            };
            format!("{taken} needs {needs} texels{whose}, and {next} would {saves}, where a step has to save {least}")
        }
        Stop::Missed => format!("{taken} meets the bound, and {next} would miss it"),
        Stop::NoMoreMaps => match &last.need {
            Ok(_) => format!("{taken}, and no further split of what is covered gains anything"),
            Err(reason) => format!("{taken}, and {next} has no maps: {reason}"),
        },
        Stop::Top if chosen.need.as_ref().is_ok_and(|n| !n.met) => {
            format!("no method of the ladder meets the bound, and {taken} comes nearest to it")
        }
        Stop::Top => match solver.max_maps {
            1 => format!("{taken}, the last step that solver.max_maps = 1 allows"),
            most => {
                format!("{taken} needs {needs} texels{whose}, the last step that solver.max_maps = {most} allows")
            }
        },
    }
}

/// Of a contest.
pub(super) fn of_contest(contest: &Contest) -> Choice {
    let tried = contest.entrants.iter().map(entrant).collect();
    let standing = |k: Option<usize>| {
        let entrant = contest.entrants.get(k?)?;
        Some((entrant.method.name(), *entrant.standing.as_ref().ok()?))
    };
    let reason = match (standing(contest.won), standing(contest.planned)) {
        (Some((won, at)), Some(_)) if contest.won == contest.planned => format!(
            "`{won}` has the smallest error at {} texels, {} of what the bound allows",
            at.texels,
            part(at.error)
        ),
        (Some((won, at)), Some((kept, base))) => format!(
            "`{kept}`: `{won}` errs less at {} texels, {} of what the bound allows where `{kept}` has {}, but needs more \
             texels for the bound",
            at.texels,
            part(at.error),
            part(base.error)
        ),
        _ => "no method with one map applies".to_owned(),
    };
    Choice { tried, reason }
}

fn entrant(entrant: &Entrant) -> Alternative {
    let standing: Option<&Standing> = entrant.standing.as_ref().ok();
    Alternative {
        method: entrant.method,
        maps: standing.map(|s| s.maps as u64),
        texels: standing.map(|s| s.texels),
        met: standing.map(|s| s.error <= 1.0),
        error: standing.map(|s| s.error).filter(|e| e.is_finite()),
        misclassified: standing.map(|s| s.misclassified),
        improved: None,
        saving: None,
        reason: entrant.standing.as_ref().err().cloned(),
    }
}

/// A share in percent, to a tenth.
fn percent(share: f64) -> f64 {
    (share * 1000.0).round() / 10.0
}

fn part(error: f64) -> String {
    format!("{:.3}", error)
}
