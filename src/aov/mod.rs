//! A renderer's own images → the shadow edges and covered points of a light, without geometry (SOSM's read-back, sections 2
//! and appendix A).
//!
//! [`Images`] finds the files of a shot, their size and their cameras; [`Images::frame`] reads one frame: a [`SeenFilm`],
//! which knows the surface behind every pixel and which neighbours are one surface, and a shadow layer for each light.
//! [`SeenFilm::answers`] and [`SeenFilm::sample`] then give what `visibility` and `samples` give of geometry.
//!
//! Not known from images: what casts. The size of a map is predicted, never measured.

mod edge_normal;
mod error;
mod exr_file;
mod film;
mod frames;
mod header_camera;
mod layers;
mod params;
mod pattern;
mod sample;
mod slope;

pub use error::AovError;
pub use film::{Depths, SeenFilm};
pub use frames::{Images, ImagesFrame, Wanted};
pub use header_camera::{HeaderCamera, camera_of_header, header_of};
pub use params::{AovParams, DepthKind, DepthLayer, NormalLayer, NormalSpace, PositionLayer, ShadowLayer, ShadowValue};
pub use pattern::{frame_file, frames_there, has_frame_number};
