//! The cut against every cut there is, and long shots against a search at every frame.

use super::*;
use crate::fit::Effort;
use crate::methods::SolverParams;
use crate::resolution::{MapParams, QualityParams};
use crate::scene::{Camera, Film, LightKind, Projection};
use synthetic::walk;

#[path = "../../../benches/shot/synthetic.rs"]
mod synthetic;

/// Something to ask with little effort.
fn asking<T>(work: impl FnOnce(&Asked) -> T) -> T {
    let (quality, map) = (QualityParams::default(), MapParams::default());
    let solver = SolverParams { effort: Effort::Local, rounds: 1, ..SolverParams::default() };
    work(&Asked { film: Film { width: 1280, height: 720 }, quality: &quality, map: &map, solver: &solver })
}

#[test]
fn the_cut_of_a_short_shot_is_the_best_of_all() {
    const FRAMES: usize = 7;
    for (seed, minimise) in [(1, Minimise::Drawn), (2, Minimise::Sum), (3, Minimise::Peak)] {
        let light = LightParts::new(walk(seed, FRAMES, 2.0, 60)).unwrap();
        let params = TemporalParams { minimise, change_cost: 3.0, ..TemporalParams::default() };
        asking(|asked| {
            let mut seeker = Seeker { asked, light: &light, params: &params, correction: 1.0, known: BTreeMap::new() };
            let found = seeker.borders(usize::MAX, BLOCKS).unwrap();
            let value = |borders: &[usize]| {
                let of = |w: &[usize]| seeker.known[&(w[0], w[1])];
                let sum: f64 = borders.windows(2).map(|w| of(w).cost).sum();
                let peak = borders.windows(2).map(|w| of(w).texels).fold(0.0, f64::max);
                if minimise == Minimise::Peak { sum + peak } else { sum }
            };
            let all = (0..1_u32 << (FRAMES - 1)).map(|bits| -> Vec<usize> {
                let inner = (1..FRAMES).filter(|k| bits >> (k - 1) & 1 == 1);
                std::iter::once(0).chain(inner).chain([FRAMES]).collect()
            });
            let best = all.map(|borders| value(&borders)).fold(f64::INFINITY, f64::min);
            assert!((value(&found) / best - 1.0).abs() < 1e-12, "{minimise:?}: {found:?}");
        });
    }
}

#[test]
fn borders_found_from_blocks_cost_what_those_of_a_search_at_every_frame_do() {
    // A long walk in few frames: segments change often.
    for (seed, step_m, change_cost) in [(1, 0.6, 0.0), (2, 1.5, 100.0), (3, 3.0, 1000.0)] {
        let light = LightParts::new(walk(seed, 36, step_m, 60)).unwrap();
        let params = TemporalParams { change_cost, ..TemporalParams::default() };
        asking(|asked| {
            let cost = |blocks: usize| {
                let (light, params) = (&light, &params);
                let mut seeker = Seeker { asked, light, params, correction: 1.0, known: BTreeMap::new() };
                let borders = seeker.borders(usize::MAX, blocks).unwrap();
                let cost: f64 = borders.windows(2).map(|w| seeker.known[&(w[0], w[1])].cost).sum();
                (cost, borders)
            };
            let ((exact, at), (found, near)) = (cost(36), cost(9));
            // Intervals are fitted by a local search to covers that are put together of other pieces: equal but for that.
            assert!(found <= exact * 1.02, "{found} at {near:?}, {exact} at {at:?}");
        });
    }
}
