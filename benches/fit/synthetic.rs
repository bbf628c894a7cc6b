//! A frame made up for the benchmark: a floor and a wall behind it, a parallel light, shadow edges all over both.

use glam::{DMat3, DVec2, DVec3};
use lixel::fit::{Aspect, Shape, normalise};
use lixel::math::{Bounds, LightSpace, convex_hull};
use lixel::methods::{Inputs, SolverParams};
use lixel::metric::{EdgeSamples, volume};
use lixel::samples::EdgePoint;
use lixel::scene::{Camera, Film, Light, LightKind, Projection};

/// Covered points: few, so that their hull weighs nothing in either fit.
const COVERED: usize = 1000;
/// Film of the frame.
const FILM: Film = Film { width: 1920, height: 1080 };

/// Edges of one light in one frame.
pub(crate) struct Scene {
    camera: Camera,
    light: Light,
    /// Shadow edges.
    pub(crate) edges: Vec<EdgePoint>,
    covered: Vec<DVec3>,
    solver: SolverParams,
}

impl Scene {
    /// With `count` edge points.
    pub(crate) fn new(count: usize) -> Scene {
        let (sin, cos) = 0.35_f64.sin_cos();
        let camera = Camera {
            name: "made up".to_owned(),
            position: DVec3::new(0.0, 3.0, 10.0),
            // Looking along -z, 20 degrees down.
            world_from_camera: DMat3::from_cols(DVec3::X, DVec3::new(0.0, cos, -sin), DVec3::new(0.0, sin, cos)),
            projection: Projection::Perspective { yfov_rad: 0.9 },
            near: 0.1,
            far: None,
        };
        let direction = DVec3::new(0.5, -0.8, -0.3).normalize();
        let light = Light { name: "sun".to_owned(), kind: LightKind::Directional { direction } };
        let mut random = Random(7);
        let edges: Vec<EdgePoint> = (0..count)
            .map(|_| {
                let film = [random.next() * f64::from(FILM.width), random.next() * f64::from(FILM.height)];
                let at = |dx: f64, dy: f64| surface(&camera, film[0] + dx, film[1] + dy, film[1]);
                EdgePoint {
                    film,
                    position: at(0.0, 0.0),
                    derivatives: [at(0.5, 0.0) - at(-0.5, 0.0), at(0.0, 0.5) - at(0.0, -0.5)],
                    normal: DVec2::from_angle(std::f64::consts::TAU * random.next()),
                    length_px: 4.0 * (0.2 + random.next()),
                    room_px: 60.0 * random.next() + 1.0,
                    uncertain: false,
                }
            })
            .collect();
        let covered = (0..COVERED).map(|k| edges[k * count / COVERED].position).collect();
        Scene { camera, light, edges, covered, solver: SolverParams::default() }
    }

    /// What a method gets.
    pub(crate) fn inputs(&self) -> Inputs<'_> {
        Inputs {
            camera: &self.camera,
            film: FILM,
            light: &self.light,
            bounds: Bounds::of(self.edges.iter().map(|e| e.position)),
            edges: &self.edges,
            covered: &self.covered,
            hull_only: false,
            clip: &[],
            texels: 512.0 * 512.0,
            aspect: Aspect::Free,
            shape: Shape::Projective,
            solver: &self.solver,
            sample_cap: usize::MAX,
        }
    }

    /// The samples and the covered hull in the light plane.
    pub(crate) fn in_plane(&self) -> (EdgeSamples, Vec<DVec2>) {
        let (Some(space), mut samples) = (LightSpace::around(&self.light, &self.covered).ok(), EdgeSamples::default())
        else {
            return Default::default();
        };
        let points: Vec<DVec2> = self.covered.iter().map(|p| space.q(*p).truncate()).collect();
        let hull = convex_hull(&points);
        let Some(normalisation) = normalise(&hull) else { return Default::default() };
        for edge in &self.edges {
            let (q, t) = normalisation.vectors(space.q(edge.position), edge.derivatives.map(|d| space.dq(d)));
            let size = q.length() * t[0].length() * t[1].length();
            samples.push(q, t, volume(q, t, size), &edge.into());
        }
        (samples, hull.iter().map(|p| normalisation.point(*p)).collect())
    }
}

/// The floor y = 0, or the wall z = -12 in the upper part of the film.
fn surface(camera: &Camera, x: f64, y: f64, y_of_pixel: f64) -> DVec3 {
    let (origin, direction) = camera.ray(FILM, x, y);
    let t = if y_of_pixel < 0.45 * f64::from(FILM.height) {
        (-12.0 - origin.z) / direction.z
    } else {
        -origin.y / direction.y
    };
    origin + direction * t
}

/// A linear congruential generator (Knuth's constants), values in [0, 1).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}
