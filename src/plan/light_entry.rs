//! One light of one frame: from rays to an entry of the plan.

use super::light_maps::Wanted;
use super::map_entry::{Chosen, map_entry};
use super::seen::{Seen, seen_by, seen_on_film};
use super::stage::{FrameStage, Lit, measures};
use super::{FromImages, LightError, LightPlan, MapPlan, Measured, PlanError, Predicted, SolverReport, Status, Tried};
use crate::job::Job;
use crate::math::first_holding;
use crate::measure::{Outside, Receivers};
use crate::methods::Method;
use crate::resolution::{Bound, Certified, FittedLight, JudgedMap, Planned};
use crate::scene::{Film, Light, VisibilitySource};
use crate::visibility::{Answer, EDGE_ON_DEGREES};
use std::time::Instant;

/// Plans one light. `timings` adds wall time; `given` are the regions to measure, where they are not to be fitted here.
pub(super) fn light_entry(
    stage: &FrameStage,
    light: &Light,
    job: &Job,
    timings: bool,
    given: Option<&FittedLight>,
) -> Result<LightPlan, PlanError> {
    let start = Instant::now();
    let (mut entry, _) = plan_light(stage, light, job, given)?;
    if timings {
        entry.cost.milliseconds = Some(start.elapsed().as_secs_f64() * 1e3);
    }
    Ok(entry)
}

/// What the entry of a light with maps was written from.
pub(crate) struct Settled {
    /// Matrices and depth rows.
    pub(crate) maps: Vec<JudgedMap>,
    /// The regions, and how the maps share texels.
    pub(crate) fitted: FittedLight,
    /// Size and bias.
    pub(crate) certified: Certified,
}

/// Plans one light: its entry, and what it was written from where it has maps.
pub(crate) fn plan_light(
    stage: &FrameStage,
    light: &Light,
    job: &Job,
    given: Option<&FittedLight>,
) -> Result<(LightPlan, Option<Settled>), PlanError> {
    let mut entry = LightPlan::unplanned(light, job.quality.epsilon());
    entry.images = stage.images.map(|_| FromImages::of(light, job));
    let lit = stage.look(light, job);
    entry.cost.samples = lit.samples.edges.len() as u64;
    entry.cost.rays = stage.rays_share + lit.rays;
    let settled = settle(stage, light, job, &lit, &mut entry, given)?;
    Ok((entry, settled))
}

/// Decides the status and, where maps are needed, plans them.
fn settle(
    stage: &FrameStage,
    light: &Light,
    job: &Job,
    lit: &Lit,
    entry: &mut LightPlan,
    given: Option<&FittedLight>,
) -> Result<Option<Settled>, PlanError> {
    let (samples, film, answers) = (&lit.samples, lit.film.as_ref(), &lit.answers);
    let (facing, shadowed) = match film {
        Some(film) => (film.len() as u64, film.shadowed_count()),
        None => (samples.facing, samples.shadowed),
    };
    let needed = if job.map.outside == Outside::Lit { shadowed } else { facing - shadowed };
    if needed == 0 {
        no_map_needed(entry, facing, job);
        return Ok(None);
    }
    let seen = seen(stage, answers, film);
    let (found, choice) = Wanted { stage, light, job, lit, seen: &seen }.find(given)?;
    let Planned { maps, fitted, certified, spent } = match found {
        Ok(found) => found,
        Err(reason) => {
            (entry.status, entry.reason) = (Status::Inapplicable, Some(reason));
            return Ok(None);
        }
    };
    entry.cost.texels_drawn = spent.texels_drawn;
    entry.cost.triangles_drawn = spent.triangles_drawn;
    entry.cost.solver_evaluations = spent.evaluations;
    entry.cost.rays += spent.rays;
    entry.maps = map_entries((&maps, fitted.method), &certified, light, stage, &seen);
    entry.status = if certified.met { Status::Planned } else { Status::NotMet };
    if !certified.met {
        entry.reason = Some(not_met_reason(job, &certified, stage.film));
    }
    entry.solver = Some(SolverReport { choice, ..solver_report(job, &fitted) });
    entry.error = Some(light_error(job, &certified, stage, film));
    Ok(Some(Settled { maps, fitted, certified }))
}

/// The entries of a light's maps, which are of a method.
pub(super) fn map_entries(
    (maps, method): (&[JudgedMap], Method),
    certified: &Certified,
    light: &Light,
    stage: &FrameStage,
    seen: &[Seen],
) -> Vec<MapPlan> {
    let tracer = if stage.images.is_some() { None } else { Some(stage.tracer) };
    let answering = |point| first_holding(maps.iter().map(|m| &m.region.domain), point);
    (0..maps.len())
        .map(|k| {
            let answers = |point| answering(point) == Some(k);
            let chosen = Chosen { method, size: certified.sizes[k], bias: certified.bias };
            map_entry(&maps[k], &chosen, light, tracer, seen, answers)
        })
        .collect()
}

/// Status and reason of a light that no map has to be looked up for.
pub(super) fn no_map_needed(entry: &mut LightPlan, facing: u64, job: &Job) {
    let at = match (job.visibility.source, measures(job)) {
        (VisibilitySource::Aov, _) => "no pixel of the images",
        (_, true) => "no pixel",
        (_, false) => "no position of the planning grid",
    };
    (entry.status, entry.reason) = if facing == 0 {
        (Status::Unlit, Some(format!("{at} faces the light within its reach")))
    } else {
        let differs = if job.map.outside == Outside::Lit { "in shadow" } else { "lit" };
        (Status::NoVisibleShadow, Some(format!("{at} that faces the light is {differs}")))
    };
}

