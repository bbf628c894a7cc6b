//! Keyframed values over time: LINEAR, STEP and CUBICSPLINE as in glTF 2.0, appendix C ("Animation Sampler
//! Interpolation Modes").
//!
//! One type serves translations, scales, rotations and scalars: a value is a 4-vector, unused components zero.
//! Rotations are quaternions x, y, z, w; LINEAR runs along the shortest arc at constant angular speed (the spec's
//! slerp). Outside the keys the nearest key holds. Written so that a track with equal keys (and, for splines, zero
//! tangents) evaluates to exactly that value at all times: such nodes must come out as still.

use super::KeyInterpolation;
use glam::{DQuat, DVec3, DVec4};

/// How values run between keys.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Interpolation {
    /// Straight, or slerp for rotations.
    Linear,
    /// Holds until the next key.
    Step,
    /// Cubic Hermite spline; three values a key: in-tangent, value, out-tangent.
    CubicSpline,
}

/// Keys and their values.
#[derive(Clone, Debug)]
pub(super) struct Track {
    /// Seconds, not decreasing, not empty. At equal times the last key wins from that time on.
    pub times_s: Vec<f64>,
    /// One a key; three a key for splines.
    pub values: Vec<DVec4>,
    /// Between keys.
    pub interpolation: Interpolation,
    /// True when values are quaternions (unit ones, except for splines).
    pub rotation: bool,
}

impl Track {
    /// The same value at all times.
    pub(super) fn constant(value: DVec4) -> Self {
        Track { times_s: vec![0.0], values: vec![value], interpolation: Interpolation::Step, rotation: false }
    }

    /// All values, and their tangents, times a factor.
    pub(super) fn scale(&mut self, factor: f64) {
        self.values.iter_mut().for_each(|value| *value *= factor);
    }

    /// Value at a time. Rotations come out unnormalised from splines.
    pub(super) fn sample(&self, time_s: f64) -> DVec4 {
        let value = |key: usize| match self.interpolation {
            Interpolation::CubicSpline => self.values[3 * key + 1],
            _ => self.values[key],
        };
        let next = self.times_s.partition_point(|&t| t <= time_s);
        if next == 0 {
            return value(0);
        }
        let key = next - 1;
        if next == self.times_s.len() {
            return value(key);
        }
        let span_s = self.times_s[next] - self.times_s[key];
        let u = (time_s - self.times_s[key]) / span_s;
        let (a, b) = (value(key), value(next));
        match self.interpolation {
            Interpolation::Step => a,
            Interpolation::Linear if self.rotation => slerp(a, b, u),
            Interpolation::Linear => a + (b - a) * u,
            Interpolation::CubicSpline => {
                let (out_tangent, in_tangent) = (self.values[3 * key + 2], self.values[3 * next]);
                let (u2, u3) = (u * u, u * u * u);
                a + (b - a) * (3.0 * u2 - 2.0 * u3)
                    + (out_tangent * (u3 - 2.0 * u2 + u) + in_tangent * (u3 - u2)) * span_s
            }
        }
    }

    /// A linear track with its values running as a job says; smooth tangents are chords over the keys' own times (Catmull
    /// and Rom, *A class of local interpolating splines*, 1974).
    pub(super) fn running(mut self, how: KeyInterpolation) -> Track {
        match how {
            KeyInterpolation::Linear => {}
            KeyInterpolation::Constant => self.interpolation = Interpolation::Step,
            KeyInterpolation::CatmullRom => {
                // Of the two quaternions of a rotation the one nearer to the key before.
                for k in 1..if self.rotation { self.values.len() } else { 0 } {
                    if self.values[k].dot(self.values[k - 1]) < 0.0 {
                        self.values[k] = -self.values[k];
                    }
                }
                let Track { times_s, values, .. } = &self;
                let tangent = |k: usize| {
                    let (before, after) = (k.saturating_sub(1), (k + 1).min(values.len() - 1));
                    let span_s = times_s[after] - times_s[before];
                    if span_s > 0.0 { (values[after] - values[before]) / span_s } else { DVec4::ZERO }
                };
                self.values = (0..values.len()).flat_map(|k| [tangent(k), values[k], tangent(k)]).collect();
                self.interpolation = Interpolation::CubicSpline;
            }
        }
        self
    }

