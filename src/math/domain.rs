//! Which points a map answers for.

use super::RigidMotion;
use glam::DVec3;

/// Which points look a map up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Domain {
    /// Every point.
    All,
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
        }
    }

    /// Whether a scene point looks this map up. On ties the lower axis wins.
    pub fn holds(&self, point: DVec3) -> bool {
        match *self {
            Domain::All => true,
            Domain::CubeFace { position, axes, axis, positive } => {
                let v = point - position;
                let v = DVec3::new(axes[0].dot(v), axes[1].dot(v), axes[2].dot(v));
                let a = v.abs();
                let largest = if a.x >= a.y && a.x >= a.z {
                    0
                } else if a.y >= a.z {
                    1
                } else {
                    2
                };
                largest == axis && (v[axis] > 0.0) == positive
            }
        }
    }
}
