//! Loading a scene against what any reader has to do: reading the file and decoding it.
//!
//!     LIXEL_BENCH_GLB=scene.glb cargo bench --bench load
//!
//! Decoder: the `gltf` crate parses the document, and positions and indices of all primitives are collected, with
//! one thread and, primitive beside primitive, with all. Load: `scene::load`, which also checks, poses and places every
//! triangle. Both read the same file, which the system has in memory, round about round.

use std::error::Error;
use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::time::Instant;

use lixel::scene::{
    self, CameraParams, FramesParams, ImageParams, LightKindName, LightParams, ShotParams, VisibilityParams,
};
use rayon::prelude::*;

/// Rounds; medians count.
const ROUNDS: usize = 7;

fn main() -> Result<(), Box<dyn Error>> {
    let courtyard = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/courtyard/courtyard.glb");
    let path = std::env::var_os("LIXEL_BENCH_GLB").map_or_else(|| courtyard.into(), PathBuf::from);
    let mut seconds: [Vec<f64>; 4] = Default::default();
    for _ in 0..ROUNDS {
        let works: [&dyn Fn() -> Result<usize, Box<dyn Error>>; 4] =
            [&|| Ok(std::fs::read(&path)?.len()), &|| decode(&path, false), &|| decode(&path, true), &|| load(&path)];
        for (seconds, work) in seconds.iter_mut().zip(works) {
            let begin = Instant::now();
            black_box(work()?);
            seconds.push(begin.elapsed().as_secs_f64());
        }
    }
    let [read, decoded, beside, loaded] = seconds.map(|mut seconds| {
        seconds.sort_by(f64::total_cmp);
        seconds[ROUNDS / 2]
    });
    println!("{}: {} triangles, medians of {ROUNDS} rounds", path.display(), load(&path)?);
    println!("read {read:.3} s; read and decoded {decoded:.3} s, with all threads {beside:.3} s; loaded {loaded:.3} s");
    println!("loaded / read and decoded: {:.2}, {:.2} with all threads", loaded / decoded, loaded / beside);
    Ok(())
}

/// Reads and decodes; how many vertices and indices there are.
fn decode(path: &Path, beside: bool) -> Result<usize, Box<dyn Error>> {
    let gltf::Gltf { document, blob } = gltf::Gltf::open(path)?;
    let blob = blob.ok_or("not a GLB with its buffer inside")?;
    let primitives: Vec<_> = document.meshes().flat_map(|mesh| mesh.primitives().collect::<Vec<_>>()).collect();
    let one = |primitive: &gltf::Primitive| {
        let reader = primitive.reader(|buffer| (buffer.index() == 0).then_some(blob.as_slice()));
        let vertices: Vec<[f32; 3]> = reader.read_positions().into_iter().flatten().collect();
        let indices: Vec<u32> = reader.read_indices().map(|i| i.into_u32().collect()).unwrap_or_default();
        black_box((&vertices, &indices));
        vertices.len() + indices.len()
    };
    Ok(if beside { primitives.par_iter().map(one).sum() } else { primitives.iter().map(one).sum() })
}

/// Loads; how many triangles there are at the first frame.
fn load(path: &Path) -> Result<usize, Box<dyn Error>> {
    let sun = LightParams {
        name: "sun".into(),
        kind: Some(LightKindName::Directional),
        direction: Some([0.3, -1.0, 0.2]),
        ..LightParams::default()
    };
    let shot = scene::load(&ShotParams {
        scene: &[path.into()],
        active_scene: None,
        animation: None,
        frames: &FramesParams { range: Some("1".into()), ..FramesParams::default() },
        image: &ImageParams::default(),
        camera: &CameraParams { frame_all: true, ..CameraParams::default() },
        lights: &[sun],
        visibility: &VisibilityParams::default(),
        allow_outside: false,
    })?;
    let frame = shot.scene.frame(shot.frames[0].time_s)?;
    Ok(shot.scene.geometry(&frame).len())
}
