//! The entries of a plan at other sizes.

use super::super::map_entry::resize;
use super::super::seen::seen_on_film;
use super::super::stage::Stages;
use super::super::{FramePlan, LightPlan, Measured, PlanError, Status, Tried, Watch};
use super::measure::{Case, Counts, Sizes, each_entry};
use super::units::Unit;
use crate::measure::{Verdict, wrong};
use crate::raster::RasterError;
use crate::resolution::{other_biases, texels};
use crate::visibility::EDGE_ON_DEGREES;

/// Writes the sizes chosen for each unit into its entries, with what was measured there.
pub(super) fn enter(
    stages: &Stages,
    frames: &mut [FramePlan],
    units: &[Unit],
    counts: &[Counts],
    chosen: &[Sizes],
    watch: &Watch,
) -> Result<(), PlanError> {
    let mut entered: Vec<([usize; 2], LightPlan)> = Vec::new();
    each_entry(
        stages,
        frames,
        units,
        |_| true,
        watch,
        |case| {
            let [u, i] = case.place;
            let mut entry = resized(stages, case, &counts[u], &chosen[u])?;
            let measured = entry.error.as_ref().and_then(|e| e.measured.as_ref());
            entry.epsilon = measured.map_or(0.0, |m| m.misclassified as f64 / m.of_pixels as f64);
            (entry.status, entry.reason) = (Status::Planned, None);
            if let Some(error) = &mut entry.error {
                error.met = true;
            }
            entered.push((units[u].entries[i], entry));
            Ok(())
        },
    )?;
    for ([k, l], entry) in entered {
        frames[k].lights[l] = entry;
    }
    Ok(())
}

/// Marks the entries of a unit as not within the budget.
pub(super) fn fall_short(frames: &mut [FramePlan], unit: &Unit, reason: &str) {
    for [k, l] in &unit.entries {
        let entry = &mut frames[*k].lights[*l];
        (entry.status, entry.reason) = (Status::NotMet, Some(reason.to_owned()));
        if let Some(error) = &mut entry.error {
            error.met = false;
        }
    }
}

/// A case's entry with its maps at a size, of which `counts` holds what was measured; the bound is not judged.
pub(in crate::plan) fn resized(
    stages: &Stages,
    case: &Case,
    counts: &Counts,
    chosen: &Sizes,
) -> Result<LightPlan, RasterError> {
    let mut entry = case.entry.clone();
    let seen = seen_on_film(case.tracer, case.view, case.camera, case.receivers);
    for (k, size) in chosen.iter().enumerate() {
        resize(&mut entry.maps, k, *size, case.light, &seen);
    }
    let of_pixels = case.view.film.pixels() as u64;
    let verdict = counts.get(chosen).and_then(|v| v.get(case.place[1])).copied().unwrap_or_default();
    let self_shadow = self_shadow(stages, case, chosen)?;
    let all = verdict.certain.wrong() + verdict.uncertain;
    entry.cost.texels_drawn += counts.keys().map(|sizes| texels(sizes)).sum::<u64>();
    if let Some(temporal) = &mut entry.temporal {
        temporal.decided_by = None;
    }
    if let Some(error) = &mut entry.error {
        error.predicted = None;
        error.measured = Some(Measured {
            misclassified: verdict.certain.wrong(),
            of_pixels,
            false_lit: verdict.certain.false_lit,
            false_shadow: verdict.certain.false_shadow,
            uncertain: verdict.uncertain,
            edge: all - self_shadow,
            self_shadow,
            ray_offset_m: case.offset.metres,
            larger_ray_offset_m: case.offset.uncertain().metres,
            edge_on_degrees: EDGE_ON_DEGREES,
            displacement: None,
            footprint: None,
        });
        let tried = |(sizes, verdicts): (&Sizes, &Vec<Verdict>)| {
            let verdict = verdicts.get(case.place[1])?;
            let [width, height] = *sizes.first()?;
            let (misclassified, uncertain) = (verdict.certain.wrong(), verdict.uncertain);
            let texels = Some(texels(sizes));
            Some(Tried { width, height, texels, misclassified, uncertain, displacement: None, footprint: None })
        };
        error.tried = counts.iter().filter_map(tried).collect();
        error.tried.sort_by_key(|t| t.texels);
    }
    Ok(entry)
}

/// Of the wrong pixels at a size, certain or not, those owed to bias.
fn self_shadow(stages: &Stages, case: &Case, sizes: &Sizes) -> Result<u64, RasterError> {
    let outside = stages.job.map.outside;
    let all = wrong(case.receivers, &case.draw(sizes, None, stages)?, outside);
    let mut edge = all.clone();
    let Some(map) = case.entry.maps.first() else { return Ok(0) };
    for other in other_biases(map.bias.drawn()) {
        let still_wrong = wrong(case.receivers, &case.draw(sizes, Some(other), stages)?, outside);
        edge.retain(|i| still_wrong.binary_search(i).is_ok());
    }
    Ok((all.len() - edge.len()) as u64)
}
