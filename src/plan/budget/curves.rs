//! Wrong pixels of a whole shot against its texels: the curve of which epsilon and budget are two ends.
//!
//! The job is planned by its epsilon and its maps are measured at other sizes. Of every size in between, the curves say what
//! equal marginal gains would come to. Measured besides: the plan itself, its texels shared out by gains, and half of them,
//! shared out by gains or with every map halved alike.

use super::super::make::{in_scene_space, load_shot};
use super::super::pieces::planned;
use super::super::stage::Stages;
use super::super::{FramePlan, PlanError, Watch};
use super::Search;
use super::measure::Sizes;
use super::sizes::{Ladder, sizes_of};
use super::units::{Unit, drawn_limit, limits, resident};
use crate::budget::{BudgetParams, Curve, Item, Limit, Point, allocate, used};
use crate::job::{Job, LoadedJob};
use crate::measure::{Counts, Verdict};
use crate::resolution::texels;
use serde::Serialize;

/// The curve is measured up to so many times the texels of the plan by epsilon.
const BEYOND: f64 = 2.0;
/// Ratio of neighbouring budgets that the curve is stated at.
const BETWEEN: f64 = std::f64::consts::SQRT_2;

/// A light's texels and wrong pixels over the shot.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LightPoint {
    /// Name.
    pub light: String,
    /// Texels of its maps that are drawn.
    pub texels_drawn: f64,
    /// Certainly wrong pixels, over all frames.
    pub misclassified: f64,
}

/// A point of the shot's curve, by the lights' own measured curves.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BudgetPoint {
    /// Texels drawn over the shot.
    pub texels_drawn: f64,
    /// Wrong pixels of all lights and frames.
    pub misclassified: f64,
    /// The same as a share of the pixels of all lights that need a map and all frames: the mean epsilon.
    pub epsilon: f64,
    /// Wrong pixels, times importance, that a million texels more would save.
    pub gain: f64,
    /// Light by light.
    pub lights: Vec<LightPoint>,
}

/// A light by itself.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LightCurve {
    /// Name.
    pub light: String,
    /// What one of its wrong pixels counts.
    pub importance: f64,
    /// Sizes measured: texels drawn and wrong pixels over the shot. Only for a light whose frames share one matrix.
    pub measured: Vec<[f64; 2]>,
    /// Texels drawn and wrong pixels: the lower convex hull in logarithms, shared out among its maps by gains.
    pub curve: Vec<[f64; 2]>,
}

/// Sizes for the whole shot, measured.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlanPoint {
    /// How they were chosen.
    pub name: String,
    /// Texels drawn over the shot.
    pub texels_drawn: u64,
    /// Texels resident in the frame that has most.
    pub texels_resident: u64,
    /// Wrong pixels, measured.
    pub misclassified: u64,
    /// The same times importance.
    pub weighted: f64,
    /// Light by light.
    pub lights: Vec<LightPoint>,
}

/// What `lixel budget` says.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BudgetCurves {
    /// Frames of the shot.
    pub frames: u64,
    /// Pixels of the image.
    pub of_pixels: u64,
    /// The bound of the plan that all of this is about.
    pub epsilon: f64,
    /// Light by light.
    pub lights: Vec<LightCurve>,
    /// The shot, from the smallest maps on.
    pub all: Vec<BudgetPoint>,
    /// Measured plans.
    pub plans: Vec<PlanPoint>,
}

