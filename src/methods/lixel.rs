//! lixel: the exact minimum over all allowed matrices of the expected displacement of the shadow edges (math note §4-5).
//!
//! The p-norm and saturating metrics are minimised by reweighting: each round's 36 moments are those of the quadratic
//! that touches the metric at the present displacement (iteratively reweighted least squares), always from the base
//! weights. The iterate with the lowest metric of its own is kept, not the last. The rounds look at an even choice of the
//! samples; between the two ends of the search all samples decide.

use super::plane::Plane;
use super::region::{Region, Report, texel_rows};
use super::{Inapplicable, Inputs};
use crate::fit::{Effort, Fit, FitProblem, PolarPolygon, Shape, at, minimise};
use crate::math::{LightSpace, support_subset};
use crate::metric::{Metric, Moments, cost, cost_and_moments, moments_of};
use glam::{DVec2, DVec3};

/// Samples that a round of reweighting looks at. The rounds only look for candidates; which of them is the answer is
/// decided on all samples.
const ROUND_SAMPLES: usize = 512;
/// Hull vertices that the rounds cover; the answer is finished on all of them.
const ROUND_VERTICES: usize = 24;
/// Relative tolerance of the first fit, which only starts the rounds.
const FIRST_TOLERANCE: f64 = 0.01;

/// Solves one region.
pub(super) fn solve(inputs: &Inputs, axis: Option<DVec3>) -> Result<Region, Inapplicable> {
    let plane = plane_of(inputs, axis, false)?;
    let (solver, metric) = (inputs.solver, inputs.solver.metric);
    let reweighted = metric != Metric::L2 && solver.rounds > 0 && !plane.samples.is_empty();
    let mut evaluations = 0;
    let rows_of = |fit: &Fit| texel_rows(&fit.rows, fit.aspect, inputs.texels);
    let mut rounds = 0;
    let fit = if reweighted {
        let few = support_subset(&plane.hull, ROUND_VERTICES);
        let thin = plane.samples.thinned(ROUND_SAMPLES);
        let mut fit = |moments: &Moments, effort: Effort, tolerance: f64, starts: &[DVec2]| -> Option<Fit> {
            let fit = minimise(&problem(inputs, &plane, &few, moments), effort, tolerance, starts)?;
            evaluations += fit.evaluations;
            Some(fit)
        };
        let first = moments_of(&thin, metric);
        let start = fit(&first, Effort::Local, solver.tolerance.max(FIRST_TOLERANCE), &[]);
        let start = start.ok_or(Inapplicable::NoFiniteFit)?;
        let (mut best, mut current) = (start, start);
        let (mut best_cost, mut moments) = cost_and_moments(&thin, metric, &rows_of(&start));
        let mut best_moments = moments;
        for round in 0..solver.rounds {
            let effort = if round == 0 { solver.effort } else { Effort::Local };
            let Some(next) = fit(&moments, effort, solver.tolerance, &[best.ab, current.ab]) else { break };
            rounds += 1;
            let value;
            (value, moments) = cost_and_moments(&thin, metric, &rows_of(&next));
            current = next;
            let gained = best_cost - value;
            if gained > 0.0 {
                (best_cost, best, best_moments) = (value, next, moments);
            }
            if gained <= solver.tolerance * best_cost {
                break;
            }
        }
        // The affine part on the whole hull, of both ends of the search; all samples decide.
        let finished = |fit: &Fit, moments: &Moments| {
            let whole = at(&problem(inputs, &plane, &plane.hull, moments), fit.ab, solver.tolerance)?;
            Some((cost(&plane.samples, metric, &rows_of(&whole)), whole))
        };
        let (a, b) = (finished(&best, &best_moments), finished(&start, &first));
        let whole = match (a, b) {
            (Some(a), Some(b)) => Some(if b.0 < a.0 { b.1 } else { a.1 }),
            (one, other) => one.or(other).map(|f| f.1),
        };
        let whole = whole.ok_or(Inapplicable::NoFiniteFit)?;
        Fit { spread: best.spread, gap: best.gap, termination: best.termination, ..whole }
    } else {
        let moments = if plane.samples.is_empty() { isotropic() } else { moments_of(&plane.samples, metric) };
        let fit = minimise(&problem(inputs, &plane, &plane.hull, &moments), solver.effort, solver.tolerance, &[]);
        let fit = fit.ok_or(Inapplicable::NoFiniteFit)?;
        evaluations += fit.evaluations;
        fit
    };
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

/// Maps near a region's own: its p4 moved by `step` of the way to the border of the legal ones in eight directions, each
/// with the best affine part for the metric's moments at the region itself. For searches that measure.
pub(super) fn neighbours(inputs: &Inputs, region: &Region, step: f64) -> Vec<Region> {
    let plane = &region.plane;
    let warp = inputs.shape == Shape::Projective || !plane.space.directional;
    if plane.samples.is_empty() || !warp {
        return Vec::new();
    }
    let rows = texel_rows(&region.rows, region.aspect, inputs.texels);
    let (_, moments) = cost_and_moments(&plane.samples, inputs.solver.metric, &rows);
    let problem = problem(inputs, plane, &plane.hull, &moments);
    let p4 = region.rows[2];
    let ab = p4.truncate() / p4.z;
    let polar = PolarPolygon::new(&plane.hull);
    (0..8)
        .filter_map(|k| {
            let direction = DVec2::from_angle(std::f64::consts::FRAC_PI_4 * f64::from(k));
            let fit = at(&problem, ab + direction * (step * polar.radius(direction)), inputs.solver.tolerance)?;
            Some(region.moved(fit.rows, fit.aspect))
        })
        .collect()
}

fn problem<'a>(inputs: &Inputs, plane: &'a Plane, hull: &'a [DVec2], moments: &'a Moments) -> FitProblem<'a> {
    FitProblem {
        moments,
        hull,
        normalisation: &plane.normalisation,
        aspect: inputs.aspect,
        shape: inputs.shape,
        directional: plane.space.directional,
    }
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
