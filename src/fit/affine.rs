//! The affine part in closed form for a given p4 (math note §4).
//!
//! With base rows b1, b2 (any two that make [b1; b2; p4] invertible), v = (b1·q, b2·q)/w over the hull,
//! G_ik = M[p4, p4, b_i × p4, b_k × p4], n(t) the unit vector at angle t, W(t) the width of v along n(t):
//!
//! ```text
//! A = [n(t1) R1/W(t1); n(t2) R2/W(t2)],   g(t) = n(t)ᵀ G n(t),   D = det[b1; b2; p4]
//! h = [ (W(t2)/R2)² g(t1) + (W(t1)/R1)² g(t2) ] / (sin²(t1 - t2) D²)
//! R1 R2 = 1, free:   R1/R2 = (W(t1)/W(t2)) √(g(t2)/g(t1)),   h = 2 W(t1) W(t2) √(g(t1) g(t2)) / (sin² D²)
//! ```
//!
//! Deviation from SOSM §2.3: its minimum-area rectangle and skew heuristic are two points of this search.

use super::Shape;
use crate::metric::Moments;
use glam::{DMat2, DVec2, DVec3};

/// Width over height of the map in texels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Aspect {
    /// Chosen by the fit.
    Free,
    /// Given.
    Fixed(f64),
}

/// Longest map relative to its height (or the reverse) that a free aspect may choose: beyond it a 16384-texel limit
/// binds before the budget does.
pub(super) const ASPECT_MAX: f64 = 16.0;

/// Smallest |sin| of the angle between the two axes of a map. Below it the texels are slivers and f32 loses them.
pub(super) const SIN_MIN: f64 = 0.05;

/// The best affine part for one p4.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AffineFit {
    /// h at a budget of one texel.
    pub value: f64,
    /// Angles of the two map axes' normals in the plane of the base rows.
    pub angles: [f64; 2],
    /// R1/R2.
    pub aspect: f64,
}

/// The quadratic form g(t) and the projected hull of one p4.
pub(super) struct AffineProblem {
    g: DMat2,
    points: Vec<DVec2>,
    det2: f64,
}

impl AffineProblem {
    /// `None` when some hull vertex has w ≤ 0 or the rows are singular.
    pub(super) fn new(moments: &Moments, hull: &[DVec2], rows: &[DVec3; 3]) -> Option<Self> {
        let [b1, b2, p4] = *rows;
        let mut points = Vec::with_capacity(hull.len());
        for v in hull {
            let q = v.extend(1.0);
            let w = p4.dot(q);
            if w <= 0.0 {
                return None;
            }
            points.push(DVec2::new(b1.dot(q), b2.dot(q)) / w);
        }
        let s = moments.contract(p4);
        let (q1, q2) = (b1.cross(p4), b2.cross(p4));
        let (s1, s2) = (s * q1, s * q2);
        let off = q1.dot(s2);
        let det = crate::math::det3(b1, b2, p4);
        let g = DMat2::from_cols(DVec2::new(q1.dot(s1), off), DVec2::new(off, q2.dot(s2)));
        let det2 = det * det;
        (det2 > 0.0 && g.is_finite() && points.iter().all(|p| p.is_finite())).then_some(AffineProblem {
            g,
            points,
            det2,
        })
    }

    fn width(&self, n: DVec2) -> f64 {
        let (lo, hi) = self.extent(n);
        hi - lo
    }

    /// A lower bound of h over all axes and aspects: W(t1) W(t2) / |sin| is the area of a parallelogram around the
    /// hull, √(g(t1) g(t2)) / |sin| ≥ √det G, and the sum of two squares is at least twice their product.
    pub(super) fn least(&self) -> f64 {
        2.0 * self.area().abs() * self.g.determinant().max(0.0).sqrt() / self.det2
    }

    /// Signed area of the projected hull.
    fn area(&self) -> f64 {
        let Some(&first) = self.points.first() else { return 0.0 };
        0.5 * self.points.windows(2).map(|p| (p[0] - first).perp_dot(p[1] - first)).sum::<f64>()
    }

    /// The axes normal to hull edges, widths by rotating calipers (Toussaint 1983).
    fn flush_axes(&self) -> Vec<Axis> {
        let (n, turn) = (self.points.len(), 1.0_f64.copysign(self.area()));
        let mut axes = Vec::with_capacity(n + 2);
        let mut far = 1;
        for i in 0..n {
            let from = self.points[i];
            let normal = (self.points[(i + 1) % n] - from).perp() * turn;
            let length = normal.length();
            if length <= 0.0 {
                continue;
            }
            let normal = normal / length;
            let height = |k: usize| normal.dot(self.points[k % n] - from);
            far = far.max(i + 1);
            let mut width = height(far);
            while far < i + n {
                let next = height(far + 1);
                if next < width {
                    break;
                }
                (far, width) = (far + 1, next);
            }
            axes.push(Axis::new(normal, width.max(0.0), self.g));
        }
        axes
    }