/// Measures the curve of a job. With a budget in the job its limits take the place of the texels of the plan by epsilon.
///
/// # Errors
/// As [`super::super::make`].
pub fn budget_curves(loaded: &LoadedJob, watch: &Watch) -> Result<BudgetCurves, PlanError> {
    let shot = load_shot(loaded)?;
    let own = in_scene_space(&loaded.job, &shot);
    let budget = own.budget.clone();
    let job = &Job { budget: BudgetParams::default(), ..own };
    shot.scene.notes.iter().for_each(|note| watch.note(note));
    let stages = Stages::new(&shot, job, None);
    let frames = planned(&stages, false, watch)?;
    let mut search = Search::new(&stages, &frames);
    let base = known(&mut search, &frames);
    let drawn = |search: &Search, sizes: &[Sizes]| -> f64 {
        search.units.iter().zip(sizes).map(|(unit, sizes)| (texels(sizes) * unit.draws) as f64).sum()
    };
    let coarse = search.ladders.iter().zip(&base).map(|(l, sizes)| l.coarse(texels(sizes) as f64 * BEYOND)).collect();
    search.measure(&stages, &frames, coarse, watch)?;

    let mut plans = Vec::new();
    let given = if budget.is_given() { limits(&search.units, frames.len(), &budget).0 } else { Vec::new() };
    let mut reference = base.clone();
    if given.is_empty() {
        plans.push(search.point("by epsilon", &frames, &base));
        let same = [drawn_limit(&search.units, drawn(&search, &base))];
        let sizes = by_gains(&mut search, &stages, &frames, &same, watch)?;
        plans.extend(sizes.map(|sizes| search.point("the same texels by gains", &frames, &sizes)));
    } else if let Some(sizes) = by_gains(&mut search, &stages, &frames, &given, watch)? {
        plans.push(search.point("budget by gains", &frames, &sizes));
        reference = sizes;
    }
    let halved: Vec<Sizes> = search.ladders.iter().zip(&reference).map(half).collect();
    let wanted = search.ladders.iter().zip(&halved).map(|(l, s)| vec![l.at_most(texels(s) as f64)]).collect();
    search.measure(&stages, &frames, wanted, watch)?;
    plans.push(search.point("half, every map alike", &frames, &halved));
    let of_half = |limits: Vec<Limit>| -> Vec<Limit> {
        let texels: Vec<f64> = halved.iter().map(|s| texels(s) as f64).collect();
        let most = used(&texels, &limits);
        limits.into_iter().zip(most).map(|(limit, most)| Limit { most, ..limit }).collect()
    };
    let under = of_half(if given.is_empty() { vec![drawn_limit(&search.units, 0.0)] } else { given });
    let sizes = by_gains(&mut search, &stages, &frames, &under, watch)?;
    plans.extend(sizes.map(|sizes| search.point("half, by gains", &frames, &sizes)));
    let epsilon = job.quality.epsilon();
    let of_pixels = shot.film.pixels() as u64;
    Ok(BudgetCurves {
        frames: frames.len() as u64,
        of_pixels,
        epsilon,
        lights: lights(&search),
        all: curve_of_all(&search, of_pixels),
        plans,
    })
}

/// What the plan by epsilon measured already, and its sizes.
fn known(search: &mut Search, frames: &[FramePlan]) -> Vec<Sizes> {
    let mut base = Vec::with_capacity(search.units.len());
    for (unit, counts) in search.units.iter().zip(&mut search.counts) {
        let entries = || unit.entries.iter().map(|[k, l]| &frames[*k].lights[*l]);
        let verdict = |m: &super::super::Measured| Verdict {
            certain: Counts { false_lit: m.false_lit, false_shadow: m.false_shadow, uncovered: 0 },
            uncertain: m.uncertain,
        };
        let verdicts: Option<Vec<Verdict>> =
            entries().map(|e| e.error.as_ref()?.measured.as_ref().map(verdict)).collect();
        let sizes = entries().next().map(sizes_of).unwrap_or_default();
        if let Some(verdicts) = verdicts {
            counts.insert(sizes.clone(), verdicts);
        }
        base.push(sizes);
    }
    base
}

/// The sizes with half of the texels.
fn half((ladder, sizes): (&Ladder, &Sizes)) -> Sizes {
    ladder.sizes(ladder.at_most(texels(sizes) as f64 / 2.0))
}

/// Sizes under limits by equal gains, measured; `None` where the smallest maps pass them.
fn by_gains(
    search: &mut Search,
    stages: &Stages,
    frames: &[FramePlan],
    limits: &[Limit],
    watch: &Watch,
) -> Result<Option<Vec<Sizes>>, PlanError> {
    Ok(search.settled(stages, frames, limits, watch)?.ok())
}

impl Search {
    /// Measured sizes as a plan.
    fn point(&self, name: &str, frames: &[FramePlan], sizes: &[Sizes]) -> PlanPoint {
        let of = |u: usize| -> (u64, u64) {
            let verdicts = self.counts[u].get(&sizes[u]);
            let wrong = verdicts.map_or(0, |v| v.iter().map(|v| v.certain.wrong()).sum());
            (texels(&sizes[u]) * self.units[u].draws, wrong)
        };
        let all: Vec<(u64, u64)> = (0..self.units.len()).map(of).collect();
        let resident = resident(&self.units, frames.len());
        let of_frame = |held: Vec<usize>| held.into_iter().map(|u| texels(&sizes[u])).sum();
        PlanPoint {
            name: name.to_owned(),
            texels_drawn: all.iter().map(|a| a.0).sum(),
            texels_resident: resident.into_iter().map(of_frame).max().unwrap_or(0),
            misclassified: all.iter().map(|a| a.1).sum(),
            weighted: all.iter().zip(&self.units).map(|(a, unit)| a.1 as f64 * unit.importance).sum(),
            lights: by_light(&self.units, |u| [all[u].0 as f64, all[u].1 as f64]),
        }
    }
}

/// Sums over the units of each light, in the order of first appearance.
fn by_light(units: &[Unit], of: impl Fn(usize) -> [f64; 2]) -> Vec<LightPoint> {
    let mut lights: Vec<LightPoint> = Vec::new();
    for (u, unit) in units.iter().enumerate() {
        let [texels_drawn, misclassified] = of(u);
        match lights.iter_mut().find(|l| l.light == unit.light) {
            Some(light) => {
                light.texels_drawn += texels_drawn;
                light.misclassified += misclassified;
            }
            None => lights.push(LightPoint { light: unit.light.clone(), texels_drawn, misclassified }),
        }
    }
    lights
}

