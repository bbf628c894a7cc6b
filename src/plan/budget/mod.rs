//! A plan within a budget: its matrices and segments stand, its sizes are settled by measured errors.
//!
//! ```text
//! units     entries that share maps; what is resident and drawn
//! measure   every frame, each unit's maps at sizes a factor of 2 in texels apart → counts
//! allocate  curves through the counts → sizes (`budget`); these are measured too, and it is done again
//! enter     every frame, the sizes with the fewest wrong pixels measured → the entries
//! ```
//!
//! Nothing of samples, metric or fit is used, so that a budget judges as `verify` does. What the entries say of gains and
//! prices is computed from their own sizes tried; `verify` computes it again.

mod claims;
mod curves;
mod enter;
mod measure;
mod sizes;
mod units;

pub(super) use claims::faults;
pub use curves::{BudgetCurves, BudgetPoint, LightCurve, LightPoint, PlanPoint, budget_curves};
pub(super) use enter::resized;
pub(super) use measure::{Case, Counts, Sizes};
pub(super) use sizes::Ladder;
pub(super) use units::{Unit, resident, units};

use super::stage::Stages;
use super::{FramePlan, LightPlan, PlanError, Watch};
use crate::budget::{Allocation, Curve, Item, Limit, Point, TooSmall, allocate, settle};
use crate::measure::Verdict;
use crate::resolution::texels;
use measure::measure;
use sizes::STEP;

use units::limits;

/// Rounds of sharing texels out and measuring what came of it, at most; it ends where nothing new comes up. The first finds the
/// sizes to a factor of the exponents' error; later ones know the curve there.
const ROUNDS: u32 = 6;

/// Gains and prices closer than this factor are equal.
const EQUAL: f64 = 1.05;

/// Sizes beside the one of equal gains that are measured with it, times its texels: counts are noisy, and of sizes that are
/// near the measured ones decide.
const NEAR: [f64; 2] = [0.92, 1.08];

/// Settles the sizes of a plan's maps within the job's budget.
pub(super) fn within(stages: &Stages, frames: &mut [FramePlan], watch: &Watch) -> Result<(), PlanError> {
    let budget = &stages.job.budget;
    let mut search = Search::new(stages, frames);
    let (limits, keys) = limits(&search.units, frames.len(), budget);
    let coarse = search.coarse(&limits);
    search.measure(stages, frames, coarse, watch)?;
    let settled = search.settled(stages, frames, &limits, watch)?;
    let (sizes, shortfall) = match settled {
        Ok(sizes) => (sizes, None),
        Err(TooSmall { limit, least }) => {
            let reason = format!(
                "the smallest maps take {least} texels, more than {} = {} allows: raise it, or lower map.min = {}",
                keys[limit],
                match keys[limit] {
                    "budget.bytes" => budget.bytes,
                    "budget.texels_total" => budget.texels_total,
                    _ => budget.texels_per_frame,
                }
                .unwrap_or(0),
                stages.job.map.min
            );
            (search.smallest(), Some((limits[limit].clone(), reason)))
        }
    };
    enter::enter(stages, frames, &search.units, &search.counts, &sizes, watch)?;
    if let Some((limit, reason)) = shortfall {
        for (number, _) in &limit.charges {
            enter::fall_short(frames, &search.units[*number], &reason);
        }
    }
    claims::state(frames, stages.job);
    Ok(())
}

/// The units of a plan and what is known of them.
struct Search {
    units: Vec<Unit>,
    ladders: Vec<Ladder>,
    counts: Vec<Counts>,
}

impl Search {
    fn new(stages: &Stages, frames: &[FramePlan]) -> Search {
        let units = units(frames, &stages.job.light);
        let ladder = |unit: &Unit| {
            let entries: Vec<&LightPlan> = unit.entries.iter().map(|[k, l]| &frames[*k].lights[*l]).collect();
            Ladder::of(&entries, &stages.job.map, STEP)
        };
        let ladders: Vec<Ladder> = units.iter().map(ladder).collect();
        let counts = vec![Counts::new(); units.len()];
        Search { units, ladders, counts }
    }

    /// Sizes to begin with: as far as the limits let each unit grow beside the smallest maps of all others.
    fn coarse(&self, limits: &[Limit]) -> Vec<Vec<usize>> {
        let mut most: Vec<f64> = self.ladders.iter().map(|l| l.texels[l.texels.len() - 1]).collect();
        for limit in limits {
            let least = |i: usize| self.ladders[i].texels[0];
            let all: f64 = limit.charges.iter().map(|(i, charge)| charge * least(*i)).sum();
            for (i, charge) in &limit.charges {
                most[*i] = most[*i].min(((limit.most - all) / charge + least(*i)).max(least(*i)));
            }
        }
        self.ladders.iter().zip(most).map(|(ladder, most)| ladder.coarse(most)).collect()
    }

    /// Measures units at places of their ladders that were not measured yet. Returns whether there were any.
    fn measure(
        &mut self,
        stages: &Stages,
        frames: &[FramePlan],
        places: Vec<Vec<usize>>,
        watch: &Watch,
    ) -> Result<bool, PlanError> {
        let sizes = |(u, places): (usize, Vec<usize>)| -> Vec<Sizes> {
            let all = places.into_iter().map(|place| self.ladders[u].sizes(place));
            all.filter(|sizes| !self.counts[u].contains_key(sizes)).collect()
        };
        let wanted: Vec<Vec<Sizes>> = places.into_iter().enumerate().map(sizes).collect();
        if wanted.iter().all(Vec::is_empty) {
            return Ok(false);
        }
        measure(stages, frames, &self.units, &wanted, &mut self.counts, watch)?;
        Ok(true)
    }

