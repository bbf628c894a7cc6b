//! A light's cover in parts: by the cells of a method with several maps, and by the faces of a cube around a light that
//! stands among the geometry, whose cover fits no half-space (math note §1).

use super::region::Region;
use super::{Inapplicable, Inputs};
use crate::math::{Domain, first_holding};
use crate::samples::EdgePoint;
use glam::{DVec3, DVec4};

/// What one map of several answers for.
pub(super) struct Part {
    /// Which points look it up.
    pub(super) domain: Domain,
    /// Half-spaces (n, d), n·p + d ≥ 0, that bound the view as far as this map is concerned, with those of the inputs.
    clip: Vec<DVec4>,
    /// The covered points that look it up.
    pub(super) covered: Vec<DVec3>,
    /// The edges on it.
    edges: Vec<EdgePoint>,
}

impl Part {
    /// The inputs of the part alone.
    pub(super) fn inputs<'a>(&'a self, inputs: &Inputs<'a>) -> Inputs<'a> {
        Inputs { covered: &self.covered, edges: &self.edges, clip: &self.clip, ..*inputs }
    }
}

/// Cover and edges by the first cell that holds them. A cell is a domain and the half-spaces that bound the view there.
pub(super) fn parts(inputs: &Inputs, cells: Vec<(Domain, Vec<DVec4>)>) -> Vec<Part> {
    let mut parts: Vec<Part> = cells
        .into_iter()
        .map(|(domain, clip)| {
            let clip = inputs.clip.iter().copied().chain(clip).collect();
            Part { domain, clip, covered: Vec::new(), edges: Vec::new() }
        })
        .collect();
    let find = |parts: &[Part], point: DVec3| first_holding(parts.iter().map(|p| &p.domain), point);
    for point in inputs.covered {
        if let Some(k) = find(&parts, *point) {
            parts[k].covered.push(*point);
        }
    }
    for edge in inputs.edges {
        if let Some(k) = find(&parts, edge.position) {
            parts[k].edges.push(*edge);
        }
    }
    parts
}

/// The maps of the parts that hold covered points, each with an even share of the texels. Where one is left out, the last
/// answers for its points too: they need no map, but a consumer wants an answer for every point.
pub(super) fn solve_parts(
    inputs: &Inputs,
    parts: &[Part],
    solve: impl Fn(usize, &Inputs) -> Result<Region, Inapplicable>,
) -> Result<Vec<Region>, Inapplicable> {
    let mut regions = Vec::with_capacity(parts.len());
    for (k, part) in parts.iter().enumerate() {
        if !part.covered.is_empty() {
            let region = solve(k, &part.inputs(inputs))?;
            regions.push(Region { domain: part.domain.clone(), share: Some(1.0), ..region });
        }
    }
    if regions.len() < parts.len()
        && let Some(last) = regions.last_mut()
    {
        last.domain = Domain::All;
    }
    Ok(regions)
}

/// Solves with one plane, or else with one plane for each needed cube face. The solver gets the view axis of a face, or
/// `None` to choose its own.
pub(super) fn by_cube_faces(
    inputs: &Inputs,
    solve: impl Fn(&Inputs, Option<DVec3>) -> Result<Vec<Region>, Inapplicable>,
) -> Result<Vec<Region>, Inapplicable> {
    match (solve(inputs, None), inputs.light.position()) {
        (Err(Inapplicable::NoHalfSpace), Some(position)) => {
            let face = |k: usize| {
                let (axis, positive) = (k / 2, k.is_multiple_of(2));
                (Domain::CubeFace { position, axes: DVec3::AXES, axis, positive }, Vec::new())
            };
            let mut regions = Vec::new();
            for (k, part) in parts(inputs, (0..6).map(face).collect()).iter().enumerate() {
                if part.covered.is_empty() {
                    continue;
                }
                let direction = DVec3::AXES[k / 2] * if k.is_multiple_of(2) { 1.0 } else { -1.0 };
                for region in solve(&part.inputs(inputs), Some(direction))? {
                    let domain = match region.domain.clone() {
                        Domain::All => part.domain.clone(),
                        within => Domain::Intersection(vec![part.domain.clone(), within]),
                    };
                    regions.push(Region { domain, ..region });
                }
            }
            Ok(regions)
        }
        (solved, _) => solved,
    }
}
