//! Homographies as 3x3 matrices, and matrices as rows for files.

use glam::{DMat3, DMat4, DVec2, DVec3, DVec4};

/// A 4x4 matrix as four rows of four, the form of the plan file.
pub type Rows4 = [[f64; 4]; 4];

/// The rows of a matrix.
pub fn rows_of(m: &DMat4) -> Rows4 {
    std::array::from_fn(|i| m.row(i).to_array())
}

/// The matrix with these rows.
pub fn matrix_from_rows(rows: &Rows4) -> DMat4 {
    let [a, b, c, d] = rows.map(DVec4::from_array);
    DMat4::from_cols(a, b, c, d).transpose()
}

/// A homography applied to a homogeneous point of the plane: (x, y) and w. The division is not guarded: ask w first.
pub fn apply(h: &DMat3, q: DVec3) -> (DVec2, f64) {
    let p = *h * q;
    (DVec2::new(p.x / p.z, p.y / p.z), p.z)
}

/// Determinant of the matrix with rows a, b, c, with each 2x2 minor as a compensated difference of products
/// (Kahan; pbrt `DifferenceOfProducts`).
pub fn det3(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    let minor = |p: f64, q: f64, r: f64, s: f64| {
        let rs = r * s;
        p.mul_add(q, -rs) + (-r).mul_add(s, rs)
    };
    a.x * minor(b.y, c.z, b.z, c.y) + a.y * minor(b.z, c.x, b.x, c.z) + a.z * minor(b.x, c.y, b.y, c.x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_round_trip() {
        let m = DMat4::from_cols_array(&std::array::from_fn(|i| i as f64 * 1.1));
        assert_eq!(matrix_from_rows(&rows_of(&m)), m);
        assert_eq!(rows_of(&m)[0][1], m.col(1).x);
    }

    #[test]
    fn determinant_matches_glam() {
        let (a, b, c) = (DVec3::new(1.0, 2.0, 3.0), DVec3::new(-4.0, 5.5, 6.0), DVec3::new(7.0, 8.0, -9.0));
        let m = DMat3::from_cols(a, b, c);
        assert!((det3(a, b, c) - m.determinant()).abs() < 1e-12);
    }
}
