//! Across frames: what is kept of each frame, the matrix of an interval of them, and the cut of a shot into intervals.
//!
//! Stages, each a pure function of the one before it, so that frames may be worked on apart:
//!
//! ```text
//! sample    frame and light → LightPart: some edge samples, the hull of what has to be covered, what stands in the map
//! solve     parts of one light → segments: the matrix, the size it is predicted to need, the frame that decides it
//! certify   segments and frames → sizes that meet epsilon on each frame (in `plan`, which holds the frames)
//! ```
//!
//! q is measured in the light's own frame, so that samples of all frames of a shot live in the same coordinates even when
//! the light moves (math note §9).

mod content;
mod interval;
mod light_pose;
mod params;
mod part;
mod partition;
mod solve;

pub use content::{Content, content};
pub use interval::{Asked, Interval, Look, fit_interval, in_frame, interval_samples};
pub use light_pose::{carry, light_poses};
pub use params::{Hold, Minimise, Temporal, TemporalParams};
pub use part::{LightPart, extremes_for_light, light_part};
pub use partition::{Ends, cheapest, lowest_peak};
pub use solve::{LightParts, Segment, Segmentation, Unsegmented, fit_segment, minimised_texels, segments};
