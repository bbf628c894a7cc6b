//! Files and parameters → a [`Shot`]: the scene, the film and the frames to plan.

use super::bake::{self, Placed, place_part};
use super::camera_source::{self, CameraSource};
use super::clip;
use super::frames::{self, DEFAULT_FPS, FrameTime};
use super::instance::Shared;
use super::light_source::{self, LightSource};
use super::marks::Marks;
use super::mask::Mask;
use super::model::{Mesh, Model, Node, Part, Skin};
use super::pose::Pose;
use super::rig::Rig;
use super::split::{self, Split};
use super::surroundings::Surroundings;
use super::{
    Camera, CameraParams, FILM_PIXELS_MAX, Film, FramesParams, Geometry, ImageParams, Instance, LightParams,
    SceneError, SceneFile, SceneFrame, SharedMesh, Triangle, VisibilityParams, read,
};
use glam::{DAffine3, DVec3};
use std::path::PathBuf;

/// Width of the film where the job gives no size, pixels.
const DEFAULT_WIDTH: u32 = 1920;
/// Width over height of the film where neither job nor camera say.
const DEFAULT_ASPECT: f64 = 16.0 / 9.0;
/// Least width over height of a film that a camera's own aspect gives: a number in a file may not ask for any memory.
const NARROWEST: f64 = 0.125;
/// Longest side of a film, pixels: 16 bits, as in most image formats.
const MAX_SIDE: u32 = 65_535;

/// The parts of a job that describe a shot.
#[derive(Clone, Copy, Debug)]
pub struct ShotParams<'a> {
    /// Scene files, their paths resolved; merged into one scene.
    pub scene: &'a [SceneFile],
    /// `active_scene`: of glTF files that hold several; `None` = each file's default.
    pub active_scene: Option<&'a str>,
    /// `animation`: names of the animations that play; `None` = all that go together.
    pub animation: Option<&'a [String]>,
    /// `[frames]`.
    pub frames: &'a FramesParams,
    /// `[image]`.
    pub image: &'a ImageParams,
    /// `[camera]`, its path resolved.
    pub camera: &'a CameraParams,
    /// `[[light]]`.
    pub lights: &'a [LightParams],
    /// `[visibility]`.
    pub visibility: &'a VisibilityParams,
    /// `allow_outside`: scene files may name files outside their own folders.
    pub allow_outside: bool,
    /// What a renderer's images show instead of the scene's triangles.
    pub images: Option<ShownByImages<'a>>,
}

/// What is taken from a renderer's images: the scene's triangles are not looked at, only its cameras and lights.
#[derive(Clone, Copy, Debug)]
pub struct ShownByImages<'a> {
    /// World-space cameras of the frames, in their order; empty where the images have none or the job states one.
    pub cameras: &'a [Camera],
    /// The files of the images.
    pub files: &'a [PathBuf],
}

/// Without triangles, what a camera that the job describes is told of the scene's size, metres.
const SIZE_UNKNOWN_M: f64 = 10.0;

/// What is to be planned.
#[derive(Debug)]
pub struct Shot {
    /// Immutable from here on.
    pub scene: Scene,
    /// The image of every frame.
    pub film: Film,
    /// In the order of the range, each frame once, at least one.
    pub frames: Vec<FrameTime>,
}

/// Everything there is, in scene space. Still and moving are told apart by the frames of the shot it was loaded for.
#[derive(Debug)]
pub struct Scene {
    /// World position of scene space's zero, metres. Zero unless the scene lies far out for its size.
    pub origin: DVec3,
    /// Triangles that never move during the shot.
    pub still: Vec<Triangle>,
    /// Of the still triangles.
    pub still_marks: Marks,
    /// Shared meshes that never move during the shot.
    pub still_instances: Vec<Instance>,
    /// Masks of the triangles with holes.
    pub masks: Vec<Mask>,
    /// Every file read: each scene file as given, followed by its buffers.
    pub inputs: Vec<PathBuf>,
    /// Remarks for the user, each once: what was ignored or dropped.
    pub notes: Vec<String>,
    /// Names of the animations that play.
    pub animations: Vec<String>,
    pub(super) shared: Shared,
    nodes: Vec<Node>,
    meshes: Vec<Mesh>,
    skins: Vec<Skin>,
    instances: Vec<DAffine3>,
    moving: Vec<Part>,
    animated: Vec<usize>,
    first: Pose,
    camera: CameraSource,
    lights: Vec<LightSource>,
}

