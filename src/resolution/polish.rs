//! Chooses between maps by what they are measured to get wrong.
//!
//! The metric sees shadow edges, not what the bias hides nor how thin things fall on texels. So a few more maps are drawn
//! at the size and with the bias they are to have, and counted as the certificate counts: the answers of the other
//! metrics and of other methods, then maps near the best ones so far (`nearby`). The fewest wrong pixels decide, ties by
//! the order of trial. Each map of a light is judged on the pixels that look it up; then texels move between the maps to
//! where they are measured to count most.

use super::nearby::Nearby;
use super::shares::measured_shares;
use super::{FilmQuestion, FittedLight, Judge, JudgedMap, MapParams, SizeGrid};
use crate::depth::Visible;
use crate::math::{Domain, first_holding};
use crate::measure::{Outside, Receivers};
use crate::methods::{AreaOver, Inputs, Method, Region, SolverParams, near, refitted, solve};
use crate::metric::Metric;
use crate::raster::{Bias, RasterError};
use crate::samples::LightSamples;
use glam::DVec3;

/// Largest map measured here, texels; larger ones cost time to draw. What coarse steps gain at this size holds at larger
/// ones, what fine ones gain does not: they are left out.
const TEXELS_MEASURED: f64 = (1u32 << 20) as f64;

/// Maps near the best one that one of `solver.measured_rounds` measures.
const MAPS_A_ROUND: u32 = 8;

/// Triangles of a scene up to which every map of a round is measured, and every bias. Of larger ones fewer maps are, in inverse
/// proportion, and the bias is chosen by lookups, so that time does not grow with triangles times maps.
pub(super) const TRIANGLES_MEASURED: u64 = 2_000_000;

/// The first maps near the best one keep the metric's own affine part and only move p4: coarse steps first.
const REFITTED: u32 = 2 * MAPS_A_ROUND;

/// Maps that steps begin at: the best of the metrics' and methods' answers.
const LINES: usize = 4;

/// The steps from each take this part of all; those left go on from the one that leads then. Measured over 60 lights: four
/// such lines have 2.6 % fewer wrong pixels on the courtyard than one with as many steps, whose start decides too much; on
/// the floor and a scanned scene, with few things narrower than a texel, both come to the same within 1 %.
const EARLY: u32 = 6;

/// Turns that the rounds are taken in where the size is free. What is gained at one size is partly luck with its texels, so
/// the last maps are measured at the size that comes out, or nearly. Against one turn, four save 3 % of the texels over 16
/// lights on the courtyard and 5 % over 12 on a scanned scene, in 1.07 times the time.
const TURNS: u32 = 4;

/// The rounds that are taken of those that a job asks for.
#[derive(Clone, Copy)]
pub struct Turn {
    number: u32,
    of: u32,
}

impl Turn {
    /// All rounds.
    pub const ONLY: Turn = Turn { number: 0, of: 1 };

    /// Turns from a size in texels on, which is settled anew in between. Where maps are measured at a smaller size there is
    /// only one.
    pub fn all(solver: &SolverParams, texels: f64) -> impl Iterator<Item = Turn> {
        let of = if texels > TEXELS_MEASURED { 1 } else { TURNS.min(solver.measured_rounds) };
        (0..of).map(move |number| Turn { number, of })
    }
}

/// Steps from one map on.
struct Line {
    /// The best so far, with the smallest limit that it meets.
    best: (f64, JudgedMap),
    nearby: Nearby,
    /// Taken so far.
    steps: u32,
}

/// How maps are drawn that are chosen between.
#[derive(Clone, Copy)]
pub struct Drawing<'a> {
    /// Texels of a map of an aspect (width over height), for its share of the light's texels.
    pub size: &'a dyn Fn(f64, f64) -> [u32; 2],
    /// As they will be drawn.
    pub bias: Bias,
}

/// The size on a job's grid of a single map with at least so many texels.
pub fn size_on_grid(map: &MapParams, aspect: f64, texels: f64) -> [u32; 2] {
    let grid = SizeGrid::new(&[(aspect, 1.0)], map);
    grid.sizes(grid.at_least(texels))[0]
}

/// Whether measuring is asked to choose between maps: of lixel's own methods only.
pub fn polishes(solver: &SolverParams) -> bool {
    solver.measured_rounds > 0 && matches!(solver.method, Method::Lixel | Method::Partitioned)
}

/// Replaces a light's maps by better ones, and their shares of the texels, where measuring finds some, unless the job asks
/// for none. Turns after the first go on from the maps as they are. Returns the number of maps measured.
pub fn polish(
    question: &FilmQuestion,
    samples: &LightSamples,
    fitted: &mut FittedLight,
    judge: &mut Judge,
    drawing: &Drawing,
    turn: Turn,
) -> Result<u64, RasterError> {
    if !polishes(question.solver) {
        return Ok(0);
    }
    let texels = fitted.texels.min(TEXELS_MEASURED);
    let smaller = texels < fitted.texels;
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
        let inputs = Inputs { edges: &edges[k], ..inputs };
        let part = Part { question, inputs, own, visible, texels, smaller, drawing, turn };
        if let Some(map) = part.best(judge, &fitted.regions[k], &mut measured)? {
            fitted.regions[k] = map.region.clone();
            judge.maps[k] = map;
        }
    }
    if fitted.regions.len() > 1 {
        measured += measured_shares(judge, &own, texels, drawing, &mut fitted.shares)?;
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
    /// They are fewer than the map will have.
    smaller: bool,
    drawing: &'a Drawing<'a>,
    turn: Turn,
}

