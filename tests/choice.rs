//! Methods that choose: the ladder of `auto` in a frame and over a shot, the contest of `best`, and what a plan says of them.

#![expect(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

mod boxes;
#[path = "scene/fixture.rs"]
#[expect(dead_code, reason = "shared with the scene tests, which use more of it")]
mod fixture;
mod watching;

use boxes::Boxes;
use lixel::job;
use lixel::methods::Method;
use lixel::plan::{self, Alternative, Choice, Format, LightPlan, MapPlan, Plan, Status, to_text};
use serde_json::json;
use std::path::Path;
use std::process::{Command, Output};
use watching::watched;

/// A long floor with posts near the camera and far from it.
const WALK: &str = "
scene = 'scene.glb'
[frames]
range = '1'
[image]
size = [160, 90]
[quality]
epsilon = 0.01
[map]
max = 4096
step = 1.05
[solver]
method = 'auto'
max_maps = 3
measured_rounds = 1
[[light]]
name = 'sun'
kind = 'directional'
direction = [0.8, -0.7, 0.35]
[camera]
look_at = [0.0, 0.5, 0.0]
[[camera.key]]
frame = 1
position = [9.0, 2.0, 2.0]
[[camera.key]]
frame = 3
position = [8.4, 2.0, 2.6]
";

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let along = (0..9_u8).map(f32::from).map(|f| [7.0 - f * 3.5, (f * 1.7).cos() * 2.5]);
    Boxes::posts([30.0, 12.0], 0.3, along).write(folder.path());
    std::fs::write(folder.path().join("job.toml"), WALK).unwrap();
    folder
}

fn planned(folder: &Path, overrides: &str) -> Plan {
    let job = job::load(&folder.join("job.toml"), &overrides.parse().unwrap()).unwrap();
    watched(|watch| plan::make(&job, folder, false, watch)).unwrap()
}

fn only(plan: &Plan) -> (&LightPlan, &Choice) {
    let light = &plan.frames[0].lights[0];
    (light, light.solver.as_ref().unwrap().choice.as_ref().unwrap())
}

fn texels(light: &LightPlan) -> u64 {
    light.maps.iter().map(MapPlan::texels).sum()
}

/// The place of the rung that was taken: the last one that saves its share, else the first that has maps.
fn taken(choice: &Choice, min_saving: f64) -> usize {
    let first = choice.tried.iter().position(|t| t.texels.is_some()).unwrap();
    choice.tried.iter().rposition(|t| t.saving.is_some_and(|saving| saving >= min_saving)).unwrap_or(first)
}

#[test]
fn a_light_climbs_to_the_last_step_that_pays() {
    let folder = folder();
    let plan = planned(folder.path(), "");
    let (light, choice) = only(&plan);
    let order: Vec<Method> = choice.tried.iter().map(|t| t.method).collect();
    let all = [Method::Focused, Method::Lixel, Method::Partitioned, Method::Partitioned];
    assert!(order.len() >= 2 && order == all[..order.len()], "{order:?}");
    let mut held = &choice.tried[0];
    for tried in &choice.tried[1..] {
        // Improved or not, a step saves of what is held before it.
        let needs = |t: &Alternative| [Some(t.texels.unwrap()), t.improved].into_iter().flatten();
        let saving = tried.saving.unwrap();
        let pairs = || needs(held).flat_map(|a| needs(tried).map(move |b| 1.0 - b as f64 / a as f64));
        assert!(pairs().any(|s| (saving - s).abs() < 1e-9), "{held:?} {tried:?}");
        if saving >= 0.15 {
            held = tried;
        }
    }
    let rung = &choice.tried[taken(choice, 0.15)];
    assert_eq!((light.status, light.maps[0].method), (Status::Planned, rung.method));
    assert_eq!(light.maps.len() as u64, rung.maps.unwrap());
    assert!(texels(light) <= rung.texels.unwrap(), "better maps near those that were compared need no more");
    assert!(choice.reason.contains(&format!("`{}`", rung.method.name())), "{}", choice.reason);
    // Each method by itself needs what its rung says, before better maps are looked for.
    for tried in &choice.tried {
        let maps = tried.maps.unwrap();
        let alone = format!("[solver]\nmethod = '{}'\nmaps = {maps}\nmeasured_rounds = 0", tried.method.name());
        assert_eq!(texels(&planned(folder.path(), &alone).frames[0].lights[0]), tried.texels.unwrap(), "{tried:?}");
    }
    let verified = watched(|watch| plan::verify(&plan, folder.path(), watch)).unwrap();
    assert!(verified.passed, "{:?}", verified.problems);
}

#[test]
fn the_share_and_the_maps_allowed_end_the_climb() {
    let folder = folder();
    let greedy = planned(folder.path(), "[solver]\nmin_saving = 0.99");
    let (light, choice) = only(&greedy);
    assert_eq!((light.maps[0].method, choice.tried.len()), (Method::Focused, 3));
    assert!(choice.reason.contains("where a step has to save the 99 % of solver.min_saving"), "{}", choice.reason);
    let one = planned(folder.path(), "[solver]\nmax_maps = 1\nmin_saving = 0.0");
    let (light, choice) = only(&one);
    assert_eq!((light.maps.len(), light.maps[0].method, choice.tried.len()), (1, Method::Lixel, 2));
    assert!(choice.reason.contains("solver.max_maps = 1"), "{}", choice.reason);
    // A light without a visible shadow stands below the ladder.
    let up = "light = [{ name = 'below', kind = 'directional', direction = [0.1, 1.0, 0.0] }]";
    let light = &planned(folder.path(), up).frames[0].lights[0];
    assert!(light.solver.is_none() && light.maps.is_empty() && light.met(), "{:?}", light.status);
}

