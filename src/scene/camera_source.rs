//! Which camera a shot has, and where it is at a time.

use super::camera_pose::{PosedCamera, frame_all, posed};
use super::model::{CameraTracks, Model, Node};
use super::names::{Found, did_you_mean, find, list, name_all};
use super::pose::{Pose, orthonormal_rotation};
use super::surroundings::Surroundings;
use super::track::Track;
use super::{Camera, CameraParams, Projection, SceneError};
use glam::DVec3;
use std::f64::consts::PI;

/// Vertical field of view where the job says nothing, degrees.
pub(super) const DEFAULT_FOV_DEG: f64 = 45.0;

const REMEDY: &str = "choose one with --camera NAME or [camera] name, or give [camera] frame_all = true, or position \
                      and look_at";

/// The camera of the shot.
#[derive(Clone, Debug)]
pub(super) enum CameraSource {
    /// Held by a node.
    Node {
        /// As in the file.
        name: String,
        /// Index into the model's nodes.
        node: usize,
        /// With the job's field of view where it gives one.
        projection: Projection,
        /// Metres.
        near: f64,
        /// Metres.
        far: Option<f64>,
        /// Width over height, where the file says.
        aspect: Option<f64>,
        /// What the animation changes; nothing that the job states.
        tracks: Box<CameraTracks>,
    },
    /// Described by the job.
    Posed(Box<PosedCamera>),
    /// In world space, each for its time, seconds.
    PerFrame(Vec<(f64, Camera)>),
}

/// Resolves `[camera]`. `aspect` is that of the film when the camera has no say in it.
///
/// # Errors
/// [`SceneError::Camera`] for no camera, several, or an unknown name; [`SceneError::BadValue`] for bad keys.
pub(super) fn choose(
    params: &CameraParams,
    model: &Model,
    fps: f64,
    aspect: f64,
    around: &Surroundings,
) -> Result<CameraSource, SceneError> {
    let is_pose =
        params.position.is_some() || params.look_at.is_some() || params.rotation.is_some() || !params.key.is_empty();
    if params.frame_all && (is_pose || params.name.is_some()) {
        let problem = "leaves no choice; remove it, or name, position, look_at, rotation and keys";
        return Err(SceneError::bad_value("camera.frame_all", true, problem));
    }
    if let Some(name) = params.name.as_deref().filter(|_| is_pose) {
        let problem =
            "is a camera of a file, which has its own pose; remove it, or position, look_at, rotation and keys";
        return Err(SceneError::bad_value("camera.name", name, problem));
    }
    if params.frame_all {
        return Ok(CameraSource::Posed(Box::new(frame_all(params, aspect, around)?)));
    }
    if is_pose {
        return Ok(CameraSource::Posed(Box::new(posed(params, fps, around)?)));
    }
    from_file(params, model)
}

fn from_file(params: &CameraParams, model: &Model) -> Result<CameraSource, SceneError> {
    let own = model.cameras.iter().map(|camera| (&model.nodes[camera.node], camera.name.as_deref()));
    let names = name_all("camera", own);
    let fail = |problem: String| SceneError::Camera { problem, known: list(&names), remedy: REMEDY };
    let index = match &params.name {
        Some(name) => match find(&names, name) {
            Found::One(index) => index,
            Found::None => return Err(fail(format!("no camera is named {name:?}{}", did_you_mean(&names, name)))),
            Found::Several => return Err(fail(format!("several cameras are named {name:?}"))),
        },
        None if names.is_empty() => return Err(fail("no camera to plan for".into())),
        None if names.len() > 1 => return Err(fail(format!("{} cameras, and none is chosen", names.len()))),
        None => 0,
    };
    let camera = &model.cameras[index];
    let projection = match (camera.projection, params.fov) {
        (projection, None) => projection,
        (Projection::Perspective { .. }, Some(fov)) if fov > 0.0 && fov < 180.0 => {
            Projection::Perspective { yfov_rad: fov.to_radians() }
        }
        (Projection::Perspective { .. }, Some(fov)) => {
            return Err(SceneError::bad_value("camera.fov", fov, "must lie between 0 and 180 degrees"));
        }
        (Projection::Orthographic { .. }, Some(fov)) => {
            return Err(SceneError::bad_value("camera.fov", fov, "an orthographic camera has none; remove it"));
        }
    };
    let near = params.near.unwrap_or(camera.near);
    let far = params.far.or(camera.far);
    if near.is_nan() || near < 0.0 || params.near == Some(0.0) {
        return Err(SceneError::bad_value("camera.near", near, "must be positive, metres"));
    }
    if let Some(far) = far.filter(|&far| far.is_nan() || far <= near) {
        let problem = format!("must be beyond the near plane, which is at {near} m");
        return Err(SceneError::bad_value("camera.far", far, problem));
    }
    let name = names[index].unique.clone();
    let mut tracks = camera.tracks.clone();
    let unstated = |given: Option<f64>, track: Option<Track>| track.filter(|_| given.is_none());
    tracks.lens = unstated(params.fov, tracks.lens);
    tracks.near = unstated(params.near, tracks.near);
    tracks.far = unstated(params.far, tracks.far);
    Ok(CameraSource::Node {
        name,
        node: camera.node,
        projection,
        near,
        far,
        aspect: camera.aspect,
        tracks: Box::new(tracks),
    })
}

