//! KHR_animation_pointer: JSON pointers of the glTF 2.0 Asset Object Model → what they drive.

use super::accessor::Source;
use super::document::entry;
use crate::scene::SceneError;

/// A property that an animation of a file drives. Indices are those of the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Property {
    /// Of a node.
    Translation(usize),
    /// Of a node.
    Rotation(usize),
    /// Of a node.
    Scale(usize),
    /// Of a node, KHR_node_visibility.
    Visible(usize),
    /// All morph weights of a node.
    NodeWeights(usize),
    /// One morph weight of a node.
    NodeWeight(usize, usize),
    /// All morph weights of a mesh, for nodes that state none.
    MeshWeights(usize),
    /// One morph weight of a mesh.
    MeshWeight(usize, usize),
    /// Of a perspective camera.
    YFov(usize),
    /// Of an orthographic camera.
    YMag(usize),
    /// Of a camera of either type.
    ZNear(usize),
    /// Of a camera of either type.
    ZFar(usize),
    /// Of a light.
    Range(usize),
    /// Of a light.
    OuterConeAngle(usize),
}

/// The property that a pointer names; `None` for one that moves no geometry, camera or light.
///
/// # Errors
/// [`SceneError::Malformed`] for an index beyond what the file has.
pub(super) fn resolve(source: Source<'_>, at: &str, pointer: &str) -> Result<Option<Property>, SceneError> {
    let document = source.document;
    let steps: Vec<&str> = pointer.split('/').skip(1).collect();
    let (kind, index, path) = match steps.as_slice() {
        ["nodes", index, path @ ..] => ("node", index, path),
        ["meshes", index, path @ ..] => ("mesh", index, path),
        ["cameras", index, path @ ..] => ("camera", index, path),
        ["extensions", "KHR_lights_punctual", "lights", index, path @ ..] => ("light", index, path),
        _ => return Ok(None),
    };
    let Ok(index) = index.parse::<usize>() else { return Ok(None) };
    let property = match (kind, path) {
        ("node", ["translation"]) => Property::Translation(index),
        ("node", ["rotation"]) => Property::Rotation(index),
        ("node", ["scale"]) => Property::Scale(index),
        ("node", ["extensions", "KHR_node_visibility", "visible"]) => Property::Visible(index),
        ("node", ["weights"]) => Property::NodeWeights(index),
        ("mesh", ["weights"]) => Property::MeshWeights(index),
        (_, ["weights", target]) => match (kind, target.parse()) {
            ("node", Ok(target)) => Property::NodeWeight(index, target),
            ("mesh", Ok(target)) => Property::MeshWeight(index, target),
            _ => return Ok(None),
        },
        ("camera", ["perspective", "yfov"]) => Property::YFov(index),
        ("camera", ["orthographic", "ymag"]) => Property::YMag(index),
        ("camera", ["perspective" | "orthographic", "znear"]) => Property::ZNear(index),
        ("camera", ["perspective" | "orthographic", "zfar"]) => Property::ZFar(index),
        ("light", ["range"]) => Property::Range(index),
        ("light", ["spot", "outerConeAngle"]) => Property::OuterConeAngle(index),
        _ => return Ok(None),
    };
    let at = format!("{at}, {pointer}");
    match kind {
        "node" => entry(source.path, &at, kind, &document.nodes, index).map(drop)?,
        "mesh" => entry(source.path, &at, kind, &document.meshes, index).map(drop)?,
        "camera" => entry(source.path, &at, kind, &document.cameras, index).map(drop)?,
        _ => entry(source.path, &at, kind, &document.extensions.lights.lights, index).map(drop)?,
    }
    // A camera has the properties of its own type only.
    let is_of_type = |path: &str| document.cameras.get(index).is_some_and(|camera| camera.kind == path);
    Ok(Some(property).filter(|_| kind != "camera" || path.first().is_some_and(|path| is_of_type(path))))
}

/// A pointer with its indices replaced by `*`, to list many alike in one note.
pub(super) fn pattern(pointer: &str) -> String {
    let step = |step: &str| {
        let is_index = !step.is_empty() && step.bytes().all(|byte| byte.is_ascii_digit());
        if is_index { "*".to_owned() } else { step.to_owned() }
    };
    pointer.split('/').map(step).collect::<Vec<_>>().join("/")
}
