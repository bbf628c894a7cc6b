//! What can go wrong besides planning itself.

use std::path::PathBuf;

use thiserror::Error;

use crate::job::JobError;
use crate::plan::PlanError;
use crate::resolution::Measure;

/// Why there is no trade, or no plan within a budget.
#[derive(Debug, Error)]
pub enum TradeError {
    /// Planning.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// Settings that do not go with the job.
    #[error(transparent)]
    Job(#[from] JobError),
    /// Nothing to plan.
    #[error(
        "no light casts a visible shadow in these frames, so there is nothing to plan: choose others with --frames"
    )]
    NoShadow,
    /// A table of operating points that cannot be used.
    #[error("{}: {message}; write one with `lixel trade INPUT --model FILE`", path.display())]
    Model {
        /// The file.
        path: PathBuf,
        /// What is wrong with it, with the value.
        message: String,
    },
    /// Nothing to choose from.
    #[error(
        "no operating point has quality.measure = {wanted:?}: leave --measure away, or give a table that has one with --time-model"
    )]
    NoPoint {
        /// What was asked for.
        wanted: Measure,
    },
}
