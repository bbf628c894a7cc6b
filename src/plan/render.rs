//! Pictures of one frame: what was seen, and where the plan's maps are wrong.

use std::path::{Path, PathBuf};

use super::{PlanError, Watch};
use crate::job::LoadedJob;

/// Writes what was seen in one frame to a folder, and says which files it wrote.
///
/// # Errors
/// As [`super::make`].
pub fn render(_job: &LoadedJob, _frame: i64, _dir: &Path, watch: &Watch) -> Result<Vec<PathBuf>, PlanError> {
    watch.check()?;
    Err(PlanError::NotBuilt("rendering"))
}
