//! Rays against shapes whose answers are known.

use glam::{DMat3, DVec3, Vec3};
use lixel::math::Prng;
use lixel::scene::{Camera, Film, Geometry, Light, LightKind, Projection, Triangle};
use lixel::visibility::{Answer, Bvh, RayOffset, Tracer, answer, classify, see, surface_at};

/// Numbers, points and directions, the same every time.
struct Seeded(Prng);

impl Seeded {
    fn next(&mut self) -> f64 {
        self.0.unit()
    }

    fn point(&mut self, size: f64) -> DVec3 {
        DVec3::from_array(std::array::from_fn(|_| size * (2.0 * self.next() - 1.0)))
    }

    fn unit(&mut self) -> DVec3 {
        loop {
            let v = self.point(1.0);
            if v.length() > 0.1 && v.length() < 1.0 {
                return v.normalize();
            }
        }
    }
}

/// A closed sphere of quads split in two, `2 × rings × rings` triangles, with a vertex at both poles.
fn sphere(centre: Vec3, radius: f32, rings: usize) -> Vec<Triangle> {
    let vertex = |i: usize, j: usize| {
        let polar = std::f64::consts::PI * i as f64 / rings as f64;
        let around = std::f64::consts::TAU * (j % rings) as f64 / rings as f64;
        let sin = if i == 0 || i == rings { 0.0 } else { polar.sin() };
        centre + radius * DVec3::new(sin * around.cos(), polar.cos(), sin * around.sin()).as_vec3()
    };
    (0..rings)
        .flat_map(|i| (0..rings).map(move |j| (i, j)))
        .flat_map(|(i, j)| {
            let [a, b, c, d] = [vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect()
}

fn square(half: f32, y: f32) -> Vec<Triangle> {
    let v = |x: f32, z: f32| Vec3::new(x * half, y, z * half);
    vec![[v(-1., -1.), v(-1., 1.), v(1., 1.)], [v(-1., -1.), v(1., 1.), v(1., -1.)]]
}

fn look_down(height: f64) -> Camera {
    Camera {
        name: "above".into(),
        position: DVec3::new(0.0, height, 0.0),
        world_from_camera: DMat3::from_cols(DVec3::X, DVec3::NEG_Z, DVec3::Y),
        projection: Projection::Perspective { yfov_rad: 1.0 },
        near: 0.1,
        far: None,
    }
}

fn sun(direction: DVec3) -> Light {
    Light { name: "sun".into(), kind: LightKind::Directional { direction: direction.normalize() } }
}

/// Nearest hit in f64 by Möller and Trumbore, over all triangles.
fn brute_force(triangles: &[Triangle], origin: DVec3, direction: DVec3) -> Option<(u32, f64)> {
    let mut best: Option<(u32, f64)> = None;
    for (index, triangle) in (0..).zip(triangles) {
        let [a, b, c] = triangle.map(|v| v.as_dvec3());
        let (e1, e2) = (b - a, c - a);
        let p = direction.cross(e2);
        let s = (origin - a) / e1.dot(p);
        let (u, v, t) = (s.dot(p), direction.dot(s.cross(e1)), e2.dot(s.cross(e1)));
        if u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t >= 0.0 && best.is_none_or(|(_, nearest)| t < nearest) {
            best = Some((index, t));
        }
    }
    best
}

#[test]
fn random_rays_meet_what_brute_force_meets() {
    let mut seeded = Seeded(Prng::seeded(1));
    let triangles: Vec<Triangle> = (0..3000)
        .map(|_| {
            let centre = seeded.point(10.0);
            std::array::from_fn(|_| (centre + seeded.point(0.5)).as_vec3())
        })
        .collect();
    let (still, moving) = triangles.split_at(2000);
    let (still_bvh, moving_bvh) = (Bvh::build(still), Bvh::build(moving));
    let tracer = Tracer::new(Geometry::plain(still, moving), &still_bvh, Some(&moving_bvh));
    let mut hits = 0;
    for _ in 0..4000 {
        let origin = seeded.point(30.0);
        let direction = (seeded.point(8.0) - origin) * 0.37;
        let (found, expected) =
            (tracer.closest(origin, direction, 0.0, f64::INFINITY), brute_force(&triangles, origin, direction));
        assert_eq!(found.map(|h| h.triangle), expected.map(|h| h.0));
        assert_eq!(tracer.occluded(origin, direction, 0.0, f64::INFINITY), expected.is_some());
        if let (Some(found), Some((_, t))) = (found, expected) {
            hits += 1;
            assert!((found.t - t).abs() <= 1e-9 * t.max(1.0), "{} against {t}", found.t);
            assert!(!tracer.occluded(origin, direction, 0.0, t * 0.999));
        }
    }
    assert!(hits > 500, "{hits} hits say little");
}

#[test]
fn nothing_leaks_through_edges_and_vertices_of_a_closed_sphere() {
    let triangles = sphere(Vec3::new(3.0, -2.0, 5.0), 2.0, 40);
    let bvh = Bvh::build(&triangles);
    let tracer = Tracer::new(Geometry::plain(&triangles, &[]), &bvh, None);
    let mut seeded = Seeded(Prng::seeded(2));
    let inside = DVec3::new(3.1, -1.8, 4.7);
    for triangle in &triangles {
        let [a, b, c] = triangle.map(|v| v.as_dvec3());
        for _ in 0..4 {
            for target in [a, a.lerp(b, seeded.next()), b.lerp(c, seeded.next()), c.lerp(a, seeded.next())] {
                assert!(tracer.closest(inside, target - inside, 0.0, f64::INFINITY).is_some());
                assert!(tracer.occluded(inside, target - inside, 0.0, f64::INFINITY));
            }
        }
    }
}

#[test]
fn a_convex_body_does_not_shadow_itself_and_its_far_side_is_unlit() {
    for scale in [1e-6_f32, 1.0, 1e6] {
        let triangles = sphere(Vec3::new(3.0, -2.0, 5.0) * scale, 2.0 * scale, 40);
        let bvh = Bvh::build(&triangles);
        let tracer = Tracer::new(Geometry::plain(&triangles, &[]), &bvh, None);
        let offset = RayOffset::for_scene(&tracer);
        let mut seeded = Seeded(Prng::seeded(3));
        let centre = DVec3::new(3.0, -2.0, 5.0) * f64::from(scale);
        let mut lit = 0;
        for _ in 0..2000 {
            let (from, light) = (seeded.unit(), sun(seeded.unit()));
            let camera = Camera { position: centre + from * 8.0 * f64::from(scale), ..toward(-from) };
            let (x, y) = (40.0 + 20.0 * seeded.next(), 40.0 + 20.0 * seeded.next());
            let Some(surface) = surface_at(&tracer, &camera, Film { width: 100, height: 100 }, x, y) else { continue };
            let facing = surface.normal.dot(light.towards(surface.position));
            let expected = if facing > 0.0 { Answer::Lit } else { Answer::Unlit };
            assert_eq!(answer(&tracer, &surface, &light, offset), expected, "facing {facing}");
            lit += u32::from(expected == Answer::Lit);
        }
        assert!(lit > 500, "{lit} lit");
    }
}

/// A camera at the origin that looks along a direction.
fn toward(forward: DVec3) -> Camera {
    let right = forward.any_orthonormal_vector();
    Camera {
        position: DVec3::ZERO,
        near: 0.0,
        world_from_camera: DMat3::from_cols(right, right.cross(forward), -forward),
        ..look_down(0.0)
    }
}

#[test]
fn a_square_over_a_floor_casts_the_shadow_geometry_says() {
    let (floor, lid) = (square(10.0, 0.0), square(1.0, 2.0));
    let (floor_bvh, lid_bvh) = (Bvh::build(&floor), Bvh::build(&lid));
    let tracer = Tracer::new(Geometry::plain(&floor, &lid), &floor_bvh, Some(&lid_bvh));
    let camera = look_down(10.0);
    let film = Film { width: 64, height: 48 };
    let view = see(&tracer, &camera, film);
    let offset = RayOffset::for_scene(&tracer);
    let bulb = DVec3::new(0.5, 4.0, 0.0);
    let lights = [
        sun(DVec3::new(1.0, -1.0, 0.0)),
        Light { name: "bulb".into(), kind: LightKind::Point { position: bulb, range: None } },
        Light { name: "star".into(), kind: LightKind::Point { position: DVec3::new(-1e12, 1e12, 0.0), range: None } },
    ];
    for light in &lights {
        let answers = classify(&tracer, &view, &camera, light, offset);
        let mut seen = [0; 3];
        for (pixel, &found) in answers.iter().enumerate() {
            let Some(surface) = view.surface(&tracer, &camera, pixel) else { panic!("the floor fills the film") };
            let towards = light.towards(surface.position);
            let at_lid = surface.position + towards * ((2.0 - surface.position.y) / towards.y);
            let below = surface.position.y < 1.0;
            let expected =
                if below && at_lid.x.abs() < 1.0 && at_lid.z.abs() < 1.0 { Answer::Shadowed } else { Answer::Lit };
            assert_eq!(found, expected, "{} at {}", light.name, surface.position);
            seen[found as usize] += 1;
        }
        assert!(seen[1] > 100 && seen[2] > 20, "{seen:?}");
    }
    let spot = Light {
        name: "spot".into(),
        kind: LightKind::Spot { position: bulb, direction: DVec3::NEG_Y, cone_rad: 0.2, range: None },
    };
    let answers = classify(&tracer, &view, &camera, &spot, offset);
    assert!(answers.contains(&Answer::Unlit) && answers.contains(&Answer::Lit));
}

#[test]
fn near_and_far_planes_bound_what_is_seen() {
    let (floor, lid) = (square(10.0, 0.0), square(1.0, 2.0));
    let triangles = [floor, lid].concat();
    let bvh = Bvh::build(&triangles);
    let tracer = Tracer::new(Geometry::plain(&triangles, &[]), &bvh, None);
    let film = Film { width: 8, height: 8 };
    let depth = |near, far| {
        surface_at(&tracer, &Camera { near, far, ..look_down(10.0) }, film, 4.1, 4.2)
            .map(|s| (s.depth_m * 1e6).round() / 1e6)
    };
    assert_eq!(depth(0.1, None), Some(8.0));
    assert_eq!(depth(8.5, None), Some(10.0));
    assert_eq!(depth(0.1, Some(7.0)), None);
    assert_eq!(depth(8.5, Some(9.5)), None);
}

#[test]
fn film_derivatives_are_the_numerical_ones() {
    let triangles = sphere(Vec3::ZERO, 2.0, 12);
    let bvh = Bvh::build(&triangles);
    let tracer = Tracer::new(Geometry::plain(&triangles, &[]), &bvh, None);
    let film = Film { width: 200, height: 100 };
    let step = 1e-4;
    for projection in [Projection::Perspective { yfov_rad: 0.8 }, Projection::Orthographic { half_height: 3.0 }] {
        let camera = Camera { projection, ..look_down(7.0) };
        let mut compared = 0;
        for (x, y) in (0..60).map(|k| (70.0 + f64::from(k), 30.3 + f64::from(k) * 0.7)) {
            let at = |x, y| surface_at(&tracer, &camera, film, x, y);
            let Some(surface) = at(x, y) else { continue };
            let around = [at(x - step, y), at(x + step, y), at(x, y - step), at(x, y + step)];
            let [Some(left), Some(right), Some(up), Some(down)] = around else { continue };
            if [left, right, up, down].iter().any(|s| s.triangle != surface.triangle) {
                continue;
            }
            let numerical = [right.position - left.position, down.position - up.position].map(|d| d / (2.0 * step));
            for (exact, numerical) in surface.film_derivatives(&camera, film, x, y).into_iter().zip(numerical) {
                assert!((exact - numerical).length() < 1e-6 * exact.length(), "{exact} against {numerical}");
            }
            compared += 1;
        }
        assert!(compared > 20, "{compared} compared");
    }
}

#[test]
fn hostile_rays_and_scenes_answer_without_panic() {
    let huge = Vec3::splat(1e38);
    let triangles = [
        [Vec3::NAN; 3],
        [Vec3::ZERO, Vec3::X * 1e-40, Vec3::Y * 1e-40],
        [-huge, huge, Vec3::new(1e38, -1e38, 0.0)],
        [Vec3::ZERO, Vec3::X, Vec3::new(2.0, 1e-30, 0.0)],
    ];
    let bvh = Bvh::build(&triangles);
    let none = Bvh::build(&[]);
    let tracer = Tracer::new(Geometry::plain(&triangles, &[]), &bvh, Some(&none));
    let odd = [0.0, -0.0, 1.0, -1e300, 1e-300, f64::NAN, f64::INFINITY];
    for &a in &odd {
        for &b in &odd {
            for &t in &odd {
                if let Some(hit) = tracer.closest(DVec3::splat(a), DVec3::new(b, a, 1.0), t, f64::INFINITY) {
                    assert!(hit.t.is_finite());
                }
                tracer.occluded(DVec3::new(a, b, 0.0), DVec3::splat(t), 0.0, a);
            }
        }
    }
    let tiny = [[Vec3::ZERO, Vec3::X * 1e-40, Vec3::Y * 1e-40], [Vec3::ONE * 1e-45, Vec3::ZERO, Vec3::Z * 1e-45]];
    let tiny_bvh = Bvh::build(&tiny);
    let tracer = Tracer::new(Geometry::plain(&tiny, &[]), &tiny_bvh, None);
    assert!(tracer.occluded(DVec3::new(1e-41, 1e-41, 1e-40), DVec3::NEG_Z, 0.0, 1.0));
    let empty = Tracer::new(Geometry::plain(&[], &[]), &none, None);
    assert!(see(&empty, &look_down(1.0), Film { width: 3, height: 3 }).depths_m.iter().all(|d| d.is_infinite()));
    assert!(see(&empty, &look_down(1.0), Film { width: 0, height: 3 }).triangles.is_empty());
    assert_eq!(RayOffset::for_scene(&empty).metres, 0.0);
}

#[test]
fn many_equal_triangles_make_no_tree_too_deep() {
    let triangles = vec![[Vec3::ZERO, Vec3::X, Vec3::Y]; 5000];
    let bvh = Bvh::build(&triangles);
    let tracer = Tracer::new(Geometry::plain(&triangles, &[]), &bvh, None);
    let hit = tracer.closest(DVec3::new(0.2, 0.2, 1.0), DVec3::NEG_Z, 0.0, 9.0);
    assert_eq!(hit.map(|h| (h.triangle, h.t)), Some((0, 1.0)));
}

#[test]
fn any_number_of_threads_gives_the_same_film() {
    let triangles = [square(3.0, -2.0), sphere(Vec3::ZERO, 1.5, 30)].concat();
    let film = Film { width: 90, height: 70 };
    let (camera, light) = (look_down(6.0), sun(DVec3::new(0.6, -1.0, 0.2)));
    let with_threads = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let bvh = Bvh::build(&triangles);
            let tracer = Tracer::new(Geometry::plain(&triangles, &[]), &bvh, None);
            let view = see(&tracer, &camera, film);
            let answers = classify(&tracer, &view, &camera, &light, RayOffset::for_scene(&tracer));
            (view.triangles, view.depths_m, answers)
        })
    };
    let one = with_threads(1);
    assert!(one.2.contains(&Answer::Shadowed) && one.2.contains(&Answer::Lit));
    assert_eq!(one, with_threads(4));
}

