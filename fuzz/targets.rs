//! What is fuzzed: each reads bytes as a user's file of a kind, in a folder of its own, and must come back.

use lixel::job::load as load_job;
use lixel::plan::{Format, parse, to_text};
use lixel::scene::{
    CameraParams, FramesParams, ImageParams, LightKindName, LightParams, SceneError, ShotParams, VisibilityParams, load,
};
use std::path::Path;

/// A job file.
///
/// # Errors
/// What the user is told.
pub(crate) fn job(bytes: &[u8], folder: &Path) -> Result<(), String> {
    let file = folder.join("job.toml");
    std::fs::write(&file, bytes).map_err(|e| e.to_string())?;
    load_job(&file, &toml::Table::new()).map(drop).map_err(|e| e.to_string())
}

/// A glTF file: .glb by its first bytes, else .gltf.
///
/// # Errors
/// What the user is told.
pub(crate) fn gltf(bytes: &[u8], folder: &Path) -> Result<(), String> {
    scene(bytes, folder, if bytes.starts_with(b"glTF") { "scene.glb" } else { "scene.gltf" })
}

/// An OBJ file.
///
/// # Errors
/// What the user is told.
pub(crate) fn obj(bytes: &[u8], folder: &Path) -> Result<(), String> {
    scene(bytes, folder, "scene.obj")
}

fn scene(bytes: &[u8], folder: &Path, name: &str) -> Result<(), String> {
    let file = folder.join(name);
    std::fs::write(&file, bytes).map_err(|e| e.to_string())?;
    let sun = LightParams {
        name: "day".into(),
        kind: Some(LightKindName::Directional),
        direction: Some([0.1, -1.0, 0.2]),
        ..LightParams::default()
    };
    let read = || -> Result<(), SceneError> {
        let shot = load(&ShotParams {
            scene: &[file.as_path().into()],
            active_scene: None,
            animation: None,
            frames: &FramesParams { range: Some("1-3".into()), fps: None },
            image: &ImageParams::default(),
            camera: &CameraParams { frame_all: true, ..CameraParams::default() },
            lights: std::slice::from_ref(&sun),
            visibility: &VisibilityParams::default(),
            allow_outside: false,
        })?;
        shot.frames.iter().try_for_each(|time| shot.scene.frame(time.time_s).map(drop))
    };
    read().map_err(|e| e.to_string())
}

/// A plan file; what is read is written again and is then the same.
///
/// # Errors
/// What the user is told.
pub(crate) fn plan(bytes: &[u8], _folder: &Path) -> Result<(), String> {
    let text = std::str::from_utf8(bytes).map_err(|e| e.to_string())?;
    let format = if text.trim_start().starts_with('{') { Format::Json } else { Format::Toml };
    let plan = parse(text, format, Path::new("plan")).map_err(|e| e.to_string())?;
    let again = to_text(&plan, Format::Json).map_err(|e| e.to_string())?;
    let same = parse(&again, Format::Json, Path::new("plan")).map_err(|e| e.to_string())?;
    assert!(same == plan, "a plan changed on its way to a file and back");
    Ok(())
}
