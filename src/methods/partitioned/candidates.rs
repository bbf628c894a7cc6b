//! Where a part may be split: planes of three families, each a pencil of directions with offsets at quantiles of what
//! the part's edges cost.
//!
//! * lines of the light's image plane, laid out in the part's own map, so that they are even where its texels are;
//! * lines of the film, pulled back through the camera: planes through the eye;
//! * planes across the view axis.
//!
//! The first separates casters too. The others put surfaces that lie behind each other along the light into different maps.

use super::super::{Inputs, Region};
use crate::samples::EdgePoint;
use glam::{DVec3, DVec4};
use std::f64::consts::PI;

/// A plane of a family.
#[derive(Clone, Copy, Debug)]
pub(super) enum Candidate {
    /// cos·u + sin·v = offset in the part's map.
    Map { angle: f64, offset: f64 },
    /// cos·x + sin·y = offset on the film, pixels.
    Film { angle: f64, offset: f64 },
    /// Distance along the view axis, metres.
    Depth { offset: f64 },
}

/// Directions of lines in the map.
const MAP_DIRECTIONS: u32 = 8;
/// Directions of lines on the film.
const FILM_DIRECTIONS: u32 = 4;
/// Offsets: shares of the edges' cost on one side.
const QUANTILES: [f64; 5] = [0.15, 0.325, 0.5, 0.675, 0.85];

/// What turns candidates of a part into planes of scene space.
pub(super) struct Frame<'a> {
    region: &'a Region,
    /// Rows x, y (pixels) and w of the film on (point, 1).
    film: [DVec4; 3],
    /// Row of the distance along the view axis.
    depth: DVec4,
    /// Planes through the light alone.
    hull_only: bool,
}

