//! The best constant matrix of an interval of frames, and the texels that it needs for epsilon on every one of them.
//!
//! Samples of all frames stand in the light's frame and are fitted together, each frame with the same weight (math note
//! §9); then the matrix is held against each frame alone. The frame that needs most texels decides.

use crate::fit::Effort;
use crate::math::Bounds;
use crate::methods::{Inapplicable, Region, SolverParams};
use crate::resolution::{FilmQuestion, FittedLight, MapParams, QualityParams, fit_light, predict, predicted_texels};
use crate::samples::{EdgePoint, LightSamples};
use crate::scene::{Film, Light};
use glam::DVec3;

use super::part::{LightPart, thinned};
use serde::{Deserialize, Serialize};

/// What is asked of every interval.
#[derive(Clone, Copy, Debug)]
pub struct Asked<'a> {
    /// The film of all frames.
    pub film: Film,
    /// `[quality]`.
    pub quality: &'a QualityParams,
    /// `[map]`.
    pub map: &'a MapParams,
    /// `[solver]`.
    pub solver: &'a SolverParams,
}

/// How closely an interval is looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Look {
    /// To be compared with other intervals.
    Quick,
    /// To be planned.
    Full,
}

/// Edge samples that an interval is fitted to: a solve's time does not grow with the shot.
const FITTED: [usize; 2] = [768, 16_384];
/// Frames that an interval is fitted to and held against, evenly spread, and edge samples of each of them: enough to tell
/// intervals apart.
const PROBED: usize = 24;
/// Edge samples of a frame that a quick look is held against.
const PROBED_EDGES: usize = 200;
/// Rounds of reweighting of a quick look.
const QUICK_ROUNDS: u32 = 2;

/// An interval's matrix.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct Interval {
    /// Regions that hold what every frame has to cover, in the frame of the light.
    pub fitted: FittedLight,
    /// Texels of all maps together at which every frame meets epsilon, as predicted.
    pub texels: f64,
    /// Place among the parts of the frame that needs them.
    pub decides: usize,
    /// Wrong pixels expected in the first and in the last frame at these texels.
    pub wrong_at_ends: [f64; 2],
}

/// Fits an interval: parts in the light's frame, in order, each with something to cover. `light` is the light as it stands
/// there, `cover` what the maps have to hold.
///
/// # Errors
/// The method's own reason.
pub fn fit_interval(
    asked: &Asked,
    light: &Light,
    parts: &[&LightPart],
    cover: Vec<DVec3>,
    look: Look,
) -> Result<Interval, Inapplicable> {
    let Some(first) = parts.first() else { return Err(Inapplicable::Empty) };
    let quick = look == Look::Quick;
    let probed = probes(parts.len(), if quick { PROBED } else { parts.len() });
    let samples =
        LightSamples { covered: cover, hull_only: true, ..samples(parts, &probed, FITTED[usize::from(!quick)]) };
    let solver = match look {
        Look::Full => asked.solver.clone(),
        Look::Quick => {
            let rounds = asked.solver.rounds.min(QUICK_ROUNDS);
            SolverParams { effort: Effort::Local, rounds, ..asked.solver.clone() }
        }
    };
    let question = FilmQuestion {
        camera: &first.camera,
        film: asked.film,
        light,
        bounds: Bounds::of(samples.covered.iter().copied()),
        quality: asked.quality,
        map: asked.map,
        solver: &solver,
        sample_cap: samples.edges.len(),
    };
    let fitted = fit_light(&question, &samples, None)?;
    let frame = |k: usize| {
        let edges = if quick { thinned(&parts[k].edges, PROBED_EDGES) } else { parts[k].edges.clone() };
        in_frame(&fitted.regions, &edges)
    };
    let (mut texels, mut decides) = (0.0_f64, 0);
    for k in &probed {
        let needed = predicted_texels(asked.quality, asked.film, &frame(*k), &fitted.shares);
        if needed > texels {
            (texels, decides) = (needed, *k);
        }
    }
    let wrong = |k: usize| predict(&frame(k), &fitted.shares, texels).misclassified;
    let wrong_at_ends = [wrong(0), wrong(parts.len() - 1)];
    Ok(Interval { fitted: FittedLight { texels, ..fitted }, texels, decides, wrong_at_ends })
}

/// At most `count` of `of` places, evenly spread, both ends among them.
fn probes(of: usize, count: usize) -> Vec<usize> {
    if of <= count {
        return (0..of).collect();
    }
    (0..count).map(|k| (k * (of - 1) + (count - 1) / 2) / (count - 1)).collect()
}

/// Edges of the probed frames, of all of them together as long as those of one frame on the average.
fn samples(parts: &[&LightPart], probed: &[usize], count: usize) -> LightSamples {
    let share = (count / probed.len()).max(8);
    let scale = 1.0 / probed.len() as f64;
    let edges = probed.iter().flat_map(|k| thinned(&parts[*k].edges, share));
    LightSamples {
        edges: edges.map(|e| EdgePoint { length_px: e.length_px * scale, ..e }).collect(),
        ..LightSamples::default()
    }
}

/// The edges that an interval is fitted to in full.
pub fn interval_samples(parts: &[&LightPart]) -> LightSamples {
    LightSamples { hull_only: true, ..samples(parts, &probes(parts.len(), parts.len()), FITTED[1]) }
}

/// The same regions, predicting for the edges of one frame.
pub fn in_frame(regions: &[Region], edges: &[EdgePoint]) -> Vec<Region> {
    let of_region = |(i, region): (usize, &Region)| {
        let looks_up = |e: &EdgePoint| regions.iter().position(|r| r.domain.holds(e.position)) == Some(i);
        let inside: Vec<EdgePoint> = edges.iter().copied().filter(looks_up).collect();
        region.over(&inside, inside.len())
    };
    regions.iter().enumerate().map(of_region).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probes_are_spread_and_hold_both_ends() {
        assert_eq!(probes(3, 24), [0, 1, 2]);
        let spread = probes(100, 24);
        assert_eq!((spread.len(), spread[0], spread[23]), (24, 0, 99));
        assert!(spread.windows(2).all(|w| w[0] < w[1]));
    }
}