    /// The curves as measured so far. A unit that has none counts nothing.
    fn items(&self) -> Vec<Item> {
        let item = |(u, unit): (usize, &Unit)| {
            let point = |(sizes, verdicts): (&Sizes, &Vec<Verdict>)| Point {
                texels: texels(sizes) as f64,
                wrong: wrong_of(verdicts),
            };
            let points: Vec<Point> = self.counts[u].iter().map(point).collect();
            let none = || Curve::new(&[Point { texels: self.ladders[u].texels[0], wrong: 0.0 }]);
            Curve::new(&points).or_else(none).map(|curve| Item { curve, weight: unit.importance })
        };
        self.units.iter().enumerate().filter_map(item).collect()
    }

    /// Weighted wrong pixels as measured at some sizes; infinite where one was not measured.
    fn weighted(&self, sizes: &[Sizes]) -> f64 {
        let of = |(u, sizes): (usize, &Sizes)| {
            let wrong = self.counts[u].get(sizes).map_or(f64::INFINITY, |v| wrong_of(v));
            if self.units[u].importance > 0.0 { self.units[u].importance * wrong } else { 0.0 }
        };
        sizes.iter().enumerate().map(of).sum()
    }

    /// Sizes of equal gains, of those that came up the ones with the fewest weighted wrong pixels measured: in each round the
    /// sizes nearest to equal gains, and the measured sizes that span the curves around them.
    fn settled(
        &mut self,
        stages: &Stages,
        frames: &[FramePlan],
        limits: &[Limit],
        watch: &Watch,
    ) -> Result<Result<Vec<Sizes>, TooSmall>, PlanError> {
        let ladders: Vec<Vec<f64>> = self.ladders.iter().map(|l| l.texels.clone()).collect();
        let mut candidates: Vec<Vec<Sizes>> = Vec::new();
        let mut items = self.items();
        let mut allocation = match allocate(&items, limits) {
            Ok(allocation) => allocation,
            Err(too_small) => return Ok(Err(too_small)),
        };
        for _ in 0..ROUNDS {
            let places = settle(&items, &ladders, limits, &allocation);
            let near = |(ladder, place): (&Ladder, &usize)| {
                let beside = NEAR.map(|factor| ladder.at_most(ladder.texels[*place] * factor));
                let mut all = vec![*place];
                all.extend(beside.into_iter().filter(|p| p != place));
                all
            };
            let wanted = self.ladders.iter().zip(&places).map(near).collect();
            let new = self.measure(stages, frames, wanted, watch)?;
            candidates.push(self.ladders.iter().zip(&places).map(|(l, place)| l.sizes(*place)).collect());
            items = self.items();
            allocation = match allocate(&items, limits) {
                Ok(allocation) => allocation,
                Err(too_small) => return Ok(Err(too_small)),
            };
            let spanning: Vec<Vec<f64>> =
                items.iter().map(|i| i.curve.hull().iter().map(|p| p.texels).collect()).collect();
            let places = settle(&items, &spanning, limits, &allocation);
            candidates.push((0..items.len()).map(|u| self.spanning(u, spanning[u][places[u]])).collect());
            if !new {
                break;
            }
        }
        let rank = |sizes: &Vec<Sizes>| {
            let imbalance = imbalance(&items, sizes, &allocation);
            (if imbalance <= EQUAL { 1.0 } else { imbalance }, self.weighted(sizes))
        };
        let best = candidates.into_iter().map(|c| (rank(&c), c)).reduce(|a, b| {
            let order = b.0.0.total_cmp(&a.0.0).then(b.0.1.total_cmp(&a.0.1));
            if order.is_lt() { b } else { a }
        });
        Ok(Ok(best.map_or_else(|| self.smallest(), |b| b.1)))
    }

    /// Of the sizes measured with so many texels the one with the fewest wrong pixels.
    fn spanning(&self, u: usize, texels: f64) -> Sizes {
        let of = self.counts[u].iter().filter(|(sizes, _)| crate::resolution::texels(sizes) as f64 == texels);
        let fewest = of.min_by(|a, b| wrong_of(a.1).total_cmp(&wrong_of(b.1)));
        fewest.map_or_else(|| self.ladders[u].sizes(0), |(sizes, _)| sizes.clone())
    }

    /// The smallest sizes.
    fn smallest(&self) -> Vec<Sizes> {
        self.ladders.iter().map(|ladder| ladder.sizes(0)).collect()
    }
}

/// The largest factor by which a price is outside of the gains at some sizes.
fn imbalance(items: &[Item], sizes: &[Sizes], allocation: &Allocation) -> f64 {
    let of = |((item, sizes), price): ((&Item, &Sizes), &f64)| {
        let [last, next] = item.curve.gains(texels(sizes) as f64).map(|g| g * item.weight);
        if *price > 0.0 { (price / last).max(next / price) } else { 1.0 }
    };
    items.iter().zip(sizes).zip(&allocation.prices).map(of).fold(1.0, f64::max)
}

/// Certainly wrong pixels of all entries of a unit.
fn wrong_of(verdicts: &[Verdict]) -> f64 {
    verdicts.iter().map(|v| v.certain.wrong() as f64).sum()
}