impl Frame<'_> {
    pub(super) fn new<'a>(inputs: &Inputs, region: &'a Region) -> Frame<'a> {
        let camera = inputs.camera;
        let clip = camera.clip_from_scene(inputs.film);
        let (width, height) = (f64::from(inputs.film.width), f64::from(inputs.film.height));
        let (x, y, w) = (clip.row(0), clip.row(1), clip.row(3));
        let forward = camera.forward();
        Frame {
            region,
            film: [(x + w) * (0.5 * width), (w - y) * (0.5 * height), w],
            depth: forward.extend(-forward.dot(camera.position)),
            hull_only: inputs.hull_only,
        }
    }

    /// The plane of a candidate, its normal of unit length; `None` where it has none.
    pub(super) fn plane(&self, candidate: Candidate) -> Option<DVec4> {
        let plane = match candidate {
            Candidate::Map { angle, offset } => {
                let [p1, p2, p4] = [0, 1, 2].map(|i| self.region.h.row(i));
                self.region.space.row_from_q(p1 * angle.cos() + p2 * angle.sin() - p4 * offset)
            }
            Candidate::Film { angle, offset } => {
                self.film[0] * angle.cos() + self.film[1] * angle.sin() - self.film[2] * offset
            }
            Candidate::Depth { offset } => self.depth - DVec4::W * offset,
        };
        let length = plane.truncate().length();
        let unit = plane / length;
        (unit.is_finite() && length > 0.0).then_some(unit)
    }

    /// The candidate's coordinate of a point: equal to its offset on the plane.
    fn coordinate(&self, candidate: Candidate, point: DVec3) -> f64 {
        let at = |row: DVec4| row.dot(point.extend(1.0));
        match candidate {
            Candidate::Map { angle, .. } => {
                let p = self.region.h * self.region.space.q(point);
                (p.x * angle.cos() + p.y * angle.sin()) / p.z
            }
            Candidate::Film { angle, .. } => {
                let [x, y, w] = self.film.map(at);
                (x * angle.cos() + y * angle.sin()) / w
            }
            Candidate::Depth { .. } => at(self.depth),
        }
    }

    /// The families at the quantiles of the edges' costs.
    pub(super) fn candidates(&self, edges: &[EdgePoint], costs: &[f64]) -> Vec<Candidate> {
        let turned = |count: u32| (0..count).map(move |k| PI * f64::from(k) / f64::from(count));
        let mut pencils: Vec<Candidate> =
            turned(MAP_DIRECTIONS).map(|angle| Candidate::Map { angle, offset: 0.0 }).collect();
        if !self.hull_only {
            pencils.extend(turned(FILM_DIRECTIONS).map(|angle| Candidate::Film { angle, offset: 0.0 }));
            pencils.push(Candidate::Depth { offset: 0.0 });
        }
        pencils.iter().flat_map(|pencil| self.at_quantiles(*pencil, edges, costs)).collect()
    }

    fn at_quantiles(&self, pencil: Candidate, edges: &[EdgePoint], costs: &[f64]) -> Vec<Candidate> {
        let mut along: Vec<(f64, f64)> =
            edges.iter().zip(costs).map(|(e, cost)| (self.coordinate(pencil, e.position), *cost)).collect();
        along.retain(|(at, _)| at.is_finite());
        along.sort_by(|a, b| a.0.total_cmp(&b.0));
        let total: f64 = along.iter().map(|a| a.1).sum();
        let (mut sum, mut wanted) = (0.0, QUANTILES.iter().peekable());
        let mut found = Vec::with_capacity(QUANTILES.len());
        for (k, (at, cost)) in along.iter().enumerate() {
            sum += cost;
            // Between two edges: on which side an edge on the plane lies is rounding.
            let next = along.get(k + 1).map_or(*at, |next| next.0);
            while wanted.next_if(|share| sum >= **share * total).is_some() {
                found.push(pencil.moved_to(0.5 * (at + next)));
            }
        }
        found
    }

    /// Candidates around one: its offset moved by `step` of the part's extent both ways, its direction turned.
    pub(super) fn around(&self, candidate: Candidate, edges: &[EdgePoint], step: f64) -> Vec<Candidate> {
        let along = edges.iter().map(|e| self.coordinate(candidate, e.position)).filter(|at| at.is_finite());
        let (lo, hi) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), at| (lo.min(at), hi.max(at)));
        let offset = candidate.offset();
        let mut near: Vec<Candidate> =
            [-1.0, 1.0].map(|sign| candidate.moved_to(offset + sign * step * (hi - lo))).to_vec();
        let turn = step * PI;
        // Turned about a point between the two edges nearest to the line, not about the origin.
        let off = |e: &EdgePoint| (self.coordinate(candidate, e.position) - offset).abs();
        let mut nearest: Vec<&EdgePoint> = edges.iter().collect();
        let count = 2.min(nearest.len());
        if count == 0 {
            return near;
        }
        nearest.select_nth_unstable_by(count - 1, |a, b| off(a).total_cmp(&off(b)));
        let middle = nearest[..count].iter().map(|e| e.position).sum::<DVec3>() / count as f64;
        for turned in [-turn, turn].into_iter().filter_map(|by| candidate.turned(by)) {
            near.push(turned.moved_to(self.coordinate(turned, middle)));
        }
        near
    }
}

impl Candidate {
    fn offset(self) -> f64 {
        let (Candidate::Map { offset, .. } | Candidate::Film { offset, .. } | Candidate::Depth { offset }) = self;
        offset
    }

    fn moved_to(mut self, to: f64) -> Candidate {
        let (Candidate::Map { offset, .. } | Candidate::Film { offset, .. } | Candidate::Depth { offset }) = &mut self;
        *offset = to;
        self
    }

    fn turned(self, by: f64) -> Option<Candidate> {
        match self {
            Candidate::Map { angle, offset } => Some(Candidate::Map { angle: angle + by, offset }),
            Candidate::Film { angle, offset } => Some(Candidate::Film { angle: angle + by, offset }),
            Candidate::Depth { .. } => None,
        }
    }
}
