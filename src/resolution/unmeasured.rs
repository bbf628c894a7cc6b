//! Maps where nothing is measured: sizes by the prediction and, where rays can be sent, by a sample of lookups.

use super::bias::default_bias;
use super::certify::{grid_of, predicted_at_quantile};
use super::fitted::{fit_again, fit_light, predict};
use super::sampled::Settled;
use super::{Certified, FilmQuestion, FittedLight, JudgedMap, Planned, Sampled, SizeGrid, Spent, texels};
use crate::depth::DepthError;
use crate::measure::Receivers;
use crate::methods::Prediction;
use crate::samples::LightSamples;
use glam::DVec3;
use std::borrow::Cow;

/// Matrices and depth rows of regions, which have to hold visible points.
pub type MapsOf<'a> = dyn Fn(&FittedLight, &[DVec3]) -> Result<Vec<JudgedMap>, DepthError> + 'a;

/// What maps that are not measured are made from.
pub struct Unmeasured<'a> {
    /// What is asked.
    pub question: &'a FilmQuestion<'a>,
    /// Visible points that look maps up.
    pub receivers: &'a [DVec3],
    /// The same, to be looked up by rays.
    pub sampled: Option<&'a Sampled<'a>>,
    /// Matrices and depth rows of regions over visible points.
    pub maps_of: &'a MapsOf<'a>,
}

impl Unmeasured<'_> {
    /// Fits maps to samples. A few lookups tell how many texels they need in truth; with these they are fitted again, since
    /// edges move less where texels are more, and others then weigh most.
    ///
    /// # Errors
    /// Why there are none.
    pub fn planned(&self, samples: &LightSamples, film: Option<&Receivers>) -> Result<Planned, String> {
        let fitted = fit_light(self.question, samples, film).map_err(|reason| reason.to_string())?;
        let Some(sampled) = self.sampled else { return self.of(fitted) };
        // Where few points see nothing of a map, it has no depth row, and all of them are asked at once.
        let few = sampled.rough();
        let receivers = few.positions();
        let rough = Unmeasured { receivers: &receivers, ..*self }.settled(fitted.clone(), Some(&few), None).ok();
        let needed = rough.as_ref().map(|rough| texels(&rough.certified.sizes) as f64);
        // Where there is no second fit, or it has no depth row, the first one stands.
        let again = needed.and_then(|needed| fit_again(self.question, samples, film, &fitted, needed));
        let mut planned = match again.and_then(|again| self.settled(again, Some(sampled), needed).ok()) {
            Some(planned) => planned,
            None => self.settled(fitted, Some(sampled), needed)?,
        };
        planned.spent.rays += rough.map_or(0, |rough| rough.spent.rays);
        Ok(planned)
    }

    /// Maps of given regions.
    ///
    /// # Errors
    /// Why there are none.
    pub fn of(&self, fitted: FittedLight) -> Result<Planned, String> {
        self.settled(fitted, self.sampled, None)
    }

    /// The larger size of the predicted one and the one that lookups ask for, sought from a guess in texels on.
    fn settled(&self, mut fitted: FittedLight, by: Option<&Sampled>, guess: Option<f64>) -> Result<Planned, String> {
        fitted.drop_unseen(self.receivers);
        let maps = (self.maps_of)(&fitted, self.receivers).map_err(|reason| reason.to_string())?;
        let grid = grid_of(self.question, &fitted);
        let least = grid.at_least(fitted.texels);
        let guess = guess.map_or(least, |texels| grid.at_least(texels));
        let settled = by.map(|sampled| sampled.settle(|_| Cow::from(&maps), &grid, (least, guess), None));
        let (place, mut certified) = Certified::undrawn(self.question, &grid, (least, fitted.texels), settled);
        certified.predicted = predict(&fitted.regions, &fitted.shares, grid.texels(place));
        certified.predicted_at_quantile = predicted_at_quantile(self.question, &fitted, grid.texels(place));
        let rays = settled.map_or(0, |s| s.rays);
        let spent = Spent { evaluations: fitted.evaluations, rays, ..Spent::default() };
        Ok(Planned { maps, fitted, certified, spent })
    }
}

impl Certified {
    /// Of maps that are not drawn, and their place on the grid: that which lookups settled on, else the least one; met where it
    /// has the texels needed and lookups say so. What the prediction says there is the caller's to add.
    pub fn undrawn(
        question: &FilmQuestion,
        grid: &SizeGrid,
        (least, needed): (usize, f64),
        settled: Option<Settled>,
    ) -> (usize, Certified) {
        let place = settled.map_or(least, |s| s.place);
        let certified = Certified {
            met: grid.texels(place) >= needed && settled.is_none_or(|s| s.met),
            sizes: grid.sizes(place).to_vec(),
            bias: settled.map_or_else(|| default_bias(&question.map.bias), |s| s.bias),
            predicted: Prediction::default(),
            predicted_at_quantile: None,
            sampled: settled.map(|s| s.wrong),
            chosen: None,
            self_shadow: 0,
            tried: Vec::new(),
        };
        (place, certified)
    }
}
