//! The part of a job that says how maps hold together over the frames of a shot.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How the maps of neighbouring frames hang together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Temporal {
    /// Segments of the shot with one matrix and size each, constant in the light's own frame, found over the whole shot.
    #[default]
    Shot,
    /// Each frame for itself.
    PerFrame,
    /// The last frame's matrix, scaled and shifted to hold what it has to, until a new one is much better (SOSM, step 5).
    Hysteresis,
    /// One orientation and size, moved by whole texels. For `map.shape = "rectangle"`.
    Snapped,
}

/// What a segmentation of a shot minimises.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Minimise {
    /// Texels drawn over the shot: a map is drawn once for as long as neither the light nor what the map sees moves.
    #[default]
    Drawn,
    /// Texels of a light's largest map.
    Peak,
    /// Texels of all frames' maps, drawn or not.
    Sum,
}

/// Over what a matrix is held, whatever it costs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Hold {
    /// The whole shot.
    Shot,
}

/// `[shot]`: how the maps of neighbouring frames hang together.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct TemporalParams {
    /// The mode. A shot of one frame is planned by itself in any mode.
    pub temporal: Temporal,
    /// What `shot` minimises.
    pub minimise: Minimise,
    /// Texels that one pixel is worth whose answer pops at a change of matrix, at least 0. `shot` adds to each change this
    /// times the wrong pixels that it expects there. 0 counts texels alone; the default allows a change where it saves a
    /// good part of the texels of many frames.
    pub change_cost: f64,
    /// Most segments of a light in mode `shot`, at least 1; absent = no limit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_segments: Option<u32>,
    /// Forces one segment in mode `shot`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hold: Option<Hold>,
    /// One size for each light over the shot, in mode `shot`; `snapped` has one always.
    pub one_size: bool,
    /// Mode `hysteresis` takes a new matrix when its median footprint is less than this part of the held one's, in (0, 1].
    pub hysteresis: f64,
    /// Part of a map's side left free along each border in mode `hysteresis`, in [0, 0.4]. Within it the held matrix stays
    /// as it is; 0 scales and shifts it every frame.
    pub hysteresis_border: f64,
}

impl Default for TemporalParams {
    fn default() -> Self {
        Self {
            temporal: Temporal::default(),
            minimise: Minimise::default(),
            change_cost: 100_000.0,
            max_segments: None,
            hold: None,
            one_size: false,
            hysteresis: 0.8,
            hysteresis_border: 0.0,
        }
    }
}
