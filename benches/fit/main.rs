//! What a fit costs: one evaluation of the metric, and the complete fit against Algorithm 1 of scene-optimised shadow
//! mapping as its paper does it.
//!
//!     cargo bench --bench fit                        all
//!     cargo bench --bench fit -- --rounds 31         more rounds of the complete fit
//!
//! One thread. Evaluations are timed by divan; the complete fits round about round, and the ratio is taken in each round.

mod rival;
mod synthetic;

use std::hint::black_box;
use std::time::Instant;

use divan::Bencher;
use glam::DVec3;
use lixel::fit::{Aspect, Shape, fit_affine};
use lixel::math::support_subset;
use lixel::methods::{Inputs, Method, SolverParams, solve};
use lixel::metric::{Metric, Moments, cost_and_moments, moments_of};
use lixel::samples::SamplingParams;
use synthetic::Scene;

/// Edge samples of a coarse and of a full look at a frame.
const COUNTS: [usize; 2] = [5_000, 100_000];
/// Vertices of the hull of an affine step: as many as the search sees at most.
const VERTICES: usize = 24;

/// Rows near the optimum of the synthetic scene, in texels.
const ROWS: [DVec3; 3] = [DVec3::new(200.0, 20.0, 5.0), DVec3::new(-30.0, 180.0, 9.0), DVec3::new(0.2, -0.3, 1.0)];

fn main() {
    let mut arguments = std::env::args().skip_while(|a| a != "--rounds").skip(1);
    let rounds = arguments.next().and_then(|n| n.parse().ok()).unwrap_or(15);
    if !std::env::args().any(|a| a == "--rounds") {
        divan::main();
    }
    for count in COUNTS {
        let scene = Scene::new(count);
        let standard = SolverParams::default();
        race(&scene, "saturating, standard, all samples", &standard, count, rounds);
        race(&scene, "saturating, standard", &standard, SamplingParams::default().cap as usize, rounds);
        race(&scene, "L2, as the rival", &SolverParams { metric: Metric::L2, ..standard.clone() }, count, rounds);
    }
}

#[divan::bench(args = COUNTS)]
fn moments_value(bencher: Bencher, count: usize) {
    let moments = moments(count, Metric::L2);
    bencher.bench_local(|| black_box(&moments).value(black_box(&ROWS)));
}

#[divan::bench(args = COUNTS)]
fn affine_step(bencher: Bencher, count: usize) {
    let moments = moments(count, Metric::L2);
    let hull = support_subset(&Scene::new(count).in_plane().1, VERTICES);
    let rows = [DVec3::X, DVec3::Y, ROWS[2]];
    bencher.bench_local(|| fit_affine(black_box(&moments), &hull, black_box(&rows), Aspect::Free, Shape::Projective));
}

/// One pass over the samples, for comparison: what a round of reweighting costs.
#[divan::bench(args = COUNTS)]
fn reweighting_pass(bencher: Bencher, count: usize) {
    let (samples, _) = Scene::new(count).in_plane();
    bencher.bench_local(|| cost_and_moments(black_box(&samples), Metric::Saturating, black_box(&ROWS)));
}

fn moments(count: usize, metric: Metric) -> Moments {
    moments_of(&Scene::new(count).in_plane().0, metric)
}

/// The complete fit from edge points and covered points to a matrix, ours and the rival's in turn.
fn race(scene: &Scene, name: &str, solver: &SolverParams, sample_cap: usize, rounds: usize) {
    let inputs = Inputs { solver, sample_cap, ..scene.inputs() };
    let (mut ours_ms, mut rival_ms, mut ratios) = (Vec::new(), Vec::new(), Vec::new());
    let mut evaluations = 0;
    for round in 0..=rounds {
        let start = Instant::now();
        let regions = solve(Method::Lixel, black_box(&inputs));
        let ours = start.elapsed().as_secs_f64() * 1e3;
        let start = Instant::now();
        let answer = black_box(rival::scene_optimal(black_box(&inputs)));
        let rival = start.elapsed().as_secs_f64() * 1e3;
        let (Ok(regions), Some(answer)) = (regions, answer) else {
            println!("{name}: no fit");
            return;
        };
        evaluations = regions.iter().map(|r| r.report.evaluations).sum();
        // The first round takes memory that later ones use again, and checks the rival.
        if round == 0 {
            rival::check(&inputs, &answer);
            continue;
        }
        ours_ms.push(ours);
        rival_ms.push(rival);
        ratios.push(rival / ours);
    }
    println!(
        "{{\"samples\": {}, \"cap\": {sample_cap}, \"fit\": \"{name}\", \"rounds\": {rounds}, \"evaluations\": \
         {evaluations}, \"ours_ms\": {:.3}, \"rival_ms\": {:.3}, \"ratio\": {:.2}, \"ratios\": {ratios:.2?}}}",
        scene.edges.len(),
        median(&ours_ms),
        median(&rival_ms),
        median(&ratios)
    );
}

fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(f64::NAN)
}
