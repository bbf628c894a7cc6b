//! How much depth bias a map needs, in window depth, texels and metres.
//!
//! A texel stores the depth of its centre; a receiver half a texel away in both directions lies up to
//! (|z_u| + |z_v|)/2 ≤ max(|z_u|, |z_v|) deeper on the same plane. Polygon offset with factor 1 covers that exactly; the
//! constant covers f32 rounding.

use crate::raster::Bias;
use crate::scene::Light;
use glam::{DMat4, DVec3, DVec4};

/// A bias as the largest over receivers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BiasUnits {
    /// Distance along the light over the size of a texel across it.
    pub texels: f64,
    /// Distance along the light, metres.
    pub world_m: f64,
}

/// Constant bias, window depth: four steps of f32 at depth 1. One for rounding the stored depth, one for the receiver's,
/// two for a consumer that evaluates the matrix in f32 relative to its origin.
pub const CONSTANT_F32: f64 = 4.0 / (1u32 << 24) as f64;

/// The largest bias over receivers (position, unit normal), for a map of a size in texels.
pub fn bias_units(
    clip_from_scene: &DMat4,
    size: [u32; 2],
    light: &Light,
    bias: &Bias,
    receivers: impl Iterator<Item = (DVec3, DVec3)>,
) -> BiasUnits {
    let mut units = BiasUnits::default();
    for (position, normal) in receivers {
        let Some((world_m, texels)) = at(clip_from_scene, size, light, bias, position, normal) else { continue };
        units.world_m = units.world_m.max(world_m);
        units.texels = units.texels.max(texels);
    }
    units
}

fn at(m: &DMat4, size: [u32; 2], light: &Light, bias: &Bias, position: DVec3, normal: DVec3) -> Option<(f64, f64)> {
    let map = MapAt::new(m, size, position)?;
    let ray = -light.towards(position).normalize();
    let (e1, e2) = ray.any_orthonormal_pair();
    let (a, b) = (map.along(e1), map.along(e2));
    let texel_m = 1.0 / (a.x * b.y - a.y * b.x).abs().sqrt();
    let world_m = bias.of(map.slopes(normal)) / map.along(ray).z.abs();
    (world_m.is_finite() && texel_m.is_finite()).then_some((world_m, world_m / texel_m))
}

/// A map at a scene point: what it makes of small steps from there.
#[derive(Clone, Copy, Debug)]
pub struct MapAt<'a> {
    clip_from_scene: &'a DMat4,
    size: [u32; 2],
    clip: DVec4,
}

impl<'a> MapAt<'a> {
    /// For a map of a size in texels; `None` behind its camera.
    pub fn new(clip_from_scene: &'a DMat4, size: [u32; 2], position: DVec3) -> Option<MapAt<'a>> {
        let clip = *clip_from_scene * position.extend(1.0);
        (clip.w > 0.0).then_some(MapAt { clip_from_scene, size, clip })
    }

    /// Window depth of the point.
    pub fn window_depth(&self) -> f64 {
        0.5 + 0.5 * self.clip.z / self.clip.w
    }

    /// Texels u, v and window depth, differentiated along a scene vector.
    fn along(&self, t: DVec3) -> DVec3 {
        let (d, clip) = (*self.clip_from_scene * t.extend(0.0), self.clip);
        let ndc = |c: f64, dc: f64| (dc - c / clip.w * d.w) / clip.w;
        let half = |k: u32| 0.5 * f64::from(k);
        DVec3::new(ndc(clip.x, d.x) * half(self.size[0]), ndc(clip.y, d.y) * half(self.size[1]), ndc(clip.z, d.z) * 0.5)
    }

    /// |z_u| and |z_v| of the plane with a unit normal, window depth per texel; not finite where the light sees it edge-on.
    pub fn slopes(&self, normal: DVec3) -> [f64; 2] {
        let (t1, t2) = normal.any_orthonormal_pair();
        let (p, q) = (self.along(t1), self.along(t2));
        let det = p.x * q.y - p.y * q.x;
        [(p.z * q.y - q.z * p.y) / det, (q.z * p.x - p.z * q.x) / det].map(f64::abs)
    }
}
