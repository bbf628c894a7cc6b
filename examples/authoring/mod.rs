//! What the example scenes are written with: triangles, a glTF document, a seeded stream. Each example uses a part of it.

#![allow(dead_code, reason = "each example uses a part of the shapes, and one only has keys")]

pub(crate) mod document;
pub(crate) mod mesh;
pub(crate) mod pose;
pub(crate) mod schema;