#[test]
fn large_planes_do_not_shadow_themselves_at_grazing_light() {
    let mut seeded = Seeded(Prng::seeded(5));
    let mut asked = 0;
    for _ in 0..200 {
        let (normal, centre) = (seeded.unit(), seeded.point(300.0));
        let (along, across) = normal.any_orthonormal_pair();
        let corner = |a: f64, b: f64| (centre + along * a * 500.0 + across * b * 500.0).as_vec3();
        let [a, b, c, d] = [corner(-1., -1.), corner(-1., 1.), corner(1., 1.), corner(1., -1.)];
        let middle = corner(0.1, 0.2);
        let triangles = [[a, b, middle], [b, c, middle], [c, d, middle], [d, a, middle]];
        let bvh = Bvh::build(&triangles);
        let tracer = Tracer::new(Geometry::plain(&triangles, &[]), &bvh, None);
        let offset = RayOffset::for_scene(&tracer);
        let camera = Camera { position: centre + normal * 50.0, ..toward(-normal) };
        for _ in 0..20 {
            let (x, y) = (100.0 * seeded.next(), 100.0 * seeded.next());
            let Some(surface) = surface_at(&tracer, &camera, Film { width: 100, height: 100 }, x, y) else { continue };
            // From half a degree above the plane: rounding of the corners bends it by much less.
            let light = sun(-(surface.normal * 0.01 + (along * seeded.next() + across * seeded.next()).normalize()));
            assert_eq!(answer(&tracer, &surface, &light, offset), Answer::Lit);
            asked += 1;
        }
    }
    assert!(asked > 3000, "{asked} asked");
}
