//! The projective part: a global polar grid over the legal (a, b), ranked by a lower bound of the objective, then
//! simplices from its best points (math note §4).
//!
//! The objective is piecewise smooth with kinks where the best pair of flush edges changes, and grows without bound
//! towards the border of the polygon, so a simplex (Nelder and Mead 1965) serves and needs no barrier.

use super::affine::{AffineFit, AffineProblem, Aspect, refine_affine};
use super::starts::{Seed, coarse_grid, look, polar_grid, starting_points};
use super::{Effort, Normalisation, PolarPolygon, Shape};
use crate::math::support_subset;
use crate::metric::Moments;
use glam::{DMat3, DVec2, DVec3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Hull vertices that the search sees; the answer is finished on all of them.
const SEARCH_VERTICES: usize = 24;
/// Part of a map's side left free on each side, so that rounding a matrix to f32 drops no covered point.
const BORDER: f64 = 1.0 / 4096.0;
/// Most evaluations of one simplex: a bound against endless crawling, reached by no case measured.
const SIMPLEX_EVALUATIONS: u32 = 200;

/// Points of the grid, those of least bound, whose affine part a local search finds at most; a global one finds that of every
/// point whose bound lets it be a start.
const LOCAL_LOOKS: usize = 24;

/// Simplices that begin afresh at the best point, at most: as long as they gain more than the tolerance.
const FRESH_SIMPLICES: u32 = 4;

/// What is minimised, and over what.
#[derive(Clone, Copy, Debug)]
pub struct FitProblem<'a> {
    /// Sums over the samples, normalised coordinates.
    pub moments: &'a Moments,
    /// Convex polygon to be covered, normalised coordinates, counter-clockwise, at least 3 vertices.
    pub hull: &'a [DVec2],
    /// Coordinates of both.
    pub normalisation: &'a Normalisation,
    /// Width over height in texels.
    pub aspect: Aspect,
    /// What the renderer can carry.
    pub shape: Shape,
    /// Parallel light: without a warp p4 is constant.
    pub directional: bool,
}

/// Why a search ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Termination {
    /// The objective over the last simplex spans less than the tolerance times its smallest value.
    SimplexWithinTolerance,
    /// The shape leaves nothing projective to search.
    NothingToSearch,
    /// The bound on evaluations was reached.
    EvaluationsExhausted,
    /// A method that computes its matrix directly.
    Direct,
}

/// The answer of a search.
#[derive(Clone, Copy, Debug)]
pub struct Fit {
    /// Rows p1, p2, p4 on normalised q, taking the covered polygon into the unit square.
    pub rows: [DVec3; 3],
    /// R1/R2.
    pub aspect: f64,
    /// h at a budget of one texel.
    pub value: f64,
    /// (a, b) of p4, for warm starts.
    pub ab: DVec2,
    /// Evaluations of the affine step.
    pub evaluations: u64,
    /// Relative spread of the objective over the last simplex.
    pub spread: f64,
    /// (value - dense) / dense, where a dense grid was also searched.
    pub gap: Option<f64>,
    /// Why the search ended.
    pub termination: Termination,
}

impl FitProblem<'_> {
    fn rows(&self, ab: DVec2) -> [DVec3; 3] {
        base_rows(self.shape, self.directional, self.normalisation, ab)
    }

    /// A lower bound of the objective at (a, b); infinite where that is not legal.
    fn least(&self, hull: &[DVec2], ab: DVec2) -> f64 {
        AffineProblem::new(self.moments, hull, &self.rows(ab)).map_or(f64::INFINITY, |p| p.least())
    }

    fn affine(&self, hull: &[DVec2], ab: DVec2) -> Option<AffineFit> {
        AffineProblem::new(self.moments, hull, &self.rows(ab))?.flush(self.aspect, self.shape)
    }
}

/// The base rows b1, b2 and p4 = (a, b, 1) of what a shape allows.
pub(super) fn base_rows(shape: Shape, directional: bool, normalisation: &Normalisation, ab: DVec2) -> [DVec3; 3] {
    let p4 = ab.extend(1.0);
    if shape != Shape::Rectangle {
        return [DVec3::X, DVec3::Y, p4];
    }
    // A plain camera: base rows orthonormal in the light's own frame, perpendicular to its view axis.
    let (e1, e2) = if directional {
        (DVec3::X, DVec3::Y)
    } else {
        let axis = normalisation.normal_from_plane.transpose() * p4;
        let e1 = axis.normalize().any_orthonormal_vector();
        (e1, axis.cross(e1).normalize())
    };
    [normalisation.row(e1), normalisation.row(e2), p4]
}

