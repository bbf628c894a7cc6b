//! The matrices of one light: fitted to the planning grid's edges, widened until they hold every film pixel that needs
//! them.

use super::{AspectRule, Bound, MapParams, QualityParams, SingleSided, shares};
use crate::fit::Aspect;
use crate::math::{Bounds, first_holding};
use crate::measure::{Outside, Receivers, least_limit};
use crate::methods::{Inapplicable, Inputs, Method, Prediction, Region, SolverParams, held, solve};
use crate::samples::LightSamples;
use crate::scene::{Camera, Film, Light};
use glam::DVec3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// What is asked of one light in one frame.
#[derive(Clone, Copy)]
pub struct FilmQuestion<'a> {
    /// Camera of the frame.
    pub camera: &'a Camera,
    /// Film it exposes.
    pub film: Film,
    /// The light.
    pub light: &'a Light,
    /// All geometry of the frame.
    pub bounds: Bounds,
    /// `[quality]`.
    pub quality: &'a QualityParams,
    /// `[map]`.
    pub map: &'a MapParams,
    /// `[solver]`.
    pub solver: &'a SolverParams,
    /// Most edge samples kept.
    pub sample_cap: usize,
}

/// Fitted regions, and the texels they were fitted for.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct FittedLight {
    /// The method that they are of.
    pub method: Method,
    /// One for each map.
    pub regions: Vec<Region>,
    /// Share of the texels of each map; they sum to 1.
    pub shares: Vec<f64>,
    /// Texels of all maps together at which the bound is expected to be met: as predicted, or as measured before.
    pub texels: f64,
    /// Evaluations of all fits.
    pub evaluations: u64,
    /// Film pixels that lay outside the first fit and joined the cover.
    pub joined: u64,
    /// Scene points that the maps hold.
    pub covered: Vec<DVec3>,
}

impl<'a> FilmQuestion<'a> {
    /// Whether rays tell what drawing would store: not where one side of triangles is left out.
    pub(super) fn rays_tell(&self) -> bool {
        self.map.single_sided == SingleSided::Both
    }

    /// The aspects that the job allows.
    pub(super) fn aspect(&self) -> Aspect {
        match self.map.aspect {
            AspectRule::Free if !self.map.square => Aspect::Free,
            _ => Aspect::Fixed(1.0),
        }
    }

    /// What a method gets of this question.
    pub fn inputs(
        &self,
        samples: &'a LightSamples,
        covered: &'a [DVec3],
        texels: f64,
        solver: &'a SolverParams,
    ) -> Inputs<'a> {
        Inputs {
            camera: self.camera,
            film: self.film,
            light: self.light,
            bounds: self.bounds,
            edges: &samples.edges,
            covered,
            hull_only: samples.hull_only,
            clip: &[],
            texels,
            aspect: self.aspect(),
            shape: self.map.shape,
            solver,
            sample_cap: self.sample_cap,
        }
    }
}

/// Texels that the first fit assumes.
const FIRST_TEXELS: f64 = 512.0 * 512.0;
/// Fits for a size, predictions of the size from the fit: so many times at most. The matrix changes little with the size.
const SIZE_ROUNDS: u32 = 3;
/// Sizes closer than this ratio in texels are not fitted again.
const SIZE_CLOSE: f64 = 1.3;
/// Rounds in which film pixels outside the maps join the cover; each takes all that are outside.
const COVER_ROUNDS: u32 = 4;
/// Most texels that a prediction considers: beyond any map.
const TEXELS_MAX: f64 = 1e9;

