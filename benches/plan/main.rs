//! A plan of one frame, light by light, against exact film-resolution classification of the same frame.
//!
//!     cargo bench --bench plan                                       frame 30 of the courtyard
//!     LIXEL_BENCH_GLB=scene.glb cargo bench --bench plan             and of this scene
//!     LIXEL_BENCH_FRAME=45 …                                         another frame
//!     cargo bench --bench plan -- --rival PROGRAM                    `benches/embree`: the rays of the classification alone
//!
//! The scene is loaded and its trees are built. Everything uses all threads, round about round; ratios are taken in each
//! round. Draft: `draft.rs`. Certified: `certified.rs`. Exact: one ray through each of 1920 × 1080 pixels and one shadow ray
//! from each that faces the light. The rival sends the same rays, prepared beforehand.

mod certified;
mod draft;
#[path = "../visibility/rays.rs"]
mod rays;
#[path = "../visibility/rival.rs"]
mod rival;

use std::error::Error;
use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::time::Instant;

use lixel::job::{Job, load};
use lixel::math::Bounds;
use lixel::measure::Receivers;
use lixel::resolution::FilmQuestion;
use lixel::scene::{Film, Light, SceneFrame};
use lixel::visibility::{Bvh, RayOffset, Tracer, see};
use rays::Rays;
use rival::Rival;

/// Rounds of each light.
const ROUNDS: usize = 9;

/// A light of a frame.
struct Case<'a> {
    film: Film,
    frame: &'a SceneFrame,
    tracer: &'a Tracer<'a>,
    offset: RayOffset,
    light: &'a Light,
    /// A draft's settings.
    job: &'a Job,
}

fn main() -> Result<(), Box<dyn Error>> {
    let rival: Option<PathBuf> = std::env::args().skip_while(|a| a != "--rival").nth(1).map(PathBuf::from);
    run(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/courtyard/courtyard.toml")), rival.as_deref())?;
    if let Some(path) = std::env::var_os("LIXEL_BENCH_GLB") {
        run(Path::new(&path), rival.as_deref())?;
    }
    Ok(())
}

fn run(input: &Path, rival: Option<&Path>) -> Result<(), Box<dyn Error>> {
    let frame = std::env::var("LIXEL_BENCH_FRAME").unwrap_or_else(|_| "30".to_owned());
    let settings = format!("preset = \"draft\"\nframes.range = \"{frame}\"\nimage.size = [1920, 1080]");
    let loaded = load(input, &settings.parse()?)?;
    let job = &loaded.job;
    let shot = loaded.shot()?;
    let time = shot.frames.first().ok_or("no frame")?;
    let frame = shot.scene.frame(time.time_s)?;
    let geometry = shot.scene.geometry(&frame);
    let (still, moving) = (Bvh::still(&shot.scene), Bvh::moving(&shot.scene, &frame));
    let tracer = Tracer::new(geometry, &still, moving.as_ref());
    for light in &frame.lights {
        let name = format!("{} {}", input.file_stem().unwrap_or_default().display(), light.name);
        let offset = RayOffset::for_scene(&tracer);
        let case = Case { film: shot.film, frame: &frame, tracer: &tracer, offset, light, job };
        let rival = rival.map(|program| case.rival(program)).transpose()?;
        case.compare(&name, rival)?;
    }
    Ok(())
}

impl Case<'_> {
    fn question<'b>(&'b self, job: &'b Job) -> FilmQuestion<'b> {
        FilmQuestion {
            camera: &self.frame.camera,
            film: self.film,
            light: self.light,
            bounds: Bounds::of(self.tracer.bounds().into_iter().flatten()),
            quality: &job.quality,
            map: &job.map,
            solver: &job.solver,
            sample_cap: job.sampling.cap as usize,
        }
    }

    /// The rays of the classification, on as many threads as here.
    fn rival(&self, program: &Path) -> Result<Rival, Box<dyn Error>> {
        let geometry = self.tracer.geometry();
        let triangles: Vec<_> = (0..geometry.len() as u32).map(|i| geometry.triangle(i)).collect();
        let rays = Rays::of(self.tracer, &self.frame.camera, self.film, std::slice::from_ref(self.light));
        let (mut closest, mut any) = (vec![0; rays.closest.len()], vec![0; rays.any.len()]);
        rays.trace_closest(self.tracer, &mut closest);
        rays.trace_any(self.tracer, &mut any);
        let mut rival = Rival::start(program, &["1", &rayon::current_num_threads().to_string()], &triangles, &rays)?;
        for what in ["closest", "any"] {
            rival.pass(what)?;
        }
        println!("{}: differing answers: {}", self.light.name, rival.differences(&closest, &any)?);
        Ok(rival)
    }

    fn exact(&self) -> Receivers {
        let view = see(self.tracer, &self.frame.camera, self.film);
        Receivers::classify(self.tracer, &view, &self.frame.camera, self.light, self.offset)
    }

    fn compare(&self, name: &str, mut rival: Option<Rival>) -> Result<(), Box<dyn Error>> {
        let [mut drafts, mut certified, mut exact, mut rivals] = [const { Vec::new() }; 4];
        let mut parts: [Vec<f64>; 3] = Default::default();
        let mut said = String::new();
        for round in 0..=ROUNDS {
            let draft = self.draft()?;
            let start = Instant::now();
            let receivers = black_box(self.exact());
            let exact_ms = lap(start);
            let start = Instant::now();
            let whole = self.certified()?;
            let certified_ms = lap(start);
            let rival_ms =
                rival.as_mut().map(|r| Ok::<_, Box<dyn Error>>((r.pass("closest")? + r.pass("any")?) * 1e-6));
            let rival_ms = rival_ms.transpose()?;
            // The first round takes the memory that later ones use again.
            if round > 0 {
                drafts.push(draft.parts_ms.iter().sum());
                parts.iter_mut().zip(draft.parts_ms).for_each(|(all, part)| all.push(part));
                certified.push(certified_ms);
                exact.push(exact_ms);
                rivals.extend(rival_ms);
            }
            said = format!(
                "\"edges\": {}, \"draft\": {:?}, \"certified\": {whole}, \"receivers\": {}",
                draft.edges,
                draft.sizes,
                receivers.len()
            );
        }
        let [rays, fit, depth] = parts.map(|p| median(&p));
        let figures = [
            ("draft_ms", median(&drafts)),
            ("rays_ms", rays),
            ("fit_ms", fit),
            ("depth_ms", depth),
            ("exact_ms", median(&exact)),
            ("draft_over_exact", ratio(&drafts, &exact)),
            ("certified_ms", median(&certified)),
            ("rival_ms", median(&rivals)),
            ("draft_over_rival", ratio(&drafts, &rivals)),
            ("exact_over_rival", ratio(&exact, &rivals)),
            ("certified_over_rival", ratio(&certified, &rivals)),
        ];
        let figures = figures.iter().filter(|(_, value)| value.is_finite());
        let figures: Vec<String> = figures.map(|(what, value)| format!("\"{what}\": {value:.3}")).collect();
        println!(
            "{{\"light\": \"{name}\", \"triangles\": {}, {said}, {}}}",
            self.tracer.geometry().len(),
            figures.join(", ")
        );
        Ok(())
    }
}

fn lap(start: Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1e3
}

/// The median of the rounds' ratios; NaN without rounds.
fn ratio(a: &[f64], b: &[f64]) -> f64 {
    let ratios: Vec<f64> = a.iter().zip(b).map(|(a, b)| a / b).collect();
    median(&ratios)
}

fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(f64::NAN)
}
