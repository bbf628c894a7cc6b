//! Light planes: every light becomes a projective plane, every scene point a homogeneous vector q of it (math note §1).
//!
//! ```text
//! point, spot:   q = R (X - L)  = R (X - C) + R (C - L)
//! directional:   q = (r1·(X - C), r2·(X - C), 1)
//! ```
//!
//! R is orthonormal with rows r1, r2, r3; C is a scene point amid what is covered. Writing X - C keeps the digits of X
//! when the light is 10¹² scene sizes away. With r3 towards C, a point light far away and a directional light give the
//! same plane up to the scale of q.

use super::RigidMotion;
use crate::scene::{Light, LightKind};
use glam::{DMat3, DMat4, DVec3, DVec4};
use serde::{Deserialize, Serialize};

/// The plane of one light, for one set of covered points.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
pub struct LightSpace {
    /// Rows r1, r2, r3 of R: right, up, forward.
    pub axes: [DVec3; 3],
    /// C, scene space.
    pub center: DVec3,
    /// R (C - L); (0, 0, 1) and unused rows for a directional light.
    pub offset: DVec3,
    /// Parallel light.
    pub directional: bool,
}

/// Why a light has no single plane for a set of points.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LightSpaceError {
    /// Nothing to cover.
    #[error("no covered point")]
    Empty,
    /// The points seen from the light fit no cone of the allowed half angle.
    #[error("the covered points seen from the light do not fit one half-space")]
    NoHalfSpace,
}

/// Widest half angle of the cone of covered directions that one plane may carry. tan 80° = 5.7: past it a perspective
/// plane spends most of its area on the rim, and splitting by cube faces is cheaper.
const CONE_MAX_RAD: f64 = 80.0 * std::f64::consts::PI / 180.0;

impl LightSpace {
    /// The plane of a light for covered scene points. For point and spot lights r3 is the axis of the smallest cone
    /// around the directions to the points.
    pub fn around(light: &Light, points: &[DVec3]) -> Result<LightSpace, LightSpaceError> {
        if points.is_empty() {
            return Err(LightSpaceError::Empty);
        }
        let center = points.iter().fold(DVec3::ZERO, |s, p| s + (*p - points[0])) / points.len() as f64 + points[0];
        match light.kind {
            LightKind::Directional { direction } => {
                Ok(LightSpace { axes: frame_around(direction), center, offset: DVec3::Z, directional: true })
            }
            LightKind::Point { position, .. } | LightKind::Spot { position, .. } => {
                let directions: Vec<DVec3> = points.iter().map(|p| (*p - position).normalize_or_zero()).collect();
                let (axis, half_angle) = smallest_cone(&directions);
                if axis == DVec3::ZERO || half_angle > CONE_MAX_RAD {
                    return Err(LightSpaceError::NoHalfSpace);
                }
                Ok(LightSpace::perspective(position, axis, center))
            }
        }
    }

    /// The plane of a point light with a given axis (unit).
    pub fn perspective(position: DVec3, axis: DVec3, center: DVec3) -> LightSpace {
        let axes = frame_around(axis);
        let v = center - position;
        LightSpace {
            axes,
            center,
            offset: DVec3::new(axes[0].dot(v), axes[1].dot(v), axes[2].dot(v)),
            directional: false,
        }
    }

    /// The plane in which X has the q that `motion` X has in this one.
    pub fn carried(&self, motion: &RigidMotion) -> LightSpace {
        let axes = self.axes.map(|a| motion.inverse_vector(a));
        LightSpace { axes, center: motion.inverse_point(self.center), ..*self }
    }

    /// The homogeneous vector of a scene point. `q.z > 0` in front of the light.
    pub fn q(&self, point: DVec3) -> DVec3 {
        let v = point - self.center;
        if self.directional {
            DVec3::new(self.axes[0].dot(v), self.axes[1].dot(v), 1.0)
        } else {
            DVec3::new(self.axes[0].dot(v), self.axes[1].dot(v), self.axes[2].dot(v)) + self.offset
        }
    }

    /// Derivative of q along a scene vector.
    pub fn dq(&self, vector: DVec3) -> DVec3 {
        let z = if self.directional { 0.0 } else { self.axes[2].dot(vector) };
        DVec3::new(self.axes[0].dot(vector), self.axes[1].dot(vector), z)
    }

    /// Depth along the light relative to C, metres: r3·(X - C).
    pub fn along(&self, point: DVec3) -> f64 {
        self.axes[2].dot(point - self.center)
    }

    /// Depth along the light of C itself, metres: from the origin of the scene for a directional light, which has no place.
    pub fn center_along(&self) -> f64 {
        if self.directional { self.axes[2].dot(self.center) } else { 0.0 }
    }

    /// A row acting on q as a row acting on (X, 1).
    pub fn row_from_q(&self, row: DVec3) -> DVec4 {
        let [r1, r2, r3] = self.axes;
        let linear = if self.directional { r1 * row.x + r2 * row.y } else { r1 * row.x + r2 * row.y + r3 * row.z };
        let constant = if self.directional { row.z } else { row.dot(self.offset) };
        linear.extend(constant - linear.dot(self.center))
    }

    /// Rows of q on (X, 1).
    pub fn plane_from_scene(&self) -> [DVec4; 3] {
        [DVec3::X, DVec3::Y, DVec3::Z].map(|row| self.row_from_q(row))
    }

    /// The row of [`LightSpace::along`].
    pub fn along_row(&self) -> DVec4 {
        self.axes[2].extend(-self.axes[2].dot(self.center))
    }

