//! What a plan says of the whole shot and of its cameras and lights, against the scene.

use std::path::Path;

use super::super::{FramePlan, LightPlan, Plan, Summary, budget};
use crate::math::rows_of;
use crate::scene::{Film, Light, SceneFrame, Shot};

/// Two numbers are the same when they differ by less than this part of the largest number beside them: what a few
/// roundings and another system's sine may change.
const TOLERANCE: f64 = 1e-12;

/// Inputs, origin, frames and summary.
pub(super) fn of_the_whole(plan: &Plan, plan_dir: &Path, shot: &Shot) -> Vec<String> {
    let mut problems = Vec::new();
    let real = |path: &Path| path.canonicalize().unwrap_or(path.to_owned());
    for read in &shot.scene.inputs {
        if !plan.job.inputs.iter().any(|input| real(&plan_dir.join(&input.path)) == real(read)) {
            problems.push(format!("{} is read by the job, but the plan has no hash of it", read.display()));
        }
    }
    let origin = shot.scene.origin.to_array();
    if plan.origin != origin {
        problems.push(format!("origin is {:?} in the plan, {origin:?} in the scene", plan.origin));
    }
    let frames: Vec<i64> = plan.frames.iter().map(|f| f.frame).collect();
    let wanted: Vec<i64> = shot.frames.iter().map(|f| f.frame).collect();
    if frames != wanted {
        problems.push(format!("the plan has frames {frames:?}, its job asks for {wanted:?}"));
    }
    for (planned, time) in plan.frames.iter().zip(&shot.frames) {
        if planned.frame == time.frame && !same(&[planned.time_s], &[time.time_s]) {
            problems.push(format!("frame {}: time_s is {}, {} in the shot", time.frame, planned.time_s, time.time_s));
        }
    }
    if plan.summary != Summary::of(&plan.frames) {
        problems.push("summary does not say what the frames say".to_owned());
    }
    if plan.budget != plan.job.budget_of(&plan.frames) {
        problems.push("budget does not say what the frames say".to_owned());
    }
    problems.extend(budget::faults(plan));
    problems
}

/// The camera and the list of lights of a frame.
pub(super) fn of_a_frame(planned: &FramePlan, frame: &SceneFrame, film: Film) -> Vec<String> {
    let mut problems = Vec::new();
    let mut problem = |text: String| problems.push(format!("frame {}: {text}", planned.frame));
    let (camera, scene) = (&planned.camera, &frame.camera);
    if camera.name != scene.name {
        problem(format!("the camera is `{}` in the plan, `{}` in the scene", camera.name, scene.name));
    }
    if (camera.width, camera.height) != (film.width, film.height) {
        let (width, height) = (camera.width, camera.height);
        problem(format!("the film is {width}x{height} in the plan, {}x{} in the job", film.width, film.height));
    }
    if !same(camera.clip_from_world.as_flattened(), rows_of(&scene.clip_from_scene(film)).as_flattened()) {
        problem("camera.clip_from_world is not the matrix of the scene's camera".to_owned());
    }
    if !same(&camera.position, &scene.position.to_array()) {
        problem(format!("camera.position is {:?}, {} in the scene", camera.position, scene.position));
    }
    let names: Vec<&str> = planned.lights.iter().map(|l| l.light.as_str()).collect();
    let wanted: Vec<&str> = frame.lights.iter().map(|l| l.name.as_str()).collect();
    if names != wanted {
        problem(format!("the plan has lights {names:?}, its job asks for {wanted:?}"));
    }
    problems
}

/// Kind and place of a light.
pub(super) fn of_a_light(planned: &LightPlan, light: &Light) -> Option<String> {
    let scene = LightPlan::unplanned(light, planned.epsilon);
    let numbers = |l: &LightPlan| {
        let vectors = [l.direction, l.position].into_iter().flatten().flatten();
        vectors.chain(l.cone_degrees).chain(l.range).collect::<Vec<f64>>()
    };
    let keys = |l: &LightPlan| {
        (l.kind, l.direction.is_some(), l.position.is_some(), l.cone_degrees.is_some(), l.range.is_some())
    };
    (keys(planned) != keys(&scene) || !same(&numbers(planned), &numbers(&scene)))
        .then(|| "kind, direction, position, cone or range are not those of the scene's light".to_owned())
}

/// Whether two lists of numbers agree within [`TOLERANCE`]; a number that is not finite agrees with none.
fn same(a: &[f64], b: &[f64]) -> bool {
    let largest = b.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= TOLERANCE * largest)
}
