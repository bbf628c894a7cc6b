//! Coordinates in which the sums are well scaled (Hartley's normalisation, math note §1).

use glam::{DMat2, DMat3, DVec2, DVec3};
use serde::{Deserialize, Serialize};

/// An affine change of coordinates of the light plane.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
pub struct Normalisation {
    /// Acts on q; its last row is (0, 0, 1).
    pub normal_from_plane: DMat3,
}

/// Smallest half extent that a covered polygon is taken to have, relative to its largest: keeps a line-shaped cover
/// invertible in f64.
const EXTENT_MIN: f64 = 1e-6;

/// Takes a convex polygon (counter-clockwise, in the plane q3 = 1) to [-1, 1]² with its centroid at 0 and equal second
/// moments. `None` for an empty polygon, or one whose points are all the same.
///
/// Both are those of the area, and the first axis points to the farther end, so that equal polygons get equal coordinates
/// whatever the frame of the plane and however many vertices rounding leaves along a side: a search that stops at a
/// tolerance then takes the same steps.
pub fn normalise(hull: &[DVec2]) -> Option<Normalisation> {
    let centre = centroid(hull)?;
    let (axis, major, minor) = principal(second_moments(hull, centre)?);
    let (low, high) =
        hull.iter().map(|p| (*p - centre).dot(axis)).fold((0.0, 0.0), |(lo, hi): (f64, f64), d| (lo.min(d), hi.max(d)));
    let axis = if -low > high { -axis } else { axis };
    let across = axis.perp();
    if major <= 0.0 || !major.is_finite() {
        return None;
    }
    let (su, sv) = (1.0 / major.sqrt(), 1.0 / minor.max(major * EXTENT_MIN * EXTENT_MIN).sqrt());
    let extent = hull
        .iter()
        .map(|p| ((*p - centre).dot(axis) * su).abs().max(((*p - centre).dot(across) * sv).abs()))
        .fold(0.0, f64::max);
    let (u, v) = (axis * su / extent, across * sv / extent);
    let m = DMat3::from_cols(
        DVec3::new(u.x, v.x, 0.0),
        DVec3::new(u.y, v.y, 0.0),
        DVec3::new(-u.dot(centre), -v.dot(centre), 1.0),
    );
    m.is_finite().then_some(Normalisation { normal_from_plane: m })
}

/// Without change of shape: into the unit disc, so that angles in the light plane are kept and turning it changes nothing.
pub fn normalise_similar(hull: &[DVec2]) -> Option<Normalisation> {
    let centre = centroid(hull)?;
    let scale = 1.0 / hull.iter().map(|p| (*p - centre).length()).fold(0.0, f64::max);
    let m = DMat3::from_cols(DVec3::new(scale, 0.0, 0.0), DVec3::new(0.0, scale, 0.0), (-centre * scale).extend(1.0));
    m.is_finite().then_some(Normalisation { normal_from_plane: m })
}

impl Normalisation {
    /// A point of the plane q3 = 1.
    pub fn point(&self, p: DVec2) -> DVec2 {
        (self.normal_from_plane * p.extend(1.0)).truncate()
    }

    /// q with its derivative, divided by q3.
    pub fn vectors(&self, q: DVec3, dq: [DVec3; 2]) -> (DVec3, [DVec3; 2]) {
        let scale = 1.0 / q.z;
        (self.normal_from_plane * (q * scale), dq.map(|d| self.normal_from_plane * (d * scale)))
    }

    /// A homography on q from one on normalised q.
    pub fn plane_homography(&self, h: &DMat3) -> DMat3 {
        *h * self.normal_from_plane
    }

    /// A row on normalised q from a row on q.
    pub fn row(&self, row: DVec3) -> DVec3 {
        self.normal_from_plane.inverse().transpose() * row
    }
}

/// Largest part of its size squared that the area of a polygon has which counts as none.
fn area_least(hull: &[DVec2], first: DVec2) -> f64 {
    hull.iter().map(|p| (*p - first).length_squared()).fold(0.0, f64::max) * EXTENT_MIN
}

