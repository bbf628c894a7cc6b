//! What the readers of files hand over: nodes, meshes, cameras, lights and animations of all files of a job in one
//! [`Model`]. Nothing here is resolved yet; names may clash, and nothing has been chosen.

use super::clip::Clip;
use super::marks::Marks;
use super::mask::Mask;
use super::track::{Track, unit_quat};
use super::{Projection, SceneError};
use glam::{DAffine3, DQuat, DVec3};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Everything read so far.
#[derive(Debug, Default)]
pub(super) struct Model {
    /// Parents before children.
    pub nodes: Vec<Node>,
    /// Referenced by index from `parts`.
    pub meshes: Vec<Mesh>,
    /// Referenced by index from `parts`.
    pub skins: Vec<Skin>,
    /// Node-from-instance of repeated parts, referenced by index from `parts`.
    pub instances: Vec<DAffine3>,
    /// Meshes placed by nodes.
    pub parts: Vec<Part>,
    /// Of the marks of meshes.
    pub masks: Vec<Mask>,
    /// In file order.
    pub cameras: Vec<FileCamera>,
    /// In file order.
    pub lights: Vec<FileLight>,
    /// Animations of all files, in file order; none plays until one is chosen.
    pub clips: Vec<Clip>,
    /// Every file read.
    pub inputs: Vec<PathBuf>,
    /// Remarks for the user.
    pub notes: Vec<String>,
}

/// A transform in the hierarchy.
#[derive(Debug)]
pub(super) struct Node {
    /// The file that holds it.
    pub file: Arc<Path>,
    /// As in the file.
    pub name: Option<String>,
    /// Index in the file, for messages.
    pub index: usize,
    /// Index into [`Model::nodes`], less than the node's own.
    pub parent: Option<usize>,
    /// At rest.
    pub local: Local,
    /// True when the node and all below it are neither seen nor cast shadows, at rest.
    pub hidden: bool,
    /// Weights of the morph targets of its mesh at rest; `None` = those of the mesh.
    pub weights: Option<Vec<f64>>,
    /// What the animation changes.
    pub tracks: Tracks,
}

/// Parent-from-node at rest.
#[derive(Debug)]
pub(super) enum Local {
    /// Given as a matrix; cannot be animated.
    Matrix(DAffine3),
    /// Scale, then rotation, then translation.
    Trs {
        /// Parent space.
        translation: DVec3,
        /// Unit.
        rotation: DQuat,
        /// Along the node's axes; may be negative.
        scale: DVec3,
    },
}

/// Animated properties of a node.
#[derive(Debug, Default)]
pub(super) struct Tracks {
    /// Replaces the translation.
    pub translation: Option<Track>,
    /// Replaces the rotation.
    pub rotation: Option<Track>,
    /// Replaces the scale.
    pub scale: Option<Track>,
    /// Visible where not 0; replaces `!hidden`.
    pub visible: Option<Track>,
    /// By morph target: replaces its weight.
    pub weights: BTreeMap<usize, Track>,
}

impl Tracks {
    /// True when neither the node's transform nor its visibility is animated.
    pub(super) fn is_still(&self) -> bool {
        self.translation.is_none() && self.rotation.is_none() && self.scale.is_none() && self.visible.is_none()
    }
}

impl Node {
    /// For messages.
    pub(super) fn place(&self) -> String {
        place("node", self.index, self.name.as_deref())
    }

    /// Parent-from-node at a time.
    pub(super) fn parent_from_node(&self, time_s: f64) -> Result<DAffine3, SceneError> {
        let (translation, rotation, scale) = match self.local {
            Local::Matrix(matrix) => return Ok(matrix),
            Local::Trs { translation, rotation, scale } => (translation, rotation, scale),
        };
        let moved = |track: &Option<Track>, rest| track.as_ref().map_or(rest, |t| t.sample_vec3(time_s));
        let rotation = match &self.tracks.rotation {
            None => rotation,
            Some(track) => unit_quat(track.sample(time_s))
                .ok_or_else(|| self.pose_error("the animated rotation has no length; fix its keys", time_s))?,
        };
        Ok(DAffine3::from_scale_rotation_translation(
            moved(&self.tracks.scale, scale),
            rotation,
            moved(&self.tracks.translation, translation),
        ))
    }

    /// True when the node itself hides what is below it at a time.
    pub(super) fn hides(&self, time_s: f64) -> bool {
        self.tracks.visible.as_ref().map_or(self.hidden, |track| track.sample(time_s).x == 0.0)
    }

    /// A [`SceneError::Pose`] at this node.
    pub(super) fn pose_error(&self, problem: &str, time_s: f64) -> SceneError {
        SceneError::Pose { path: self.file.to_path_buf(), place: self.place(), problem: problem.into(), time_s }
    }
}

