//! Pictures of numbers: 8-bit PNG to look at, OpenEXR to compute with.

mod layers;
mod raster;

pub use layers::{CameraAttributes, Channel, write_exr, write_exr_of_camera};
pub use raster::{Colour, Picture, mix, scaled, tiled};
