//! The plane of the scene that holds most shadow edge.
//!
//! Every tangent plane of an edge point is a candidate; the one with most edge length on it wins and is refitted to that
//! edge by least squares. Candidates are taken in the order of the film, so that the order of the samples, and where the
//! world has its zero and axes, do not matter.

use super::{Inapplicable, Inputs};
use crate::samples::EdgePoint;
use glam::DVec3;
use nalgebra::{Matrix3, SymmetricEigen};

/// Candidates tried.
const CANDIDATES: usize = 256;
/// Edge points that vote.
const VOTERS: usize = 4096;
/// Distance from a plane, relative to that from the camera, within which a point is on it: about the angle of a few
/// pixels.
const ON_PLANE: f64 = 0.005;
/// Least cosine between a plane's normal and that of a surface on it.
const SAME_NORMAL: f64 = 0.99;
/// Rounds of refitting.
const ROUNDS: u32 = 3;

/// An edge point with its surface's unit normal and what it weighs.
struct Vote {
    position: DVec3,
    normal: DVec3,
    length_px: f64,
    reach: f64,
}

/// Unit normal n and d of n·X + d = 0.
pub(super) fn plane_of_most_edges(inputs: &Inputs) -> Result<(DVec3, f64), Inapplicable> {
    let mut ordered: Vec<&EdgePoint> = inputs.edges.iter().collect();
    ordered.sort_by(|a, b| a.film[1].total_cmp(&b.film[1]).then(a.film[0].total_cmp(&b.film[0])));
    let votes: Vec<Vote> = spread(&ordered, VOTERS).filter_map(|e| vote(inputs, e)).collect();
    let length = |plane: (DVec3, DVec3)| votes.iter().filter(|v| v.lies_on(plane)).map(|v| v.length_px).sum::<f64>();
    let mut best: Option<((DVec3, DVec3), f64)> = None;
    for candidate in spread(&votes, CANDIDATES) {
        let plane = (candidate.normal, candidate.position);
        let value = length(plane);
        if best.is_none_or(|b| value > b.1) {
            best = Some((plane, value));
        }
    }
    let (mut plane, mut value) = best.ok_or(Inapplicable::NoEdges)?;
    for _ in 0..ROUNDS {
        let Some(next) = refitted(&votes, plane) else { break };
        let held = length(next);
        if held < value {
            break;
        }
        (plane, value) = (next, held);
    }
    let (n, point) = plane;
    Ok((n, -n.dot(point)))
}

/// At most `count` of a slice, evenly spread.
fn spread<T>(all: &[T], count: usize) -> impl Iterator<Item = &T> {
    let taken = all.len().min(count);
    (0..taken).map(move |k| &all[k * all.len() / taken])
}

fn vote(inputs: &Inputs, edge: &EdgePoint) -> Option<Vote> {
    let normal = edge.derivatives[0].cross(edge.derivatives[1]).try_normalize()?;
    let reach = (edge.position - inputs.camera.position).length();
    (reach > 0.0).then_some(Vote { position: edge.position, normal, length_px: edge.length_px, reach })
}

impl Vote {
    fn lies_on(&self, (n, point): (DVec3, DVec3)) -> bool {
        n.dot(self.position - point).abs() <= ON_PLANE * self.reach && n.dot(self.normal).abs() >= SAME_NORMAL
    }
}

/// Least squares of the angles off the plane, over the votes on it; `None` where they span none.
fn refitted(votes: &[Vote], plane: (DVec3, DVec3)) -> Option<(DVec3, DVec3)> {
    /// Spread across, relative to along, below which points are collinear.
    const COLLINEAR: f64 = 1e-6;
    let on = || votes.iter().filter(|v| v.lies_on(plane)).map(|v| (v, v.length_px / (v.reach * v.reach)));
    let weight: f64 = on().map(|(_, k)| k).sum();
    let mean = plane.1 + on().fold(DVec3::ZERO, |s, (v, k)| s + (v.position - plane.1) * k) / weight;
    let mut sum = Matrix3::<f64>::zeros();
    for (v, k) in on() {
        let r = nalgebra::Vector3::from((v.position - mean).to_array());
        sum += r * r.transpose() * k;
    }
    let eigen = SymmetricEigen::try_new(sum, f64::EPSILON, 0)?;
    let mut order = [0, 1, 2];
    order.sort_by(|a, b| eigen.eigenvalues[*a].total_cmp(&eigen.eigenvalues[*b]));
    let value = |k: usize| eigen.eigenvalues[order[k]];
    let spans = value(1) > COLLINEAR * value(2);
    if !spans {
        return None;
    }
    let axis = eigen.eigenvectors.column(order[0]);
    let n = DVec3::new(axis[0], axis[1], axis[2]).try_normalize()?;
    Some((if n.dot(plane.0) < 0.0 { -n } else { n }, mean))
}
