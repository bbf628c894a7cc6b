//! Writes the floor: 36 objects of some 31,000 triangles each on or near a floor, as in the experiments of "Scene-optimised
//! shadow mapping" (section 3: "a few dozen objects on or near a floor", 1,137,772 triangles). It is large, so it does not
//! ship: `cargo run --release --example floor -- floor.glb [SEED]`

#[path = "../authoring/mod.rs"]
mod authoring;
mod objects;
mod shot;

use authoring::document::{Content, Document, Placement};
use authoring::mesh::Mesh;
use glam::{DQuat, dvec3};
use lixel::math::Prng;
use std::f64::consts::TAU;
use std::process::ExitCode;

/// Objects along each side of the square they stand in.
const ROWS: u32 = 6;
/// Distance between neighbours, metres.
const PITCH_M: f64 = 3.2;
/// How far an object may stand from its place in the grid, metres.
const JITTER_M: f64 = 0.8;
/// Half the side of the floor, metres.
const FLOOR_M: f64 = 30.0;
/// The seed when none is given.
const SEED: u64 = 1;

fn main() -> ExitCode {
    let mut arguments = std::env::args_os().skip(1);
    let path = arguments.next();
    let seed = match arguments.next().map(|s| s.to_str().and_then(|s| s.parse().ok())) {
        None => Some(SEED),
        Some(seed) => seed,
    };
    let (Some(path), Some(seed)) = (path, seed) else {
        eprintln!("usage: floor OUTPUT.glb [SEED]");
        return ExitCode::from(2);
    };
    match scene(seed).and_then(|bytes| std::fs::write(&path, bytes)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{}: {error}", path.display());
            ExitCode::FAILURE
        }
    }
}

/// The bytes of the scene: the same for the same seed.
fn scene(seed: u64) -> std::io::Result<Vec<u8>> {
    let mut doc = Document::default();
    let grey = doc.material("floor", [0.6, 0.6, 0.6], 0.0, 0.9);
    let clay = doc.material("clay", [0.7, 0.5, 0.35], 0.0, 0.8);
    let mut floor = Mesh::default();
    let corner = |x: f64, z: f64| dvec3(FLOOR_M * x, 0.0, FLOOR_M * z);
    floor.add_quad([corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0), corner(-1.0, -1.0)]);
    let floor = doc.mesh("floor", grey, &floor);
    let mut roots = vec![doc.node("floor", Content::Mesh(floor), Placement::default(), vec![])];
    let kinds = objects::all(&mut doc, clay);
    let mut prng = Prng::seeded(seed);
    for i in 0..ROWS * ROWS {
        let along = |k: u32| PITCH_M * (f64::from(k) - 0.5 * f64::from(ROWS - 1));
        let (kind, lift) = kinds[prng.between(0.0, kinds.len() as f64) as usize];
        let size = prng.between(0.6, 1.5);
        // A fifth of the objects hangs over the floor.
        let height = if prng.between(0.0, 1.0) < 0.2 { prng.between(0.3, 1.5) } else { 0.0 };
        let place = Placement {
            translation: dvec3(
                along(i % ROWS) + prng.between(-JITTER_M, JITTER_M),
                lift * size + height,
                along(i / ROWS) + prng.between(-JITTER_M, JITTER_M),
            ),
            rotation: DQuat::from_rotation_y(prng.between(0.0, TAU)),
            scale: dvec3(size, size, size),
        };
        roots.push(doc.node(format!("object {}", i + 1), Content::Mesh(kind), place, vec![]));
    }
    roots.push(shot::sun(&mut doc));
    roots.push(shot::camera(&mut doc));
    doc.into_glb("floor", &roots)
}