/// Fits a light's regions and finds the texels at which the prediction meets the bound. `film` holds the exact answers of
/// every film pixel, when they are to be measured.
///
/// # Errors
/// [`Inapplicable`]: why the method gives no map.
pub fn fit_light(
    question: &FilmQuestion,
    samples: &LightSamples,
    film: Option<&Receivers>,
) -> Result<FittedLight, Inapplicable> {
    let mut cover = Cover::new(question, samples, film);
    let aspect = question.aspect();
    let mut texels = FIRST_TEXELS;
    let mut regions = cover.fit(texels, aspect)?;
    for _ in 0..SIZE_ROUNDS {
        let predicted = predicted_texels(question.quality, question.film, &regions, &shares(&regions));
        let close = (predicted / texels).max(texels / predicted) < SIZE_CLOSE;
        texels = predicted;
        if close {
            break;
        }
        regions = cover.fit(texels, aspect)?;
    }
    let mut fitted = cover.fitted(regions, texels);
    if let Some(film) = film {
        fitted.drop_unseen(&film.positions);
    }
    Ok(fitted)
}

/// Fits a light's regions for a number of texels.
///
/// # Errors
/// [`Inapplicable`]: why the method gives no map.
pub fn fit_texels(
    question: &FilmQuestion,
    samples: &LightSamples,
    film: &Receivers,
    texels: f64,
    aspect: Aspect,
) -> Result<FittedLight, Inapplicable> {
    let mut cover = Cover::new(question, samples, Some(film));
    let regions = cover.fit(texels, aspect)?;
    let mut fitted = cover.fitted(regions, texels);
    fitted.drop_unseen(&film.positions);
    Ok(fitted)
}

/// Fits a light's regions for the texels that maps fitted for much fewer were found to need; `None` when they are near
/// enough, or there is no second fit. The texels are again those at which the prediction meets the bound.
pub(super) fn fit_again(
    question: &FilmQuestion,
    samples: &LightSamples,
    film: Option<&Receivers>,
    before: &FittedLight,
    texels: f64,
) -> Option<FittedLight> {
    if texels < SIZE_CLOSE * before.texels {
        return None;
    }
    let mut cover = Cover::new(question, samples, film);
    let regions = cover.fit(texels, question.aspect()).ok()?;
    let predicted = predicted_texels(question.quality, question.film, &regions, &shares(&regions));
    let fitted = cover.fitted(regions, predicted);
    Some(FittedLight { evaluations: before.evaluations + fitted.evaluations, ..fitted })
}

impl FittedLight {
    /// Drops maps that none of the visible points looks up: their cover lies between pixels.
    pub fn drop_unseen(&mut self, visible: &[DVec3]) {
        if self.regions.len() < 2 {
            return;
        }
        let mut seen = vec![false; self.regions.len()];
        for point in visible {
            if let Some(k) = first_holding(self.regions.iter().map(|r| &r.domain), *point) {
                seen[k] = seen[k] || self.regions[k].contains(*point);
            }
            if seen.iter().all(|s| *s) {
                return;
            }
        }
        if seen.iter().any(|s| *s) {
            let mut seen = seen.into_iter();
            self.regions.retain(|_| seen.next().unwrap_or(true));
            self.shares = shares(&self.regions);
        }
    }
}

/// What the maps have to hold, as far as it is known.
struct Cover<'a> {
    question: &'a FilmQuestion<'a>,
    samples: &'a LightSamples,
    /// Every film pixel that has to be held.
    wanted: Vec<DVec3>,
    /// Those of the samples, and the film pixels that joined them.
    covered: Vec<DVec3>,
    joined: u64,
    evaluations: u64,
}

