//! Time to draw a shadow map of a million triangles, and the same scene for a rival.
//!
//! `cargo bench --bench raster -- [--export FILE] [--sizes 1024,4096] [--threads 2] [--rounds 9] [--depth PREFIX]`
//!
//! Prints one JSON object per size: milliseconds of each round on a canvas that is used again (`reused_ms`, as a GPU keeps
//! its texture and its tile lists) and into a new map (`fresh_ms`). `--export` writes the scene as little-endian values: 16 f64 of
//! the matrix by rows, then 9 f32 a triangle. `--depth PREFIX` writes each map as f32 to `PREFIX<size>.f32`.

use std::error::Error;
use std::hint::black_box;
use std::time::Instant;

use glam::{DMat4, DVec3, DVec4, Vec3};
use lixel::raster::{Bias, Canvas, draw};
use lixel::scene::{Geometry, Triangle};

/// Quads along each side of the ground: half a million triangles.
const GROUND_CELLS: usize = 500;

/// Stones of 2 * 20 * 10 triangles on the ground: the other half million.
const STONES: usize = 1250;
const STONE_RINGS: usize = 10;
const STONE_SECTORS: usize = 20;

/// Seed of the scene.
const SEED: u64 = 20;

/// Half the side of the ground, metres.
const GROUND_HALF_M: f64 = 50.0;

fn main() -> Result<(), Box<dyn Error>> {
    let mut sizes = vec![1024, 4096];
    let (mut threads, mut rounds, mut export, mut depth) = (2, 9, None, None);
    let mut arguments = std::env::args().skip(1).filter(|a| a != "--bench");
    while let Some(flag) = arguments.next() {
        let value = arguments.next().ok_or_else(|| format!("{flag} needs a value"))?;
        match flag.as_str() {
            "--sizes" => sizes = value.split(',').map(str::parse).collect::<Result<_, _>>()?,
            "--threads" => threads = value.parse()?,
            "--rounds" => rounds = value.parse()?,
            "--export" => export = Some(value),
            "--depth" => depth = Some(value),
            _ => return Err(format!("unknown flag {flag}").into()),
        }
    }
    let triangles = scene();
    let clip_from_scene = light();
    if let Some(path) = export {
        let matrix = clip_from_scene.transpose().to_cols_array();
        let mut bytes: Vec<u8> = matrix.iter().flat_map(|m| m.to_le_bytes()).collect();
        bytes.extend(triangles.iter().flatten().flat_map(|v| v.to_array()).flat_map(f32::to_le_bytes));
        std::fs::write(path, bytes)?;
    }
    let geometry = Geometry::plain(&triangles, &[]);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
    for size in sizes {
        let mut canvas = Canvas::default();
        let (mut reused_ms, mut fresh_ms) = (Vec::new(), Vec::new());
        for round in 0..=rounds {
            let start = Instant::now();
            pool.install(|| canvas.draw(geometry, &clip_from_scene, size, size, Bias::NONE, |_| true))?;
            let reused = start.elapsed().as_secs_f64() * 1e3;
            let start = Instant::now();
            black_box(pool.install(|| draw(geometry, &clip_from_scene, size, size, Bias::NONE))?);
            // The first round takes the memory that later ones use again.
            if round > 0 {
                reused_ms.push(reused);
                fresh_ms.push(start.elapsed().as_secs_f64() * 1e3);
            }
        }
        println!(
            "{{\"who\": \"lixel\", \"size\": {size}, \"threads\": {threads}, \"triangles\": {}, \
             \"reused_ms\": {reused_ms:.2?}, \"fresh_ms\": {fresh_ms:.2?}}}",
            triangles.len()
        );
        if let Some(prefix) = &depth {
            let bytes: Vec<u8> = canvas.map.depth.iter().flat_map(|d| d.to_le_bytes()).collect();
            std::fs::write(format!("{prefix}{size}.f32"), bytes)?;
        }
    }
    Ok(())
}

/// Oblique parallel light under a projective warp, so that w varies over the map; the ground fills four fifths of it.
fn light() -> DMat4 {
    // Where a light ray meets y = 0, in half sides of the map, and the depth along the light.
    let half_m = 1.04 * GROUND_HALF_M;
    let plane_from_scene = DMat4::from_cols(
        DVec4::new(1.0 / half_m, 0.0, 0.0, 0.0),
        DVec4::new(0.4 / half_m, 0.3 / half_m, -0.1, 0.0),
        DVec4::new(0.0, 1.0 / half_m, 0.0, 0.0),
        DVec4::W,
    );
    // w from 1 - warp to 1 + warp; the side towards the warp shrinks.
    let warp = 0.25;
    DMat4::from_cols(
        DVec4::new(1.0, 0.0, 0.0, warp),
        DVec4::new(0.0, 1.0 - warp, 0.0, 0.0),
        DVec4::new(0.0, 0.0, 1.0, 0.0),
        DVec4::new(warp, 0.0, 0.0, 1.0),
    ) * plane_from_scene
}

/// Rolling ground strewn with stones: [`GROUND_CELLS`]² * 2 + [`STONES`] * 400 triangles.
fn scene() -> Vec<Triangle> {
    let mut state = SEED;
    let mut random = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let height = |x: f64, z: f64| 2.0 * (0.11 * x).sin() * (0.07 * z).cos() + 0.3 * (0.9 * x + 0.4 * z).sin();
    let ground = |i: usize, j: usize| {
        let along = |k: usize| GROUND_HALF_M * (2.0 * k as f64 / GROUND_CELLS as f64 - 1.0);
        DVec3::new(along(i), height(along(i), along(j)), along(j)).as_vec3()
    };
    let mut triangles = grid(GROUND_CELLS, GROUND_CELLS, ground);
    for _ in 0..STONES {
        let (x, z) = (GROUND_HALF_M * (2.0 * random() - 1.0), GROUND_HALF_M * (2.0 * random() - 1.0));
        let radius = 0.2 + 1.8 * random() * random();
        let (phase, squash) = (6.0 * random(), 0.5 + 0.8 * random());
        let centre = DVec3::new(x, height(x, z) + 0.5 * radius, z);
        triangles.extend(grid(STONE_SECTORS, STONE_RINGS, |i, j| {
            let (azimuth, polar) = (
                std::f64::consts::TAU * (i % STONE_SECTORS) as f64 / STONE_SECTORS as f64,
                std::f64::consts::PI * j as f64 / STONE_RINGS as f64,
            );
            let lumpy = radius * (1.0 + 0.15 * (3.0 * azimuth + phase).sin() * polar.sin());
            let (s, c) = polar.sin_cos();
            (centre + lumpy * DVec3::new(s * azimuth.cos(), squash * c, s * azimuth.sin())).as_vec3()
        }));
    }
    triangles
}

/// Two triangles for each cell of a grid of points.
fn grid(columns: usize, rows: usize, point: impl Fn(usize, usize) -> Vec3) -> Vec<Triangle> {
    let mut triangles = Vec::with_capacity(2 * columns * rows);
    for j in 0..rows {
        for i in 0..columns {
            let (a, b, c, d) = (point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1));
            triangles.extend([[a, c, b], [a, d, c]]);
        }
    }
    triangles
}
