//! Methods with several maps a light against the formulas of their papers.

use crate::fixture::{Setup, assert_covers, camera, gradients, place, room, setup};
use crate::papers::{BORDER, FAR, HALF_FOV, NEAR, at, overhead, storage_factor_between};
use glam::{DVec2, DVec3, DVec4};
use lixel::math::{Bounds, Domain};
use lixel::methods::{CascadeFit, CascadeSplit, Inapplicable, Method, PerspectiveMethod, Region};
use lixel::scene::{LightKind, Projection};

/// Lloyd's setting with something to cover at every depth.
fn covered() -> Setup {
    let mut setup = overhead();
    setup.covered = (1..400).map(|k| at(NEAR * (FAR / NEAR).powf(f64::from(k) / 400.0))).collect();
    setup
}

/// Where the regions of cascades end, metres; the last one has no end.
fn ends(setup: &Setup) -> Vec<f64> {
    let regions = setup.solve(Method::Cascades).unwrap();
    assert_covers(setup, &regions, "cascades");
    let to = regions.iter().map(|r| match r.domain {
        Domain::ViewDepth { to_m, .. } => to_m,
        ref other => panic!("{other:?}"),
    });
    let ends: Vec<f64> = to.collect();
    assert!(ends.last().unwrap().is_infinite());
    ends[..ends.len() - 1].to_vec()
}

fn close(found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len());
    for (a, b) in found.iter().zip(expected) {
        assert!((a / b - 1.0).abs() < 1e-6, "{found:?} instead of {expected:?}");
    }
}

/// Zhang et al. 2006: uniform n + (f - n) i/m, logarithmic n (f/n)^(i/m), and their mean weighted by λ; Lauritzen et al.
/// 2011: logarithmic between the nearest and the farthest sample.
#[test]
fn cascades_split_by_their_formulas() {
    let mut setup = covered();
    setup.solver.cascade_count = 4;
    let with = |split: CascadeSplit, blend: f64| {
        let mut setup = setup.clone();
        (setup.solver.cascade_split, setup.solver.cascade_blend) = (split, blend);
        ends(&setup)
    };
    let uniform = [25.75, 50.5, 75.25];
    let log = [3.162_277_660, 10.0, 31.622_776_602];
    close(&with(CascadeSplit::Uniform, 0.5), &uniform);
    close(&with(CascadeSplit::Log, 0.5), &log);
    for blend in [0.0, 0.3, 1.0] {
        let mean: Vec<f64> = uniform.iter().zip(log).map(|(u, l)| blend * l + (1.0 - blend) * u).collect();
        close(&with(CascadeSplit::Blend, blend), &mean);
    }
    let (n, f) = (2.0, 50.0);
    setup.covered = (0..=100).map(|k| at(n + (f - n) * f64::from(k) / 100.0)).collect();
    setup.solver.cascade_split = CascadeSplit::Samples;
    close(&ends(&setup), &[1.0, 2.0, 3.0].map(|i| n * (f / n).powf(i / 4.0)));
}

/// Lloyd et al. 2006: k self-similar splits with a warp have the storage factor k (ρ - 1) / (2 tan θ), ρ = (f/n)^(1/k),
/// without one ρ times that: for k = 4, n = 1, f = 100, θ = 30° 7.49 and 23.7.
#[test]
fn storage_factors_of_self_similar_splits() {
    for (fit, k, expected) in [
        (CascadeFit::Warped, 4, 7.490),
        (CascadeFit::Plain, 4, 23.686),
        (CascadeFit::Warped, 1, 85.737),
        (CascadeFit::Plain, 1, 8573.7),
    ] {
        let mut setup = covered();
        (setup.solver.cascade_split, setup.solver.cascade_fit) = (CascadeSplit::Log, fit);
        setup.solver.cascade_count = k;
        let regions = setup.solve(Method::Cascades).unwrap();
        let rho = (FAR / NEAR).powf(1.0 / f64::from(k));
        let sum: f64 = (regions.iter().enumerate())
            .map(|(i, r)| storage_factor_between(r, NEAR * rho.powi(i as i32), NEAR * rho.powi(i as i32 + 1)))
            .sum();
        assert!((sum / expected - 1.0).abs() < BORDER, "{fit:?}, {k}: {sum} instead of {expected}");
    }
}

