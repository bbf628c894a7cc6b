//! How hard to search, and among which homographies.

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
