//! The largest bias in texels and metres, and the largest shift by rounding the matrix to f32, over what is seen.
//!
//! Planning differentiates the matrix (`depth/bias.rs`); here slopes and areas are quotients of determinants. With A, B, C
//! the homogeneous images (x, y in texels, z window depth, w) of a point and of two directions, the plane through them is
//! their generalised cross product, so that a receiver's window slopes are z_u = -|y z w| / |x y w| and
//! z_v = |x z w| / |x y w|, and the area that the map gives to a unit of area is |x y w| / A.w³.

use super::super::seen::{Seen, looking_up};
use super::super::{LightPlan, MapPlan, domain};
use super::witness::window;
use crate::math::{first_holding, matrix_from_rows};
use crate::scene::Light;
use glam::{DMat3, DMat4, DVec3, DVec4};

/// Relative difference that is none: two formulas for slopes that grow without bound as light grazes a surface, where each
/// loses 1 / cosine roundings; this allows for 10⁹ of them.
const ACCURACY: f64 = 1e-6;

/// What does not hold of a light's maps, given the points that its entries speak of.
pub(super) fn faults(entry: &LightPlan, light: &Light, seen: &[Seen]) -> Vec<String> {
    let domains: Vec<_> = entry.maps.iter().map(|map| domain::read(&map.domain)).collect();
    let of_map = |(k, map): (usize, &MapPlan)| {
        let m = matrix_from_rows(&map.clip_from_world);
        let inside = looking_up(&m, seen, |p| first_holding(domains.iter(), p) == Some(k));
        let [texels, world] = largest_bias(map, &m, light, &inside);
        let (shift, rounding) = f32_shift(map, &m, &inside);
        let each = [
            ("bias.texels", map.bias.texels, texels, 0.0),
            ("bias.world", map.bias.world, world, 0.0),
            ("f32_roundtrip_texels", map.f32_roundtrip_texels, shift, rounding),
        ];
        let fault = |(key, planned, found, rounding): (&str, f64, f64, f64)| {
            let same = (planned - found).abs() <= ACCURACY * found + rounding;
            (!same).then(|| format!("{key} of map {k} is {planned} in the plan, {found} here"))
        };
        each.into_iter().filter_map(fault).collect::<Vec<String>>()
    };
    entry.maps.iter().enumerate().flat_map(of_map).collect()
}

/// In texels, and in metres along the light.
fn largest_bias(map: &MapPlan, m: &DMat4, light: &Light, inside: &[Seen]) -> [f64; 2] {
    let (width, height) = (f64::from(map.width), f64::from(map.height));
    let half = DVec3::new(0.5 * width, 0.5 * height, 0.5);
    let texels_from_clip = DMat4::from_translation(half) * DMat4::from_scale(half);
    let texels_from_scene = texels_from_clip * *m;
    let of = |s: &Seen| {
        let at = texels_from_scene * s.position.extend(1.0);
        let image = |direction: DVec3| texels_from_scene * direction.extend(0.0);
        let (b, c) = s.normal.any_orthonormal_pair();
        let plane = [at, image(b), image(c)];
        let area = minor(plane, |v| [v.x, v.y, v.w]);
        let (z_u, z_v) = (minor(plane, |v| [v.y, v.z, v.w]) / area, minor(plane, |v| [v.x, v.z, v.w]) / area);
        let bias = map.bias.drawn();
        let depth = bias.constant + (bias.slope * z_u.abs().max(z_v.abs())).min(bias.clamp);
        let ray = light.towards(s.position).normalize();
        let along = image(ray);
        let metres = depth * at.w * at.w / (along.z * at.w - at.z * along.w).abs();
        let (e, f) = ray.any_orthonormal_pair();
        let texels_per_metre = (minor([at, image(e), image(f)], |v| [v.x, v.y, v.w]) / at.w.powi(3)).abs().sqrt();
        (metres.is_finite() && texels_per_metre > 0.0).then_some([metres * texels_per_metre, metres])
    };
    inside.iter().filter_map(of).fold([0.0; 2], |m: [f64; 2], v| [m[0].max(v[0]), m[1].max(v[1])])
}

/// Determinant of three of the four coordinates of three vectors.
fn minor(vectors: [DVec4; 3], of: impl Fn(DVec4) -> [f64; 3]) -> f64 {
    let [a, b, c] = vectors.map(|v| DVec3::from(of(v)));
    DMat3::from_cols(a, b, c).determinant()
}

/// Largest shift, texels, with what roundings of f64 may change of it.
fn f32_shift(map: &MapPlan, m: &DMat4, inside: &[Seen]) -> (f64, f64) {
    let size = [f64::from(map.width), f64::from(map.height)];
    let rounded = matrix_from_rows(&map.clip_from_world.map(|row| row.map(|v| f64::from(v as f32))));
    let of = |s: &Seen| {
        let ((exact, own), (shifted, other)) = (window(m, s.position)?, window(&rounded, s.position)?);
        let each = [0, 1].map(|i| ((exact[i] - shifted[i]).abs() * size[i], (own[i] + other[i]) * size[i]));
        Some((each[0].0.max(each[1].0), each[0].1.max(each[1].1)))
    };
    inside.iter().filter_map(of).fold((0.0, 0.0), |m: (f64, f64), v| (m.0.max(v.0), m.1.max(v.1)))
}