impl Part<'_> {
    /// The map with the fewest wrong pixels; `None` when the region itself has no depth row.
    fn best(&self, judge: &mut Judge, region: &Region, measured: &mut u64) -> Result<Option<JudgedMap>, RasterError> {
        let Some(own) = self.measure(judge, region, f64::INFINITY)? else { return Ok(None) };
        let asked = self.maps_asked(judge.triangles()) / self.turn.of;
        let first = self.turn.number == 0;
        let lines = if first && !self.smaller { LINES } else { 1 };
        let mut left = if self.smaller { asked.min(REFITTED) } else { asked };
        let mut starts = vec![own];
        let others = if first { self.others(&region.domain) } else { Vec::new() };
        for region in others {
            *measured += 1;
            // One that is no better than the last of as many as are wanted need not be counted to its end.
            let limit = starts.get(lines - 1).map_or(f64::INFINITY, |start| start.0);
            if let Some(found) = self.measure(judge, &region, limit)? {
                // Of equals the first.
                starts.insert(starts.partition_point(|start| start.0 <= found.0), found);
                starts.truncate(lines);
            }
        }
        let early = if lines > 1 { asked / EARLY } else { 0 };
        let mut lead: Option<Line> = None;
        for (number, best) in starts.into_iter().enumerate() {
            let stream = number as u64 + LINES as u64 * u64::from(self.turn.number);
            let mut line = Line { best, nearby: Nearby::new(stream), steps: if first { 0 } else { REFITTED } };
            self.follow(judge, &mut line, early, measured)?;
            left -= early;
            if lead.as_ref().is_none_or(|lead| line.best.0 < lead.best.0) {
                lead = Some(line);
            }
        }
        let Some(mut lead) = lead else { return Ok(None) };
        self.follow(judge, &mut lead, left, measured)?;
        Ok(Some(lead.best.1))
    }

    /// Maps that the job's rounds may draw of so many triangles.
    fn maps_asked(&self, triangles: u64) -> u32 {
        let asked = u64::from(self.question.solver.measured_rounds.saturating_mul(MAPS_A_ROUND));
        (asked * TRIANGLES_MEASURED.min(triangles) / triangles.max(1)) as u32
    }

    /// Takes steps from a line's best map, each better one the next to step from.
    fn follow(&self, judge: &mut Judge, line: &mut Line, steps: u32, measured: &mut u64) -> Result<(), RasterError> {
        for _ in 0..steps {
            let here = &line.best.1.region;
            let candidate = if line.steps < REFITTED {
                refitted(&self.inputs, here, line.nearby.warp())
            } else {
                near(&self.inputs, here, &line.nearby.step())
            };
            line.steps += 1;
            let better = match candidate {
                Some(region) => {
                    *measured += 1;
                    self.measure(judge, &region, line.best.0)?
                }
                None => None,
            };
            line.nearby.heed(better.is_some());
            if let Some(better) = better {
                line.best = better;
            }
        }
        Ok(())
    }

    /// What the other metrics and methods give for the part.
    fn others(&self, domain: &Domain) -> Vec<Region> {
        let own = self.question.solver;
        // The parts of a hull are not among the covered points, which other methods would be fitted to.
        if self.inputs.hull_only && own.method == Method::Partitioned {
            return Vec::new();
        }
        let variants = [
            (Method::Lixel, Metric::Displacement),
            (Method::Lixel, Metric::Saturating),
            (Method::Lixel, Metric::L2),
            (Method::SceneOptimal, Metric::L2),
            (Method::HomographyArea, Metric::L2),
            (Method::Lispsm, Metric::L2),
            (Method::Tsm, Metric::L2),
            (Method::Psm, Metric::L2),
            (Method::Focused, Metric::L2),
        ];
        let others = variants.into_iter().filter(|v| *v != (Method::Lixel, own.metric));
        others.filter_map(|(method, metric)| self.variant(method, metric, domain)).collect()
    }

    /// The part's map by another method or metric.
    fn variant(&self, method: Method, metric: Metric, domain: &Domain) -> Option<Region> {
        let solver = SolverParams { method, metric, area: AreaOver::Normal, ..self.question.solver.clone() };
        let regions = solve(method, &Inputs { solver: &solver, ..self.inputs }).ok()?;
        let [mut region] = <[Region; 1]>::try_from(regions).ok()?;
        region.domain = domain.clone();
        Some(region)
    }

    /// A region's wrong pixels as a limit that it meets, if below `limit`; `None` also when it has no depth row.
    fn measure(&self, judge: &mut Judge, region: &Region, limit: f64) -> Result<Option<(f64, JudgedMap)>, RasterError> {
        let Ok(map) = judge.judged(region, self.visible) else { return Ok(None) };
        let size = (self.drawing.size)(region.aspect, self.texels);
        let found = judge.least_limit(&map, size, self.drawing.bias, self.own, limit)?;
        Ok(found.map(|found| (found, map)))
    }
}
