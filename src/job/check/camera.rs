//! `[camera]`: one way of saying where the camera is, and values that make a camera.
//!
//! A key of `[camera]` holds wherever no `[[camera.key]]` states the same; a keyframe may state any of them.

use super::{Problem, finite, nonzero, problem, require};
use crate::job::is_scene_file;
use crate::scene::{CameraKey, CameraParams};

pub(super) fn check(camera: &CameraParams) -> Result<(), Problem> {
    one_way(camera)?;
    if camera.name.as_deref() == Some("") {
        return Err(problem("camera.name", "the name is empty", "name a camera of the scene's files"));
    }
    let CameraParams { position, look_at, rotation, fov, near, far, .. } = *camera;
    values("camera", &CameraKey { frame: 0.0, position, look_at, rotation, fov, near, far })?;
    for (i, key) in camera.key.iter().enumerate() {
        let at = format!("camera.key[{i}]");
        finite(&format!("{at}.frame"), &[key.frame])?;
        if camera.key[..i].iter().any(|k| k.frame == key.frame) {
            let message = format!("frame {} has a key already", key.frame);
            return Err(problem(format!("{at}.frame"), message, "keep one of the two"));
        }
        values(&at, key)?;
    }
    Ok(())
}

/// A name, a view of everything, or a pose: and a pose has a position and one way of looking.
fn one_way(camera: &CameraParams) -> Result<(), Problem> {
    let stated = |own: bool, in_key: &dyn Fn(&CameraKey) -> bool| own || camera.key.iter().any(in_key);
    let position = stated(camera.position.is_some(), &|k| k.position.is_some());
    let look_at = stated(camera.look_at.is_some(), &|k| k.look_at.is_some());
    let rotation = stated(camera.rotation.is_some(), &|k| k.rotation.is_some());
    let posed = position || look_at || rotation || !camera.key.is_empty();
    if camera.file.is_none() && camera.rotation_order.is_some() {
        return Err(problem(
            "camera.rotation_order",
            "there is no .chan file to read",
            "remove it, or name one in `file`",
        ));
    }
    let path = camera.file.as_deref().filter(|file| !is_scene_file(file));
    if let Some(path) = path {
        let known = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
        if !matches!(known.as_deref(), Some("chan" | "json" | "csv")) {
            let message = format!("`{}` is not a camera file", path.display());
            return Err(problem("camera.file", message, "name a .chan, .json, .csv, .gltf or .glb file"));
        }
    }
    let ways = [
        // A file of cameras may hold several: a name says which.
        ("file", path.is_some() || camera.file.is_some() && camera.name.is_none()),
        ("name", camera.name.is_some()),
        ("frame_all", camera.frame_all),
        (if camera.key.is_empty() { "position" } else { "key" }, posed),
    ];
    let mut given = ways.iter().filter(|w| w.1).map(|w| w.0);
    if let (Some(first), Some(second)) = (given.next(), given.next()) {
        let message = format!("`{first}` and `{second}` both say where the camera is");
        return Err(problem(format!("camera.{second}"), message, "keep one of them"));
    }
    if !posed {
        return Ok(());
    }
    if !position {
        return Err(problem("camera.position", "the camera has no position", "add `position = [x, y, z]`"));
    }
    match (look_at, rotation) {
        (true, true) => Err(problem(
            "camera.rotation",
            "`look_at` and `rotation` both say where the camera looks",
            "keep one of them, for all keys",
        )),
        (false, false) => Err(problem(
            "camera.look_at",
            "nothing says where the camera looks",
            "add `look_at = [x, y, z]` or `rotation = [x, y, z, w]`",
        )),
        _ => Ok(()),
    }
}

/// The ranges of values, wherever they stand.
fn values(at: &str, pose: &CameraKey) -> Result<(), Problem> {
    let key = |name: &str| format!("{at}.{name}");
    if let Some(position) = pose.position {
        finite(&key("position"), &position)?;
    }
    if let Some(target) = pose.look_at {
        finite(&key("look_at"), &target)?;
        if pose.position == pose.look_at {
            return Err(problem(key("look_at"), "the camera looks at its own position", "choose another point"));
        }
    }
    if let Some(rotation) = pose.rotation {
        nonzero(&key("rotation"), &rotation)?;
    }
    if let Some(fov) = pose.fov {
        require(fov > 0.0 && fov < 180.0, &key("fov"), fov, "above 0 and below 180 degrees")?;
    }
    if let Some(near) = pose.near {
        require(near > 0.0 && near.is_finite(), &key("near"), near, "a finite number of metres above 0")?;
    }
    if let Some(far) = pose.far {
        let near = pose.near.unwrap_or(0.0);
        let allowed = format!("a finite number of metres above near = {near}; without the key there is no far plane");
        require(far > near && far.is_finite(), &key("far"), far, &allowed)?;
    }
    Ok(())
}
