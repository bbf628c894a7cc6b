//! Exit codes, and what leads to them.

use std::io;
use std::process::ExitCode;

use lixel::job::JobError;
use lixel::plan::{PartError, PlanError};
use lixel::trade::TradeError;

use super::flags::JobFlags;

/// All done, every bound met.
pub(super) const MET: u8 = 0;
/// A run-time failure, or a bound that `verify` found broken.
pub(super) const FAILED: u8 = 1;
/// Bad input or usage; also clap's code.
pub(super) const BAD_INPUT: u8 = 2;
/// The plan is written and a bound is not met.
pub(super) const NOT_MET: u8 = 3;
/// Parts are merged, and ask for another round.
pub(super) const AGAIN: u8 = 4;
/// Plus the number of a signal.
pub(super) const SIGNAL_BASE: u8 = 128;

/// Why a command could not do its work.
pub(super) enum Failure {
    /// The process could not be set up.
    Setup(String),
    /// The job; with the flags that were laid over it, as `--flag` and key.
    Job(JobError, Vec<(&'static str, &'static str)>),
    /// Input that is in order by itself and leaves nothing to do, or that a flag does not go with.
    Input(String),
    /// Planning, reading or writing a plan.
    Plan(PlanError),
    /// Writing to standard output.
    Stdout(io::Error),
}

impl Failure {
    /// A fault of a job, and the flags that may have caused it.
    pub(super) fn job(error: JobError, flags: &JobFlags) -> Self {
        Failure::Job(error, flags.given())
    }

    /// The exit code. A reader that closes our output early has seen what it wanted.
    pub(super) fn code(&self) -> ExitCode {
        ExitCode::from(match self {
            Failure::Job(..) | Failure::Input(_) => BAD_INPUT,
            Failure::Plan(error) if error.is_closed_pipe() => MET,
            Failure::Plan(
                PlanError::Scene(_)
                | PlanError::NotConsecutive { .. }
                | PlanError::Aov(_)
                | PlanError::NoGeometry
                | PlanError::Pattern { .. },
            ) => BAD_INPUT,
            Failure::Plan(PlanError::Part(PartError::Write { .. })) => FAILED,
            Failure::Plan(PlanError::Part(_)) => BAD_INPUT,
            Failure::Plan(PlanError::Read { .. } | PlanError::Parse { .. } | PlanError::Schema { .. }) => BAD_INPUT,
            Failure::Stdout(error) if error.kind() == io::ErrorKind::BrokenPipe => MET,
            Failure::Setup(_) | Failure::Plan(_) | Failure::Stdout(_) => FAILED,
        })
    }

    /// True when there is nothing to tell.
    pub(super) fn is_silent(&self) -> bool {
        match self {
            Failure::Plan(error) => error.is_closed_pipe(),
            Failure::Stdout(error) => error.kind() == io::ErrorKind::BrokenPipe,
            _ => false,
        }
    }
}

impl From<TradeError> for Failure {
    fn from(error: TradeError) -> Self {
        match error {
            TradeError::Plan(error) => Failure::Plan(error),
            TradeError::Job(error) => Failure::Job(error, Vec::new()),
            TradeError::NoShadow | TradeError::Model { .. } | TradeError::NoPoint { .. } => {
                Failure::Input(error.to_string())
            }
        }
    }
}

impl From<PlanError> for Failure {
    fn from(error: PlanError) -> Self {
        Failure::Plan(error)
    }
}
