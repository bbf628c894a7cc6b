//! A shot in pieces: the stages of planning as functions of what is known of frames, so that frames may be worked on
//! apart, by several machines or one after an interruption, and the plan is the same to the byte.
//!
//! ```text
//! sample    frame                  → FrameState: parts of its lights, or finished entries where a frame needs no other
//! solve     all FrameStates        → Draft: what is settled over the shot; opens the frames that decide a segment
//! certify   Draft, frame           → FrameState with answers: its entries, and its flicker since the frame before
//! settle    Draft, all FrameStates → the plan; or the Draft of another round, where a frame asked for a larger size
//! ```
//!
//! `lixel plan` calls them in turn ([`run`]); `lixel sample`, `solve`, `certify` and `merge` write what they return to files
//! in between ([`file`]); `lixel plan --work` does both. There is no other way to a plan.
//!
//! A frame's answer hangs on the Draft, on the frame and, for flicker, on the maps of the frame before, which the Draft
//! names. Nothing hangs on who asked, on the order of frames, or on which other frames were asked.

mod certify;
mod commands;
mod file;
mod identity;
mod looked_up;
mod run;
mod same;
mod sample;
mod settle;
mod solve;
mod work;

pub use commands::{Merged, certify, merge, sample, solve};
pub use file::PartError;
pub(super) use file::as_json;
pub use run::make_in;
pub(super) use run::planned;

use super::LightPlan;
use super::whole_shot::Held;
use crate::math::RigidMotion;
use crate::plan::Flicker;
use crate::resolution::{FittedLight, Trial};
use crate::scene::{Camera, Light};
use crate::shot::{Content, LightPart};
use serde::{Deserialize, Serialize};

/// One frame, as far as it is known.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(super) struct FrameState {
    /// Place in the shot.
    pub(super) place: usize,
    pub(super) camera: Camera,
    /// The lights that are on, in the order of the scene.
    pub(super) lights: Vec<FrameLight>,
}

/// One light of a frame.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(super) struct FrameLight {
    /// As it stands in the frame.
    pub(super) light: Light,
    /// What was kept of it. Once the shot is solved its edges stand in the light's frame and its cover is gone.
    pub(super) part: Option<LightPart>,
    /// Takes the frame's points to where they stand, seen from the light, in the first frame. `None` where it stands the same.
    pub(super) motion: Option<RigidMotion>,
    /// Scene from light.
    pub(super) pose: Option<RigidMotion>,
    /// The regions fitted to the frame alone, in mode `hysteresis`; once the shot is solved, those it holds.
    pub(super) fresh: Option<FittedLight>,
    pub(super) answer: Option<Answer>,
    /// Place of the first frame that is equal to this one for the light: the answer is that one's.
    pub(super) same_as: Option<usize>,
    pub(super) flicker: Option<Compared>,
}

impl FrameLight {
    /// A light of which nothing is known.
    pub(super) fn new(light: Light) -> FrameLight {
        FrameLight {
            light,
            part: None,
            motion: None,
            pose: None,
            fresh: None,
            answer: None,
            same_as: None,
            flicker: None,
        }
    }

    /// Whether a map has to be looked up, as far as the frame was sampled.
    fn needs_map(&self) -> bool {
        self.part.as_ref().is_some_and(|p| p.needed > 0)
    }
}

/// What a light of a frame came to.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(super) struct Answer {
    /// Its entry, without what only the whole shot knows.
    #[serde(with = "file::as_json")]
    pub(super) entry: LightPlan,
    /// Place on the segment's grid of sizes that it was measured at.
    pub(super) place: usize,
    /// All sizes tried, with their places, in order.
    pub(super) tried: Vec<(usize, Trial)>,
    /// The bound is missed at the largest size.
    pub(super) missed: bool,
    /// What moves in its maps.
    pub(super) content: Content,
}

/// Flicker, and between which maps.
#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
pub(super) struct Compared {
    /// Fingerprint of the maps of both frames.
    pub(super) of: [u8; 32],
    /// Absent for a light that was off in the frame before.
    pub(super) flicker: Option<Flicker>,
}

/// What is settled over the shot.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(super) struct Draft {
    /// Counted from 1: how often frames are asked.
    pub(super) round: u32,
    /// Every light of the shot once.
    pub(super) lights: Vec<LightDraft>,
}

/// What is settled for one light.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(super) struct LightDraft {
    pub(super) name: String,
    pub(super) way: Way,
}

/// How a light's frames hang together.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(super) enum Way {
    /// Each frame for itself; with the reason, where the job asks otherwise.
    Each { reason: Option<String> },
    /// Each frame has regions that were chosen with those of the frame before in mind.
    Chosen,
    /// Segments, in order.
    Segments(Vec<Held>),
}

impl Draft {
    fn light(&self, name: &str) -> Option<&LightDraft> {
        self.lights.iter().find(|l| l.name == name)
    }
}

impl LightDraft {
    /// The segment that a frame belongs to.
    fn held(&self, frame: usize) -> Option<&Held> {
        match &self.way {
            Way::Segments(segments) => segments.iter().find(|h| h.segment.frames.contains(&frame)),
            Way::Each { .. } | Way::Chosen => None,
        }
    }
}
