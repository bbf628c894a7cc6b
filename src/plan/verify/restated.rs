//! What a map's entry says in other words than its matrix, the camera at the light; and that the matrix's depth range
//! holds the pixels. Each is derived again, by other code than wrote it.

use super::super::remeasure::Remeasured;
use super::super::{LightCamera, LightPlan, LightProjection, MapPlan};
use crate::job::Job;
use crate::math::{first_holding, matrix_from_rows};
use glam::{DMat4, DQuat, DVec3, DVec4};

/// Part of a row's largest entry by which the matrix of a light camera may differ. Its near plane is a difference of
/// nearly equal numbers, and loses `far / near` roundings; this allows for 10⁶ of them.
const CAMERA_ACCURACY: f64 = 1e-9;

/// What does not hold of the maps of a light.
pub(super) fn faults(entry: &LightPlan, measured: &Remeasured, job: &Job) -> Vec<String> {
    let mut faults = Vec::new();
    // Without measuring, the range was found on the planning grid, not for every pixel.
    if job.quality.measure.measures() {
        faults.extend(range_faults(measured));
    }
    for (k, map) in entry.maps.iter().enumerate() {
        let camera = map.light_camera.as_ref();
        if camera.is_some_and(|camera| !is_camera_of(camera, map)) {
            faults.push(format!("light_camera of map {k} is not the camera of its matrix"));
        }
        if camera.is_some() == map.light_camera_reason.is_some() {
            faults.push(format!("map {k} has to have either a light_camera or a light_camera_reason"));
        }
    }
    faults
}

/// Receivers that look a map up lie within its clip depth. No tolerance: planning leaves a margin free at both ends.
fn range_faults(measured: &Remeasured) -> Vec<String> {
    let drawn = &measured.drawn;
    let mut clipped = vec![0_u64; drawn.len()];
    for point in &measured.receivers.positions {
        let Some(k) = first_holding(drawn.iter().map(|d| &d.domain), *point) else { continue };
        let clip = drawn[k].clip_from_scene * point.extend(1.0);
        let inside = |c: f64| c >= -clip.w && c < clip.w;
        let looks_up = clip.w > 0.0 && inside(clip.x) && inside(clip.y);
        clipped[k] += u64::from(looks_up && clip.z.abs() > clip.w);
    }
    let fault = |(k, n): (usize, u64)| format!("{n} pixels that look map {k} up lie out of its clip depth");
    clipped.into_iter().enumerate().filter(|(_, n)| *n > 0).map(fault).collect()
}

/// Whether a camera, written out as glFrustum or glOrtho would, is the map's matrix but for a factor.
fn is_camera_of(camera: &LightCamera, map: &MapPlan) -> bool {
    let m = matrix_from_rows(&map.clip_from_world);
    let rebuilt = clip_from_scene(camera);
    let factor = match camera.projection {
        LightProjection::Perspective => m.row(3).truncate().length(),
        LightProjection::Orthographic => m.row(3).w,
    };
    (0..4).all(|i| {
        let largest = m.row(i).abs().max_element();
        ((rebuilt.row(i) * factor - m.row(i)).abs().max_element()) <= CAMERA_ACCURACY * largest
    })
}

fn clip_from_scene(camera: &LightCamera) -> DMat4 {
    let f = &camera.frustum;
    let (width, height, depth) = (f.right - f.left, f.top - f.bottom, f.far - f.near);
    let (x, y, z) = ((f.right + f.left) / width, (f.top + f.bottom) / height, (f.far + f.near) / depth);
    let projection = match camera.projection {
        LightProjection::Perspective => DMat4::from_cols(
            DVec4::new(2.0 * f.near / width, 0.0, 0.0, 0.0),
            DVec4::new(0.0, 2.0 * f.near / height, 0.0, 0.0),
            DVec4::new(x, y, -z, -1.0),
            DVec4::new(0.0, 0.0, -2.0 * f.far * f.near / depth, 0.0),
        ),
        LightProjection::Orthographic => DMat4::from_cols(
            DVec4::new(2.0 / width, 0.0, 0.0, 0.0),
            DVec4::new(0.0, 2.0 / height, 0.0, 0.0),
            DVec4::new(0.0, 0.0, -2.0 / depth, 0.0),
            DVec4::new(-x, -y, -z, 1.0),
        ),
    };
    let skewed = DMat4::from_cols(DVec4::X, DVec4::new(camera.skew, 1.0, 0.0, 0.0), DVec4::Z, DVec4::W);
    let turned = DMat4::from_quat(DQuat::from_array(camera.rotation).conjugate());
    projection * skewed * turned * DMat4::from_translation(-DVec3::from(camera.position))
}
