//! The part of a job that says how finely the planner looks for shadow edges.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `[sampling]`: the coarse grid, its refinement, and how many samples are kept.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct SamplingParams {
    /// Cells of the planning grid along the image's short side, 8 to 16384; never finer than the film. One as fine as the
    /// film costs no rays of its own where every pixel is measured anyway.
    pub grid: u32,
    /// Halvings of a grid step across which a shadow bit changes, 0 to 24. The edge is known to grid step / 2^refine, its
    /// direction over a step to 2^-refine: with 3, long shadows of a low sun were predicted three times too wrong.
    pub refine: u32,
    /// Most boundary samples kept per light and frame, at least 16; more are thinned evenly along the edges.
    pub cap: u32,
}

impl Default for SamplingParams {
    fn default() -> Self {
        Self { grid: 4096, refine: 6, cap: 4096 }
    }
}
