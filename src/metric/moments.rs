//! The sum over samples as 36 numbers (math note §3).
//!
//! ```text
//! h(H) = Σ_s k_s ‖·‖² = det(H)⁻² Σ_i M[p4, p4, q_i', q_i']
//! M[a,b,c,d] = Σ_s (k_s / V_s²) (q_s)_a (q_s)_b (C_s)_cd,     C_s = Σ_j c_j c_jᵀ
//! ```
//!
//! M is symmetric in ab and in cd: 6 x 6 sums. One pass over the samples builds it; afterwards a value costs the same
//! whatever their number. Moments in one light frame add, over tiles, threads and frames.

use super::pass::{BLOCK, Each, LANES};
use glam::{DMat3, DVec3};

/// Index pairs of a symmetric 3x3 matrix in the order xx, xy, xz, yy, yz, zz.
const PAIRS: [(usize, usize); 6] = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];

/// The 36 sums: rows are the pair ab of q qᵀ, columns the pair cd of C.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moments {
    sums: [[f64; 6]; 6],
}

impl Default for Moments {
    fn default() -> Self {
        Moments { sums: [[0.0; 6]; 6] }
    }
}

impl Moments {
    /// Adds one sample: its q, V, one vector c and weight k. Call once per c of the sample.
    pub fn add(&mut self, q: DVec3, volume: f64, c: DVec3, weight: f64) {
        self.add_scaled(q, c, weight / (volume * volume));
    }

    /// The same with k / V² in one.
    #[inline(always)]
    pub(super) fn add_scaled(&mut self, q: DVec3, c: DVec3, k: f64) {
        let cc = products(c);
        for (row, qq) in self.sums.iter_mut().zip(products(q)) {
            let f = k * qq;
            for (sum, c) in row.iter_mut().zip(cc) {
                *sum += f * c;
            }
        }
    }

    /// Adds another set of samples of the same light frame.
    pub fn merge(&mut self, other: &Moments) {
        for (row, o) in self.sums.iter_mut().zip(&other.sums) {
            for (sum, v) in row.iter_mut().zip(o) {
                *sum += v;
            }
        }
    }

    /// True when every sum is a number.
    pub fn is_finite(&self) -> bool {
        self.sums.iter().flatten().all(|v| v.is_finite())
    }

    /// The symmetric matrix S with S_cd = M[p4, p4, c, d].
    pub fn contract(&self, p4: DVec3) -> DMat3 {
        self.contract_samples(p4, p4)
    }

    /// The symmetric matrix with entries M[u, v, c, d], made symmetric in u and v.
    pub(super) fn contract_samples(&self, u: DVec3, v: DVec3) -> DMat3 {
        let mut s = [0.0; 6];
        for (&(a, b), row) in PAIRS.iter().zip(&self.sums) {
            let f = if a == b { u[a] * v[a] } else { u[a] * v[b] + u[b] * v[a] };
            for (s, m) in s.iter_mut().zip(row) {
                *s += f * m;
            }
        }
        symmetric(s)
    }

    /// The symmetric matrix with entries Σ_i M[a, b, q_i', q_i'].
    pub(super) fn contract_footprints(&self, [q1, q2]: [DVec3; 2]) -> DMat3 {
        let (f1, f2) = (products(q1), products(q2));
        symmetric(self.sums.map(|row| {
            (0..6).map(|k| row[k] * (f1[k] + f2[k]) * if PAIRS[k].0 == PAIRS[k].1 { 1.0 } else { 2.0 }).sum()
        }))
    }

    /// h of a homography with rows p1, p2, p4.
    pub fn value(&self, rows: &[DVec3; 3]) -> f64 {
        let [p1, p2, p4] = *rows;
        let s = self.contract(p4);
        let det = crate::math::det3(p1, p2, p4);
        let (q1, q2) = (p1.cross(p4), p2.cross(p4));
        (q1.dot(s * q1) + q2.dot(s * q2)) / (det * det)
    }

    /// Largest |Σ_b M[a,b,b,d]| over the sum of its terms' magnitudes. Exactly zero in real arithmetic, since c is
    /// perpendicular to q: a free measure of rounding.
    pub fn rounding(&self) -> f64 {
        let index = |a: usize, b: usize| {
            let (a, b) = (a.min(b), a.max(b));
            PAIRS.iter().position(|p| *p == (a, b)).unwrap_or(0)
        };
        let mut worst = 0.0_f64;
        for a in 0..3 {
            for d in 0..3 {
                let (mut sum, mut size) = (0.0, 0.0);
                for b in 0..3 {
                    let v = self.sums[index(a, b)][index(b, d)];
                    sum += v;
                    size += v.abs();
                }
                if size > 0.0 {
                    worst = worst.max(sum.abs() / size);
                }
            }
        }
        worst
    }
}

