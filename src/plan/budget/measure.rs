//! Wrong pixels of a plan's maps at other sizes than its own, measured from its matrices alone.

use super::super::remeasure::draw_map;
use super::super::stage::{Posed, Stages};
use super::super::{FramePlan, LightPlan, PlanError, Stage, Watch};
use super::units::Unit;
use crate::measure::{Certainty, Drawn, Receivers, Verdict, wrong};
use crate::raster::{Bias, RasterError};
use crate::resolution::texels;
use crate::scene::{Camera, Light};
use crate::visibility::{RayOffset, Tracer, View, see};
use std::collections::BTreeMap;

/// Texels of each map.
pub(in crate::plan) type Sizes = Vec<[u32; 2]>;

/// What was measured of a unit at a size: a verdict an entry.
pub(in crate::plan) type Counts = BTreeMap<Sizes, Vec<Verdict>>;

/// Texels of maps that stay drawn for the frames that reuse them: 256 MiB.
const TEXELS_HELD: u64 = 1 << 26;

/// An entry of the plan with all that its maps are judged by.
pub(in crate::plan) struct Case<'a> {
    pub(in crate::plan) tracer: &'a Tracer<'a>,
    pub(in crate::plan) camera: &'a Camera,
    pub(in crate::plan) view: &'a View,
    pub(in crate::plan) offset: RayOffset,
    pub(in crate::plan) light: &'a Light,
    pub(in crate::plan) entry: &'a LightPlan,
    pub(in crate::plan) receivers: &'a Receivers,
    pub(in crate::plan) certainty: &'a Certainty<'a>,
    /// Number of the unit, and of the entry among the unit's.
    pub(in crate::plan) place: [usize; 2],
}

impl Case<'_> {
    /// Draws the entry's maps at sizes; with a bias where one is given, else with its own.
    pub(in crate::plan) fn draw(
        &self,
        sizes: &[[u32; 2]],
        bias: Option<Bias>,
        stages: &Stages,
    ) -> Result<Vec<Drawn>, RasterError> {
        let (sides, maps) = (stages.job.map.single_sided, &self.entry.maps);
        let one = |(map, size)| draw_map(self.tracer, self.light, map, size, bias, sides);
        maps.iter().zip(sizes.iter().copied()).map(one).collect()
    }
}

/// Goes through the frames and calls `work` for the entries of units that are wanted.
pub(super) fn each_entry(
    stages: &Stages,
    frames: &[FramePlan],
    units: &[Unit],
    wanted: impl Fn(usize) -> bool,
    watch: &Watch,
    mut work: impl FnMut(&Case) -> Result<(), PlanError>,
) -> Result<(), PlanError> {
    let mut by_frame: Vec<Vec<[usize; 2]>> = vec![Vec::new(); frames.len()];
    for (number, unit) in units.iter().enumerate().filter(|(u, _)| wanted(*u)) {
        unit.entries.iter().enumerate().for_each(|(i, [k, _])| by_frame[*k].push([number, i]));
    }
    let total = by_frame.iter().map(|of| of.len() as u64).sum();
    let mut done = 0;
    for (planned, places) in frames.iter().zip(by_frame).filter(|(_, places)| !places.is_empty()) {
        let posed = Posed::new(stages.shot, planned.time_s)?;
        let (tracer, frame) = (posed.tracer(stages.shot, &stages.still), &posed.frame);
        let view = see(&tracer, &frame.camera, stages.shot.film);
        let offset = RayOffset::for_scene(&tracer);
        for place in places {
            watch.step(Stage::Budget, done, total)?;
            done += 1;
            let [_, l] = units[place[0]].entries[place[1]];
            let entry = &planned.lights[l];
            let Some(light) = frame.lights.iter().find(|light| light.name == entry.light) else { continue };
            let receivers = Receivers::classify(&tracer, &view, &frame.camera, light, offset);
            let certainty = Certainty::new(&tracer, &view, &frame.camera, light, &receivers, offset);
            let (camera, receivers, certainty) = (&frame.camera, &receivers, &certainty);
            let (tracer, view) = (&tracer, &view);
            work(&Case { tracer, camera, view, offset, light, entry, receivers, certainty, place })?;
        }
    }
    watch.step(Stage::Budget, total, total)
}

/// Measures units at sizes and adds what was found.
pub(super) fn measure(
    stages: &Stages,
    frames: &[FramePlan],
    units: &[Unit],
    wanted: &[Vec<Sizes>],
    counts: &mut [Counts],
    watch: &Watch,
) -> Result<(), PlanError> {
    let mut held: BTreeMap<(usize, &Sizes), Vec<Drawn>> = BTreeMap::new();
    let mut texels_held = 0;
    each_entry(
        stages,
        frames,
        units,
        |u| !wanted[u].is_empty(),
        watch,
        |case| {
            let [u, i] = case.place;
            let next = units[u].entries.get(i + 1).map(|[k, l]| &frames[*k].lights[*l]);
            let stays = next.and_then(|entry| entry.temporal.as_ref()).is_some_and(|t| t.reused_from.is_some());
            for sizes in &wanted[u] {
                watch.check()?;
                let drawn = match held.remove(&(u, sizes)) {
                    Some(drawn) => {
                        texels_held -= texels(sizes);
                        drawn
                    }
                    None => case.draw(sizes, None, stages)?,
                };
                let wrong = wrong(case.receivers, &drawn, stages.job.map.outside);
                counts[u].entry(sizes.clone()).or_default().push(case.certainty.verdict(&wrong));
                if stays && texels_held + texels(sizes) <= TEXELS_HELD {
                    texels_held += texels(sizes);
                    held.insert((u, sizes), drawn);
                }
            }
            Ok(())
        },
    )
}
