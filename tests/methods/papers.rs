//! The published methods against the figures and curves of their papers.

use crate::fixture::{FLOOR, Setup, camera, edge_on, gradients, place, room, setup};
use glam::{DVec2, DVec3};
use lixel::math::Bounds;
use lixel::methods::{AreaOver, Inapplicable, Method, Region};
use lixel::scene::{LightKind, Projection};

pub(crate) const NEAR: f64 = 1.0;
pub(crate) const FAR: f64 = 100.0;
pub(crate) const HALF_FOV: f64 = std::f64::consts::FRAC_PI_6;

/// Lloyd's setting: a level view from 1 to 100 m of ±30° under an overhead sun; nothing but the view bounds the body.
pub(crate) fn overhead() -> Setup {
    let mut camera = camera(DVec3::ZERO, DVec3::NEG_Z, Projection::Perspective { yfov_rad: 2.0 * HALF_FOV });
    (camera.near, camera.far) = (NEAR, Some(FAR));
    let mut setup = setup(camera, Bounds { min: DVec3::splat(-300.0), max: DVec3::splat(300.0) }, DVec3::NEG_Y);
    setup.film.width = setup.film.height;
    setup.edges.clear();
    setup.covered = vec![at(2.0), at(50.0)];
    setup
}

/// The point of the view axis at a depth.
pub(crate) fn at(z: f64) -> DVec3 {
    DVec3::new(0.0, 0.0, -z)
}

fn depths() -> impl Iterator<Item = f64> {
    (0..=200).map(|k| NEAR * (FAR / NEAR).powf(f64::from(k) / 200.0))
}

/// dp/ds of Wimmer et al. §4 along the view axis, up to a factor: (1/z) dz/ds.
fn dp_ds(region: &Region, z: f64) -> f64 {
    let [u, v] = gradients(region, at(z));
    1.0 / (z * DVec2::new(u.z, v.z).length())
}

/// Lloyd 2006: the largest error along the view times the largest across it, (dz/ds)(dx/dt) / (2 z tan θ)².
fn storage_factor(region: &Region) -> f64 {
    storage_factor_between(region, NEAR, FAR)
}

/// The same over a range of depths.
pub(crate) fn storage_factor_between(region: &Region, near: f64, far: f64) -> f64 {
    let across = |z: f64| {
        let [u, v] = gradients(region, at(z));
        1.0 / (z * DVec2::new(u.x, v.x).length())
    };
    let depths = || (0..=200).map(|k| near * (far / near).powf(f64::from(k) / 200.0));
    let most = |f: &dyn Fn(f64) -> f64| depths().map(f).fold(0.0, f64::max);
    most(&|z| dp_ds(region, z)) * most(&across) / (2.0 * HALF_FOV.tan()).powi(2)
}

fn one(setup: &Setup, method: Method) -> Region {
    setup.solve(method).unwrap().remove(0)
}

/// TSM with the centre of projection `n` before the near end: p of `tsm_focus` for f = 1/2.
fn warped_by(n: f64) -> Region {
    let mut setup = overhead();
    let s = (FAR - NEAR) / n;
    setup.solver.tsm_depth = 0.5;
    setup.solver.tsm_focus = 0.5 * (1.0 + s) / (1.0 + 0.5 * s);
    one(&setup, Method::Tsm)
}

/// Part that the border of the unit square adds: 1/4096 at each side, in both axes.
pub(crate) const BORDER: f64 = 2e-3;

/// Lloyd et al. 2006, storage factors for n = 1, f = 100, θ = 30°: 8573.7 uniform; (f - n) / (2 n tan θ) = 85.7 warped,
/// the same for every centre of projection from n to n_opt.
#[test]
fn storage_factors() {
    let warped = (FAR - NEAR) / (2.0 * NEAR * HALF_FOV.tan());
    let close = |region: &Region, expected: f64, what: &str| {
        let s = storage_factor(region);
        assert!((s / expected - 1.0).abs() < BORDER, "{what}: {s} instead of {expected}");
    };
    assert!((warped - 85.737).abs() < 1e-3);
    close(&one(&overhead(), Method::Lispsm), warped, "LiSPSM at n_opt");
    for n in [1.0, 2.0, 5.0, 11.0] {
        close(&warped_by(n), warped, "a warp between n and n_opt");
    }
    close(&warped_by(1e12), warped * FAR / NEAR, "uniform");
}

