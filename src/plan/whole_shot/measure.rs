//! One frame of a segment, measured: at the segment's size, or at the smallest larger one at which the frame is met.
//!
//! Nothing here hangs on other frames but the segment itself, so that frames may be measured anywhere and in any order.

use super::super::light_entry::{light_error, map_entries, not_met_reason, seen, solver_report};
use super::super::pieces::{Answer, FrameLight};
use super::super::stage::FrameStage;
use super::super::{LightPlan, PlanError, SolverReport, Status};
use super::held::Held;
use crate::job::Job;
use crate::measure::{Drawn, Receivers};
use crate::methods::{Prediction, Region};
use crate::raster::{Bias, RasterError};
use crate::resolution::{
    Certified, FilmQuestion, FittedLight, Judge, JudgedMap, Probe, Sampled, Spent, Trial, measured_bias, predict,
    predicted_at_quantile, predicted_texels, smallest, trial,
};
use crate::scene::Light;
use crate::shot::{Content, LightPart, in_frame};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Instant;

/// Maps as drawn.
#[derive(Clone, Debug)]
pub(in crate::plan) struct Ready {
    pub(in crate::plan) drawn: Arc<Vec<Drawn>>,
    /// What drawing them took: what is reused costs a plan as much as what is drawn, so that it says the same wherever its
    /// frames were measured.
    pub(in crate::plan) spent: Spent,
}

/// A frame of a segment.
pub(in crate::plan) struct SegmentFrame<'a> {
    pub(in crate::plan) stage: &'a FrameStage<'a>,
    pub(in crate::plan) job: &'a Job,
    /// Place of the frame in the shot.
    pub(in crate::plan) frame: usize,
    /// The light, as it stands here.
    pub(in crate::plan) here: &'a Light,
    pub(in crate::plan) state: &'a FrameLight,
    pub(in crate::plan) part: &'a LightPart,
    /// Absent when nothing is measured.
    pub(in crate::plan) film: Option<&'a Receivers>,
    pub(in crate::plan) timings: bool,
}

/// What a frame of a segment was found to need.
pub(in crate::plan) struct Entered {
    pub(in crate::plan) answer: Answer,
    /// The bias it was measured with.
    pub(in crate::plan) bias: Option<Bias>,
    /// The error over what the bound allows.
    pub(in crate::plan) error: f64,
    /// Its maps at the place of the answer.
    pub(in crate::plan) ready: Option<Ready>,
}

impl SegmentFrame<'_> {
    /// Measures the frame. Where the segment has no bias yet this frame decides bias and size; else it may only ask for
    /// more. `ready` are its maps at the segment's size, where they are drawn already.
    pub(in crate::plan) fn enter(&self, held: &Held, ready: Option<Ready>) -> Result<Entered, PlanError> {
        let start = Instant::now();
        let SegmentFrame { stage, job, frame, here, part, film, .. } = *self;
        let motion = self.state.motion.as_ref();
        // That the domains move with the light was found out when the segment was decided.
        let at = |place: usize| held.maps_at(frame, place, motion).unwrap_or_default();
        let mut entry = LightPlan::unplanned(here, job.quality.epsilon());
        (entry.cost.samples, entry.cost.rays) = (part.samples, part.rays);
        let in_light: Vec<Region> = super::window::maps(held, frame, held.size).into_iter().map(|m| m.region).collect();
        let regions = in_frame(&in_light, &part.edges);
        let question = stage.question(here, job);
        let answers = match film {
            Some(_) => Vec::new(),
            None => stage.grid.answers(stage.tracer, stage.camera, here, stage.offset),
        };
        let seen = seen(stage, &answers, film);
        let before = self.state.answer.as_ref().map(|a| a.tried.clone()).unwrap_or_default();
        let mut found = match film.and_then(|film| stage.on_film(film)) {
            Some(on) => {
                let mut judge = Judge::of_maps(on, &question, at(held.size));
                let mut trials = Trials { question: &question, held, maps_at: &at, ready, tried: before, last: None };
                trials.measured(&mut judge)?
            }
            None => predicted(&question, held, &regions, stage.sampled(&question, &seen).as_ref(), &at),
        };
        entry.cost.texels_drawn = found.spent.texels_drawn;
        entry.cost.triangles_drawn = found.spent.triangles_drawn;
        entry.cost.rays += found.spent.rays;
        let texels = held.grid.texels(found.place);
        let certified = &mut found.certified;
        certified.predicted = predict(&regions, &held.fitted.shares, texels);
        let frame_fitted = FittedLight { regions, ..held.fitted.clone() };
        certified.predicted_at_quantile = predicted_at_quantile(&question, &frame_fitted, texels);
        let error = certified.error_over_bound(&question);
        let maps = at(found.place);
        entry.maps = map_entries((&maps, held.fitted.method), certified, here, stage, &seen);
        entry.status = if certified.met { Status::Planned } else { Status::NotMet };
        if !certified.met {
            entry.reason = Some(not_met_reason(job, certified, stage.film));
        }
        entry.solver = Some(SolverReport { choice: held.choice.clone(), ..solver_report(job, &held.fitted) });
        entry.cost.solver_evaluations = held.fitted.evaluations;
        entry.error = Some(light_error(job, certified, stage, film));
        if self.timings {
            entry.cost.milliseconds = Some(start.elapsed().as_secs_f64() * 1e3);
        }
        let content = self.content(held);
        let Found { place, tried, missed, bias, ready, .. } = found;
        Ok(Entered { answer: Answer { entry, place, tried, missed, content }, bias, error, ready })
    }

    /// What moves in the segment's maps here.
    pub(in crate::plan) fn content(&self, held: &Held) -> Content {
        let carried = |r: &Region| self.state.motion.as_ref().map_or_else(|| Some(r.clone()), |m| r.carried(m));
        let regions: Option<Vec<Region>> = held.fitted.regions.iter().map(carried).collect();
        Content::in_maps(self.stage.tracer.geometry(), &regions.unwrap_or_default())
    }
}

