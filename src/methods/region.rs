//! What a method returns.

use super::in_plane::edge_samples;
use super::plane::Plane;
use crate::fit::{Shape, Termination};
use crate::math::{Domain, LightSpace, RigidMotion};
use crate::metric::{Metric, TexelRows, cost, inverse_jacobian_norm2, wrong_pixels};
use crate::samples::EdgePoint;
use glam::{DMat3, DVec2, DVec3};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// How a method came to its matrix.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
pub struct Report {
    /// Evaluations of the affine step.
    pub evaluations: u64,
    /// Edge samples used.
    pub samples: u64,
    /// Edge samples left out because the light grazes their surface.
    pub grazing: u64,
    /// Reweighting rounds done.
    pub rounds: u32,
    /// Relative spread of the objective over the last simplex.
    pub spread: f64,
    /// Relative distance above a dense search, where one was made.
    pub gap: Option<f64>,
    /// Why the search ended.
    pub termination: Termination,
}

impl Report {
    /// Of a matrix that was constructed, not searched for.
    pub(super) fn direct(plane: &Plane, evaluations: u64) -> Report {
        Report {
            evaluations,
            samples: plane.samples.len() as u64,
            grazing: plane.grazing,
            rounds: 0,
            spread: 0.0,
            gap: None,
            termination: Termination::Direct,
        }
    }
}

/// A homography of a light plane and the points that look it up.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct Region {
    /// Which points look this map up.
    pub domain: Domain,
    /// The light plane.
    pub space: LightSpace,
    /// Rows p1, p2, p4 on q; the covered points lie in the unit square with w > 0; det > 0.
    pub h: DMat3,
    /// Width over height in texels.
    pub aspect: f64,
    /// Share of the light's texels that the method gives this map, relative to its other maps'. `None` = by what its
    /// edges cost. All regions of a light have one or none has.
    pub share: Option<f64>,
    /// How it was found.
    pub report: Report,
    /// What it was fitted to.
    pub(super) plane: Arc<Plane>,
    /// The same homography on normalised q.
    pub(super) rows: [DVec3; 3],
}

/// What the edge samples say of a map of a given size.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Prediction {
    /// Expected misclassified pixels with a certain exact answer: saturating displacement times edge length.
    pub misclassified: f64,
    /// Further ones, whose exact answer is uncertain.
    pub uncertain: f64,
    /// The certain ones without saturation.
    pub unsaturated: f64,
}

impl Region {
    /// From rows on normalised q that take the covered hull to the unit square.
    pub(super) fn new(plane: Plane, rows: [DVec3; 3], aspect: f64, report: Report) -> Region {
        let h = homography(&plane, &rows);
        Region { domain: Domain::All, space: plane.space, h, aspect, share: None, report, plane: Arc::new(plane), rows }
    }

    /// Whether a scene point lies in front of the light and inside the map. The domain is not asked.
    pub fn contains(&self, point: DVec3) -> bool {
        let p = self.h * self.space.q(point);
        p.z > 0.0 && p.x >= 0.0 && p.x <= p.z && p.y >= 0.0 && p.y <= p.z
    }

    /// The same region with other rows on normalised q.
    pub(super) fn moved(&self, rows: [DVec3; 3], aspect: f64) -> Region {
        let h = homography(&self.plane, &rows);
        Region { h, rows, aspect, ..self.clone() }
    }

    /// The box of points in the map, in units of the map; `None` when one lies behind its vanishing line, or there is none.
    pub fn extent(&self, points: &[DVec3]) -> Option<[DVec2; 2]> {
        let mut found: Option<[DVec2; 2]> = None;
        for point in points {
            let p = self.h * self.space.q(*point);
            if p.z <= 0.0 {
                return None;
            }
            let at = p.truncate() / p.z;
            let [low, high] = found.unwrap_or([at, at]);
            found = Some([low.min(at), high.max(at)]);
        }
        found
    }

    /// The map of a box within this one, in units of the map.
    pub fn window(&self, low: DVec2, size: DVec2) -> Region {
        let [p1, p2, p4] = self.rows;
        self.moved([(p1 - p4 * low.x) / size.x, (p2 - p4 * low.y) / size.y, p4], self.aspect * size.x / size.y)
    }

