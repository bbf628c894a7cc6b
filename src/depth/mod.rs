//! Row 3, near and far, and bias for a chosen homography, from the triangles it keeps (math note §7).
//!
//! Along a light ray a caster has a smaller w (point, spot) or a smaller d = r3·X (directional) than its receiver. No row
//! of a 4x4 matrix gives depth along the light exactly under a warp; the row is linear:
//!
//! ```text
//! a camera at a lamp:   z/w = B / w + b,            B < 0,  largest |B| with  -w ≤ B + b w ≤ w
//! any other:            z/w = (g·q + β d) / w,      β > 0,  largest β   with  -w ≤ g·q + β d ≤ w
//! ```
//!
//! over everything kept: casters between the light and what is covered, inside the map, and every visible point that
//! looks the map up. Both are one linear program on homogeneous vectors (q, e) with e = d, the distance along the light.

mod bias;
mod kept;
mod reach;
mod row;
mod unseen;
mod visible;

pub use bias::{BiasUnits, CONSTANT_F32, MapAt, bias_units};
pub use kept::Kept;
pub use reach::reach;
pub use row::{DepthError, DepthRow, FINER, RowKind, fit_row};
pub use unseen::Unseen;
pub use visible::Visible;
