//! (this room is being built)

mod params;

pub use params::{AspectRule, BiasParams, Bound, MapParams, Measure, QualityParams, SIZE_MAX};
