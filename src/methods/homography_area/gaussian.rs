//! Eq. 11: a known distribution in the place of the samples, "parameters approximated from sparse sampling".
//!
//! The paper takes surface points to be normally distributed and leaves open what gives their det J. Here the normal
//! distribution is that of (x, y, ln |V|): where a point stands in the light plane and how much of that plane its pixel
//! covers. The expectation is Gauss and Hermite's quadrature with five nodes along each principal axis. The model is
//! taken on the condition that the point is covered, since a normal distribution reaches past every vanishing line.

use super::areas::Areas;
use glam::{DVec2, DVec3};
use nalgebra::{Matrix3, SymmetricEigen, Vector3};

/// Nodes and weights of the standard normal distribution, exact up to degree 9 (Abramowitz and Stegun 25.4.46, scaled).
const NODES: [(f64, f64); 5] = [
    (-2.856_970_013_872_805_6, 0.011_257_411_327_720_69),
    (-1.355_626_179_974_265_8, 0.222_075_922_005_612_64),
    (0.0, 0.533_333_333_333_333_3),
    (1.355_626_179_974_265_8, 0.222_075_922_005_612_64),
    (2.856_970_013_872_805_6, 0.011_257_411_327_720_69),
];

/// The nodes of the fitted distribution inside the hull (counter-clockwise); `None` when there are none.
pub(super) fn model(samples: &Areas, hull: &[DVec2]) -> Option<Areas> {
    let features = || {
        let feature = |(q, v): (&DVec3, &f64)| Vector3::new(q.x, q.y, v.ln());
        samples.q.iter().zip(&samples.volume).map(feature).zip(&samples.weight)
    };
    let mean = features().fold(Vector3::zeros(), |s: Vector3<f64>, (f, k)| s + f * *k);
    let covariance =
        features().fold(Matrix3::zeros(), |s: Matrix3<f64>, (f, k)| s + (f - mean) * (f - mean).transpose() * *k);
    let eigen = SymmetricEigen::try_new(covariance, f64::EPSILON, 0)?;
    let axis = |k: usize| eigen.eigenvectors.column(k) * eigen.eigenvalues[k].max(0.0).sqrt();
    let axes = [axis(0), axis(1), axis(2)];
    let (mut q, mut volume, mut weight) = (Vec::new(), Vec::new(), Vec::new());
    for (a, ka) in NODES {
        for (b, kb) in NODES {
            for (c, kc) in NODES {
                let node = mean + axes[0] * a + axes[1] * b + axes[2] * c;
                if inside(hull, DVec2::new(node[0], node[1])) {
                    q.push(DVec3::new(node[0], node[1], 1.0));
                    volume.push(node[2].exp());
                    weight.push(ka * kb * kc);
                }
            }
        }
    }
    Areas::weighted(q, volume, weight)
}

fn inside(hull: &[DVec2], point: DVec2) -> bool {
    (0..hull.len()).all(|i| (hull[(i + 1) % hull.len()] - hull[i]).perp_dot(point - hull[i]) >= 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Quadrature gives back the moments it was fitted to.
    #[test]
    fn nodes_have_the_mean_and_variance_of_the_samples() {
        let q: Vec<DVec3> =
            (0..50).map(|k| DVec3::new((f64::from(k)).sin() * 0.2, f64::from(k) * 0.004, 1.0)).collect();
        let volume: Vec<f64> = (0..50).map(|k| 1e-4 * (1.0 + 0.01 * f64::from(k))).collect();
        let samples = Areas::weighted(q, volume, vec![1.0; 50]).unwrap();
        let wide = [(-9.0, -9.0), (9.0, -9.0), (9.0, 9.0), (-9.0, 9.0)].map(|(x, y)| DVec2::new(x, y));
        let model = model(&samples, &wide).unwrap();
        let moments = |a: &Areas| {
            let mean = a.q.iter().zip(&a.weight).fold(DVec3::ZERO, |s, (q, k)| s + *q * *k);
            let xy: f64 = a.q.iter().zip(&a.weight).map(|(q, k)| k * (q.x - mean.x) * (q.y - mean.y)).sum();
            let yy: f64 = a.q.iter().zip(&a.weight).map(|(q, k)| k * (q.y - mean.y).powi(2)).sum();
            (mean, xy, yy)
        };
        let (a, b) = (moments(&samples), moments(&model));
        assert!((a.0 - b.0).length() < 1e-12 && (a.1 - b.1).abs() < 1e-12 && (a.2 - b.2).abs() < 1e-12);
    }
}
