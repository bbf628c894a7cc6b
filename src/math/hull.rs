//! Convex hulls in the plane: Andrew's monotone chain on exact orientation tests (Shewchuk, crate `robust`).

use glam::DVec2;
use robust::{Coord, orient2d};

/// Convex hull, counter-clockwise, without collinear or repeated points. Non-finite points are ignored. Fewer than three
/// vertices when the points are empty, single or collinear.
pub fn convex_hull(points: &[DVec2]) -> Vec<DVec2> {
    let mut sorted = outer(points);
    sorted.sort_unstable_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    sorted.dedup();
    if sorted.len() < 3 {
        return sorted;
    }
    let mut hull: Vec<DVec2> = Vec::with_capacity(32);
    let half = |hull: &mut Vec<DVec2>, points: &mut dyn Iterator<Item = DVec2>, keep: usize| {
        for p in points {
            while hull.len() >= keep + 2 && !turns_left(hull[hull.len() - 2], hull[hull.len() - 1], p) {
                hull.pop();
            }
            hull.push(p);
        }
    };
    half(&mut hull, &mut sorted.iter().copied(), 0);
    let lower = hull.len() - 1;
    half(&mut hull, &mut sorted.iter().rev().skip(1).copied(), lower);
    hull.pop();
    hull
}

/// Points below which a hull is found as fast without leaving any out.
const FEW: usize = 64;