/// Reads the files and settles camera, lights, frames and film.
///
/// # Errors
/// Any [`SceneError`]: unreadable or broken files, features not supported yet, an unsettled choice of camera, lights,
/// animations or glTF scene, keys that make no sense, transforms that break at some frame of the shot.
pub fn load(params: &ShotParams<'_>) -> Result<Shot, SceneError> {
    let (mut model, path) = read::all(params)?;
    if let Some(images) = &params.images {
        model.parts.clear();
        model.inputs.extend_from_slice(images.files);
    }
    let params = &ShotParams { camera: path.as_ref().unwrap_or(params.camera), ..*params };
    let played = clip::play(params.animation, &mut model)?;
    let fps = params.frames.fps.unwrap_or(DEFAULT_FPS);
    if !(fps > 0.0 && fps.is_finite()) {
        return Err(SceneError::bad_value("frames.fps", fps, "must be positive"));
    }
    let frames = frame_times(params, played.last_key_s, fps)?;
    let lights = light_source::choose(params.lights, &model)?;

    let split = split::split(&model, &frames)?;
    let origin = if split.bounds.is_empty() { DVec3::ZERO } else { bake::origin(&split.bounds) };
    let first_s = frames.first().map_or(0.0, |frame| frame.time_s);
    let moving_may_be_there = split.moving.iter().any(|part| !model.meshes[part.mesh].triangles.is_empty());
    check_count(&model, &split)?;
    let shared = Shared::take(&mut model, [&split.still, &split.moving], params.visibility.instances);
    let still = bake_still(&mut model, &shared, &split, origin, first_s)?;
    let moving = placed(Rig::of(&model), &shared, &split.moving, &split.first, origin, first_s)?;
    // Moving parts may have none at the first frame only.
    let without = still.triangles.is_empty() && still.instances.is_empty() && !moving_may_be_there;
    if without && params.images.is_none() {
        let files: Vec<String> = params.scene.iter().map(|file| file.path().display().to_string()).collect();
        return Err(SceneError::NoTriangles { files: files.join(", ") });
    }
    let around = match params.images {
        None => Surroundings::of(&[&still, &moving], &shared, &split.bounds, origin),
        Some(_) => {
            let (centre, radius) = (DVec3::ZERO, SIZE_UNKNOWN_M / 2.0);
            Surroundings { centre, radius, reach: radius, diagonal: SIZE_UNKNOWN_M }
        }
    };
    drop(moving);
    let film_of_poses = film(params.image, None)?;
    let camera = match params.images.filter(|images| !images.cameras.is_empty()) {
        Some(images) => {
            let times = frames.iter().map(|frame| frame.time_s);
            CameraSource::PerFrame(times.zip(images.cameras.iter().cloned()).collect())
        }
        None => camera_source::choose(params.camera, &model, fps, film_of_poses.aspect(), &around)?,
    };
    let film = film(params.image, camera.aspect())?;

    let Model { nodes, mut meshes, skins, instances, masks, inputs, notes, .. } = model;
    let mut kept = vec![false; meshes.len()];
    for part in &split.moving {
        kept[part.mesh] = true;
    }
    for (mesh, _) in meshes.iter_mut().zip(kept).filter(|(_, kept)| !kept) {
        *mesh = Mesh::default();
    }
    let Split { moving, animated, first, .. } = split;
    let scene = Scene {
        origin,
        still: still.triangles,
        still_marks: still.marks,
        still_instances: still.instances,
        shared,
        masks,
        inputs,
        notes,
        animations: played.names,
        nodes,
        meshes,
        skins,
        instances,
        moving,
        animated,
        first,
        camera,
        lights,
    };
    Ok(Shot { scene, film, frames })
}

impl Scene {
    /// Camera, lights and moving triangles at a time of one of the shot's frames. (At other times parts that happen to
    /// stand still at all frames stay where they are.) Triangles that lose their area at that time are left out, as are
    /// parts and lights that are hidden then.
    ///
    /// # Errors
    /// [`SceneError::Pose`] when a transform breaks at that time, [`SceneError::BadValue`] when a pose of the job does.
    pub fn frame(&self, time_s: f64) -> Result<SceneFrame, SceneError> {
        let mut pose = self.first.clone();
        pose.move_to(&self.nodes, self.animated.iter().copied(), time_s)?;
        let camera = self.camera.at(&self.nodes, &pose, self.origin, time_s)?;
        let light = |light: &LightSource| light.at(&self.nodes, &pose, self.origin, time_s);
        let lights = self.lights.iter().filter(|light| light.is_on(&pose)).map(light).collect::<Result<_, _>>()?;
        let rig = Rig { nodes: &self.nodes, meshes: &self.meshes, skins: &self.skins, instances: &self.instances };
        let Placed { triangles: moving, marks: moving_marks, instances: moving_instances, .. } =
            placed(rig, &self.shared, &self.moving, &pose, self.origin, time_s)?;
        Ok(SceneFrame { time_s, camera, lights, moving, moving_marks, moving_instances })
    }