/// Minimises over all eight parameters. `starts` are (a, b) known to be good. `None` when no legal parameter gives a
/// finite value.
pub fn minimise(problem: &FitProblem, effort: Effort, tolerance: f64, starts: &[DVec2]) -> Option<Fit> {
    let few = support_subset(problem.hull, SEARCH_VERTICES);
    let mut evaluations = 0;
    let mut value_at = |ab: DVec2| {
        evaluations += 1;
        problem.affine(&few, ab).map_or(f64::INFINITY, |f| f.value)
    };
    if problem.directional && problem.shape != Shape::Projective {
        return finish(problem, DVec2::ZERO, 1, 0.0, tolerance, Termination::NothingToSearch);
    }
    let polar = PolarPolygon::new(&few);
    let mut seeds: Vec<Seed> = starts.iter().map(|ab| (value_at(*ab), *ab)).collect();
    let (looks, simplices) = match effort {
        Effort::Local => (LOCAL_LOOKS, 1),
        Effort::Global | Effort::Exhaustive => (usize::MAX, 3),
    };
    if starts.is_empty() || effort != Effort::Local {
        // The bound costs a tenth of the affine step and ranks nearly as it does.
        let mut grid: Vec<Seed> =
            std::iter::once(DVec2::ZERO).chain(coarse_grid(&polar)).map(|ab| (problem.least(&few, ab), ab)).collect();
        grid.sort_by(|a, b| a.0.total_cmp(&b.0));
        grid.truncate(looks);
        look(grid, &polar, simplices, &mut seeds, &mut value_at);
    }
    let mut best: Option<(f64, DVec2, f64, Termination)> = None;
    let size = 0.08 * polar.radius(DVec2::X).min(polar.radius(DVec2::Y));
    for (_, start) in starting_points(&mut seeds, &polar, simplices) {
        let (ab, value, spread, termination) = simplex(&mut value_at, start, size, tolerance);
        if best.is_none_or(|b| value < b.0) {
            best = Some((value, ab, spread, termination));
        }
    }
    let (mut value, mut ab, mut spread, mut termination) = best?;
    // A simplex may fold up on a kink before the minimum: a fresh one tells, and goes on.
    for _ in 0..FRESH_SIMPLICES {
        let again = simplex(&mut value_at, ab, 0.5 * size, tolerance);
        let gained = value - again.1;
        if gained > 0.0 {
            (ab, value, spread, termination) = again;
        }
        if gained <= tolerance * value.abs() {
            break;
        }
    }
    let mut fit = finish(problem, ab, evaluations, spread, tolerance, termination)?;
    if effort == Effort::Exhaustive
        && let Some(dense) = minimise_exhaustive(problem, tolerance)
    {
        fit.gap = Some((fit.value - dense.value) / dense.value);
        fit.evaluations += dense.evaluations;
    }
    Some(fit)
}

/// The best affine part of a given (a, b); `None` where it is not legal.
pub fn at(problem: &FitProblem, ab: DVec2, tolerance: f64) -> Option<Fit> {
    finish(problem, ab, 1, 0.0, tolerance, Termination::NothingToSearch)
}

/// [`minimise`] by a dense polar grid (96 directions x 48 radii) and a simplex from each of its 24 best points: slow and
/// simple, its yardstick.
pub fn minimise_exhaustive(problem: &FitProblem, tolerance: f64) -> Option<Fit> {
    let polar = PolarPolygon::new(problem.hull);
    let fractions: Vec<f64> = (1..=48).map(|k| (f64::from(k) / 48.5 * std::f64::consts::FRAC_PI_2).sin()).collect();
    let mut evaluations = 0;
    let mut value_at = |ab: DVec2| {
        evaluations += 1;
        problem.affine(problem.hull, ab).map_or(f64::INFINITY, |f| f.value)
    };
    let mut seeds: Vec<Seed> = polar_grid(&polar, 96, &fractions).map(|ab| (value_at(ab), ab)).collect();
    seeds.push((value_at(DVec2::ZERO), DVec2::ZERO));
    seeds.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.x.total_cmp(&b.1.x)).then(a.1.y.total_cmp(&b.1.y)));
    let mut best: Option<(f64, DVec2, f64, Termination)> = None;
    for (_, start) in seeds.iter().take(24).filter(|s| s.0.is_finite()) {
        let (ab, value, spread, termination) = simplex(&mut value_at, *start, 0.02, tolerance * 0.1);
        if best.is_none_or(|b| value < b.0) {
            best = Some((value, ab, spread, termination));
        }
    }
    let (_, ab, spread, termination) = best?;
    finish(problem, ab, evaluations, spread, tolerance, termination)
}

