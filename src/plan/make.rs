//! From a job to a plan, and to pictures of one frame: the stages in order.

use std::path::{Path, PathBuf};

use super::{Plan, PlanError, Watch};
use crate::job::LoadedJob;

/// Plans a shot. Paths in the plan are relative to `plan_dir`; `timings` puts wall times into the plan's costs.
///
/// # Errors
/// [`PlanError::Cancelled`] soon after the watch asks to stop; else what stands in the way.
pub fn make(_job: &LoadedJob, _plan_dir: &Path, _timings: bool, watch: &Watch) -> Result<Plan, PlanError> {
    watch.check()?;
    Err(PlanError::NotBuilt("planning"))
}

/// Writes what was seen in one frame to a folder, and says which files it wrote.
///
/// # Errors
/// As [`make`].
pub fn render(_job: &LoadedJob, _frame: i64, _dir: &Path, watch: &Watch) -> Result<Vec<PathBuf>, PlanError> {
    watch.check()?;
    Err(PlanError::NotBuilt("rendering"))
}
