//! Eq. 12: the map as the film's image of a plane whose normal lies between camera and light.
//!
//! ```text
//! n(α) ~ α (C - X) + (1 - α) (L - X),     through the point of the view that is farthest from the light
//! ```
//!
//! X is the centroid of the cover: with the paper's "given surface point" n would differ from point to point. Where
//! camera or light are at infinity, C - X and L - X are unit vectors. "This parametrization, while very effective for
//! some situations, contained many singularities": an α whose plane holds the light or the camera, whose normal vanishes,
//! or whose horizon crosses the cover is passed over, and when all are, the commonest reason is the answer.

use super::super::body::{Rectangle, least};
use super::super::focused::view_body;
use super::super::lixel::centre;
use super::super::on_plane::film_rows;
use super::super::plane::Plane;
use super::super::{Inapplicable, Inputs};
use super::areas::Areas;
use super::{Candidate, candidate};
use crate::scene::{LightKind, Projection};
use glam::DVec3;

/// Values of α tried over [0, 1], ends included.
const GRID: u32 = 65;
/// Halvings of the step around the best of them.
const HALVINGS: u32 = 20;

/// The best plane between camera and light.
pub(super) fn over_planes(
    inputs: &Inputs,
    axis: Option<DVec3>,
    plane: &Plane,
    areas: &Areas,
    evaluations: &mut u64,
) -> Result<Candidate, Inapplicable> {
    let body = view_body(inputs, axis)?;
    let farthest = least(&body, |p| match inputs.light.kind {
        LightKind::Directional { direction } => -direction.dot(p - inputs.bounds.center()),
        LightKind::Point { position, .. } | LightKind::Spot { position, .. } => -(p - position).length(),
    })
    .ok_or(Inapplicable::NoCommonVolume)?;
    let x = centre(inputs.covered);
    let mut to_camera = match inputs.camera.projection {
        Projection::Perspective { .. } => inputs.camera.position - x,
        Projection::Orthographic { .. } => -inputs.camera.forward(),
    };
    let mut to_light = inputs.light.towards(x);
    if inputs.light.position().is_none() || matches!(inputs.camera.projection, Projection::Orthographic { .. }) {
        (to_camera, to_light) = (to_camera.normalize_or_zero(), to_light.normalize_or_zero());
    }
    let mut at = |alpha: f64| -> Result<Candidate, Inapplicable> {
        *evaluations += 1;
        let n = (to_camera * alpha + to_light * (1.0 - alpha)).try_normalize().ok_or(Inapplicable::VanishingNormal)?;
        let rows = film_rows(inputs, &plane.space, (n, -n.dot(farthest)), inputs.covered[0])?;
        let base = rows.map(|row| plane.normalisation.row(row));
        candidate(inputs, plane, areas, &base, Rectangle::Axes)
    };
    let mut best: Option<(f64, Candidate)> = None;
    let mut reasons: Vec<(Inapplicable, u32)> = Vec::new();
    for k in 0..GRID {
        let alpha = f64::from(k) / f64::from(GRID - 1);
        match at(alpha) {
            Ok(found) if best.is_none_or(|b| found.cost < b.1.cost) => best = Some((alpha, found)),
            Ok(_) => {}
            Err(reason) => match reasons.iter_mut().find(|r| r.0 == reason) {
                Some(known) => known.1 += 1,
                None => reasons.push((reason, 1)),
            },
        }
    }
    let commonest = reasons.iter().rev().max_by_key(|r| r.1).map_or(Inapplicable::NoFiniteFit, |r| r.0);
    let (mut alpha, mut best) = best.ok_or(commonest)?;
    let mut step = 0.5 / f64::from(GRID - 1);
    for _ in 0..HALVINGS {
        for to in [alpha - step, alpha + step] {
            if (0.0..=1.0).contains(&to)
                && let Ok(found) = at(to)
                && found.cost < best.cost
            {
                (alpha, best) = (to, found);
            }
        }
        step *= 0.5;
    }
    Ok(best)
}
