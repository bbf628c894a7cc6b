//! What a plane leaves of edges and cover on its side.

use super::super::Inputs;
use crate::math::LightSpace;
use crate::samples::EdgePoint;
use glam::{DVec2, DVec3, DVec4};

/// The edges on a side of a plane.
pub(super) fn held_edges(edges: &[EdgePoint], plane: DVec4) -> Vec<EdgePoint> {
    edges.iter().copied().filter(|e| plane.dot(e.position.extend(1.0)) >= 0.0).collect()
}

/// The covered points on a side of a plane, or within a strip across it, metres. Where the points are but the vertices of a
/// hull in a light plane, the two points are added in which the plane, which holds the light, cuts the hull: the line between
/// two points is a line in the light plane too, so that those of all pairs on both sides hold the two ends of the cut.
pub(super) fn held_points(
    inputs: &Inputs,
    space: &LightSpace,
    points: &[DVec3],
    plane: DVec4,
    strip_m: f64,
) -> Vec<DVec3> {
    let distance = |p: &DVec3| plane.dot(p.extend(1.0)) + strip_m;
    let (mut held, outside): (Vec<DVec3>, Vec<DVec3>) = points.iter().partition(|p| distance(p) >= 0.0);
    if inputs.hull_only {
        let ends = ends_of_cut(space, &held, &outside, distance);
        held.extend(ends.into_iter().flatten());
    }
    held
}

/// Of the points between two sets in which a distance is 0 the two that lie farthest apart in a light plane, where all of
/// them lie on a line.
fn ends_of_cut(
    space: &LightSpace,
    inside: &[DVec3],
    outside: &[DVec3],
    distance: impl Fn(&DVec3) -> f64,
) -> Option<[DVec3; 2]> {
    let mut cuts: Vec<(DVec2, DVec3)> = Vec::with_capacity(inside.len() * outside.len());
    for a in inside {
        let near = distance(a);
        for b in outside {
            let cut = *a + (*b - *a) * (near / (near - distance(b)));
            let q = space.q(cut);
            cuts.push((q.truncate() / q.z, cut));
        }
    }
    // Along the axis that the line is longer in; across a line they differ by rounding alone.
    let ends = |axis: usize| {
        let order = |a: &&(DVec2, DVec3), b: &&(DVec2, DVec3)| a.0[axis].total_cmp(&b.0[axis]);
        let (first, last) = (cuts.iter().min_by(order)?, cuts.iter().max_by(order)?);
        Some((last.0[axis] - first.0[axis], [first.1, last.1]))
    };
    let (x, y) = (ends(0)?, ends(1)?);
    Some(if x.0 >= y.0 { x.1 } else { y.1 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Light, LightKind};

    /// The vertices of a slanted square, cut by planes through a light: nothing of the square on a side lies outside the hull
    /// of what is held there.
    #[test]
    fn halves_of_a_hull_hold_what_lies_between_its_vertices() {
        let corner = |x: f64, z: f64| DVec3::new(x, 0.3 * x - 0.1 * z, z);
        let square = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
        let lamp = DVec3::new(0.2, 3.0, -0.4);
        for kind in [
            LightKind::Directional { direction: DVec3::new(0.3, -1.0, 0.2).normalize() },
            LightKind::Point { position: lamp, range: None },
        ] {
            let light = Light { name: "l".into(), kind };
            let space = LightSpace::around(&light, &square).unwrap();
            let flat = |p: DVec3| {
                let q = space.q(p);
                q.truncate() / q.z
            };
            for turn in 0..8 {
                // A line of the light plane through the middle.
                let middle = flat(corner(0.1, 0.05));
                let normal = DVec2::from_angle(f64::from(turn) * 0.4);
                let plane = space.row_from_q(normal.extend(-normal.dot(middle)));
                let distance = |p: &DVec3| plane.dot(p.extend(1.0));
                let (inside, outside): (Vec<DVec3>, Vec<DVec3>) = square.iter().partition(|p| distance(p) >= 0.0);
                let mut held = inside.clone();
                held.extend(ends_of_cut(&space, &inside, &outside, distance).into_iter().flatten());
                let hull = crate::math::convex_hull(&held.iter().map(|p| flat(*p)).collect::<Vec<_>>());
                let holds = |at: DVec2| {
                    (0..hull.len()).all(|i| (hull[(i + 1) % hull.len()] - hull[i]).perp_dot(at - hull[i]) >= -1e-12)
                };
                let steps = || (0..=20).map(|i| f64::from(i) / 10.0 - 1.0);
                for (x, z) in steps().flat_map(|x| steps().map(move |z| (x, z))) {
                    let point = corner(x, z);
                    assert!(distance(&point) < 0.0 || holds(flat(point)), "{turn}: {point}");
                }
            }
        }
    }
}
