//! The order in which a scene lists its triangles does not matter: from triangles to maps.

use crate::fixture::{ALL, Setup, room};
use crate::properties::{difference, lights};
use glam::Vec3;
use lixel::math::Bounds;
use lixel::samples::{Grid, GridView, LightView, sample_light};
use lixel::scene::{Geometry, Triangle};
use lixel::visibility::{Bvh, RayOffset, Tracer};

/// A floor, a wall and a few pillars before it.
fn triangles() -> Vec<Triangle> {
    let mut all = Vec::new();
    let mut quad = |a: Vec3, u: Vec3, v: Vec3| all.extend([[a, a + u, a + u + v], [a, a + u + v, a + v]]);
    quad(Vec3::new(-40.0, 0.0, 20.0), Vec3::X * 80.0, Vec3::NEG_Z * 50.0);
    quad(Vec3::new(-40.0, 0.0, -30.0), Vec3::X * 80.0, Vec3::Y * 20.0);
    for k in 0..9 {
        let k = k as f32;
        let (base, side, height) = (Vec3::new(k * 2.3 - 9.0, 0.0, -5.0 - (k * 3.7) % 19.0), 0.7, 1.0 + (k * 1.3) % 2.5);
        let (x, y, z) = (Vec3::X * side, Vec3::Y * height, Vec3::NEG_Z * side);
        quad(base, x, y);
        quad(base + z, x, y);
        quad(base, z, y);
        quad(base + x, z, y);
        quad(base + y, x, z);
    }
    all
}

/// The room's camera and light over these triangles.
fn sampled(room: &Setup, triangles: &[Triangle]) -> Setup {
    let bvh = Bvh::build(triangles);
    let tracer = Tracer::new(Geometry::plain(triangles, &[]), &bvh, None);
    let view = GridView::see(&tracer, &room.camera, Grid::new(room.film, 60), None);
    let offset = RayOffset::for_scene(&tracer);
    let answers = view.answers(&tracer, &room.camera, &room.light, offset);
    let lit =
        LightView { tracer: &tracer, camera: &room.camera, view: &view, light: &room.light, offset, answers: &answers };
    let samples = sample_light(&lit, 5, false);
    let bounds = Bounds::of(triangles.iter().flatten().map(|v| v.as_dvec3()));
    Setup { bounds, edges: samples.edges, covered: samples.covered, ..room.clone() }
}

#[test]
fn the_order_of_triangles_does_not_matter() {
    let listed = triangles();
    let mut other = listed.clone();
    other.reverse();
    other.rotate_left(31);
    let mut edges = 0;
    for (name, kind) in lights() {
        let room = room().with_light(kind);
        let (a, b) = (sampled(&room, &listed), sampled(&room, &other));
        edges += a.edges.len();
        assert_eq!(a.covered, b.covered, "{name}");
        for method in ALL {
            match (a.solve(method), b.solve(method)) {
                (Ok(x), Ok(y)) => {
                    assert_eq!(difference(method, (&a, &x), (&b, &y), 1e-9), None, "{method:?}, {name}");
                }
                (x, y) => assert_eq!(x.err(), y.err(), "{method:?}, {name}"),
            }
        }
    }
    assert!(edges > 200, "{edges} edges under all lights");
}
