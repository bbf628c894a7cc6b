//! What can go wrong with a plan.

use std::io;
use std::path::PathBuf;

use thiserror::Error;

use super::{PartError, SCHEMA};
use crate::aov::AovError;
use crate::raster::RasterError;
use crate::scene::SceneError;

/// Why there is no plan, or no plan file.
#[derive(Debug, Error)]
pub enum PlanError {
    /// The files of the job, or what they hold.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A renderer's images, or what they hold.
    #[error(transparent)]
    Aov(#[from] AovError),
    /// Something that takes geometry was asked of a job that is planned from images.
    #[error(
        "the job is planned from a renderer's images (visibility.source = \"aov\"): there is no geometry to draw; take a job with source = \"scene\""
    )]
    NoGeometry,
    /// Several frames would overwrite one file.
    #[error("{}: {frames} frames cannot go into one file; put #### where the frame number goes", pattern.display())]
    Pattern {
        /// As given.
        pattern: PathBuf,
        /// Frames of the job.
        frames: usize,
    },
    /// A map that cannot be drawn.
    #[error(transparent)]
    Raster(#[from] RasterError),
    /// A part of a shot, or what parts do not come to.
    #[error(transparent)]
    Part(#[from] PartError),
    /// Frames that a renderer does not show one after the other.
    #[error(
        "lookup.temporal = \"reprojection\" needs consecutive frames, and frame {after} follows frame {before}: plan every \
         frame of frames.range, or set lookup.temporal = \"none\""
    )]
    NotConsecutive {
        /// A frame, by number.
        before: i64,
        /// The next one planned.
        after: i64,
    },
    /// The caller asked to stop.
    #[error("interrupted")]
    Cancelled,
    /// A number that JSON cannot carry; a fault of lixel, not of the input.
    #[error("{key} of the plan is {value}: nothing was written; please report this with the job")]
    NonFinite {
        /// The key of the plan.
        key: String,
        /// NaN or an infinity.
        value: f64,
    },
    /// A value that the format cannot carry.
    #[error("the plan cannot be written as {format}: {message}")]
    Encode {
        /// JSON or TOML.
        format: &'static str,
        /// What the format says.
        message: String,
    },
    /// The destination cannot be written.
    #[error("cannot write {dest}: {source}")]
    Write {
        /// File name or `standard output`.
        dest: String,
        /// What the system says.
        source: io::Error,
    },
    /// A file cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// The file is not a plan.
    #[error("{} is not a plan: {message}", path.display())]
    Parse {
        /// The file.
        path: PathBuf,
        /// What the parser says, with line and column.
        message: String,
    },
    /// A plan of another version.
    #[error("{} has schema `{found}`, this lixel reads `{SCHEMA}`; plan the job again", path.display())]
    Schema {
        /// The file.
        path: PathBuf,
        /// Its schema.
        found: String,
    },
}

impl PlanError {
    /// True when a reader of the output went away: no fault, and nothing to say.
    pub fn is_closed_pipe(&self) -> bool {
        matches!(self, PlanError::Write { source, .. } if source.kind() == io::ErrorKind::BrokenPipe)
    }
}
