//! Rays per second, one thread: primary rays of a 1920 × 1080 view and the shadow rays of its lights.
//!
//!     cargo bench --bench visibility                          the authored scene
//!     LIXEL_BENCH_GLB=scene.glb cargo bench --bench visibility           and this one (plain meshes, camera below)
//!     cargo bench --bench visibility -- --rival PROGRAM [ARGUMENT]       against `benches/embree`, pass about pass
//!
//! Every figure is the median of the passes; ratios are taken pass by pass, then their median. Answers that differ from
//! the rival's are counted.

mod rays;
mod rival;
mod scenes;

use std::path::PathBuf;
use std::time::Instant;

use lixel::scene::Geometry;
use lixel::visibility::{Bvh, Tracer};
use scenes::Workload;

/// Passes over all rays.
const PASSES: usize = 7;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip_while(|a| a != "--rival").skip(1).collect();
    let program = arguments.first().map(PathBuf::from);
    let extra = arguments.get(1).map_or("1", String::as_str);
    let mut workloads = vec![scenes::authored()];
    if let Some(path) = std::env::var_os("LIXEL_BENCH_GLB") {
        workloads.push(scenes::from_glb(&PathBuf::from(path))?);
    }
    for workload in workloads {
        run(&workload, program.as_deref().map(|p| (p, extra)))?;
    }
    Ok(())
}

fn run(workload: &Workload, rival: Option<(&std::path::Path, &str)>) -> Result<(), Box<dyn std::error::Error>> {
    let triangles = &workload.triangles;
    let builds: Vec<f64> = (0..3).map(|_| milliseconds(|| drop(std::hint::black_box(Bvh::build(triangles))))).collect();
    let bvh = Bvh::build(triangles);
    let tracer = Tracer::new(Geometry::plain(triangles, &[]), &bvh, None);
    let rays = workload.rays(&tracer);
    println!(
        "{}: {} triangles, {} closest-hit rays, {} any-hit rays",
        workload.name,
        triangles.len(),
        rays.closest.len(),
        rays.any.len()
    );
    let mut rival =
        rival.map(|(program, extra)| rival::Rival::start(program, &[extra], triangles, &rays)).transpose()?;
    let mut rows = [("build", vec![], vec![]), ("closest", vec![], vec![]), ("any", vec![], vec![])];
    for pass in 0..PASSES {
        let mut closest = vec![-1i32; rays.closest.len()];
        let closest_ms = milliseconds(|| rays.trace_closest(&tracer, &mut closest));
        let mut any = vec![0i32; rays.any.len()];
        let any_ms = milliseconds(|| rays.trace_any(&tracer, &mut any));
        if pass == 0 {
            println!("  answers {:016x}", fingerprint(closest.iter().chain(&any)));
        }
        rows[1].1.push(closest_ms);
        rows[2].1.push(any_ms);
        if let Some(rival) = &mut rival {
            rows[1].2.push(rival.pass("closest")? * 1e-6);
            rows[2].2.push(rival.pass("any")? * 1e-6);
            if pass == 0 {
                rows[0].2 = (0..3).map(|_| rival.pass("build")).collect::<Result<_, _>>()?;
                println!("  differing answers: {}", rival.differences(&closest, &any)?);
            }
        }
    }
    rows[0].1 = builds;
    let counts = [0, rays.closest.len(), rays.any.len()];
    for ((what, ours, theirs), count) in rows.iter().zip(counts) {
        print!("  {what:8} {}", figure(ours, count));
        if !theirs.is_empty() {
            let ratios: Vec<f64> = ours.iter().zip(theirs).map(|(a, b)| b / a).collect();
            print!("   rival {}   ratio of speeds {:.3}", figure(theirs, count), median(&ratios));
        }
        println!();
    }
    Ok(())
}

/// FNV-1a: the same on every machine, with every instruction set and number of threads.
fn fingerprint<'a>(answers: impl Iterator<Item = &'a i32>) -> u64 {
    answers.fold(0xcbf2_9ce4_8422_2325, |hash, &answer| (hash ^ u64::from(answer as u32)).wrapping_mul(0x100_0000_01b3))
}

fn milliseconds(work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    start.elapsed().as_secs_f64() * 1e3
}

fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(f64::NAN)
}

/// Milliseconds, or millions of rays per second when there are rays.
fn figure(milliseconds: &[f64], rays: usize) -> String {
    let median = median(milliseconds);
    if rays == 0 { format!("{median:8.1} ms") } else { format!("{:8.3} M rays/s", rays as f64 * 1e-3 / median) }
}
