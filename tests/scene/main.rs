//! The scene room through its public interface.
#![expect(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

mod compressed;
mod corpus;
mod deform;
mod fixture;
mod gltf;
mod hostile;
mod masks;
mod play;
mod shot;
mod sources;
