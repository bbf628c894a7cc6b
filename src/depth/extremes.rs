//! What a map keeps in several frames, for one depth row: of each frame only the extremes stay.

use super::kept::Kept;
use glam::DVec4;

/// Directions in which extremes are kept.
const DIRECTIONS: usize = 400;
/// Points between those directions may stand out of the hull of the extremes: it is widened by this part of its extent. A
/// smooth body stands out by 1 - cos of half the angle between neighbouring directions, 0.3 % for 400 of them; a corner that
/// no direction found, by more.
const WIDENED: f64 = 0.05;

impl Kept<'_> {
    /// Points v/w whose convex hull holds everything kept. What the depth row depends on is the hull of v/w; under the same
    /// homography in the same light's frame those of several frames add ([`Kept::of_points`]).
    pub fn extremes(&self) -> Vec<DVec4> {
        if self.is_empty() {
            return Vec::new();
        }
        let by_w = self.p4.extend(0.0);
        let farthest = |direction: DVec4| self.farthest(direction, by_w);
        let axes: Vec<DVec4> =
            DVec4::AXES.iter().flat_map(|a| [*a, -*a]).filter_map(farthest).map(|v| v / self.w(v)).collect();
        let low = axes.iter().fold(DVec4::INFINITY, |m, v| m.min(*v));
        let high = axes.iter().fold(DVec4::NEG_INFINITY, |m, v| m.max(*v));
        let scale = (high - low).map(|e| if e > 0.0 { 1.0 / e } else { 0.0 });
        let mut found = axes;
        found.extend((0..DIRECTIONS).filter_map(|k| farthest(direction(k) * scale)).map(|v| v / self.w(v)));
        let mean = found.iter().fold(DVec4::ZERO, |s, v| s + *v / found.len() as f64);
        // Of a point light 1/w is positive: a widened far end stays in front of infinity.
        let one = self.one();
        let least = 0.5 * found.iter().map(|v| one.dot(*v)).fold(f64::INFINITY, f64::min);
        let widened = |v: &DVec4| {
            let v = mean + (*v - mean) * (1.0 + WIDENED);
            let short = least - one.dot(v);
            if one.w != 0.0 && short > 0.0 { v + DVec4::W * (short / one.w) } else { v }
        };
        found.iter().map(widened).collect()
    }

    /// The kept point farthest along a direction of v/w.
    fn farthest(&self, direction: DVec4, by_w: DVec4) -> Option<DVec4> {
        let along = |v: &DVec4| direction.dot(*v) / self.w(*v);
        let seen = self.few.iter().copied().max_by(|a, b| along(a).total_cmp(&along(b)));
        let least = seen.map_or(f64::NEG_INFINITY, |v| along(&v));
        self.largest(direction, by_w, least, 0.0).map(|(_, v)| v).or(seen)
    }
}

/// Directions spread over the 4-sphere: a Weyl sequence through the normal distribution's Box-Muller pairs.
fn direction(k: usize) -> DVec4 {
    // Roberts 2018: powers of the root of x^5 = x + 1 spread best in four dimensions.
    const ROOT: f64 = 1.167_303_978_261_418_7;
    let u: [f64; 4] = std::array::from_fn(|i| (0.5 + k as f64 * ROOT.powi(-(i as i32 + 1))).fract());
    let pair = |a: f64, b: f64| {
        let radius = (-2.0 * (1.0 - a).ln()).sqrt();
        let (s, c) = (std::f64::consts::TAU * b).sin_cos();
        (radius * c, radius * s)
    };
    let ((x, y), (z, w)) = (pair(u[0], u[1]), pair(u[2], u[3]));
    DVec4::new(x, y, z, w).normalize_or(DVec4::X)
}
