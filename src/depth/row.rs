//! The depth row by linear programming, then scaled so that it holds exactly.

use super::kept::Kept;
use glam::DVec4;
use microlp::{ComparisonOp, OptimizationDirection, Problem, SolveOutcome};
use serde::{Deserialize, Serialize};

/// Row 3 of a light matrix and the range it spans.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
pub struct DepthRow {
    /// On (X, 1), scene space.
    pub row: DVec4,
    /// Smallest depth kept, metres along the light: of a directional light from the plane's centre on.
    pub near_m: f64,
    /// Largest depth kept, metres, from where `near_m` is measured.
    pub far_m: f64,
    /// The row is a camera's: depth by w alone (point, spot), or by the distance along the light alone (directional).
    pub plain: bool,
}

/// Which rows a map may have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RowKind {
    /// A camera's: depth by w alone (point, spot), or by the distance along the light alone (directional).
    Plain,
    /// A camera's, unless another row tells casters from receivers [`FINER`] times better.
    PlainIfFine,
    /// Any.
    Free,
}

/// How much finer along the light a free row has to be to be worth a camera. A view axis far from the direction of the
/// light, as a warp has it, makes depth by w nearly a function of the place in the map.
pub const FINER: f64 = 2.0;

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
///
/// # Errors
/// [`DepthError`]: nothing is kept, or it has no finite row.
pub fn fit_row(kept: &Kept, kind: RowKind) -> Result<DepthRow, DepthError> {
    let plain = match kind {
        RowKind::Free => return Ok(fit(kept, false)?.0),
        RowKind::Plain => return Ok(fit(kept, true)?.0),
        RowKind::PlainIfFine => fit(kept, true),
    };
    match (plain, fit(kept, false)) {
        (Ok((_, by_w)), Ok((free, strength))) if strength > FINER * by_w => Ok(free),
        (Err(_), Ok((free, _))) => Ok(free),
        (plain, _) => Ok(plain?.0),
    }
}

