//! From the parts of a light to segments with a matrix, a bias and a size, each decided on one frame.

use super::super::pieces::{Answer, FrameLight};
use super::super::stage::{FrameStage, Stages};
use super::super::{PlanError, Watch};
use super::held::Held;
use super::measure::SegmentFrame;
use super::{auto, row, window};
use crate::job::Job;
use crate::measure::Receivers;
use crate::methods::Method;
use crate::resolution::{
    AspectRule, Drawing, FilmQuestion, Judge, MapParams, Turn, default_bias, polish, size_on_grid,
};
use crate::scene::Light;
use crate::shot::{Asked, Hold, LightParts, Segmentation, Temporal, carry, interval_samples, segments};

/// Cuts of a shot at most: the first by prediction, the others with costs corrected by measurement.
const CUTS: u32 = 3;
/// Measured over predicted texels, or its inverse, from which a cut is made again. Predictions scale all intervals of a
/// light alike; a factor below this moves no border by much.
const STRONG: f64 = 1.5;

/// A segment, and what the frame that decided it was found to need.
pub(in crate::plan) struct Decided {
    pub(in crate::plan) held: Held,
    pub(in crate::plan) frame: usize,
    /// Absent when the light is not on in that frame after all.
    pub(in crate::plan) answer: Option<Answer>,
    /// The error there over what the bound allows.
    pub(super) error: f64,
}

/// The segments of one light, in order. The inner error is the reason why it has none.
pub(in crate::plan) fn decided(
    stages: &Stages,
    light: &LightParts,
    timings: bool,
    watch: &Watch,
) -> Result<Result<Vec<Decided>, String>, PlanError> {
    match stages.job.solver.method {
        Method::Auto => auto::by_ladder(stages, light, timings, watch),
        _ => by_method(stages, light, timings, watch),
    }
}

/// The job's maps as segments have them: one size means one aspect for all segments.
pub(super) fn asked_map(job: &Job) -> MapParams {
    let mut map = job.map.clone();
    if job.shot.one_size {
        map.aspect = AspectRule::Fixed;
    }
    map
}

/// The segments by the job's own method.
pub(super) fn by_method(
    stages: &Stages,
    light: &LightParts,
    timings: bool,
    watch: &Watch,
) -> Result<Result<Vec<Decided>, String>, PlanError> {
    let job = stages.job;
    let map = asked_map(job);
    let asked = Asked { film: stages.shot.film, quality: &job.quality, map: &map, solver: &job.solver };
    let mut params = job.shot.clone();
    if params.temporal == Temporal::Snapped {
        params.hold = Some(Hold::Shot);
    }
    let mut correction = 1.0;
    let mut done: Vec<Decided> = Vec::new();
    for cut in 0..CUTS {
        watch.check()?;
        let segmentation = match segments(&asked, light, &params, correction) {
            Ok(segmentation) => segmentation,
            Err(reason) => return Ok(Err(reason.to_string())),
        };
        let (kept, fresh) = sort(done, segmentation, &asked);
        done = kept;
        if fresh.is_empty() {
            break;
        }
        for held in fresh {
            watch.check()?;
            match decide(stages, light, held, &asked, timings)? {
                Ok(decided) => done.push(decided),
                Err(reason) => return Ok(Err(reason)),
            }
        }
        let next = measured_over_predicted(&done);
        let strong = (next / correction).max(correction / next) > STRONG;
        if cut + 1 == CUTS || !(strong && params.hold.is_none()) {
            break;
        }
        correction = next;
    }
    done.sort_by_key(|decided| decided.held.segment.frames.start);
    Ok(Ok(done))
}

/// Of the segments of a new cut, those decided before and those that are new.
fn sort(done: Vec<Decided>, cut: Segmentation, asked: &Asked) -> (Vec<Decided>, Vec<Held>) {
    let mut done: Vec<Option<Decided>> = done.into_iter().map(Some).collect();
    let (mut kept, mut fresh) = (Vec::new(), Vec::new());
    for segment in cut.segments {
        let same = |d: &Option<Decided>| d.as_ref().is_some_and(|d| d.held.segment.needing == segment.needing);
        match done.iter_mut().find(|d| same(d)).and_then(Option::take) {
            Some(mut decided) => {
                decided.held.segment.frames = segment.frames;
                kept.push(decided);
            }
            None => fresh.push(Held::new(segment, asked)),
        }
    }
    (kept, fresh)
}

