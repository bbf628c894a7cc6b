//! `auto` on a film: the ladder by the texels that measuring finds each rung to need.
//!
//! Rungs are compared as their methods fit them. Looking for better maps near them, which takes most of the time of a plan
//! with one map, is left to the rung that is taken, which then needs what is stated for it or less. One comparison would not
//! be fair so: `focused` has nothing to be looked for, so that one map of `lixel` is given up for it only with the better
//! maps near it measured too.

use super::super::{Certified, FilmQuestion, FittedLight, texels};
use super::ladder::{Ladder, Need, climb, rungs};
use super::one::{OnFilm, Planned, improved, planned};
use crate::methods::Method;
use crate::raster::RasterError;
use crate::samples::LightSamples;

impl Need {
    /// What maps need that were measured, or predicted.
    pub fn of(question: &FilmQuestion, fitted: &FittedLight, certified: &Certified) -> Need {
        Need {
            texels: texels(&certified.sizes) as f64,
            met: certified.met,
            error: certified.error_over_bound(question),
            maps: fitted.regions.len(),
        }
    }
}

/// Climbs and plans the rung that is taken; `None` where none has maps. What it `spent` is that of all rungs.
pub fn auto(
    question: &FilmQuestion,
    samples: &LightSamples,
    on: &OnFilm,
) -> Result<(Ladder, Option<Planned>), RasterError> {
    let solver = question.solver;
    let mut spent = [0; 3];
    let mut spend = |now: [u64; 3], before: [u64; 3]| (0..3).for_each(|k| spent[k] += now[k] - before[k]);
    let (ladder, taken) = climb(&rungs(solver), solver.min_saving, |rung, below| {
        let own = rung.solver(solver);
        let question = &FilmQuestion { solver: &own, ..*question };
        let mut found = match planned(question, samples, on, false)? {
            Ok(found) => found,
            Err(reason) => return Ok(Err(reason)),
        };
        spend(found.spent, [0; 3]);
        let need = |found: &Planned| Need::of(question, &found.fitted, &found.certified);
        let pays = |need: Need, below: &Need| need.texels <= below.texels * (1.0 - solver.min_saving);
        let given_up = below.is_some_and(|below| below.met && !(need(&found).met && pays(need(&found), below)));
        let last = rung.method == Method::Lixel && given_up;
        if last {
            let before = found.spent;
            found = improved(question, samples, on, found)?;
            spend(found.spent, before);
        }
        Ok(Ok((need(&found), (found, own, last))))
    })?;
    let Some((mut taken, own, done)) = taken else { return Ok((ladder, None)) };
    if !done {
        let before = taken.spent;
        taken = improved(&FilmQuestion { solver: &own, ..*question }, samples, on, taken)?;
        spend(taken.spent, before);
    }
    Ok((ladder, Some(Planned { spent, ..taken })))
}
