//! Gradient and Hessian of the moment form against automatic differentiation (hyper-dual numbers: exact but for
//! rounding) of the sum over samples itself, so that the moments are not taken on trust either.

use glam::{DVec2, DVec3};
use lixel::metric::{EdgeSamples, FilmEdge, Moments};
use num_dual::HyperDual64;
use proptest::prelude::*;

/// Greatest error of a derivative over the greatest one of its order, both per relative change of the rows. Below it
/// there is room for the condition of the rows and for the cancellation of w² = Σ p4 p4 q q near the border of the
/// polar polygon: 1e6 roundings.
const TOLERANCE: f64 = 1e-9;

/// Samples over the unit disc, two footprints each. `grazing` is the sine of the light's angle on the first receiver.
fn samples(grazing: f64) -> EdgeSamples {
    let mut s = EdgeSamples::default();
    for i in 0..40 {
        let f = f64::from(i);
        let q = (DVec2::from_angle(f * 2.4) * ((f + 0.5) / 40.0).sqrt()).extend(1.0);
        let first = DVec3::new(0.01 + 0.002 * f.sin(), 0.003, 0.001 * f.cos());
        let across = DVec3::new(-0.002, 0.02 + 0.004 * f.cos(), 0.0);
        let along = first * 1.5 + q * 0.01;
        let second = if i == 0 { along + (across - along) * grazing } else { across };
        let t = [first, second];
        let edge = FilmEdge { normal: DVec2::from_angle(f), length_px: 1.0 + 0.1 * f, room_px: 10.0, uncertain: false };
        s.push(q, t, lixel::math::det3(q, t[0], t[1]), &edge);
    }
    s
}

fn moments(s: &EdgeSamples) -> Moments {
    let mut m = Moments::default();
    for i in 0..s.len() {
        for c in s.footprint_vectors(i) {
            m.add(s.q[i], 1.0 / s.inverse_volume[i], c, s.length_px[i]);
        }
    }
    m
}

type Dual3 = [HyperDual64; 3];

fn cross(a: &Dual3, b: &Dual3) -> Dual3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: &Dual3, b: DVec3) -> HyperDual64 {
    a[0] * b.x + a[1] * b.y + a[2] * b.z
}

/// Σ_s k_s Σ_ij (q_i'·c_j)² (w / (det H V))², sample by sample.
fn direct(s: &EdgeSamples, [p1, p2, p4]: &[Dual3; 3]) -> HyperDual64 {
    let normal = cross(p1, p2);
    let det = normal[0] * p4[0] + normal[1] * p4[1] + normal[2] * p4[2];
    let film = [cross(p1, p4), cross(p2, p4)];
    let mut sum = HyperDual64::from_re(0.0);
    for i in 0..s.len() {
        let scale = dot(p4, s.q[i]) / det * s.inverse_volume[i];
        for c in s.footprint_vectors(i) {
            for row in &film {
                let v = dot(row, c) * scale;
                sum += v * v * s.length_px[i];
            }
        }
    }
    sum
}

/// Compares all 9 + 81 derivatives at one point.
fn check(s: &EdgeSamples, rows: [DVec3; 3]) -> Result<(), TestCaseError> {
    let m = moments(s);
    let (gradient, hessian) = (m.gradient(&rows), m.hessian(&rows));
    let mut errors = [0.0_f64; 2];
    let mut sizes = [0.0_f64; 2];
    for i in 0..9 {
        for j in 0..9 {
            let mut x = rows.map(|r| r.to_array().map(HyperDual64::from_re));
            x[i / 3][i % 3].eps1 = 1.0;
            x[j / 3][j % 3].eps2 = 1.0;
            let exact = direct(s, &x);
            let (by_i, by_j) = (rows[i / 3].length(), rows[j / 3].length());
            let analytic = [gradient[i / 3][i % 3], hessian[i / 3][j / 3].col(j % 3)[i % 3]];
            for (order, (a, e, unit)) in
                [(analytic[0], exact.eps1, by_i), (analytic[1], exact.eps1eps2, by_i * by_j)].into_iter().enumerate()
            {
                prop_assert!(a.is_finite() && e.is_finite(), "{i} {j}: {a} {e}");
                errors[order] = errors[order].max((a - e).abs() * unit);
                sizes[order] = sizes[order].max(e.abs() * unit);
            }
        }
    }
    for order in 0..2 {
        prop_assert!(
            errors[order] <= TOLERANCE * sizes[order],
            "order {}: {:e} of {:e}",
            order + 1,
            errors[order],
            sizes[order]
        );
    }
    Ok(())
}

