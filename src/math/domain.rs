//! Which points a map answers for.
//!
//! Every test is a comparison of f64 values that are sums of products, taken from left to right as written, without fused
//! multiply-add. Whoever evaluates them so gets the same answer for every point, also on a border; whoever does not
//! (a shader in f32) differs only within rounding of one, where methods let neighbouring maps overlap.

use super::RigidMotion;
use glam::{DVec2, DVec3, DVec4};
use serde::{Deserialize, Serialize};

/// Which points look a map up.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub enum Domain {
    /// Every point.
    All,
    /// Points with a x + b y + c z + d ≥ 0.
    HalfSpace {
        /// a, b, c, d; scene space.
        plane: DVec4,
    },
    /// Points whose distance in front of a camera, `forward`·(point - `position`), is at least `from_m` and less than
    /// `to_m`.
    ViewDepth {
        /// The camera, scene space.
        position: DVec3,
        /// Its view axis, unit.
        forward: DVec3,
        /// Metres; -infinity = no lower end.
        from_m: f64,
        /// Metres; infinity = no upper end.
        to_m: f64,
    },
    /// Points in front of a light plane (w > 0) with min ≤ (x / w, y / w) < max there.
    LightPlaneRectangle {
        /// Rows of (x, y, w) on (point, 1), scene space.
        plane_from_scene: [DVec4; 3],
        /// Smallest x / w and y / w.
        min: DVec2,
        /// Past the largest x / w and y / w.
        max: DVec2,
    },
    /// Points in front of a light plane (w > 0) on the inner side of every line: a x + b y + c w ≥ 0. May be unbounded.
    LightPlanePolygon {
        /// Rows of (x, y, w) on (point, 1), scene space.
        plane_from_scene: [DVec4; 3],
        /// a, b, c of each side.
        sides: Vec<DVec3>,
    },
    /// Points whose vector from the light has its largest component along one signed axis of a cube.
    CubeFace {
        /// Position of the light, scene space.
        position: DVec3,
        /// The cube's x, y and z axes in scene space, unit.
        axes: [DVec3; 3],
        /// 0, 1, 2 = x, y, z of the cube.
        axis: usize,
        /// Positive side of the axis.
        positive: bool,
    },
    /// Points that all of these hold.
    Intersection(Vec<Domain>),
}

impl Domain {
    /// The points that `motion` takes into this domain; `None` for a domain that cannot be moved.
    pub fn carried(&self, motion: &RigidMotion) -> Option<Domain> {
        match *self {
            Domain::All => Some(Domain::All),
            Domain::CubeFace { position, axes, axis, positive } => Some(Domain::CubeFace {
                position: motion.inverse_point(position),
                axes: axes.map(|a| motion.inverse_vector(a)),
                axis,
                positive,
            }),
            Domain::HalfSpace { .. }
            | Domain::ViewDepth { .. }
            | Domain::LightPlaneRectangle { .. }
            | Domain::LightPlanePolygon { .. }
            | Domain::Intersection { .. } => None,
        }
    }

    /// Whether a scene point lies in the domain. On ties of a cube face the lower axis wins.
    pub fn holds(&self, point: DVec3) -> bool {
        match self {
            Domain::All => true,
            Domain::HalfSpace { plane } => row_at(*plane, point) >= 0.0,
            Domain::ViewDepth { position, forward, from_m, to_m } => {
                let depth_m = forward.dot(point - *position);
                *from_m <= depth_m && depth_m < *to_m
            }
            Domain::LightPlaneRectangle { plane_from_scene, min, max } => {
                let [x, y, w] = plane_from_scene.map(|row| row_at(row, point));
                let flat = DVec2::new(x / w, y / w);
                w > 0.0 && min.cmple(flat).all() && flat.cmplt(*max).all()
            }
            Domain::LightPlanePolygon { plane_from_scene, sides } => {
                let q = DVec3::from_array(plane_from_scene.map(|row| row_at(row, point)));
                q.z > 0.0 && sides.iter().all(|side| side.dot(q) >= 0.0)
            }
            Domain::CubeFace { position, axes, axis, positive } => {
                let v = point - *position;
                let v = DVec3::new(axes[0].dot(v), axes[1].dot(v), axes[2].dot(v));
                let a = v.abs();
                let largest = if a.x >= a.y && a.x >= a.z {
                    0
                } else if a.y >= a.z {
                    1
                } else {
                    2
                };
                largest == *axis && (v[*axis] > 0.0) == *positive
            }
            Domain::Intersection(all) => all.iter().all(|domain| domain.holds(point)),
        }
    }
}

