//! Sizes of segments by measurement, and the entries of their frames.

use super::super::light_entry::{light_error, map_entries, no_map_needed, not_met_reason, seen, solver_report};
use super::super::stage::{FrameStage, Stages};
use super::super::{FromImages, LightPlan, PlanError, Stage, Status, Watch, images};
use super::held::Held;
use super::{range, window};
use crate::math::RigidMotion;
use crate::measure::{Drawn, Receivers};
use crate::raster::{Bias, RasterError};
use crate::resolution::{
    Certified, Drawing, FilmQuestion, Judge, JudgedMap, Probe, Trial, default_bias, measured_bias, polish, predict,
    predicted_at_quantile, predicted_texels, size_on_grid, smallest, trial,
};
use crate::scene::Light;
use crate::shot::{Asked, LightParts, carry, in_frame, interval_samples};
use std::time::Instant;

/// Maps up to so many texels stay drawn from frame to frame: 128 MiB for each light in turn.
const TEXELS_HELD: u64 = 1 << 25;

/// Settles matrices, biases and sizes of segments of a light and writes their entries. The inner error is the reason why
/// the light has no maps for several frames.
pub(super) fn certify(
    stages: &Stages,
    light: &LightParts,
    mut held: Vec<Held>,
    asked: &Asked,
    timings: bool,
    watch: &Watch,
) -> Result<Result<Vec<Held>, String>, PlanError> {
    for segment in &mut held {
        watch.check()?;
        if segment.windows.is_empty() {
            polished(stages, light, segment, asked)?;
        }
    }
    if let Err(reason) = range::find(stages, light, &mut held, watch)? {
        return Ok(Err(reason));
    }
    for segment in &mut held {
        if let Err(reason) = sized(stages, light, segment, timings, watch)? {
            return Ok(Err(reason));
        }
    }
    Ok(Ok(held))
}

/// Grows all segments to the size of the largest, and measures them there.
pub(super) fn one_size(
    stages: &Stages,
    light: &LightParts,
    held: &mut [Held],
    timings: bool,
    watch: &Watch,
) -> Result<(), PlanError> {
    // Segments are fitted for one aspect (see `whole_light`), so that places on their grids are the same sizes; with several
    // maps a light, the same texels in all.
    loop {
        let largest = held.iter().map(|h| h.size).max().unwrap_or(0);
        let decided_by = held.iter().find(|h| h.size == largest).and_then(|h| h.decided_by);
        let mut grown = false;
        for segment in held.iter_mut() {
            let place = largest.min(segment.grid.len().saturating_sub(1));
            segment.size = place;
            // What is settled already does not become unsettled: only the size changes.
            drop(sized(stages, light, segment, timings, watch)?);
            grown |= segment.size != place;
        }
        if !grown {
            held.iter_mut().for_each(|segment| segment.decided_by = decided_by);
            return Ok(());
        }
    }
}

/// Better matrices near a segment's, by measurement on the frame that decides it. A light that moves stays with its own.
fn polished(stages: &Stages, light: &LightParts, held: &mut Held, asked: &Asked) -> Result<(), PlanError> {
    let job = stages.job;
    let frame = held.predicted_decider();
    if job.solver.measured_rounds == 0 || light.poses[frame] != light.poses[0] {
        return Ok(());
    }
    let parts: Vec<_> = held.segment.needing.iter().map(|f| &light.parts[*f]).collect();
    let mut samples = interval_samples(&parts);
    samples.covered.clone_from(&held.fitted.covered);
    stages.film(frame, |stage, scene| {
        let (Some(view), Some(here)) = (stage.view, scene.lights.iter().find(|l| l.name == light.light.name)) else {
            return Ok(());
        };
        let receivers = Receivers::classify(stage.tracer, view, stage.camera, here, stage.offset);
        let question = FilmQuestion { map: asked.map, ..stage.question(here, job) };
        if let Ok(mut judge) = Judge::new(stage.tracer, view, &question, &held.fitted, &receivers, stage.offset) {
            let size = |aspect: f64, texels: f64| size_on_grid(asked.map, aspect, texels);
            let drawing = Drawing { size: &size, bias: default_bias(&asked.map.bias) };
            polish(&question, &samples, &mut held.fitted, &mut judge, &drawing)?;
        }
        Ok(())
    })?;
    held.refit(asked);
    Ok(())
}

