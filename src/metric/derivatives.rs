//! First and second derivatives of the moment form by the nine entries of the rows p1, p2, p4 (math note §3).
//!
//! ```text
//! h = N / D²,    N = Σ_i q_i'ᵀ S q_i',    q_i' = p_i × p4,    S = M[p4, p4, ·, ·],    D = p1·(p2 × p4)
//! ∇h  = ∇N / D² - 2 N ∇D / D³
//! ∇²h = ∇²N / D² - 2 (∇N ∇Dᵀ + ∇D ∇Nᵀ + N ∇²D) / D³ + 6 N ∇D ∇Dᵀ / D⁴
//! ```
//!
//! With [v] the matrix of v ×, s_i = S q_i', Q_ab = Σ_i M[a, b, q_i', q_i'] and K_i of the columns
//! 2 M[p4, e_k, ·, ·] q_i', the change of s_i with p4 at a fixed q_i':
//!
//! ```text
//! ∂N/∂p_i = 2 p4 × s_i                                  ∂N/∂p4 = 2 Σ_i s_i × p_i + 2 Q p4
//! N_ii = 2 [p4]ᵀ S [p4],    N_12 = 0,                   D_12 = -[p4],    D_14 = [p2],    D_24 = -[p1]
//! N_i4 = 2 (-[s_i] + [p4] S [p_i] + [p4] K_i)
//! N_44 = 2 Σ_i ([p_i]ᵀ S [p_i] + [p_i]ᵀ K_i + K_iᵀ [p_i]) + 2 Q
//! ```
//!
//! Both cost the same whatever the number of samples. The search needs neither: its objective over (a, b) has kinks
//! where the best pair of flush edges changes. A descent at a fixed affine part takes the gradient; the Hessian's
//! block of p4 tells how sharp such a minimum is.

use super::Moments;
use glam::{DMat3, DVec3};

/// What both derivatives are made of.
struct Parts {
    /// S.
    s: DMat3,
    /// s_1 and s_2.
    s_i: [DVec3; 2],
    /// q_1' and q_2'.
    q_i: [DVec3; 2],
    /// Q.
    q: DMat3,
    n: f64,
    gradient_n: [DVec3; 3],
    d: f64,
    gradient_d: [DVec3; 3],
}

impl Parts {
    fn new(moments: &Moments, &[p1, p2, p4]: &[DVec3; 3]) -> Parts {
        let s = moments.contract(p4);
        let q_i = [p1.cross(p4), p2.cross(p4)];
        let s_i = q_i.map(|q| s * q);
        let q = moments.contract_footprints(q_i);
        let by_p4 = (s_i[0].cross(p1) + s_i[1].cross(p2)) + q * p4;
        Parts {
            s,
            s_i,
            q_i,
            q,
            n: q_i[0].dot(s_i[0]) + q_i[1].dot(s_i[1]),
            gradient_n: [p4.cross(s_i[0]), p4.cross(s_i[1]), by_p4].map(|g| 2.0 * g),
            d: crate::math::det3(p1, p2, p4),
            gradient_d: [p2.cross(p4), p4.cross(p1), p1.cross(p2)],
        }
    }
}

impl Moments {
    /// Gradient of [`Moments::value`] by the rows p1, p2, p4. Not finite where they are singular.
    pub fn gradient(&self, rows: &[DVec3; 3]) -> [DVec3; 3] {
        let p = Parts::new(self, rows);
        let inverse2 = 1.0 / (p.d * p.d);
        let by_d = -2.0 * p.n * inverse2 / p.d;
        [0, 1, 2].map(|i| p.gradient_n[i] * inverse2 + p.gradient_d[i] * by_d)
    }

    /// Hessian of [`Moments::value`] in blocks: a step δ of the rows adds ½ Σ_ij δ_iᵀ `hessian[i][j]` δ_j to second
    /// order. `hessian[j][i]` is the transpose of `hessian[i][j]`. Not finite where the rows are singular.
    ///
    /// Never positive definite: h is constant along p_i + t p4.
    pub fn hessian(&self, rows: &[DVec3; 3]) -> [[DMat3; 3]; 3] {
        let p = Parts::new(self, rows);
        let second_n = self.second_n(rows, &p);
        let [c1, c2, c4] = rows.map(cross_matrix);
        let zero = DMat3::ZERO;
        let second_d = [[zero, -c4, c2], [c4, zero, -c1], [-c2, c1, zero]];
        let inverse2 = 1.0 / (p.d * p.d);
        let by_d = -2.0 * inverse2 / p.d;
        let by_d2 = 6.0 * p.n * inverse2 * inverse2;
        let block = |i: usize, j: usize| {
            let crossed = outer(p.gradient_n[i], p.gradient_d[j]) + outer(p.gradient_d[i], p.gradient_n[j]);
            second_n[i][j] * inverse2
                + (crossed + second_d[i][j] * p.n) * by_d
                + outer(p.gradient_d[i], p.gradient_d[j]) * by_d2
        };
        [0, 1, 2].map(|i| [0, 1, 2].map(|j| block(i, j)))
    }

    /// ∇²N in blocks.
    fn second_n(&self, rows: &[DVec3; 3], parts: &Parts) -> [[DMat3; 3]; 3] {
        let (s, p4) = (parts.s, cross_matrix(rows[2]));
        let by_entry = DMat3::IDENTITY.to_cols_array_2d().map(|e| self.contract_samples(rows[2], e.into()) * 2.0);
        let same = p4.transpose() * s * p4 * 2.0;
        let mut mixed = [DMat3::ZERO; 2];
        let mut last = parts.q * 2.0;
        for i in 0..2 {
            let row = cross_matrix(rows[i]);
            let [x, y, z] = by_entry.map(|m| m * parts.q_i[i]);
            let k = DMat3::from_cols(x, y, z);
            mixed[i] = (p4 * s * row + p4 * k - cross_matrix(parts.s_i[i])) * 2.0;
            let half = row.transpose() * k;
            last += (row.transpose() * s * row + half + half.transpose()) * 2.0;
        }
        let [m1, m2] = mixed;
        [[same, DMat3::ZERO, m1], [DMat3::ZERO, same, m2], [m1.transpose(), m2.transpose(), last]]
    }
}

/// [v]: [v] u = v × u.
fn cross_matrix(v: DVec3) -> DMat3 {
    DMat3::from_cols(DVec3::new(0.0, v.z, -v.y), DVec3::new(-v.z, 0.0, v.x), DVec3::new(v.y, -v.x, 0.0))
}

/// u vᵀ.
fn outer(u: DVec3, v: DVec3) -> DMat3 {
    DMat3::from_cols(u * v.x, u * v.y, u * v.z)
}
