//! What can be wrong with a renderer's images.

use std::path::PathBuf;

/// Every message names the file, the layer or key, the value met, and what to do about it.
#[derive(Debug, thiserror::Error)]
pub enum AovError {
    /// A file could not be read.
    #[error("{}: cannot be read: {source}; check [aov] file and the frame range", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's answer.
        source: std::io::Error,
    },
    /// Not an OpenEXR file, a broken one, or one of a kind that is not read.
    #[error("{}: {problem}", path.display())]
    Exr {
        /// The file.
        path: PathBuf,
        /// What is wrong, and the remedy.
        problem: String,
    },
    /// No file has a layer.
    #[error("{}: {key} = \"{layer}\": {problem}; layers there: {}", files.iter().map(|f| f.display().to_string()).collect::<Vec<_>>().join(", "), known.join(", "))]
    Layer {
        /// The files of the frame.
        files: Vec<PathBuf>,
        /// The key that names it.
        key: String,
        /// As asked for.
        layer: String,
        /// Missing, or of another number of channels.
        problem: String,
        /// Layers of the files, with their channels.
        known: Vec<String>,
    },
    /// Images of different sizes.
    #[error(
        "{}: the image is {}x{} pixels, {} wants {}x{}; render the layers at one size, and leave [image] size out or set it to that",
        path.display(), found[0], found[1], whose, wanted[0], wanted[1]
    )]
    Size {
        /// The file.
        path: PathBuf,
        /// Its display window, pixels.
        found: [u32; 2],
        /// What states the other size.
        whose: String,
        /// The other size, pixels.
        wanted: [u32; 2],
    },
    /// Pixels that hold no number.
    #[error(
        "{}: layer \"{layer}\": {count} pixels are {what}, the first at x = {}, y = {} from the top left; write numbers there",
        path.display(), at[0], at[1]
    )]
    Pixels {
        /// The file.
        path: PathBuf,
        /// The layer.
        layer: String,
        /// How many.
        count: usize,
        /// NaN, infinite, out of range.
        what: String,
        /// The first one.
        at: [usize; 2],
    },
    /// Neither images nor job have a camera.
    #[error(
        "{}: the header has neither worldToNDC nor worldToCamera, and the job no camera; give [camera] in the job (position and look_at, keys, a .chan file, or name with a scene that has one)",
        path.display()
    )]
    NoCamera {
        /// The file.
        path: PathBuf,
    },
    /// The header's camera makes no sense.
    #[error("{}: {problem}; or give [camera] in the job, which is taken instead", path.display())]
    Camera {
        /// The file.
        path: PathBuf,
        /// What is wrong, with the numbers.
        problem: String,
    },
    /// The positions do not lie where the camera sees them.
    #[error(
        "{}: layer \"{layer}\": the camera sees {off} of {of} points in other pixels than theirs, by {median_px:.1} pixels in the median; camera and points are of different worlds: check [aov] unit and up, the camera's frame, and that the points are in world space",
        path.display()
    )]
    Elsewhere {
        /// The file.
        path: PathBuf,
        /// The layer.
        layer: String,
        /// Points that are off.
        off: usize,
        /// Points.
        of: usize,
        /// Median distance, pixels.
        median_px: f64,
    },
    /// No frame to plan.
    #[error("[aov] file = \"{}\": {problem}", pattern.display())]
    Frames {
        /// As in the job.
        pattern: PathBuf,
        /// Why, and what to do.
        problem: String,
    },
}
