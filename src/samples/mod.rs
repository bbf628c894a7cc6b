//! (this room is being built)

mod params;

pub use params::SamplingParams;