    /// Smallest and largest n·v.
    pub(super) fn extent(&self, n: DVec2) -> (f64, f64) {
        // Finite by construction, so that a plain comparison will do: a third of the time of `f64::min`.
        self.points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), p| {
            let d = n.dot(*p);
            (if d < lo { d } else { lo }, if d > hi { d } else { hi })
        })
    }

    /// A candidate axis: its normal, W and g.
    fn axis(&self, angle: f64) -> Axis {
        self.axis_along(DVec2::from_angle(angle))
    }

    fn axis_along(&self, n: DVec2) -> Axis {
        Axis::new(n, self.width(n), self.g)
    }

    fn combine(&self, a: &Axis, b: &Axis, aspect: Aspect) -> Option<(f64, f64)> {
        let sin = a.n.perp_dot(b.n);
        if sin.abs() < SIN_MIN {
            return None;
        }
        let ratio = match aspect {
            Aspect::Fixed(r) => r,
            Aspect::Free => {
                let r = (a.width / b.width) * (b.g / a.g).sqrt();
                if r.is_finite() { r.clamp(1.0 / ASPECT_MAX, ASPECT_MAX) } else { 1.0 }
            }
        };
        // R1 = √ratio, R2 = 1/√ratio
        let value = (b.width * b.width * ratio * a.g + a.width * a.width / ratio * b.g) / (sin * sin * self.det2);
        value.is_finite().then_some((value, ratio))
    }

    /// The best pair of axes flush with hull edges (or perpendicular ones, for `Shape::Rectangle`).
    pub(super) fn flush(&self, aspect: Aspect, shape: Shape) -> Option<AffineFit> {
        let mut axes = self.flush_axes();
        if axes.len() < 3 {
            axes.extend([self.axis(0.0), self.axis(std::f64::consts::FRAC_PI_2)]);
        }
        let mut best: Option<(f64, [DVec2; 2], f64)> = None;
        // h sin² ≥ 2 W(t1) W(t2) √(g(t1) g(t2)) / D² for every R1/R2: most pairs go without a division.
        let mut bound = f64::INFINITY;
        let mut consider = |a: &Axis, b: &Axis| {
            let sin = a.n.perp_dot(b.n);
            if a.least * b.least > bound * (sin * sin) {
                return;
            }
            if let Some((value, ratio)) = self.combine(a, b, aspect)
                && best.is_none_or(|(least, ..)| value < least)
            {
                bound = 0.5 * value * self.det2;
                best = Some((value, [a.n, b.n], ratio));
            }
        };
        if shape == Shape::Rectangle {
            for a in &axes {
                let across = self.axis_along(a.n.perp());
                consider(a, &across);
                consider(&across, a);
            }
        } else {
            // The axis of least W √g with all others first: a good bound from the start.
            let least = (1..axes.len()).fold(0, |l, i| if axes[i].least < axes[l].least { i } else { l });
            axes.swap(0, least);
            for (i, a) in axes.iter().enumerate() {
                for b in &axes[i + 1..] {
                    consider(a, b);
                    if aspect != Aspect::Free {
                        consider(b, a);
                    }
                }
            }
        }
        best.map(|(value, normals, aspect)| AffineFit { value, angles: normals.map(DVec2::to_angle), aspect })
    }

    /// The value of given angles.
    fn at(&self, angles: [f64; 2], aspect: Aspect) -> Option<AffineFit> {
        let (value, ratio) = self.combine(&self.axis(angles[0]), &self.axis(angles[1]), aspect)?;
        Some(AffineFit { value, angles, aspect: ratio })
    }
}

struct Axis {
    n: DVec2,
    width: f64,
    g: f64,
    /// W √g.
    least: f64,
}

impl Axis {
    fn new(n: DVec2, width: f64, g: DMat2) -> Axis {
        let g = n.dot(g * n).max(0.0);
        Axis { n, width, g, least: width * g.sqrt() }
    }
}

/// The best affine part with axes flush with hull edges.
pub fn fit_affine(
    moments: &Moments,
    hull: &[DVec2],
    rows: &[DVec3; 3],
    aspect: Aspect,
    shape: Shape,
) -> Option<AffineFit> {
    AffineProblem::new(moments, hull, rows)?.flush(aspect, shape)
}

