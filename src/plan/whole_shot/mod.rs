//! Segments of constant matrix and size over a whole shot, each measured on all of its frames.
//!
//! ```text
//! sample    every frame       → parts (`shot`)
//! solve     parts             → segments; and on the frame of each that is predicted to need most, its film seen once:
//!                               other matrices near the segment's by what they are measured to get wrong, the depth row
//!                               over all frames' parts, the bias and the smallest size
//! certify   every frame       → measured at the segment's size; where a frame fails, the smallest larger size that serves
//! settle    all frames' sizes → the largest; frames measured at another one are certified again
//! ```
//!
//! With `auto` the shot is solved for one rung of the ladder after the other (`auto`).
//!
//! Where measured sizes are far from the predicted ones the shot is cut again with corrected costs, before any frame is
//! certified. `plan::pieces` runs the stages.

mod auto;
mod decide;
mod held;
mod hysteresis;
mod measure;
mod row;
mod window;

pub(super) use decide::{Decided, decided};
pub(super) use held::Held;
pub(super) use hysteresis::choose;
pub(super) use measure::{Ready, SegmentFrame};

use super::stage::Stages;
use crate::methods::Method;

/// Why no light of a shot can have one matrix for several frames, whatever it covers.
pub(super) fn refused(stages: &Stages) -> Option<String> {
    if stages.images.is_some() {
        return Some("planned from images, which do not show what moves between frames".to_owned());
    }
    let shared = matches!(stages.job.solver.method, Method::Lixel | Method::SceneOptimal | Method::Auto);
    (!shared).then(|| PLACED_BY_ONE_CAMERA.to_owned())
}

/// Why a method has no matrix for several frames.
const PLACED_BY_ONE_CAMERA: &str = "the method places its matrix by one camera: no frame shares it with another";
