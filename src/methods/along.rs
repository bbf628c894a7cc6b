//! A perspective along one direction of the light plane: the form that LiSPSM and TSM share (Mikkelsen §3, matrix N_t).
//!
//! ```text
//! t = d·v - top        distance from the top of the hull, along the unit direction d
//! p1 = c·v - centre,   p2 = t,   p4 = 1 + s t,      c ⟂ d
//! ```
//!
//! w is 1 at the top. The centre of projection stands 1/s above it on the line c·v = centre; s = 0 is a map without a
//! warp, s < 0 a centre below the hull. The trapezoid between top, base and the two tangents from that centre then
//! fills the unit square: writing p2 = t, not 1/s, keeps this continuous through s = 0.

use super::body::{Body, Rectangle, refit};
use super::{Inapplicable, Inputs, Region};
use glam::{DVec2, DVec3};

/// A warp in normalised coordinates of a light plane.
pub(super) struct Warp {
    /// d, unit.
    pub(super) along: DVec2,
    /// c·v of the centre line.
    pub(super) centre: f64,
    /// Smallest d·v, where w = 1.
    pub(super) top: f64,
    /// s.
    pub(super) strength: f64,
}

impl Warp {
    /// Rows p1, p2, p4, det > 0.
    pub(super) fn rows(&self) -> [DVec3; 3] {
        let t = self.along.extend(-self.top);
        [across(self.along).extend(-self.centre), t, t * self.strength + DVec3::Z]
    }
}

/// c for d: to its right, so that a map with d upwards is not mirrored.
pub(super) fn across(along: DVec2) -> DVec2 {
    -along.perp()
}

/// Smallest and largest d·v.
pub(super) fn extent(points: impl Iterator<Item = DVec2>, along: DVec2) -> (f64, f64) {
    points.map(|p| along.dot(p)).fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), d| (lo.min(d), hi.max(d)))
}

/// The region of a warp.
pub(super) fn region(inputs: &Inputs, body: Body, warp: &Warp) -> Result<Region, Inapplicable> {
    let rows = warp.rows();
    if !rows.iter().all(|r| r.is_finite()) {
        return Err(Inapplicable::NoFiniteFit);
    }
    refit(inputs, body.plane, &rows, Rectangle::Axes)
}
