//! The covered points and edges of one region, in its light plane: what every method starts from.

use super::Inputs;
use super::in_plane::edge_samples;
use crate::fit::{Normalisation, Shape, normalise, normalise_similar};
use crate::math::{LightSpace, convex_hull, without_flat};
use crate::metric::EdgeSamples;
use crate::samples::EdgePoint;
use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};

/// Vertices of a cover that stand out by less, in normalised coordinates of extent 1, are left out: f32 vertices round by
/// as much. A part of the border that is left free inside a map, under warps too.
const FLAT: f64 = 1e-6;

/// A region in its light plane.
#[derive(Debug, Deserialize, Serialize)]
pub(super) struct Plane {
    pub(super) space: LightSpace,
    /// Normalised hull of what is covered; at least 3 vertices.
    pub(super) hull: Vec<DVec2>,
    pub(super) normalisation: Normalisation,
    pub(super) samples: EdgeSamples,
    pub(super) grazing: u64,
    /// What the job allows.
    pub(super) shape: Shape,
}

impl Plane {
    /// `None` when nothing covered lies in front of the light, or not even a pixel's footprint gives it an extent.
    /// `similar` keeps the angles of the light plane.
    pub(super) fn new(
        inputs: &Inputs,
        space: LightSpace,
        covered: &[DVec3],
        edges: &[EdgePoint],
        similar: bool,
    ) -> Option<Plane> {
        let flat: Vec<DVec2> =
            covered.iter().map(|p| space.q(*p)).filter(|q| q.z > 0.0).map(|q| q.truncate() / q.z).collect();
        let mut hull = convex_hull(&flat);
        let pad = padding(inputs, &space, covered);
        if narrow(&hull, pad) {
            let corners = [DVec2::new(pad, pad), DVec2::new(-pad, pad), DVec2::new(pad, -pad), DVec2::new(-pad, -pad)];
            hull = convex_hull(&hull.iter().flat_map(|p| corners.map(|c| *p + c)).collect::<Vec<_>>());
        }
        if hull.len() < 3 {
            return None;
        }
        let normalisation = if similar { normalise_similar(&hull)? } else { normalise(&hull)? };
        let normal: Vec<DVec2> = hull.iter().map(|p| normalisation.point(*p)).collect();
        let hull = without_flat(&normal, FLAT);
        let (samples, grazing) = edge_samples(edges, inputs.sample_cap, &space, &normalisation);
        Some(Plane { space, hull, normalisation, samples, grazing, shape: inputs.shape })
    }

    /// Normalised units per unit of the plane q3 = 1, where the normalisation is a similarity.
    pub(super) fn scale(&self) -> f64 {
        self.normalisation.normal_from_plane.x_axis.x
    }
}

/// Half a pixel's footprint at the covered point nearest to the camera, in units of the plane q3 = 1: what a cover
/// without area is widened by.
fn padding(inputs: &Inputs, space: &LightSpace, covered: &[DVec3]) -> f64 {
    let [(_, by_x), _] = inputs.camera.ray_derivatives(inputs.film);
    let nearest = covered
        .iter()
        .map(|p| ((*p - inputs.camera.position).length(), space.q(*p).z))
        .filter(|(_, z)| *z > 0.0)
        .min_by(|a, b| a.0.total_cmp(&b.0));
    let [(origin_by_x, _), _] = inputs.camera.ray_derivatives(inputs.film);
    nearest.map_or(0.0, |(distance, z)| 0.5 * (by_x.length() * distance + origin_by_x.length()) / z)
}

/// True when a hull is thinner than `pad` in some direction.
fn narrow(hull: &[DVec2], pad: f64) -> bool {
    if hull.len() < 3 {
        return true;
    }
    let n = hull.len();
    (0..n).any(|i| {
        let edge = hull[(i + 1) % n] - hull[i];
        let across = edge.perp() / edge.length();
        hull.iter().map(|p| across.dot(*p - hull[i])).fold(0.0, f64::max) < pad
    })
}
