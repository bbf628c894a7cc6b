//! Files → an immutable, fully resolved [`Scene`]; `Scene::frame(t)` → camera, lights, moving triangles.
//!
//! Readers (`gltf/`, `obj`, called by `read`) fill a `model`; `camera_source`, `light_source` and `frames` settle what the
//! job leaves open; `clip` chooses the animations that play; `split` poses the model at all frames and tells still from
//! moving parts, `rig` says where the vertices of a part are (nodes, instances, skins, morph targets), `bake` chooses the
//! origin and makes triangles, `surroundings` says how large they are together; `shot` runs the stage. `tasks` shares long
//! lists out to threads.
//!
//! After this stage there are no nodes, no accessors, no units, no keyframes: only triangles in scene space, listed, or made
//! on the spot from a mesh that is placed many times (`instance`).

mod bake;
mod beside;
mod camera;
mod camera_file;
mod camera_pose;
mod camera_source;
mod clip;
mod error;
mod file;
mod frames;
mod geometry;
mod gltf;
mod image;
mod instance;
mod light;
mod light_source;
mod marks;
mod mask;
mod mesh;
mod model;
mod mtl;
mod names;
mod obj;
mod params;
mod polygon;
mod pose;
mod read;
mod rig;
mod shot;
mod split;
mod surroundings;
mod tasks;
mod track;

pub use camera::{Camera, FILM_PIXELS_MAX, Film, FilmRays, Projection};
pub use error::SceneError;
pub use file::{LengthUnit, SceneFile, UpAxis};
pub use frames::{FrameTime, parse_range};
pub use geometry::{Geometry, Room, Run};
pub use instance::{Instance, SharedMesh};
pub use light::{Light, LightKind};
pub use marks::{Mark, Marks};
pub use mask::{AlphaImage, Cutout, Mask, Wrap};
pub use params::{
    BlendRule, CameraKey, CameraParams, FramesParams, ImageParams, InstanceRule, KeyInterpolation, LightKindName,
    LightParams, RotationOrder, VisibilityParams, VisibilitySource,
};
pub use shot::{Scene, Shot, ShotParams, ShownByImages, load};

use glam::Vec3;

/// Three vertices in scene space, metres. f32 is the precision of the files; everything computed from them is f64.
pub type Triangle = [Vec3; 3];

/// What one moment of the shot looks like.
#[derive(Clone, Debug)]
pub struct SceneFrame {
    /// Seconds from the start of the animation.
    pub time_s: f64,
    /// The camera at that time, in scene space.
    pub camera: Camera,
    /// The lights at that time, in scene space, in the order of the scene.
    pub lights: Vec<Light>,
    /// Triangles that move at some time of the shot, posed for this frame.
    pub moving: Vec<Triangle>,
    /// Of the moving triangles.
    pub moving_marks: Marks,
    /// Shared meshes that move rigidly, placed for this frame.
    pub moving_instances: Vec<Instance>,
}
