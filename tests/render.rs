//! Pictures of a frame: the files are there, their sizes are right, and the layers agree with what verify measures.

#![expect(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

mod watching;

use lixel::job::{self, LoadedJob};
use lixel::plan::{self, PlanError};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use watching::watched;

const WIDTH: usize = 160;
const HEIGHT: usize = 90;

fn courtyard() -> LoadedJob {
    let file = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/courtyard/courtyard.toml"));
    let over =
        format!("[image]\nsize = [{WIDTH}, {HEIGHT}]\n[map]\nmax = 512\nstep = 1.5\n[quality]\nepsilon = 0.05\n");
    job::load(file, &over.parse().unwrap()).unwrap()
}

fn png_size(path: &Path) -> (u32, u32) {
    let file = std::io::BufReader::new(std::fs::File::open(path).unwrap());
    let reader = png::Decoder::new(file).read_info().unwrap();
    (reader.info().width, reader.info().height)
}

/// Every channel of an EXR file.
fn channels(path: &Path) -> HashMap<String, Vec<f32>> {
    let image = exr::prelude::read_first_flat_layer_from_file(path).unwrap();
    let list = image.layer_data.channel_data.list;
    list.into_iter().map(|c| (c.name.to_string(), c.sample_data.values_as_f32().collect())).collect()
}

#[test]
fn the_layers_hold_what_verify_counts() {
    let loaded = courtyard();
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("made/for/it");
    let files = watched(|watch| plan::render(&loaded, 30, None, &out, watch)).unwrap();
    let named = |name: &str| out.join(name);
    for name in ["shaded.png", "sun.shadow.png", "sun.error.png", "spot.map.png", "lamp.map.0.png", "seen.exr"] {
        assert!(files.contains(&named(name)), "{name} is not among {files:?}");
    }
    assert_eq!(png_size(&named("shaded.png")), (WIDTH as u32, HEIGHT as u32));

    let mut planned = loaded.clone();
    planned.job.frames.range = Some("30".to_owned());
    let plan = watched(|watch| plan::make(&planned, &out, false, watch)).unwrap();
    let seen = channels(&named("seen.exr"));
    assert_eq!(seen["Z"].len(), WIDTH * HEIGHT);
    let count = |name: &str| seen[name].iter().filter(|v| **v > 0.0).count() as u64;
    for light in &plan.frames[0].lights {
        let channel = |layer: &str| format!("{}.{layer}", light.light);
        let measured = light.error.as_ref().unwrap().measured.as_ref().unwrap();
        let wrong = count(&channel("false_lit")) + count(&channel("false_shadow"));
        assert_eq!(wrong, measured.misclassified + measured.uncertain, "{}", light.light);
        assert_eq!(count(&channel("uncertain")), measured.uncertain);
        assert!(count(&channel("edge")) > 0 && count(&channel("shadow")) < count(&channel("faces")));
        for (k, map) in light.maps.iter().enumerate() {
            let number = if light.maps.len() > 1 { format!(".{k}") } else { String::new() };
            let depth = &channels(&named(&format!("{}.map{number}.exr", light.light)))["Z"];
            assert_eq!(depth.len() as u64, map.texels());
            assert!(depth.iter().all(|d| (0.0..=1.5).contains(d)) && depth.iter().any(|d| *d < 1.0));
        }
    }
    for (pixel, depth) in seen["Z"].iter().enumerate() {
        let normal = ["N.x", "N.y", "N.z"].map(|n| seen[n][pixel]);
        let length = normal.iter().map(|c| c * c).sum::<f32>().sqrt();
        let expected = if depth.is_finite() { 1.0 } else { 0.0 };
        assert!((length - expected).abs() < 1e-5, "{normal:?}");
    }
}

#[test]
fn one_light_can_be_asked_for_by_name() {
    let dir = tempfile::tempdir().unwrap();
    let render = |light| watched(|watch| plan::render(&courtyard(), 80, Some(light), dir.path(), watch));
    let files = render("spot").unwrap();
    let names: Vec<String> = files.iter().map(|f: &PathBuf| f.file_name().unwrap().to_string_lossy().into()).collect();
    assert_eq!(names, ["spot.shadow.png", "spot.error.png", "shaded.png", "seen.exr"], "unlit: there is no map");
    let error = render("moon").unwrap_err();
    assert!(matches!(error, PlanError::Scene(_)), "{error}");
    let text = error.to_string();
    assert!(text.contains("moon") && text.contains("sun"), "{text}");
}
