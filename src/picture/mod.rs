//! Pictures of numbers: 8-bit PNG to look at, OpenEXR to compute with.

mod layers;
mod raster;

pub use layers::{Channel, write_exr};
pub use raster::{Colour, Picture, mix, scaled, tiled};
