//! Homographies near a given one that cover the same polygon: steps of a search that measures what the moments do not see.

use super::affine::{ASPECT_MAX, SIN_MIN};
use super::search::base_rows;
use super::{Aspect, Normalisation, PolarPolygon, Shape, unit_square_rows};
use glam::{DMat3, DVec2, DVec3};

/// How far, and where to.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// Of (a, b) of p4, in parts of the way from 0 to the border of the legal ones.
    pub warp: DVec2,
    /// Of the two axes of the map, radians.
    pub turn_rad: [f64; 2],
    /// Of the logarithm of width over height, where it is free.
    pub stretch: f64,
}

/// A map to step from: rows p1, p2, p4 on normalised q that take the hull to the unit square, and width over height.
pub type RowsAndAspect = ([DVec3; 3], f64);

/// The map a step away, flush with the hull again. `None` where that is not legal or the step leaves everything as it is.
pub fn near(
    (rows, ratio): &RowsAndAspect,
    step: &Step,
    hull: &[DVec2],
    normalisation: &Normalisation,
    (shape, aspect, directional): (Shape, Aspect, bool),
) -> Option<RowsAndAspect> {
    let ab = rows[2].truncate() / rows[2].z;
    let base = |ab: DVec2| base_rows(shape, directional, normalisation, ab);
    // p1 and p2 in the base: n.x b1 + n.y b2 less a part of p4.
    let [b1, b2, p4] = base(ab);
    let in_base = DMat3::from_cols(b1, b2, p4).inverse();
    let angle = |row: DVec3| (in_base * row).truncate().to_angle();
    let turn = if shape == Shape::Rectangle { [step.turn_rad[0]; 2] } else { step.turn_rad };
    let angles = [angle(rows[0]) + turn[0], angle(rows[1]) + turn[1]];
    if (angles[0] - angles[1]).sin().abs() < SIN_MIN {
        return None;
    }
    let moves = shape == Shape::Projective || !directional;
    let polar = PolarPolygon::new(hull);
    let far = polar.radius(step.warp.normalize_or(DVec2::X));
    let ab = if moves { ab + step.warp * far } else { ab };
    if polar.w_min(ab) <= 0.0 {
        return None;
    }
    let ratio = match aspect {
        Aspect::Free => (ratio * step.stretch.exp()).clamp(1.0 / ASPECT_MAX, ASPECT_MAX),
        Aspect::Fixed(ratio) => ratio,
    };
    Some((unit_square_rows(hull, &base(ab), angles)?, ratio))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::normalise;

    const SHAPES: [(Shape, bool); 5] = [
        (Shape::Projective, true),
        (Shape::Projective, false),
        (Shape::Affine, true),
        (Shape::Rectangle, true),
        (Shape::Rectangle, false),
    ];

    fn hull() -> (Vec<DVec2>, Normalisation) {
        let hull = [(-1.0, -0.5), (0.9, -0.7), (1.2, 0.1), (0.3, 1.0)].map(|(x, y)| DVec2::new(x, y));
        let normalisation = normalise(&hull).unwrap();
        (hull.map(|p| normalisation.point(p)).to_vec(), normalisation)
    }

    /// No step gives the same map; a step gives another one, which still fills the unit square with the hull.
    #[test]
    fn a_step_stays_flush_and_nothing_else_moves() {
        let (hull, normalisation) = hull();
        for (shape, directional) in SHAPES {
            let warp = if directional && shape != Shape::Projective { DVec2::ZERO } else { DVec2::new(0.2, -0.1) };
            let base = base_rows(shape, directional, &normalisation, warp);
            let start = (unit_square_rows(&hull, &base, [0.3, 0.3 + std::f64::consts::FRAC_PI_2]).unwrap(), 1.5);
            let step = |warp: DVec2, turn: f64, stretch: f64| {
                let step = Step { warp, turn_rad: [turn, -0.5 * turn], stretch };
                near(&start, &step, &hull, &normalisation, (shape, Aspect::Free, directional)).unwrap()
            };
            let (rows, ratio) = step(DVec2::ZERO, 0.0, 0.0);
            assert!(rows.iter().zip(start.0).all(|(a, b)| (*a - b).length() < 1e-12) && ratio == 1.5, "{shape:?}");
            let (rows, ratio) = step(DVec2::new(0.05, 0.1), 0.1, 0.2);
            assert!(rows.iter().zip(start.0).any(|(a, b)| (*a - b).length() > 1e-3), "{shape:?}");
            assert!((ratio / 1.5 - 0.2_f64.exp()).abs() < 1e-12);
            for row in 0..2 {
                let at = hull.iter().map(|v| rows[row].dot(v.extend(1.0)) / rows[2].dot(v.extend(1.0)));
                let (low, high) = at.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
                assert!(low > 0.0 && low < 1e-3 && high < 1.0 && high > 1.0 - 1e-3, "{shape:?}: {low} {high}");
            }
            assert!(crate::math::det3(rows[0], rows[1], rows[2]) > 0.0);
        }
    }

    #[test]
    fn a_step_over_the_border_or_onto_one_axis_is_none() {
        let (hull, normalisation) = hull();
        let base = base_rows(Shape::Projective, true, &normalisation, DVec2::ZERO);
        let start = (unit_square_rows(&hull, &base, [0.0, std::f64::consts::FRAC_PI_2]).unwrap(), 1.0);
        let of = |warp: DVec2, turn: f64| {
            let step = Step { warp, turn_rad: [turn, 0.0], stretch: 0.0 };
            near(&start, &step, &hull, &normalisation, (Shape::Projective, Aspect::Fixed(1.0), true))
        };
        assert!(of(DVec2::new(0.9, 0.0), 0.0).is_some());
        assert!(of(DVec2::new(1.1, 0.0), 0.0).is_none());
        assert!(of(DVec2::ZERO, std::f64::consts::FRAC_PI_2).is_none());
    }
}
