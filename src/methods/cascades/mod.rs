//! Cascades, or z-partitioning: the view is cut across its axis, and each range of depth gets a map.
//!
//! Split schemes of Zhang, Sun, Xu and Lun 2006 (*Parallel-Split Shadow Maps*), from n to f over m ranges:
//!
//! ```text
//! uniform       n + (f - n) i/m
//! logarithmic   n (f/n)^(i/m)
//! blended       λ logarithmic + (1 - λ) uniform
//! ```
//!
//! n and f are the ends of view ∩ light ∩ scene: the authors' code too draws the view's ends in to the scene. Or, after
//! Lauritzen, Salvi and Lefohn 2011 (*Sample Distribution Shadow Maps*), n and f are those of the visible samples, split
//! logarithmically, with maps around the samples of a range alone.
//!
//! Each range has one of three maps. `plain`: the focused map of its part of the view (the smallest rectangle, where
//! older code takes the box along a fixed axis). `warped`: LiSPSM with n_opt for its part of the view (Lloyd et al. 2006;
//! course slides, "Z-partitioning and warping"). `stable`: [`stable`].
//!
//! All ranges get the same texels, as in the papers. Deviations: a range that holds nothing to cover gets no map, and its
//! texels go to the others; the samples are the covered points, not all pixels.

mod stable;

use super::split::{parts, solve_parts};
use super::{CascadeFit, CascadeSplit, Inapplicable, Inputs, Region, SolverParams, focused, lispsm};
use crate::math::Domain;
use crate::scene::Projection;
use glam::{DVec3, DVec4};

/// Solves all ranges.
pub(super) fn solve(inputs: &Inputs, axis: Option<DVec3>) -> Result<Vec<Region>, Inapplicable> {
    let (camera, solver) = (inputs.camera, inputs.solver);
    let by_samples = solver.cascade_split == CascadeSplit::Samples;
    let (near, far) = match (by_samples, solver.cascade_fit) {
        (true, _) => extent(inputs, inputs.covered),
        (false, CascadeFit::Stable) => stable::view_range(inputs, axis)?,
        (false, _) => extent(inputs, &focused::view_body(inputs, axis)?),
    };
    let logarithmic = solver.cascade_split != CascadeSplit::Uniform;
    if logarithmic && !(near > 0.0 && matches!(camera.projection, Projection::Perspective { .. })) {
        return Err(Inapplicable::NoLogarithmicSplit);
    }
    let ends = ends(solver, near, far);
    let last = ends.len() - 2;
    let (position, forward) = (camera.position, camera.forward());
    let across = |depth_m: f64| forward.extend(-forward.dot(position) - depth_m);
    let cell = |i: usize| -> (Domain, Vec<DVec4>) {
        let from_m = if i == 0 { f64::NEG_INFINITY } else { ends[i] };
        let to_m = if i == last { f64::INFINITY } else { ends[i + 1] };
        (Domain::ViewDepth { position, forward, from_m, to_m }, vec![across(ends[i]), -across(ends[i + 1])])
    };
    let ranges = parts(inputs, (0..=last).map(cell).collect());
    solve_parts(inputs, &ranges, |i, given| match solver.cascade_fit {
        CascadeFit::Stable => stable::solve(given, ends[i], ends[i + 1]),
        CascadeFit::Plain if by_samples => focused::around(given, axis, given.covered),
        CascadeFit::Plain => focused::solve(given, axis),
        CascadeFit::Warped if by_samples => lispsm::around(given, axis, given.covered.to_vec()),
        CascadeFit::Warped => lispsm::solve(given, axis),
    })
}

/// The ends of the ranges, count + 1, ascending.
fn ends(solver: &SolverParams, near: f64, far: f64) -> Vec<f64> {
    let blend = match solver.cascade_split {
        CascadeSplit::Uniform => 0.0,
        CascadeSplit::Blend => solver.cascade_blend,
        CascadeSplit::Log | CascadeSplit::Samples => 1.0,
    };
    let count = solver.cascade_count.max(1);
    let at = |i: u32| {
        let part = f64::from(i) / f64::from(count);
        let uniform = near + (far - near) * part;
        // The logarithm of a near end that is not in front of the camera is no number, even with a weight of nothing.
        if blend == 0.0 { uniform } else { blend * near * (far / near).powf(part) + (1.0 - blend) * uniform }
    };
    (0..=count).map(at).collect()
}

/// Least and largest depth along the view axis, metres.
fn extent(inputs: &Inputs, points: &[DVec3]) -> (f64, f64) {
    let depth = |p: &DVec3| inputs.camera.forward().dot(*p - inputs.camera.position);
    points.iter().map(depth).fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), d| (lo.min(d), hi.max(d)))
}