fn rows() -> impl Strategy<Value = [DVec3; 3]> {
    // Two axes at least 17 degrees apart, some hundreds of texels over the disc, any offset.
    let row = || (100.0..400.0_f64, -100.0..100.0_f64);
    (0.0..std::f64::consts::TAU, 0.3..2.8_f64, row(), row(), 0.0..std::f64::consts::TAU).prop_map(
        |(t, apart, a, b, way)| {
            [
                (DVec2::from_angle(t) * a.0).extend(a.1),
                (DVec2::from_angle(t + apart) * b.0).extend(b.1),
                (DVec2::from_angle(way) * 0.6).extend(1.0),
            ]
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn derivatives_are_exact_at_random_rows(rows in rows()) {
        check(&samples(1.0), rows)?;
    }

    #[test]
    fn derivatives_are_exact_where_a_receiver_grazes(rows in rows(), decades in 1.0..5.0_f64) {
        check(&samples(10.0_f64.powf(-decades)), rows)?;
    }

    #[test]
    fn derivatives_are_exact_near_the_border_of_the_polar_polygon(rows in rows(), sample in 0..40_usize, decades in 1.0..8.0_f64) {
        // p4 vanishes at a sample but for one part in 10^decades: w = 0 there is the border.
        let s = samples(1.0);
        let to = -s.q[sample].truncate().normalize() / s.q[sample].truncate().length();
        let p4 = (to * (1.0 - 10.0_f64.powf(-decades))).extend(1.0);
        prop_assume!(rows[0].cross(rows[1]).normalize().dot(p4.normalize()).abs() > 0.1);
        check(&s, [rows[0], rows[1], p4])?;
    }

    #[test]
    fn derivatives_are_exact_where_the_axes_nearly_fall_together(rows in rows(), decades in 1.0..4.0_f64) {
        // The second axis runs along the first but for one part in 10^decades: det -> 0.
        let apart = 10.0_f64.powf(-decades);
        check(&samples(1.0), [rows[0], rows[0] + (rows[1] - rows[0]) * apart, rows[2]])?;
    }

    #[test]
    fn derivatives_are_exact_at_any_scale_of_rows(rows in rows(), p in -9.0..9.0_f64, w in -9.0..9.0_f64) {
        let [p, w] = [p, w].map(|decades| 10.0_f64.powf(decades));
        check(&samples(1.0), [rows[0] * p, rows[1] * p, rows[2] * w])?;
    }

    #[test]
    fn derivatives_are_exact_for_texels_of_any_aspect(rows in rows(), decades in -6.0..6.0_f64) {
        check(&samples(1.0), [rows[0] * 10.0_f64.powf(decades), rows[1], rows[2]])?;
    }
}

#[test]
fn hessian_is_symmetric_and_flat_where_the_form_is_constant() {
    let rows = [DVec3::new(200.0, 20.0, 5.0), DVec3::new(-30.0, 180.0, 9.0), DVec3::new(0.2, -0.3, 1.0)];
    let h = moments(&samples(1.0)).hessian(&rows);
    for (i, blocks) in h.iter().enumerate() {
        for (j, block) in blocks.iter().enumerate() {
            let size = block.to_cols_array().into_iter().fold(0.0, |m: f64, v| m.max(v.abs()));
            let apart = block.transpose() - h[j][i];
            assert!(apart.to_cols_array().into_iter().all(|v| v.abs() <= 1e-14 * size), "{i} {j}: {apart}");
        }
        // h does not change along p_i + t p4.
        if i < 2 {
            let bend = rows[2].dot(blocks[i] * rows[2]);
            assert!(bend.abs() <= 1e-12 * blocks[i].x_axis.length(), "{i}: {bend:e}");
        }
    }
}