/// a x + b y + c z + d, from left to right: as domains evaluate their rows.
pub fn row_at(plane: DVec4, p: DVec3) -> f64 {
    plane.x * p.x + plane.y * p.y + plane.z * p.z + plane.w
}

/// The place among `domains` of the one that answers for a point: the first that holds it.
pub fn first_holding<'a>(mut domains: impl Iterator<Item = &'a Domain>, point: DVec3) -> Option<usize> {
    domains.position(|domain| domain.holds(point))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// x, y of scene x, z; w = 1 + scene y.
    const PLANE: [DVec4; 3] = [DVec4::X, DVec4::Z, DVec4::new(0.0, 1.0, 0.0, 1.0)];

    #[test]
    fn borders_belong_to_exactly_one_neighbour() {
        let p = DVec3::new(3.0, 1.0, 4.0); // (1.5, 2) in the light plane, w = 2
        let tile = |x: f64, y: f64| Domain::LightPlaneRectangle {
            plane_from_scene: PLANE,
            min: DVec2::new(x, y),
            max: DVec2::new(x + 1.0, y + 1.0),
        };
        assert!(tile(1.5, 2.0).holds(p) && !tile(0.5, 2.0).holds(p) && !tile(1.5, 1.0).holds(p));
        let depth =
            |from_m, to_m| Domain::ViewDepth { position: DVec3::ZERO, forward: DVec3::Z, from_m, to_m }.holds(p);
        assert!(depth(4.0, f64::INFINITY) && depth(f64::NEG_INFINITY, 4.5) && !depth(1.0, 4.0));
        // Opposite sides of one line both hold a point on it: the first answers.
        let side = |s: DVec3| Domain::LightPlanePolygon { plane_from_scene: PLANE, sides: vec![s] };
        let (a, b) = (side(DVec3::new(2.0, 0.0, -3.0)), side(DVec3::new(-2.0, 0.0, 3.0)));
        assert_eq!(first_holding([&a, &b].into_iter(), p), Some(0));
        assert_eq!(first_holding([&a, &b].into_iter(), p - DVec3::X), Some(1));
        let half = Domain::HalfSpace { plane: DVec4::new(0.0, 1.0, 0.0, -1.0) };
        assert!(half.holds(p) && !half.holds(p - DVec3::Y * 1e-9));
        assert!(!Domain::Intersection(vec![half.clone(), tile(0.5, 2.0)]).holds(p));
        assert!(Domain::Intersection(vec![half, tile(1.5, 2.0)]).holds(p));
    }

    #[test]
    fn behind_a_light_plane_is_in_no_domain_of_it() {
        let behind = DVec3::new(0.0, -1.0, 0.0); // w = 0
        let all = DVec2::splat(f64::INFINITY);
        assert!(!Domain::LightPlaneRectangle { plane_from_scene: PLANE, min: -all, max: all }.holds(behind));
        assert!(!Domain::LightPlanePolygon { plane_from_scene: PLANE, sides: Vec::new() }.holds(behind));
        assert!(
            Domain::LightPlanePolygon { plane_from_scene: PLANE, sides: Vec::new() }.holds(behind + DVec3::Y * 1e-9)
        );
    }
}
