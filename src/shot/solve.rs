//! The stage from the parts of one light to the segments of a shot.
//!
//! All intervals of a shot are too many: 50 million of 10,000 frames. So the shot is first cut at the borders of at most
//! [`BLOCKS`] blocks of frames, every interval of blocks looked at quickly and the cheapest cut found by dynamic programming;
//! then the chosen borders may move by half a block, a quarter, down to a frame, and segments part in the middle, each time by
//! dynamic programming over the chosen borders and their neighbours, so that no step makes the cut dearer. Up to [`BLOCKS`] frames the cut is the best of
//! all. Its segments are fitted in full.

use super::interval::{Asked, Interval, Look, fit_interval};
use super::light_pose::light_poses;
use super::part::{LightPart, extremes_for_light};
use super::partition::{Ends, cheapest, lowest_peak};
use super::{Hold, Minimise, TemporalParams};
use crate::math::RigidMotion;
use crate::methods::Inapplicable;
use crate::samples::EdgePoint;
use crate::scene::Light;
use glam::DVec3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::ops::Range;

/// Most blocks that a shot is first cut into: 820 intervals are looked at.
const BLOCKS: usize = 40;
/// Rounds in which borders are moved at most: blocks of 2¹⁵ frames would take 15 to come down to a frame.
const ROUNDS: usize = 24;
/// Chosen borders that an interval may pass on when borders are moved: from one's neighbourhood to the next one's.
const SPAN: usize = 1;

/// One light over a shot, in the frame of the light.
#[derive(Clone, Debug)]
pub struct LightParts {
    /// One a frame; edges and cover stand where they stand for the light as it is in `light`.
    pub parts: Vec<LightPart>,
    /// Scene from light, a frame each.
    pub poses: Vec<RigidMotion>,
    /// The light as it stands in the first frame.
    pub light: Light,
}

impl LightParts {
    /// Carries the parts of one light into its frame; `None` without a part.
    pub fn new(mut parts: Vec<LightPart>) -> Option<LightParts> {
        let light = parts.first()?.light.clone();
        let poses = light_poses(parts.iter().map(|p| &p.light));
        for (part, pose) in parts.iter_mut().zip(&poses) {
            let Some(motion) = super::carry(pose, &poses[0]) else { continue };
            for edge in &mut part.edges {
                let derivatives = edge.derivatives.map(|d| motion.vector(d));
                *edge = EdgePoint { position: motion.point(edge.position), derivatives, ..*edge };
            }
            for point in part.cover.iter_mut().chain(&mut part.reach) {
                *point = motion.point(*point);
            }
        }
        Some(LightParts { parts, poses, light })
    }

    /// Frames of a range that need a map.
    pub fn needing(&self, frames: Range<usize>) -> Vec<usize> {
        frames.filter(|f| self.parts[*f].needed > 0).collect()
    }

    /// The points of some frames that span what they have to cover.
    fn hull(&self, frames: Range<usize>) -> Vec<DVec3> {
        let points: Vec<DVec3> = self.parts[frames].iter().flat_map(|p| p.cover.iter().copied()).collect();
        extremes_for_light(&self.light, &points)
    }

    /// How often a map over these frames is drawn: where light or content are not those of the frame before.
    fn draws(&self, frames: &[usize]) -> usize {
        let same =
            |a: usize, b: usize| self.poses[a] == self.poses[b] && self.parts[a].content == self.parts[b].content;
        frames.len().min(1) + frames.windows(2).filter(|w| !same(w[0], w[1])).count()
    }
}

/// Frames that share a matrix and a size.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct Segment {
    /// Of the shot, by place.
    pub frames: Range<usize>,
    /// Those that need a map.
    pub needing: Vec<usize>,
    /// Their matrix.
    pub interval: Interval,
}

/// A cut of a shot.
#[derive(Clone, Debug)]
pub struct Segmentation {
    /// In order; frames that need no map may stand in any.
    pub segments: Vec<Segment>,
    /// The objective, texels, with what changes cost.
    pub cost: f64,
}

/// Why a light's shot has no segments.
pub type Unsegmented = Inapplicable;