/// A thing in a file, for messages: `node 4 "lamp"`.
pub(super) fn place(kind: &str, index: usize, name: Option<&str>) -> String {
    name.map_or_else(|| format!("{kind} {index}"), |name| format!("{kind} {index} {name:?}"))
}

/// Indexed triangles in the space of a node. Vertices are finite, indices valid; no triangle has zero area, unless the
/// mesh deforms.
#[derive(Debug, Default)]
pub(super) struct Mesh {
    /// f64: OBJ files of surveys hold world coordinates that f32 loses.
    pub vertices: Vec<DVec3>,
    /// Counter-clockwise from the front.
    pub triangles: Vec<[u32; 3]>,
    /// Of the triangles.
    pub marks: Marks,
    /// Morph targets: vertices by index, each once, with what full weight adds to them.
    pub targets: Vec<Vec<(u32, DVec3)>>,
    /// Weights of the targets at rest, one each.
    pub rest_weights: Vec<f64>,
    /// Joints that move each vertex; `None` for a mesh without.
    pub influences: Option<Influences>,
}

/// The joints of each vertex, by index into [`Skin::joints`]. The weights of a vertex are positive and sum to 1.
#[derive(Debug, Default)]
pub(super) struct Influences {
    /// Where each vertex's entries end; they begin where those of the vertex before end.
    pub ends: Vec<usize>,
    /// Joint and weight. A vertex without any moves with its node.
    pub entries: Vec<(u16, f64)>,
}

impl Influences {
    /// Entries of a vertex.
    pub(super) fn of(&self, vertex: usize) -> &[(u16, f64)] {
        let begin = vertex.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.entries[begin..self.ends[vertex]]
    }
}

/// Joints that bend meshes.
#[derive(Debug)]
pub(super) struct Skin {
    /// Indices into [`Model::nodes`].
    pub joints: Vec<usize>,
    /// Joint-from-mesh at bind time, one a joint.
    pub inverse_bind: Vec<DAffine3>,
}

/// A mesh placed by a node.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    /// Index into [`Model::nodes`].
    pub node: usize,
    /// Index into [`Model::meshes`].
    pub mesh: usize,
    /// Index into [`Model::skins`]; the vertices then follow the joints, not the node.
    pub skin: Option<usize>,
    /// Index into [`Model::instances`].
    pub instance: Option<usize>,
}

/// A camera of a file.
#[derive(Debug)]
pub(super) struct FileCamera {
    /// Index into [`Model::nodes`].
    pub node: usize,
    /// Of the camera itself.
    pub name: Option<String>,
    /// Vertical.
    pub projection: Projection,
    /// Width over height, where the file says.
    pub aspect: Option<f64>,
    /// Metres.
    pub near: f64,
    /// Metres; `None` = infinite.
    pub far: Option<f64>,
    /// What the animation changes.
    pub tracks: CameraTracks,
}

/// Animated properties of a camera.
#[derive(Clone, Debug, Default)]
pub(super) struct CameraTracks {
    /// Vertical field of view, radians, or half height, metres: whichever the projection has.
    pub lens: Option<Track>,
    /// Metres.
    pub near: Option<Track>,
    /// Metres.
    pub far: Option<Track>,
}

/// A light of a file.
#[derive(Debug)]
pub(super) struct FileLight {
    /// Index into [`Model::nodes`]; it shines along the node's -z.
    pub node: usize,
    /// Of the light itself.
    pub name: Option<String>,
    /// Without its placement.
    pub kind: FileLightKind,
    /// What the animation changes.
    pub tracks: LightTracks,
}

/// Animated properties of a light.
#[derive(Clone, Debug, Default)]
pub(super) struct LightTracks {
    /// Metres.
    pub range: Option<Track>,
    /// Half angle, radians.
    pub cone_rad: Option<Track>,
}

impl FileCamera {
    /// Its distances in units of `metres`.
    pub(super) fn scale(&mut self, metres: f64) {
        self.near *= metres;
        self.far = self.far.map(|far| far * metres);
        if let Projection::Orthographic { half_height } = &mut self.projection {
            *half_height *= metres;
        }
    }
}

impl FileLight {
    /// Its distances in units of `metres`.
    pub(super) fn scale(&mut self, metres: f64) {
        match &mut self.kind {
            FileLightKind::Directional => {}
            FileLightKind::Point { range } | FileLightKind::Spot { range, .. } => {
                *range = range.map(|range| range * metres);
            }
        }
    }
}

/// Kinds of KHR_lights_punctual.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum FileLightKind {
    /// Parallel.
    Directional,
    /// All around.
    Point {
        /// Metres.
        range: Option<f64>,
    },
    /// A cone.
    Spot {
        /// Half angle, radians.
        cone_rad: f64,
        /// Metres.
        range: Option<f64>,
    },
}
