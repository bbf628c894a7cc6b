//! → the shadow edges and the covered points of one light: what metric and fit see of a frame.
//!
//! A grid over the film is seen once for all lights ([`GridView`]): a coarse one, or the film's own pixels where those are
//! looked at anyway. For a light, each grid step across which the
//! shadow answer changes is bisected with exact rays ([`Crossing`]); crossings around a cell are joined to segments, which
//! carry the edge's place, normal and length on the film ([`Changes`], which asks the caller, not rays: `aov` uses it too).

mod changes;
mod crossing;
mod edges;
mod grid;
mod params;

pub use changes::{Changes, EdgeLook};
pub use crossing::{Crossing, CrossingKind};
pub use edges::{EdgePoint, LightSamples, LightView, sample_light};
pub use grid::{Grid, GridView};
pub use params::SamplingParams;
