//! `best`: of the methods with one map the one with the smallest error at equal texels, as measured.
//!
//! The texels are those that `lixel` needs for the bound, the better maps near its own included; so `lixel` stands there at
//! the bound, and a method that errs less there needs less. Each of the others is fitted for these texels and drawn at them
//! with the depth bias that suits it, chosen as for a plan. The smallest error wins, ties by the order of the list; the
//! winner is then certified, and gives way to `lixel` if the bound asks for more texels of it after all: errors do not fall
//! with texels at the same pace everywhere.

use super::super::{FilmQuestion, Judge, OnFilm, Spent, fit_texels, grid_of, measured_bias, texels, trial};
use super::one::{Planned, planned};
use crate::methods::{Method, SolverParams};
use crate::raster::RasterError;
use crate::samples::LightSamples;

/// The methods with one map, `lixel` first.
pub const SINGLE_MAP: [Method; 9] = [
    Method::Lixel,
    Method::SceneOptimal,
    Method::Focused,
    Method::Lispsm,
    Method::Tsm,
    Method::Psm,
    Method::PlaneOptimal,
    Method::HomographyArea,
    Method::Normal,
];

/// A method's maps at the texels of the contest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Standing {
    /// Number of maps: several for a light among the geometry.
    pub maps: usize,
    /// Texels of all maps, the next allowed ones.
    pub texels: u64,
    /// Certainly wrong pixels.
    pub misclassified: u64,
    /// The error, in the unit of the bound, over what that allows.
    pub error: f64,
}

/// One that took part.
#[derive(Clone, Debug, PartialEq)]
pub struct Entrant {
    /// The method.
    pub method: Method,
    /// How it stood, or the reason why it does not apply.
    pub standing: Result<Standing, String>,
}

/// All that took part.
#[derive(Clone, Debug, PartialEq)]
pub struct Contest {
    /// In order of trial.
    pub entrants: Vec<Entrant>,
    /// Place of the one with the smallest error; `None` where no method applies.
    pub won: Option<usize>,
    /// Place of the one that is planned.
    pub planned: Option<usize>,
}

/// Holds the contest and plans the winner; `None` where no method applies. What it `spent` is that of all.
pub fn best(
    question: &FilmQuestion,
    samples: &LightSamples,
    on: &OnFilm,
) -> Result<(Contest, Option<Planned>), RasterError> {
    let solver_of = |method: Method| SolverParams { method, ..question.solver.clone() };
    let mut entrants: Vec<Entrant> = Vec::new();
    let mut spent = Spent::default();
    let mut spend = |more: Spent| spent += more;
    let mut first: Option<(usize, Planned)> = None;
    for method in SINGLE_MAP {
        let solver = solver_of(method);
        let question = &FilmQuestion { solver: &solver, ..*question };
        let standing = match &first {
            None => match planned(question, samples, on, true)? {
                Ok(found) => {
                    let standing = certified_standing(question, &found);
                    spend(found.spent);
                    first = Some((entrants.len(), found));
                    Ok(standing)
                }
                Err(reason) => Err(reason),
            },
            Some((_, first)) => at_texels(question, samples, on, texels(&first.certified.sizes), &mut spend)?,
        };
        entrants.push(Entrant { method, standing });
    }
    let Some((base, mut kept)) = first else { return Ok((Contest { entrants, won: None, planned: None }, None)) };
    let error = |k: usize| entrants[k].standing.as_ref().map_or(f64::INFINITY, |s| s.error);
    let won = (0..entrants.len()).fold(base, |won, k| if error(k) < error(won) { k } else { won });
    let mut taken = base;
    if won != base {
        let solver = solver_of(entrants[won].method);
        if let Ok(found) = planned(&FilmQuestion { solver: &solver, ..*question }, samples, on, false)? {
            spend(found.spent);
            if found.certified.serves_as_well_as(&kept.certified) {
                (taken, kept) = (won, found);
            }
        }
    }
    Ok((Contest { entrants, won: Some(won), planned: Some(taken) }, Some(Planned { spent, ..kept })))
}

/// How maps stand that were certified.
fn certified_standing(question: &FilmQuestion, found: &Planned) -> Standing {
    Standing {
        maps: found.maps.len(),
        texels: texels(&found.certified.sizes),
        misclassified: found.certified.chosen.as_ref().map_or(0, |trial| trial.verdict.certain.wrong()),
        error: found.certified.error_over_bound(question),
    }
}

/// A method's maps at a number of texels; the inner error is the reason why it has none.
fn at_texels(
    question: &FilmQuestion,
    samples: &LightSamples,
    on: &OnFilm,
    texels: u64,
    spend: &mut impl FnMut(Spent),
) -> Result<Result<Standing, String>, RasterError> {
    let fitted = match fit_texels(question, samples, on.receivers, texels as f64, question.aspect()) {
        Ok(fitted) => fitted,
        Err(reason) => return Ok(Err(reason.to_string())),
    };
    let mut judge = match Judge::new(*on, question, &fitted) {
        Ok(judge) => judge,
        Err(reason) => return Ok(Err(reason.to_string())),
    };
    let grid = grid_of(question, &fitted);
    let (bias, _) = measured_bias(question, &fitted, &mut judge, &grid)?;
    let sizes = grid.sizes(grid.at_least(texels as f64)).to_vec();
    let drawn = judge.draw(&sizes, bias)?;
    let wrong = judge.wrong(&drawn);
    let texels = super::super::texels(&sizes);
    let (probe, trial) = trial(question, &judge, (&drawn, &wrong), sizes);
    spend(Spent { evaluations: fitted.evaluations, ..judge.spent });
    let misclassified = trial.verdict.certain.wrong();
    Ok(Ok(Standing { maps: fitted.regions.len(), texels, misclassified, error: probe.ratio }))
}
