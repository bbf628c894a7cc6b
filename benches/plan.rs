//! A draft plan of one frame, light by light, against exact film-resolution classification of the same frame.
//!
//!     cargo bench --bench plan                                       frame 30 of the courtyard
//!     LIXEL_BENCH_GLB=scene.glb cargo bench --bench plan             and frame 30 of this one
//!
//! The scene is loaded and its trees are built. Draft: the planning grid, the shadow edges, the fit, lookups by rays, a
//! second fit, the size, the depth rows, with the settings of `configs/draft.toml`. Exact: one ray through each of 1920 × 1080 pixels and one shadow ray from
//! each that faces the light. Both use all threads, round about round; the ratio is taken in each round.

use std::cell::Cell;
use std::error::Error;
use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

use glam::DVec3;
use lixel::depth::Visible;
use lixel::job::{Job, load};
use lixel::math::Bounds;
use lixel::measure::{Receivers, Seen};
use lixel::methods::Region;
use lixel::resolution::{FilmQuestion, FittedLight, JudgedMap, Sampled, Unmeasured};
use lixel::samples::{Grid, GridView, LightView, sample_light};
use lixel::scene::{self, Film, Light, SceneFrame, Shot, ShotParams};
use lixel::visibility::{Answer, Bvh, RayOffset, Tracer, see};

/// Rounds of each light.
const ROUNDS: usize = 9;
/// Settings of a draft, over those of the input.
const DRAFT: &str = "preset = \"draft\"\nframes.range = \"30\"\nimage.size = [1920, 1080]";