/// Budgets of texels drawn for some units, from the least to the most of their curves.
fn budgets(items: &[Item], units: &[&Unit]) -> Vec<f64> {
    let sum = |of: &dyn Fn(&Curve) -> f64| items.iter().zip(units).map(|(i, u)| of(&i.curve) * u.draws as f64).sum();
    let (least, most): (f64, f64) = (sum(&Curve::least), sum(&Curve::most));
    let mut all = vec![least];
    while all[all.len() - 1] * BETWEEN < most {
        all.push(all[all.len() - 1] * BETWEEN);
    }
    if most > least {
        all.push(most);
    }
    all
}

/// What equal gains come to under budgets of texels drawn: texels and wrong pixels of each unit, and the price.
fn at_budgets(items: &[Item], units: &[&Unit]) -> Vec<(Vec<[f64; 2]>, f64)> {
    let charges: Vec<(usize, f64)> = units.iter().enumerate().map(|(u, unit)| (u, unit.draws as f64)).collect();
    let at = |most: f64| {
        let found = allocate(items, &[Limit { most, charges: charges.clone() }]).ok()?;
        let of = |(u, texels): (usize, &f64)| [texels * charges[u].1, items[u].curve.wrong(*texels)];
        let price = found.prices.first().map_or(0.0, |p| p / charges[0].1);
        Some((found.texels.iter().enumerate().map(of).collect(), price))
    };
    budgets(items, units).into_iter().filter_map(at).collect()
}

fn curve_of_all(search: &Search, of_pixels: u64) -> Vec<BudgetPoint> {
    let items = search.items();
    let units: Vec<&Unit> = search.units.iter().collect();
    let pixels = search.units.iter().map(|u| u.entries.len() as u64 * of_pixels).sum::<u64>();
    let point = |(of, price): (Vec<[f64; 2]>, f64)| {
        let misclassified = of.iter().map(|p| p[1]).sum();
        BudgetPoint {
            texels_drawn: of.iter().map(|p| p[0]).sum(),
            misclassified,
            epsilon: misclassified / pixels.max(1) as f64,
            gain: price * 1e6,
            lights: by_light(&search.units, |u| of[u]),
        }
    };
    at_budgets(&items, &units).into_iter().map(point).collect()
}

fn lights(search: &Search) -> Vec<LightCurve> {
    let items = search.items();
    let mut lights: Vec<LightCurve> = Vec::new();
    for first in &search.units {
        if lights.iter().any(|l| l.light == first.light) {
            continue;
        }
        let own: Vec<usize> = (0..search.units.len()).filter(|u| search.units[*u].light == first.light).collect();
        let of: Vec<Item> = own.iter().map(|u| items[*u].clone()).collect();
        let units: Vec<&Unit> = own.iter().map(|u| &search.units[*u]).collect();
        let sum = |(of, _): (Vec<[f64; 2]>, f64)| of.into_iter().fold([0.0; 2], |a, b| [a[0] + b[0], a[1] + b[1]]);
        let measured = |u: usize| {
            let wrong = |v: &Vec<Verdict>| v.iter().map(|v| v.certain.wrong() as f64).sum();
            let one = |(sizes, v): (&Sizes, &Vec<Verdict>)| [(texels(sizes) * search.units[u].draws) as f64, wrong(v)];
            let mut all: Vec<[f64; 2]> = search.counts[u].iter().map(one).collect();
            all.sort_by(|a, b| a[0].total_cmp(&b[0]));
            all
        };
        lights.push(LightCurve {
            light: first.light.clone(),
            importance: first.importance,
            measured: if let [alone] = own[..] { measured(alone) } else { Vec::new() },
            curve: at_budgets(&of, &units).into_iter().map(sum).collect(),
        });
    }
    lights
}

impl BudgetCurves {
    /// The curves as a picture.
    pub fn svg(&self) -> String {
        let points =
            |of: &[[f64; 2]]| of.iter().map(|[texels, wrong]| Point { texels: *texels, wrong: *wrong }).collect();
        let all = self.all.iter().map(|p| [p.texels_drawn, p.misclassified]).collect::<Vec<_>>();
        let plans = self.plans.iter().map(|p| [p.texels_drawn as f64, p.misclassified as f64]).collect::<Vec<_>>();
        let mut lines =
            vec![crate::budget::Line { name: "all lights".to_owned(), curve: points(&all), measured: points(&plans) }];
        lines.extend(self.lights.iter().map(|l| crate::budget::Line {
            name: l.light.clone(),
            curve: points(&l.curve),
            measured: points(&l.measured),
        }));
        let frames = if self.frames == 1 { "frame" } else { "frames" };
        let title = format!("Wrong pixels against texels: {} {frames} of {} pixels", self.frames, self.of_pixels);
        crate::budget::plot(&title, &lines)
    }
}