    /// Meshes of instances, still and moving.
    pub fn shared_meshes(&self) -> &[SharedMesh] {
        &self.shared.meshes
    }

    /// All triangles of a frame.
    pub fn geometry<'a>(&'a self, frame: &'a SceneFrame) -> Geometry<'a> {
        Geometry::of(self, frame)
    }
}

/// The frames of the range, or of the whole animation: that of the files and the camera's keys.
fn frame_times(params: &ShotParams<'_>, last_key_s: Option<f64>, fps: f64) -> Result<Vec<FrameTime>, SceneError> {
    let numbers = match &params.frames.range {
        Some(range) => frames::parse_range(range)?,
        None => {
            let keys = params.camera.key.iter().map(|key| frames::time_s(key.frame, fps));
            let last_s = keys.fold(last_key_s.unwrap_or(0.0), f64::max);
            frames::whole_animation(last_s, fps)?
        }
    };
    Ok(numbers.into_iter().map(|frame| FrameTime { frame, time_s: frames::time_s(frame as f64, fps) }).collect())
}

/// Triangles are numbered in u32 from here on.
fn check_count(model: &Model, split: &Split) -> Result<(), SceneError> {
    let limit = u64::from(u32::MAX);
    let parts = split.still.iter().chain(&split.moving);
    let triangles = parts.map(|part| model.meshes[part.mesh].triangles.len() as u64).sum::<u64>();
    if triangles > limit { Err(SceneError::TooManyTriangles { triangles, limit }) } else { Ok(()) }
}

/// Places all still parts, and notes what was dropped.
fn bake_still(
    model: &mut Model,
    shared: &Shared,
    split: &Split,
    origin: DVec3,
    time_s: f64,
) -> Result<Placed, SceneError> {
    let still = placed(Rig::of(model), shared, &split.still, &split.first, origin, time_s)?;
    if still.dropped > 0 {
        let dropped = still.dropped;
        model.notes.push(format!("{dropped} triangles dropped that have no area once placed and rounded to f32"));
    }
    if origin != DVec3::ZERO {
        model.notes.push(format!("the scene lies far out for its size; scene space has its zero at world {origin}"));
    }
    Ok(still)
}

/// The triangles and instances of parts.
fn placed(
    rig: Rig<'_>,
    shared: &Shared,
    parts: &[Part],
    pose: &Pose,
    origin: DVec3,
    time_s: f64,
) -> Result<Placed, SceneError> {
    let listed = parts.iter().filter(|part| shared.of(part).is_none());
    let count = listed.map(|part| rig.mesh(part).triangles.len() as u64).sum::<u64>();
    let mut placed = Placed::default();
    if placed.triangles.try_reserve_exact(count as usize).is_err() {
        return Err(SceneError::TooManyTriangles { triangles: count, limit: u64::from(u32::MAX) });
    }
    for part in parts {
        place_part(rig, shared, part, pose, origin, time_s, &mut placed)?;
    }
    placed.number();
    Ok(placed)
}

/// The film: as the job says, else 1920 wide at the camera's aspect.
fn film(image: &ImageParams, aspect: Option<f64>) -> Result<Film, SceneError> {
    if let Some([width, height]) = image.size {
        if width == 0 || height == 0 || width > MAX_SIDE || height > MAX_SIDE {
            let problem = format!("width and height must lie between 1 and {MAX_SIDE} pixels");
            return Err(SceneError::bad_value("image.size", [width, height], problem));
        }
        if u64::from(width) * u64::from(height) > FILM_PIXELS_MAX {
            let problem = format!("must be at most {FILM_PIXELS_MAX} pixels; render in tiles");
            return Err(SceneError::bad_value("image.size", [width, height], problem));
        }
        return Ok(Film { width, height });
    }
    let aspect = aspect.unwrap_or(DEFAULT_ASPECT);
    if aspect < NARROWEST {
        let problem = format!("missing, and the camera's aspect ratio {aspect} makes no image; give width and height");
        return Err(SceneError::bad_key("image.size", problem));
    }
    let height = (f64::from(DEFAULT_WIDTH) / aspect).round().max(1.0);
    Ok(Film { width: DEFAULT_WIDTH, height: height as u32 })
}
