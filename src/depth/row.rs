//! The depth row by linear programming, then scaled so that it holds exactly.

use super::kept::Kept;
use glam::DVec4;
use microlp::{ComparisonOp, OptimizationDirection, Problem, SolveOutcome};

/// Row 3 of a light matrix and the range it spans.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthRow {
    /// On (X, 1), scene space.
    pub row: DVec4,
    /// Smallest depth kept, metres along the light.
    pub near_m: f64,
    /// Largest depth kept, metres along the light.
    pub far_m: f64,
}

/// Why a map has no depth row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DepthError {
    /// Nothing in front of the map.
    #[error("nothing visible lies in front of the map")]
    Empty,
    /// The linear program found no row, or one without a number.
    #[error("no finite depth row holds everything the map has to keep")]
    NoRow,
}

/// Directions in which the few receivers' extremes are taken as first constraints; the rounds find the casters'.
const DIRECTIONS: usize = 24;
/// Rounds of adding violated constraints. Each adds the worst ones; the last scaling makes any rest exact.
const ROUNDS: usize = 24;
/// Violation, in units of w, below which constraints count as met, and to which the ends of the range are found: a
/// sixteenth of the margin that is left at each of them.
const VIOLATION: f64 = MARGIN / 16.0;
/// Part of the depth range left free at each end, so that rounding to f32 clips nothing.
const MARGIN: f64 = 1.0 / 65536.0;
/// Accuracy of the extents that scale the unknowns, relative: scaling is all they do.
const SCALE_ACCURACY: f64 = 1e-2;

/// Fits row 3 for what a homography keeps.
/// `plain` keeps the row a camera's: depth by w alone (point, spot) or by d alone (directional).
///
/// # Errors
/// [`DepthError`]: nothing is kept, or it has no finite row.
pub fn fit_row(kept: &Kept, plain: bool) -> Result<DepthRow, DepthError> {
    let (space, p4) = (&kept.space, kept.p4);
    let by_w = p4.extend(0.0);
    let over_w = |v: &DVec4| *v / kept.w(*v);
    if kept.is_empty() {
        return Err(DepthError::Empty);
    }
    let few: Vec<DVec4> = kept.few.iter().map(over_w).collect();
    // Extremes of a linear function of v/β·v: over the few, then over all.
    let extreme = |alpha: DVec4, beta: DVec4, accuracy: f64| -> (f64, Option<DVec4>) {
        let values = || kept.few.iter().map(|v| alpha.dot(*v) / beta.dot(*v));
        let (lo, hi) = values().fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)));
        let slack = if hi > lo { (hi - lo) * accuracy } else { 0.0 };
        match kept.largest(alpha, beta, hi, slack) {
            Some((value, v)) => (value, Some(v)),
            None => (hi, None),
        }
    };

    // Well-scaled unknowns: y = S (v/w - centre) with |y| ≤ 1 or so, centred where a constant can be absorbed by p4.
    let mut found: Vec<DVec4> = Vec::new();
    let (mut centre, mut scale) = (DVec4::ZERO, DVec4::ZERO);
    for (k, axis) in DVec4::AXES.into_iter().enumerate() {
        if plain && k < 3 {
            continue;
        }
        let ((high, a), (low, b)) = (extreme(axis, by_w, SCALE_ACCURACY), extreme(-axis, by_w, SCALE_ACCURACY));
        let low = -low;
        found.extend([a, b].iter().flatten().map(over_w));
        centre[k] = (high + low) * 0.5;
        scale[k] = if high > low { 2.0 / (high - low) } else { 0.0 };
    }
    let scaled = |v: &DVec4| (*v - centre) * scale;
    let sign = if space.directional { 1.0 } else { -1.0 };

    // z/w = a·y + a0, since 1 = p4·q / w. Maximise sign * a.w subject to -1 ≤ a·y + a0 ≤ 1.
    let mut chosen: Vec<DVec4> = extremes(&few.iter().chain(&found).map(scaled).collect::<Vec<_>>());
    chosen.extend(found.iter().map(scaled));
    let mut solution = solve(&chosen, sign).ok_or(DepthError::NoRow)?;
    // The same as α·v / w.
    let on_v = |(a, a0): (DVec4, f64)| {
        let row = a * scale;
        (row, a0 - row.dot(centre))
    };
    for _ in 0..ROUNDS {
        let (row, constant) = on_v(solution);
        let alpha = row + by_w * constant;
        let before = chosen.len();
        for alpha in [alpha, -alpha] {
            let worst = kept.largest(alpha, by_w, 1.0 + VIOLATION, VIOLATION);
            chosen.extend(worst.map(|(_, v)| scaled(&over_w(&v))));
        }
        if chosen.len() == before {
            break;
        }
        solution = solve(&chosen, sign).ok_or(DepthError::NoRow)?;
    }

    // Back to v, then the exact scaling into [-1, 1].
    let (row, constant) = on_v(solution);
    let alpha = row + by_w * constant;
    let (hi, lo) = (extreme(alpha, by_w, VIOLATION).0, -extreme(-alpha, by_w, VIOLATION).0);
    let half = ((hi - lo) * 0.5).max(f64::MIN_POSITIVE) * (1.0 + MARGIN);
    let middle = (hi + lo) * 0.5;
    let flat = hi - lo <= f64::EPSILON;
    let (row, constant) = if flat { (DVec4::ZERO, 0.0) } else { (row / half, (constant - middle) / half) };

    let q_row = row.truncate() + p4 * constant;
    let e_row = if space.directional { space.along_row() * row.w } else { DVec4::new(0.0, 0.0, 0.0, row.w) };
    let row = space.row_from_q(q_row) + e_row;
    if !row.is_finite() {
        return Err(DepthError::NoRow);
    }
    // A point light's axes are orthonormal, so w / |p4| is in metres along the view axis.
    let (depth, one) = if space.directional { (DVec4::W, DVec4::Z) } else { (by_w / p4.length(), DVec4::W) };
    let (far_m, near_m) = (extreme(depth, one, VIOLATION).0, -extreme(-depth, one, VIOLATION).0);
    Ok(DepthRow { row, near_m, far_m })
}

