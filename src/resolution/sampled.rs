//! Bias and size where no map is drawn: a sample of the visible points is looked up by rays.

use super::bias::biases;
use super::{Bound, FilmQuestion, JudgedMap, OnFilm, Probe, SizeGrid, bound_limit, smallest, undrawn};
use crate::measure::{LookedUp, Seen, least_limit, look_up_by_rays};
use crate::raster::Bias;
use crate::visibility::Tracer;
use glam::DVec3;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::convert::Infallible;

/// Points looked up at most, evenly thinned: with a bound of a thousandth of the film, sixteen wrong ones decide.
const POINTS: usize = 1 << 14;
/// Of so many points one is looked up for a rough answer.
const ROUGH: usize = 4;

/// Multiples of the golden ratio less 1 fall evenly into the unit interval, however many are taken (Weyl).
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// Visible points of a light that stand for its film.
pub struct Sampled<'a> {
    question: &'a FilmQuestion<'a>,
    tracer: &'a Tracer<'a>,
    points: Vec<Seen>,
    pixels_a_point: f64,
}

/// Bias and size by lookups.
#[derive(Clone, Copy, Debug)]
pub struct Settled {
    /// The size's place on the grid: the largest where none meets the bound.
    pub place: usize,
    /// The bound is expected to hold there.
    pub met: bool,
    /// The bias.
    pub bias: Bias,
    /// Wrong pixels, estimated: with a certain and with an uncertain exact answer.
    pub wrong: [f64; 2],
    /// Rays that it took.
    pub rays: u64,
}

