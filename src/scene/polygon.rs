//! Polygons → triangles by ear clipping (Meisters 1975, "Polygons have ears"), in the plane of the polygon's Newell
//! normal. Convex polygons come out as a fan from the first vertex.
//!
//! Orientation tests are exact (Shewchuk's predicates); the projection drops the coordinate in which the normal is
//! longest. A polygon without a proper ear left (self-crossing, or folded in projection) ends in a fan of what remains:
//! no vertex is ever dropped.

use glam::DVec3;
use robust::{Coord, orient2d};

/// Triangles of a polygon as indices into its corners, wound as the polygon. Fewer than three corners give none.
pub(super) fn triangulate(corners: &[DVec3]) -> Vec<[usize; 3]> {
    let flat = project(corners);
    let mut left: Vec<usize> = (0..corners.len()).collect();
    let mut triangles = Vec::with_capacity(corners.len().saturating_sub(2));
    while left.len() > 3 {
        let n = left.len();
        let corner = |k: usize| [left[(k + n - 1) % n], left[k], left[(k + 1) % n]];
        // The ear at position 1 leaves the first vertex as the hub of the fan.
        let ear = (1..=n).map(|k| k % n).find(|&k| is_ear(&flat, &left, corner(k))).unwrap_or(1);
        triangles.push(corner(ear));
        left.remove(ear);
    }
    if let &[a, b, c] = left.as_slice() {
        triangles.push([a, b, c]);
    }
    triangles
}

/// The corners in a plane in which the polygon runs counter-clockwise.
fn project(corners: &[DVec3]) -> Vec<Coord<f64>> {
    // Newell: twice the area vector, whatever the polygon's shape; relative to a corner to keep large offsets out.
    let origin = corners.first().copied().unwrap_or_default();
    let mut normal = DVec3::ZERO;
    for (k, &a) in corners.iter().enumerate() {
        normal += (a - origin).cross(corners[(k + 1) % corners.len()] - origin);
    }
    let size = normal.abs();
    let axes: fn(DVec3) -> (f64, f64) = if size.x >= size.y && size.x >= size.z {
        |p| (p.y, p.z)
    } else if size.y >= size.z {
        |p| (p.z, p.x)
    } else {
        |p| (p.x, p.y)
    };
    let along = if size.x >= size.y && size.x >= size.z {
        normal.x
    } else if size.y >= size.z {
        normal.y
    } else {
        normal.z
    };
    corners
        .iter()
        .map(|&p| {
            let (x, y) = axes(p);
            if along < 0.0 { Coord { x: y, y: x } } else { Coord { x, y } }
        })
        .collect()
}

/// True when a corner is strictly convex and no other corner lies in its triangle, border included.
fn is_ear(flat: &[Coord<f64>], left: &[usize], [a, b, c]: [usize; 3]) -> bool {
    let [pa, pb, pc] = [a, b, c].map(|k| flat[k]);
    if orient2d(pa, pb, pc) <= 0.0 {
        return false;
    }
    let is_corner = |p: Coord<f64>| [pa, pb, pc].iter().any(|q| q.x == p.x && q.y == p.y);
    let inside = |p: Coord<f64>| orient2d(pa, pb, p) >= 0.0 && orient2d(pb, pc, p) >= 0.0 && orient2d(pc, pa, p) >= 0.0;
    // A corner that coincides with one of the ear's (a slit, a repeated vertex) does not block it.
    !left.iter().any(|&k| k != a && k != b && k != c && !is_corner(flat[k]) && inside(flat[k]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(corners: &[DVec3], triangles: &[[usize; 3]]) -> (DVec3, f64) {
        let cross = |t: &[usize; 3]| (corners[t[1]] - corners[t[0]]).cross(corners[t[2]] - corners[t[0]]) * 0.5;
        (triangles.iter().map(cross).sum(), triangles.iter().map(|t| cross(t).length()).sum())
    }

    /// Signed and unsigned areas agree exactly when no triangle overlaps another or leaves the polygon.
    fn check(corners: &[DVec3], want_area: f64) {
        for turn in [glam::DQuat::IDENTITY, glam::DQuat::from_rotation_x(1.1), glam::DQuat::from_rotation_y(-2.0)] {
            let turned: Vec<DVec3> = corners.iter().map(|&p| turn * p + DVec3::new(1e4, 0.0, 5.0)).collect();
            for start in 0..turned.len() {
                let mut rotated = turned.clone();
                rotated.rotate_left(start);
                let triangles = triangulate(&rotated);
                assert_eq!(triangles.len(), corners.len() - 2);
                let (signed, unsigned) = area(&rotated, &triangles);
                assert!((signed.length() - want_area).abs() < 1e-8, "{signed} {want_area}");
                assert!((unsigned - want_area).abs() < 1e-8, "{unsigned} {want_area}");
                assert!(signed.dot(turn * DVec3::Z) > 0.0);
            }
        }
    }

    fn flat(points: &[[f64; 2]]) -> Vec<DVec3> {
        points.iter().map(|p| DVec3::new(p[0], p[1], 0.0)).collect()
    }

    #[test]
    fn convex_and_concave_polygons_are_covered_once() {
        check(&flat(&[[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]]), 2.0);
        check(&flat(&[[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [2.0, 1.0], [0.0, 4.0]]), 10.0);
        check(
            &flat(&[[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [1.0, 1.0], [1.0, 2.0], [3.0, 2.0], [3.0, 3.0], [0.0, 3.0]]),
            7.0,
        );
    }

    #[test]
    fn convex_polygons_are_fans() {
        let square = flat(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
        assert_eq!(triangulate(&square), [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn odd_polygons_end() {
        assert!(triangulate(&[]).is_empty());
        assert!(triangulate(&flat(&[[0.0, 0.0], [1.0, 0.0]])).is_empty());
        assert_eq!(triangulate(&flat(&[[0.0, 0.0]; 6])).len(), 4);
        assert_eq!(triangulate(&flat(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]])).len(), 2);
    }
}
