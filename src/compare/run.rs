//! Frames and lights of a comparison.

use super::entry::{Case, Mask, entry};
use super::files::write_file;
use super::picture::{self, Column};
use super::{CaseLight, CompareParams, Comparison, MethodRows, PerLight, Question, budget, workers};
use crate::job::{Job, LoadedJob};
use crate::plan::{FrameStage, PlanError, Stage, Stages, Watch, in_scene_space, load_shot};
use crate::resolution::Measure;
use crate::scene::{Film, Light};
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// Compares methods on the frames and lights of a job.
///
/// # Errors
/// [`PlanError::Cancelled`] soon after the watch asks to stop; else what stands in the way.
pub fn compare(loaded: &LoadedJob, params: &CompareParams, watch: &Watch) -> Result<Comparison, PlanError> {
    watch.step(Stage::Load, 0, 1)?;
    let shot = load_shot(loaded)?;
    for note in &shot.scene.notes {
        watch.note(note);
    }
    let mut job = in_scene_space(&loaded.job, &shot);
    // What is compared is measured, also where a plan would not be.
    job.quality.measure = Measure::Always;
    let mut params = params.clone();
    for variant in &mut params.methods {
        variant.solver = variant.solver.in_scene_space(shot.scene.origin);
    }
    let stages = Stages::new(&shot, &job, None);
    watch.step(Stage::Load, 1, 1)?;

    let done = AtomicU64::new(0);
    let mut cases: Vec<(CaseLight, Vec<PerLight>)> = Vec::new();
    for place in 0..stages.len() {
        cases.extend(stages.with(place, |stage, frame| {
            let total = (stages.len() * frame.lights.len()) as u64;
            watch.step(Stage::Lights, done.load(Ordering::Relaxed), total)?;
            workers::each(frame.lights.len(), |i| {
                watch.check()?;
                let case = light((stage, stages.time(place).frame), (i, &frame.lights[i]), &job, &params, watch)?;
                watch.step(Stage::Lights, done.fetch_add(1, Ordering::Relaxed) + 1, total)?;
                Ok::<_, PlanError>(case)
            })
        })?);
    }
    Ok(gather(cases, &params, shot.film, &job))
}

/// All methods on one light of a frame, given with its number.
fn light(
    (stage, frame): (&FrameStage, i64),
    (number, light): (usize, &Light),
    job: &Job,
    params: &CompareParams,
    watch: &Watch,
) -> Result<(CaseLight, Vec<PerLight>), PlanError> {
    let start = Instant::now();
    let lit = stage.look(light, job);
    let receivers = lit.film.unwrap_or_default();
    let mut case = CaseLight {
        frame,
        light: light.name.clone(),
        skipped: None,
        facing: receivers.len() as u64,
        shadowed: receivers.shadowed_count(),
        samples: lit.samples.edges.len() as u64,
        seconds: start.elapsed().as_secs_f64(),
    };
    let (Some(view), true) = (stage.view, receivers.needing(job.map.outside) > 0) else {
        let reason = if receivers.is_empty() { "no pixel faces the light" } else { "no visible shadow" };
        case.skipped = Some(reason.to_owned());
        let row = |_| PerLight {
            frame,
            light: light.name.clone(),
            chosen: None,
            reason: case.skipped.clone(),
            measured: None,
            solve_seconds: 0.0,
            seconds: 0.0,
        };
        let rows = params.methods.iter().map(row).collect();
        return Ok((case, rows));
    };
    let given = Case { stage, view, frame, light, samples: &lit.samples, receivers: &receivers };
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