/// Cuts the shot of one light. `correction` is what measured texels were of predicted ones, 1 before anything is measured.
/// Empty when no frame needs a map.
///
/// # Errors
/// The reason why no cut has a matrix for each of its segments.
pub fn segments(
    asked: &Asked,
    light: &LightParts,
    params: &TemporalParams,
    correction: f64,
) -> Result<Segmentation, Unsegmented> {
    let count = light.parts.len();
    if light.needing(0..count).is_empty() {
        return Ok(Segmentation { segments: Vec::new(), cost: 0.0 });
    }
    let most = match params.hold {
        Some(Hold::Shot) => 1,
        None => params.max_segments.map_or(usize::MAX, |m| m as usize),
    };
    let mut seeker = Seeker { asked, light, params, correction, known: BTreeMap::new() };
    let chosen = seeker.borders(most, BLOCKS).ok_or_else(|| refusal(asked, light))?;
    let mut segments = Vec::with_capacity(chosen.len());
    let mut cost = 0.0;
    for ends in chosen.windows(2) {
        let frames = ends[0]..ends[1];
        cost += seeker.known.get(&(ends[0], ends[1])).map_or(0.0, |v| v.cost);
        if !light.needing(frames.clone()).is_empty() {
            segments.push(fit_segment(asked, light, frames)?);
        }
    }
    Ok(Segmentation { segments, cost })
}

/// Fits a segment in full.
///
/// # Errors
/// The reason why it has no matrix.
pub fn fit_segment(asked: &Asked, light: &LightParts, frames: Range<usize>) -> Result<Segment, Unsegmented> {
    let needing = light.needing(frames.clone());
    let parts: Vec<&LightPart> = needing.iter().map(|f| &light.parts[*f]).collect();
    let interval = fit_interval(asked, &light.light, &parts, light.hull(frames.clone()), Look::Full)?;
    Ok(Segment { frames, needing, interval })
}

/// The texels of a light's segments as an objective counts them, without what changes cost: of each its texels and the
/// frames that need them.
pub fn minimised_texels<'a>(
    light: &LightParts,
    minimise: Minimise,
    segments: impl Iterator<Item = (f64, &'a [usize])>,
) -> f64 {
    let of_each = segments.map(|(texels, needing)| match minimise {
        Minimise::Drawn => texels * light.draws(needing) as f64,
        Minimise::Sum => texels * needing.len() as f64,
        Minimise::Peak => texels,
    });
    if minimise == Minimise::Peak { of_each.fold(0.0, f64::max) } else { of_each.sum() }
}

/// Looks for the cheapest cut.
struct Seeker<'a> {
    asked: &'a Asked<'a>,
    light: &'a LightParts,
    params: &'a TemporalParams,
    correction: f64,
    /// Intervals looked at, by first frame and end.
    known: BTreeMap<(usize, usize), Valued>,
}

impl Seeker<'_> {
    /// The borders of the cheapest cut found, first and last frame among them; `blocks` at most in the first round.
    fn borders(&mut self, most: usize, blocks: usize) -> Option<Vec<usize>> {
        let count = self.light.parts.len();
        if most == 1 {
            return self.cut(&[0, count], &[0, 1], 1);
        }
        let mut stride = count.div_ceil(blocks);
        let borders: Vec<usize> = (0..count).step_by(stride).chain([count]).collect();
        // One family: any interval may be chosen.
        let mut chosen = self.cut(&borders, &vec![0; borders.len()], most)?;
        if stride == 1 {
            return Some(chosen);
        }
        for _ in 0..ROUNDS {
            stride = stride.div_ceil(2);
            let (borders, family) = near(&chosen, stride);
            let next = self.cut(&borders, &family, most)?;
            if stride == 1 && next == chosen {
                break;
            }
            chosen = next;
        }
        Some(chosen)
    }

    /// The cheapest cut at some of the borders, in intervals that lead from one family of borders to one at most [`SPAN`]
    /// farther on.
    fn cut(&mut self, borders: &[usize], family: &[usize], most: usize) -> Option<Vec<usize>> {
        let blocks = borders.len() - 1;
        let hulls: Vec<Vec<DVec3>> = borders.par_windows(2).map(|w| self.light.hull(w[0]..w[1])).collect();
        let near = |first: usize, end: usize| family[end].abs_diff(family[first]) <= SPAN;
        let fresh: Vec<(usize, usize)> = (0..blocks)
            .flat_map(|first| (first + 1..=blocks).map(move |end| (first, end)))
            .filter(|(first, end)| near(*first, *end) && !self.known.contains_key(&(borders[*first], borders[*end])))
            .collect();
        let looked: Vec<Valued> = fresh
            .par_iter()
            .map(|(first, end)| self.valued(borders[*first]..borders[*end], hulls[*first..*end].concat()))
            .collect();
        self.known.extend(fresh.iter().map(|(first, end)| (borders[*first], borders[*end])).zip(looked));
        const FORBIDDEN: Valued = Valued { texels: f64::INFINITY, cost: f64::INFINITY };
        let at = |first: usize, end: usize| match near(first, end) {
            true => self.known.get(&(borders[first], borders[end])).copied().unwrap_or(FORBIDDEN),
            false => FORBIDDEN,
        };
        let (_, ends) = cut(blocks, most, self.params.minimise, at)?;
        Some(std::iter::once(0).chain(ends).map(|end| borders[end]).collect())
    }

    fn valued(&self, frames: Range<usize>, cover: Vec<DVec3>) -> Valued {
        let (asked, light, params) = (self.asked, self.light, self.params);
        let needing = light.needing(frames);
        let (Some(first), Some(last)) = (needing.first(), needing.last()) else {
            return Valued { texels: 0.0, cost: 0.0 };
        };
        let parts: Vec<&LightPart> = needing.iter().map(|f| &light.parts[*f]).collect();
        let Ok(interval) = fit_interval(asked, &light.light, &parts, cover, Look::Quick) else {
            return Valued { texels: f64::INFINITY, cost: f64::INFINITY };
        };
        let texels = interval.texels * self.correction;
        // A matrix that would need more than the largest map stands back behind any cut that needs less.
        let over = (texels / largest(asked, &interval)).max(1.0);
        let [at_first, at_last] = interval.wrong_at_ends;
        let begins = light.parts[..*first].iter().any(|p| p.needed > 0);
        let ends = light.parts[last + 1..].iter().any(|p| p.needed > 0);
        let popping = at_first * f64::from(u8::from(begins)) + at_last * f64::from(u8::from(ends));
        let times = match params.minimise {
            Minimise::Drawn => light.draws(&needing),
            Minimise::Sum => needing.len(),
            Minimise::Peak => 0,
        };
        let cost = texels * times as f64 * over * over + params.change_cost * popping;
        Valued { texels: texels * over * over, cost }
    }
}

