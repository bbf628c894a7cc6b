//! Frames, points and repetitions, one after the other on all threads.

use super::price::{Price, Truth};
use super::summary::{Runs, summarise};
use super::sweep::Point;
use super::{Trade, TradeCase, TradeError};
use crate::job::{Job, LoadedJob, Preset};
use crate::measure::Receivers;
use crate::plan::{LightPlan, PlanError, Settled, Stage, Stages, Watch, in_scene_space, open, plan_light};
use crate::resolution::{Measure, QualityParams, texels};
use std::time::Instant;

/// What is timed, and how often.
#[derive(Clone, Debug, PartialEq)]
pub struct TradeParams {
    /// The points; those of [`super::points`], or some of them with the thorough preset among them.
    pub points: Vec<Point>,
    /// Times each point is run, at least 1.
    pub repeat: u32,
    /// Lights of each frame, from the first; `None` = all.
    pub lights: Option<usize>,
}

/// Times operating points on the frames and lights of a job and judges what they plan.
///
/// # Errors
/// [`TradeError::NoShadow`], [`TradeError::Job`] for a point that does not go with the job, and what stands in the way of
/// planning; [`PlanError::Cancelled`] soon after the watch asks to stop.
pub fn trade(loaded: &LoadedJob, params: &TradeParams, watch: &Watch) -> Result<Trade, TradeError> {
    let jobs = |points: &[Point]| -> Result<Vec<Job>, TradeError> {
        points.iter().map(|p| Ok(loaded.with(&p.settings)?.job)).collect()
    };
    let mut points = params.points.clone();
    if !points.iter().any(is_reference) {
        points.extend(super::points().into_iter().filter(is_reference));
    }
    let jobs = jobs(&points)?;
    let reference = points.iter().position(is_reference).unwrap_or(0);
    let repeat = params.repeat.max(1);
    let mut runs = Runs::new(points.len());
    let pixels = open(loaded, watch, |stages, _| {
        let jobs: Vec<Job> = jobs.iter().map(|job| in_scene_space(job, stages.shot)).collect();
        let total = (stages.len() * points.len()) as u64 * u64::from(repeat);
        let mut done = 0;
        for frame in 0..stages.len() {
            let step = || {
                watch.step(Stage::Points, done, total)?;
                done += 1;
                Ok(())
            };
            one_frame(
                stages,
                frame,
                &Sweep { jobs: &jobs, reference, repeat, lights: params.lights },
                &mut runs,
                step,
            )?;
        }
        Ok(stages.shot.film.pixels() as u64)
    })?;
    if runs.cases.is_empty() {
        return Err(TradeError::NoShadow);
    }
    let threads = rayon::current_num_threads();
    let least = u64::from(loaded.job.map.min).pow(2);
    Ok(summarise(points, runs, (pixels, loaded.job.quality.epsilon()), (threads, repeat), least))
}

/// The point that excess is measured from.
fn is_reference(point: &Point) -> bool {
    point.preset == Some(Preset::Thorough)
}

/// What is run on each frame.
struct Sweep<'a> {
    jobs: &'a [Job],
    reference: usize,
    repeat: u32,
    lights: Option<usize>,
}

/// All points on the lights of a frame.
fn one_frame(
    stages: &Stages,
    frame: usize,
    sweep: &Sweep,
    runs: &mut Runs,
    mut step: impl FnMut() -> Result<(), PlanError>,
) -> Result<(), PlanError> {
    let quality = QualityParams { measure: Measure::Always, ..stages.job.quality.clone() };
    let film_job = Job { quality, ..stages.job.clone() };
    stages.with_job(&film_job).film(frame, |stage, scene| {
        let Some(view) = stage.view else { return Ok(()) };
        let truths: Vec<Truth> = scene
            .lights
            .iter()
            .enumerate()
            .take(sweep.lights.unwrap_or(usize::MAX))
            .map(|(index, light)| {
                let receivers = Receivers::classify(stage.tracer, view, stage.camera, light, stage.offset);
                Truth { stage, view, index, light, receivers, job: stages.job }
            })
            .filter(Truth::needs_a_map)
            .collect();
        if truths.is_empty() {
            return Ok(());
        }
        let wanted = |light: usize| truths.iter().any(|t| t.index == light);
        // The reference comes first: it says how many texels are equal ones. It also wakes caches and threads.
        let thorough = timed(&stages.with_job(&sweep.jobs[sweep.reference]), frame, wanted)?;
        let mut equal = Vec::with_capacity(truths.len());
        for (truth, run) in truths.iter().zip(&thorough) {
            let texels = run.settled.as_ref().map_or(0, |s| texels(&s.certified.sizes));
            runs.cases.push(TradeCase {
                frame: stages.time(frame).frame,
                light: truth.light.name.clone(),
                facing: truth.receivers.len() as u64,
                thorough_texels: texels,
                thorough_met: run.entry.met(),
            });
            equal.push(texels as f64);
        }
        drop(thorough);
        // Points take turns, so that what else the machine does falls on all of them.
        for round in 0..sweep.repeat {
            for (k, job) in sweep.jobs.iter().enumerate() {
                step()?;
                let planned = timed(&stages.with_job(job), frame, wanted)?;
                for (i, run) in planned.iter().enumerate() {
                    let judged = if round > 0 { None } else { Some(judge(&truths[i], run, job, equal[i])?) };
                    runs.add(k, (runs.cases.len() - truths.len()) + i, run.seconds, judged);
                }
            }
        }
        Ok(())
    })
}

/// Price of a plan, and its wrong pixels with the thorough plan's texels.
fn judge(truth: &Truth, run: &Run, job: &Job, texels: f64) -> Result<(Price, u64), PlanError> {
    let settled = run.settled.as_ref();
    Ok((truth.price(&run.entry, settled, job)?, truth.wrong_at(settled, texels)?))
}

/// A light, planned against the clock.
pub(super) struct Run {
    /// Place in the frame's list of lights.
    pub(super) light: usize,
    /// Its own time, and its share of setting up the frame.
    pub(super) seconds: f64,
    pub(super) entry: LightPlan,
    pub(super) settled: Option<Settled>,
}

/// Plans the lights of a frame at the places wanted, each by itself, and times that.
pub(super) fn timed(stages: &Stages, frame: usize, wanted: impl Fn(usize) -> bool) -> Result<Vec<Run>, PlanError> {
    let start = Instant::now();
    stages.with(frame, |stage, scene| {
        let setting_up = start.elapsed().as_secs_f64();
        let places: Vec<usize> = (0..scene.lights.len()).filter(|i| wanted(*i)).collect();
        let share = setting_up / places.len().max(1) as f64;
        let one = |light: usize| {
            let start = Instant::now();
            let (entry, settled) = plan_light(stage, &scene.lights[light], stages.job, None)?;
            Ok(Run { light, seconds: share + start.elapsed().as_secs_f64(), entry, settled })
        };
        places.into_iter().map(one).collect()
    })
}
