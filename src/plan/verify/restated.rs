//! What a map's entry says in other words than its matrix, the camera at the light; and that the matrix's depth range
//! holds the pixels. Each is derived again, by other code than wrote it.

use super::super::{LightCamera, LightPlan, LightProjection, MapPlan};
use super::light::knew_pixels;
use crate::job::Job;
use crate::math::{first_holding, matrix_from_rows};
use crate::measure::{Drawn, Receivers};
use crate::scene::{Light, LightKind};
use glam::{DMat4, DQuat, DVec3, DVec4};

/// Part of a row's largest entry by which the matrix of a light camera may differ. Its near plane is a difference of
/// nearly equal numbers, and loses `far / near` roundings; this allows for 10⁶ of them.
const CAMERA_ACCURACY: f64 = 1e-9;

/// Part of a map's depth range by which a receiver may lie nearer than `near` or farther than `far`: the search for them may
/// pass over what is nearer still, or farther, by less. The matrix's own range leaves more free.
const RANGE_ACCURACY: f64 = 1e-3;
/// Besides, as a part of the distance: 32 roundings of f64, for lamps so far away that they are more than the range.
const DISTANCE_ACCURACY: f64 = 32.0 * f64::EPSILON;

/// What does not hold of the maps of a light.
pub(super) fn faults(
    entry: &LightPlan,
    light: &Light,
    receivers: &Receivers,
    drawn: &[Drawn],
    job: &Job,
) -> Vec<String> {
    let mut faults = Vec::new();
    if knew_pixels(job) {
        faults.extend(range_faults(entry, light, receivers, drawn));
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

/// Receivers that look a map up lie within its clip depth, without tolerance, because planning leaves a margin free at both
/// ends; and in metres between `near` and `far`.
fn range_faults(entry: &LightPlan, light: &Light, receivers: &Receivers, drawn: &[Drawn]) -> Vec<String> {
    let mut clipped = vec![0_u64; drawn.len()];
    let mut reach = vec![[f64::INFINITY, f64::NEG_INFINITY]; drawn.len()];
    for point in &receivers.positions {
        let Some(k) = first_holding(drawn.iter().map(|d| &d.domain), *point) else { continue };
        let m = &drawn[k].clip_from_scene;
        let clip = *m * point.extend(1.0);
        let inside = |c: f64| c >= -clip.w && c < clip.w;
        let looks_up = clip.w > 0.0 && inside(clip.x) && inside(clip.y);
        clipped[k] += u64::from(looks_up && clip.z.abs() > clip.w);
        if looks_up {
            let metres = match light.kind {
                LightKind::Directional { direction } => direction.dot(*point),
                LightKind::Point { .. } | LightKind::Spot { .. } => clip.w / m.row(3).truncate().length(),
            };
            reach[k] = [reach[k][0].min(metres), reach[k][1].max(metres)];
        }
    }
    let clipped = clipped.into_iter().enumerate().filter(|(_, n)| *n > 0);
    let mut faults: Vec<String> =
        clipped.map(|(k, n)| format!("{n} pixels that look map {k} up lie out of its clip depth")).collect();
    for ((k, map), [low, high]) in entry.maps.iter().enumerate().zip(reach) {
        let free = RANGE_ACCURACY * (map.far - map.near) + DISTANCE_ACCURACY * map.near.abs().max(map.far.abs());
        if low < map.near - free || high > map.far + free {
            let (near, far) = (map.near, map.far);
            faults.push(format!(
                "pixels that look map {k} up lie {low} m to {high} m away, near and far are {near} and {far}"
            ));
        }
    }
    faults
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
