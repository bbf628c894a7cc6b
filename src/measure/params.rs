//! The part of a job that says what a renderer does with the answers of its maps.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What a renderer makes of the answers of neighbouring frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Smoothing {
    /// Nothing: each frame's answer stands.
    #[default]
    None,
    /// Temporal reprojection with confidence: an answer near the centre of its texel counts for more than one near its
    /// border, and the rest comes from the frame before.
    Reprojection,
}

/// `[lookup]`: the renderer's use of answers, as a model that errors are measured under.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct LookupParams {
    /// What becomes of answers over time. `reprojection` needs consecutive frames.
    pub temporal: Smoothing,
    /// Exponent of the confidence, from 0.1 to 100: larger ones trust the frames before more.
    pub confidence_power: f64,
}

impl Default for LookupParams {
    fn default() -> Self {
        Self { temporal: Smoothing::default(), confidence_power: 1.0 }
    }
}

impl LookupParams {
    /// Whether answers of earlier frames enter.
    pub fn is_temporal(&self) -> bool {
        self.temporal == Smoothing::Reprojection
    }
}
