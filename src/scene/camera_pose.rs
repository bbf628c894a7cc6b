//! Cameras that the job describes: one pose, keyframes of poses, or a view of everything.
//!
//! Each property (position, look_at or rotation, fov, near, far) is a track of its own through those keys that state
//! it, straight, smooth or in steps; a key that does not state it leaves it alone. `[camera]` itself supplies the properties that no key states.

use super::camera_source::DEFAULT_FOV_DEG;
use super::frames::time_s;
use super::surroundings::Surroundings;
use super::track::{Interpolation, Track, unit_quat};
use super::{Camera, CameraKey, CameraParams, Projection, SceneError};
use glam::{DMat3, DVec3, DVec4};

/// Near plane of a pose that states none, relative to the scene's diagonal: nothing of note is that near to a camera,
/// and with an infinite far plane 24-bit depth still resolves 6e-5 of the distance at one diagonal.
const NEAR_OF_DIAGONAL: f64 = 1e-3;

/// Azimuth (from +z towards +x) and elevation of the view of everything, degrees: the classic three-quarter view.
const FRAME_ALL_DEG: (f64, f64) = (35.0, 25.0);

/// Share by which near and far planes of the view of everything keep clear of the scene: far more than f32 rounding.
const FRAME_ALL_SLACK: f64 = 1e-3;

/// A camera of the job, in world space.
#[derive(Clone, Debug)]
pub(super) struct PosedCamera {
    name: &'static str,
    position: Track,
    aim: Aim,
    fov_deg: Track,
    near: Track,
    far: Option<Track>,
}

#[derive(Clone, Debug)]
enum Aim {
    LookAt(Track),
    Rotation(Track),
}

/// Builds the tracks of `[camera]` and `[[camera.key]]`.
///
/// # Errors
/// [`SceneError::BadValue`] naming the key.
pub(super) fn posed(params: &CameraParams, fps: f64, around: &Surroundings) -> Result<PosedCamera, SceneError> {
    let keys = sorted_keys(params)?;
    let stated = |name: &str, base: bool, of: &dyn Fn(&CameraKey) -> bool| -> Option<String> {
        let key = params.key.iter().position(of).map(|k| format!("camera.key[{k}].{name}"));
        key.or_else(|| base.then(|| format!("camera.{name}")))
    };
    let look_at = stated("look_at", params.look_at.is_some(), &|key| key.look_at.is_some());
    let rotation = stated("rotation", params.rotation.is_some(), &|key| key.rotation.is_some());
    let aim = match (look_at, rotation) {
        (Some(_), None) => Aim::LookAt(points("look_at", params.look_at, &keys, fps, |key| key.look_at)?),
        (None, Some(_)) => Aim::Rotation(rotations(params.rotation, &keys, fps)?),
        (Some(_), Some(key)) => {
            return Err(SceneError::bad_key(key, "clashes with look_at, which says the same; keep one of them"));
        }
        (None, None) => {
            let problem = "missing; a camera pose needs look_at = [x, y, z] (or rotation = [x, y, z, w])";
            return Err(SceneError::bad_key("camera.look_at", problem));
        }
    };
    let angle = |v: f64| v > 0.0 && v < 180.0;
    let distance = |v: f64| v > 0.0 && v.is_finite();
    let fov_deg = scalars("fov", params.fov, &keys, fps, |key| key.fov, angle, "must lie between 0 and 180 degrees")?;
    let metres = "must be positive, metres";
    let near = scalars("near", params.near, &keys, fps, |key| key.near, distance, metres)?;
    let far = scalars("far", params.far, &keys, fps, |key| key.far, distance, metres)?;
    let how = params.interpolation.unwrap_or_default();
    let aim = match aim {
        Aim::LookAt(track) => Aim::LookAt(track.running(how)),
        Aim::Rotation(track) => Aim::Rotation(track.running(how)),
    };
    Ok(PosedCamera {
        name: "camera",
        position: points("position", params.position, &keys, fps, |key| key.position)?.running(how),
        aim,
        fov_deg: fov_deg.map_or_else(|| constant(DEFAULT_FOV_DEG), |track| track.running(how)),
        near: near.map_or_else(|| constant(NEAR_OF_DIAGONAL * around.diagonal), |track| track.running(how)),
        far: far.map(|track| track.running(how)),
    })
}