/// Valient 2008: the map of a range keeps its size and its axes however the camera turns, and moves by whole steps.
#[test]
fn stable_cascades_move_by_whole_steps() {
    let texel = |forward: DVec3| {
        let camera = camera(DVec3::new(0.3, 1.7, 0.0), forward, Projection::Perspective { yfov_rad: 0.9 });
        let bounds = Bounds { min: DVec3::splat(-80.0), max: DVec3::splat(90.0) };
        let mut setup = setup(camera, bounds, DVec3::new(0.6, -0.8, -0.35));
        setup.solver.cascade_fit = CascadeFit::Stable;
        let mut region = setup.solve(Method::Cascades).unwrap().remove(0);
        region.domain = Domain::All;
        let [u, v] = gradients(&region, DVec3::ZERO);
        let origin = place(std::slice::from_ref(&region), DVec3::ZERO).unwrap().1;
        (u, v, origin * 64.0)
    };
    let first = texel(DVec3::new(0.1, -0.15, -1.0));
    for forward in [DVec3::new(0.2, -0.2, -1.0), DVec3::new(0.5, -0.3, -1.0), DVec3::new(-0.4, -0.1, -1.0)] {
        let turned = texel(forward);
        assert!((turned.0 - first.0).length() < 1e-12 && (turned.1 - first.1).length() < 1e-12);
        let moved = turned.2 - first.2;
        assert!((moved - moved.round()).abs().max_element() < 1e-6, "{moved}");
    }
    let lamp = LightKind::Point { position: DVec3::new(2.0, 9.0, -14.0), range: None };
    let mut setup = room().with_light(lamp);
    setup.solver.cascade_fit = CascadeFit::Stable;
    assert_eq!(setup.solve(Method::Cascades).unwrap_err(), Inapplicable::StableNeedsParallelLight);
}

/// Rows x, y and w of a region on (X, 1).
fn rows(region: &Region) -> [DVec4; 3] {
    [0, 1, 2].map(|i| region.space.row_from_q(region.h.row(i)))
}

/// Mikkelsen (2): n·(x, y, w) and w of a camera's ray through `film` (post-projective s, t up to scale) at a depth.
fn terms(setup: &Setup, region: &Region, film: DVec2, depth: f64) -> (f64, f64) {
    let m = setup.camera.world_from_camera;
    let rows = rows(region);
    let column = |v: DVec4| DVec3::from_array(rows.map(|row| row.dot(v)));
    // C_proj⁻¹ (s, t, q, 1) = (s, t, -1, 1/depth) in camera space.
    let point = (m.x_axis * film.x + m.y_axis * film.y - m.z_axis + setup.camera.position / depth).extend(1.0 / depth);
    let n = column(m.x_axis.extend(0.0)).cross(column(m.y_axis.extend(0.0)));
    (n.dot(column(point)), column(point).z)
}

/// Texel area of a pixel on the plane across the view at a depth, by the derivatives of the map itself.
fn area(setup: &Setup, region: &Region, film: DVec2, depth: f64) -> f64 {
    let m = setup.camera.world_from_camera;
    let point = setup.camera.position + (m.x_axis * film.x + m.y_axis * film.y - m.z_axis) * depth;
    let [u, v] = gradients(region, point);
    let by = |axis: DVec3| DVec2::new(u.dot(axis), v.dot(axis)) * depth;
    by(m.x_axis).perp_dot(by(m.y_axis)).abs()
}

/// Mikkelsen 2007: (3) with its w_1 and w_2 exchanged, and the plane (6), tell which of two maps gives a pixel the larger
/// area, for all pairs of the five methods; (3) as printed does not.
#[test]
fn the_corrected_inequality_tells_the_larger_area() {
    let five = [Method::Normal, Method::Focused, Method::Tsm, Method::Lispsm, Method::Psm];
    let lamp = |x: f64, y: f64, z: f64| LightKind::Point { position: DVec3::new(x, y, z), range: None };
    let sun = |x: f64, y: f64, z: f64| LightKind::Directional { direction: DVec3::new(x, y, z).normalize() };
    let (mut decided, mut printed) = (0, 0);
    for kind in [lamp(2.0, 19.0, -14.0), lamp(-9.0, 12.0, 3.0), sun(0.6, -0.8, -0.35), sun(-0.3, -1.0, 0.4)] {
        let setup = room().with_light(kind);
        let maps: Vec<Region> = five.iter().filter_map(|m| setup.solve(*m).ok()).map(|mut r| r.remove(0)).collect();
        assert!(maps.len() >= 4);
        for (k, a) in maps.iter().enumerate() {
            for b in &maps[..k] {
                let plane = rows(b)[2] * a.h.determinant().cbrt() - rows(a)[2] * b.h.determinant().cbrt();
                for i in 0..40 {
                    let i = f64::from(i);
                    let film = DVec2::new((i * 0.754_877_666).fract() - 0.5, (i * 0.569_840_291).fract() - 0.5) * 0.9;
                    let depth = 0.5 * 90.0_f64.powf((i * 0.328).fract());
                    let ((na, wa), (nb, wb)) = (terms(&setup, a, film, depth), terms(&setup, b, film, depth));
                    let larger = area(&setup, a, film, depth) / area(&setup, b, film, depth);
                    if wa <= 0.0 || wb <= 0.0 || (larger - 1.0).abs() < 1e-6 {
                        continue;
                    }
                    decided += 1;
                    assert_eq!(na.abs() * wb.abs().powi(3) > nb.abs() * wa.abs().powi(3), larger > 1.0);
                    printed += u32::from((na.abs() * wa.abs().powi(3) > nb.abs() * wb.abs().powi(3)) == (larger > 1.0));
                    let m = setup.camera.world_from_camera;
                    let point = setup.camera.position + (m.x_axis * film.x + m.y_axis * film.y - m.z_axis) * depth;
                    assert_eq!(plane.dot(point.extend(1.0)) > 0.0, larger > 1.0, "{film} {depth}");
                }
            }
        }
    }
    assert!(decided > 500 && printed < decided, "{printed} of {decided}");
}

