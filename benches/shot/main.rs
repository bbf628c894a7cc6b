//! The cut of long shots into segments: time and memory for many frames and lights of synthetic parts.
//!
//!     cargo bench --bench shot                          10,000 frames, 20 lights
//!     cargo bench --bench shot -- --frames 1000 --lights 3
//!
//! Lights are solved one after another, as in planning; the parts of one light are held at a time. Time is that of
//! `shot::segments`: intervals looked at, the dynamic programme, the segments fitted in full. Memory is the peak of the
//! process, parts included.

mod synthetic;

use lixel::methods::SolverParams;
use lixel::resolution::{MapParams, QualityParams};
use lixel::samples::EdgePoint;
use lixel::scene::{Camera, Film, Light, LightKind, Projection};
use lixel::shot::{Asked, LightPart, LightParts, TemporalParams, segments};
use std::error::Error;
use std::mem::size_of;
use std::time::{Duration, Instant};

/// Edge samples of a frame, as `lixel sample` keeps at most.
const EDGES: usize = 600;
/// Metres a frame: a walk at 24 frames a second.
const STEP_M: f64 = 0.06;

fn main() -> Result<(), Box<dyn Error>> {
    let (frames, lights) = (argument("--frames", 10_000)?, argument("--lights", 20)?);
    let (quality, map) = (QualityParams::default(), MapParams::default());
    let (solver, params) = (SolverParams::default(), TemporalParams::default());
    let asked = Asked { film: Film { width: 1280, height: 720 }, quality: &quality, map: &map, solver: &solver };
    let (mut all, mut cuts) = (Duration::ZERO, Vec::new());
    for light in 0..lights {
        let parts = LightParts::new(synthetic::walk(light as u64, frames, STEP_M, EDGES)).ok_or("no frame")?;
        let start = Instant::now();
        let found = segments(&asked, &parts, &params, 1.0)?;
        all += start.elapsed();
        cuts.push(found.segments.len());
        eprintln!("light {light}: {} segments, {:.2} s", found.segments.len(), start.elapsed().as_secs_f64());
    }
    let bytes = frames * EDGES * size_of::<EdgePoint>();
    println!("{frames} frames x {lights} lights: {:.1} s, segments {cuts:?}", all.as_secs_f64());
    println!("edges of one light {} MB, peak of the process {}", bytes / 1_000_000, peak());
    Ok(())
}

/// A number behind a flag.
fn argument(flag: &str, default: usize) -> Result<usize, Box<dyn Error>> {
    let mut arguments = std::env::args().skip_while(|a| a != flag).skip(1);
    Ok(arguments.next().map_or(Ok(default), |value| value.parse())?)
}

/// Peak resident memory, where the system says.
fn peak() -> String {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"));
    line.map_or("not known".to_owned(), |l| l.trim().to_owned())
}
