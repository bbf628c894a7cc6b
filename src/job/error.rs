//! What can be wrong with a job.

use std::io;
use std::ops::Range;
use std::path::PathBuf;

use thiserror::Error;

use super::Problem;

/// Why a job cannot be used.
#[derive(Debug, Error)]
pub enum JobError {
    /// The input cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// The input.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// The input is neither a job nor a scene.
    #[error(
        "{} is neither a job file (.toml) nor a scene (.gltf, .glb, .obj); name one of these",
        path.display()
    )]
    Kind {
        /// The input.
        path: PathBuf,
    },
    /// The job file is larger than any job.
    #[error("{} is larger than {limit} bytes, the most a job file may have", path.display())]
    TooLarge {
        /// The job file.
        path: PathBuf,
        /// Bytes.
        limit: u64,
    },
    /// Something at a place in the job file.
    #[error(transparent)]
    InFile(Box<Located>),
    /// A value laid over the job file is wrong, or does not go with what the file says.
    #[error("{}: {}; {}", .0.key, .0.message, .0.help)]
    Override(Problem),
}

/// A fault at a place in a job file.
#[derive(Debug, Error)]
#[error("{}:{line}:{column}: {message}{}", path.display(), help.as_ref().map(|h| format!("; {h}")).unwrap_or_default())]
pub struct Located {
    /// The job file.
    pub path: PathBuf,
    /// Its whole text, so that the line can be quoted.
    pub text: String,
    /// Bytes of `text` that are at fault.
    pub span: Range<usize>,
    /// Line, from 1.
    pub line: usize,
    /// Character in the line, from 1.
    pub column: usize,
    /// What is wrong, with the value.
    pub message: String,
    /// What to do about it.
    pub help: Option<String>,
}
