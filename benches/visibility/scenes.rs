//! What the rays are sent into: an authored scene of a million triangles, or the meshes of a glTF file.

use std::path::Path;

use glam::{DMat3, DVec3, Mat4, Vec3};
use lixel::math::Prng;
use lixel::scene::{Camera, Film, Light, LightKind, Projection, Triangle};
use lixel::visibility::Tracer;

use crate::rays::Rays;

/// Triangles, a camera and lights.
pub(crate) struct Workload {
    pub(crate) name: String,
    pub(crate) triangles: Vec<Triangle>,
    camera: Camera,
    lights: Vec<Light>,
}

const FILM: Film = Film { width: 1920, height: 1080 };
impl Workload {
    /// Camera rays through all pixel centres, and shadow rays from what they meet where it faces a light.
    pub(crate) fn rays(&self, tracer: &Tracer) -> Rays {
        Rays::of(tracer, &self.camera, FILM, &self.lights)
    }
}

fn camera(position: DVec3, target: DVec3) -> Camera {
    let backward = (position - target).normalize();
    let right = DVec3::Y.cross(backward).normalize();
    Camera {
        name: "bench".into(),
        position,
        world_from_camera: DMat3::from_cols(right, backward.cross(right), backward),
        projection: Projection::Perspective { yfov_rad: 50f64.to_radians() },
        near: 0.02,
        far: Some(100.0),
    }
}

fn lights(bulb: DVec3) -> Vec<Light> {
    let direction = DVec3::new(0.5, -0.8, 0.3).normalize();
    vec![
        Light { name: "sun".into(), kind: LightKind::Directional { direction } },
        Light { name: "bulb".into(), kind: LightKind::Point { position: bulb, range: None } },
    ]
}

/// Numbers in [0, 1) of f32's 24 bits, the same every time.
struct Seeded(Prng);

impl Seeded {
    fn next(&mut self) -> f32 {
        (self.0.next_u64() >> 40) as f32 / (1u32 << 24) as f32
    }
}

/// Hills of 400k triangles, 150 stones of 3,200, and 120k blades of grass: large and small, fat and thin.
pub(crate) fn authored() -> Workload {
    let mut seeded = Seeded(Prng::seeded(7));
    let height =
        |x: f32, z: f32| 0.25 * (1.7 * x).sin() * (1.3 * z).cos() + 0.06 * (7.1 * x + 1.0).sin() * (6.3 * z).sin();
    let ground = |x: f32, z: f32| Vec3::new(x, height(x, z), z);
    let cells = 447;
    let side = 10.0;
    let at = |i: usize| side * (i as f32 / cells as f32 - 0.5);
    let mut triangles: Vec<Triangle> = Vec::new();
    for (i, j) in (0..cells).flat_map(|i| (0..cells).map(move |j| (i, j))) {
        let [a, b, c, d] = [(i, j), (i, j + 1), (i + 1, j + 1), (i + 1, j)].map(|(i, j)| ground(at(i), at(j)));
        triangles.extend([[a, b, c], [a, c, d]]);
    }
    for _ in 0..150 {
        let (x, z, radius) =
            (side * (seeded.next() - 0.5), side * (seeded.next() - 0.5), 0.05 + 0.4 * seeded.next().powi(3));
        triangles.extend(stone(ground(x, z) + Vec3::Y * radius * 0.5, radius, 40, seeded.next() * 9.0));
    }
    for _ in 0..120_000 {
        let (x, z, turn) = (side * (seeded.next() - 0.5), side * (seeded.next() - 0.5), 6.3 * seeded.next());
        let (foot, wide) = (ground(x, z), 0.004 * Vec3::new(turn.cos(), 0.0, turn.sin()));
        let tip = foot + Vec3::new(0.03 * seeded.next(), 0.06 + 0.08 * seeded.next(), 0.03 * seeded.next());
        triangles.push([foot - wide, foot + wide, tip]);
    }
    Workload {
        name: "authored".into(),
        triangles,
        camera: camera(DVec3::new(0.5, 1.6, 5.0), DVec3::new(0.0, 0.1, 0.0)),
        lights: lights(DVec3::new(1.0, 2.0, 0.5)),
    }
}

/// A bumpy ball.
fn stone(centre: Vec3, radius: f32, rings: usize, phase: f32) -> impl Iterator<Item = Triangle> {
    let vertex = move |i: usize, j: usize| {
        let polar = std::f32::consts::PI * i as f32 / rings as f32;
        let around = std::f32::consts::TAU * (j % rings) as f32 / rings as f32;
        let v = Vec3::new(polar.sin() * around.cos(), polar.cos(), polar.sin() * around.sin());
        centre + radius * (1.0 + 0.15 * (5.0 * v.x + phase).sin() * (4.0 * v.y + phase).cos()) * v
    };
    (0..rings).flat_map(move |i| (0..rings).map(move |j| (i, j))).flat_map(move |(i, j)| {
        let [a, b, c, d] = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| vertex(i, j));
        [[a, b, c], [a, c, d]]
    })
}

/// The meshes of a binary glTF file, seen from outside its bounds.
pub(crate) fn from_glb(path: &Path) -> Result<Workload, Box<dyn std::error::Error>> {
    let gltf = gltf::Gltf::from_slice(&std::fs::read(path)?)?;
    let blob = gltf.blob.as_deref().ok_or("the glTF file has no binary chunk")?;
    let mut triangles = Vec::new();
    for scene in gltf.document.scenes() {
        for node in scene.nodes() {
            add_node(&node, Mat4::IDENTITY, blob, &mut triangles);
        }
    }
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let (camera, lights) =
        (camera(DVec3::new(0.8, 2.4, 5.2), DVec3::new(0.0, 0.6, 0.0)), lights(DVec3::new(2.2, 4.4, 1.2)));
    Ok(Workload { name, triangles, camera, lights })
}

fn add_node(node: &gltf::Node, parent: Mat4, blob: &[u8], triangles: &mut Vec<Triangle>) {
    let world = parent * Mat4::from_cols_array_2d(&node.transform().matrix());
    for primitive in node.mesh().iter().flat_map(|mesh| mesh.primitives()) {
        let reader = primitive.reader(|_| Some(blob));
        let vertices: Vec<Vec3> =
            reader.read_positions().into_iter().flatten().map(|p| world.transform_point3(p.into())).collect();
        let indices: Vec<u32> = match reader.read_indices() {
            Some(indices) => indices.into_u32().collect(),
            None => (0..vertices.len() as u32).collect(),
        };
        triangles.extend(indices.chunks_exact(3).map(|t| [0, 1, 2].map(|k| vertices[t[k] as usize])));
    }
    node.children().for_each(|child| add_node(&child, world, blob, triangles));
}