/// Wimmer et al. 2004 §4 and the course slides: dp/ds ~ 1/z uniform, ~ z for PSM without pull-back, equal at both ends
/// for LiSPSM with n_opt = z_n + √(z_f z_n), least between them at z = n_opt - z_n.
#[test]
fn sampling_error_along_the_view() {
    let flat = |region: &Region, power: i32| {
        let values: Vec<f64> = depths().map(|z| dp_ds(region, z) * z.powi(power)).collect();
        values.iter().all(|v| (v / values[0] - 1.0).abs() < 1e-9)
    };
    assert!(flat(&warped_by(1e15), 1), "uniform");
    let mut plain = overhead();
    plain.solver.psm_infinity = 1.0;
    assert!(flat(&one(&plain, Method::Psm), -1), "PSM");
    let region = one(&overhead(), Method::Lispsm);
    assert!((dp_ds(&region, NEAR) / dp_ds(&region, FAR) - 1.0).abs() < 1e-9, "LiSPSM is balanced");
    let least = depths().min_by(|a, b| dp_ds(&region, *a).total_cmp(&dp_ds(&region, *b))).unwrap();
    assert!((least / (NEAR * FAR).sqrt() - 1.0).abs() < 0.03, "least at {least}");
}

/// Kozlov 2004: slid back until zf / (zf - zn) = 1.5, dp/ds ~ (z + t)² / z, t = 1.5 (zf - zn) - zf.
#[test]
fn psm_slides_the_camera_back() {
    let region = one(&overhead(), Method::Psm);
    let t = 1.5 * (FAR - NEAR) - FAR;
    let expected = |z: f64| (z + t).powi(2) / z;
    for z in depths() {
        let ratio = dp_ds(&region, z) / dp_ds(&region, NEAR);
        assert!((ratio / (expected(z) / expected(NEAR)) - 1.0).abs() < 1e-9, "{z}");
    }
}

/// Directional light at any angle γ to the view: w grows by √(z1/z0) = √(1 + d sin γ / z_n) over the body (2006 form),
/// continuously to 1 as γ → 0.
#[test]
fn n_opt_of_tilted_lights() {
    let setup = overhead();
    let corners: Vec<DVec3> = [NEAR, FAR]
        .iter()
        .flat_map(|z| [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)].map(|(x, y)| (*z, x, y)))
        .map(|(z, x, y)| DVec3::new(x * HALF_FOV.tan(), y * HALF_FOV.tan(), -1.0) * z)
        .collect();
    for degrees in [90.0, 60.0, 20.0, 1.0, 1e-3, 1e-7] {
        let (sin, cos) = f64::to_radians(degrees).sin_cos();
        let light = DVec3::new(0.0, -sin, -cos);
        let region = one(&setup.with_direction(light), Method::Lispsm);
        let along = DVec3::new(0.0, cos, -sin); // the view direction in the light's plane
        let extent = |f: &dyn Fn(DVec3) -> f64| {
            corners.iter().map(|p| f(*p)).fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)))
        };
        let (lo, hi) = extent(&|p| p.dot(along));
        let (w_lo, w_hi) = extent(&|p| (region.h * region.space.q(p)).z);
        let expected = (1.0 + (hi - lo) * sin / NEAR).sqrt();
        assert!((w_hi / w_lo / expected - 1.0).abs() < 1e-9, "{degrees}°: {} {expected}", w_hi / w_lo);
    }
}

/// Martin and Tan 2004 §4: top to 0, base to 1, the focus at δ to the 80 % line; the sides touch the hull.
#[test]
fn tsm_maps_top_base_and_focus() {
    let setup = overhead();
    let region = one(&setup, Method::Tsm);
    let v = |z: f64| place(std::slice::from_ref(&region), at(z)).unwrap().1.y;
    let delta = setup.solver.tsm_depth * (FAR - NEAR);
    for (z, expected) in [(NEAR, 0.0), (NEAR + delta, setup.solver.tsm_focus), (FAR, 1.0)] {
        assert!((v(z) - expected).abs() < 3e-4, "{z} at {}", v(z));
    }
    let side = |z: f64| place(std::slice::from_ref(&region), at(z) + DVec3::X * z * HALF_FOV.tan()).unwrap().1.x;
    let reach = side(NEAR).max(side(FAR));
    assert!((reach - 1.0).abs() < 3e-4, "{reach}");
}

