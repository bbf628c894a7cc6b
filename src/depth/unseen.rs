//! What the depth range of a map has to hold where casters are not known: the visible points that look it up, and room
//! towards the light in which something may stand that no image shows.
//!
//! Room costs little: bias is drawn from slopes, which scale with the range, and f32 depth resolves far more than a texel.

use super::kept::{Kept, along_its_ray, vector};
use crate::math::{Domain, LightSpace};
use glam::{DMat3, DVec3, DVec4};

/// How far towards the light, and away from it, a map keeps what it does not see.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Unseen {
    /// The range begins here at the latest, metres along the map's axis (directional: along the light, from the origin of the
    /// scene); absent = by what is seen.
    pub near_m: Option<f64>,
    /// The range ends here at the earliest, likewise.
    pub far_m: Option<f64>,
    /// Of a directional light: room in front of what is seen where there is no `near_m`, metres.
    pub reach_m: f64,
}

/// Where a point or spot light's range begins, as a part of the distance of the nearest thing seen. f32 depth then still
/// resolves 10⁻⁴ of that distance at four times it.
const NEAR_PART: f64 = 1.0 / 64.0;

impl Kept<'_> {
    /// What the map `h` keeps when `visible` points in its domain and square look it up and nothing is known of casters.
    pub fn of_visible(
        space: &LightSpace,
        h: &DMat3,
        visible: &[DVec3],
        domain: &Domain,
        unseen: &Unseen,
    ) -> Kept<'static> {
        let (p1, p2, p4) = (h.row(0), h.row(1), h.row(2));
        let looks_up = |p: &DVec3| {
            let (q, inside) = (space.q(*p), |u: f64, w: f64| u >= 0.0 && u <= w);
            let w = p4.dot(q);
            domain.holds(*p) && w > 0.0 && inside(p1.dot(q), w) && inside(p2.dot(q), w)
        };
        let held: Vec<DVec3> = visible.iter().copied().filter(looks_up).collect();
        let mut points = Vec::with_capacity(2 * held.len());
        if space.directional {
            let along = |p: &DVec3| space.along(*p);
            let nearest = held.iter().map(along).fold(f64::INFINITY, f64::min);
            let from_centre = |from_origin: f64| from_origin - space.center_along();
            let near = unseen.near_m.map_or(nearest - unseen.reach_m, from_centre);
            for p in &held {
                let (q, w, d) = (space.q(*p), p4.dot(space.q(*p)), along(p));
                points.push(q.extend(d.max(unseen.far_m.map_or(d, from_centre))) / w);
                points.push(q.extend(d.min(near)) / w);
            }
        } else {
            let metres = |p: &DVec3| p4.dot(space.q(*p)) / p4.length();
            let nearest = held.iter().map(metres).fold(f64::INFINITY, f64::min);
            let near = unseen.near_m.unwrap_or(nearest * NEAR_PART);
            for p in &held {
                let (v, distance) = (vector(space, *p), metres(p));
                let at = |metres: f64| {
                    let v = along_its_ray(space, v, metres / distance);
                    v / p4.dot(v.truncate())
                };
                points.push(at(distance.max(unseen.far_m.unwrap_or(distance))));
                points.push(at(distance.min(near)));
            }
        }
        Kept::of_points(space, h, points.into_iter().filter(|v: &DVec4| v.is_finite()).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::depth::{RowKind, fit_row};

    #[test]
    fn the_range_holds_what_is_seen_and_room_towards_the_light() {
        // Above the origin, so that distances from there are not those from the floor.
        let floor: Vec<DVec3> = (0..100).map(|i| DVec3::new(f64::from(i % 10), 7.0, f64::from(i / 10))).collect();
        let square = |side: f64| DMat3::from_diagonal(DVec3::new(1.0 / side, 1.0 / side, 1.0));
        let sun = crate::scene::Light {
            name: String::new(),
            kind: crate::scene::LightKind::Directional { direction: DVec3::NEG_Y },
        };
        let space = LightSpace::around(&sun, &floor).unwrap();
        let h = square(100.0) + DMat3::from_cols(DVec3::ZERO, DVec3::ZERO, DVec3::new(0.5, 0.5, 0.0));
        let range = |unseen: &Unseen| {
            let row = fit_row(&Kept::of_visible(&space, &h, &floor, &Domain::All, unseen), RowKind::Plain).unwrap();
            [row.near_m, row.far_m].map(|m| m + space.center_along())
        };
        let close = |a: [f64; 2], b: [f64; 2]| (0..2).all(|i| (a[i] - b[i]).abs() < 1e-3);
        assert!(close(range(&Unseen { reach_m: 12.0, ..Unseen::default() }), [-19.0, -7.0]));
        let stated = Unseen { near_m: Some(-30.0), far_m: Some(2.0), reach_m: 12.0 };
        assert!(close(range(&stated), [-30.0, 2.0]));
        let within = Unseen { near_m: Some(-2.0), far_m: Some(-12.0), reach_m: 1.0 };
        let empty = range(&within);
        assert!(empty[0] <= -7.0 + 1e-3 && empty[1] >= -7.0 - 1e-3, "what is seen stays in: {empty:?}");

        let lamp = DVec3::new(4.5, 11.0, 4.5);
        let space = LightSpace::perspective(lamp, DVec3::NEG_Y, DVec3::new(4.5, 7.0, 4.5));
        let h = square(4.0) + DMat3::from_cols(DVec3::ZERO, DVec3::ZERO, DVec3::new(0.5, 0.5, 0.0));
        let range = |unseen: &Unseen| {
            let row = fit_row(&Kept::of_visible(&space, &h, &floor, &Domain::All, unseen), RowKind::Plain).unwrap();
            [row.near_m, row.far_m]
        };
        assert!(close(range(&Unseen::default()), [4.0 * NEAR_PART, 4.0]));
        assert!(close(range(&Unseen { near_m: Some(0.5), far_m: Some(6.0), reach_m: 0.0 }), [0.5, 6.0]));
    }
}