/// Projection, near and far plane at a time, or what is wrong with them.
fn lens_at(
    rest: Projection,
    near: f64,
    far: Option<f64>,
    tracks: &CameraTracks,
    time_s: f64,
) -> Result<(Projection, f64, Option<f64>), String> {
    let at = |track: &Option<Track>| track.as_ref().map(|track| track.sample(time_s).x);
    let wrong = |what: &str, value: f64| format!("the animated {what} of its camera is {value}; fix its keys");
    let projection = match (rest, at(&tracks.lens)) {
        (rest, None) => rest,
        (Projection::Perspective { .. }, Some(yfov_rad)) if yfov_rad > 0.0 && yfov_rad < PI => {
            Projection::Perspective { yfov_rad }
        }
        (Projection::Perspective { .. }, Some(yfov)) => return Err(wrong("yfov", yfov)),
        (Projection::Orthographic { .. }, Some(half_height)) if half_height > 0.0 && half_height.is_finite() => {
            Projection::Orthographic { half_height }
        }
        (Projection::Orthographic { .. }, Some(ymag)) => return Err(wrong("ymag", ymag)),
    };
    let near = at(&tracks.near).unwrap_or(near);
    let far = at(&tracks.far).or(far);
    let may_be_zero = matches!(projection, Projection::Orthographic { .. });
    if !(near > 0.0 || near == 0.0 && may_be_zero) {
        return Err(wrong("znear", near));
    }
    match far.filter(|&far| far.is_nan() || far <= near) {
        Some(far) => Err(format!("the animated zfar of its camera, {far}, is not beyond znear, {near}; fix the keys")),
        None => Ok((projection, near, far)),
    }
}

impl CameraSource {
    /// Width over height, where the file says.
    pub(super) fn aspect(&self) -> Option<f64> {
        match self {
            CameraSource::Node { aspect, .. } => *aspect,
            CameraSource::Posed(_) | CameraSource::PerFrame(_) => None,
        }
    }

    /// The camera in scene space, given the nodes' pose at a time. A node's camera has its node's translation and the
    /// orthonormalised rotation of its world matrix.
    ///
    /// # Errors
    /// [`SceneError::Pose`] when the node's matrix is singular or the animated lens makes no sense; [`SceneError::BadValue`] from the job's poses.
    pub(super) fn at(&self, nodes: &[Node], pose: &Pose, origin: DVec3, time_s: f64) -> Result<Camera, SceneError> {
        match self {
            CameraSource::Posed(posed) => posed.at(origin, time_s),
            CameraSource::PerFrame(cameras) => {
                let found = cameras.iter().find(|(time, _)| *time == time_s).map(|(_, camera)| camera);
                let camera = found.ok_or_else(|| {
                    SceneError::bad_key("frames.range", format!("no image of the shot is at t = {time_s} s"))
                })?;
                Ok(Camera { position: camera.position - origin, ..camera.clone() })
            }
            CameraSource::Node { name, node, projection, near, far, tracks, .. } => {
                let world = &pose.world_from_node[*node];
                let world_from_camera = orthonormal_rotation(world.matrix3).ok_or_else(|| {
                    nodes[*node].pose_error("the camera has no orientation, an axis is scaled to 0", time_s)
                })?;
                let (projection, near, far) = lens_at(*projection, *near, *far, tracks, time_s)
                    .map_err(|problem| nodes[*node].pose_error(&problem, time_s))?;
                let position = world.translation - origin;
                Ok(Camera { name: name.clone(), position, world_from_camera, projection, near, far })
            }
        }
    }
}
