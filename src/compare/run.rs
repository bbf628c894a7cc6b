//! Frames and lights of a comparison.

use super::entry::{Case, Mask, entry};
use super::files::write_file;
use super::picture::{self, Column};
use super::{CaseLight, CompareParams, Comparison, MethodRows, PerLight, Question, budget, workers};
use crate::job::{Job, LoadedJob};
use crate::math::Bounds;
use crate::measure::{Outside, Receivers};
use crate::plan::{PlanError, Stage, Watch, load_shot};
use crate::samples::{Grid, GridView, LightView, sample_light};
use crate::scene::{Camera, Film, Light};
use crate::visibility::{Bvh, RayOffset, Tracer, View, classify, see};
use std::borrow::Cow;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// What a frame gives to its lights.
struct FrameStage<'a> {
    tracer: &'a Tracer<'a>,
    camera: &'a Camera,
    film: Film,
    grid: &'a GridView<'a>,
    view: &'a View,
    bounds: Bounds,
    offset: RayOffset,
    frame: i64,
}

/// Compares methods on the frames and lights of a job.
///
/// # Errors
/// [`PlanError::Cancelled`] soon after the watch asks to stop; else what stands in the way.
pub fn compare(loaded: &LoadedJob, params: &CompareParams, watch: &Watch) -> Result<Comparison, PlanError> {
    let job = &loaded.job;
    watch.step(Stage::Load, 0, 1)?;
    let shot = load_shot(loaded)?;
    for note in &shot.scene.notes {
        watch.note(note);
    }
    let still = Bvh::still(&shot.scene);
    watch.step(Stage::Load, 1, 1)?;

    let done = AtomicU64::new(0);
    let mut cases: Vec<(CaseLight, Vec<PerLight>)> = Vec::new();
    for time in &shot.frames {
        let frame = shot.scene.frame(time.time_s)?;
        let geometry = shot.scene.geometry(&frame);
        let moving = Bvh::moving(&shot.scene, &frame);
        let tracer = Tracer::new(geometry, &still, moving.as_ref());
        let view = see(&tracer, &frame.camera, shot.film);
        let stage = FrameStage {
            tracer: &tracer,
            camera: &frame.camera,
            film: shot.film,
            grid: &GridView::see(&tracer, &frame.camera, Grid::new(shot.film, job.sampling.grid), Some(&view)),
            view: &view,
            bounds: tracer.bounds().map_or(Bounds::EMPTY, |[min, max]| Bounds { min, max }),
            offset: RayOffset::for_scene(&tracer),
            frame: time.frame,
        };
        let total = (shot.frames.len() * frame.lights.len()) as u64;
        watch.step(Stage::Lights, done.load(Ordering::Relaxed), total)?;
        cases.extend(workers::each(frame.lights.len(), |i| {
            watch.check()?;
            let case = light(&stage, i, &frame.lights[i], job, params, watch)?;
            watch.step(Stage::Lights, done.fetch_add(1, Ordering::Relaxed) + 1, total)?;
            Ok::<_, PlanError>(case)
        })?);
    }
    Ok(gather(cases, params, shot.film, job))
}

