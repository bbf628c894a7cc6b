//! When a frame is, and how a camera or a light is turned.

use glam::{DMat3, DQuat, DVec3};

const FRAMES_PER_SECOND: f64 = 24.0;

/// Seconds; frame 1 is at t = 0.
pub(crate) fn frame_time_s(frame: f64) -> f64 {
    (frame - 1.0) / FRAMES_PER_SECOND
}

/// World from camera for a camera that looks along its -z, y up.
pub(crate) fn looking(from: DVec3, at: DVec3) -> DQuat {
    let backward = (from - at).normalize();
    let right = DVec3::Y.cross(backward).normalize();
    DQuat::from_mat3(&DMat3::from_cols(right, backward.cross(right), backward))
}