/// Turns the axes of a fit away from the hull edges as long as that lowers h, in halving steps down to `tolerance_rad`.
pub fn refine_affine(
    moments: &Moments,
    hull: &[DVec2],
    rows: &[DVec3; 3],
    aspect: Aspect,
    shape: Shape,
    from: AffineFit,
    tolerance_rad: f64,
) -> AffineFit {
    let Some(problem) = AffineProblem::new(moments, hull, rows) else { return from };
    let moves: &[[f64; 2]] = if shape == Shape::Rectangle {
        &[[1.0, 1.0], [-1.0, -1.0]]
    } else {
        &[[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]]
    };
    let mut best = problem.at(from.angles, aspect).unwrap_or(from);
    let mut step = 0.1_f64;
    while step > tolerance_rad {
        let better = moves
            .iter()
            .filter_map(|m| problem.at([best.angles[0] + m[0] * step, best.angles[1] + m[1] * step], aspect))
            .filter(|f| f.value < best.value)
            .min_by(|a, b| a.value.total_cmp(&b.value));
        match better {
            Some(fit) => best = fit,
            None => step *= 0.5,
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::convex_hull;

    fn moments() -> Moments {
        let mut m = Moments::default();
        for i in 0..40 {
            let f = f64::from(i);
            let q = DVec3::new((f * 1.3).sin() * 0.8, (f * 0.7).cos() * 0.8, 1.0);
            let (t1, t2) = (DVec3::new(0.01, 0.002 * f.sin(), 0.0), DVec3::new(-0.003, 0.02, 0.0));
            for c in [t1.cross(q), t2.cross(q)] {
                m.add(q, crate::math::det3(q, t1, t2), c, 1.0);
            }
        }
        m
    }

    fn hull() -> Vec<DVec2> {
        convex_hull(
            &(0..9).map(|i| DVec2::from_angle(f64::from(i) * 0.8) * (0.6 + 0.04 * f64::from(i))).collect::<Vec<_>>(),
        )
    }

    /// The closed form equals Moments::value of the homography it stands for.
    #[test]
    fn value_is_that_of_the_homography() {
        let (m, hull) = (moments(), hull());
        let rows = [DVec3::X, DVec3::Y, DVec3::new(0.3, -0.2, 1.0)];
        for (aspect, shape) in [(Aspect::Free, Shape::Projective), (Aspect::Fixed(2.0), Shape::Projective)] {
            let fit = fit_affine(&m, &hull, &rows, aspect, shape).unwrap();
            let problem = AffineProblem::new(&m, &hull, &rows).unwrap();
            let row = |angle: f64, size: f64| {
                let n = DVec2::from_angle(angle);
                (rows[0] * n.x + rows[1] * n.y) * (size / problem.width(n))
            };
            let r1 = fit.aspect.sqrt();
            let h = [row(fit.angles[0], r1), row(fit.angles[1], 1.0 / r1), rows[2]];
            assert!((m.value(&h) / fit.value - 1.0).abs() < 1e-12);
        }
    }

    /// The bound holds, and calipers find the widths that a look at every vertex finds.
    #[test]
    fn bound_and_calipers() {
        let (m, hull) = (moments(), hull());
        for (a, b) in [(0.0, 0.0), (0.3, -0.2), (-0.6, 0.5), (0.1, 0.9)] {
            for flip in [1.0, -1.0] {
                let rows = [DVec3::X * flip, DVec3::Y, DVec3::new(a, b, 1.0)];
                let problem = AffineProblem::new(&m, &hull, &rows).unwrap();
                let axes = problem.flush_axes();
                assert_eq!(axes.len(), hull.len());
                for axis in &axes {
                    assert!((axis.width / problem.width(axis.n) - 1.0).abs() < 1e-12);
                }
                let fit = problem.flush(Aspect::Free, Shape::Projective).unwrap();
                assert!(problem.least() > 0.0 && problem.least() <= fit.value, "{} {}", problem.least(), fit.value);
            }
        }
    }

    /// A dense search over both angles finds nothing better than flush edges and their refinement.
    #[test]
    fn flush_and_refined_is_the_minimum() {
        let (m, hull) = (moments(), hull());
        let rows = [DVec3::X, DVec3::Y, DVec3::new(-0.25, 0.4, 1.0)];
        let flush = fit_affine(&m, &hull, &rows, Aspect::Free, Shape::Projective).unwrap();
        let fit = refine_affine(&m, &hull, &rows, Aspect::Free, Shape::Projective, flush, 1e-6);
        let problem = AffineProblem::new(&m, &hull, &rows).unwrap();
        let n = 720;
        let mut dense = f64::INFINITY;
        for i in 0..n {
            for j in 0..i {
                let angle = |k: i32| std::f64::consts::PI * f64::from(k) / f64::from(n);
                if let Some(f) = problem.at([angle(i), angle(j)], Aspect::Free) {
                    dense = dense.min(f.value);
                }
            }
        }
        assert!(fit.value <= dense * (1.0 + 1e-9), "{} {dense}", fit.value);
    }
}