/// All methods on one light.
fn light(
    stage: &FrameStage,
    number: usize,
    light: &Light,
    job: &Job,
    params: &CompareParams,
    watch: &Watch,
) -> Result<(CaseLight, Vec<PerLight>), PlanError> {
    let start = Instant::now();
    let outside_lit = job.map.outside == Outside::Lit;
    let classified = classify(stage.tracer, stage.view, stage.camera, light, stage.offset);
    let receivers = Receivers::new(stage.view, stage.camera, &classified);
    let wanted = receivers.positions_where(outside_lit);
    let mut case = CaseLight {
        frame: stage.frame,
        light: light.name.clone(),
        skipped: None,
        facing: receivers.len() as u64,
        shadowed: receivers.shadowed_count(),
        samples: 0,
        seconds: 0.0,
    };
    if wanted.is_empty() {
        let reason = if receivers.is_empty() { "no pixel faces the light" } else { "no visible shadow" };
        case.skipped = Some(reason.to_owned());
        case.seconds = start.elapsed().as_secs_f64();
        let row = |_| PerLight {
            frame: stage.frame,
            light: light.name.clone(),
            chosen: None,
            reason: case.skipped.clone(),
            measured: None,
            solve_seconds: 0.0,
            seconds: 0.0,
        };
        let rows = params.methods.iter().map(row).collect();
        return Ok((case, rows));
    }
    let (tracer, camera, view, offset) = (stage.tracer, stage.camera, stage.grid, stage.offset);
    let answers =
        if view.grid.is_film() { Cow::from(&classified) } else { view.answers(tracer, camera, light, offset).into() };
    let lit = LightView { tracer, camera, view, light, offset, answers: &answers };
    let samples = sample_light(&lit, job.sampling.refine, !outside_lit);
    case.samples = samples.edges.len() as u64;
    case.seconds = start.elapsed().as_secs_f64();
    let given = Case {
        tracer: stage.tracer,
        camera: stage.camera,
        film: stage.film,
        view: stage.view,
        bounds: stage.bounds,
        offset: stage.offset,
        frame: stage.frame,
        light,
        samples: &samples,
        receivers: &receivers,
    };
    let mut rows = Vec::with_capacity(params.methods.len());
    let mut masks: Vec<Mask> = Vec::new();
    for variant in &params.methods {
        watch.check()?;
        let (row, mask) = entry(&given, variant, job, params)?;
        rows.push(row);
        if params.pictures.is_some() {
            masks.push(mask);
        }
    }
    if let Some(dir) = &params.pictures {
        strip(&given, number, &rows, &masks, params, dir)?;
    }
    Ok((case, rows))
}

/// Writes the picture of a light: a column for each method.
fn strip(
    case: &Case,
    number: usize,
    rows: &[PerLight],
    masks: &[Mask],
    params: &CompareParams,
    dir: &Path,
) -> Result<(), PlanError> {
    let title = |row: &PerLight, method: &str| match &row.measured {
        Some(measured) => format!("{method} {}", measured.misclassified),
        None => format!("{method} does not apply"),
    };
    let columns: Vec<Column> =
        (0..rows.len()).map(|k| Column { title: title(&rows[k], &params.methods[k].name), mask: &masks[k] }).collect();
    let path = dir.join(picture_name(case.frame, number, &case.light.name));
    let failed = |source| PlanError::Write { dest: path.display().to_string(), source };
    write_file(&path, &picture::strip(case, &columns).map_err(failed)?)
}

/// Frame, place in the list of lights, and as much of the light's name as a file name may hold.
fn picture_name(frame: i64, number: usize, light: &str) -> String {
    let plain = |c: char| if c.is_alphanumeric() || c == '-' { c } else { '_' };
    let name: String = light.chars().take(64).map(plain).collect();
    format!("frame{frame:04}-{number:03}-{name}.png")
}

/// Rows by light to rows by method.
fn gather(cases: Vec<(CaseLight, Vec<PerLight>)>, params: &CompareParams, film: Film, job: &Job) -> Comparison {
    let (lights, rows): (Vec<CaseLight>, Vec<Vec<PerLight>>) = cases.into_iter().unzip();
    let compared = lights.iter().filter(|l| l.skipped.is_none()).count().max(1) as f64;
    let methods = params.methods.iter().enumerate().map(|(k, variant)| {
        let per_light: Vec<PerLight> = rows.iter().map(|r| r[k].clone()).collect();
        let refused = |(row, light): &(&PerLight, &CaseLight)| row.reason.is_some() && light.skipped.is_none();
        MethodRows {
            method: variant.name.clone(),
            misclassified: per_light.iter().filter_map(|r| r.measured.as_ref()).map(|m| m.misclassified).sum(),
            inapplicable: per_light.iter().zip(&lights).filter(refused).count() as u64,
            seconds: per_light.iter().map(|r| r.seconds).sum::<f64>() / compared,
            per_light,
        }
    });
    Comparison {
        pixels: film.pixels() as u64,
        texels: budget::texels(params.question).map(|t| t as u64),
        epsilon: (params.question == Question::Epsilon).then(|| job.quality.epsilon()),
        methods: methods.collect(),
        lights,
    }
}