/// The geometric mean over segments of measured over predicted texels.
fn measured_over_predicted(done: &[Decided]) -> f64 {
    let logs: Vec<f64> = done.iter().map(|d| d.held.measured_over_predicted().ln()).collect();
    (logs.iter().sum::<f64>() / logs.len().max(1) as f64).exp()
}

/// Settles matrix, depth row, bias and size of a segment on the frame that is predicted to need most.
pub(super) fn decide(
    stages: &Stages,
    light: &LightParts,
    mut held: Held,
    asked: &Asked,
    timings: bool,
) -> Result<Result<Decided, String>, PlanError> {
    let motion = |frame: usize| carry(&light.poses[frame], &light.poses[0]);
    let moves = |m: crate::math::RigidMotion| held.fitted.regions.iter().all(|r| r.carried(&m).is_some());
    if !held.segment.needing.iter().filter_map(|f| motion(*f)).all(moves) {
        return Ok(Err("the domain of one of its maps does not move with the light".to_owned()));
    }
    if stages.job.shot.temporal == Temporal::Snapped
        && let Err(reason) = window::open(&mut held, light, asked)
    {
        return Ok(Err(reason));
    }
    let frame = held.predicted_decider();
    let found = stages.film(frame, |stage, scene| {
        let Some(here) = scene.lights.iter().find(|l| l.name == light.light.name) else { return Ok(Ok(None)) };
        let film = stage.view.map(|view| Receivers::classify(stage.tracer, view, stage.camera, here, stage.offset));
        let still = light.poses[frame] == light.poses[0];
        if let (Some(film), true, true) = (&film, still, held.windows.is_empty()) {
            polished((stage, here), light, &mut held, film, (asked, stages))?;
        }
        if let Err(reason) = row::find(light, &mut held) {
            return Ok(Err(reason));
        }
        let part = &light.parts[frame];
        let state = FrameLight { motion: motion(frame), ..FrameLight::new(here.clone()) };
        let at =
            SegmentFrame { stage, job: stages.job, frame, here, state: &state, part, film: film.as_ref(), timings };
        Ok(Ok(Some(at.enter(&held, None)?)))
    })?;
    let entered = match found {
        Ok(entered) => entered,
        Err(reason) => return Ok(Err(reason)),
    };
    if let Some(entered) = &entered {
        held.bias = entered.bias;
        held.size = entered.answer.place;
        held.missed = entered.answer.missed;
        held.decided_by = entered.bias.map(|_| frame);
    }
    let error = entered.as_ref().map_or(0.0, |e| e.error);
    Ok(Ok(Decided { held, frame, answer: entered.map(|e| e.answer), error }))
}

/// Better matrices near a segment's, by measurement on the frame that decides it. A light that moves stays with its own.
fn polished(
    (stage, here): (&FrameStage, &Light),
    light: &LightParts,
    held: &mut Held,
    film: &Receivers,
    (asked, stages): (&Asked, &Stages),
) -> Result<(), PlanError> {
    let Some(on) = stage.on_film(film) else { return Ok(()) };
    if stages.job.solver.measured_rounds == 0 {
        return Ok(());
    }
    let parts: Vec<_> = held.segment.needing.iter().map(|f| &light.parts[*f]).collect();
    let mut samples = interval_samples(&parts);
    samples.covered.clone_from(&held.fitted.covered);
    let question = FilmQuestion { map: asked.map, ..stage.question(here, stages.job) };
    if let Ok(mut judge) = Judge::new(on, &question, &held.fitted) {
        let size = |aspect: f64, texels: f64| size_on_grid(asked.map, aspect, texels);
        let drawing = Drawing { size: &size, bias: default_bias(&asked.map.bias) };
        polish(&question, &samples, &mut held.fitted, &mut judge, &drawing, Turn::ONLY)?;
    }
    held.refit(asked);
    Ok(())
}
