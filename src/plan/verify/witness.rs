//! Whether witnesses are what the plan says.
//!
//! u, v and depth are computed again. A coordinate is a quotient of two sums of four products; each sum is right to 4
//! roundings of the sum of its terms' magnitudes, by whatever order it is summed in, and two such evaluations may differ
//! by twice that.
//!
//! The exact answer of a witness that is the surface point of a pixel is that pixel's, lifted along its normal as every
//! shadow ray. Any other witness is a point in free space: the ray to the light starts at the point itself.

use glam::{DMat4, DVec3, DVec4};

use super::super::remeasure::Seeing;
use super::super::{LightPlan, Witness, domain};
use crate::math::matrix_from_rows;
use crate::scene::Light;
use crate::visibility::{Answer, answer};

/// Roundings by which two evaluations of a coordinate may differ: of numerator and denominator 4 each, of quotient and
/// viewport 4, twice.
const ROUNDINGS: f64 = 24.0;

/// What is wrong with a witness of map `k` of a light. `is_shadowed` is the exact answer at a point, where it is known.
pub(super) fn fault(
    entry: &LightPlan,
    k: usize,
    witness: &Witness,
    is_shadowed: &impl Fn(DVec3) -> Option<bool>,
) -> Option<String> {
    let point = DVec3::from(witness.world);
    let map = &entry.maps[k];
    match entry.maps.iter().position(|m| domain::read(&m.domain).holds(point)) {
        Some(first) if first == k => {}
        Some(first) => return Some(format!("witness {point} of map {k} lies in the domain of map {first}")),
        None => return Some(format!("witness {point} of map {k} lies in no domain")),
    }
    let told = [witness.uv[0], witness.uv[1], witness.depth];
    let Some((found, tolerance)) = window(&matrix_from_rows(&map.clip_from_world), point) else {
        return Some(format!("witness {point} lies behind the light"));
    };
    let agrees = (0..3).all(|i| (told[i] - found[i]).abs() <= tolerance[i]);
    if !agrees {
        return Some(format!("witness {point} has uv and depth {told:?} in the plan, the matrix gives {found:?}"));
    }
    let shadowed = is_shadowed(point)?;
    (shadowed != witness.shadowed).then(|| {
        let word = |shadowed: bool| if shadowed { "in shadow" } else { "lit" };
        format!("witness {point} is {} in the plan, {} exactly", word(witness.shadowed), word(shadowed))
    })
}

/// u, v and depth of a point, and how far two evaluations of them may lie apart; `None` behind the light.
pub(super) fn window(clip_from_scene: &DMat4, point: DVec3) -> Option<([f64; 3], [f64; 3])> {
    let point = point.extend(1.0);
    let clip = *clip_from_scene * point;
    let rows = clip_from_scene.transpose();
    let terms = |row: DVec4| (row * point).abs().element_sum();
    let w_terms = terms(rows.w_axis);
    let ndc = clip.truncate() / clip.w;
    let each = [(ndc.x, rows.x_axis), (ndc.y, rows.y_axis), (ndc.z, rows.z_axis)];
    let tolerance = each.map(|(ndc, row)| {
        let roundings = (terms(row) + ndc.abs() * w_terms) / clip.w + ndc.abs() + 1.0;
        ROUNDINGS * 0.5 * f64::EPSILON * roundings
    });
    (clip.w > 0.0).then_some(((ndc * 0.5 + 0.5).to_array(), tolerance))
}

/// The exact answer at a point.
pub(super) fn is_shadowed(seeing: &Seeing, light: &Light, point: DVec3) -> bool {
    if let Some((x, y, _)) = seeing.camera.project(seeing.view.film, point) {
        let film = seeing.view.film;
        let inside = x >= 0.0 && y >= 0.0 && x < f64::from(film.width) && y < f64::from(film.height);
        let pixel = y as usize * film.width as usize + x as usize;
        if inside
            && let Some(surface) = seeing.view.surface(seeing.tracer, seeing.camera, pixel)
            && surface.position.abs_diff_eq(point, seeing.offset.metres)
        {
            return answer(seeing.tracer, &surface, light, seeing.offset) == Answer::Shadowed;
        }
    }
    let end = if light.position().is_some() { 1.0 } else { f64::INFINITY };
    seeing.tracer.occluded(point, light.towards(point), 0.0, end)
}
