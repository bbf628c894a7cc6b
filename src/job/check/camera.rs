//! `[camera]`: one way of saying where the camera is, and values that make a camera.

use super::{Problem, finite, nonzero, problem, require};
use crate::scene::CameraParams;

/// The part of a camera that a pose and a keyframe share.
struct Pose<'a> {
    key: &'a str,
    position: Option<[f64; 3]>,
    look_at: Option<[f64; 3]>,
    rotation: Option<[f64; 4]>,
    fov: Option<f64>,
    near: Option<f64>,
    far: Option<f64>,
}

pub(super) fn check(camera: &CameraParams) -> Result<(), Problem> {
    let posed = camera.position.is_some() || camera.look_at.is_some() || camera.rotation.is_some();
    let ways = [
        ("name", camera.name.is_some()),
        ("frame_all", camera.frame_all),
        ("position", posed),
        ("key", !camera.key.is_empty()),
    ];
    let mut given = ways.iter().filter(|w| w.1).map(|w| w.0);
    if let (Some(first), Some(second)) = (given.next(), given.next()) {
        let message = format!("`{first}` and `{second}` both say where the camera is");
        return Err(problem(format!("camera.{second}"), message, "keep one of them"));
    }
    if camera.name.as_deref() == Some("") {
        return Err(problem("camera.name", "the name is empty", "name a camera of the scene's files"));
    }
    let CameraParams { position, look_at, rotation, fov, near, far, .. } = *camera;
    if posed {
        placed("camera", position.is_some(), look_at.is_some(), rotation.is_some())?;
    }
    pose(&Pose { key: "camera", position, look_at, rotation, fov, near, far })?;
    keys(camera)
}

fn keys(camera: &CameraParams) -> Result<(), Problem> {
    let mut last = f64::NEG_INFINITY;
    for (i, k) in camera.key.iter().enumerate() {
        let key = format!("camera.key[{i}]");
        finite(&format!("{key}.frame"), &[k.frame])?;
        if k.frame <= last {
            let message = format!("frame {} does not come after frame {last} of the key before", k.frame);
            return Err(problem(format!("{key}.frame"), message, "write the keys in the order of their frames"));
        }
        last = k.frame;
        placed(&key, k.position.is_some(), k.look_at.is_some(), k.rotation.is_some())?;
        pose(&Pose {
            key: &key,
            position: k.position,
            look_at: k.look_at,
            rotation: k.rotation,
            fov: k.fov,
            near: k.near,
            far: k.far,
        })?;
    }
    Ok(())
}

/// A pose has a position and one way of looking.
fn placed(key: &str, position: bool, look_at: bool, rotation: bool) -> Result<(), Problem> {
    if !position {
        return Err(problem(format!("{key}.position"), "the camera has no position", "add `position = [x, y, z]`"));
    }
    match (look_at, rotation) {
        (true, true) => Err(problem(
            format!("{key}.rotation"),
            "`look_at` and `rotation` both say where the camera looks",
            "keep one of them",
        )),
        (false, false) => Err(problem(
            format!("{key}.look_at"),
            "nothing says where the camera looks",
            "add `look_at = [x, y, z]` or `rotation = [x, y, z, w]`",
        )),
        _ => Ok(()),
    }
}

fn pose(pose: &Pose) -> Result<(), Problem> {
    let key = |name: &str| format!("{}.{name}", pose.key);
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
        require(
            far > near && far.is_finite(),
            &key("far"),
            far,
            &format!("a finite number of metres above near = {near}; leave it away for none"),
        )?;
    }
    Ok(())
}
