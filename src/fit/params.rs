//! `[solver]` and the shape of a map.

use crate::metric::Metric;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How hard the projective part is searched for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Effort {
    /// A coarse polar grid and one simplex.
    Local,
    /// A polar grid over the whole polygon and simplices from its best few points.
    #[default]
    Global,
    /// Global, and a dense grid besides that states the gap.
    Exhaustive,
}

/// What a renderer can carry.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Shape {
    /// Any homography.
    #[default]
    Projective,
    /// No perspective warp of a directional light; skew allowed. Point and spot lights: any view axis, skew allowed.
    Affine,
    /// A plain orthographic or off-centre perspective camera: no warp, no skew.
    Rectangle,
}

/// `[solver]`.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct SolverParams {
    /// What is minimised.
    pub metric: Metric,
    /// Reweighting rounds of the `displacement` and `saturating` metrics.
    pub rounds: u32,
    /// Relative: the search stops when its simplex spans less than this in the objective, and the rounds stop when one
    /// improves the objective by less.
    pub tolerance: f64,
    /// How hard to search.
    pub effort: Effort,
    /// At most this many edge samples per light; more are thinned evenly. 0 = no cap.
    pub cap: u32,
}

impl Default for SolverParams {
    fn default() -> Self {
        SolverParams { metric: Metric::default(), rounds: 6, tolerance: 1e-3, effort: Effort::default(), cap: 4096 }
    }
}
