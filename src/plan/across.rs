//! What holds from frame to frame in a finished plan: which maps are drawn and which are reused, and flicker.

use super::stage::Stages;
use super::{FramePlan, PlanError, Watch};

/// Completes the entries of a shot.
pub(super) fn complete(_stages: &Stages, _frames: &mut [FramePlan], _watch: &Watch) -> Result<(), PlanError> {
    Ok(())
}
