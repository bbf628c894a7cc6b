//! Jobs: layers, inputs, and what each bad job is told.

#![expect(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use lixel::fit::Effort;
use lixel::job::{Job, JobError, LoadedJob, Preset, load};
use lixel::methods::Method;
use lixel::resolution::{Bound, Measure};
use lixel::scene::SceneFile;

fn loaded(text: &str, overrides: &str) -> Result<LoadedJob, JobError> {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("job.toml");
    fs::write(&file, text).unwrap();
    load(&file, &overrides.parse().unwrap())
}

fn job(text: &str, overrides: &str) -> Job {
    loaded(text, overrides).unwrap().job
}

#[test]
fn a_full_job_is_read() {
    let job = job(
        r#"
        scene = ["set/a.gltf", "b.obj"]
        animation = "walk"
        active_scene = "night"
        [frames]
        range = "1-240x2"
        fps = 25
        [image]
        size = [1280, 720]
        [[camera.key]]
        frame = 1
        position = [0, 1.7, 5]
        look_at = [0, 1, 0]
        [[camera.key]]
        frame = 100.5
        position = [3, 1.7, 5]
        look_at = [0, 2, 0]
        fov = 30
        [[light]]
        name = "sun"
        [[light]]
        name = "lamp"
        kind = "spot"
        position = [0, 3, 0]
        direction = [0, -1, 0]
        cone = 40
        range = 12.5
        [quality]
        bound = "displacement"
        quantile = 0.95
        [map]
        shape = "affine"
        max = 4096
        power_of_two = true
        bias = { constant = 0.0001, slope = 2 }
        [solver]
        method = "scene-optimal"
        "#,
        "",
    );
    assert_eq!(job.scene, [SceneFile::from("set/a.gltf"), SceneFile::from("b.obj")]);
    assert_eq!((job.animation, job.active_scene), (Some(vec!["walk".to_owned()]), Some("night".to_owned())));
    assert_eq!(job.frames.fps, Some(25.0));
    assert_eq!(job.camera.key[1].fov, Some(30.0));
    assert_eq!(job.light[1].range, Some(12.5));
    assert_eq!((job.quality.bound, job.quality.epsilon), (Bound::Displacement, Some(1.0)));
    assert_eq!(job.map.bias.constant, Some(0.0001));
    assert_eq!(job.solver.method, Method::SceneOptimal);
    assert_eq!(job.sampling, Job::default().sampling);
}

#[test]
fn layers_lie_in_order() {
    let text = "scene = \"a.glb\"\npreset = \"draft\"\n[solver]\nrounds = 7\n[map]\nmax = 512";
    let from_file = job(text, "");
    assert_eq!((from_file.preset, from_file.quality.measure), (Preset::Draft, Measure::Never));
    assert_eq!((from_file.sampling.cap, from_file.solver.rounds, from_file.map.max), (2048, 7, 512));
    assert_eq!(from_file.solver.effort, Effort::Global);
    let overridden = job(text, "preset = \"thorough\"\n[map]\nmax = 1024");
    assert_eq!((overridden.preset, overridden.quality.measure), (Preset::Thorough, Measure::Always));
    assert_eq!((overridden.solver.effort, overridden.solver.rounds, overridden.map.max), (Effort::Exhaustive, 7, 1024));
}

#[test]
fn epsilon_follows_its_bound() {
    let text = "scene = \"a.glb\"\n[quality]\nepsilon = 0.002";
    assert_eq!(job(text, "").quality.epsilon, Some(0.002));
    assert_eq!(job(text, "[quality]\nbound = \"footprint\"").quality.epsilon, Some(1.0));
    assert_eq!(job(text, "[quality]\nbound = \"footprint\"\nepsilon = 3").quality.epsilon, Some(3.0));
}

#[test]
fn a_scene_is_a_job_of_its_own() {
    let loaded = load(Path::new("sets/House.GLB"), &"[image]\nsize = [64, 48]".parse().unwrap()).unwrap();
    assert_eq!(loaded.job.scene, [SceneFile::from("House.GLB")]);
    assert_eq!(loaded.job.image.size, Some([64, 48]));
    assert_eq!((loaded.file.as_deref(), loaded.dir.as_path()), (None, Path::new("sets")));
    assert_eq!(loaded.scene_files(), [SceneFile::from("sets/House.GLB")]);
}

#[test]
fn a_resolved_job_is_a_job_file_with_the_same_meaning() {
    let first = job("scene = [\"a.glb\", \"b.obj\"]\npreset = \"draft\"\n[camera]\nframe_all = true\nfov = 30", "");
    assert_eq!(job(&toml::to_string(&first).unwrap(), ""), first);
}

#[test]
fn what_only_the_overrides_break_is_not_blamed_on_the_file() {
    let error = loaded("scene = \"a.glb\"", "[map]\nmax = 4").unwrap_err();
    assert!(matches!(&error, JobError::Override(problem) if problem.key == "map.max"), "{error}");
    let error = loaded("scene = \"a.glb\"", "preset = \"fast\"").unwrap_err();
    assert!(matches!(&error, JobError::Override(problem) if problem.key == "preset"), "{error}");
}

#[test]
fn files_that_are_no_text_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("job.toml");
    fs::write(&file, b"scene = \"a.glb\"\n# caf\xe9\n").unwrap();
    let error = load(&file, &toml::Table::new()).unwrap_err().to_string();
    assert!(error.ends_with("job.toml:2:6: this is not UTF-8; save the file as UTF-8"), "{error}");
    let error = load(dir.path(), &toml::Table::new()).unwrap_err();
    assert!(matches!(error, JobError::Kind { .. }));
}

/// What a user sees, to the letter. `case.txt` follows `case.toml` in `tests/job_errors`.
#[test]
fn bad_jobs_are_told_what_is_wrong_where_and_what_to_do() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/job_errors");
    let mut jobs: Vec<PathBuf> = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    jobs.retain(|path| path.extension().is_some_and(|e| e == "toml"));
    jobs.sort();
    assert!(jobs.len() >= 15, "only {} bad jobs", jobs.len());
    let mut wrong = Vec::new();
    for path in &jobs {
        let name = path.file_name().unwrap();
        let run = Command::new(assert_cmd::cargo::cargo_bin!("lixel"))
            .current_dir(&folder)
            .env("NO_COLOR", "1")
            .arg("plan")
            .arg(name)
            .output()
            .unwrap();
        let said = String::from_utf8(run.stderr).unwrap();
        let expected = fs::read_to_string(path.with_extension("txt")).unwrap_or_default().replace("\r\n", "\n");
        if said != expected || run.status.code() != Some(2) || !run.stdout.is_empty() {
            wrong.push(format!("{} ({:?}): expected\n{expected}\nbut was\n{said}", name.display(), run.status.code()));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
