//! The matrices of one light: fitted to the planning grid's edges, widened until they hold every film pixel that needs
//! them.

use super::{AspectRule, Bound, MapParams, QualityParams, shares};
use crate::fit::Aspect;
use crate::math::Bounds;
use crate::measure::{Outside, Receivers};
use crate::methods::{Inapplicable, Inputs, Prediction, Region, SolverParams, held, solve};
use crate::samples::LightSamples;
use crate::scene::{Camera, Film, Light};
use glam::DVec3;

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
#[derive(Clone, Debug)]
pub struct FittedLight {
    /// One for each map.
    pub regions: Vec<Region>,
    /// Share of the texels of each map; they sum to 1.
    pub shares: Vec<f64>,
    /// Texels of all maps together at which the prediction meets the bound.
    pub texels: f64,
    /// Evaluations of all fits.
    pub evaluations: u64,
    /// Film pixels that lay outside the first fit and joined the cover.
    pub joined: u64,
    /// Scene points that the maps hold.
    pub covered: Vec<DVec3>,
}

impl<'a> FilmQuestion<'a> {
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
            clip: &[],
            texels,
            aspect: match self.map.aspect {
                AspectRule::Free if !self.map.square => Aspect::Free,
                _ => Aspect::Fixed(1.0),
            },
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

/// Fits a light's regions. `film` holds the exact answers of every film pixel, when they are to be measured.
pub fn fit_light(
    question: &FilmQuestion,
    samples: &LightSamples,
    film: Option<&Receivers>,
) -> Result<FittedLight, Inapplicable> {
    let mut covered = samples.covered.clone();
    let wanted: Vec<DVec3> = film.map(|f| f.positions_where(question.map.outside == Outside::Lit)).unwrap_or_default();
    if covered.is_empty() {
        covered.clone_from(&wanted);
    }
    let mut evaluations = 0;
    let mut fit = |covered: &[DVec3], texels: f64| -> Result<Vec<Region>, Inapplicable> {
        let regions = solve(question.solver.method, &question.inputs(samples, covered, texels, question.solver))?;
        evaluations += regions.iter().map(|r| r.report.evaluations).sum::<u64>();
        Ok(regions)
    };
    let mut texels = FIRST_TEXELS;
    let mut regions = fit(&covered, texels)?;
    let mut joined = 0;
    for _ in 0..COVER_ROUNDS {
        let outside: Vec<DVec3> = wanted.iter().copied().filter(|p| !held(&regions, *p)).collect();
        if outside.is_empty() {
            break;
        }
        joined += outside.len() as u64;
        covered.extend(outside);
        regions = fit(&covered, texels)?;
    }
    for _ in 0..SIZE_ROUNDS {
        let predicted = predicted_texels(question.quality, question.film, &regions, &shares(&regions));
        let close = (predicted / texels).max(texels / predicted) < SIZE_CLOSE;
        texels = predicted;
        if close {
            break;
        }
        regions = fit(&covered, texels)?;
    }
    let shares = shares(&regions);
    Ok(FittedLight { regions, shares, texels, evaluations, joined, covered })
}

/// The prediction of all regions at a number of texels in all.
pub fn predict(regions: &[Region], shares: &[f64], texels: f64) -> Prediction {
    regions.iter().zip(shares).fold(Prediction::default(), |sum, (region, share)| {
        let p = region.predict(texels * share);
        Prediction { misclassified: sum.misclassified + p.misclassified, unsaturated: sum.unsaturated + p.unsaturated }
    })
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
        Bound::Misclassified => predict(regions, shares, texels).misclassified,
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
