//! The footprint of a texel on the film at exact shadow edges, by finite differences of finished matrices.

use super::{Drawn, Receivers};
use crate::scene::{Camera, Film};
use crate::visibility::Surface;
use glam::{DMat2, DVec2, DVec3};
use rayon::prelude::*;

/// Half step of the differences, pixels: truncation and rounding of f64 are both far below a part in a million.
const HALF_STEP_PX: f64 = 1e-3;

/// The root of SOSM's summand ‖J⁻¹‖² (eq. 6), pixels per texel, at the quantile over receivers beside an exact shadow edge;
/// 0 without edges. Infinite where the map has no texel at all. `surface` is what a pixel of the film sees.
pub fn footprint(
    surface: impl Fn(usize) -> Option<Surface> + Sync,
    film: Film,
    camera: &Camera,
    receivers: &Receivers,
    maps: &[Drawn],
    quantile: f64,
) -> f64 {
    let beside = beside_edges(receivers, film);
    let mut sizes: Vec<f64> = beside
        .par_iter()
        .with_min_len(1024)
        .map(|i| {
            let pixel = receivers.pixels[*i] as usize;
            surface(pixel).and_then(|s| at(&s, film, camera, pixel, maps)).unwrap_or(f64::INFINITY)
        })
        .collect();
    sizes.sort_by(f64::total_cmp);
    let rank = (quantile * sizes.len() as f64).ceil() as usize;
    sizes.get(rank.max(1) - 1).copied().unwrap_or(0.0)
}

/// Receivers whose right or lower neighbour is a receiver with the other answer.
fn beside_edges(receivers: &Receivers, film: Film) -> Vec<usize> {
    let mut answers = vec![0_u8; film.pixels()];
    for (pixel, shadowed) in receivers.pixels.iter().zip(&receivers.shadowed) {
        answers[*pixel as usize] = 1 + u8::from(*shadowed);
    }
    let width = film.width as usize;
    let differs = |a: usize, b: usize| answers.get(b).is_some_and(|b| *b != 0 && *b != answers[a]);
    (0..receivers.len())
        .filter(|i| {
            let pixel = receivers.pixels[*i] as usize;
            (pixel % width + 1 < width && differs(pixel, pixel + 1)) || differs(pixel, pixel + width)
        })
        .collect()
}

fn at(surface: &Surface, film: Film, camera: &Camera, pixel: usize, maps: &[Drawn]) -> Option<f64> {
    let width = film.width as usize;
    let (x, y) = ((pixel % width) as f64 + 0.5, (pixel / width) as f64 + 0.5);
    let derivatives = surface.film_derivatives(camera, film, x, y);
    let map = maps.iter().find(|m| m.domain.holds(surface.position))?;
    let texel = |p: DVec3| {
        let clip = map.clip_from_scene * p.extend(1.0);
        let size = DVec2::new(f64::from(map.map.width), f64::from(map.map.height));
        (clip.w > 0.0).then(|| clip.truncate().truncate() / clip.w * 0.5 * size)
    };
    let column = |t: DVec3| {
        let (ahead, behind) =
            (texel(surface.position + t * HALF_STEP_PX)?, texel(surface.position - t * HALF_STEP_PX)?);
        Some((ahead - behind) / (2.0 * HALF_STEP_PX))
    };
    let jacobian = DMat2::from_cols(column(derivatives[0])?, column(derivatives[1])?);
    let inverse = jacobian.inverse();
    let size = inverse.x_axis.length_squared() + inverse.y_axis.length_squared();
    size.is_finite().then(|| size.sqrt())
}
