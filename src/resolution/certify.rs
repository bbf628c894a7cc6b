//! Chooses the smallest size by measurement, with a certificate of what was tried.

use super::bias::{default_bias, measured_bias};
use super::fitted::{predict, predicted_bound};
use super::judge::Judge;
use super::{Bound, FilmQuestion, FittedLight, Probe, SizeGrid, smallest};
use crate::measure::{Drawn, UNCERTAIN_SLACK, Verdict};
use crate::methods::Prediction;
use crate::raster::{Bias, RasterError};
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
    /// The trial of this size; `None` when nothing was measured.
    pub chosen: Option<Trial>,
    /// Of its wrong pixels, certain or not, those owed to bias.
    pub self_shadow: u64,
    /// All trials, in order.
    pub tried: Vec<Trial>,
}

/// Chooses by measurement.
pub fn certify(question: &FilmQuestion, fitted: &FittedLight, judge: &mut Judge) -> Result<Certified, RasterError> {
    let grid = grid_of(question, fitted);
    let (bias, mut at_guess) = measured_bias(question, fitted, judge, &grid)?;
    let guess = grid.at_least(fitted.texels);
    let mut tried: Vec<(usize, Trial, Vec<u32>)> = Vec::new();
    let found = smallest(grid.len(), guess, question.map.step, |index| {
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
    })?;
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
    let epsilon = question.quality.epsilon();
    let (ratio, meets, at_quantile) = match question.quality.bound {
        Bound::Misclassified => {
            let certain = verdict.certain.wrong() as f64;
            let all = certain + verdict.uncertain as f64;
            let limit = epsilon * question.film.pixels() as f64;
            (certain.max(all / UNCERTAIN_SLACK) / limit, verdict.meets(limit), None)
        }
        Bound::Displacement | Bound::Footprint => {
            let value = judge.at_quantile(drawn, wrong);
            (value / epsilon, value <= epsilon, Some(value))
        }
    };
    (Probe { meets, ratio }, Trial { sizes, verdict, at_quantile, meets })
}

/// Chooses by the prediction alone.
pub fn predict_only(question: &FilmQuestion, fitted: &FittedLight) -> Certified {
    let grid = grid_of(question, fitted);
    let index = grid.at_least(fitted.texels);
    let texels = grid.texels(index);
    Certified {
        met: texels >= fitted.texels,
        sizes: grid.sizes(index).to_vec(),
        bias: default_bias(&question.map.bias),
        predicted: predict(&fitted.regions, &fitted.shares, texels),
        predicted_at_quantile: predicted_at_quantile(question, fitted, texels),
        chosen: None,
        self_shadow: 0,
        tried: Vec::new(),
    }
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
