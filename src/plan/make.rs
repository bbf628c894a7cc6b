//! From a job to a plan: the stages in order.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use super::{Plan, PlanError};
use crate::job::LoadedJob;

/// A stage of the work, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Reading the scene's files.
    Load,
    /// Planning or measuring; counted in lights of frames.
    Lights,
}

/// How far a stage is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// The stage.
    pub stage: Stage,
    /// Steps done.
    pub done: u64,
    /// Steps in all; 0 = not known.
    pub total: u64,
}

/// Plans a shot. Paths in the plan are relative to `plan_dir`; `cancel` is looked at between steps.
///
/// # Errors
/// [`PlanError::Cancelled`] soon after `cancel` becomes true; else what stands in the way.
pub fn make(
    _job: &LoadedJob,
    _plan_dir: &Path,
    _progress: &(dyn Fn(Progress) + Sync),
    _cancel: &AtomicBool,
) -> Result<Plan, PlanError> {
    Err(PlanError::NotBuilt("planning"))
}
