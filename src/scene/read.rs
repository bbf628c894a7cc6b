//! Files → the model: each by its format, in its unit and axes, at its place.

use super::model::{Local, Model, Node, Tracks};
use super::{BlendRule, CameraParams, SceneError, SceneFile, camera_file, gltf, obj};
use std::path::Path;
use std::sync::Arc;

/// Adds a scene file to the model, placed in the world, its distances in metres.
///
/// # Errors
/// Those of the readers, [`SceneError::UnknownFormat`], [`SceneError::BadValue`] for a bad transform.
pub(super) fn scene(file: &SceneFile, blend: BlendRule, model: &mut Model) -> Result<(), SceneError> {
    let path = file.path();
    let Some(placed) = file.world_from_file()? else { return as_is(path, blend, model) };
    let (root, cameras, lights) = (model.nodes.len(), model.cameras.len(), model.lights.len());
    model.nodes.push(Node {
        file: Arc::from(path),
        name: Some("the file".into()),
        index: 0,
        parent: None,
        local: Local::Matrix(placed),
        tracks: Tracks::default(),
    });
    as_is(path, blend, model)?;
    for node in &mut model.nodes[root + 1..] {
        node.parent = node.parent.or(Some(root));
    }
    let metres = file.unit.metres();
    model.cameras[cameras..].iter_mut().for_each(|camera| camera.scale(metres));
    model.lights[lights..].iter_mut().for_each(|light| light.scale(metres));
    Ok(())
}

fn as_is(path: &Path, blend: BlendRule, model: &mut Model) -> Result<(), SceneError> {
    let bytes = std::fs::read(path).map_err(|source| SceneError::Read { path: path.to_owned(), source })?;
    model.inputs.push(path.to_owned());
    if is_gltf(path, &bytes) {
        gltf::read(path, bytes, blend, model)
    } else if path.extension().is_some_and(|have| have.eq_ignore_ascii_case("obj")) {
        obj::read(path, &bytes, blend, model)
    } else {
        Err(SceneError::UnknownFormat { path: path.to_owned() })
    }
}

fn is_gltf(path: &Path, bytes: &[u8]) -> bool {
    let ends_in = |ending: &str| path.extension().is_some_and(|have| have.eq_ignore_ascii_case(ending));
    gltf::is_glb(bytes) || ends_in("gltf") || ends_in("glb")
}

/// Reads `camera.file`: returns the camera with the file's keys, or makes a glTF file's cameras the only ones of the model,
/// where nothing else of it is kept.
///
/// # Errors
/// Those of the readers, [`SceneError::BadValue`] for another kind of file.
pub(super) fn camera(camera: &CameraParams, model: &mut Model) -> Result<Option<CameraParams>, SceneError> {
    let Some(path) = &camera.file else { return Ok(None) };
    let bytes = std::fs::read(path).map_err(|source| SceneError::Read { path: path.clone(), source })?;
    if is_gltf(path, &bytes) {
        model.cameras.clear();
        let (parts, lights) = (model.parts.len(), model.lights.len());
        model.inputs.push(path.clone());
        gltf::read(path, bytes, BlendRule::Opaque, model)?;
        model.parts.truncate(parts);
        model.lights.truncate(lights);
        return Ok(None);
    }
    let order = camera.rotation_order.unwrap_or_default();
    let keys = camera_file::keys(path, &bytes, order).ok_or_else(|| {
        SceneError::bad_value("camera.file", path, "must be a .chan, .json, .csv, .gltf or .glb file")
    })??;
    model.inputs.push(path.clone());
    Ok(Some(CameraParams { key: keys, file: None, ..camera.clone() }))
}