/// A row, and how much clip depth it gives to a step along the light, up to a factor of the light plane.
fn fit(kept: &Kept, plain: bool) -> Result<(DepthRow, f64), DepthError> {
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

    // The functions of v that a row is made of; the last one tells casters from receivers. A camera at a lamp has 1 alone,
    // which falls over w as the distance along the light grows.
    let mut basis = DVec4::AXES;
    let by_constant = basis[3] == kept.one() || plain && !space.directional;
    if by_constant {
        basis[3] = kept.one();
    }
    let sign = if by_constant { -1.0 } else { 1.0 };
    let on_basis = |v: &DVec4| DVec4::from_array(basis.map(|row| row.dot(*v)));

    // Well-scaled unknowns: y = S (u/w - centre) with |y| ≤ 1 or so, centred where a constant can be absorbed by p4.
    let mut found: Vec<DVec4> = Vec::new();
    let (mut centre, mut scale) = (DVec4::ZERO, DVec4::ZERO);
    for (k, axis) in basis.into_iter().enumerate() {
        if plain && k < 3 {
            continue;
        }
        let ((high, a), (low, b)) = (extreme(axis, by_w, SCALE_ACCURACY), extreme(-axis, by_w, SCALE_ACCURACY));
        let low = -low;
        found.extend([a, b].iter().flatten().map(over_w));
        centre[k] = (high + low) * 0.5;
        scale[k] = if high > low { 2.0 / (high - low) } else { 0.0 };
    }
    let scaled = |v: &DVec4| (on_basis(v) - centre) * scale;

    // z/w = a·y + a0, since 1 = p4·q / w. Maximise sign * a.w subject to -1 ≤ a·y + a0 ≤ 1.
    let mut chosen: Vec<DVec4> = extremes(&few.iter().chain(&found).map(scaled).collect::<Vec<_>>());
    chosen.extend(found.iter().map(scaled));
    let mut solution = solve(&chosen, sign).ok_or(DepthError::NoRow)?;
    // The same as α·u / w, and as a row on v.
    let on_u = |(a, a0): (DVec4, f64)| {
        let row = a * scale;
        (row, a0 - row.dot(centre))
    };
    let on_v = |row: DVec4, constant: f64| (0..4).fold(by_w * constant, |sum, k| sum + basis[k] * row[k]);
    for _ in 0..ROUNDS {
        let (row, constant) = on_u(solution);
        let alpha = on_v(row, constant);
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
    let (row, constant) = on_u(solution);
    let alpha = on_v(row, constant);
    let (hi, lo) = (extreme(alpha, by_w, VIOLATION).0, -extreme(-alpha, by_w, VIOLATION).0);
    let half = ((hi - lo) * 0.5).max(f64::MIN_POSITIVE) * (1.0 + MARGIN);
    let middle = (hi + lo) * 0.5;
    let flat = hi - lo <= f64::EPSILON;
    let (row, constant) = if flat { (DVec4::ZERO, 0.0) } else { (row / half, (constant - middle) / half) };

    // B over w falls by B / (distance of the centre) a metre, at w = 1 there: comparable with a factor on metres.
    let strength = row.w.abs() / if by_constant { space.offset.length() } else { 1.0 };
    let on_scene = if by_constant {
        space.row_from_q(row.truncate() + p4 * constant) + DVec4::W * row.w
    } else {
        kept.scene_row(on_v(row, constant))
    };
    if !on_scene.is_finite() {
        return Err(DepthError::NoRow);
    }
    // A point light's axes are orthonormal, so w / |p4| is in metres along the view axis.
    let (depth, one) = if space.directional { (DVec4::W, DVec4::Z) } else { (by_w / p4.length(), kept.one()) };
    let (far_m, near_m) = (extreme(depth, one, VIOLATION).0, -extreme(-depth, one, VIOLATION).0);
    Ok((DepthRow { row: on_scene, near_m, far_m, plain }, strength))
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::depth::Visible;
    use crate::math::{Domain, LightSpace};
    use crate::scene::{Geometry, Light, LightKind, Triangle};
    use crate::visibility::{Bvh, Tracer};
    use glam::{DMat3, DVec3, Vec3};

    /// Hills, and triangles afloat above them.
    fn triangles() -> Vec<Triangle> {
        let at = |i: u32, k: u32| {
            let (x, z) = (i as f32 * 0.25 - 5.0, k as f32 * 0.25 - 5.0);
            Vec3::new(x, (x * 1.3).sin() * 0.4 + (z * 0.9).cos() * 0.3, z)
        };
        let cells = (0..40).flat_map(|i| (0..40).map(move |k| (i, k)));
        let mut triangles: Vec<Triangle> = cells
            .flat_map(|(i, k)| [[at(i, k), at(i + 1, k), at(i, k + 1)], [at(i + 1, k), at(i + 1, k + 1), at(i, k + 1)]])
            .collect();
        for i in 0..60 {
            let f = i as f32;
            let p = Vec3::new((f * 1.7).sin() * 6.0, 1.0 + (f * 0.61).sin().abs() * 4.0, (f * 2.3).cos() * 6.0);
            triangles.push([p, p + Vec3::new(0.9, 0.2 * f.cos(), 0.1), p + Vec3::new(0.1, 0.3, 0.8)]);
        }
        triangles
    }

    fn warps() -> [DMat3; 3] {
        let rows = |p1: DVec3, p2: DVec3, p4: DVec3| DMat3::from_cols(p1, p2, p4).transpose();
        let (p1, p2) = (DVec3::new(0.11, 0.02, 0.5), DVec3::new(-0.01, 0.13, 0.45));
        [
            rows(p1, p2, DVec3::Z),
            rows(p1, p2, DVec3::new(0.03, -0.02, 1.0)),
            rows(p1 * 4.0, p2 * 4.0, DVec3::new(0.1, 0.05, 1.0)),
        ]
    }

    /// A lamp keeps a camera's row where its view axis looks along the light, and not where it looks aside; so far out that
    /// it is a sun, its row is as steep as the sun's.
    #[test]
    fn a_far_lamp_under_a_warp_has_a_row_like_the_suns() {
        let triangles = triangles();
        let bvh = Bvh::build(&triangles);
        let geometry = Geometry::plain(&triangles, &[]);
        let tracer = Tracer::new(geometry, &bvh, None);
        let points: Vec<DVec3> = (0..3200).map(|i| geometry.triangle_f64(i).iter().sum::<DVec3>() / 3.0).collect();
        let visible = Visible::new(&points);
        let direction = DVec3::new(0.4, -1.0, 0.2).normalize();
        let sun = LightSpace::around(&Light { name: "s".into(), kind: LightKind::Directional { direction } }, &points);
        let sun = sun.unwrap();
        for distance in [1e6, 1e9, 1e12] {
            let lamp = LightSpace::perspective(sun.center - direction * distance, direction, sun.center);
            for (h, warped) in warps().into_iter().zip([false, true, true]) {
                // q of the lamp is `distance` times the sun's.
                let as_lamp = DMat3::from_diagonal(DVec3::new(1.0, 1.0, 1.0 / distance));
                let row = |space: &LightSpace, h: DMat3, kind| {
                    fit_row(&Kept::new(&tracer, space, &h, &visible, &Domain::All), kind).unwrap()
                };
                let of_lamp = row(&lamp, h * as_lamp, RowKind::PlainIfFine);
                assert_eq!(of_lamp.plain, !warped, "{distance:e}");
                let of_sun = row(&sun, h, if warped { RowKind::Free } else { RowKind::Plain });
                // Clip depth a metre along the light. What is kept differs a little: behind the receivers is by w for a lamp.
                let steepness = |row: DepthRow| row.row.truncate().dot(direction);
                let ratio = steepness(of_lamp) / steepness(of_sun);
                assert!((0.8..1.25).contains(&ratio), "{distance:e}: {ratio}");
            }
        }
    }

    /// The row from searches equals the one from a list of everything kept.
    #[test]
    fn searches_find_what_a_list_holds() {
        let triangles = triangles();
        let geometry = Geometry::plain(&triangles, &[]);
        let bvh = Bvh::build(&triangles);
        let tracer = Tracer::new(geometry, &bvh, None);
        let visible: Vec<DVec3> = (0..3200).map(|i| geometry.triangle_f64(i).iter().sum::<DVec3>() / 3.0).collect();
        let visible = Visible::new(&visible);
        let kinds = [
            LightKind::Directional { direction: DVec3::new(0.4, -1.0, 0.2).normalize() },
            LightKind::Point { position: DVec3::new(2.0, 9.0, -3.0), range: None },
        ];
        let mut flat = 0;
        for (kind, h) in kinds.into_iter().flat_map(|kind| warps().map(|h| (kind, h))) {
            let light = Light { name: "l".into(), kind };
            let space = LightSpace::around(&light, &[DVec3::new(-3.0, 0.0, -3.0), DVec3::new(3.0, 0.0, 3.0)]).unwrap();
            // Rows for q of the size of the scene: a perspective plane's q is some nine times a directional one's.
            let h = if space.directional { h } else { h * DMat3::from_diagonal(DVec3::new(1.0, 1.0, 1.0 / 9.0)) };
            let kept = Kept::new(&tracer, &space, &h, &visible, &Domain::All);
            let plain = h.row(2).truncate() == glam::DVec2::ZERO;
            let row = fit_row(&kept, if plain { RowKind::Plain } else { RowKind::Free }).unwrap();
            assert_eq!(row.plain, plain);
            let list = kept.list();
            assert!(list.len() > 100, "{}", list.len());
            let rows = h.row(2);
            let w = |v: &DVec4| v.truncate().dot(rows);
            // The row on v: back from its row on (X, 1).
            let on_q = DVec3::from_array(space.axes.map(|r| r.dot(row.row.truncate())));
            let constant = row.row.w + row.row.truncate().dot(space.center);
            let alpha = if space.directional {
                DVec4::new(on_q.x, on_q.y, constant, on_q.z)
            } else {
                on_q.extend(0.0) + kept.one() * (constant - on_q.dot(space.offset))
            };
            let one = |v: &DVec4| kept.one().dot(*v);
            let ends = |f: &dyn Fn(&DVec4) -> f64| {
                list.iter().map(f).fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), z| (lo.min(z), hi.max(z)))
            };
            let (lo, hi) = ends(&|v| alpha.dot(*v) / w(v));
            assert!((-1.0..-0.9999).contains(&lo) && (0.9999..=1.0).contains(&hi), "{lo} {hi}");
            let (near, far) = ends(&|v| if space.directional { v.w } else { w(v) / rows.length() / one(v) });
            let accuracy = (far - near) * VIOLATION;
            assert!((row.near_m - near).abs() <= accuracy && (row.far_m - far).abs() <= accuracy);
            // The linear program over all.
            let by_constant = plain && !space.directional;
            let keep = if plain { DVec4::W } else { DVec4::ONE };
            let last = |v: &DVec4| if by_constant { one(v) } else { v.w };
            let y: Vec<DVec4> = list.iter().map(|v| v.truncate().extend(last(v)) / w(v) * keep).collect();
            let sign = if by_constant { -1.0 } else { 1.0 };
            let (a, a0) = solve(&y, sign).unwrap();
            let (lo, hi) =
                y.iter().map(|v| a.dot(*v) + a0).fold((1.0, -1.0), |(l, h): (f64, f64), z| (l.min(z), h.max(z)));
            let best = a.w / ((hi - lo) * 0.5);
            // Of the row's own factor: on 1, which stands for -e over the distance of the centre, or on e.
            let own = if by_constant { -alpha.w * space.offset.z } else { alpha.w };
            assert!((own / best - 1.0).abs() < 1e-3, "{own} {best}");
            flat += usize::from(plain);
        }
        assert_eq!(flat, 2);
    }
}
