//! The parts of a job that say how good a map has to be and what a map may look like.

use crate::fit::Shape;
use crate::measure::Outside;
use crate::scene::{Geometry, Light};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What epsilon bounds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Bound {
    /// The share of the image's pixels that are answered wrongly.
    #[default]
    Misclassified,
    /// Film distance, pixels, between the drawn and the exact shadow edge, at the quantile.
    Displacement,
    /// Texel footprint on the film, pixels, at the quantile.
    Footprint,
}

/// Whether the planned size is checked by drawing and looking up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Measure {
    /// Every planned size is measured at film resolution against exact visibility, and so is the next smaller one.
    #[default]
    Always,
    /// The same, with nothing left out: a candidate's pixels are counted to the end where `always` ends once it is worse than
    /// the best known, and frames that are equal to an earlier one are planned again. The plan is the same but for `cost` and
    /// for what it says of equal frames.
    Full,
    /// Size and bias by a sample of the film's pixels, looked up by rays, and one map drawn and counted. Only where it is over,
    /// larger sizes are measured until one meets; no smaller one is tried. Where nothing is looked up (`map.single_sided`),
    /// the predicted size with the default bias, and a bias chosen by measurement where that is over. Segments of a shot are
    /// measured as with `always`.
    Check,
    /// No map is drawn: sizes and bias follow the prediction and a sample of the visible points, looked up by rays; the plan
    /// says so.
    Never,
}

impl Measure {
    /// Whether maps are drawn and counted at all.
    pub fn measures(self) -> bool {
        self != Measure::Never
    }
}

/// `[quality]`: the bound that the smallest map has to meet.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct QualityParams {
    /// What epsilon bounds.
    pub bound: Bound,
    /// The bound. A share of the image in (0, 1] for `misclassified`, absent = 0.001; pixels above 0 for
    /// `displacement` and `footprint`, absent = 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub epsilon: Option<f64>,
    /// The quantile at which `displacement` and `footprint` are taken, in (0, 1].
    pub quantile: f64,
    /// Whether sizes are measured or only predicted.
    pub measure: Measure,
}

impl Default for QualityParams {
    fn default() -> Self {
        Self { bound: Bound::default(), epsilon: None, quantile: 0.99, measure: Measure::default() }
    }
}

impl QualityParams {
    /// Epsilon of `bound` when a job gives none: one pixel in a thousand, or one pixel.
    pub fn default_epsilon(bound: Bound) -> f64 {
        match bound {
            Bound::Misclassified => 0.001,
            Bound::Displacement | Bound::Footprint => 1.0,
        }
    }

    /// The bound as given, or the default of its kind.
    pub fn epsilon(&self) -> f64 {
        self.epsilon.unwrap_or(Self::default_epsilon(self.bound))
    }
}

/// Whether width and height of a map are chosen apart.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum AspectRule {
    /// The best ratio of width to height is part of the search.
    #[default]
    Free,
    /// Width and height are equal, and the matrix is fitted for that.
    Fixed,
}

/// Which sides of triangles a renderer draws into its maps. glTF materials that are `doubleSided` are always drawn whole.
/// Only the drawn maps follow: the exact answer, against which they are measured, is shadow from both sides.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SingleSided {
    /// Both sides.
    #[default]
    Both,
    /// Triangles that turn their front to the light are left out: second-depth maps.
    CullFront,
    /// Triangles that turn their back to the light are left out.
    CullBack,
}

impl SingleSided {
    /// Whether a triangle is drawn into a map of a light. Fronts are counter-clockwise; a triangle seen edge-on is drawn.
    pub fn draws(self, geometry: Geometry, light: &Light, index: u32) -> bool {
        let facing = || {
            let [a, b, c] = geometry.triangle_f64(index);
            (b - a).cross(c - a).dot(light.towards(a))
        };
        match self {
            SingleSided::Both => true,
            SingleSided::CullFront => facing() <= 0.0 || geometry.two_sided(index),
            SingleSided::CullBack => facing() >= 0.0 || geometry.two_sided(index),
        }
    }
}

/// `[map]`: what the maps may look like and how they are looked up.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct MapParams {
    /// Which matrices are allowed.
    pub shape: Shape,
    /// What a point outside every map is taken for.
    pub outside: Outside,
    /// Smallest width and height, texels.
    pub min: u32,
    /// Largest width and height, texels, at most 16384.
    pub max: u32,
    /// Widths and heights are multiples of this.
    pub multiple_of: u32,
    /// Both sides are rounded up to the larger one.
    pub square: bool,
    /// Widths and heights are powers of two.
    pub power_of_two: bool,
    /// Ratio of neighbouring sizes on the grid that is searched, from 1.02 to 2.
    pub step: f64,
    /// Whether width and height are chosen apart.
    pub aspect: AspectRule,
    /// Which sides of single-sided triangles are drawn.
    pub single_sided: SingleSided,
    /// The depth bias under which the plan is made.
    pub bias: BiasParams,
}

/// Largest width or height of a map or image, texels: what a renderer's textures and this memory allow.
pub const SIZE_MAX: u32 = 16_384;

/// Most texels of a light's maps together: what one map of the largest size has, 1 GiB of depth.
pub const TEXELS_MAX: u64 = SIZE_MAX as u64 * SIZE_MAX as u64;

impl Default for MapParams {
    fn default() -> Self {
        Self {
            shape: Shape::default(),
            outside: Outside::default(),
            min: 16,
            max: 8192,
            multiple_of: 1,
            square: false,
            power_of_two: false,
            step: 1.02,
            aspect: AspectRule::default(),
            single_sided: SingleSided::default(),
            bias: BiasParams::default(),
        }
    }
}

/// `[map.bias]`: stored depth = depth + constant + min(slope * max(|z_u|, |z_v|), clamp), in window depth, where z_u
/// and z_v are the caster's depth slopes per texel.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct BiasParams {
    /// Window depth, at least 0. Absent = a few steps of f32 depth, chosen per map.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub constant: Option<f64>,
    /// Factor on the larger depth slope per texel, at least 0. 1 covers half a texel in both directions on a flat
    /// surface. Absent = the best of a few by measurement, per light and frame.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub slope: Option<f64>,
    /// Largest slope part, window depth, above 0. Absent = none, or one of a few by measurement, per light and frame.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub clamp: Option<f64>,
}
