//! Chooses the smallest size by measurement, with a certificate of what was tried.

use super::bias::{default_bias, measured_bias};
use super::fitted::{bound_limit, predict, predicted_bound, predicted_limit};
use super::judge::Judge;
use super::sampled::Sampled;
use super::{
    Bound, Drawing, FilmQuestion, FittedLight, Measure, Probe, SizeGrid, Turn, grown, polish, polishes, size_on_grid,
    smallest, texels,
};
use crate::measure::{Drawn, Verdict, least_limit};
use crate::methods::Prediction;
use crate::raster::{Bias, RasterError};
use crate::samples::LightSamples;
use serde::{Deserialize, Serialize};

/// One size that was tried.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct Trial {
    /// Texels of each map.
    pub sizes: Vec<[u32; 2]>,
    /// What was measured.
    pub verdict: Verdict,
    /// The bound's value, where it is not a count: pixels at the quantile.
    pub at_quantile: Option<f64>,
    /// The bound holds.
    pub meets: bool,
}

/// The chosen size.
#[derive(Clone, Debug)]
pub struct Certified {
    /// The bound holds.
    pub met: bool,
    /// Texels of each map.
    pub sizes: Vec<[u32; 2]>,
    /// The bias it was measured with.
    pub bias: Bias,
    /// The prediction at this size.
    pub predicted: Prediction,
    /// The predicted value of a bound at a quantile.
    pub predicted_at_quantile: Option<f64>,
    /// Certain and uncertain wrong pixels by a sample of the visible points at this size; `None` where nothing was looked up.
    pub sampled: Option<[f64; 2]>,
    /// The trial of this size; `None` when nothing was measured.
    pub chosen: Option<Trial>,
    /// Of its wrong pixels, certain or not, those owed to bias.
    pub self_shadow: u64,
    /// All trials, in order.
    pub tried: Vec<Trial>,
}

impl Certified {
    /// The error at the chosen size over what the bound allows: measured where it was, else predicted.
    pub fn error_over_bound(&self, question: &FilmQuestion) -> f64 {
        let limit = bound_limit(question.quality, question.film);
        match &self.chosen {
            Some(trial) => trial.error_over_bound(question),
            None => {
                let sampled = self.sampled.map_or(0.0, |[certain, uncertain]| least_limit(certain, uncertain));
                self.predicted_at_quantile.unwrap_or_else(|| predicted_limit(&self.predicted).max(sampled)) / limit
            }
        }
    }

    /// Whether these maps may stand in for others of the same light: what meets the bound goes before what does not, then
    /// what has no more texels.
    pub fn serves_as_well_as(&self, other: &Certified) -> bool {
        (self.met && !other.met) || (self.met == other.met && texels(&self.sizes) <= texels(&other.sizes))
    }
}

impl Trial {
    /// The measured error over what the bound allows.
    pub fn error_over_bound(&self, question: &FilmQuestion) -> f64 {
        let limit = bound_limit(question.quality, question.film);
        self.at_quantile.unwrap_or_else(|| self.verdict.least_limit()) / limit
    }
}

/// Chooses matrices and size by measurement: the size that the fitted maps need, better maps at that size and with its
/// bias where the job asks for them, and the size that these need.
pub fn choose(
    question: &FilmQuestion,
    samples: &LightSamples,
    fitted: &mut FittedLight,
    judge: &mut Judge,
) -> Result<Certified, RasterError> {
    let first = certify(question, fitted, judge)?;
    refined(question, samples, fitted, judge, first)
}

/// Better matrices than those of a certificate, at its size and with its bias, then the bias and the size that these need, in
/// turns; the same where there are none.
pub fn refined(
    question: &FilmQuestion,
    samples: &LightSamples,
    fitted: &mut FittedLight,
    judge: &mut Judge,
    first: Certified,
) -> Result<Certified, RasterError> {
    if !polishes(question.solver) {
        return Ok(first);
    }
    let size = |aspect: f64, texels: f64| size_on_grid(question.map, aspect, texels);
    let mut best = first;
    for turn in Turn::all(question.solver, texels(&best.sizes) as f64) {
        fitted.texels = texels(&best.sizes) as f64;
        let before = (fitted.clone(), judge.maps.clone());
        let drawing = Drawing { size: &size, bias: best.bias };
        polish(question, samples, fitted, judge, &drawing, turn)?;
        // What hides behind the bias of one map need not behind that of another.
        let (bias, at_guess) = measured_bias(question, fitted, judge, &grid_of(question, fitted))?;
        let polished = smallest_size(question, fitted, judge, bias, at_guess)?;
        // What is better at one size may be worse at the sizes that count.
        if polished.serves_as_well_as(&best) {
            best = polished;
        } else {
            (*fitted, judge.maps) = before;
        }
    }
    Ok(best)
}

/// Chooses bias and size by measurement; with [`Measure::Check`] first the predicted size with the default bias.
pub fn certify(question: &FilmQuestion, fitted: &FittedLight, judge: &mut Judge) -> Result<Certified, RasterError> {
    let grid = grid_of(question, fitted);
    if question.quality.measure == Measure::Check {
        let (bias, guess) = (default_bias(&question.map.bias), grid.at_least(fitted.texels));
        let sizes = grid.sizes(guess).to_vec();
        let drawn = judge.draw(&sizes, bias)?;
        let wrong = judge.wrong(&drawn);
        let (probe, trial) = trial(question, judge, (&drawn, &wrong), sizes);
        if probe.meets {
            return certified(question, fitted, judge, (&grid, Some(guess)), bias, vec![(guess, trial, wrong)]);
        }
    }
    let (bias, at_guess) = measured_bias(question, fitted, judge, &grid)?;
    smallest_size(question, fitted, judge, bias, at_guess)
}

