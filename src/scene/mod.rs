//! Files → an immutable, fully resolved [`Scene`]; `Scene::frame(t)` → camera, lights, moving triangles.
//!
//! Readers (`gltf/`, `obj`, called by `read`) fill a `model`; `camera_source`, `light_source` and `frames` settle what the
//! job leaves open; `clip` chooses the animations that play; `split` poses the model at all frames and tells still from
//! moving parts, `rig` says where the vertices of a part are (nodes, instances, skins, morph targets), `bake` chooses the
//! origin and makes triangles; `shot` runs the stage.
//!
//! After this stage there are no nodes, no accessors, no units, no keyframes: only triangles in scene space.

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
mod gltf;
mod image;
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
mod track;

pub use camera::{Camera, Film, Projection};
pub use error::SceneError;
pub use file::{LengthUnit, SceneFile, UpAxis};
pub use frames::{FrameTime, parse_range};
pub use light::{Light, LightKind};
pub use marks::{Mark, Marks};
pub use mask::{AlphaImage, Cutout, Mask, Wrap};
pub use params::{
    BlendRule, CameraKey, CameraParams, FramesParams, ImageParams, KeyInterpolation, LightKindName, LightParams,
    RotationOrder, VisibilityParams, VisibilitySource,
};
pub use shot::{Scene, Shot, ShotParams, ShownByImages, load};

use glam::{DVec3, Vec3};

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
}

/// The triangles of one frame: the still ones of the shot, then the moving ones. A triangle's index counts through both.
#[derive(Clone, Copy, Debug)]
pub struct Geometry<'a> {
    /// Triangles that never move during the shot.
    pub still: &'a [Triangle],
    /// Triangles posed for this frame.
    pub moving: &'a [Triangle],
    /// Of the still and of the moving triangles.
    pub marks: [&'a Marks; 2],
    /// Masks of the triangles with holes.
    pub masks: &'a [Mask],
}

/// Of plain triangles.
static PLAIN: Marks = Marks::new();

impl<'a> Geometry<'a> {
    /// Triangles without holes, single-sided where that matters.
    pub fn plain(still: &'a [Triangle], moving: &'a [Triangle]) -> Self {
        Geometry { still, moving, marks: [&PLAIN; 2], masks: &[] }
    }

    /// The marks of the list that a triangle is in, and its index there.
    fn in_list(&self, index: u32) -> (&'a Marks, u32) {
        match (index as usize).checked_sub(self.still.len()) {
            None => (self.marks[0], index),
            Some(moving) => (self.marks[1], moving as u32),
        }
    }

    /// Triangles with holes, ascending.
    pub fn cut(&self) -> impl Iterator<Item = u32> {
        let still = self.still.len() as u32;
        self.marks[0].cut().iter().copied().chain(self.marks[1].cut().iter().map(move |&k| still + k))
    }

    /// The holes of a triangle and their mask.
    #[inline]
    pub fn cutout(&self, index: u32) -> Option<(&'a Cutout, &'a Mask)> {
        let (marks, index) = self.in_list(index);
        let cutout = marks.cutout(index)?;
        Some((cutout, self.masks.get(cutout.mask as usize)?))
    }

    /// True for a triangle that is drawn from both sides even where a renderer leaves out fronts or backs.
    pub fn two_sided(&self, index: u32) -> bool {
        let (marks, index) = self.in_list(index);
        marks.two_sided(index)
    }

    /// Number of triangles.
    pub fn len(&self) -> usize {
        self.still.len() + self.moving.len()
    }

    /// True when there is no triangle.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The triangle with an index below [`Geometry::len`].
    pub fn triangle(&self, index: u32) -> Triangle {
        let index = index as usize;
        if index < self.still.len() { self.still[index] } else { self.moving[index - self.still.len()] }
    }

    /// The same vertices in f64.
    pub fn triangle_f64(&self, index: u32) -> [DVec3; 3] {
        self.triangle(index).map(|v| v.as_dvec3())
    }
}
