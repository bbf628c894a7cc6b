//! Minimises a sum of 36 moments over the eight parameters of a homography that covers a convex polygon.
//!
//! Nothing here knows of shadows or lights: a polygon in the plane q3 = 1, moments of samples in the same plane, a shape
//! of map, and a budget. The projective part (a, b) of p4 = (a, b, 1) is searched over the polar polygon of the hull;
//! for each the affine part is found over pairs of angles (math note §4).

mod affine;
mod near;
mod normalise;
mod params;
mod polar;
mod search;
mod starts;

pub use affine::{AffineFit, Aspect, fit_affine, refine_affine};
pub use near::{RowsAndAspect, Step, near};
pub use normalise::{Normalisation, normalise, normalise_similar};
pub use params::{Effort, Shape};
pub use polar::PolarPolygon;
pub use search::{Fit, FitProblem, Termination, at, minimise, minimise_exhaustive, unit_square_rows};
