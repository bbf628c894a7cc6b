//! Files → the model: each by its format, in its unit and axes, at its place.

use super::beside::{self, Reach};
use super::clip::Target;
use super::model::{Local, Model, Node, Tracks};
use super::names::list;
use super::{BlendRule, CameraParams, Projection, SceneError, SceneFile, ShotParams, camera_file, gltf, obj};
use std::path::Path;
use std::sync::Arc;

/// What a job says of the insides of its files.
struct Choice<'a> {
    active_scene: Option<&'a str>,
    blend: BlendRule,
    reach: Reach,
    met: gltf::ScenesMet,
}

/// Reads the files of a shot; with the camera where a file gives its keys.
///
/// # Errors
/// Those of the readers, [`SceneError::UnknownFormat`], [`SceneError::BadValue`] for a bad transform or another kind of
/// camera file, [`SceneError::ActiveScene`] for one that no file has.
pub(super) fn all(params: &ShotParams<'_>) -> Result<(Model, Option<CameraParams>), SceneError> {
    let mut model = Model::default();
    let mut choice = Choice {
        active_scene: params.active_scene,
        blend: params.visibility.blend,
        reach: if params.allow_outside { Reach::Anywhere } else { Reach::Folder },
        met: gltf::ScenesMet::default(),
    };
    for file in params.scene {
        scene(file, &mut choice, &mut model)?;
    }
    let path = camera(params.camera, &mut choice, &mut model)?;
    match params.active_scene.filter(|_| !choice.met.found) {
        None => Ok((model, path)),
        Some(name) => Err(SceneError::ActiveScene { name: name.to_owned(), known: list(&choice.met.names) }),
    }
}

/// Adds a scene file to the model, placed in the world, its distances in metres.
fn scene(file: &SceneFile, choice: &mut Choice<'_>, model: &mut Model) -> Result<(), SceneError> {
    let path = file.path();
    let Some(placed) = file.world_from_file()? else { return as_is(path, choice, model) };
    let (root, cameras, lights, clips) =
        (model.nodes.len(), model.cameras.len(), model.lights.len(), model.clips.len());
    model.nodes.push(Node {
        file: Arc::from(path),
        name: Some("the file".into()),
        index: 0,
        parent: None,
        local: Local::Matrix(placed),
        hidden: false,
        weights: None,
        tracks: Tracks::default(),
    });
    as_is(path, choice, model)?;
    for node in &mut model.nodes[root + 1..] {
        node.parent = node.parent.or(Some(root));
    }
    let metres = file.unit.metres();
    model.cameras[cameras..].iter_mut().for_each(|camera| camera.scale(metres));
    model.lights[lights..].iter_mut().for_each(|light| light.scale(metres));
    let is_distance = |target: Target| match target {
        Target::Lens(camera) => matches!(model.cameras[camera].projection, Projection::Orthographic { .. }),
        Target::Near(_) | Target::Far(_) | Target::Range(_) => true,
        // Translations are below the file's root, which is scaled.
        _ => false,
    };
    for (target, track) in model.clips[clips..].iter_mut().flat_map(|clip| &mut clip.channels) {
        if is_distance(*target) {
            track.scale(metres);
        }
    }
    Ok(())
}

fn as_is(path: &Path, choice: &mut Choice<'_>, model: &mut Model) -> Result<(), SceneError> {
    let bytes = beside::bytes(path).map_err(|source| SceneError::Read { path: path.to_owned(), source })?;
    model.inputs.push(path.to_owned());
    if is_gltf(path, &bytes) {
        gltf::read(path, &bytes, (choice.active_scene, choice.blend, choice.reach), &mut choice.met, model)
    } else if path.extension().is_some_and(|have| have.eq_ignore_ascii_case("obj")) {
        obj::read(path, &bytes, choice.blend, choice.reach, model)
    } else {
        Err(SceneError::UnknownFormat { path: path.to_owned() })
    }
}

fn is_gltf(path: &Path, bytes: &[u8]) -> bool {
    let ends_in = |ending: &str| path.extension().is_some_and(|have| have.eq_ignore_ascii_case(ending));
    gltf::is_glb(bytes) || ends_in("gltf") || ends_in("glb")
}

/// Reads `camera.file`: returns the camera with the file's keys, or makes a glTF file's cameras the only ones of the model,
/// where nothing else of it is kept but its animations.
fn camera(
    camera: &CameraParams,
    choice: &mut Choice<'_>,
    model: &mut Model,
) -> Result<Option<CameraParams>, SceneError> {
    let Some(path) = &camera.file else { return Ok(None) };
    let bytes = beside::bytes(path).map_err(|source| SceneError::Read { path: path.clone(), source })?;
    if is_gltf(path, &bytes) {
        model.cameras.clear();
        keep_channels(model, |target| !matches!(target, Target::Lens(_) | Target::Near(_) | Target::Far(_)));
        let (parts, lights) = (model.parts.len(), model.lights.len());
        model.inputs.push(path.clone());
        gltf::read(path, &bytes, (choice.active_scene, BlendRule::Opaque, choice.reach), &mut choice.met, model)?;
        model.parts.truncate(parts);
        model.lights.truncate(lights);
        keep_channels(model, |target| match target {
            Target::Range(light) | Target::Cone(light) => light < lights,
            _ => true,
        });
        return Ok(None);
    }
    let order = camera.rotation_order.unwrap_or_default();
    let keys = camera_file::keys(path, &bytes, order).ok_or_else(|| {
        SceneError::bad_value("camera.file", path, "must be a .chan, .json, .csv, .gltf or .glb file")
    })??;
    model.inputs.push(path.clone());
    Ok(Some(CameraParams { key: keys, file: None, ..camera.clone() }))
}

/// Drops the channels whose camera or light is gone.
fn keep_channels(model: &mut Model, keep: impl Fn(Target) -> bool) {
    for clip in &mut model.clips {
        clip.channels.retain(|&(target, _)| keep(target));
    }
}