/// Nelder and Mead's simplex in two dimensions; infinite values are walls. Returns point, value, relative spread.
fn simplex(
    f: &mut impl FnMut(DVec2) -> f64,
    start: DVec2,
    size: f64,
    tolerance: f64,
) -> (DVec2, f64, f64, Termination) {
    let mut s = [start, start + DVec2::new(size, 0.0), start + DVec2::new(0.0, size)].map(|p| (f(p), p));
    let mut spent = 3;
    loop {
        s.sort_by(|a, b| a.0.total_cmp(&b.0));
        let spread = (s[2].0 - s[0].0) / s[0].0.abs().max(f64::MIN_POSITIVE);
        if spread <= tolerance {
            return (s[0].1, s[0].0, spread.max(0.0), Termination::SimplexWithinTolerance);
        }
        if spent >= SIMPLEX_EVALUATIONS {
            return (s[0].1, s[0].0, spread, Termination::EvaluationsExhausted);
        }
        let middle = (s[0].1 + s[1].1) * 0.5;
        let mut probe = |t: f64| {
            let p = middle + (s[2].1 - middle) * t;
            spent += 1;
            (f(p), p)
        };
        let reflected = probe(-1.0);
        if reflected.0 < s[0].0 {
            let expanded = probe(-2.0);
            s[2] = if expanded.0 < reflected.0 { expanded } else { reflected };
        } else if reflected.0 < s[1].0 {
            s[2] = reflected;
        } else {
            let contracted = if reflected.0 < s[2].0 { probe(-0.5) } else { probe(0.5) };
            if contracted.0 < s[2].0.min(reflected.0) {
                s[2] = contracted;
            } else {
                for k in 1..3 {
                    let p = (s[0].1 + s[k].1) * 0.5;
                    s[k] = (f(p), p);
                }
                spent += 2;
            }
        }
    }
}

/// Fits the affine part on the whole hull and writes the rows of the unit square.
fn finish(
    problem: &FitProblem,
    ab: DVec2,
    evaluations: u64,
    spread: f64,
    tolerance: f64,
    termination: Termination,
) -> Option<Fit> {
    let base = problem.rows(ab);
    let flush = problem.affine(problem.hull, ab)?;
    let angle_tolerance = tolerance.clamp(1e-6, 1e-2);
    let affine =
        refine_affine(problem.moments, problem.hull, &base, problem.aspect, problem.shape, flush, angle_tolerance);
    let rows = unit_square_rows(problem.hull, &base, affine.angles)?;
    Some(Fit { rows, aspect: affine.aspect, value: affine.value, ab, evaluations, spread, gap: None, termination })
}

/// Rows that take a hull to the unit square (less a border) with axes normal to the given angles; det > 0.
pub fn unit_square_rows(hull: &[DVec2], base: &[DVec3; 3], angles: [f64; 2]) -> Option<[DVec3; 3]> {
    let [b1, b2, p4] = *base;
    let row = |angle: f64| {
        let n = DVec2::from_angle(angle);
        let (lo, hi) = hull.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| {
            let q = v.extend(1.0);
            let d = (n.x * b1.dot(q) + n.y * b2.dot(q)) / p4.dot(q);
            (lo.min(d), hi.max(d))
        });
        let width = (hi - lo) / (1.0 - 2.0 * BORDER);
        (b1 * n.x + b2 * n.y - p4 * (lo - width * BORDER)) / width
    };
    let (p1, p2) = (row(angles[0]), row(angles[1]));
    let det = crate::math::det3(p1, p2, p4);
    let p2 = if det < 0.0 { row(angles[1] + std::f64::consts::PI) } else { p2 };
    let rows = DMat3::from_cols(p1, p2, p4);
    (rows.is_finite() && det != 0.0).then_some([p1, p2, p4])
}
