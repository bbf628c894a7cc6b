//! A light among the geometry: what it has to cover fits no half-space, so its directions are split by the faces of a
//! cube, and only the faces that hold covered points get a map (math note §1).

use super::region::Region;
use super::{Inapplicable, Inputs};
use crate::math::Domain;
use glam::DVec3;

/// Solves with one plane, or else with one plane for each needed cube face. The solver gets the view axis of a face, or
/// `None` to choose its own.
pub(super) fn by_cube_faces(
    inputs: &Inputs,
    solve: impl Fn(&Inputs, Option<DVec3>) -> Result<Region, Inapplicable>,
) -> Result<Vec<Region>, Inapplicable> {
    match (solve(inputs, None), inputs.light.position()) {
        (Ok(region), _) => Ok(vec![region]),
        (Err(Inapplicable::NoHalfSpace), Some(position)) => {
            let mut regions = Vec::new();
            for face in 0..6 {
                let (axis, positive) = (face / 2, face % 2 == 0);
                let domain = Domain::CubeFace { position, axes: DVec3::AXES, axis, positive };
                let covered: Vec<DVec3> = inputs.covered.iter().copied().filter(|p| domain.holds(*p)).collect();
                if covered.is_empty() {
                    continue;
                }
                let edges: Vec<_> = inputs.edges.iter().copied().filter(|e| domain.holds(e.position)).collect();
                let direction = DVec3::AXES[axis] * if positive { 1.0 } else { -1.0 };
                let face = Inputs { covered: &covered, edges: &edges, ..*inputs };
                let mut region = solve(&face, Some(direction))?;
                region.domain = domain.clone();
                regions.push(region);
            }
            Ok(regions)
        }
        (Err(reason), _) => Err(reason),
    }
}
