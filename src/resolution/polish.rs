//! Chooses between maps by what they are measured to get wrong.
//!
//! The metric sees shadow edges, not what the bias hides nor what falls between samples. So at the predicted size a few
//! more maps are drawn and counted: the answers of the other metrics and of the scene-optimal method, then in rounds the
//! neighbours of the best map so far. The measured count decides, ties by the order of trial. Each map of a light is
//! judged on the pixels that look it up; then texels move between the maps to where they are measured to count most.

use super::bias::default_bias;
use super::judge::{Judge, JudgedMap};
use super::shares::measured_shares;
use super::{FilmQuestion, FittedLight, SizeGrid};
use crate::depth::Visible;
use crate::math::{Domain, first_holding};
use crate::measure::{Outside, Receivers};
use crate::methods::{Inputs, Method, Region, SolverParams, neighbours, solve};
use crate::metric::Metric;
use crate::raster::RasterError;
use crate::samples::LightSamples;
use glam::DVec3;

/// How far the first round's neighbours stand, relative to the legal range of p4; a third of that in the last one.
const FIRST_STEP: f64 = 0.08;

/// Largest map measured here, texels: which of two maps wastes less does not hang on their size, and larger ones cost
/// time to draw.
const TEXELS_MEASURED: f64 = (1u32 << 20) as f64;

/// Replaces a light's maps by better ones, and their shares of the texels, where measuring finds some. Other methods
/// than lixel's own, and maps that may not warp, stay as they are. Returns the number of maps measured.
pub fn polish(
    question: &FilmQuestion,
    samples: &LightSamples,
    fitted: &mut FittedLight,
    judge: &mut Judge,
) -> Result<u64, RasterError> {
    let ours = matches!(question.solver.method, Method::Lixel | Method::Partitioned);
    if question.solver.measured_rounds == 0 || !ours {
        return Ok(0);
    }
    let texels = fitted.texels.min(TEXELS_MEASURED);
    let own = judge.own_receivers();
    let first = |point: DVec3| first_holding(fitted.regions.iter().map(|r| &r.domain), point);
    let mut edges = vec![Vec::new(); fitted.regions.len()];
    for edge in &samples.edges {
        if let Some(k) = first(edge.position) {
            edges[k].push(*edge);
        }
    }
    let mut covered = vec![Vec::new(); fitted.regions.len()];
    for point in &fitted.covered {
        if let Some(k) = first(*point) {
            covered[k].push(*point);
        }
    }
    if fitted.regions.len() > 1 {
        // The cover leaves out what lies between its points; parted, they may have a border between them.
        for (covered, own) in covered.iter_mut().zip(&own) {
            covered.extend(own.positions_where(question.map.outside == Outside::Lit));
        }
    }
    let mut measured = 0;
    for (k, own) in own.iter().enumerate() {
        let texels = texels * fitted.shares[k];
        let inputs = question.inputs(samples, &covered[k], texels, question.solver);
        let visible = &Visible::new(&own.positions);
        let part = Part { question, inputs: Inputs { edges: &edges[k], ..inputs }, own, visible, texels };
        if let Some(map) = part.best(judge, &fitted.regions[k], &mut measured)? {
            fitted.regions[k] = map.region.clone();
            judge.maps[k] = map;
        }
    }
    if fitted.regions.len() > 1 {
        measured += measured_shares(question, judge, &own, texels, &mut fitted.shares)?;
    }
    Ok(measured)
}

/// One map of a light: what it is fitted to, and the receivers that look it up.
struct Part<'a> {
    question: &'a FilmQuestion<'a>,
    inputs: Inputs<'a>,
    own: &'a Receivers,
    visible: &'a Visible<'a>,
    texels: f64,
}

impl Part<'_> {
    /// The map with the fewest wrong pixels; `None` when the region itself has no depth row.
    fn best(&self, judge: &mut Judge, region: &Region, measured: &mut u64) -> Result<Option<JudgedMap>, RasterError> {
        let solver = self.question.solver;
        let Some(mut best) = self.measure(judge, region, u64::MAX)? else { return Ok(None) };
        let mut better = |judge: &mut Judge, candidates: Vec<Region>, best: &mut (u64, JudgedMap)| {
            for region in candidates {
                *measured += 1;
                if let Some(candidate) = self.measure(judge, &region, best.0)? {
                    *best = candidate;
                }
            }
            Ok::<(), RasterError>(())
        };
        let variant = |method: Method, metric: Metric| self.variant(method, metric, &region.domain);
        let others = [
            variant(Method::Lixel, Metric::Displacement).filter(|_| solver.metric != Metric::Displacement),
            variant(Method::Lixel, Metric::Saturating).filter(|_| solver.metric != Metric::Saturating),
            variant(Method::SceneOptimal, Metric::L2),
            variant(Method::Lixel, Metric::L2),
            variant(Method::Lispsm, Metric::L2),
            variant(Method::Tsm, Metric::L2),
            variant(Method::Focused, Metric::L2),
        ];
        better(judge, others.into_iter().flatten().collect(), &mut best)?;
        let rounds = solver.measured_rounds;
        for round in 0..rounds {
            let t = if rounds > 1 { f64::from(round) / f64::from(rounds - 1) } else { 0.0 };
            let step = FIRST_STEP * (1.0 - t * 2.0 / 3.0);
            let near = neighbours(&self.inputs, &best.1.region, step);
            better(judge, near, &mut best)?;
        }
        Ok(Some(best.1))
    }

    /// The part's map by another method or metric.
    fn variant(&self, method: Method, metric: Metric, domain: &Domain) -> Option<Region> {
        let solver = SolverParams { method, metric, ..self.question.solver.clone() };
        let regions = solve(method, &Inputs { solver: &solver, ..self.inputs }).ok()?;
        let [mut region] = <[Region; 1]>::try_from(regions).ok()?;
        region.domain = domain.clone();
        Some(region)
    }

    /// Wrong pixels of a region, if fewer than `limit`; `None` also when it has no depth row.
    fn measure(&self, judge: &mut Judge, region: &Region, limit: u64) -> Result<Option<(u64, JudgedMap)>, RasterError> {
        let Ok(map) = judge.judged(region, self.visible) else { return Ok(None) };
        let grid = SizeGrid::new(&[(region.aspect, 1.0)], self.question.map);
        let size = grid.sizes(grid.at_least(self.texels))[0];
        let bias = default_bias(&self.question.map.bias);
        Ok(judge.fewer_wrong(&map, size, bias, self.own, limit)?.map(|wrong| (wrong, map)))
    }
}
