//! (scene view, light, maps) → wrong pixels against exact visibility. Takes maps, not a plan; shares no metric, sample or
//! fit with what it judges.

mod batch;
mod by_rays;
mod certainty;
mod count;
mod edge_distance;
mod flicker;
mod footprint;
mod params;
mod receivers;
mod reprojection;

pub use by_rays::{LookedUp, Undrawn, look_up_by_rays};
pub use certainty::{Certainty, UNCERTAIN_SLACK, Verdict, least_limit};
pub use count::{Counts, Drawn, Looked, Outside, answers_shadowed, count, fewer_wrong, look_up, wrong};
pub use edge_distance::edge_distance;
pub use flicker::{Earlier, Flickering, LightThenNow, Moment, flicker, flickering, reproject};
pub use footprint::footprint;
pub use params::{LookupParams, Smoothing};
pub use receivers::{Receivers, Seen};
pub use reprojection::{Blended, Cache, Past, blend};
