//! Shadow map optimisation by areas: Colbert 2007.
//!
//! ```text
//! min over H of Σ (det J - det J⁻¹)²       (eq. 10; eq. 11 takes the expectation over a distribution of points)
//! det J = det(H) V / w³                    texels of map per pixel of film
//! ```
//!
//! The paper's set is all surface seen; here it is the shadow edges, weighted by their length. The metric sees areas
//! alone: it leaves an area-preserving part of H free, and knows no cover. So p4 is searched for, and the affine part is
//! the minimum-area rectangle around the cover as the light camera along p4 sees it. The paper asks for a numerical
//! minimum without naming a method: a polar grid over all legal p4, then a compass search from its best points.

mod alpha;
mod areas;
mod gaussian;

use super::body::{Rectangle, finished, may_warp, square};
use super::lixel::plane_of;
use super::plane::Plane;
use super::region::texel_rows;
use super::scene_optimal::oriented;
use super::{AreaOver, Inapplicable, Inputs, Region};
use crate::fit::PolarPolygon;
use areas::Areas;
use glam::{DVec2, DVec3};

/// Directions and parts of the way to the border of the polar grid.
const DIRECTIONS: u32 = 24;
const FRACTIONS: [f64; 7] = [0.15, 0.3, 0.45, 0.6, 0.75, 0.88, 0.96];
/// Grid points that are refined.
const STARTS: usize = 3;
/// First and last step of the compass search, parts of the way to the border.
const STEPS: [f64; 2] = [0.08, 1e-6];

/// Unit-square rows with their aspect and cost.
#[derive(Clone, Copy)]
struct Candidate {
    rows: [DVec3; 3],
    aspect: f64,
    cost: f64,
}

/// Solves one region.
pub(super) fn solve(inputs: &Inputs, axis: Option<DVec3>) -> Result<Region, Inapplicable> {
    may_warp(inputs)?;
    let plane = plane_of(inputs, axis, true)?;
    let samples = Areas::of_samples(&plane.samples).ok_or(Inapplicable::NoEdges)?;
    let mut evaluations = 0;
    let best = match inputs.solver.area {
        AreaOver::Samples => over_all(inputs, &plane, &samples, &mut evaluations)?,
        AreaOver::Normal => {
            let model = gaussian::model(&samples, &plane.hull).ok_or(Inapplicable::NoEdges)?;
            over_all(inputs, &plane, &model, &mut evaluations)?
        }
        AreaOver::Alpha => alpha::over_planes(inputs, axis, &plane, &samples, &mut evaluations)?,
    };
    finished(plane, best.rows, best.aspect, evaluations)
}

/// The candidate of base rows, where it has a finite cost.
fn candidate(
    inputs: &Inputs,
    plane: &Plane,
    areas: &Areas,
    base: &[DVec3; 3],
    rectangle: Rectangle,
) -> Result<Candidate, Inapplicable> {
    let (rows, width, height) = square(&plane.hull, base, rectangle)?;
    let (rows, aspect) = oriented(rows, width, height, inputs.aspect);
    let cost = areas.cost(&texel_rows(&rows, aspect, inputs.texels));
    if cost.is_finite() { Ok(Candidate { rows, aspect, cost }) } else { Err(Inapplicable::NoFiniteFit) }
}

/// The minimum over all p4 = (a, b, 1) that keep w > 0 on the cover.
fn over_all(inputs: &Inputs, plane: &Plane, areas: &Areas, evaluations: &mut u64) -> Result<Candidate, Inapplicable> {
    let polar = PolarPolygon::new(&plane.hull);
    let mut at = |ab: DVec2| -> Option<Candidate> {
        *evaluations += 1;
        let p4 = ab.extend(1.0).normalize();
        let e1 = p4.any_orthonormal_vector();
        candidate(inputs, plane, areas, &[e1, p4.cross(e1), p4], Rectangle::MinimumArea).ok()
    };
    let mut seeds: Vec<(DVec2, Candidate)> = at(DVec2::ZERO).map(|c| (DVec2::ZERO, c)).into_iter().collect();
    for k in 0..DIRECTIONS {
        let direction = DVec2::from_angle(std::f64::consts::TAU * f64::from(k) / f64::from(DIRECTIONS));
        let radius = polar.radius(direction);
        seeds.extend(
            FRACTIONS.iter().filter_map(|f| at(direction * (radius * f)).map(|c| (direction * (radius * f), c))),
        );
    }
    seeds.sort_by(|a, b| a.1.cost.total_cmp(&b.1.cost));
    let refined = seeds.iter().take(STARTS).map(|seed| compass(&mut at, &polar, *seed));
    refined.min_by(|a, b| a.cost.total_cmp(&b.cost)).ok_or(Inapplicable::NoFiniteFit)
}

/// Steps in eight directions, halved where none lowers the cost.
fn compass(
    at: &mut impl FnMut(DVec2) -> Option<Candidate>,
    polar: &PolarPolygon,
    (mut ab, mut best): (DVec2, Candidate),
) -> Candidate {
    let mut step = STEPS[0];
    while step > STEPS[1] {
        let mut moved = false;
        for k in 0..8 {
            let direction = DVec2::from_angle(std::f64::consts::FRAC_PI_4 * f64::from(k));
            let to = ab + direction * (step * polar.radius(direction));
            if let Some(found) = at(to)
                && found.cost < best.cost
            {
                (ab, best, moved) = (to, found, true);
            }
        }
        if !moved {
            step *= 0.5;
        }
    }
    best
}