    /// Scaled and shifted along its own axes to hold points, with `border` of the map's sides left free on each side. `None`
    /// when it cannot hold them.
    pub fn rescaled(&self, points: &[DVec3], border: f64) -> Option<Region> {
        let [low, high] = self.extent(points)?;
        let size = (high - low) / (1.0 - 2.0 * border);
        (size.min_element() > 0.0).then(|| self.window(low - size * border, size))
    }

    /// The same region, its predictions over other edges of the same light: those of another frame.
    pub fn over(&self, edges: &[EdgePoint], cap: usize) -> Region {
        let plane = &self.plane;
        let (samples, grazing) = edge_samples(edges, cap, &plane.space, &plane.normalisation);
        let (hull, normalisation) = (plane.hull.clone(), plane.normalisation);
        let plane = Plane { space: plane.space, hull, normalisation, samples, grazing, shape: plane.shape };
        Region { plane: Arc::new(plane), ..self.clone() }
    }

    /// The region of a light that was carried to another place, as seen from where it stands now: it answers for X as this
    /// one does for `here_from_there` X. `None` for a domain that does not move with its light.
    pub fn carried(&self, here_from_there: &RigidMotion) -> Option<Region> {
        let domain = self.domain.carried(here_from_there)?;
        Some(Region { domain, space: self.space.carried(here_from_there), ..self.clone() })
    }

    /// What the job allows of the map's matrix.
    pub fn shape(&self) -> Shape {
        self.plane.shape
    }

    /// Rows in texels for a map of a given size.
    fn texel_rows(&self, texels: f64) -> [DVec3; 3] {
        texel_rows(&self.rows, self.aspect, texels)
    }

    /// Expected wrong pixels of a map of `texels` texels at the region's aspect.
    pub fn predict(&self, texels: f64) -> Prediction {
        let rows = self.texel_rows(texels);
        let [misclassified, uncertain] = wrong_pixels(&self.plane.samples, true, &rows);
        let [unsaturated, _] = wrong_pixels(&self.plane.samples, false, &rows);
        Prediction { misclassified, uncertain, unsaturated }
    }

    /// Expected wrong pixels that each of some edges accounts for in a map of `texels` texels.
    pub(super) fn costs_at(&self, edges: &[EdgePoint], texels: f64) -> Vec<f64> {
        let rows = self.texel_rows(texels);
        edges
            .iter()
            .map(|edge| {
                let (samples, _) = edge_samples(&[*edge], 1, &self.space, &self.plane.normalisation);
                cost(&samples, Metric::Saturating, &rows)
            })
            .collect()
    }

    /// Largest edge displacement, pixels, of each sample with its edge length, for a map of `texels` texels.
    pub fn displacements(&self, texels: f64) -> Vec<(f64, f64)> {
        let rows = TexelRows::new(&self.texel_rows(texels));
        (0..self.plane.samples.len())
            .map(|i| (rows.displacement(&self.plane.samples, i).largest(), self.plane.samples.length_px[i]))
            .collect()
    }

    /// Root of SOSM's summand, pixels per texel, of each sample with its edge length, for a map of `texels` texels.
    pub fn footprints(&self, texels: f64) -> Vec<(f64, f64)> {
        let rows = TexelRows::new(&self.texel_rows(texels));
        (0..self.plane.samples.len())
            .map(|i| (inverse_jacobian_norm2(&self.plane.samples, i, &rows).sqrt(), self.plane.samples.length_px[i]))
            .collect()
    }
}

/// The homography on q of rows on normalised q. It has no scale of its own: p4 of unit length keeps w in metres along the
/// view axis.
fn homography(plane: &Plane, rows: &[DVec3; 3]) -> DMat3 {
    let h = plane.normalisation.plane_homography(&DMat3::from_cols(rows[0], rows[1], rows[2]).transpose());
    h * (1.0 / h.row(2).length())
}

/// Unit-square rows in texels for a budget and an aspect.
pub(super) fn texel_rows(rows: &[DVec3; 3], aspect: f64, texels: f64) -> [DVec3; 3] {
    [rows[0] * (texels * aspect).sqrt(), rows[1] * (texels / aspect).sqrt(), rows[2]]
}
