//! `auto` on a film: the ladder by the texels that measuring finds each rung to need.

use super::super::{Certified, FilmQuestion, FittedLight, OnFilm, Spent, texels};
use super::ladder::{Ladder, Need, Rung, climb, rungs};
use super::one::{Planned, improved, planned};
use crate::raster::RasterError;
use crate::samples::LightSamples;
use std::cell::Cell;

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
    let spent = Cell::new(Spent::default());
    let spend = |more: Spent| {
        let mut all = spent.get();
        all += more;
        spent.set(all);
    };
    let first = |rung: &Rung| {
        let solver = rung.solver(solver);
        let question = &FilmQuestion { solver: &solver, ..*question };
        let found = planned(question, samples, on, false)?;
        Ok::<_, RasterError>(found.map(|found| {
            spend(found.spent);
            (Need::of(question, &found.fitted, &found.certified), found)
        }))
    };
    let better = |rung: &Rung, (_, found): (Need, Planned)| {
        let solver = rung.solver(solver);
        let question = &FilmQuestion { solver: &solver, ..*question };
        let found = improved(question, samples, on, Planned { spent: Spent::default(), ..found })?;
        spend(found.spent);
        Ok((Need::of(question, &found.fitted, &found.certified), found))
    };
    let (ladder, taken) = climb(&rungs(solver), solver.min_saving, first, better)?;
    Ok((ladder, taken.map(|taken| Planned { spent: spent.get(), ..taken })))
}