/// Chosen borders with those `stride` before and after each and in the middle of each segment, every one with the number of
/// the chosen border that it belongs to.
fn near(chosen: &[usize], stride: usize) -> (Vec<usize>, Vec<usize>) {
    let (mut borders, mut family) = (vec![0], vec![0]);
    let mut add = |place: usize, of: usize| {
        if borders.last().is_some_and(|last| *last < place) {
            borders.push(place);
            family.push(of);
        }
    };
    for (k, ends) in chosen.windows(2).enumerate() {
        let [first, end] = [ends[0], ends[1]];
        let last = k + 2 == chosen.len();
        let mut inner = vec![(first + stride, k), ((first + end) / 2, k)];
        if !last {
            inner.push((end.saturating_sub(stride), k + 1));
        }
        inner.retain(|(place, _)| first < *place && *place < end);
        inner.sort_unstable();
        inner.into_iter().for_each(|(place, of)| add(place, of));
        add(end, k + 1);
    }
    (borders, family)
}

/// The reason why the first single frame that has no matrix has none.
fn refusal(asked: &Asked, light: &LightParts) -> Inapplicable {
    let alone = |f: &usize| {
        let part = &light.parts[*f];
        fit_interval(asked, &light.light, &[part], part.cover.clone(), Look::Quick).err()
    };
    light.needing(0..light.parts.len()).iter().find_map(alone).unwrap_or(Inapplicable::NoFiniteFit)
}

/// What an interval costs.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Valued {
    /// Texels of its maps; infinite where there is no matrix, or none within the largest map.
    texels: f64,
    /// The objective, without the peak.
    cost: f64,
}

/// Most texels that an interval's maps may have.
fn largest(asked: &Asked, interval: &Interval) -> f64 {
    let side = f64::from(asked.map.max);
    let of = |(aspect, share): (f64, f64)| side * side / (aspect.max(1.0 / aspect) * share);
    let maps = interval.fitted.regions.iter().map(|r| r.aspect).zip(interval.fitted.shares.iter().copied());
    maps.map(of).fold(f64::INFINITY, f64::min)
}

fn cut(blocks: usize, most: usize, minimise: Minimise, at: impl Fn(usize, usize) -> Valued) -> Option<(f64, Ends)> {
    let cost = |first, end| at(first, end).cost;
    match minimise {
        Minimise::Drawn | Minimise::Sum => cheapest(blocks, most, cost),
        Minimise::Peak => lowest_peak(blocks, most, |first, end| at(first, end).texels, cost),
    }
}

#[cfg(test)]
mod tests;