/// A three-quarter view into which the bounding sphere of the first frame just fits. Near and far planes enclose what
/// is there at any frame.
///
/// # Errors
/// [`SceneError::BadValue`] for a field of view outside (0, 180).
pub(super) fn frame_all(params: &CameraParams, aspect: f64, around: &Surroundings) -> Result<PosedCamera, SceneError> {
    let fov_deg = params.fov.unwrap_or(DEFAULT_FOV_DEG);
    if !(fov_deg > 0.0 && fov_deg < 180.0) {
        return Err(SceneError::bad_value("camera.fov", fov_deg, "must lie between 0 and 180 degrees"));
    }
    let half_y = 0.5 * fov_deg.to_radians();
    let half_x = (half_y.tan() * aspect).atan();
    let distance = around.radius / half_y.min(half_x).sin();
    let (azimuth, elevation) = (FRAME_ALL_DEG.0.to_radians(), FRAME_ALL_DEG.1.to_radians());
    let towards_camera = DVec3::new(azimuth.sin() * elevation.cos(), elevation.sin(), azimuth.cos() * elevation.cos());
    let near = (distance - around.reach) * (1.0 - FRAME_ALL_SLACK);
    let far = (distance + around.reach) * (1.0 + FRAME_ALL_SLACK);
    Ok(PosedCamera {
        name: "frame_all",
        position: Track::constant((around.centre + towards_camera * distance).extend(0.0)),
        aim: Aim::LookAt(Track::constant(around.centre.extend(0.0))),
        fov_deg: constant(fov_deg),
        near: constant(params.near.unwrap_or(near.max(NEAR_OF_DIAGONAL * around.diagonal))),
        far: Some(constant(params.far.unwrap_or(far))),
    })
}

impl PosedCamera {
    /// The camera in scene space at a time.
    ///
    /// # Errors
    /// [`SceneError::BadValue`] when it looks at itself, or near is not before far.
    pub(super) fn at(&self, origin: DVec3, time_s: f64) -> Result<Camera, SceneError> {
        let position = self.position.sample_vec3(time_s);
        let world_from_camera = match &self.aim {
            Aim::Rotation(track) => unit_quat(track.sample(time_s)).map(DMat3::from_quat).ok_or_else(|| {
                SceneError::bad_value("camera.rotation", track.sample(time_s), "has no length; add a key in between")
            })?,
            Aim::LookAt(track) => {
                let target = track.sample_vec3(time_s);
                let problem = "is where the camera stands; move one of them";
                looking_along(target - position)
                    .ok_or_else(|| SceneError::bad_value("camera.look_at", target.to_array(), problem))?
            }
        };
        let near = self.near.sample(time_s).x;
        let far = self.far.as_ref().map(|far| far.sample(time_s).x);
        if let Some(far) = far.filter(|&far| far.is_nan() || far <= near) {
            let problem = format!("must be beyond the near plane, which is at {near} m");
            return Err(SceneError::bad_value("camera.far", far, problem));
        }
        let projection = Projection::Perspective { yfov_rad: self.fov_deg.sample(time_s).x.to_radians() };
        Ok(Camera { name: self.name.into(), position: position - origin, world_from_camera, projection, near, far })
    }
}

/// Right, up, backward for a view direction with y up; straight up or down, right is +x. `None` without a direction.
fn looking_along(direction: DVec3) -> Option<DMat3> {
    let forward = direction.try_normalize()?;
    let right = forward.cross(DVec3::Y).try_normalize().unwrap_or(DVec3::X);
    Some(DMat3::from_cols(right, right.cross(forward), -forward))
}

/// Keys in the order of their frames, with their places in the job.
fn sorted_keys(params: &CameraParams) -> Result<Vec<(usize, &CameraKey)>, SceneError> {
    let mut keys: Vec<(usize, &CameraKey)> = params.key.iter().enumerate().collect();
    if let Some((k, key)) = keys.iter().find(|(_, key)| !key.frame.is_finite()) {
        return Err(SceneError::bad_value(format!("camera.key[{k}].frame"), key.frame, "must be a number"));
    }
    keys.sort_by(|a, b| a.1.frame.total_cmp(&b.1.frame));
    if let Some(pair) = keys.windows(2).find(|pair| pair[0].1.frame == pair[1].1.frame) {
        let problem = "two keys at the same frame; remove one";
        return Err(SceneError::bad_value(format!("camera.key[{}].frame", pair[1].0), pair[1].1.frame, problem));
    }
    Ok(keys)
}