fn main() -> Result<(), Box<dyn Error>> {
    run(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/courtyard/courtyard.toml")))?;
    if let Some(path) = std::env::var_os("LIXEL_BENCH_GLB") {
        run(Path::new(&path))?;
    }
    Ok(())
}

fn run(input: &Path) -> Result<(), Box<dyn Error>> {
    let loaded = load(input, &DRAFT.parse()?)?;
    let job = &loaded.job;
    let shot = scene::load(&ShotParams {
        scene: &loaded.scene_files(),
        active_scene: job.active_scene.as_deref(),
        animation: job.animation.as_deref(),
        frames: &job.frames,
        image: &job.image,
        camera: &loaded.camera(),
        lights: &job.light,
        visibility: &job.visibility,
        allow_outside: false,
        images: None,
    })?;
    let time = shot.frames.first().ok_or("no frame")?;
    let frame = shot.scene.frame(time.time_s)?;
    let geometry = shot.scene.geometry(&frame);
    let (still, moving) = (Bvh::still(&shot.scene), Bvh::moving(&shot.scene, &frame));
    let tracer = Tracer::new(geometry, &still, moving.as_ref());
    for light in &frame.lights {
        let name = format!("{} {}", input.file_stem().unwrap_or_default().display(), light.name);
        compare(&name, &shot, &frame, &tracer, light, job)?;
    }
    Ok(())
}

fn compare(
    name: &str,
    shot: &Shot,
    frame: &SceneFrame,
    tracer: &Tracer,
    light: &Light,
    job: &Job,
) -> Result<(), Box<dyn Error>> {
    let offset = RayOffset::for_scene(tracer);
    let (mut draft_ms, mut exact_ms, mut ratios) = (Vec::new(), Vec::new(), Vec::new());
    let mut parts: [Vec<f64>; 3] = Default::default();
    let mut said = String::new();
    for round in 0..=ROUNDS {
        let draft = draft(shot.film, frame, tracer, light, job)?;
        let start = Instant::now();
        let view = see(tracer, &frame.camera, shot.film);
        let exact = black_box(Receivers::classify(tracer, &view, &frame.camera, light, offset));
        let ms = start.elapsed().as_secs_f64() * 1e3;
        // The first round takes the memory that later ones use again.
        if round > 0 {
            let sum: f64 = draft.parts_ms.iter().sum();
            draft_ms.push(sum);
            exact_ms.push(ms);
            ratios.push(sum / ms);
            parts.iter_mut().zip(draft.parts_ms).for_each(|(all, part)| all.push(part));
        }
        said = format!("\"edges\": {}, \"maps\": {:?}, \"receivers\": {}", draft.edges, draft.sizes, exact.len());
    }
    let [rays, fit, depth] = parts.map(|p| median(&p));
    println!(
        "{{\"light\": \"{name}\", \"triangles\": {}, {said}, \"draft_ms\": {:.2}, \"rays_ms\": {rays:.2}, \"fit_ms\": \
         {fit:.2}, \"depth_ms\": {depth:.2}, \"exact_ms\": {:.1}, \"ratio\": {:.4}, \"ratios\": {ratios:.4?}}}",
        tracer.geometry().len(),
        median(&draft_ms),
        median(&exact_ms),
        median(&ratios)
    );
    Ok(())
}

struct Draft {
    /// Rays; fits, lookups and size; depth rows.
    parts_ms: [f64; 3],
    edges: usize,
    /// Sizes of the maps; none when the light casts no visible shadow.
    sizes: Vec<[u32; 2]>,
}

/// The stages of a draft plan, as `lixel plan` runs them.
fn draft(film: Film, frame: &SceneFrame, tracer: &Tracer, light: &Light, job: &Job) -> Result<Draft, Box<dyn Error>> {
    let start = Instant::now();
    let corners = tracer.bounds().into_iter().flatten();
    let offset = RayOffset::for_scene(tracer);
    let grid = GridView::see(tracer, &frame.camera, Grid::new(film, job.sampling.grid), None);
    let answers = grid.answers(tracer, &frame.camera, light, offset);
    let lit = LightView { tracer, camera: &frame.camera, view: &grid, light, offset, answers: &answers };
    let samples = sample_light(&lit, job.sampling.refine, false);
    // The visible points that depth rows, lookups and witnesses are made from.
    let seen: Vec<Seen> = (0..answers.len())
        .filter(|i| answers[*i] != Answer::Unlit)
        .filter_map(|i| {
            let surface = grid.surface(tracer, &frame.camera, i)?;
            Some(Seen { position: surface.position, normal: surface.normal, shadowed: answers[i] == Answer::Shadowed })
        })
        .collect();
    let receivers: Vec<DVec3> = seen.iter().map(|s| s.position).collect();
    let mut draft = Draft { parts_ms: [lap(start), 0.0, 0.0], edges: samples.edges.len(), sizes: Vec::new() };
    if samples.shadowed == 0 {
        return Ok(draft);
    }
    let start = Instant::now();
    let question = FilmQuestion {
        camera: &frame.camera,
        film,
        light,
        bounds: Bounds::of(corners),
        quality: &job.quality,
        map: &job.map,
        solver: &job.solver,
        sample_cap: job.sampling.cap as usize,
    };
    let rows_ms = Cell::new(0.0);
    let maps_of = |fitted: &FittedLight| {
        let start = Instant::now();
        let kept = |region: &Region, own: &[DVec3]| JudgedMap::kept(region, tracer, &Visible::new(own));
        let maps = JudgedMap::of_all_by(&fitted.regions, &receivers, kept);
        rows_ms.set(rows_ms.get() + lap(start));
        maps
    };
    let sampled = Sampled::new(&question, tracer, &seen, grid.grid.len());
    let unmeasured =
        Unmeasured { question: &question, receivers: &receivers, sampled: sampled.as_ref(), maps_of: &maps_of };
    draft.sizes = black_box(unmeasured.planned(&samples, None)?).certified.sizes;
    draft.parts_ms[1] = lap(start) - rows_ms.get();
    draft.parts_ms[2] = rows_ms.get();
    Ok(draft)
}

fn lap(start: Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1e3
}

fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(f64::NAN)
}