/// Measures a segment on all of its frames, at a size at which none is over, or at the largest.
fn sized(
    stages: &Stages,
    light: &LightParts,
    held: &mut Held,
    timings: bool,
    watch: &Watch,
) -> Result<Result<(), String>, PlanError> {
    let mut order = vec![held.predicted_decider()];
    order.extend(held.segment.needing.iter().copied().filter(|f| *f != held.predicted_decider()));
    let mut done = 0;
    loop {
        let stale: Vec<usize> = order.iter().copied().filter(|f| held.entered_at.get(f) != Some(&held.size)).collect();
        if stale.is_empty() {
            return Ok(Ok(()));
        }
        for frame in stale {
            watch.step(Stage::Lights, done, (done + 1).max(order.len() as u64))?;
            done += 1;
            let entered = stages.film(frame, |stage, scene| {
                let Some(here) = scene.lights.iter().find(|l| l.name == light.light.name) else { return Ok(None) };
                enter(stages, stage, light, held, frame, here, timings)
            })?;
            let Some(entry) = entered else {
                return Ok(Err("the domain of one of its maps does not move with the light".to_owned()));
            };
            held.entries.insert(frame, entry);
            held.entered_at.insert(frame, held.size);
        }
        held.drawn = None;
    }
}

/// A segment's maps as they stand in a frame whose points `motion` takes to where they stand for the segment.
fn carried(maps: &[JudgedMap], motion: Option<&RigidMotion>) -> Option<Vec<JudgedMap>> {
    let Some(motion) = motion else { return Some(maps.to_vec()) };
    let matrix = motion.matrix();
    maps.iter()
        .map(|map| {
            let mut depth = map.depth;
            depth.row = matrix.transpose() * depth.row;
            let clip_from_scene = map.clip_from_scene * matrix;
            Some(JudgedMap { region: map.region.carried(motion)?, clip_from_scene, depth })
        })
        .collect()
}

/// Measures a frame at the segment's size, or at the smallest larger one at which it is met, and writes its entry.
fn enter(
    stages: &Stages,
    stage: &FrameStage,
    light: &LightParts,
    held: &mut Held,
    frame: usize,
    here: &Light,
    timings: bool,
) -> Result<Option<LightPlan>, PlanError> {
    let start = Instant::now();
    let job = stages.job;
    let part = &light.parts[frame];
    let motion = carry(&light.poses[frame], &light.poses[0]);
    let at = |held: &Held, place: usize| carried(&window::maps(held, frame, place), motion.as_ref());
    let Some(maps) = at(held, held.size) else { return Ok(None) };
    let mut entry = LightPlan::unplanned(here, job.quality.epsilon());
    (entry.cost.samples, entry.cost.rays) = (part.samples, part.rays);
    entry.images = stage.images.map(|_| FromImages::of(here, job));
    let film = stage.view.map(|view| Receivers::classify(stage.tracer, view, stage.camera, here, stage.offset));
    if part.needed == 0 {
        no_map_needed(&mut entry, part.facing, job);
        return Ok(Some(entry));
    }
    let in_light: Vec<_> = window::maps(held, frame, held.size).into_iter().map(|m| m.region).collect();
    let regions = in_frame(&in_light, &part.edges);
    let question = stage.question(here, job);
    let mut certified = match (stage.view, &film) {
        (Some(view), Some(film)) => {
            let mut judge = Judge::of_maps(stage.tracer, view, &question, maps, film, stage.offset);
            let at = |held: &Held, place: usize| at(held, place).unwrap_or_default();
            let certified = measured(&question, held, &mut judge, frame, light, &at)?;
            entry.cost.texels_drawn = judge.texels_drawn;
            entry.cost.triangles_drawn = judge.triangles_drawn;
            certified
        }
        _ => predicted(&question, held, &regions),
    };
    let Some(maps) = at(held, held.size) else { return Ok(None) };
    let texels = held.grid.texels(held.size);
    certified.predicted = predict(&regions, &held.fitted.shares, texels);
    let frame_fitted = crate::resolution::FittedLight { regions, ..held.fitted.clone() };
    certified.predicted_at_quantile = predicted_at_quantile(&question, &frame_fitted, texels);
    let answers = match (&film, stage.images) {
        (None, None) => stage.grid.answers(stage.tracer, stage.camera, here, stage.offset),
        _ => Vec::new(),
    };
    let receivers = film.as_ref().cloned().or_else(|| stage.images.map(|i| images::receivers(i, here)));
    let seen = seen(stage, &answers, receivers.as_ref());
    entry.maps = map_entries(&maps, &certified, job, here, stage, &seen);
    entry.status = if certified.met { Status::Planned } else { Status::NotMet };
    if !certified.met {
        entry.reason = Some(not_met_reason(job, &certified, stage.film));
    }
    entry.solver = Some(solver_report(job, &held.fitted));
    entry.cost.solver_evaluations = held.fitted.evaluations;
    entry.error = Some(light_error(job, &certified, stage, film.as_ref()));
    if timings {
        entry.cost.milliseconds = Some(start.elapsed().as_secs_f64() * 1e3);
    }
    Ok(Some(entry))
}

