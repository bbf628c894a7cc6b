//! What a plan says of a light across frames.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::shot::Temporal;

/// How the maps of a light hang together with those of its other frames.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
pub struct LightTemporal {
    /// The mode by which this entry was planned.
    pub mode: Temporal,
    /// Why it is not the mode that the job asks for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// First and last frame number that share the matrix (in the light's own frame) and the size.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub segment: Option<[i64; 2]>,
    /// The frame that needs the size: the next smaller one was measured there and is over.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub decided_by: Option<i64>,
    /// The maps are drawn in this frame; its own number. Absent when they are reused.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub drawn_at: Option<i64>,
    /// The maps are those drawn in an earlier frame, by number: matrix, size and bias are the same, and nothing that the
    /// maps see has moved.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reused_from: Option<i64>,
    /// The entry is that of an earlier frame, by number, which is equal to this one in camera, light and geometry, to the bit:
    /// nothing was computed for it, and `cost` is nothing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub same_as: Option<i64>,
}

/// Pixels whose answer from the maps changes between two frames at the same point of a surface, although the exact answer
/// there does not.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
pub struct Flicker {
    /// The frame before, by number.
    pub since: i64,
    /// Flickering pixels on surfaces that did not move.
    pub still: u64,
    /// Flickering pixels on surfaces that moved, followed through their motion.
    pub moved: u64,
    /// Pixels that face the light, are seen in both frames and have the same exact answer in both: those that could have
    /// flickered.
    pub compared: u64,
}

/// What a renderer shows that blends answers over time (`job.lookup`), in this frame.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
pub struct Reprojected {
    /// Pixels taken wrongly for shadowed or lit whose exact answer is certain.
    pub misclassified: u64,
    /// Further such pixels whose exact answer is uncertain.
    pub uncertain: u64,
    /// The bound holds for these counts.
    pub met: bool,
    /// Changes of what is shown since the frame before that nothing accounts for, of pixels that the renderer finds there;
    /// absent for the first frame.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub flicker: Option<Flicker>,
}

impl LightTemporal {
    /// Of an entry planned for its frame alone.
    pub fn alone(frame: i64, reason: Option<String>) -> LightTemporal {
        LightTemporal {
            mode: Temporal::PerFrame,
            reason,
            segment: None,
            decided_by: None,
            drawn_at: Some(frame),
            reused_from: None,
            same_as: None,
        }
    }
}