/// The plane of the method is (6), goes through the light, and refocused maps still hold their sides.
#[test]
fn the_separating_plane_goes_through_the_light() {
    let position = DVec3::new(2.0, 19.0, -14.0);
    for map in [PerspectiveMethod::Psm, PerspectiveMethod::Tsm, PerspectiveMethod::Lispsm] {
        for iterations in [1, 2, 20] {
            let mut setup = room().with_light(LightKind::Point { position, range: None });
            (setup.solver.separating_map, setup.solver.separating_iterations) = (map, iterations);
            let regions = setup.solve(Method::SeparatingPlane).unwrap();
            assert_covers(&setup, &regions, "separating-plane");
            if map == PerspectiveMethod::Psm && regions.len() == 1 {
                continue; // one of the two is the better everywhere
            }
            let [warped, focused] = regions.as_slice() else { panic!("{map:?}, {iterations}: {} maps", regions.len()) };
            let Domain::HalfSpace { plane } = warped.domain else { panic!("{:?}", warped.domain) };
            assert!(plane.dot(position.extend(1.0)).abs() < 1e-9 && focused.domain == Domain::All);
            if iterations == 1 {
                for edge in &setup.edges {
                    let area = |r: &Region| {
                        let [u, v] = gradients(r, edge.position);
                        let [a, b] = edge.derivatives.map(|d| DVec2::new(u.dot(d), v.dot(d)));
                        a.perp_dot(b).abs()
                    };
                    let (here, there) = (area(warped), area(focused));
                    let nearer = warped.domain.holds(edge.position);
                    assert!(nearer == (here > there) || (here / there - 1.0).abs() < 1e-6, "{here} {there}");
                }
            }
        }
    }
}

/// Lloyd et al. 2006: under light along or against the view the four side faces and the near one have maps; on a side face
/// the sampling error along the view, ~ (z + √(z_n z_f))² / z, is the same at both ends.
#[test]
fn side_faces_are_balanced() {
    for direction in [DVec3::NEG_Z, DVec3::Z] {
        let mut setup = overhead().with_direction(direction);
        let tan = HALF_FOV.tan();
        setup.covered = (0..2000)
            .map(f64::from)
            .map(|k| {
                let z = NEAR * (FAR / NEAR).powf((k * 0.328).fract());
                let x = DVec2::new((k * 0.754_877_666).fract() - 0.5, (k * 0.569_840_291).fract() - 0.5) * 1.99 * tan;
                DVec3::new(x.x, x.y, -1.0) * z
            })
            .collect();
        let regions = setup.solve(Method::Faces).unwrap();
        assert_covers(&setup, &regions, "faces");
        assert_eq!(regions.len(), 5, "{direction}");
        for towards in [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y] {
            let on_face = |z: f64| (DVec3::NEG_Z + towards * tan * (1.0 - 1e-9)) * z;
            let map = place(&regions, on_face(30.0)).unwrap().0;
            assert_eq!(place(&regions, on_face(3.0)).unwrap().0, map);
            // Along the middle of the face the map moves along one axis alone.
            let error = |z: f64| {
                let [u, v] = gradients(&regions[map], on_face(z));
                let along = DVec2::new(u.dot(towards), v.dot(towards)) * tan;
                1.0 / (z * along.length())
            };
            assert!((error(NEAR) / error(FAR) - 1.0).abs() < 1e-6, "{} {}", error(NEAR), error(FAR));
            let middle = (NEAR * FAR).sqrt();
            let expected = (NEAR + middle).powi(2) / NEAR / ((middle + middle).powi(2) / middle);
            assert!((error(NEAR) / error(middle) / expected - 1.0).abs() < 1e-6);
        }
    }
    // Under light from the side one face is all there is, and the map is LiSPSM's.
    let setup = overhead();
    let (faces, lispsm) = (setup.solve(Method::Faces).unwrap(), setup.solve(Method::Lispsm).unwrap());
    let factor = |r: &[Region]| storage_factor_between(&r[0], NEAR, FAR);
    assert!(faces.len() == 1 && (factor(&faces) / factor(&lispsm) - 1.0).abs() < 1e-6);
    // A lamp in the view sees every face from within.
    let lamp = LightKind::Point { position: DVec3::new(0.0, 0.0, -9.0), range: None };
    let mut within = room().with_light(lamp);
    within.covered.retain(|p| p.z < -29.0);
    assert_eq!(within.solve(Method::Faces).map(|r| r.len()), Err(Inapplicable::LightAmongFaces));
}