/// The measurement of a frame. The first one of a segment chooses bias and size; later ones may only let it grow.
fn measured(
    question: &FilmQuestion,
    held: &mut Held,
    judge: &mut Judge,
    frame: usize,
    light: &LightParts,
    maps_at: &dyn Fn(&Held, usize) -> Vec<JudgedMap>,
) -> Result<Certified, RasterError> {
    let grid = held.grid.clone();
    let bias = match held.bias {
        Some(bias) => bias,
        None => measured_bias(question, &held.fitted, judge, &grid)?.0,
    };
    let first = held.bias.replace(bias).is_none();
    let mut tried = held.tried.remove(&frame).unwrap_or_default();
    let mut probe = |held: &mut Held, judge: &mut Judge, place: usize| -> Result<Probe, RasterError> {
        let sizes = grid.sizes(place).to_vec();
        judge.maps = maps_at(held, place);
        let drawn = draw(held, judge, &sizes, bias, (frame, place), light)?;
        let wrong = judge.wrong(&drawn);
        let (probe, trial) = trial(question, judge, (&drawn, &wrong), sizes);
        held.drawn = (texels(&drawn) <= TEXELS_HELD).then_some((frame, place, drawn));
        tried.retain(|(p, _): &(usize, Trial)| *p != place);
        tried.push((place, trial));
        Ok(probe)
    };
    let (least, guess) = if first { (0, held.size) } else { (held.size, held.size) };
    let met = !first && probe(held, judge, held.size)?.meets;
    if !met {
        let found = smallest(grid.len() - least, guess - least, question.map.step, |k| probe(held, judge, least + k))?;
        held.missed |= found.is_none();
        let place = found.map_or(grid.len() - 1, |k| least + k);
        if first || place > held.size {
            (held.size, held.decided_by) = (place, Some(frame));
        }
        if held.decided_by.is_none() {
            held.decided_by = Some(frame);
        }
    }
    let chosen = tried.iter().find(|(place, _)| *place == held.size).map(|(_, t)| t.clone());
    let sizes = grid.sizes(held.size).to_vec();
    judge.maps = maps_at(held, held.size);
    let drawn = draw(held, judge, &sizes, bias, (frame, held.size), light)?;
    let wrong = judge.wrong(&drawn);
    held.drawn = (texels(&drawn) <= TEXELS_HELD).then_some((frame, held.size, drawn));
    let self_shadow = judge.self_shadowed(&sizes, bias, &wrong)?;
    let trials = tried.iter().map(|(_, t)| t.clone()).collect();
    held.tried.insert(frame, tried);
    Ok(Certified {
        met: chosen.as_ref().is_some_and(|t| t.meets),
        sizes,
        bias,
        predicted: crate::methods::Prediction::default(),
        predicted_at_quantile: None,
        chosen,
        self_shadow,
        tried: trials,
    })
}

fn texels(drawn: &[Drawn]) -> u64 {
    drawn.iter().map(|d| d.map.depth.len() as u64).sum()
}

/// The maps of a frame at a place on the grid: those drawn last, where they are the same.
fn draw(
    held: &mut Held,
    judge: &mut Judge,
    sizes: &[[u32; 2]],
    bias: Bias,
    (frame, place): (usize, usize),
    light: &LightParts,
) -> Result<Vec<Drawn>, RasterError> {
    match held.drawn.take() {
        Some((at, size, drawn)) if size == place && (at == frame || held.same_maps(at, frame, place, light)) => {
            Ok(drawn)
        }
        _ => judge.draw(sizes, bias),
    }
}

/// Without measurement: met where the prediction says so.
fn predicted(question: &FilmQuestion, held: &Held, regions: &[crate::methods::Region]) -> Certified {
    let needed = predicted_texels(question.quality, question.film, regions, &held.fitted.shares);
    Certified {
        met: held.grid.texels(held.size) >= needed,
        sizes: held.grid.sizes(held.size).to_vec(),
        bias: default_bias(&question.map.bias),
        predicted: crate::methods::Prediction::default(),
        predicted_at_quantile: None,
        chosen: None,
        self_shadow: 0,
        tried: Vec::new(),
    }
}
