//! Real scenes, which lie outside the repository:
//! `LIXEL_SCENES=folder cargo test --release --test real_scenes -- --nocapture`.
//!
//! Every scene file of the folder is planned at a small size, with its own camera and lights where it has them, else seen
//! as a whole under one sun; the plan is written, read again and verified. A file that needs a feature lixel does not have is
//! refused by the name of that feature. Nothing may fail, crash or hang.

#![expect(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

mod encodings;
mod requantised;
#[path = "../watching/mod.rs"]
mod watching;

use lixel::job::{self, LoadedJob};
use lixel::math::{Domain, matrix_from_rows};
use lixel::measure::{Drawn, Outside, Receivers, wrong};
use lixel::plan::{self, Format, LightPlan, Outcome, PlanError};
use lixel::raster::{Bias, draw};
use lixel::resolution::Measure;
use lixel::scene::{Geometry, SceneError};
use lixel::visibility::{Bvh, RayOffset, Tracer, see};
use std::fs;
use std::path::{Path, PathBuf};
use watching::watched;

/// Small, so that a folder of scenes takes minutes.
const SETTINGS: &str = "[image]\nsize = [480, 270]\n[quality]\nepsilon = 0.001\n[map]\nmax = 4096\n";
/// A three-quarter view under one sun.
const SEEN_WHOLE: &str =
    "[camera]\nframe_all = true\n[[light]]\nname = \"sun\"\nkind = \"directional\"\ndirection = [0.4, -1.0, 0.3]\n";
/// Frames planned of an animation, evenly spread.
const FRAMES: usize = 2;

/// Scene files of a folder and its folders, in order.
fn scene_files(folder: &Path) -> Vec<PathBuf> {
    let mut entries: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    let open = |path: PathBuf| match path {
        path if path.is_dir() => scene_files(&path),
        path if job::is_scene_file(&path) => vec![path],
        _ => Vec::new(),
    };
    entries.into_iter().flat_map(open).collect()
}

fn load(file: &Path, more: &str) -> LoadedJob {
    job::load(file, &format!("{SETTINGS}{more}").parse().unwrap()).unwrap()
}

/// The shot of a job: number of triangles, and the numbers of its frames.
fn shot(loaded: &LoadedJob) -> Result<(usize, Vec<i64>), SceneError> {
    let shot = loaded.shot()?;
    let moving = shot.scene.frame(shot.frames[0].time_s)?.moving.len();
    Ok((shot.scene.still.len() + moving, shot.frames.iter().map(|f| f.frame).collect()))
}

/// The scene as it is where that makes a shot, else seen as a whole; with the frames to plan.
fn settled(file: &Path) -> Result<(LoadedJob, usize, &'static str), SceneError> {
    let own = load(file, "");
    let (mut loaded, how, (triangles, frames)) = match shot(&own) {
        Ok(found) => (own, "own", found),
        Err(_) => {
            let whole = load(file, SEEN_WHOLE);
            let found = shot(&whole)?;
            (whole, "supplied", found)
        }
    };
    let chosen: Vec<String> = (0..FRAMES).map(|k| frames[(frames.len() - 1) * k / (FRAMES - 1)].to_string()).collect();
    loaded.job.frames.range = Some(chosen.join(","));
    Ok((loaded, triangles, how))
}

fn row(name: &str, triangles: usize, how: &str, frame: i64, light: &LightPlan) {
    let sizes: Vec<String> = light.maps.iter().map(|m| format!("{}x{}", m.width, m.height)).collect();
    let error = light.error.as_ref();
    let predicted =
        error.and_then(|e| e.predicted.as_ref()).map_or("-".to_owned(), |p| format!("{:.0}", p.misclassified));
    let measured = error
        .and_then(|e| e.measured.as_ref())
        .map_or("-".to_owned(), |m| format!("{}+{}", m.misclassified, m.uncertain));
    println!(
        "| {name} | {triangles} | {how} | {frame} | {} | {} | {:?} | {predicted} | {measured} |",
        light.light,
        sizes.join(" "),
        light.status
    );
}

/// Plans a scene, and says what a check of the plan found wrong.
fn plan_and_verify(name: &str, file: &Path, work: &Path) -> Result<Vec<String>, PlanError> {
    let (loaded, triangles, how) = settled(file)?;
    let plan = watched(|watch| plan::make(&loaded, work, false, watch))?;
    for frame in &plan.frames {
        for light in &frame.lights {
            row(name, triangles, how, frame.frame, light);
        }
    }
    let text = plan::to_text(&plan, Format::Json)?;
    let read = plan::parse(&text, Format::Json, Path::new(name))?;
    let found = watched(|watch| plan::verify(&read, work, watch))?;
    let inputs = found.inputs.iter().filter_map(|i| i.reason.clone());
    let lights = found.lights.iter().filter(|l| l.outcome == Outcome::Broken);
    let lights = lights.map(|l| format!("frame {}, {}: {}", l.frame, l.light, l.reasons.join("; ")));
    Ok(inputs.chain(found.problems.clone()).chain(lights).collect())
}

