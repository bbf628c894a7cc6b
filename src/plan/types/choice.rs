//! What a plan says of a choice among methods.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::methods::Method;

/// How `auto` or `best` came to its method, which the maps name.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
pub struct Choice {
    /// The methods tried, in order.
    pub tried: Vec<Alternative>,
    /// Why it is this one, in words.
    pub reason: String,
}

/// A method that was tried.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
pub struct Alternative {
    /// The method.
    pub method: Method,
    /// Number of maps; over a shot, of the frame that has most. Absent where the method has none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub maps: Option<u64>,
    /// Of `auto`: texels of all maps that the bound asks for, before better maps are looked for near these; over a shot, those
    /// that `shot.minimise` counts. Of `best`: the texels that it was measured at.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub texels: Option<u64>,
    /// Of `auto`: texels that the better maps near these need; only where they were looked for and need fewer.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub improved: Option<u64>,
    /// The bound is met at these texels.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub met: Option<bool>,
    /// The error at these texels, over what the bound allows.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<f64>,
    /// Certainly wrong pixels at these texels, of `best`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub misclassified: Option<u64>,
    /// Of `auto`: the share that it saves of the texels of the simpler method it would replace, negative where it needs more;
    /// by the improved texels where a step hung on them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub saving: Option<f64>,
    /// Why it has no maps.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
}
