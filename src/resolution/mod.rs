//! (this room is being built)

mod params;

pub use params::{Aspect, BiasParams, Bound, MapParams, Measure, Outside, QualityParams, SIZE_MAX, Shape};
