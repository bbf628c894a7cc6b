//! `[solver]`: how the matrix of a light is found.

use super::Method;
use crate::fit::Effort;
use crate::metric::Metric;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `[solver]`: how the matrix of a light is found.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct SolverParams {
    /// The method.
    pub method: Method,
    /// What `lixel` minimises; the other methods have their own.
    pub metric: Metric,
    /// Rounds of reweighting of the `displacement` and `saturating` metrics, 0 to 100.
    pub rounds: u32,
    /// Relative, in (0, 1]: the search stops when its simplex spans less than this in the objective, the rounds when one
    /// improves the objective by less.
    pub tolerance: f64,
    /// How far the search goes.
    pub effort: Effort,
    /// Rounds of choosing between maps by measured error, each among eight neighbours of the best map so far, before the
    /// first of which the other metrics' and methods' answers are measured too. 0 = trust the metric. At most 20.
    pub measured_rounds: u32,
}

impl Default for SolverParams {
    fn default() -> Self {
        Self {
            method: Method::default(),
            metric: Metric::default(),
            rounds: 6,
            tolerance: 0.001,
            effort: Effort::default(),
            measured_rounds: 2,
        }
    }
}