impl<'a> Cover<'a> {
    fn new(question: &'a FilmQuestion<'a>, samples: &'a LightSamples, film: Option<&Receivers>) -> Cover<'a> {
        let wanted: Vec<DVec3> =
            film.map(|f| f.positions_where(question.map.outside == Outside::Lit)).unwrap_or_default();
        let covered = if samples.covered.is_empty() { wanted.clone() } else { samples.covered.clone() };
        Cover { question, samples, wanted, covered, joined: 0, evaluations: 0 }
    }

    /// Regions that hold everything wanted: what lies outside joins the cover.
    fn fit(&mut self, texels: f64, aspect: Aspect) -> Result<Vec<Region>, Inapplicable> {
        let FilmQuestion { solver, .. } = *self.question;
        for round in 0.. {
            let inputs = Inputs { aspect, ..self.question.inputs(self.samples, &self.covered, texels, solver) };
            let regions = solve(solver.method, &inputs)?;
            self.evaluations += regions.iter().map(|r| r.report.evaluations).sum::<u64>();
            let outside: Vec<DVec3> = self.wanted.par_iter().copied().filter(|p| !held(&regions, *p)).collect();
            if outside.is_empty() || round == COVER_ROUNDS {
                return Ok(regions);
            }
            self.joined += outside.len() as u64;
            self.covered.extend(outside);
        }
        Err(Inapplicable::NoFiniteFit)
    }

    fn fitted(self, regions: Vec<Region>, texels: f64) -> FittedLight {
        let shares = shares(&regions);
        let Cover { question, covered, joined, evaluations, .. } = self;
        let method = question.solver.method;
        FittedLight { method, regions, shares, texels, evaluations, joined, covered }
    }
}

/// The prediction of all regions at a number of texels in all.
pub fn predict(regions: &[Region], shares: &[f64], texels: f64) -> Prediction {
    regions.iter().zip(shares).fold(Prediction::default(), |sum, (region, share)| {
        let p = region.predict(texels * share);
        Prediction {
            misclassified: sum.misclassified + p.misclassified,
            uncertain: sum.uncertain + p.uncertain,
            unsaturated: sum.unsaturated + p.unsaturated,
        }
    })
}

/// The smallest limit of wrong pixels that a prediction meets.
pub(super) fn predicted_limit(predicted: &Prediction) -> f64 {
    least_limit(predicted.misclassified, predicted.uncertain)
}

/// What the bound allows on a film: wrong pixels, or pixels at the quantile.
pub fn bound_limit(quality: &QualityParams, film: Film) -> f64 {
    match quality.bound {
        Bound::Misclassified => quality.epsilon() * film.pixels() as f64,
        Bound::Displacement | Bound::Footprint => quality.epsilon(),
    }
}

/// The predicted value of the bound: wrong pixels, or pixels at the quantile.
pub fn predicted_bound(quality: &QualityParams, regions: &[Region], shares: &[f64], texels: f64) -> f64 {
    let of_all = regions.iter().zip(shares);
    match quality.bound {
        Bound::Misclassified => predicted_limit(&predict(regions, shares, texels)),
        Bound::Displacement => {
            weighted_quantile(of_all.flat_map(|(r, s)| r.displacements(texels * s)).collect(), quality.quantile)
        }
        Bound::Footprint => {
            weighted_quantile(of_all.flat_map(|(r, s)| r.footprints(texels * s)).collect(), quality.quantile)
        }
    }
}

/// The smallest value such that values up to it hold at least `quantile` of the weight; 0 for none.
pub(super) fn weighted_quantile(mut values: Vec<(f64, f64)>, quantile: f64) -> f64 {
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    let wanted = quantile * values.iter().map(|v| v.1).sum::<f64>();
    let mut sum = 0.0;
    for (value, weight) in &values {
        sum += weight;
        if sum >= wanted {
            return *value;
        }
    }
    values.last().map_or(0.0, |v| v.0)
}

/// The fewest texels at which the prediction meets the bound on a film: bisection in log texels, the prediction falls
/// with them.
pub fn predicted_texels(quality: &QualityParams, film: Film, regions: &[Region], shares: &[f64]) -> f64 {
    let limit = bound_limit(quality, film);
    let meets = |texels: f64| predicted_bound(quality, regions, shares, texels) <= limit;
    let (mut lo, mut hi) = (1.0_f64, TEXELS_MAX);
    if meets(lo) {
        return lo;
    }
    while hi / lo > 1.01 {
        let middle = (lo * hi).sqrt();
        if meets(middle) { hi = middle } else { lo = middle }
    }
    hi
}
