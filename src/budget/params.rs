//! The part of a job that limits texels.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Bytes of a texel: the depth of a plan's maps is f32.
pub const TEXEL_BYTES: u64 = 4;

/// `[budget]`: limits under which the wrong pixels of all lights and frames together are made fewest. Any of them given,
/// sizes come from the budget, and `quality.epsilon` only says for which quality matrices and segments are fitted.
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct BudgetParams {
    /// Most texels that are resident in any frame, at least 1: those of the maps that the frame looks up, and of maps drawn
    /// before it that a later frame looks up again.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub texels_per_frame: Option<u64>,
    /// Most texels drawn over all frames, at least 1: a map that is drawn once and reused counts once.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub texels_total: Option<u64>,
    /// Most bytes that are resident in any frame, at least 4: 4 a texel.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bytes: Option<u64>,
}

impl BudgetParams {
    /// Whether there is any limit.
    pub fn is_given(&self) -> bool {
        *self != BudgetParams::default()
    }

    /// Most texels resident in a frame, from texels and bytes.
    pub fn resident(&self) -> Option<u64> {
        self.texels_per_frame.into_iter().chain(self.bytes.map(|b| b / TEXEL_BYTES)).min()
    }
}
