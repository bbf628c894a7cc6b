//! What a budget gives texels to: the entries of a plan that share their maps.
//!
//! In mode `shot` that is a segment of a light, otherwise a light of a frame. A unit's maps are *resident* in every frame
//! that looks them up, and between two frames of which the later reuses what was drawn for the earlier; they are *drawn* as
//! often as the plan says.

use super::super::FramePlan;
use crate::budget::{BudgetParams, Limit, Point};
use crate::scene::LightParams;
use std::collections::{BTreeMap, BTreeSet};

/// Entries that share maps.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::plan) struct Unit {
    /// Name of the light.
    pub(in crate::plan) light: String,
    /// What one of its wrong pixels counts.
    pub(in crate::plan) importance: f64,
    /// Places of its entries in the plan: frame, light; in the order of frames.
    pub(in crate::plan) entries: Vec<[usize; 2]>,
    /// How often its maps are drawn.
    pub(in crate::plan) draws: u64,
    /// Places of the frames that hold its maps, ascending.
    pub(in crate::plan) resident: Vec<usize>,
}

/// The units of a plan, in the order of their first entries.
pub(in crate::plan) fn units(frames: &[FramePlan], lights: &[LightParams]) -> Vec<Unit> {
    let mut units: Vec<Unit> = Vec::new();
    let mut of_segment: BTreeMap<(&str, [i64; 2]), usize> = BTreeMap::new();
    for (k, frame) in frames.iter().enumerate() {
        for (l, entry) in frame.lights.iter().enumerate().filter(|(_, entry)| !entry.maps.is_empty()) {
            let segment = entry.temporal.as_ref().and_then(|t| t.segment);
            let known = segment.and_then(|s| of_segment.get(&(entry.light.as_str(), s)).copied());
            let number = known.unwrap_or(units.len());
            if known.is_none() {
                let importance = lights.iter().find(|p| p.name == entry.light).and_then(|p| p.importance);
                let (light, importance) = (entry.light.clone(), importance.unwrap_or(1.0));
                units.push(Unit { light, importance, entries: Vec::new(), draws: 0, resident: Vec::new() });
                if let Some(segment) = segment {
                    of_segment.insert((entry.light.as_str(), segment), number);
                }
            }
            let unit = &mut units[number];
            let reused = entry.temporal.as_ref().is_some_and(|t| t.reused_from.is_some());
            let from = unit.resident.last().filter(|_| reused).map_or(k, |last| last + 1);
            unit.resident.extend(from..=k);
            unit.draws += u64::from(!reused);
            unit.entries.push([k, l]);
        }
    }
    units
}

/// For each frame the units that it holds.
pub(in crate::plan) fn resident(units: &[Unit], frames: usize) -> Vec<Vec<usize>> {
    let mut held = vec![Vec::new(); frames];
    for (number, unit) in units.iter().enumerate() {
        unit.resident.iter().for_each(|k| held[*k].push(number));
    }
    held
}

/// The limits of a job on the units, with the keys they come from; frames that hold the same units are one.
pub(in crate::plan) fn limits(units: &[Unit], frames: usize, budget: &BudgetParams) -> (Vec<Limit>, Vec<&'static str>) {
    let mut limits = Vec::new();
    let mut keys = Vec::new();
    if let Some(most) = budget.resident() {
        let by_bytes = budget.texels_per_frame.is_none_or(|texels| texels > most);
        let distinct: BTreeSet<Vec<usize>> = resident(units, frames).into_iter().collect();
        for held in distinct {
            limits.push(Limit { most: most as f64, charges: held.into_iter().map(|u| (u, 1.0)).collect() });
            keys.push(if by_bytes { "budget.bytes" } else { "budget.texels_per_frame" });
        }
    }
    if let Some(most) = budget.texels_total {
        limits.push(drawn_limit(units, most as f64));
        keys.push("budget.texels_total");
    }
    (limits, keys)
}

/// A limit on the texels drawn.
pub(super) fn drawn_limit(units: &[Unit], most: f64) -> Limit {
    Limit { most, charges: units.iter().enumerate().map(|(u, unit)| (u, unit.draws as f64)).collect() }
}

impl Unit {
    /// Texels of its maps together.
    pub(in crate::plan) fn texels(&self, frames: &[FramePlan]) -> u64 {
        self.entries.first().map_or(0, |[k, l]| frames[*k].lights[*l].maps.iter().map(|m| m.texels()).sum())
    }

    /// The sizes that a plan says were tried in all of its frames, with their wrong pixels together.
    pub(super) fn tried(&self, frames: &[FramePlan]) -> Vec<Point> {
        let mut by_texels: BTreeMap<u64, (usize, u64)> = BTreeMap::new();
        for [k, l] in &self.entries {
            for tried in frames[*k].lights[*l].error.iter().flat_map(|e| &e.tried) {
                let Some(texels) = tried.texels else { continue };
                let sum = by_texels.entry(texels).or_default();
                *sum = (sum.0 + 1, sum.1.saturating_add(tried.misclassified));
            }
        }
        let of_all = by_texels.into_iter().filter(|(_, (count, _))| *count == self.entries.len());
        of_all.map(|(texels, (_, wrong))| Point { texels: texels as f64, wrong: wrong as f64 }).collect()
    }
}