pub(super) fn not_met_reason(job: &Job, certified: &Certified, film: Film) -> String {
    let largest = certified.sizes.iter().map(|[w, h]| format!("{w}x{h}")).collect::<Vec<_>>().join(" + ");
    match &certified.chosen {
        Some(trial) if job.quality.bound == Bound::Misclassified => format!(
            "at the largest size within map.max = {}, {largest}, {} certain and {} uncertain of {} pixels are wrong, \
             of them {} by depth bias: raise map.max or epsilon",
            job.map.max,
            trial.verdict.certain.wrong(),
            trial.verdict.uncertain,
            film.pixels(),
            certified.self_shadow
        ),
        Some(trial) => format!(
            "at the largest size within map.max = {}, {largest}, the bound is at {:.3} pixels: raise map.max or epsilon",
            job.map.max,
            trial.at_quantile.unwrap_or(f64::INFINITY)
        ),
        None if let Some(sampled) = certified.sampled => format!(
            "at the largest size within map.max = {}, {largest}, a sample of lookups expects {:.0} certain and {:.0} uncertain \
             of {} pixels to be wrong: raise map.max or epsilon",
            job.map.max,
            sampled[0],
            sampled[1],
            film.pixels(),
        ),
        None => format!("the prediction needs more than map.max = {} allows: raise map.max or epsilon", job.map.max),
    }
}

pub(super) fn solver_report(job: &Job, fitted: &FittedLight) -> SolverReport {
    let reports = || fitted.regions.iter().map(|r| r.report);
    let worst = reports().fold(None, |w: Option<crate::methods::Report>, r| match w {
        Some(w) if w.spread >= r.spread => Some(w),
        _ => Some(r),
    });
    SolverReport {
        tolerance: job.solver.tolerance,
        spread: reports().map(|r| r.spread).fold(0.0, f64::max),
        gap: reports().filter_map(|r| r.gap).reduce(f64::max),
        evaluations: fitted.evaluations,
        rounds: reports().map(|r| u64::from(r.rounds)).max().unwrap_or(0),
        grazing: reports().map(|r| r.grazing).sum(),
        joined: fitted.joined,
        choice: None,
        termination: worst.map_or(crate::fit::Termination::Direct, |r| r.termination),
    }
}

pub(super) fn light_error(
    job: &Job,
    certified: &Certified,
    stage: &FrameStage,
    film: Option<&Receivers>,
) -> LightError {
    let of_quantile = |bound: Bound, value: Option<f64>| if job.quality.bound == bound { value } else { None };
    let measured = certified.chosen.as_ref().filter(|_| film.is_some()).map(|trial| {
        let verdict = trial.verdict;
        let all = verdict.certain.wrong() + verdict.uncertain;
        Measured {
            misclassified: verdict.certain.wrong(),
            of_pixels: stage.film.pixels() as u64,
            false_lit: verdict.certain.false_lit,
            false_shadow: verdict.certain.false_shadow,
            uncertain: verdict.uncertain,
            edge: all - certified.self_shadow,
            self_shadow: certified.self_shadow,
            ray_offset_m: stage.offset.metres,
            larger_ray_offset_m: stage.offset.uncertain().metres,
            edge_on_degrees: EDGE_ON_DEGREES,
            displacement: of_quantile(Bound::Displacement, trial.at_quantile),
            footprint: of_quantile(Bound::Footprint, trial.at_quantile),
        }
    });
    LightError {
        predicted: Some(Predicted {
            misclassified: certified.predicted.misclassified,
            uncertain: certified.predicted.uncertain,
            unsaturated: certified.predicted.unsaturated,
            sampled: certified.sampled,
            displacement: of_quantile(Bound::Displacement, certified.predicted_at_quantile),
            footprint: of_quantile(Bound::Footprint, certified.predicted_at_quantile),
        }),
        measured,
        tried: certified
            .tried
            .iter()
            .map(|trial| Tried {
                width: trial.sizes[0][0],
                height: trial.sizes[0][1],
                texels: None,
                misclassified: trial.verdict.certain.wrong(),
                uncertain: trial.verdict.uncertain,
                displacement: of_quantile(Bound::Displacement, trial.at_quantile),
                footprint: of_quantile(Bound::Footprint, trial.at_quantile),
            })
            .collect(),
        met: certified.met,
    }
}

/// Visible points of the light, evenly thinned: of the film where it was classified, else of the grid.
pub(super) fn seen(stage: &FrameStage, answers: &[Answer], film: Option<&Receivers>) -> Vec<Seen> {
    if let (Some(images), Some(film)) = (stage.images, film) {
        return seen_by(film, |pixel| images.film.surface(pixel));
    }
    match (film, stage.view) {
        (Some(film), Some(view)) => seen_on_film(stage.tracer, view, stage.camera, film),
        _ => (0..answers.len())
            .filter(|i| answers[*i] != Answer::Unlit)
            .filter_map(|i| {
                let surface = stage.grid.surface(stage.tracer, stage.camera, i)?;
                let shadowed = answers[i] == Answer::Shadowed;
                Some(Seen { position: surface.position, normal: surface.normal, shadowed })
            })
            .collect(),
    }
}
