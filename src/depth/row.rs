//! The depth row by linear programming, then scaled so that it holds exactly.

use super::kept::Kept;
use crate::math::LightSpace;
use glam::{DMat3, DVec4};
use microlp::{ComparisonOp, OptimizationDirection, Problem, SolveOutcome};
use rayon::prelude::*;

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

/// Directions in which extreme points are taken as the first constraints.
const DIRECTIONS: usize = 96;
/// Points searched for them; the rounds find the rest.
const SEARCHED: usize = 4096;
/// Rounds of adding violated constraints. Each adds the worst ones; the last scaling makes any rest exact.
const ROUNDS: usize = 12;
/// Violation, in units of w, below which constraints count as met before the exact scaling.
const VIOLATION: f64 = 1e-7;
/// Part of the depth range left free at each end, so that rounding to f32 clips nothing.
const MARGIN: f64 = 1.0 / 65536.0;

/// Fits row 3 for a homography and what it keeps.
/// `plain` keeps the row a camera's: depth by w alone (point, spot) or by d alone (directional).
pub fn fit_row(space: &LightSpace, h: &DMat3, kept: &Kept, plain: bool) -> Result<DepthRow, DepthError> {
    let p4 = h.row(2);
    if kept.points.is_empty() {
        return Err(DepthError::Empty);
    }
    // Well-scaled unknowns: y = S (q, e) / w with |y| ≤ 1, centred where a constant can be absorbed by p4.
    let w = |v: &DVec4| v.truncate().dot(p4);
    let scaled: Vec<DVec4> = kept.points.iter().map(|v| *v / w(v)).collect();
    let n = scaled.len() as f64;
    let centre = scaled.iter().fold(DVec4::ZERO, |s, v| s + *v / n);
    let extent = scaled.iter().fold(DVec4::ZERO, |m, v| m.max((*v - centre).abs()));
    let mut scale = extent.map(|e| if e > 0.0 { 1.0 / e } else { 0.0 });
    if plain {
        scale = DVec4::new(0.0, 0.0, 0.0, scale.w);
    }
    let y: Vec<DVec4> = scaled.iter().map(|v| (*v - centre) * scale).collect();
    let sign = if space.directional { 1.0 } else { -1.0 };

    // z/w = a·y + a0, since 1 = p4·q / w. Maximise sign * a.w subject to -1 ≤ a·y + a0 ≤ 1.
    let mut chosen = extremes(&y);
    let mut solution = solve(&y, &chosen, sign).ok_or(DepthError::NoRow)?;
    for _ in 0..ROUNDS {
        let value = |v: &DVec4| solution.0.dot(*v) + solution.1;
        let excess = |sign: f64| {
            let worst = |a: (f64, usize), b: (f64, usize)| if b.0 > a.0 || (b.0 == a.0 && b.1 < a.1) { b } else { a };
            let found = y.par_iter().enumerate().map(|(i, v)| (sign * value(v) - 1.0, i));
            found.reduce(|| (VIOLATION, usize::MAX), worst)
        };
        let before = chosen.len();
        chosen.extend([excess(1.0), excess(-1.0)].iter().filter(|(_, i)| *i < y.len()).map(|(_, i)| *i));
        if chosen.len() == before {
            break;
        }
        solution = solve(&y, &chosen, sign).ok_or(DepthError::NoRow)?;
    }
    let (a, a0) = solution;

    // Back to (q, e): z/w = (a∘scale)·(v/w - centre) + a0, then the exact scaling into [-1, 1].
    let on_v = a * scale;
    let constant = a0 - on_v.dot(centre);
    let (lo, hi) = scaled
        .iter()
        .map(|v| on_v.dot(*v) + constant)
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), z| (lo.min(z), hi.max(z)));
    let half = ((hi - lo) * 0.5).max(f64::MIN_POSITIVE) * (1.0 + MARGIN);
    let middle = (hi + lo) * 0.5;
    let flat = hi - lo <= f64::EPSILON;
    let (on_v, constant) = if flat { (DVec4::ZERO, 0.0) } else { (on_v / half, (constant - middle) / half) };

    let q_row = on_v.truncate() + p4 * constant;
    let e_row = if space.directional { space.along_row() * on_v.w } else { DVec4::new(0.0, 0.0, 0.0, on_v.w) };
    let row = space.row_from_q(q_row) + e_row;
    if !row.is_finite() {
        return Err(DepthError::NoRow);
    }
    Ok(DepthRow { row, near_m: kept.range_m[0], far_m: kept.range_m[1] })
}

/// Points extreme in fixed directions of the four-dimensional box, among at most [`SEARCHED`] of them.
fn extremes(y: &[DVec4]) -> Vec<usize> {
    let stride = y.len().div_ceil(SEARCHED).max(1);
    let mut chosen = Vec::new();
    for k in 0..DIRECTIONS {
        // A Kronecker sequence with the golden ratios of four dimensions (Roberts 2018): evenly spread directions.
        let f = |g: f64| ((k as f64 + 1.0) * g).fract() * 2.0 - 1.0;
        let d =
            DVec4::new(f(0.856_674_883_854_5), f(0.733_891_856_627_1), f(0.628_706_721_037_7), f(0.538_597_257_223_5));
        let best = (0..y.len()).step_by(stride).fold((0, f64::NEG_INFINITY), |best, i| {
            let along = y[i].dot(d);
            if along > best.1 { (i, along) } else { best }
        });
        chosen.push(best.0);
    }
    chosen.sort_unstable();
    chosen.dedup();
    chosen
}

/// The linear program over the chosen points: (a, a0).
fn solve(y: &[DVec4], chosen: &[usize], sign: f64) -> Option<(DVec4, f64)> {
    /// Bound of the unknowns: y lies in [-1, 1]⁴, so larger coefficients only come from nearly flat sets.
    const MOST: f64 = 1e4;
    let mut problem = Problem::new(OptimizationDirection::Maximize);
    let a: [_; 4] = std::array::from_fn(|i| problem.add_var(if i == 3 { sign } else { 0.0 }, (-MOST, MOST)));
    let a0 = problem.add_var(0.0, (-MOST, MOST));
    for i in chosen {
        let terms: Vec<_> = (0..4).map(|k| (a[k], y[*i][k])).chain([(a0, 1.0)]).collect();
        problem.add_constraint(&terms, ComparisonOp::Le, 1.0);
        problem.add_constraint(&terms, ComparisonOp::Ge, -1.0);
    }
    let SolveOutcome::Solution(solution) = problem.solve().ok()? else { return None };
    let solved = DVec4::from_array(a.map(|v| solution.var_value(v)));
    let constant = solution.var_value(a0);
    (solved.is_finite() && constant.is_finite()).then_some((solved, constant))
}