impl<'a> Sampled<'a> {
    /// Of the points that `positions` evenly spread film positions see and that face the light. `None` where rays do not tell
    /// what would be drawn: where one side of triangles is left out.
    pub fn new(
        question: &'a FilmQuestion<'a>,
        tracer: &'a Tracer<'a>,
        seen: &[Seen],
        positions: usize,
    ) -> Option<Sampled<'a>> {
        let (stride, picked) = thinned(seen.len(), POINTS);
        let points = picked.map(|i| seen[i]).collect();
        let pixels_a_point = question.film.pixels() as f64 / positions.max(1) as f64 * stride as f64;
        question.rays_tell().then_some(Sampled { question, tracer, points, pixels_a_point })
    }

    /// Of the film's pixels. `None` as there.
    pub fn of_film(question: &'a FilmQuestion<'a>, on: &OnFilm<'a>) -> Option<Sampled<'a>> {
        let (stride, picked) = thinned(on.receivers.len(), POINTS);
        let points = picked.filter_map(|i| on.seen(question.camera, i)).collect();
        question.rays_tell().then_some(Sampled { question, tracer: on.tracer, points, pixels_a_point: stride as f64 })
    }

    /// Few of the points.
    pub fn rough(&self) -> Sampled<'a> {
        let points = self.points.iter().step_by(ROUGH).copied().collect();
        Sampled { points, pixels_a_point: self.pixels_a_point * ROUGH as f64, ..*self }
    }

    /// Where they are, scene space.
    pub fn positions(&self) -> Vec<DVec3> {
        self.points.iter().map(|seen| seen.position).collect()
    }

    /// The smallest size from `least` on at which the bound is expected to hold, sought from `guess` on, and the best bias
    /// there unless it is given. Where the bound is no count of pixels, sizes are predicted well: only the bias is chosen, at
    /// `least`.
    pub fn settle<'b>(
        &self,
        maps_at: impl Fn(usize) -> Cow<'b, [JudgedMap]>,
        grid: &SizeGrid,
        (least, guess): (usize, usize),
        bias: Option<Bias>,
    ) -> Settled {
        let limit = bound_limit(self.question.quality, self.question.film);
        let counts = self.question.quality.bound == Bound::Misclassified;
        let trial_at = |place: usize| self.trial(&maps_at(place), grid.sizes(place), bias);
        let mut tried: BTreeMap<usize, (Bias, [f64; 2])> = BTreeMap::new();
        let mut probe = |k: usize| {
            let trial = trial_at(least + k);
            let value = self.expected_limit(trial.1);
            tried.insert(least + k, trial);
            Ok::<_, Infallible>(Probe { meets: !counts || value <= limit, ratio: value / limit })
        };
        let Ok(found) = if counts {
            smallest(grid.len() - least, guess.saturating_sub(least), self.question.map.step, probe)
        } else {
            probe(0).map(|_| Some(0))
        };
        let place = found.map_or(grid.len() - 1, |k| least + k);
        let (bias, wrong) = tried.get(&place).copied().unwrap_or_else(|| trial_at(place));
        let rays = tried.len() as u64 * self.rays();
        Settled { place, met: found.is_some(), bias, wrong, rays }
    }

    /// Rays that looking all of them up once takes.
    pub fn rays(&self) -> u64 {
        self.points.len() as u64
    }

    /// The best bias, ties go to the earlier one, or the one given, and the estimated certain and uncertain wrong pixels.
    pub fn trial(&self, maps: &[JudgedMap], sizes: &[[u32; 2]], bias: Option<Bias>) -> (Bias, [f64; 2]) {
        let FilmQuestion { light, map, .. } = self.question;
        let maps = undrawn(maps, sizes);
        let all = bias.map_or_else(|| biases(&map.bias), |bias| vec![bias]);
        let slope_max = all.iter().map(|bias| bias.slope).fold(0.0, f64::max);
        let found = look_up_by_rays(self.tracer, light, &maps, &self.points, slope_max);
        let is_wrong = |f: &LookedUp, bias: &Bias| f.wrong(*bias, map.outside);
        // Between the least and the most bias answers change once at most: what both answer alike all do.
        let (least, most) = ends(&all);
        let open: Vec<&LookedUp> = found.iter().filter(|f| is_wrong(f, &least) != is_wrong(f, &most)).collect();
        let settled = found.iter().filter(|f| is_wrong(f, &least) && is_wrong(f, &most)).fold([0; 2], counted);
        let wrong_under = |bias: &Bias| open.iter().copied().filter(|f| is_wrong(f, bias)).fold(settled, counted);
        let counts: Vec<[u64; 2]> = all.iter().map(wrong_under).collect();
        let best = (0..all.len()).min_by_key(|k| counts[*k].iter().sum::<u64>()).unwrap_or(0);
        (all[best], counts[best].map(|points| points as f64 * self.pixels_a_point))
    }

    /// The smallest limit, pixels, that so many wrong ones are expected to meet: one standard deviation of a count more than
    /// the estimate, so that what is said to be met mostly is.
    fn expected_limit(&self, [certain, uncertain]: [f64; 2]) -> f64 {
        let value = least_limit(certain, uncertain);
        value + (value * self.pixels_a_point).sqrt()
    }
}

/// About one in so many of a row of things, at most `most` of them; one out of each run, each at another place, since things
/// in rows of a film that are as far apart each time may all lie in a few columns.
fn thinned(len: usize, most: usize) -> (usize, impl Iterator<Item = usize>) {
    let stride = len.div_ceil(most).max(1);
    let place = move |run: usize| (run as f64 * GOLDEN).fract() * stride as f64;
    (stride, (0..len.div_ceil(stride)).map(move |run| (run * stride + place(run) as usize).min(len - 1)))
}

/// One more, with a certain or with an uncertain exact answer.
fn counted([certain, uncertain]: [u64; 2], found: &LookedUp) -> [u64; 2] {
    if found.uncertain { [certain, uncertain + 1] } else { [certain + 1, uncertain] }
}

/// A bias that adds no more than any of those, and one that adds no less.
fn ends(all: &[Bias]) -> (Bias, Bias) {
    let end = |a: Bias, b: &Bias, pick: fn(f64, f64) -> f64| Bias {
        constant: pick(a.constant, b.constant),
        slope: pick(a.slope, b.slope),
        clamp: pick(a.clamp, b.clamp),
    };
    let first = all.first().copied().unwrap_or(Bias::NONE);
    all.iter().fold((first, first), |(least, most), b| (end(least, b, f64::min), end(most, b, f64::max)))
}
