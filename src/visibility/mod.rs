//! What the camera sees and what the light reaches, by rays: exact up to the rounding of f32 vertices.
//!
//! [`Bvh`] sorts triangles for rays, [`Tracer`] sends rays through the still and the moving ones of a frame,
//! [`surface_at`] finds the surface behind a film position, [`answer`] asks whether a light reaches it, and [`see`] and
//! [`classify`] do both for every pixel of a film. Nothing here knows of shadow maps.

mod bvh;
mod collapse;
mod kernel;
mod lanes;
mod parts;
mod pieces;
mod ray;
mod shadow;
mod shared;
mod simd;
mod solid;
mod surface;
mod through;
mod top;
mod trace;
mod view;
mod walk;
mod wide;

pub use bvh::Bvh;
pub use parts::Part;
pub use shadow::{Answer, EDGE_ON_DEGREES, RayOffset, UNCERTAIN_MULTIPLE, answer, edge_on, edge_on_at};
pub(crate) use surface::first_hit;
pub use surface::{Surface, surface_at};
pub use trace::{Hit, Tracer};
pub use view::{NO_TRIANGLE, View, classify, see};
