//! Lookups under the ideal bias: what is left is the error of resampling alone.
//!
//! A texel stores the depth at its centre. The receiver is not compared at its own depth but at that of its plane there.
//! A homogeneous matrix takes the plane to a plane of window space, so that depth is z + z_u Δu + z_v Δv exactly, with the
//! slopes found from two tangents t of the receiver: (z_u, z_v) (∂_t u, ∂_t v) = ∂_t z. No renderer has this for free; it
//! tells apart what a better matrix and what a better bias could gain.

use crate::depth::CONSTANT_F32;
use crate::measure::{Drawn, Outside, Receivers};
use crate::scene::Camera;
use crate::visibility::{Tracer, View};
use glam::{DMat4, DVec3};
use rayon::prelude::*;

/// Indices of the receivers that maps drawn without bias answer wrongly, ascending.
pub(super) fn wrong(
    tracer: &Tracer,
    view: &View,
    camera: &Camera,
    receivers: &Receivers,
    maps: &[Drawn],
    outside: Outside,
) -> Vec<u32> {
    (0..receivers.len())
        .into_par_iter()
        .with_min_len(4096)
        .filter(|i| {
            let surface = view.surface(tracer, camera, receivers.pixels[*i] as usize);
            let normal = surface.map_or(DVec3::ZERO, |s| s.normal);
            let found = shadowed(maps, receivers.positions[*i], normal);
            found.unwrap_or(outside == Outside::Shadowed) != receivers.shadowed[*i]
        })
        .map(|i| i as u32)
        .collect()
}

/// The answer of the first map whose domain holds a point with a unit normal; `None` outside it.
fn shadowed(maps: &[Drawn], point: DVec3, normal: DVec3) -> Option<bool> {
    let drawn = maps.iter().find(|m| m.domain.holds(point))?;
    let (width, height) = (drawn.map.width, drawn.map.height);
    let [at, t1, t2] = window(&drawn.clip_from_scene, [width, height], point, normal)?;
    if !(at.x >= 0.0 && at.x < f64::from(width) && at.y >= 0.0 && at.y < f64::from(height)) {
        return None;
    }
    let det = t1.x * t2.y - t1.y * t2.x;
    let (z_u, z_v) = ((t1.z * t2.y - t2.z * t1.y) / det, (t2.z * t1.x - t1.z * t2.x) / det);
    let there = at.z + z_u * (at.x.floor() + 0.5 - at.x) + z_v * (at.y.floor() + 0.5 - at.y);
    // A receiver exactly edge-on to the light has no plane depth; its own serves.
    let depth = if there.is_finite() { there } else { at.z };
    let stored = drawn.map.depth[at.y as usize * width as usize + at.x as usize];
    Some(depth.clamp(0.0, 1.0) > f64::from(stored) + CONSTANT_F32)
}

/// Texels u, v and window depth of a point, and their derivatives along two tangents; `None` behind the light.
fn window(clip_from_scene: &DMat4, size: [u32; 2], point: DVec3, normal: DVec3) -> Option<[DVec3; 3]> {
    let clip = *clip_from_scene * point.extend(1.0);
    if clip.w <= 0.0 {
        return None;
    }
    let half = DVec3::new(0.5 * f64::from(size[0]), 0.5 * f64::from(size[1]), 0.5);
    let ndc = clip.truncate() / clip.w;
    let along = |t: DVec3| {
        let d = *clip_from_scene * t.extend(0.0);
        (d.truncate() - ndc * d.w) / clip.w * half
    };
    let (t1, t2) = normal.normalize_or(DVec3::Y).any_orthonormal_pair();
    Some([(ndc + DVec3::ONE) * half, along(t1), along(t2)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Domain;
    use crate::raster::{Bias, draw};
    use crate::scene::Geometry;
    use glam::{DVec4, Vec3};

    /// A slope under a warped light from above: without bias about half its points shadow themselves, by the plane none.
    #[test]
    fn a_plane_does_not_shadow_itself() {
        let v = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
        let triangles = [
            [v(-1.0, 0.9, -1.0), v(1.0, -0.2, -1.0), v(-1.0, 0.4, 1.0)],
            [v(1.0, -0.2, -1.0), v(1.0, -0.7, 1.0), v(-1.0, 0.4, 1.0)],
        ];
        let geometry = Geometry::plain(&triangles, &[]);
        let m = DMat4::from_cols(
            DVec4::new(1.0, 0.0, 0.0, 0.0),
            DVec4::new(0.0, 0.0, -1.0, 0.0),
            DVec4::new(0.0, 0.7, 0.0, 0.3),
            DVec4::new(0.0, 0.0, 0.0, 1.5),
        );
        let map = draw(geometry, &m, 37, 29, Bias::NONE).unwrap();
        let maps = [Drawn { domain: Domain::All, clip_from_scene: m, map }];
        let (corner, across, down) =
            (triangles[0][0].as_dvec3(), DVec3::new(2.0, -1.1, 0.0), DVec3::new(0.0, -0.5, 2.0));
        let normal = down.cross(across).normalize();
        let mut plain = 0;
        for (i, j) in (1..60).flat_map(|i| (1..60).map(move |j| (i, j))) {
            let point = corner + across * (f64::from(i) / 60.0) + down * (f64::from(j) / 60.0);
            assert_eq!(shadowed(&maps, point, normal), Some(false), "{point}");
            plain += u32::from(matches!(
                crate::measure::look_up(&maps, point),
                crate::measure::Looked::Answered { shadowed: true }
            ));
        }
        assert!((1000..2500).contains(&plain), "{plain}");
        let below = corner + across * 0.5 + down * 0.5 - DVec3::Y * 0.2;
        assert_eq!(shadowed(&maps, below, normal), Some(true));
    }
}
