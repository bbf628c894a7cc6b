//! Chooses between maps by what they are measured to get wrong.
//!
//! The metric sees shadow edges, not what the bias hides nor what falls between samples. So at the predicted size a few
//! more maps are drawn and counted: the answers of the other metrics and of the scene-optimal method, then in rounds the
//! neighbours of the best map so far. The measured count decides, ties by the order of trial.

use super::bias::default_bias;
use super::judge::{Judge, JudgedMap};
use super::{FilmQuestion, FittedLight, SizeGrid};
use crate::methods::{Method, Region, SolverParams, neighbours, solve};
use crate::metric::Metric;
use crate::raster::RasterError;
use crate::samples::LightSamples;

/// How far the first round's neighbours stand, relative to the legal range of p4; a third of that in the last one.
const FIRST_STEP: f64 = 0.08;

/// Largest map measured here, texels: which of two maps wastes less does not hang on their size, and larger ones cost
/// time to draw.
const TEXELS_MEASURED: f64 = (1u32 << 20) as f64;

/// Replaces a light's single map by a better one, if measuring finds one. Lights with several maps, other methods than
/// lixel, and maps that may not warp stay as they are. Returns the number of maps measured.
pub fn polish(
    question: &FilmQuestion,
    samples: &LightSamples,
    fitted: &mut FittedLight,
    judge: &mut Judge,
) -> Result<u64, RasterError> {
    let rounds = question.solver.measured_rounds;
    if rounds == 0 || question.solver.method != Method::Lixel || fitted.regions.len() != 1 {
        return Ok(0);
    }
    let covered = std::mem::take(&mut fitted.covered);
    let texels = fitted.texels.min(TEXELS_MEASURED);
    let variant = |method: Method, metric: Metric| -> Option<Region> {
        let solver = SolverParams { method, metric, ..question.solver.clone() };
        let regions = solve(method, &question.inputs(samples, &covered, texels, &solver)).ok()?;
        <[Region; 1]>::try_from(regions).ok().map(|[region]| region)
    };
    let mut measured = 0;
    let mut best = match measure(question, judge, &fitted.regions[0], texels, u64::MAX)? {
        Some(first) => first,
        None => return Ok(0),
    };
    let mut better = |judge: &mut Judge, candidates: Vec<Region>, best: &mut (u64, JudgedMap)| {
        for region in candidates {
            measured += 1;
            if let Some(candidate) = measure(question, judge, &region, texels, best.0)? {
                *best = candidate;
            }
        }
        Ok::<(), RasterError>(())
    };
    let others: Vec<Region> = [
        variant(Method::Lixel, Metric::Displacement).filter(|_| question.solver.metric != Metric::Displacement),
        variant(Method::Lixel, Metric::Saturating).filter(|_| question.solver.metric != Metric::Saturating),
        variant(Method::SceneOptimal, Metric::L2),
    ]
    .into_iter()
    .flatten()
    .collect();
    better(judge, others, &mut best)?;
    for round in 0..rounds {
        let t = if rounds > 1 { f64::from(round) / f64::from(rounds - 1) } else { 0.0 };
        let step = FIRST_STEP * (1.0 - t * 2.0 / 3.0);
        let inputs = question.inputs(samples, &covered, texels, question.solver);
        let near = neighbours(&inputs, &best.1.region, step);
        better(judge, near, &mut best)?;
    }
    fitted.regions = vec![best.1.region.clone()];
    judge.maps = vec![best.1];
    fitted.covered = covered;
    Ok(measured)
}

/// Wrong pixels of a region at a number of texels, if fewer than `limit`; `None` also when it has no depth row.
fn measure(
    question: &FilmQuestion,
    judge: &mut Judge,
    region: &Region,
    texels: f64,
    limit: u64,
) -> Result<Option<(u64, JudgedMap)>, RasterError> {
    let Ok(map) = judge.judged(region) else { return Ok(None) };
    let grid = SizeGrid::new(&[(region.aspect, 1.0)], question.map);
    let sizes = grid.sizes(grid.at_least(texels)).to_vec();
    let before = std::mem::replace(&mut judge.maps, vec![map]);
    let drawn = judge.draw(&sizes, default_bias(&question.map.bias));
    let mut maps = std::mem::replace(&mut judge.maps, before);
    let wrong = judge.fewer_wrong(&drawn?, limit);
    Ok(wrong.zip(maps.pop()))
}