    /// The 4x4 light matrix with rows 1, 2, 4 from a homography on q, and a given row 3 on (X, 1).
    pub fn clip_from_scene(&self, h: &DMat3, depth_row: DVec4) -> DMat4 {
        let rows = h.transpose();
        DMat4::from_cols(
            self.row_from_q(rows.x_axis),
            self.row_from_q(rows.y_axis),
            depth_row,
            self.row_from_q(rows.z_axis),
        )
        .transpose()
    }
}

/// Orthonormal rows right, up, forward with forward = `axis` (unit), as a camera's: r1 × r2 = -r3. With them a homography
/// of positive determinant draws a map that is not mirrored. Continuous in the axis except where it crosses y = 0.
fn frame_around(axis: DVec3) -> [DVec3; 3] {
    // Duff et al. 2017, "Building an orthonormal basis, revisited", with y in the place of z.
    let sign = 1.0_f64.copysign(axis.y);
    let a = -1.0 / (sign + axis.y);
    let b = axis.x * axis.z * a;
    let r1 = DVec3::new(1.0 + sign * axis.x * axis.x * a, -sign * axis.x, sign * b).normalize();
    let r2 = r1.cross(axis);
    [r1, r2, axis]
}

/// Axis and half angle of a nearly smallest cone around unit directions: Bădoiu and Clarkson's core-set iteration on
/// the sphere. Zero directions (a point on the light) are ignored; axis zero when nothing is left.
fn smallest_cone(directions: &[DVec3]) -> (DVec3, f64) {
    const STEPS: u32 = 64; // the radius errs by about 1/steps of itself; the cone only steers numerics
    let mut axis = directions.iter().fold(DVec3::ZERO, |s, d| s + *d).normalize_or_zero();
    if axis == DVec3::ZERO {
        axis = directions.iter().copied().find(|d| *d != DVec3::ZERO).unwrap_or(DVec3::ZERO);
    }
    let farthest = |axis: DVec3| {
        directions.iter().fold((axis, 1.0_f64), |far, d| {
            let cosine = d.dot(axis);
            if cosine < far.1 && *d != DVec3::ZERO { (*d, cosine) } else { far }
        })
    };
    let (mut far, cosine) = farthest(axis);
    let mut best = (axis, cosine);
    for k in 1..=STEPS {
        axis = (axis + (far - axis) / f64::from(k + 1)).normalize_or_zero();
        if axis == DVec3::ZERO {
            break;
        }
        let cosine;
        (far, cosine) = farthest(axis);
        if cosine > best.1 {
            best = (axis, cosine);
        }
    }
    (best.0, best.1.clamp(-1.0, 1.0).acos())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cloud() -> Vec<DVec3> {
        (0..40).map(|i| DVec3::new((i as f64).sin() * 3.0, (i as f64 * 0.7).cos(), (i % 7) as f64)).collect()
    }

    #[test]
    fn frame_is_orthonormal_everywhere() {
        for axis in [DVec3::Y, DVec3::NEG_Y, DVec3::X, DVec3::new(1.0, -2.0, 0.3), DVec3::new(1e-9, -1.0, 1e-9)] {
            let [a, b, c] = frame_around(axis.normalize());
            assert!((a.dot(b)).abs() < 1e-15 && a.dot(c).abs() < 1e-15 && b.dot(c).abs() < 1e-15);
            assert!((a.cross(b).dot(c) + 1.0).abs() < 1e-15);
        }
    }

    #[test]
    fn matrix_agrees_with_q() {
        let points = cloud();
        for kind in [
            LightKind::Directional { direction: DVec3::new(0.3, -1.0, 0.2).normalize() },
            LightKind::Point { position: DVec3::new(1.0, 20.0, 3.0), range: None },
        ] {
            let light = Light { name: "l".into(), kind };
            let space = LightSpace::around(&light, &points).unwrap();
            let h = DMat3::from_cols_array(&[1.0, 0.2, 0.01, -0.3, 2.0, 0.02, 0.5, 0.6, 1.0]);
            let m = space.clip_from_scene(&h, space.along_row());
            for p in &points {
                let (clip, q) = (m * p.extend(1.0), h * space.q(*p));
                assert!((clip.x - q.x).abs() + (clip.y - q.y).abs() + (clip.w - q.z).abs() < 1e-12);
                assert!((clip.z - space.along(*p)).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn far_point_light_is_a_directional_one() {
        let points = cloud();
        let direction = DVec3::new(0.3, -1.0, 0.2).normalize();
        let point = Light { name: "p".into(), kind: LightKind::Point { position: direction * -1e12, range: None } };
        let space = LightSpace::around(&point, &points).unwrap();
        // The axis may stand anywhere in the tiny cone, so the planes differ by a shift: compare differences.
        let flat = |p: DVec3| {
            let q = space.q(p);
            q.truncate() / q.z * 1e12
        };
        for p in &points {
            let v = *p - points[0];
            let expected = glam::DVec2::new(space.axes[0].dot(v), space.axes[1].dot(v));
            let error = (flat(*p) - flat(points[0]) - expected).length();
            assert!(error < 1e-3, "{error}"); // a few times 1e12 * 2^-53
        }
    }

    #[test]
    fn bulb_among_points_has_no_half_space() {
        let light = Light { name: "l".into(), kind: LightKind::Point { position: DVec3::ZERO, range: None } };
        let around = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y];
        assert_eq!(LightSpace::around(&light, &around), Err(LightSpaceError::NoHalfSpace));
        assert_eq!(LightSpace::around(&light, &[]), Err(LightSpaceError::Empty));
    }
}
