//! Separating plane perspective shadow maps: Mikkelsen 2007.
//!
//! A focused map (1) and one of the perspective family (2) share the light. A point goes to the map that gives its pixel
//! the larger area,
//!
//! ```text
//! |det J_i| = |n_i·(x_i, y_i, w_i)| / |w_i|³,    |n_1·(x_1, y_1, w_1)| |w_2|³  >  |n_2·(x_2, y_2, w_2)| |w_1|³      (3)
//! ```
//!
//! (in print (3) has w_1 and w_2 exchanged, and the third minor of its determinant multiplies z_i where it is w_i). On
//! light planes n_i·(x_i, y_i, w_i) is det(H_i) V with the same V for both maps, so that the cube root of (3) is linear:
//!
//! ```text
//! ∛det(H_2) w_1(X) - ∛det(H_1) w_2(X)  ≥  0       the perspective map's side                                     (6)
//! ```
//!
//! a plane through the light, as w_1 and w_2 vanish there. Both maps get the same number of texels, as in the paper; a
//! map whose side holds nothing to cover is left out.
//!
//! The refocusing of §6: iteration 1 fits both maps to the whole of I; each further one fits each map to its own side of
//! the plane, and then the plane to the maps, except in the last, so that each map holds its side. A plane that would
//! leave one of them nothing to cover ends the refocusing: the paper, which saw none, gives no rule for it.

use super::split::{parts, solve_parts};
use super::{Inapplicable, Inputs, PerspectiveMethod, Region, focused, lispsm, psm, tsm};
use crate::math::Domain;
use glam::{DVec3, DVec4};

/// Covered points that take part in refocusing.
const FEW: usize = 1024;

/// Solves both maps.
pub(super) fn solve(inputs: &Inputs, axis: Option<DVec3>) -> Result<Vec<Region>, Inapplicable> {
    let perspective = match inputs.solver.separating_map {
        PerspectiveMethod::Psm => psm::solve,
        PerspectiveMethod::Tsm => tsm::solve,
        PerspectiveMethod::Lispsm => lispsm::solve,
    };
    let map =
        |side: usize, given: &Inputs| if side == 0 { perspective(given, axis) } else { focused::solve(given, axis) };
    let mut plane = separating_plane(&map(0, inputs)?, &map(1, inputs)?);
    let focusing = inputs.solver.separating_iterations > 1;
    // All that is covered lies in I: a few points stand for it while only the plane is looked for.
    let few: Vec<DVec3> = inputs.covered.iter().step_by(inputs.covered.len() / FEW + 1).copied().collect();
    let draft = Inputs { covered: &few, edges: &[], ..*inputs };
    // The first iteration is done; the last one leaves the plane as it is.
    for _ in 2..inputs.solver.separating_iterations {
        let regions = solve_parts(&draft, &parts(&draft, sides_of(plane)), map)?;
        let [warped, focused] = regions.as_slice() else { break };
        let next = separating_plane(warped, focused);
        if parts(&draft, sides_of(next)).iter().any(|side| side.covered.is_empty()) {
            break;
        }
        plane = next;
    }
    let sides = sides_of(plane).into_iter().map(|(domain, clip)| (domain, if focusing { clip } else { Vec::new() }));
    let sides = parts(inputs, sides.collect());
    let whole = |side: usize, given: &Inputs| map(side, &Inputs { edges: given.edges, ..*inputs });
    if focusing { solve_parts(inputs, &sides, map) } else { solve_parts(inputs, &sides, whole) }
}

/// The perspective map's side, and what is left, with what bounds the view on either.
fn sides_of(plane: DVec4) -> Vec<(Domain, Vec<DVec4>)> {
    vec![(Domain::HalfSpace { plane }, vec![plane]), (Domain::All, vec![-plane])]
}

/// (a, b, c, d), a x + b y + c z + d ≥ 0 where the area of a pixel is larger in `warped` than in `focused` (6). Of unit
/// normal, unless there is none: two maps without a warp differ alike everywhere.
fn separating_plane(warped: &Region, focused: &Region) -> DVec4 {
    let w = |region: &Region| region.space.row_from_q(region.h.row(2));
    let plane = w(focused) * warped.h.determinant().cbrt() - w(warped) * focused.h.determinant().cbrt();
    let length = plane.truncate().length();
    if length > 0.0 { plane / length } else { plane }
}
