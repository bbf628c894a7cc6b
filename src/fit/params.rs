//! The part of a job that says which method finds the matrix and how hard it tries.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A method of choosing the light matrix.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Minimises the displacement of the shadow edges on screen over all allowed matrices.
    #[default]
    Lixel,
    /// The light's frustum over the whole scene, blind to the camera.
    Normal,
    /// The smallest rectangle around what both the camera and the light see.
    Focused,
    /// Scene-optimised shadow mapping, Algorithm 1 as published.
    SceneOptimal,
}

/// What `lixel` minimises.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Metric {
    /// Edge displacement, saturating where it is wider than the shadow itself.
    #[default]
    Saturating,
    /// Edge displacement to the power `p`.
    Displacement,
    /// The squared norm of the inverse Jacobian, as in the scene-optimised paper.
    Jacobian,
}

/// How far the search over matrices goes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Effort {
    /// A few local steps from the uniform map.
    Quick,
    /// A coarse global grid, then local steps from the best few.
    #[default]
    Standard,
    /// A fine global grid, then local steps from more of its cells.
    Global,
}

/// `[solver]`: how the matrix of a light is found.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct SolverParams {
    /// The method.
    pub method: Method,
    /// What `lixel` minimises; the other methods have their own.
    pub metric: Metric,
    /// Power of `displacement`, in (0, 2].
    pub p: f64,
    /// Rounds of reweighting, 0 to 100.
    pub rounds: u32,
    /// Relative distance from the optimum at which the solver may stop, in (0, 1].
    pub tolerance: f64,
    /// How far the search goes.
    pub effort: Effort,
}

impl Default for SolverParams {
    fn default() -> Self {
        Self {
            method: Method::default(),
            metric: Metric::default(),
            p: 1.0,
            rounds: 4,
            tolerance: 0.001,
            effort: Effort::default(),
        }
    }
}