/// Chong and Gortler 2004: on its plane every pixel has the same texels, whatever its depth; given or fitted.
#[test]
fn plane_optimal_samples_its_plane_evenly() {
    let lights = [
        LightKind::Directional { direction: DVec3::new(0.3, -0.9, 0.2).normalize() },
        LightKind::Point { position: DVec3::new(2.0, 12.0, -9.0), range: None },
    ];
    for kind in lights {
        for plane in [None, Some([0.0, 2.0, 0.0, 0.0])] {
            let mut setup = room().with_light(kind);
            setup.edges.retain(|e| e.position.y < 1e-6 || e.film[0] < 40.0);
            setup.covered = setup.edges.iter().map(|e| e.position).filter(|p| p.y < 1e-6).collect();
            setup.solver.plane = plane;
            let region = one(&setup, Method::PlaneOptimal);
            let jacobian = |x: f64, y: f64| {
                let edge = edge_on(&setup.camera, setup.film, FLOOR, x, y, DVec2::X).unwrap();
                let g = gradients(&region, edge.position);
                edge.derivatives.map(|d| DVec2::new(g[0].dot(d), g[1].dot(d)))
            };
            let first = jacobian(80.0, 118.0);
            for (x, y) in [(2.0, 119.0), (150.0, 90.0), (70.0, 70.0), (20.0, 60.0)] {
                let here = jacobian(x, y);
                for (a, b) in first.iter().zip(here) {
                    assert!((*a - b).length() < 1e-9 * a.length(), "{plane:?} at {x}, {y}: {a} {b}");
                }
            }
        }
    }
}

/// Colbert eq. 10 recomputed from the finished maps: scene-optimal chooses among the same maps by another metric, so its
/// mean of (det J - 1/det J)² is never smaller, with too few texels and with too many.
#[test]
fn homography_area_has_the_least_area_error() {
    for texels in [2_000.0, 20_000.0, 160_000.0] {
        let setup = Setup { texels, ..room() };
        let error = |region: &Region| {
            let terms = setup.edges.iter().map(|e| {
                let [u, v] = gradients(region, e.position);
                let [a, b] = e.derivatives.map(|d| DVec2::new(u.dot(d), v.dot(d)));
                let area = (a.perp_dot(b) * texels).abs();
                e.length_px * (area - 1.0 / area).powi(2)
            });
            terms.sum::<f64>()
        };
        let [least, other] = [Method::HomographyArea, Method::SceneOptimal].map(|m| error(&one(&setup, m)));
        assert!(least <= other * (1.0 + 1e-9), "{texels} texels: {other} below {least}");
    }
}

/// Eq. 11 and eq. 12 give maps too; the singularities of eq. 12 have names.
#[test]
fn homography_area_over_models_and_planes() {
    for area in [AreaOver::Normal, AreaOver::Alpha] {
        let mut setup = room();
        setup.solver.area = area;
        let regions = setup.solve(Method::HomographyArea).unwrap();
        crate::fixture::assert_covers(&setup, &regions, "homography-area");
    }
    // The light on the far side of the cover: every plane between has its horizon in the cover, or is seen as a line.
    let mut setup = room().with_direction(DVec3::new(0.1, -0.02, 1.0));
    setup.solver.area = AreaOver::Alpha;
    let reason = setup.solve(Method::HomographyArea).unwrap_err();
    let named = [
        Inapplicable::StraddlesVanishingLine,
        Inapplicable::CameraOnPlane,
        Inapplicable::LightOnPlane,
        Inapplicable::VanishingNormal,
    ];
    assert!(named.contains(&reason), "{reason}");
}

/// A point light 10⁷ m away is a directional one, for every method.
#[test]
fn far_lamps_are_suns() {
    let setup = room();
    let direction = DVec3::new(0.6, -0.8, -0.35).normalize();
    let lamp = setup.with_light(LightKind::Point { position: direction * -1e7, range: None });
    for method in [Method::Psm, Method::Tsm, Method::Lispsm, Method::PlaneOptimal] {
        let (Ok(a), Ok(b)) = (setup.solve(method), lamp.solve(method)) else { panic!("{method:?}") };
        for p in &setup.covered {
            let (u, v) = (place(&a, *p).unwrap().1, place(&b, *p).unwrap().1);
            assert!(u.abs_diff_eq(v, 1e-4), "{method:?}: {p} at {u} and {v}");
        }
    }
}

/// The user's plane is in world space, the solver's in scene space.
#[test]
fn a_given_plane_moves_with_the_origin() {
    let mut solver = room().solver;
    solver.plane = Some([0.0, 2.0, 0.0, -6.0]); // y = 3
    assert_eq!(solver.in_scene_space(DVec3::new(5.0, 1.0, 7.0)).plane, Some([0.0, 2.0, 0.0, -4.0])); // y = 2
}
