//! lixel: the exact minimum over all allowed matrices of the expected displacement of the shadow edges (math note §4-5).
//!
//! The p-norm and saturating metrics are minimised by reweighting: each round's 36 moments are those of the quadratic
//! that touches the metric at the present displacement (iteratively reweighted least squares), always from the base
//! weights. The largest displacement is minimised by Lawson's reweighting instead. The iterate with the lowest metric of
//! its own is kept, not the last.

use super::plane::Plane;
use super::region::{Region, Report, texel_rows};
use super::{Inapplicable, Inputs};
use crate::fit::{self, Effort, Fit, FitProblem, PolarPolygon, Shape, Step, minimise};
use crate::math::LightSpace;
use crate::metric::{Lawson, Metric, Moments, cost, cost_and_moments, moments_of};
use glam::{DVec2, DVec3};

/// Rounds of Lawson's reweighting for one of `solver.rounds`: they converge linearly.
const MINIMAX_ROUNDS: u32 = 16;

/// Solves one region.
pub(super) fn solve(inputs: &Inputs, axis: Option<DVec3>) -> Result<Region, Inapplicable> {
    let plane = plane_of(inputs, axis, false)?;
    let solver = inputs.solver;
    let mut evaluations = 0;
    let mut fit = |moments: &Moments, effort: Effort, starts: &[DVec2]| -> Option<Fit> {
        let problem = FitProblem {
            moments,
            hull: &plane.hull,
            normalisation: &plane.normalisation,
            aspect: inputs.aspect,
            shape: inputs.shape,
            directional: plane.space.directional,
        };
        let fit = minimise(&problem, effort, solver.tolerance, starts)?;
        evaluations += fit.evaluations;
        Some(fit)
    };
    let metric = solver.metric;
    let first = if plane.samples.is_empty() { isotropic() } else { moments_of(&plane.samples, metric) };
    let start = fit(&first, solver.effort, &[]).ok_or(Inapplicable::NoFiniteFit)?;
    let rows_of = |fit: &Fit| texel_rows(&fit.rows, fit.aspect, inputs.texels);
    let mut best = start;
    let mut rounds = 0;
    if metric == Metric::Minimax && solver.rounds > 0 {
        let mut weights = Lawson::new(&plane.samples);
        let mut least = f64::INFINITY;
        for _ in 0..solver.rounds.saturating_mul(MINIMAX_ROUNDS) {
            let Some(next) = fit(&weights.moments(&plane.samples), Effort::Local, &[best.ab]) else { break };
            rounds += 1;
            let value = cost(&plane.samples, metric, &rows_of(&next));
            if value < least {
                (least, best) = (value, next);
            }
            weights.heed(&plane.samples, &rows_of(&next));
        }
    } else if metric != Metric::L2 && solver.rounds > 0 && !plane.samples.is_empty() {
        let mut current = start;
        let (mut best_cost, mut moments) = cost_and_moments(&plane.samples, metric, &rows_of(&start));
        for round in 0..solver.rounds {
            let effort = if round == 0 { solver.effort } else { Effort::Local };
            let Some(next) = fit(&moments, effort, &[best.ab, current.ab]) else { break };
            rounds += 1;
            let value;
            (value, moments) = cost_and_moments(&plane.samples, metric, &rows_of(&next));
            current = next;
            let gained = best_cost - value;
            if gained > 0.0 {
                (best_cost, best) = (value, next);
            }
            if gained <= solver.tolerance * best_cost {
                break;
            }
        }
    }
    let fit = best;
    let report = Report {
        evaluations,
        samples: plane.samples.len() as u64,
        grazing: plane.grazing,
        rounds,
        spread: fit.spread,
        gap: fit.gap,
        termination: fit.termination,
    };
    Ok(Region::new(plane, fit.rows, fit.aspect, report))
}

/// The map a step away from a region's own, flush with what it covers. `None` where that is not legal.
pub(super) fn near(inputs: &Inputs, region: &Region, step: &Step) -> Option<Region> {
    let plane = &region.plane;
    let allowed = (inputs.shape, inputs.aspect, plane.space.directional);
    let (rows, aspect) = fit::near(&(region.rows, region.aspect), step, &plane.hull, &plane.normalisation, allowed)?;
    Some(region.moved(rows, aspect))
}

/// The map with p4 a step away from a region's own, and the best affine part for the metric's moments at the region itself.
/// `None` where that is not legal, or where nothing projective may change.
pub(super) fn refitted(inputs: &Inputs, region: &Region, warp: DVec2) -> Option<Region> {
    let plane = &region.plane;
    let directional = plane.space.directional;
    if plane.samples.is_empty() || (inputs.shape != Shape::Projective && directional) {
        return None;
    }
    let rows = texel_rows(&region.rows, region.aspect, inputs.texels);
    let (_, moments) = cost_and_moments(&plane.samples, inputs.solver.metric, &rows);
    let problem = FitProblem {
        moments: &moments,
        hull: &plane.hull,
        normalisation: &plane.normalisation,
        aspect: inputs.aspect,
        shape: inputs.shape,
        directional,
    };
    let p4 = region.rows[2];
    let ab = p4.truncate() / p4.z;
    let far = PolarPolygon::new(&plane.hull).radius(warp.normalize_or(DVec2::X));
    let fit = fit::at(&problem, ab + warp * far, inputs.solver.tolerance)?;
    Some(region.moved(fit.rows, fit.aspect))
}

/// The light plane of the region's cover, around a given axis or one of its own.
pub(super) fn plane_of(inputs: &Inputs, axis: Option<DVec3>, similar: bool) -> Result<Plane, Inapplicable> {
    let space = match (axis, inputs.light.position()) {
        (Some(axis), Some(position)) => LightSpace::perspective(position, axis, centre(inputs.covered)),
        _ => LightSpace::around(inputs.light, inputs.covered)?,
    };
    Plane::new(inputs, space, inputs.covered, inputs.edges, similar).ok_or(Inapplicable::NoFiniteFit)
}

/// Mean of points.
pub(super) fn centre(points: &[DVec3]) -> DVec3 {
    let first = points.first().copied().unwrap_or(DVec3::ZERO);
    first + points.iter().fold(DVec3::ZERO, |s, p| s + (*p - first)) / points.len().max(1) as f64
}

/// Without a shadow edge any map that holds the cover answers alike: texels of equal size in the light plane.
fn isotropic() -> Moments {
    let mut moments = Moments::default();
    let q = DVec3::Z;
    for t in [DVec3::X, DVec3::Y] {
        moments.add(q, 1.0, t.cross(q), 1.0);
    }
    moments
}
