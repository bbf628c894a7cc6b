//! A light matrix as a camera at the light, where there is one.

use super::{Frustum, LightCamera, LightProjection};
use crate::depth::FINER;
use crate::methods::Region;
use crate::resolution::JudgedMap;
use glam::{DMat3, DMat4, DQuat, DVec3};

/// The camera of a matrix, or why there is none.
///
/// With f forward, up the part of row 2 across f, and right = f × up, row 1 is C (right + skew up) + E f and row 2 is
/// A up + B f (+ constants for parallel light).
pub(super) fn light_camera(map: &JudgedMap) -> Result<LightCamera, String> {
    let (region, m) = (&map.region, &map.clip_from_scene);
    if !map.depth.plain {
        return Err(if region.space.directional {
            "a perspective warp of parallel light is no camera: use the matrix".to_owned()
        } else {
            format!(
                "depth along the axis of this camera would be more than {FINER} times coarser: use the matrix, or ask for \
                 map.shape = \"affine\""
            )
        });
    }
    let row = |i: usize| m.row(i).truncate();
    let forward = region_forward(region, m);
    let up = (row(1) - forward * row(1).dot(forward)).try_normalize();
    let Some(up) = up else { return Err("the rows of the matrix are singular".to_owned()) };
    let right = forward.cross(up);
    let (c, d, a) = (row(0).dot(right), row(0).dot(up), row(1).dot(up));
    let rotation = DQuat::from_mat3(&DMat3::from_cols(right, up, -forward));
    let (position, frustum) = if region.space.directional {
        orthographic(region, m, forward, [c, a])
    } else {
        perspective(region, m, [c, a])
    };
    if !(frustum.near >= 0.0 && frustum.near < frustum.far && frustum.far.is_finite()) {
        return Err("its depth range has no far plane in front of the light: use the matrix".to_owned());
    }
    let projection =
        if region.space.directional { LightProjection::Orthographic } else { LightProjection::Perspective };
    let camera =
        LightCamera { projection, position: position.to_array(), rotation: rotation.to_array(), frustum, skew: d / c };
    Ok(camera)
}

fn region_forward(region: &Region, m: &DMat4) -> DVec3 {
    if region.space.directional { region.space.axes[2] } else { m.row(3).truncate().normalize() }
}

/// Eye at the light; sides on the near plane. x_clip = C x' + E w with C > 0, so the sides are where x_clip = ±w.
fn perspective(region: &Region, m: &DMat4, [c, a]: [f64; 2]) -> (DVec3, Frustum) {
    let forward = m.row(3).truncate();
    let scale = forward.length();
    let f = forward / scale;
    let eye = region.space.center - light_vector(region);
    // z_clip = P w + Q: -w at near, +w at far.
    let p = m.row(2).truncate().dot(f) / scale;
    let q = m.row(2).dot(eye.extend(1.0));
    let (near, far) = (-q / (p + 1.0) / scale, -q / (p - 1.0) / scale);
    let side = |row: usize, along: f64, sign: f64| (sign * scale - m.row(row).truncate().dot(f)) / along * near;
    let frustum = Frustum {
        left: side(0, c, -1.0),
        right: side(0, c, 1.0),
        bottom: side(1, a, -1.0),
        top: side(1, a, 1.0),
        near,
        far,
    };
    (eye, frustum)
}

/// C - L of the light plane.
fn light_vector(region: &Region) -> DVec3 {
    let [r1, r2, r3] = region.space.axes;
    let o = region.space.offset;
    r1 * o.x + r2 * o.y + r3 * o.z
}

/// Eye at the centre of the near plane, so that near = 0.
fn orthographic(_region: &Region, m: &DMat4, forward: DVec3, [c, a]: [f64; 2]) -> (DVec3, Frustum) {
    let w = m.row(3).w;
    let inverse = m.inverse();
    let eye = inverse.project_point3(DVec3::new(0.0, 0.0, -1.0));
    let depth = 2.0 * w / m.row(2).truncate().dot(forward);
    let (x, y) = (w / c, w / a);
    (eye, Frustum { left: -x, right: x, bottom: -y, top: y, near: 0.0, far: depth })
}
