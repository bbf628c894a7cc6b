//! What can be wrong with scene files and the parts of a job that describe a shot.

use std::path::PathBuf;

/// Every message names the file or key, the value met, and what to do about it.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// A file could not be read.
    #[error("{}: cannot be read: {source}; check the path and its permissions", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's answer.
        source: std::io::Error,
    },
    /// The file's ending and first bytes belong to no known format.
    #[error("{}: neither glTF (.gltf, .glb) nor OBJ (.obj); convert it to one of these", path.display())]
    UnknownFormat {
        /// The file.
        path: PathBuf,
    },
    /// The file breaks the rules of its format.
    #[error("{}: {place}: {problem}", path.display())]
    Malformed {
        /// The file.
        path: PathBuf,
        /// The part of the file: "accessor 3", "node 4 \"lamp\"".
        place: String,
        /// What is wrong there, with the values met.
        problem: String,
    },
    /// The file is sound but needs what lixel cannot do.
    #[error("{}: not supported yet: {}", path.display(), features.join("; "))]
    Unsupported {
        /// The file.
        path: PathBuf,
        /// Each with the place where it is needed and the remedy.
        features: Vec<String>,
    },
    /// Node transforms overflow or divide by zero at some time of the shot.
    #[error("{}: {place}: {problem} at t = {time_s} s", path.display())]
    Pose {
        /// The file.
        path: PathBuf,
        /// The node.
        place: String,
        /// What is wrong there.
        problem: String,
        /// Seconds from the start of the animation.
        time_s: f64,
    },
    /// The files hold no triangle with an area.
    #[error("{files}: no triangles to cast or receive shadows; add a mesh with triangles to the scene")]
    NoTriangles {
        /// The scene's files, comma separated.
        files: String,
    },
    /// More triangles than a u32 can count, or than memory holds.
    #[error(
        "{triangles} triangles are too many (limit {limit}, or this machine's memory); split or simplify the scene"
    )]
    TooManyTriangles {
        /// Triangles, instances counted.
        triangles: u64,
        /// The most that can be addressed.
        limit: u64,
    },
    /// A key of the job holds a value that makes no sense.
    #[error("{key} = {value}: {problem}")]
    BadValue {
        /// Full key, as in `camera.key[2].fov` or `light "sun": direction`.
        key: String,
        /// As written.
        value: String,
        /// Why not, and what would do.
        problem: String,
    },
    /// A key of the job is missing where it is needed, or given where it means nothing.
    #[error("{key}: {problem}")]
    BadKey {
        /// Full key.
        key: String,
        /// What to add or remove.
        problem: String,
    },
    /// The choice of camera is not settled.
    #[error("{problem}; cameras in the scene: {known}; {remedy}")]
    Camera {
        /// No camera, several, unknown name.
        problem: String,
        /// Names, comma separated, or "none".
        known: String,
        /// What to add.
        remedy: &'static str,
    },
    /// The choice of lights is not settled.
    #[error("{problem}; lights in the scene: {known}; {remedy}")]
    Light {
        /// No light, unknown name, name used twice.
        problem: String,
        /// Names, comma separated, or "none".
        known: String,
        /// What to add.
        remedy: &'static str,
    },
    /// The choice of animations is not settled.
    #[error("{problem}; animations in the scene: {known}; {remedy}")]
    Animation {
        /// Unknown name.
        problem: String,
        /// Names, comma separated, or "none".
        known: String,
        /// What to add.
        remedy: &'static str,
    },
    /// The choice of a glTF scene is not settled.
    #[error(
        "active_scene: no glTF scene is named {name:?}; scenes in the files: {known}; choose one of these with --active-scene NAME, or leave the key out for each file's own default"
    )]
    ActiveScene {
        /// As written.
        name: String,
        /// Names, comma separated, or "none".
        known: String,
    },
    /// A frame range that cannot be read or is too long.
    #[error("frames.range = \"{range}\": {problem}")]
    FrameRange {
        /// As written.
        range: String,
        /// Why not, and what would do.
        problem: String,
    },
}

impl SceneError {
    /// A [`SceneError::BadValue`].
    pub(super) fn bad_value(key: impl Into<String>, value: impl std::fmt::Debug, problem: impl Into<String>) -> Self {
        SceneError::BadValue { key: key.into(), value: format!("{value:?}"), problem: problem.into() }
    }

    /// A [`SceneError::BadKey`].
    pub(super) fn bad_key(key: impl Into<String>, problem: impl Into<String>) -> Self {
        SceneError::BadKey { key: key.into(), problem: problem.into() }
    }
}