/// The track of one property; `None` when it is stated nowhere.
fn track<V: Copy>(
    name: &str,
    base: Option<V>,
    keys: &[(usize, &CameraKey)],
    fps: f64,
    of: impl Fn(&CameraKey) -> Option<V>,
    check: impl Fn(String, V) -> Result<DVec4, SceneError>,
) -> Result<Option<Track>, SceneError> {
    let mut times_s = Vec::new();
    let mut values = Vec::new();
    for (k, key) in keys {
        if let Some(value) = of(key) {
            times_s.push(time_s(key.frame, fps));
            values.push(check(format!("camera.key[{k}].{name}"), value)?);
        }
    }
    if values.is_empty() {
        let Some(base) = base else { return Ok(None) };
        return Ok(Some(Track::constant(check(format!("camera.{name}"), base)?)));
    }
    Ok(Some(Track { times_s, values, interpolation: Interpolation::Linear, rotation: false }))
}

fn points(
    name: &str,
    base: Option<[f64; 3]>,
    keys: &[(usize, &CameraKey)],
    fps: f64,
    of: impl Fn(&CameraKey) -> Option<[f64; 3]>,
) -> Result<Track, SceneError> {
    let check = |key: String, value: [f64; 3]| {
        let point = DVec3::from_array(value);
        let finite = point.is_finite().then(|| point.extend(0.0));
        finite.ok_or_else(|| SceneError::bad_value(key, value, "must be three finite numbers, metres"))
    };
    let missing = || SceneError::bad_key(format!("camera.{name}"), "missing; a camera pose needs it: [x, y, z]");
    track(name, base, keys, fps, of, check)?.ok_or_else(missing)
}

fn rotations(base: Option<[f64; 4]>, keys: &[(usize, &CameraKey)], fps: f64) -> Result<Track, SceneError> {
    let check = |key: String, value: [f64; 4]| {
        let unit = unit_quat(DVec4::from_array(value)).map(DVec4::from);
        unit.ok_or_else(|| SceneError::bad_value(key, value, "must be a quaternion [x, y, z, w] with a length"))
    };
    let missing = || SceneError::bad_key("camera.rotation", "missing; a camera pose needs it: [x, y, z, w]");
    let found = track("rotation", base, keys, fps, |key| key.rotation, check)?.ok_or_else(missing)?;
    Ok(Track { rotation: true, ..found })
}

fn scalars(
    name: &str,
    base: Option<f64>,
    keys: &[(usize, &CameraKey)],
    fps: f64,
    of: impl Fn(&CameraKey) -> Option<f64>,
    valid: impl Fn(f64) -> bool,
    problem: &str,
) -> Result<Option<Track>, SceneError> {
    let check = |key: String, value: f64| {
        valid(value).then(|| scalar(value)).ok_or_else(|| SceneError::bad_value(key, value, problem))
    };
    track(name, base, keys, fps, of, check)
}

fn scalar(value: f64) -> DVec4 {
    DVec4::new(value, 0.0, 0.0, 0.0)
}

fn constant(value: f64) -> Track {
    Track::constant(scalar(value))
}

#[cfg(test)]
mod tests {
    use super::super::KeyInterpolation;
    use super::*;

    fn around() -> Surroundings {
        Surroundings { centre: DVec3::new(1.0, 2.0, 3.0), radius: 2.0, reach: 3.0, diagonal: 4.0 }
    }

    #[test]
    fn look_at_keeps_y_up_and_the_horizon_level() {
        let m = looking_along(DVec3::new(1.0, -0.5, -2.0)).unwrap();
        assert!(m.x_axis.y.abs() < 1e-15 && m.y_axis.y > 0.0);
        assert!((m.determinant() - 1.0).abs() < 1e-14);
        let down = looking_along(-DVec3::Y).unwrap();
        assert_eq!([down.x_axis, down.y_axis, down.z_axis], [DVec3::X, -DVec3::Z, DVec3::Y]);
        assert!(looking_along(DVec3::ZERO).is_none());
    }

    #[test]
    fn keys_interpolate_each_property_on_its_own() {
        let key = |frame, x: Option<f64>, fov| CameraKey {
            frame,
            position: x.map(|x| [x, 0.0, 0.0]),
            fov,
            ..CameraKey::default()
        };
        let params = CameraParams {
            look_at: Some([0.0, 0.0, -100.0]),
            key: vec![key(25.0, Some(4.0), None), key(13.0, None, Some(50.0)), key(1.0, Some(0.0), Some(30.0))],
            ..CameraParams::default()
        };
        let camera = posed(&params, 24.0, &around()).unwrap();
        let at = |frame: f64| camera.at(DVec3::new(0.0, 0.0, 1.0), time_s(frame, 24.0)).unwrap();
        assert!(at(7.0).position.abs_diff_eq(DVec3::new(1.0, 0.0, -1.0), 1e-14));
        assert_eq!(at(7.0).projection, Projection::Perspective { yfov_rad: 40.0_f64.to_radians() });
        assert_eq!(at(99.0).projection, Projection::Perspective { yfov_rad: 50.0_f64.to_radians() });
        assert_eq!((at(1.0).near, at(1.0).far), (0.004, None));
    }