/// Second moments about a centre, but for a factor: of the area, or of the vertices where that is none.
fn second_moments(hull: &[DVec2], centre: DVec2) -> Option<DMat2> {
    let first = *hull.first()?;
    let outer = |a: DVec2, b: DVec2| DMat2::from_cols(a * b.x, a * b.y);
    let next = hull.iter().cycle().skip(1);
    let (mut area, mut of_area, mut of_vertices) = (0.0, DMat2::ZERO, DMat2::ZERO);
    for (a, b) in hull.iter().zip(next).map(|(a, b)| (*a - centre, *b - centre)) {
        let cross = a.perp_dot(b);
        area += cross;
        // A triangle with a corner at the centre: ∫ p pᵀ = (a aᵀ + b bᵀ + (a + b)(a + b)ᵀ) / 24 times the cross product.
        of_area += (outer(a, a) + outer(b, b) + outer(a + b, a + b)) * cross;
        of_vertices += outer(a, a);
    }
    Some(if area > area_least(hull, first) { of_area } else { of_vertices })
}

/// Area centroid of a convex polygon; the mean of its points when it has no area.
fn centroid(hull: &[DVec2]) -> Option<DVec2> {
    let first = *hull.first()?;
    let (mut area, mut sum) = (0.0, DVec2::ZERO);
    for pair in hull.windows(2) {
        let (a, b) = (pair[0] - first, pair[1] - first);
        let cross = a.perp_dot(b);
        area += cross;
        sum += (a + b) * cross;
    }
    if area > area_least(hull, first) {
        Some(first + sum / (3.0 * area))
    } else {
        Some(first + hull.iter().fold(DVec2::ZERO, |s, p| s + (*p - first)) / hull.len() as f64)
    }
}

/// Major axis (unit) and the two eigenvalues of a symmetric 2x2 matrix.
fn principal(m: DMat2) -> (DVec2, f64, f64) {
    let (a, b, d) = (m.x_axis.x, m.x_axis.y, m.y_axis.y);
    let angle = 0.5 * (2.0 * b).atan2(a - d);
    let axis = DVec2::from_angle(angle);
    let across = axis.perp();
    (axis, axis.dot(m * axis), across.dot(m * across).max(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_far_thin_box_becomes_a_square_about_zero() {
        let hull: Vec<DVec2> = [(-3.0, -0.01), (3.0, -0.01), (3.0, 0.01), (-3.0, 0.01)]
            .iter()
            .map(|&(x, y)| DVec2::new(2e7, -5e6) + DVec2::from_angle(0.3).rotate(DVec2::new(x, y)))
            .collect();
        let n = normalise(&hull).unwrap();
        for p in hull {
            let q = n.point(p);
            assert!((q.abs() - DVec2::ONE).length() < 1e-5, "{q}"); // 2e7 / 0.01 * 2^-53
        }
    }

    #[test]
    fn points_along_sides_and_the_frame_change_nothing() {
        let corners = [(-2.0, 0.0), (3.0, -1.0), (4.0, 2.0), (0.0, 2.5)].map(|(x, y)| DVec2::new(x, y));
        let along = |t: f64| corners[0].lerp(corners[1], t) - DVec2::new(0.0, 1e-12);
        let more = [corners[0], along(0.1), along(0.2), along(0.7), corners[1], corners[2], corners[3]];
        let turn = DVec2::from_angle(2.3);
        let turned: Vec<DVec2> = corners.iter().map(|p| turn.rotate(*p) * 40.0 + DVec2::splat(7.0)).collect();
        let reference = normalise(&corners).unwrap();
        for (k, corner) in corners.iter().enumerate() {
            let at = reference.point(*corner);
            assert!((normalise(&more).unwrap().point(*corner) - at).length() < 1e-11);
            assert!((normalise(&turned).unwrap().point(turned[k]) - at).length() < 1e-13);
        }
    }

    #[test]
    fn a_point_has_no_normalisation_and_a_line_has() {
        assert!(normalise(&[DVec2::ONE]).is_none());
        assert!(normalise(&[DVec2::ZERO, DVec2::ONE]).is_some());
        assert!(normalise(&[]).is_none());
    }
}
