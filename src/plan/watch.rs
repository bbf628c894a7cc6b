//! How a caller follows long work, and stops it.

use std::sync::atomic::{AtomicBool, Ordering};

use super::PlanError;

/// A stage of the work, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Reading the scene's files.
    Load,
    /// Sampling the frames of a shot; counted in frames.
    Samples,
    /// Cutting a shot into segments and deciding them; counted in lights.
    Solve,
    /// Measuring or drawing; counted in frames of a shot, or in its lights.
    Lights,
    /// Measuring planned maps at other sizes; counted in lights of frames.
    Budget,
    /// Comparing the frames of a planned shot with the ones before them; counted in frames.
    Flicker,
    /// Timing settings of the planner; counted in runs.
    Points,
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

/// Where progress goes and where a wish to stop comes from.
#[derive(Clone, Copy)]
pub struct Watch<'a> {
    /// Called from any thread, now and then.
    pub progress: &'a (dyn Fn(Progress) + Sync),
    /// Becomes true when the work should stop.
    pub cancel: &'a AtomicBool,
    /// Called with each remark on the input, once.
    pub notes: &'a (dyn Fn(&str) + Sync),
}

impl Watch<'_> {
    /// Passes a remark on.
    pub fn note(&self, text: &str) {
        (self.notes)(text);
    }

    /// Reports progress, and asks whether to go on.
    ///
    /// # Errors
    /// [`PlanError::Cancelled`] once `cancel` is true.
    pub fn step(&self, stage: Stage, done: u64, total: u64) -> Result<(), PlanError> {
        (self.progress)(Progress { stage, done, total });
        self.check()
    }

    /// Asks whether to go on.
    ///
    /// # Errors
    /// [`PlanError::Cancelled`] once `cancel` is true.
    pub fn check(&self) -> Result<(), PlanError> {
        if self.cancel.load(Ordering::Relaxed) { Err(PlanError::Cancelled) } else { Ok(()) }
    }
}