/// Points extreme in fixed directions of the four-dimensional box.
fn extremes(y: &[DVec4]) -> Vec<DVec4> {
    let mut chosen = Vec::new();
    for k in 0..DIRECTIONS {
        // A Kronecker sequence with the golden ratios of four dimensions (Roberts 2018): evenly spread directions.
        let f = |g: f64| ((k as f64 + 1.0) * g).fract() * 2.0 - 1.0;
        let d =
            DVec4::new(f(0.856_674_883_854_5), f(0.733_891_856_627_1), f(0.628_706_721_037_7), f(0.538_597_257_223_5));
        let best = (0..y.len()).fold((0, f64::NEG_INFINITY), |best, i| {
            let along = y[i].dot(d);
            if along > best.1 { (i, along) } else { best }
        });
        chosen.push(best.0);
    }
    chosen.sort_unstable();
    chosen.dedup();
    chosen.into_iter().filter_map(|i| y.get(i).copied()).collect()
}

/// The linear program over chosen points: (a, a0).
fn solve(chosen: &[DVec4], sign: f64) -> Option<(DVec4, f64)> {
    /// Bound of the unknowns: y lies in [-1, 1]⁴, so larger coefficients only come from nearly flat sets.
    const MOST: f64 = 1e4;
    let mut problem = Problem::new(OptimizationDirection::Maximize);
    let a: [_; 4] = std::array::from_fn(|i| problem.add_var(if i == 3 { sign } else { 0.0 }, (-MOST, MOST)));
    let a0 = problem.add_var(0.0, (-MOST, MOST));
    for y in chosen {
        let terms: Vec<_> = (0..4).map(|k| (a[k], y[k])).chain([(a0, 1.0)]).collect();
        problem.add_constraint(&terms, ComparisonOp::Le, 1.0);
        problem.add_constraint(&terms, ComparisonOp::Ge, -1.0);
    }
    let SolveOutcome::Solution(solution) = problem.solve().ok()? else { return None };
    let solved = DVec4::from_array(a.map(|v| solution.var_value(v)));
    let constant = solution.var_value(a0);
    (solved.is_finite() && constant.is_finite()).then_some((solved, constant))
}
