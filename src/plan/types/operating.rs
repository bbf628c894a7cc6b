//! What a plan says of settings that a time budget chose.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How a time budget chose the settings of the job.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
pub struct Operating {
    /// Milliseconds that were asked for, for each light of each frame.
    pub budget_ms: f64,
    /// The chosen operating point, by name; its settings are those of `job`.
    pub point: String,
    /// What the choice rests on.
    pub model: TimeModel,
    /// Milliseconds expected of the point, for each light of each frame planned by itself.
    pub expected_ms: f64,
    /// False when even the fastest point is expected to take longer than the budget.
    pub within: bool,
    /// False when a clock had a say: another run may choose another point. The plan of a job with the settings of `job` and
    /// no budget is this one, whenever it is made.
    pub deterministic: bool,
}

/// What the choice of an operating point rests on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum TimeModel {
    /// The table of points, its times corrected by timing a few of them on the shot's first frame with shadows.
    FirstFrame,
    /// The table of points as it stands.
    Table,
}