/// What a shortened measurement says is what a full one says, in every scene that can be planned.
#[test]
fn a_shortened_measurement_answers_as_the_full_one() {
    let Some(folder) = std::env::var_os("LIXEL_SCENES").map(PathBuf::from) else {
        println!("skipped: LIXEL_SCENES not set");
        return;
    };
    let (work, mut planned) = (tempfile::tempdir().unwrap(), 0);
    for file in scene_files(&folder) {
        let Ok((mut loaded, ..)) = settled(&file) else { continue };
        let mut frames = |measure: Measure| {
            loaded.job.quality.measure = measure;
            watched(|watch| plan::make(&loaded, work.path(), false, watch)).unwrap().frames
        };
        assert!(frames(Measure::Always) == frames(Measure::Full), "{}", file.display());
        planned += 1;
    }
    println!("{planned} scenes");
}

/// Whether a refusal names something that stands in the file: an extension or a key.
fn is_named_in(feature: &str, file: &Path) -> bool {
    let text = String::from_utf8_lossy(&fs::read(file).unwrap()).into_owned();
    let words = feature.split(|c: char| !(c.is_ascii_alphanumeric() || c == '_'));
    words.filter(|word| word.len() > 4).any(|word| text.contains(&format!("\"{word}\"")))
}

#[test]
fn every_real_scene_is_planned_and_verified_or_refused_by_name() {
    let Some(folder) = std::env::var_os("LIXEL_SCENES").map(PathBuf::from) else {
        println!("skipped: LIXEL_SCENES not set");
        return;
    };
    assert!(folder.is_dir(), "LIXEL_SCENES = {} is no folder", folder.display());
    let files = scene_files(&folder);
    assert!(!files.is_empty(), "{} holds no scene file", folder.display());
    let work = tempfile::tempdir().unwrap();
    let mut failed = Vec::new();
    println!("| scene | triangles | camera, lights | frame | light | maps | status | predicted | measured |");
    println!("|---|---|---|---|---|---|---|---|---|");
    for file in &files {
        let name = file.strip_prefix(&folder).unwrap_or(file).display().to_string();
        match plan_and_verify(&name, file, work.path()) {
            Ok(faults) if faults.is_empty() => {}
            Ok(faults) => failed.push(format!("{name}: {}", faults.join("\n  "))),
            // A feature by its name: an extension.
            Err(PlanError::Scene(SceneError::Unsupported { features, .. })) => {
                println!("| {name} | refused: {} |", features.join("; "));
                let unfounded = features.iter().find(|f| !is_named_in(f, file));
                failed.extend(unfounded.map(|f| format!("{name}: refused for `{f}`, which the file does not name")));
                if features.is_empty() {
                    failed.push(format!("{name}: refused without a reason"));
                }
            }
            Err(error) => failed.push(format!("{name}: {error}")),
        }
    }
    assert!(failed.is_empty(), "{} of {} scenes failed:\n{}", failed.len(), files.len(), failed.join("\n"));
}

/// Wrong and asking pixels of a frame's first light, with its maps drawn as planned, and with masks ignored.
fn with_and_without_masks(file: &Path, work: &Path) -> [usize; 3] {
    let (loaded, ..) = settled(file).unwrap();
    let plan = watched(|watch| plan::make(&loaded, work, false, watch)).unwrap();
    let planned = &plan.frames[0];
    let shot = loaded.shot().unwrap();
    let frame = shot.scene.frame(planned.time_s).unwrap();
    let geometry = shot.scene.geometry(&frame);
    let (still, moving) = (Bvh::still(&shot.scene), Bvh::moving(&shot.scene, &frame));
    let tracer = Tracer::new(geometry, &still, moving.as_ref());
    let view = see(&tracer, &frame.camera, shot.film);
    let offset = RayOffset::for_scene(&tracer);
    let receivers = Receivers::classify(&tracer, &view, &frame.camera, &frame.lights[0], offset);
    let draw = |geometry: Geometry| {
        let maps = planned.lights[0].maps.iter().map(|map| {
            let bias = Bias {
                constant: map.bias.constant,
                slope: map.bias.slope,
                clamp: map.bias.clamp.unwrap_or(f64::INFINITY),
            };
            let clip_from_scene = matrix_from_rows(&map.clip_from_world);
            let map = draw(geometry, &clip_from_scene, map.width, map.height, bias).unwrap();
            Drawn { domain: Domain::All, clip_from_scene, map }
        });
        wrong(&receivers, &maps.collect::<Vec<_>>(), Outside::Lit).len()
    };
    [draw(geometry), draw(Geometry::plain(geometry.still, geometry.moving)), receivers.len()]
}

#[test]
fn holes_of_masks_agree_between_rays_and_maps() {
    let Some(folder) = std::env::var_os("LIXEL_SCENES").map(PathBuf::from) else {
        println!("skipped: LIXEL_SCENES not set");
        return;
    };
    let work = tempfile::tempdir().unwrap();
    for name in ["house_foliage/house.glb", "alpha_blend_mode/AlphaBlendModeTest.glb"] {
        let file = folder.join(name);
        if !file.exists() {
            continue;
        }
        let [masked, ignored, asked] = with_and_without_masks(&file, work.path());
        println!("{name}: {masked} of {asked} pixels wrong with the mask, {ignored} with it ignored");
        assert!(3 * masked < ignored, "{name}: {masked} wrong with the mask, {ignored} without");
    }
}
