//! Scene-optimised shadow mapping: Algorithm 1 of Chong and Gortler, TR-07-07, to the letter.
//!
//! Three iterations; each turns p4 in the plane of the negative gradient of h (eq. 6, 9) by the nine angles of §2.4 and
//! takes the best of them, with the minimum-area rectangle around the projected hull as the affine part. The skew
//! adjustment, of which §2.3 says that it "can be ignored without much ill effect", is left out; step 5 (hysteresis)
//! belongs to shots. Deviations, both where the paper is silent: light space of a directional light is its plane scaled
//! so that the cover fits the unit disc about 0, and the search starts from the map without a warp.

use super::lixel::plane_of;
use super::region::{Region, Report, texel_rows};
use super::{Inapplicable, Inputs};
use crate::fit::{Aspect, Shape, unit_square_rows};
use crate::metric::{Metric, Moments, moments_of};
use glam::{DQuat, DVec2, DVec3};

/// "-10, 3, 5, 9, 16, 23, 30, 40, and 50 degree rotations" (§2.4).
const ANGLES_DEGREES: [f64; 9] = [-10.0, 3.0, 5.0, 9.0, 16.0, 23.0, 30.0, 40.0, 50.0];
/// "three iterations of gradient descent were sufficient" (§2.4).
const ITERATIONS: u32 = 3;

#[derive(Clone, Copy)]
struct Candidate {
    /// Unit-square rows.
    rows: [DVec3; 3],
    aspect: f64,
    value: f64,
}

/// Solves one region.
pub(super) fn solve(inputs: &Inputs, axis: Option<DVec3>) -> Result<Region, Inapplicable> {
    let plane = plane_of(inputs, axis, true)?;
    let moments = moments_of(&plane.samples, Metric::L2);
    let mut evaluations = 1;
    let mut best = candidate(inputs, &plane.hull, &moments, DVec3::Z).ok_or(Inapplicable::NoFiniteFit)?;
    let warp = inputs.shape == Shape::Projective || !plane.space.directional;
    for _ in 0..if warp && !plane.samples.is_empty() { ITERATIONS } else { 0 } {
        let p4 = best.rows[2].normalize();
        let gradient = moments.gradient(&texel_rows(&best.rows, best.aspect, inputs.texels))[2];
        let Some(turn) = p4.cross(-gradient).try_normalize() else { break };
        let from = best;
        for degrees in ANGLES_DEGREES {
            let p4 = DQuat::from_axis_angle(turn, degrees.to_radians()) * from.rows[2];
            evaluations += 1;
            if let Some(found) = candidate(inputs, &plane.hull, &moments, p4.normalize())
                && found.value < best.value
            {
                best = found;
            }
        }
    }
    let report = Report { rounds: ITERATIONS, ..Report::direct(&plane, evaluations) };
    Ok(Region::new(plane, best.rows, best.aspect, report))
}

/// The minimum-area rectangle of a p4 and its h; `None` when the hull reaches behind p4.
fn candidate(inputs: &Inputs, hull: &[DVec2], moments: &Moments, p4: DVec3) -> Option<Candidate> {
    let e1 = p4.any_orthonormal_vector();
    let base = [e1, p4.cross(e1), p4];
    let (rows, width, height) = minimum_area_rectangle(hull, &base)?;
    let (rows, aspect) = oriented(rows, width, height, inputs.aspect);
    let value = moments.value(&texel_rows(&rows, aspect, inputs.texels));
    value.is_finite().then_some(Candidate { rows, aspect, value })
}

/// Unit-square rows of the minimum-area rectangle around the hull as seen through base rows, and its two sides.
/// "An edge of the rectangle lines up with an edge of the hull" (Freeman and Shapira 1975).
pub(super) fn minimum_area_rectangle(hull: &[DVec2], base: &[DVec3; 3]) -> Option<([DVec3; 3], f64, f64)> {
    let mut points = Vec::with_capacity(hull.len());
    for v in hull {
        let q = v.extend(1.0);
        let w = base[2].dot(q);
        if w <= 0.0 {
            return None;
        }
        points.push(DVec2::new(base[0].dot(q), base[1].dot(q)) / w);
    }
    let extent = |n: DVec2| {
        let (lo, hi) =
            points.iter().map(|p| n.dot(*p)).fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), d| (l.min(d), h.max(d)));
        hi - lo
    };
    let mut best: Option<(f64, f64, f64, f64)> = None;
    for i in 0..points.len() {
        let Some(along) = (points[(i + 1) % points.len()] - points[i]).try_normalize() else { continue };
        let (width, height) = (extent(along), extent(along.perp()));
        if best.is_none_or(|b| width * height < b.0) {
            best = Some((width * height, along.to_angle(), width, height));
        }
    }
    let (_, angle, width, height) = best?;
    let rows = unit_square_rows(hull, base, [angle, angle + std::f64::consts::FRAC_PI_2])?;
    Some((rows, width, height))
}

/// "We make sure to map the longer side of the min-area rectangle to the dimension of the shadow map with more samples."
/// A free aspect is the rectangle's own.
pub(super) fn oriented(rows: [DVec3; 3], width: f64, height: f64, aspect: Aspect) -> ([DVec3; 3], f64) {
    match aspect {
        Aspect::Free => (rows, width / height),
        Aspect::Fixed(ratio) if (ratio >= 1.0) == (width >= height) => (rows, ratio),
        // u ← v, v ← 1 - u: a quarter turn, det stays positive.
        Aspect::Fixed(ratio) => ([rows[1], rows[2] - rows[0], rows[2]], ratio),
    }
}