/// Draws maps at the size and with the bias that lookups settled on; only where they are over, larger ones until some meet.
pub fn check(
    question: &FilmQuestion,
    fitted: &mut FittedLight,
    judge: &mut Judge,
    sampled: &Sampled,
    settled: Certified,
) -> Result<Certified, RasterError> {
    fitted.texels = texels(&settled.sizes) as f64;
    let checked = smallest_size(question, fitted, judge, settled.bias, None)?;
    let mut expected = settled.sampled;
    if checked.sizes != settled.sizes {
        judge.spent.rays += sampled.rays();
        expected = Some(sampled.trial(&judge.maps, &checked.sizes, Some(checked.bias)).1);
    }
    Ok(Certified { sampled: expected, ..checked })
}

/// Chooses the size with a bias. `at_guess` are the receivers known to be wrong at the size that the fit expects to need.
fn smallest_size(
    question: &FilmQuestion,
    fitted: &FittedLight,
    judge: &mut Judge,
    bias: Bias,
    mut at_guess: Option<Vec<u32>>,
) -> Result<Certified, RasterError> {
    let grid = grid_of(question, fitted);
    let guess = grid.at_least(fitted.texels);
    let mut tried: Vec<(usize, Trial, Vec<u32>)> = Vec::new();
    let mut probe = |index: usize| {
        let sizes = grid.sizes(index).to_vec();
        let known = if index == guess && question.quality.bound != Bound::Footprint { at_guess.take() } else { None };
        let (drawn, wrong) = match known {
            Some(wrong) => (Vec::new(), wrong),
            None => {
                let drawn = judge.draw(&sizes, bias)?;
                let wrong = judge.wrong(&drawn);
                (drawn, wrong)
            }
        };
        let (probe, trial) = trial(question, judge, (&drawn, &wrong), sizes);
        tried.push((index, trial, wrong));
        Ok::<_, RasterError>(probe)
    };
    let (count, step) = (grid.len(), question.map.step);
    let found = match question.quality.measure {
        Measure::Check => grown(count, guess, step, &mut probe)?,
        Measure::Always | Measure::Full | Measure::Never => smallest(count, guess, step, &mut probe)?,
    };
    certified(question, fitted, judge, (&grid, found), bias, tried)
}

/// The certificate of the size that was found, of the largest when none was.
fn certified(
    question: &FilmQuestion,
    fitted: &FittedLight,
    judge: &mut Judge,
    (grid, found): (&SizeGrid, Option<usize>),
    bias: Bias,
    tried: Vec<(usize, Trial, Vec<u32>)>,
) -> Result<Certified, RasterError> {
    let index = found.unwrap_or(grid.len() - 1);
    let sizes = grid.sizes(index).to_vec();
    let (chosen, self_shadow) = match tried.iter().find(|(i, ..)| *i == index) {
        Some((_, trial, wrong)) => (Some(trial.clone()), judge.self_shadowed(&sizes, bias, wrong)?),
        None => (None, 0),
    };
    Ok(Certified {
        met: found.is_some(),
        bias,
        predicted: predict(&fitted.regions, &fitted.shares, grid.texels(index)),
        predicted_at_quantile: predicted_at_quantile(question, fitted, grid.texels(index)),
        sizes,
        sampled: None,
        chosen,
        self_shadow,
        tried: tried.into_iter().map(|(_, t, _)| t).collect(),
    })
}

/// What drawn maps are measured to give, with the receivers that they answer wrongly.
pub fn trial(
    question: &FilmQuestion,
    judge: &Judge,
    (drawn, wrong): (&[Drawn], &[u32]),
    sizes: Vec<[u32; 2]>,
) -> (Probe, Trial) {
    let verdict = judge.verdict(wrong);
    let limit = bound_limit(question.quality, question.film);
    let at_quantile = (question.quality.bound != Bound::Misclassified).then(|| judge.at_quantile(drawn, wrong));
    let meets = at_quantile.map_or_else(|| verdict.meets(limit), |value| value <= limit);
    let trial = Trial { sizes, verdict, at_quantile, meets };
    (Probe { meets, ratio: trial.error_over_bound(question) }, trial)
}

/// The sizes that a light's maps may have.
pub fn grid_of(question: &FilmQuestion, fitted: &FittedLight) -> SizeGrid {
    let maps: Vec<(f64, f64)> = fitted.regions.iter().map(|r| r.aspect).zip(fitted.shares.iter().copied()).collect();
    SizeGrid::new(&maps, question.map)
}

/// The predicted value of a bound that is taken at a quantile.
pub fn predicted_at_quantile(question: &FilmQuestion, fitted: &FittedLight, texels: f64) -> Option<f64> {
    (question.quality.bound != Bound::Misclassified)
        .then(|| predicted_bound(question.quality, &fitted.regions, &fitted.shares, texels))
}
