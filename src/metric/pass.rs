//! One pass over the samples: their cost, and the moments of the quadratic that touches it, a block of samples side by side.
//!
//! Compiled twice, for any machine and for AVX2 where the machine has it. Both are the same Rust, which never fuses a
//! product with a sum, so both give the same bytes. Against one sample after the other a pass takes a third of the time
//! (`benches/fit`).

use super::moments::Sums;
use super::weights::counted_px;
use super::{EdgeSamples, Moments, TexelRows};

/// Samples of a block: what a loop over them needs stays in the first-level cache.
pub(super) const BLOCK: usize = 16;
/// Sums that run side by side: two registers of two, or one of four.
pub(super) const LANES: usize = 4;

/// One number for each sample of a block.
pub(super) type Each = [f64; BLOCK];

/// Smallest displacement, pixels, that a weight k_s / k0_s of math note §5 distinguishes: nothing is gained below a
/// hundredth of a pixel.
const DISPLACEMENT_MIN_PX: f64 = 0.01;

/// Cost of rows, saturating or not, and the moments.
pub(super) fn pass(samples: &EdgeSamples, saturating: bool, rows: &TexelRows) -> (f64, Moments) {
    #[cfg(target_arch = "x86_64")]
    if is_x86_feature_detected!("avx2") {
        #[expect(unsafe_code, reason = "AVX2 was just detected, which is all that the callee asks for")]
        return unsafe { pass_avx2(samples, saturating, rows) };
    }
    pass_here(samples, saturating, rows)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn pass_avx2(samples: &EdgeSamples, saturating: bool, rows: &TexelRows) -> (f64, Moments) {
    pass_here(samples, saturating, rows)
}

#[inline(always)]
fn pass_here(samples: &EdgeSamples, saturating: bool, rows: &TexelRows) -> (f64, Moments) {
    let (mut cost, mut sums) = ([0.0; LANES], Sums::default());
    for first in (0..samples.len()).step_by(BLOCK) {
        let block = Block::new(samples, first);
        let (costs, weights) = block.weigh(saturating, rows);
        for (i, c) in costs.iter().enumerate() {
            cost[i % LANES] += c;
        }
        sums.add(&block.q, &block.edge_vector, &weights);
    }
    (cost.iter().sum(), sums.total())
}

/// Samples beside each other; where there are none, ones without length.
struct Block {
    q: [Each; 3],
    edge_vector: [Each; 3],
    inverse_volume: Each,
    length_px: Each,
    room_px: Each,
}

impl Block {
    #[inline(always)]
    fn new(samples: &EdgeSamples, first: usize) -> Block {
        let mut block = Block {
            q: [[0.0; BLOCK], [0.0; BLOCK], [1.0; BLOCK]],
            edge_vector: [[0.0; BLOCK]; 3],
            inverse_volume: [1.0; BLOCK],
            length_px: [0.0; BLOCK],
            room_px: [1.0; BLOCK],
        };
        for (i, s) in (first..samples.len().min(first + BLOCK)).enumerate() {
            let (q, c) = (samples.q[s], samples.edge_vector[s]);
            for k in 0..3 {
                (block.q[k][i], block.edge_vector[k][i]) = (q[k], c[k]);
            }
            block.inverse_volume[i] = samples.inverse_volume[s];
            block.length_px[i] = counted_px(samples, s);
            block.room_px[i] = samples.room_px[s];
        }
        block
    }

    /// Cost of each sample, and the weight k / V² of its square.
    #[inline(always)]
    fn weigh(&self, saturating: bool, rows: &TexelRows) -> (Each, Each) {
        let (mut costs, mut weights) = ([0.0; BLOCK], [0.0; BLOCK]);
        let ([q1, q2], p4) = (rows.cofactors, rows.p4);
        for i in 0..BLOCK {
            let scale = (dot(p4, &self.q, i) * self.inverse_volume[i]).abs();
            let a = dot(q1, &self.edge_vector, i).abs() * scale;
            let b = dot(q2, &self.edge_vector, i).abs() * scale;
            let (r_max, r_min) = if a > b { (a, b) } else { (b, a) };
            // `Displacement::expected` with one division.
            let expected = (3.0 * r_max * r_max + r_min * r_min) / (12.0 * r_max);
            let d = if r_max > 0.0 { expected } else { 0.0 };
            let at_least = if d > DISPLACEMENT_MIN_PX { d } else { DISPLACEMENT_MIN_PX };
            let room = self.room_px[i];
            // With s = 1 + d/room: cost d/s and weight 1/(d s²).
            let inverse = 1.0 / if saturating { at_least * (room + at_least) } else { at_least };
            let (cost, weight) = if saturating {
                (d * room / (room + d), at_least * (room * inverse) * (room * inverse))
            } else {
                (d, inverse)
            };
            // Too wide for a number: as wide as the room.
            let wide = saturating && r_max > 0.0 && !expected.is_finite();
            let (cost, weight) = if wide { (room, 0.0) } else { (cost, weight) };
            costs[i] = self.length_px[i] * cost;
            weights[i] = self.length_px[i] * weight * self.inverse_volume[i] * self.inverse_volume[i];
        }
        (costs, weights)
    }
}

// Functions, not closures, and no `map` of arrays: what is not inlined is compiled without AVX2.
#[inline(always)]
fn dot(a: glam::DVec3, b: &[Each; 3], i: usize) -> f64 {
    a.x * b[0][i] + a.y * b[1][i] + a.z * b[2][i]
}

#[cfg(test)]
mod tests {
    use super::super::{FilmEdge, cost};
    use super::*;
    use crate::metric::Metric;
    use glam::{DVec2, DVec3};

    fn samples(count: u32) -> EdgeSamples {
        let mut samples = EdgeSamples::default();
        for i in 0..count {
            let f = f64::from(i);
            let q = DVec3::new((f * 1.3).sin(), (f * 0.7).cos(), 1.0);
            let size = 10.0_f64.powi(-(i as i32 % 9));
            let t = [DVec3::new(size, 0.3 * size, 0.0), DVec3::new(-0.2 * size, size * (1.1 + f.cos()), 0.0)];
            let (normal, length_px) = (DVec2::from_angle(f), 1.0 + f);
            let edge = FilmEdge { normal, length_px, room_px: 0.1 + f % 30.0, uncertain: i % 7 == 0 };
            samples.push(q, t, crate::math::det3(q, t[0], t[1]), &edge);
        }
        samples
    }

    const ROWS: [DVec3; 3] = [DVec3::new(40.0, 2.0, 5.0), DVec3::new(-3.0, 30.0, 9.0), DVec3::new(0.2, -0.3, 1.0)];

    /// Displacements of a millionth of a pixel to a million, block borders, and as many numbers any machine can add.
    #[test]
    fn blocks_cost_as_one_by_one() {
        for count in [0, 1, 15, 16, 17, 333] {
            let samples = samples(count);
            for (metric, saturating) in [(Metric::Saturating, true), (Metric::Displacement, false)] {
                let rows = TexelRows::new(&ROWS);
                let (found, moments) = pass(&samples, saturating, &rows);
                let expected = cost(&samples, metric, &ROWS);
                assert!((found - expected).abs() <= 1e-12 * expected, "{count} {metric:?}: {found} {expected}");
                assert!(moments.is_finite());
                assert_eq!((found, moments), pass_here(&samples, saturating, &rows));
            }
        }
    }

    /// Where the map collapses an edge is wrong as far as there is room, and pulls at nothing.
    #[test]
    fn what_is_wider_than_a_number_costs_its_room() {
        let samples = samples(40);
        let rows = [ROWS[0] * 1e-154, ROWS[1] * 1e-154, ROWS[2]];
        let (found, moments) = pass(&samples, true, &TexelRows::new(&rows));
        let rooms: f64 = (0..40).map(|i| counted_px(&samples, i) * samples.room_px[i]).sum();
        assert!((found / rooms - 1.0).abs() < 1e-12, "{found} {rooms}");
        assert!(moments.is_finite());
    }
}
