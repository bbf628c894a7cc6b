//! What a comparison found, row by row.

use serde::Serialize;

/// Methods side by side.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// Pixels of the image.
    pub pixels: u64,
    /// Texels of each light; absent when they were searched.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub texels: Option<u64>,
    /// The bound that texels were searched for; absent at equal texels.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub epsilon: Option<f64>,
    /// Every light of every frame, in order.
    pub lights: Vec<CaseLight>,
    /// The methods; their rows are those of `lights`.
    pub methods: Vec<MethodRows>,
}

/// A light of a frame: what all methods were given.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CaseLight {
    /// Frame number.
    pub frame: i64,
    /// Name of the light.
    pub light: String,
    /// Why there was nothing to compare.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub skipped: Option<String>,
    /// Pixels that face the light.
    pub facing: u64,
    /// Of them in shadow.
    pub shadowed: u64,
    /// Shadow edge samples.
    pub samples: u64,
    /// Sampling the edges and classifying the film, once for all methods.
    pub seconds: f64,
}

/// One method on all lights.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MethodRows {
    /// Its name.
    pub method: String,
    /// Certainly wrong pixels of all lights.
    pub misclassified: u64,
    /// Lights to which the method does not apply.
    pub inapplicable: u64,
    /// Mean over lights of the method's own time: solving, drawing and counting.
    pub seconds: f64,
    /// One for each light.
    pub per_light: Vec<PerLight>,
}

/// One method on one light.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PerLight {
    /// Frame number.
    pub frame: i64,
    /// Name of the light.
    pub light: String,
    /// The method that `auto` or `best` came to.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub chosen: Option<String>,
    /// Why the method does not apply, or why there was nothing to compare.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// What was measured, unless there is a reason.
    #[serde(flatten)]
    pub measured: Option<Measured>,
    /// The fit alone.
    pub solve_seconds: f64,
    /// Fit, depth row, drawing and counting.
    pub seconds: f64,
}

/// What one method's maps came to.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Measured {
    /// Wrong pixels whose exact answer is certain.
    pub misclassified: u64,
    /// Of them in shadow, answered lit.
    pub false_lit: u64,
    /// Of them lit, answered in shadow.
    pub false_shadow: u64,
    /// Of them owed to bias.
    pub self_shadow: u64,
    /// Of them owed to misplaced shadow edges.
    pub edge: u64,
    /// Further wrong pixels whose exact answer is uncertain.
    pub uncertain: u64,
    /// Expected wrong pixels, saturating; absent when it is not finite.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub predicted: Option<f64>,
    /// Expected wrong pixels without saturation; absent when it is not finite.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub predicted_unsaturated: Option<f64>,
    /// Texels of all maps.
    pub texels: u64,
    /// Width and height of each map.
    pub maps: Vec<[u32; 2]>,
    /// Samples that stand in for texels, one a pixel that faces the light, where the method answers exactly.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub samples: Option<u64>,
    /// Constant bias, window depth.
    pub bias_constant: f64,
    /// Factor on the depth slope per texel.
    pub bias_slope: f64,
    /// Largest slope part, window depth; absent = none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bias_clamp: Option<f64>,
    /// Texels that the bound asks for; absent at equal texels.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub needed: Option<TexelsFor>,
}

/// Texels for a bound.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TexelsFor {
    /// The bound holds at these texels; else they are the most that the job allows.
    pub met: bool,
    /// Texels of all maps.
    pub texels: u64,
}