/// Finite points without most of those inside the polygon of the extremes in eight directions (Akl and Toussaint 1978). A
/// point goes only when it lies inside by more than rounding.
fn outer(points: &[DVec2]) -> Vec<DVec2> {
    let finite = || points.iter().copied().filter(|p| p.is_finite());
    if points.len() < FEW {
        return finite().collect();
    }
    let axes = [(1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (-1.0, 1.0)].map(|(x, y)| DVec2::new(x, y));
    let mut extremes = [[DVec2::ZERO; 4]; 2];
    let (mut low, mut high) = ([f64::INFINITY; 4], [f64::NEG_INFINITY; 4]);
    for p in finite() {
        for (k, axis) in axes.iter().enumerate() {
            let along = axis.dot(p);
            if along < low[k] {
                (low[k], extremes[1][k]) = (along, p);
            }
            if along > high[k] {
                (high[k], extremes[0][k]) = (along, p);
            }
        }
    }
    let corners = extremes.concat();
    let size =
        (high[0] - low[0]).max(high[2] - low[2]) + high[0].abs().max(low[0].abs()) + high[2].abs().max(low[2].abs());
    // An orientation of coordinates up to `size` errs by less than this.
    let rounding = 16.0 * f64::EPSILON * size * size;
    let edges: [(DVec2, DVec2); 8] = std::array::from_fn(|k| (corners[k], corners[(k + 1) % 8] - corners[k]));
    let sides = edges.iter().filter(|(_, edge)| *edge != DVec2::ZERO);
    if sides.clone().next().is_none() {
        return finite().collect();
    }
    let inside = |p: &DVec2| sides.clone().all(|(corner, edge)| edge.perp_dot(*p - *corner) > rounding);
    finite().filter(|p| !inside(p)).collect()
}

fn turns_left(a: DVec2, b: DVec2, c: DVec2) -> bool {
    let coord = |p: DVec2| Coord { x: p.x, y: p.y };
    orient2d(coord(a), coord(b), coord(c)) > 0.0
}

/// At most `count` vertices of a convex polygon: its support points in `count` evenly spread directions, in the order
/// of the polygon. An inner approximation whose width errs by at most 1 - cos(π/count) of the diameter.
pub fn support_subset(hull: &[DVec2], count: usize) -> Vec<DVec2> {
    if hull.len() <= count {
        return hull.to_vec();
    }
    let mut keep = vec![false; hull.len()];
    for k in 0..count {
        let (s, c) = (std::f64::consts::TAU * k as f64 / count as f64).sin_cos();
        let direction = DVec2::new(c, s);
        let best = (0..hull.len()).fold(0, |b, i| if hull[i].dot(direction) > hull[b].dot(direction) { i } else { b });
        keep[best] = true;
    }
    hull.iter().zip(keep).filter_map(|(p, k)| k.then_some(*p)).collect()
}

/// A convex polygon without the vertices that lie within `distance` of the sides that close over them: what rounding leaves
/// along straight sides and about corners, where such sides would point anywhere. Begins at its farthest vertex from the
/// middle, a corner whatever the rounding; at least three vertices stay.
pub fn without_flat(hull: &[DVec2], distance: f64) -> Vec<DVec2> {
    let n = hull.len();
    let middle = hull.iter().fold(DVec2::ZERO, |sum, p| sum + *p) / n.max(1) as f64;
    let farther = |a: usize, b: usize| if hull[b].distance(middle) > hull[a].distance(middle) { b } else { a };
    let first = (0..n).reduce(farther).unwrap_or(0);
    let at = |k: usize| hull[(first + k) % n];
    let mut kept: Vec<usize> = Vec::with_capacity(n);
    for k in 0..n {
        // All vertices since the last one kept lie near the line from it to the next one.
        let flat = kept.last().is_some_and(|&before| {
            let (from, along) = (at(before), at(k + 1) - at(before));
            (before + 1..=k).all(|j| along.perp_dot(at(j) - from).abs() <= distance * along.length())
        });
        if !flat || kept.len() + (n - k - 1) < 3 {
            kept.push(k);
        }
    }
    kept.into_iter().map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn square_with_inner_and_collinear_points() {
        let mut points = vec![DVec2::new(0.5, 0.5), DVec2::new(0.5, 0.0), DVec2::new(f64::NAN, 0.0)];
        points.extend([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (1.0, 1.0)].map(|(x, y)| DVec2::new(x, y)));
        let hull = convex_hull(&points);
        assert_eq!(hull, [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(x, y)| DVec2::new(x, y)));
    }

    #[test]
    fn leaving_inner_points_out_changes_nothing() {
        let at = |i: u32, k: u32| f64::from(i.wrapping_mul(2_654_435_761).wrapping_mul(k) >> 8) / f64::from(1 << 24);
        for centre in [0.0, 1e7] {
            let cloud: Vec<DVec2> = (1..3000).map(|i| DVec2::new(at(i, 3) + centre, at(i, 5) * at(i, 7))).collect();
            let round: Vec<DVec2> = cloud.iter().map(|p| DVec2::from_angle(p.y * 9.0) * 3.0 + centre).collect();
            let grid: Vec<DVec2> =
                (0..900).map(|i| DVec2::new(f64::from(i % 30), f64::from(i / 30)) + centre).collect();
            for points in [cloud, round, grid, vec![DVec2::ONE; 100]] {
                let hull = convex_hull(&points);
                assert!(outer(&points).len() <= points.len());
                // The hull of the hull and any few points is the hull.
                for few in points.chunks(40) {
                    let with: Vec<DVec2> = hull.iter().chain(few).copied().collect();
                    assert_eq!(convex_hull(&with), hull);
                }
            }
        }
    }

    #[test]
    fn degenerate_inputs() {
        assert!(convex_hull(&[]).is_empty());
        assert_eq!(convex_hull(&[DVec2::ONE, DVec2::ONE]).len(), 1);
        assert_eq!(convex_hull(&(0..9).map(|i| DVec2::splat(f64::from(i))).collect::<Vec<_>>()).len(), 2);
    }

    #[test]
    fn flat_vertices_go_and_corners_stay() {
        let at = |x: f64, y: f64| DVec2::new(x, y);
        let corners = [at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)];
        let hull = [
            at(0.0, 0.0),
            at(0.3, -1e-9),
            at(0.6, -1e-9),
            at(1.0, 0.0),
            at(1.0 + 1e-9, 1e-9),
            at(1.0, 1.0),
            at(0.0, 1.0),
        ];
        let found = without_flat(&hull, 1e-6);
        assert_eq!(found.len(), 4, "{found:?}");
        let is_corner = |p: &DVec2| corners.iter().any(|q| (*p - *q).length() < 1e-8);
        assert!(found.iter().all(is_corner), "{found:?}");
        assert_eq!(without_flat(&corners, 1e-6).len(), 4);
        for few in 0..=3 {
            assert_eq!(without_flat(&vec![DVec2::ONE; few], 1.0).len(), few);
        }
        assert_eq!(without_flat(&corners, 9.0).len(), 3);
        // A smooth polygon loses no more than the distance.
        let circle: Vec<DVec2> = (0..3600).map(|i| DVec2::from_angle((0.1 * f64::from(i)).to_radians())).collect();
        let thinned = without_flat(&circle, 1e-4);
        let inner = (0..thinned.len()).map(|k| thinned[k].midpoint(thinned[(k + 1) % thinned.len()]).length());
        assert!(thinned.len() < 1900 && inner.fold(1.0, f64::min) > 1.0 - 2e-4, "{}", thinned.len());
    }

    #[test]
    fn subset_keeps_extremes_and_order() {
        let circle: Vec<DVec2> = (0..360).map(|i| DVec2::from_angle(f64::from(i).to_radians())).collect();
        let hull = convex_hull(&circle);
        let subset = support_subset(&hull, 32);
        assert!(subset.len() <= 32 && subset.len() >= 30);
        assert_eq!(convex_hull(&subset).len(), subset.len());
    }
}