    #[test]
    fn keys_run_as_the_job_says() {
        let key = |frame: f64, x: f64, turn: f64| CameraKey {
            frame,
            position: Some([x, 0.0, 0.0]),
            rotation: Some(glam::DQuat::from_rotation_y(turn).to_array()),
            ..CameraKey::default()
        };
        let keys = [key(1.0, 0.0, 0.0), key(2.0, 1.0, 1.0), key(4.0, 9.0, 3.0), key(5.0, 16.0, 4.0)];
        let at = |how: KeyInterpolation, frame: f64| {
            let params = CameraParams { key: keys.to_vec(), interpolation: Some(how), ..CameraParams::default() };
            let camera = posed(&params, 24.0, &around()).unwrap().at(DVec3::ZERO, time_s(frame, 24.0)).unwrap();
            let forward = camera.forward();
            (camera.position.x, (-forward.x).atan2(-forward.z))
        };
        assert_eq!(at(KeyInterpolation::Constant, 3.9).0, 1.0);
        assert!((at(KeyInterpolation::Linear, 3.0).0 - 5.0).abs() < 1e-12);
        // x = (frame - 1)² has its own slopes at inner keys; the chord from neighbour to neighbour has 3 and 5 here.
        let (x, turn) = at(KeyInterpolation::CatmullRom, 3.0);
        assert!((x - (5.0 + 2.0 * (3.0 - 5.0) / 8.0)).abs() < 1e-12, "{x}");
        assert!((turn - 2.0).abs() < 0.02, "{turn}");
        for (how, key) in [(KeyInterpolation::CatmullRom, 1), (KeyInterpolation::Constant, 2)] {
            assert!((at(how, keys[key].frame).0 - keys[key].position.unwrap()[0]).abs() < 1e-12);
        }
    }

    #[test]
    fn the_view_of_everything_just_holds_the_sphere() {
        for (aspect, params) in [(16.0 / 9.0, CameraParams::default()), (0.5, CameraParams::default())] {
            let around = around();
            let camera = frame_all(&params, aspect, &around).unwrap().at(DVec3::ZERO, 0.0).unwrap();
            let Projection::Perspective { yfov_rad } = camera.projection else { panic!("{camera:?}") };
            let to_centre = around.centre - camera.position;
            assert!((to_centre.normalize() - camera.forward()).length() < 1e-14);
            let half = if aspect < 1.0 { ((0.5 * yfov_rad).tan() * aspect).atan() } else { 0.5 * yfov_rad };
            assert!((to_centre.length() * half.sin() - around.radius).abs() < 1e-12);
            assert!(camera.near > 0.0 && camera.far.unwrap() >= to_centre.length() + around.reach);
        }
    }

    #[test]
    fn bad_keys_are_named() {
        let pose = CameraParams { position: Some([0.0; 3]), look_at: Some([1.0; 3]), ..CameraParams::default() };
        let error = |params: &CameraParams| match posed(params, 24.0, &around()) {
            Ok(camera) => camera.at(DVec3::ZERO, 0.0).unwrap_err().to_string(),
            Err(error) => error.to_string(),
        };
        let both = CameraParams { rotation: Some([0.0, 0.0, 0.0, 1.0]), ..pose.clone() };
        assert!(error(&both).contains("camera.rotation"));
        assert!(error(&CameraParams { look_at: None, ..pose.clone() }).contains("camera.look_at"));
        assert!(error(&CameraParams { position: None, ..pose.clone() }).contains("camera.position"));
        assert!(error(&CameraParams { look_at: Some([0.0; 3]), ..pose.clone() }).contains("camera.look_at"));
        assert!(error(&CameraParams { fov: Some(180.0), ..pose.clone() }).contains("camera.fov = 180"));
        assert!(error(&CameraParams { near: Some(-1.0), ..pose.clone() }).contains("camera.near"));
        assert!(error(&CameraParams { near: Some(2.0), far: Some(1.0), ..pose.clone() }).contains("camera.far"));
        let key = CameraKey { frame: 1.0, position: Some([f64::NAN; 3]), ..CameraKey::default() };
        assert!(error(&CameraParams { key: vec![key.clone()], ..pose.clone() }).contains("camera.key[0].position"));
        let twice = CameraParams { key: vec![CameraKey { position: None, ..key }; 2], ..pose };
        assert!(error(&twice).contains("camera.key[1].frame"));
    }
}