    /// As a 3-vector.
    pub(super) fn sample_vec3(&self, time_s: f64) -> DVec3 {
        self.sample(time_s).truncate()
    }
}

/// The unit quaternion along x, y, z, w; `None` for zero length or overflow.
pub(super) fn unit_quat(xyzw: DVec4) -> Option<DQuat> {
    let unit = xyzw.try_normalize()?;
    Some(DQuat::from_vec4(unit))
}

/// Shortest-arc spherical interpolation of unit quaternions. The angle comes from atan2 of difference and sum
/// (Kahan 2006, "How Futile are Mindless Assessments of Roundoff", §12), exact to rounding for all angles, so that no
/// threshold between slerp and lerp is needed: only equal ends are special.
fn slerp(a: DVec4, b: DVec4, u: f64) -> DVec4 {
    let b = if a.dot(b) < 0.0 { -b } else { b };
    let angle = 2.0 * (b - a).length().atan2((b + a).length());
    let s = angle.sin();
    if s == 0.0 {
        return a;
    }
    (a * ((1.0 - u) * angle).sin() + b * (u * angle).sin()) / s
}

#[cfg(test)]
mod tests {
    use super::*;

    fn track(values: Vec<DVec4>, interpolation: Interpolation, rotation: bool) -> Track {
        Track { times_s: vec![1.0, 3.0], values, interpolation, rotation }
    }

    #[test]
    fn linear_and_step_hold_outside_their_keys() {
        let (a, b) = (DVec4::ZERO, DVec4::new(2.0, 4.0, 6.0, 0.0));
        let linear = track(vec![a, b], Interpolation::Linear, false);
        let step = track(vec![a, b], Interpolation::Step, false);
        assert_eq!(linear.sample(-5.0), a);
        assert_eq!(linear.sample(1.5), b * 0.25);
        assert_eq!(linear.sample(9.0), b);
        assert_eq!(step.sample(2.999), a);
        assert_eq!(step.sample(3.0), b);
    }

    #[test]
    fn slerp_takes_the_short_way_at_constant_speed() {
        let a = DQuat::from_rotation_y(0.2);
        let b = DQuat::from_rotation_y(1.4);
        for sign in [1.0, -1.0] {
            let t = track(vec![a.into(), DVec4::from(b) * sign], Interpolation::Linear, true);
            let got = unit_quat(t.sample(1.5)).unwrap();
            assert!(got.angle_between(DQuat::from_rotation_y(0.5)) < 1e-7, "{got:?}");
        }
        let nearly = DQuat::from_rotation_y(0.2 + 1e-13);
        let t = track(vec![a.into(), nearly.into()], Interpolation::Linear, true);
        assert!((t.sample(2.0).length() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn cubic_spline_is_the_hermite_polynomial() {
        // The cubic x(t) = t³ on [1, 3]: slopes 3 and 27.
        let v = |x: f64| DVec4::new(x, 0.0, 0.0, 0.0);
        let t = track(vec![v(0.0), v(1.0), v(3.0), v(27.0), v(27.0), v(0.0)], Interpolation::CubicSpline, false);
        for time in [1.0, 1.3, 2.0, 2.9, 3.0] {
            assert!((t.sample(time).x - time * time * time).abs() < 1e-12);
        }
    }

    #[test]
    fn equal_keys_evaluate_to_exactly_their_value() {
        let q = DVec4::from(DQuat::from_rotation_x(0.3).normalize());
        let p = DVec4::new(0.1, -0.7, 1e9, 0.0);
        let z = DVec4::ZERO;
        for time in [1.0, 1.1, 1.7, 2.3, 2.9] {
            assert_eq!(track(vec![q, q], Interpolation::Linear, true).sample(time), q);
            assert_eq!(track(vec![p, p], Interpolation::Linear, false).sample(time), p);
            assert_eq!(track(vec![z, p, z, z, p, z], Interpolation::CubicSpline, false).sample(time), p);
        }
    }
}