#[test]
fn without_measuring_the_prediction_is_climbed_by() {
    let folder = folder();
    let plan = planned(folder.path(), "[quality]\nmeasure = 'never'");
    let (light, choice) = only(&plan);
    let rung = &choice.tried[taken(choice, 0.15)];
    assert!(light.error.as_ref().unwrap().measured.is_none() && light.cost.texels_drawn == 0);
    assert_eq!((Some(texels(light)), light.maps[0].method), (rung.texels, rung.method));
    assert!(choice.reason.contains("as predicted"), "{}", choice.reason);
}

#[test]
fn a_shot_has_one_rung_for_a_light_and_threads_decide_nothing() {
    let folder = folder();
    let over = "frames.range = '1-3'\n[solver]\nmin_saving = 0.05";
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| planned(folder.path(), over))
    };
    let plan = on(1);
    assert_eq!(to_text(&plan, Format::Json).unwrap(), to_text(&on(3), Format::Json).unwrap());
    let (_, choice) = only(&plan);
    assert!(choice.tried[0].reason.as_ref().unwrap().contains("by one camera"), "{choice:?}");
    assert_eq!(choice.tried[1].method, Method::Lixel);
    let rung = &choice.tried[taken(choice, 0.05)];
    for frame in &plan.frames {
        let light = &frame.lights[0];
        assert_eq!(light.solver.as_ref().unwrap().choice.as_ref(), Some(choice), "frame {}", frame.frame);
        assert_eq!((light.maps[0].method, light.temporal.as_ref().unwrap().segment.is_some()), (rung.method, true));
        assert!(light.met());
    }
    let plain = planned(folder.path(), "frames.range = '1-3'\n[solver]\nmethod = 'lixel'");
    assert!(plan.summary.texels_drawn <= plain.summary.texels_drawn);
    let verified = watched(|watch| plan::verify(&plan, folder.path(), watch)).unwrap();
    assert!(verified.passed, "{:?}", verified.problems);
}

#[test]
fn the_best_map_errs_least_at_equal_texels() {
    let folder = folder();
    let plan = planned(folder.path(), "quality.epsilon = 0.003\nsolver.method = 'best'");
    let (light, choice) = only(&plan);
    assert_eq!(choice.tried.len(), 9, "every method with one map");
    let errors = || choice.tried.iter().filter_map(|t| t.error);
    let least = errors().fold(f64::INFINITY, f64::min);
    let won = choice.tried.iter().find(|t| t.error == Some(least)).unwrap();
    let planned_by = light.maps[0].method;
    let named = format!("`{}`", won.method.name());
    // The winner may need more texels for the bound itself; then it is said, and lixel's own map stays.
    let gave_way = choice.reason.contains(&format!("{named} errs less"));
    assert!(planned_by == won.method || (gave_way && planned_by == Method::Lixel), "{}", choice.reason);
    assert!(choice.reason.contains(&named), "{}", choice.reason);
    let base = choice.tried[0].texels.unwrap();
    for tried in &choice.tried {
        let Some(texels) = tried.texels else { continue };
        // Steps of 1.05 along each side.
        assert!(texels >= base && texels as f64 <= 1.15 * base as f64, "{tried:?}");
        assert!(tried.error.unwrap() > 0.0 && tried.misclassified.is_some());
    }
    let plain = planned(folder.path(), "quality.epsilon = 0.003\nsolver.method = 'lixel'");
    assert!(texels(light) <= texels(&plain.frames[0].lights[0]), "never more than lixel's own");
}

#[test]
fn the_command_says_why() {
    let folder = folder();
    let args = ["plan", "job.toml", "--method", "auto", "--max-maps", "2", "--explain", "-o", "auto.json", "--quiet"];
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("lixel"));
    let Output { status, stdout, stderr } = command.current_dir(folder.path()).args(args).output().unwrap();
    let (said, noted) = (String::from_utf8(stdout).unwrap(), String::from_utf8(stderr).unwrap());
    assert_eq!((status.code(), noted.as_str()), (Some(0), ""));
    assert!(said.starts_with("frame 1, sun: planned, ") && !said.contains("the job's method"), "{said}");
    assert!(said.contains("solver.m"), "the key that ended the climb: {said}");
    let plan: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(folder.path().join("auto.json")).unwrap()).unwrap();
    let choice = &plan["frames"][0]["lights"][0]["solver"]["choice"];
    assert!(choice["tried"].as_array().unwrap().len() <= 3 && said.contains(choice["reason"].as_str().unwrap()));
    assert_eq!((&plan["job"]["solver"]["method"], &plan["job"]["solver"]["max_maps"]), (&json!("auto"), &json!(2)));
    let schema = Command::new(assert_cmd::cargo::cargo_bin!("lixel")).args(["schema", "plan"]).output().unwrap();
    let schema: serde_json::Value = serde_json::from_slice(&schema.stdout).unwrap();
    assert!(jsonschema::is_valid(&schema, &plan));
}
