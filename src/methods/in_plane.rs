//! Edge points brought to a light plane, a block of them side by side.
//!
//! Compiled twice, for any machine and for AVX2 where the machine has it. Both are the same Rust, which never fuses a product
//! with a sum, so both give the same bytes.

use crate::fit::Normalisation;
use crate::math::LightSpace;
use crate::metric::{EdgeSamples, FilmEdge, volume};
use crate::samples::EdgePoint;
use glam::{DMat3, DVec3};

/// Smallest |V| relative to |q| |T_1| |T_2|: a receiver nearer to edge-on is left out, and counted. At 1e-7 a texel is
/// spread over ten million pixels' worth of surface; f64 sums still hold its square.
const GRAZING: f64 = 1e-7;

/// Points of a block.
const BLOCK: usize = 16;

/// A vector of each point of a block, by component.
type Vectors = [[f64; BLOCK]; 3];

/// Edge points in the normalised coordinates of a light plane, and the number left out because the light grazes their
/// surface or they lie behind it. More points than `cap` are thinned evenly along the edges, with lengths scaled to keep
/// the sum.
pub(super) fn edge_samples(
    points: &[EdgePoint],
    cap: usize,
    space: &LightSpace,
    normalisation: &Normalisation,
) -> (EdgeSamples, u64) {
    #[cfg(target_arch = "x86_64")]
    if is_x86_feature_detected!("avx2") {
        #[expect(unsafe_code, reason = "AVX2 was just detected, which is all that the callee asks for")]
        return unsafe { samples_avx2(points, cap, space, normalisation) };
    }
    samples_here(points, cap, space, normalisation)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn samples_avx2(
    points: &[EdgePoint],
    cap: usize,
    space: &LightSpace,
    normalisation: &Normalisation,
) -> (EdgeSamples, u64) {
    samples_here(points, cap, space, normalisation)
}

#[inline(always)]
fn samples_here(
    points: &[EdgePoint],
    cap: usize,
    space: &LightSpace,
    normalisation: &Normalisation,
) -> (EdgeSamples, u64) {
    let count = if cap == 0 { points.len() } else { points.len().min(cap) };
    let scale = points.len() as f64 / count.max(1) as f64;
    let mut samples = EdgeSamples::with_capacity(count);
    let mut grazing = 0;
    // Light plane and normalisation in one matrix, about the plane's centre; its last row gives q3.
    let normal_from_scene =
        normalisation.normal_from_plane * DMat3::from_cols(space.dq(DVec3::X), space.dq(DVec3::Y), space.dq(DVec3::Z));
    let of_centre = normalisation.normal_from_plane * space.offset;
    for first in (0..count).step_by(BLOCK) {
        // Where there are none left, the last one again.
        let mut block = [&points[0]; BLOCK];
        for (i, point) in block.iter_mut().enumerate() {
            *point = &points[(first + i).min(count - 1) * points.len() / count];
        }
        let mut q: Vectors = [[0.0; BLOCK]; 3];
        let mut t: [Vectors; 2] = [[[0.0; BLOCK]; 3]; 2];
        for (i, point) in block.iter().enumerate() {
            let from_centre = point.position - space.center;
            for k in 0..3 {
                q[k][i] = from_centre[k];
                (t[0][k][i], t[1][k][i]) = (point.derivatives[0][k], point.derivatives[1][k]);
            }
        }
        place(&normal_from_scene, &mut q);
        for (row, of_centre) in q.iter_mut().zip(of_centre.to_array()) {
            row.iter_mut().for_each(|x| *x += of_centre);
        }
        let depth = q[2];
        let mut by_depth = [0.0; BLOCK];
        for i in 0..BLOCK {
            by_depth[i] = 1.0 / depth[i];
        }
        scale_by(&mut q, &by_depth);
        for t in &mut t {
            place(&normal_from_scene, t);
            scale_by(t, &by_depth);
        }
        let (q2, t2) = (length_squared(&q), [length_squared(&t[0]), length_squared(&t[1])]);
        let mut size = [0.0; BLOCK];
        for i in 0..BLOCK {
            size[i] = (q2[i] * t2[0][i] * t2[1][i]).sqrt();
        }
        for (i, point) in block.into_iter().enumerate().take(count - first) {
            let (q, t) = (vector(&q, i), [vector(&t[0], i), vector(&t[1], i)]);
            let volume = volume(q, t, size[i]);
            if !(q.is_finite() && volume.abs() > GRAZING * size[i]) || depth[i] <= 0.0 {
                grazing += 1;
                continue;
            }
            samples.push(q, t, volume, &FilmEdge { length_px: point.length_px * scale, ..point.into() });
        }
    }
    (samples, grazing)
}

// Functions that are inlined, not closures: those are compiled without AVX2.
#[inline(always)]
fn vector(v: &Vectors, i: usize) -> DVec3 {
    DVec3::new(v[0][i], v[1][i], v[2][i])
}

#[inline(always)]
fn place(matrix: &DMat3, v: &mut Vectors) {
    for i in 0..BLOCK {
        let [a, b, c] = [v[0][i], v[1][i], v[2][i]];
        for (k, row) in v.iter_mut().enumerate() {
            row[i] = matrix.x_axis[k] * a + matrix.y_axis[k] * b + matrix.z_axis[k] * c;
        }
    }
}

#[inline(always)]
fn scale_by(v: &mut Vectors, by: &[f64; BLOCK]) {
    for row in v {
        for i in 0..BLOCK {
            row[i] *= by[i];
        }
    }
}

#[inline(always)]
fn length_squared(v: &Vectors) -> [f64; BLOCK] {
    let mut out = [0.0; BLOCK];
    for i in 0..BLOCK {
        out[i] = v[0][i] * v[0][i] + v[1][i] * v[1][i] + v[2][i] * v[2][i];
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::normalise;
    use glam::DVec2;

    fn point(position: DVec3, derivatives: [DVec3; 2]) -> EdgePoint {
        let (film, normal) = ([1.0, 2.0], DVec2::from_angle(position.x));
        EdgePoint { film, position, derivatives, normal, length_px: 1.5, room_px: 4.0, uncertain: false }
    }

    /// Block borders, points behind the light and edge-on surfaces, under both kinds of light.
    #[test]
    fn blocks_are_what_the_light_plane_says_of_each_point() {
        let hull = [(-3.0, -1.0), (3.0, -2.0), (1.0, 2.0)].map(|(x, y)| DVec2::new(x, y));
        let normalisation = normalise(&hull).unwrap();
        let perspective = LightSpace::perspective(DVec3::new(0.0, 5.0, 0.0), DVec3::NEG_Y, DVec3::ZERO);
        for space in [perspective, LightSpace { offset: DVec3::Z, directional: true, ..perspective }] {
            for count in [0, 1, 15, 16, 17, 53] {
                let of = |i: usize| {
                    let f = i as f64;
                    let position = DVec3::new(f.sin(), if i % 5 == 4 { 6.0 } else { 0.1 * f.cos() }, (1.7 * f).cos());
                    let edge_on = if i % 7 == 6 { DVec3::ZERO } else { DVec3::new(0.0, 0.001, 0.02) };
                    point(position, [DVec3::new(0.01, 0.002, 0.0), edge_on])
                };
                let points: Vec<EdgePoint> = (0..count).map(of).collect();
                let kept: Vec<&EdgePoint> =
                    points.iter().filter(|p| space.q(p.position).z > 0.0 && p.derivatives[1] != DVec3::ZERO).collect();
                let (samples, grazing) = edge_samples(&points, 0, &space, &normalisation);
                assert_eq!((samples.len(), grazing as usize), (kept.len(), points.len() - kept.len()));
                for (i, p) in kept.iter().enumerate() {
                    let (q, t) = normalisation.vectors(space.q(p.position), p.derivatives.map(|d| space.dq(d)));
                    assert!((samples.q[i] - q).length() < 1e-14);
                    assert!((samples.t[i][0] - t[0]).length() + (samples.t[i][1] - t[1]).length() < 1e-16);
                    let volume = q.dot(t[0].cross(t[1]));
                    assert!((samples.inverse_volume[i] * volume - 1.0).abs() < 1e-9);
                    assert_eq!(samples.length_px[i], 1.5);
                }
                let all = samples_here(&points, 0, &space, &normalisation);
                assert_eq!((samples, grazing), all);
            }
            let points: Vec<EdgePoint> =
                (0..40).map(|i| point(DVec3::new(0.1 * f64::from(i), 0.0, 0.0), [DVec3::X, DVec3::Z])).collect();
            let (few, _) = edge_samples(&points, 10, &space, &normalisation);
            assert_eq!((few.len(), few.length_px.iter().sum::<f64>()), (10, 60.0));
        }
    }
}
