//! Checking a plan against the scene: input hashes, cameras, witnesses, and every light measured again.
//!
//! Uses no sample, metric or fit: what judges a plan shares none of what chose it. Planning and checking are both
//! deterministic, so counts have to be equal to the pixel.
//!
//! A plan from images is held against them: what is in shadow lies in a map, what looks a map up in its depth range, and
//! witnesses are as the images have them. Nothing can be drawn, so nothing is counted.
//!
//! Not checked: `near` and `far` in metres, the prediction, and what planning cost; and where the plan was not measured, the
//! bias in texels and metres and the f32 round trip, which are those of points of its planning grid.

mod across;
mod claims;
mod images;
mod light;
mod restated;
mod units;
mod witness;

use std::path::Path;

use across::Across;
use serde::Serialize;

use super::make::load_either;
use super::remeasure::{Before, Left, Seeing};
use super::reproject::Steps;
use super::stage::Posed;
use super::{Input, Plan, PlanError, Stage, Watch, sha256_hex};
use crate::job::{self, LoadedJob};
use crate::scene::Shot;
use crate::visibility::{Bvh, RayOffset, see};

/// What a check of a plan found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Verification {
    /// True when every input, every light and every bound holds.
    pub passed: bool,
    /// The files of the plan.
    pub inputs: Vec<InputCheck>,
    /// What does not hold of the plan as a whole: its job, frames, cameras, summary.
    pub problems: Vec<String>,
    /// The lights of the plan's frames; none when inputs or job do not hold.
    pub lights: Vec<LightCheck>,
}

/// Whether a file is what the plan was made from.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct InputCheck {
    /// As in the plan.
    pub path: String,
    /// True when its hash is the plan's.
    pub passed: bool,
    /// What is wrong.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
}

/// What a check of a light came to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Outcome {
    /// What the plan says is so, and the bound holds.
    Holds,
    /// What the plan says is so, but the bound does not hold.
    NotMet,
    /// What the plan says is not so.
    Broken,
}

/// Whether a light of a frame keeps what the plan says of it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LightCheck {
    /// Frame number.
    pub frame: i64,
    /// Name of the light.
    pub light: String,
    /// Width and height of each map, texels.
    pub sizes: Vec<[u32; 2]>,
    /// Wrong pixels as the plan has them; absent when it was not measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub planned: Option<u64>,
    /// Wrong pixels now; absent where nothing can be drawn, for a plan from images.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub measured: Option<u64>,
    /// Further wrong pixels, whose exact answer is uncertain, now; absent likewise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub uncertain: Option<u64>,
    /// Pixels on surfaces that did not move whose answer changes since the frame before although the exact answer does not,
    /// now; absent for the first frame.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub flicker: Option<u64>,
    /// Pixels of the image.
    pub of_pixels: u64,
    /// The bound, in the unit of the job's `quality.bound`.
    pub epsilon: f64,
    /// Witnesses that the plan's matrices and exact visibility bear out.
    pub witnesses_held: u64,
    /// Witnesses in the plan.
    pub witnesses: u64,
    /// What it came to.
    pub outcome: Outcome,
    /// What does not hold, each with the plan's value and the one found.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub reasons: Vec<String>,
}

/// Checks a plan whose paths are relative to `plan_dir`.
///
/// # Errors
/// [`PlanError`] when the check itself cannot be made; a plan found wrong is a [`Verification`] that did not pass.
pub fn verify(plan: &Plan, plan_dir: &Path, watch: &Watch) -> Result<Verification, PlanError> {
    watch.step(Stage::Load, 0, 1)?;
    let inputs = check_inputs(plan, plan_dir);
    let problems: Vec<String> =
        job::check(&plan.job.job).err().map(|p| format!("job.{}: {}", p.key, p.message)).into_iter().collect();
    let mut found = Verification { passed: false, inputs, problems, lights: Vec::new() };
    if !(found.problems.is_empty() && found.inputs.iter().all(|i| i.passed)) {
        return Ok(found);
    }
    let loaded = LoadedJob { job: plan.job.job.clone(), file: None, dir: plan_dir.to_owned() };
    let (shot, images) = load_either(&loaded)?;
    found.problems = claims::of_the_whole(plan, plan_dir, &shot);
    match &images {
        Some(images) => images::look(plan, &shot, images, &mut found, watch)?,
        None => measure(plan, &shot, &mut found, watch)?,
    }
    found.passed = found.problems.is_empty() && found.lights.iter().all(|l| l.outcome == Outcome::Holds);
    Ok(found)
}

/// Measures the lights of all frames that the shot has.
fn measure(plan: &Plan, shot: &Shot, found: &mut Verification, watch: &Watch) -> Result<(), PlanError> {
    let still = Bvh::still(&shot.scene);
    let mut across = Across::default();
    let total = plan.frames.iter().map(|f| f.lights.len() as u64).sum();
    for planned in &plan.frames {
        let Some(time) = shot.frames.iter().find(|time| time.frame == planned.frame) else { continue };
        let posed = Posed::new(shot, time.time_s)?;
        let (tracer, frame) = (posed.tracer(shot, &still), &posed.frame);
        found.problems.extend(claims::of_a_frame(planned, frame, shot.film));
        let view = see(&tracer, &frame.camera, shot.film);
        let offset = RayOffset::for_scene(&tracer);
        let (mut maps, mut caches) = (Vec::with_capacity(planned.lights.len()), Vec::new());
        let seeing = Seeing { tracer: &tracer, camera: &frame.camera, view: &view, offset };
        let earlier = across.before.as_ref().map(|b| b.earlier((shot, &still), &seeing));
        for entry in &planned.lights {
            watch.step(Stage::Lights, found.lights.len() as u64, total)?;
            let Some(light) = frame.lights.iter().find(|l| l.name == entry.light) else { continue };
            let (mut check, measured) = light::check(&seeing, planned.frame, entry, light, &plan.job.job);
            if let Some(measured) = measured {
                if plan.job.job.lookup.is_temporal() && plan.frames.len() > 1 {
                    let (before, earlier) = (across.before.as_ref(), earlier.as_deref());
                    let steps = Steps { shot, still: &still, job: &plan.job.job, seeing, before, earlier };
                    let (shown, cache) = steps.shown(light, &measured);
                    across::check_shown(&mut check, entry, shown);
                    caches.push((entry.light.clone(), cache));
                }
                across.check(&mut check, plan, entry, &measured, (shot, &still), earlier.as_deref());
                maps.push((entry.light.clone(), measured.drawn));
            }
            found.lights.push(check);
        }
        let offset = seeing.offset;
        let left = plan.job.job.lookup.is_temporal().then_some(Left { view, caches });
        across.before = Some(Before { number: planned.frame, posed, offset, maps, left });
    }
    watch.step(Stage::Lights, total, total)
}

/// Compares the hash of every input with the plan's.
fn check_inputs(plan: &Plan, plan_dir: &Path) -> Vec<InputCheck> {
    let check = |input: &Input| match sha256_hex(&plan_dir.join(&input.path)) {
        Ok(hash) if hash == input.sha256 => None,
        Ok(_) => Some("its content is not what the plan was made from; plan the job again".to_owned()),
        Err(error) => Some(error.to_string()),
    };
    let found = |input: &Input| {
        let reason = check(input);
        InputCheck { path: input.path.clone(), passed: reason.is_none(), reason }
    };
    plan.job.inputs.iter().map(found).collect()
}
