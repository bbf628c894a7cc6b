//! Small geometry used by several stages: hulls, homographies, boxes, the light plane, the points of a map.

mod bounds;
mod domain;
mod hull;
mod light_space;
mod matrix;
mod motion;
mod prng;

pub use bounds::Bounds;
pub use domain::{Domain, first_holding, row_at};
pub use hull::{convex_hull, support_subset, without_flat};
pub use light_space::{LightSpace, LightSpaceError};
pub use matrix::{Rows4, apply, det3, matrix_from_rows, rows_of};
pub use motion::RigidMotion;
pub use prng::Prng;