/// [`Moments`] of samples that come in blocks, in a few sums each.
#[derive(Default)]
pub(super) struct Sums([[[f64; LANES]; 6]; 6]);

impl Sums {
    /// Adds samples: q, one vector c and k / V² of each.
    #[inline(always)]
    pub(super) fn add(&mut self, q: &[Each; 3], c: &[Each; 3], k: &Each) {
        let mut cc = [[0.0; BLOCK]; 6];
        for (cc, (a, b)) in cc.iter_mut().zip(PAIRS) {
            *cc = product(&c[a], &c[b]);
        }
        for (row, (a, b)) in self.0.iter_mut().zip(PAIRS) {
            let f = product(k, &product(&q[a], &q[b]));
            for (sums, c) in row.iter_mut().zip(&cc) {
                let terms = product(&f, c);
                for i in 0..BLOCK {
                    sums[i % LANES] += terms[i];
                }
            }
        }
    }

    /// All of them.
    pub(super) fn total(&self) -> Moments {
        Moments { sums: self.0.map(|row| row.map(|sums| sums.iter().sum())) }
    }
}

#[inline(always)]
fn product(a: &Each, b: &Each) -> Each {
    let mut product = [0.0; BLOCK];
    for (i, p) in product.iter_mut().enumerate() {
        *p = a[i] * b[i];
    }
    product
}

fn symmetric([xx, xy, xz, yy, yz, zz]: [f64; 6]) -> DMat3 {
    DMat3::from_cols(DVec3::new(xx, xy, xz), DVec3::new(xy, yy, yz), DVec3::new(xz, yz, zz))
}

#[inline(always)]
fn products(v: DVec3) -> [f64; 6] {
    [v.x * v.x, v.x * v.y, v.x * v.z, v.y * v.y, v.y * v.z, v.z * v.z]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metric::{FilmEdge, TexelRows, inverse_jacobian_norm2};

    fn samples() -> crate::metric::EdgeSamples {
        let mut s = crate::metric::EdgeSamples::default();
        for i in 0..50 {
            let f = f64::from(i);
            let q = DVec3::new((f * 1.3).sin(), (f * 0.7).cos(), 1.0);
            let t = [
                DVec3::new(0.01 + 0.002 * f.sin(), 0.003, 0.001 * f.cos()),
                DVec3::new(-0.002, 0.02 + 0.004 * f.cos(), 0.0),
            ];
            let volume = crate::math::det3(q, t[0], t[1]);
            let edge = FilmEdge {
                normal: glam::DVec2::from_angle(f),
                length_px: 1.0 + 0.1 * f,
                room_px: 10.0,
                uncertain: false,
            };
            s.push(q, t, volume, &edge);
        }
        s
    }

    fn moments(s: &crate::metric::EdgeSamples) -> Moments {
        let mut m = Moments::default();
        for i in 0..s.len() {
            for c in s.footprint_vectors(i) {
                m.add(s.q[i], 1.0 / s.inverse_volume[i], c, s.length_px[i]);
            }
        }
        m
    }

    const ROWS: [DVec3; 3] = [DVec3::new(200.0, 20.0, 5.0), DVec3::new(-30.0, 180.0, 9.0), DVec3::new(0.2, -0.3, 1.0)];

    #[test]
    fn moments_equal_the_sum_of_equation_9() {
        let s = samples();
        let rows = TexelRows::new(&ROWS);
        let direct: f64 = (0..s.len()).map(|i| s.length_px[i] * inverse_jacobian_norm2(&s, i, &rows)).sum();
        let value = moments(&s).value(&ROWS);
        assert!((value / direct - 1.0).abs() < 1e-12, "{value} {direct}");
        assert!(moments(&s).rounding() < 1e-14);
    }

    #[test]
    fn moments_add() {
        let s = samples();
        let mut halves = [Moments::default(), Moments::default()];
        for i in 0..s.len() {
            halves[i % 2].add(s.q[i], 1.0 / s.inverse_volume[i], s.edge_vector[i], 1.0);
        }
        let mut whole = halves[0];
        whole.merge(&halves[1]);
        let sum = halves[0].value(&ROWS) + halves[1].value(&ROWS);
        assert!((whole.value(&ROWS) / sum - 1.0).abs() < 1e-12);
    }
}
