//! One map of a plan, from what was fitted and certified.

use super::light_camera::light_camera;
use super::{MapBias, MapPlan, Witness, domain};
use crate::depth::bias_units;
use crate::math::{first_holding, matrix_from_rows, rows_of};
use crate::methods::Method;
use crate::raster::Bias;
use crate::resolution::JudgedMap;
use crate::scene::Light;
use crate::visibility::Tracer;
use glam::{DMat4, DVec2, DVec3};

/// A visible point that may look a map up: position, unit normal towards the camera, exact answer.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    pub(super) position: DVec3,
    pub(super) normal: DVec3,
    pub(super) shadowed: bool,
}

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
    let looked_up = |p: DVec3| answers(p) && uv_of(m, p).is_some_and(|(uv, _)| in_unit(uv));
    let inside: Vec<Seen> = seen.iter().copied().filter(|s| looked_up(s.position)).collect();
    let units = bias_units(m, size, light, &bias, inside.iter().map(|s| (s.position, s.normal)));
    let (light_camera, light_camera_reason) = match light_camera(map) {
        Ok(camera) => (Some(camera), None),
        Err(reason) => (None, Some(reason)),
    };
    MapPlan {
        method,
        domain: domain::written(&map.region.domain),
        clip_from_world: rows_of(m),
        width: size[0],
        height: size[1],
        near: map.depth.near_m,
        far: map.depth.far_m,
        bias: MapBias {
            constant: bias.constant,
            slope: bias.slope,
            clamp: bias.clamp.is_finite().then_some(bias.clamp),
            texels: units.texels,
            world: units.world_m,
        },
        light_camera,
        light_camera_reason,
        witnesses: witnesses(m, light, tracer, &inside, &answers),
        f32_roundtrip_texels: f32_roundtrip(m, size, &inside),
    }
}

/// Gives map `k` of a light another size, with what the entry says of bias and rounding there. `seen` as for [`map_entry`].
pub(super) fn resize(maps: &mut [MapPlan], k: usize, size: [u32; 2], light: &Light, seen: &[Seen]) {
    let domains: Vec<_> = maps.iter().map(|m| domain::read(&m.domain)).collect();
    let Some(map) = maps.get_mut(k) else { return };
    let m = matrix_from_rows(&map.clip_from_world);
    let answers = |p: DVec3| first_holding(domains.iter(), p) == Some(k);
    let looked_up = |s: &Seen| answers(s.position) && uv_of(&m, s.position).is_some_and(|(uv, _)| in_unit(uv));
    let inside: Vec<Seen> = seen.iter().copied().filter(looked_up).collect();
    let units = bias_units(&m, size, light, &map.bias.drawn(), inside.iter().map(|s| (s.position, s.normal)));
    (map.bias.texels, map.bias.world) = (units.texels, units.world_m);
    map.f32_roundtrip_texels = f32_roundtrip(&m, size, &inside);
    [map.width, map.height] = size;
}

/// Map coordinates in [0, 1] and window depth; `None` behind the light.
pub(super) fn uv_of(m: &DMat4, point: DVec3) -> Option<(DVec2, f64)> {
    let clip = *m * point.extend(1.0);
    (clip.w > 0.0).then(|| {
        let ndc = clip.truncate() / clip.w * 0.5 + 0.5;
        (ndc.truncate(), ndc.z)
    })
}

fn in_unit(uv: DVec2) -> bool {
    uv.cmpge(DVec2::ZERO).all() && uv.cmplt(DVec2::ONE).all()
}

/// Extremes of the seen points in eight directions, and two of them lifted towards the light, so that the set is not flat
/// even over a flat floor.
fn witnesses(
    m: &DMat4,
    light: &Light,
    tracer: Option<&Tracer>,
    inside: &[Seen],
    answers: &impl Fn(DVec3) -> bool,
) -> Vec<Witness> {
    let Some(first) = inside.first() else { return Vec::new() };
    let mut chosen: Vec<(DVec3, bool)> = Vec::new();
    let mut add = |position: DVec3, shadowed: bool| {
        if !chosen.iter().any(|(p, _)| *p == position) {
            chosen.push((position, shadowed));
        }
    };
    for k in 0..8 {
        let sign = |bit: usize| if k >> bit & 1 == 0 { 1.0 } else { -1.0 };
        let direction = DVec3::new(sign(0), sign(1) * 0.7, sign(2) * 1.3);
        let far =
            inside.iter().fold(first, |b, s| if s.position.dot(direction) > b.position.dot(direction) { s } else { b });
        add(far.position, far.shadowed);
    }
    for answer in [true, false] {
        if let Some(s) = inside.iter().find(|s| s.shadowed == answer) {
            add(s.position, s.shadowed);
        }
    }
    // Lifted by halving steps until it still lies in the map's depth range and looks the map up.
    let from: Vec<&Seen> = inside.iter().filter(|s| tracer.is_some() || !s.shadowed).collect();
    let spread = [0, from.len() / 2, from.len().saturating_sub(1)];
    for s in spread.into_iter().filter_map(|k| from.get(k)) {
        let towards = light.towards(s.position);
        let reach = if light.position().is_some() { 0.5 } else { inside_extent(inside) };
        for halving in 0..8 {
            let lifted = s.position + towards * (reach * 0.5_f64.powi(halving));
            let in_range = uv_of(m, lifted).is_some_and(|(uv, depth)| in_unit(uv) && (0.0..=1.0).contains(&depth));
            if in_range && answers(lifted) {
                let end = if light.position().is_some() { 1.0 } else { f64::INFINITY };
                add(lifted, tracer.is_some_and(|t| t.occluded(lifted, light.towards(lifted), 0.0, end)));
                break;
            }
        }
    }
    chosen
        .into_iter()
        .filter_map(|(world, shadowed)| {
            let (uv, depth) = uv_of(m, world)?;
            Some(Witness { world: world.to_array(), uv: uv.to_array(), depth, shadowed })
        })
        .collect()
}

fn inside_extent(inside: &[Seen]) -> f64 {
    crate::math::Bounds::of(inside.iter().map(|s| s.position)).diagonal()
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
