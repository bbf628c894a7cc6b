//! lixel plans shadow maps offline: per frame and light, the light matrix that wastes fewest texels on what the camera
//! sees, and the smallest map that keeps the wrongly shadowed pixels under the user's epsilon.
//!
//! Data flows one way: scene → visibility → samples → metric → fit → methods → depth → raster → measure → resolution →
//! plan. Each module knows only those before it; `docs/architecture.md` has the house.
//!
//! # Conventions
//! * **World**: right-handed, metres, y up, as in glTF. Inputs that differ are converted once, on load.
//! * **Scene space**: world minus `Scene::origin`; everything after `scene` works in it. The origin is zero unless the
//!   scene lies so far out that f32 vertices would lose it.
//! * Column vectors; `b_from_a` maps a to b. Matrices are written as 4 rows of 4.
//! * **Clip space** is OpenGL's: -w ≤ x, y, z ≤ w, y up. Map texel (0, 0) is at the bottom left; depth is 0 near and 1
//!   far after the viewport.
//! * **Film** coordinates are pixels, x right, y **down** from the top left corner; pixel centres lie at half integers.
//! * A directional light's `direction` is the way light travels.
//! * Angles are radians and carry `_rad`, unless a user wrote them (degrees).

pub mod budget;
pub mod compare;
pub mod depth;
pub mod fit;
pub mod job;
pub mod math;
pub mod measure;
pub mod methods;
pub mod metric;
pub mod picture;
pub mod plan;
pub mod raster;
pub mod resolution;
pub mod samples;
pub mod scene;
pub mod shot;
pub mod trade;
pub mod visibility;
