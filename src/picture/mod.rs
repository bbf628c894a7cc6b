//! Pictures of numbers: 8-bit PNG to look at, OpenEXR to compute with, and what plots in SVG share.

mod layers;
mod raster;
mod svg;

pub use layers::{CameraAttributes, Channel, write_exr, write_exr_of_camera};
pub use raster::{Colour, Picture, mix, scaled, tiled};
pub use svg::{COLOURS, decades, escaped, svg_head};