/// A frame's size, found.
struct Found {
    certified: Certified,
    place: usize,
    tried: Vec<(usize, Trial)>,
    missed: bool,
    bias: Option<Bias>,
    ready: Option<Ready>,
    spent: Spent,
}

/// The sizes tried in a frame.
struct Trials<'a> {
    question: &'a FilmQuestion<'a>,
    held: &'a Held,
    maps_at: &'a dyn Fn(usize) -> Vec<JudgedMap>,
    /// The maps at the segment's size.
    ready: Option<Ready>,
    /// With their places on the grid.
    tried: Vec<(usize, Trial)>,
    /// What was drawn last.
    last: Option<(usize, Ready)>,
}

impl Trials<'_> {
    fn measured(&mut self, judge: &mut Judge) -> Result<Found, RasterError> {
        let (held, grid, step) = (self.held, &self.held.grid, self.question.map.step);
        let decides = held.bias.is_none();
        let bias = match held.bias {
            Some(bias) => bias,
            None => measured_bias(self.question, &held.fitted, judge, grid)?.0,
        };
        let least = if decides { 0 } else { held.size };
        let mut probes: BTreeMap<usize, Probe> = BTreeMap::new();
        let mut probe = |place: usize| -> Result<Probe, RasterError> {
            if let Some(known) = probes.get(&place) {
                return Ok(*known);
            }
            let found = self.probe(judge, place, bias)?;
            probes.insert(place, found);
            Ok(found)
        };
        let found = if !decides && probe(held.size)?.meets {
            Some(0)
        } else {
            smallest(grid.len() - least, held.size - least, step, |k| probe(least + k))?
        };
        let place = found.map_or(grid.len() - 1, |k| least + k);
        let ready = self.draw(judge, place, bias)?;
        let wrong = judge.wrong(&ready.drawn);
        let sizes = grid.sizes(place).to_vec();
        let self_shadow = judge.self_shadowed(&sizes, bias, &wrong)?;
        let chosen = self.tried.iter().find(|(at, _)| *at == place).map(|(_, t)| t.clone());
        let certified = Certified {
            met: chosen.as_ref().is_some_and(|t| t.meets),
            sizes,
            bias,
            predicted: Prediction::default(),
            predicted_at_quantile: None,
            sampled: None,
            chosen,
            self_shadow,
            tried: self.tried.iter().map(|(_, t)| t.clone()).collect(),
        };
        let tried = std::mem::take(&mut self.tried);
        let (missed, spent) = (found.is_none(), judge.spent);
        Ok(Found { certified, place, tried, missed, bias: Some(bias), ready: Some(ready), spent })
    }

    fn probe(&mut self, judge: &mut Judge, place: usize, bias: Bias) -> Result<Probe, RasterError> {
        let ready = self.draw(judge, place, bias)?;
        let wrong = judge.wrong(&ready.drawn);
        let sizes = self.held.grid.sizes(place).to_vec();
        let (probe, trial) = trial(self.question, judge, (&ready.drawn, &wrong), sizes);
        self.last = Some((place, ready));
        self.tried.retain(|(at, _)| *at != place);
        self.tried.push((place, trial));
        Ok(probe)
    }

    /// The maps at a place; drawn unless they are those drawn last or were handed over.
    fn draw(&mut self, judge: &mut Judge, place: usize, bias: Bias) -> Result<Ready, RasterError> {
        judge.maps = (self.maps_at)(place);
        if let Some((_, ready)) = self.last.take_if(|(at, _)| *at == place) {
            return Ok(ready);
        }
        if place == self.held.size
            && let Some(ready) = self.ready.take()
        {
            judge.spent += ready.spent;
            return Ok(ready);
        }
        let before = judge.spent;
        let drawn = judge.draw(self.held.grid.sizes(place), bias)?;
        Ok(Ready { drawn: Arc::new(drawn), spent: judge.spent - before })
    }
}

/// Without measurement: met where the prediction says so, and where lookups do.
fn predicted(
    question: &FilmQuestion,
    held: &Held,
    regions: &[Region],
    sampled: Option<&Sampled>,
    maps_at: &dyn Fn(usize) -> Vec<JudgedMap>,
) -> Found {
    let grid = &held.grid;
    let needed = predicted_texels(question.quality, question.film, regions, &held.fitted.shares);
    let from = (held.size, held.size);
    let settled = sampled.map(|sampled| sampled.settle(|place| Cow::from(maps_at(place)), grid, from, held.bias));
    let (place, certified) = Certified::undrawn(question, grid, (held.size, needed), settled);
    let missed = settled.is_some_and(|s| !s.met);
    let spent = Spent { rays: settled.map_or(0, |s| s.rays), ..Spent::default() };
    Found { certified, place, tried: Vec::new(), missed, bias: settled.map(|s| s.bias), ready: None, spent }
}
