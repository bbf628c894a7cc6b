//! What the entries of a budget's plan say of gains and prices, from the sizes that they say were tried.

use super::super::{FramePlan, LightBudget, LightPlan, Plan};
use super::units::{Unit, limits, units};
use crate::budget::{Curve, Item, allocate};
use crate::job::Job;

/// Gains are stated for so many texels.
const TEXELS: f64 = 1e6;

/// Relative difference that is none: another system's powers and logarithms.
const ACCURACY: f64 = 1e-6;

/// Writes what each entry gains.
pub(super) fn state(frames: &mut [FramePlan], job: &Job) {
    let units = units(frames, &job.light);
    let stated = computed(frames, &units, job);
    for (unit, stated) in units.iter().zip(stated) {
        for [k, l] in &unit.entries {
            frames[*k].lights[*l].budget.clone_from(&stated);
        }
    }
}

/// What each unit gains; `None` for one of which no size was tried.
fn computed(frames: &[FramePlan], units: &[Unit], job: &Job) -> Vec<Option<LightBudget>> {
    let curves: Vec<Option<Curve>> = units.iter().map(|u| Curve::new(&u.tried(frames))).collect();
    let known: Option<Vec<Item>> = curves
        .iter()
        .zip(units)
        .map(|(curve, unit)| curve.clone().map(|curve| Item { curve, weight: unit.importance }))
        .collect();
    let (limits, _) = limits(units, frames.len(), &job.budget);
    let prices = known.and_then(|items| allocate(&items, &limits).ok()).map(|found| found.prices);
    let of = |(u, (curve, unit)): (usize, (&Option<Curve>, &Unit))| {
        let [last, next] = curve.as_ref()?.gains(unit.texels(frames) as f64).map(|g| g * unit.importance * TEXELS);
        Some(LightBudget {
            importance: unit.importance,
            gain_of_last: Some(last).filter(|g| g.is_finite()),
            gain_of_next: next,
            price: prices.as_ref().map_or(0.0, |p| p[u] * TEXELS),
        })
    };
    curves.iter().zip(units).enumerate().map(of).collect()
}

/// What does not hold of a plan's budget, with frame and light; nothing for a plan without one.
pub(in crate::plan) fn faults(plan: &Plan) -> Vec<String> {
    let job = &plan.job.job;
    let entries = || plan.frames.iter().flat_map(|f| f.lights.iter().map(move |l| (f.frame, l)));
    let at = |frame: i64, entry: &LightPlan, text: &str| format!("frame {frame}, {}: {text}", entry.light);
    if !job.budget.is_given() {
        let stray = entries().filter(|(_, l)| l.budget.is_some());
        return stray.map(|(frame, l)| at(frame, l, "it has a share of a budget, and the job has none")).collect();
    }
    let units = units(&plan.frames, &job.light);
    let mut faults = Vec::new();
    if plan.budget.as_ref().is_some_and(|b| !b.held) && plan.summary.met {
        faults.push("the limits of the budget are passed, and every light is said to be within them".to_owned());
    }
    for (unit, found) in units.iter().zip(computed(&plan.frames, &units, job)) {
        for [k, l] in &unit.entries {
            let (frame, entry) = (plan.frames[*k].frame, &plan.frames[*k].lights[*l]);
            let same_maps = {
                let [k, l] = unit.entries[0];
                let first = &plan.frames[k].lights[l];
                let sizes = |e: &LightPlan| e.maps.iter().map(|m| [m.width, m.height]).collect::<Vec<_>>();
                sizes(first) == sizes(entry)
            };
            if !same_maps {
                faults.push(at(frame, entry, "its maps are not of the size of its segment's first"));
            }
            match (&entry.budget, &found) {
                (Some(stated), Some(found)) if same(stated, found) => {}
                (Some(stated), found) => faults.push(at(
                    frame,
                    entry,
                    &format!("its budget is {stated:?} in the plan, {found:?} from the sizes tried"),
                )),
                (None, _) => faults.push(at(frame, entry, "it has maps, and no share of the budget")),
            }
        }
    }
    faults
}

fn same(a: &LightBudget, b: &LightBudget) -> bool {
    let close = |a: f64, b: f64| (a - b).abs() <= ACCURACY * a.abs().max(b.abs());
    a.importance == b.importance
        && close(a.gain_of_next, b.gain_of_next)
        && close(a.price, b.price)
        && match (a.gain_of_last, b.gain_of_last) {
            (Some(a), Some(b)) => close(a, b),
            (a, b) => a == b,
        }
}
