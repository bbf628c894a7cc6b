//! One map of a plan, from what was fitted and certified.

use super::light_camera::light_camera;
use super::seen::{Seen, looking_up, uv_of};
use super::witnesses::{Place, witnesses};
use super::{MapBias, MapPlan, domain};
use crate::depth::bias_units;
use crate::math::{first_holding, matrix_from_rows, rows_of};
use crate::methods::Method;
use crate::raster::Bias;
use crate::resolution::JudgedMap;
use crate::scene::Light;
use crate::visibility::Tracer;
use glam::{DMat4, DVec2, DVec3};

/// What was chosen for a map besides its matrix.
pub(super) struct Chosen {
    pub(super) method: Method,
    pub(super) size: [u32; 2],
    pub(super) bias: Bias,
}

/// Writes the entry of a map. `seen` are visible points of the light, a few thousand are enough; `answers` says whether
/// this is the map that a point looks up. Without a `tracer` only points between lit ones and the light are known to be lit.
pub(super) fn map_entry(
    map: &JudgedMap,
    &Chosen { method, size, bias }: &Chosen,
    light: &Light,
    tracer: Option<&Tracer>,
    seen: &[Seen],
    answers: impl Fn(DVec3) -> bool,
) -> MapPlan {
    let m = &map.clip_from_scene;
    let inside = looking_up(m, seen, &answers);
    let units = bias_units(m, size, light, &bias, inside.iter().map(|s| (s.position, s.normal)));
    let (light_camera, light_camera_reason) = match light_camera(map) {
        Ok(camera) => (Some(camera), None),
        Err(reason) => (None, Some(reason)),
    };
    // Of the region's own plane, which goes with a light that moves.
    let from_origin = map.region.space.center_along();
    let (witnesses, witnesses_reason) = witnesses(&Place { m, light, tracer, answers: &answers }, &inside);
    MapPlan {
        method,
        domain: domain::written(&map.region.domain),
        clip_from_world: rows_of(m),
        width: size[0],
        height: size[1],
        near: map.depth.near_m + from_origin,
        far: map.depth.far_m + from_origin,
        bias: MapBias {
            constant: bias.constant,
            slope: bias.slope,
            clamp: bias.clamp.is_finite().then_some(bias.clamp),
            texels: units.texels,
            world: units.world_m,
        },
        light_camera,
        light_camera_reason,
        witnesses,
        witnesses_reason,
        f32_roundtrip_texels: f32_roundtrip(m, size, &inside),
    }
}

/// Gives map `k` of a light another size, with what the entry says of bias and rounding there. `seen` as for [`map_entry`].
pub(super) fn resize(maps: &mut [MapPlan], k: usize, size: [u32; 2], light: &Light, seen: &[Seen]) {
    let domains: Vec<_> = maps.iter().map(|m| domain::read(&m.domain)).collect();
    let Some(map) = maps.get_mut(k) else { return };
    let m = matrix_from_rows(&map.clip_from_world);
    let answers = |p: DVec3| first_holding(domains.iter(), p) == Some(k);
    let inside = looking_up(&m, seen, answers);
    let units = bias_units(&m, size, light, &map.bias.drawn(), inside.iter().map(|s| (s.position, s.normal)));
    (map.bias.texels, map.bias.world) = (units.texels, units.world_m);
    map.f32_roundtrip_texels = f32_roundtrip(&m, size, &inside);
    [map.width, map.height] = size;
}

/// Largest shift of a seen point, texels, when every entry of the matrix is rounded to f32.
fn f32_roundtrip(m: &DMat4, size: [u32; 2], inside: &[Seen]) -> f64 {
    let rounded = DMat4::from_cols_array(&m.to_cols_array().map(|v| f64::from(v as f32)));
    let size = DVec2::new(f64::from(size[0]), f64::from(size[1]));
    inside
        .iter()
        .filter_map(|s| {
            let (a, b) = (uv_of(m, s.position)?, uv_of(&rounded, s.position)?);
            Some(((a.0 - b.0) * size).abs().max_element())
        })
        .fold(0.0, f64::max)
}
