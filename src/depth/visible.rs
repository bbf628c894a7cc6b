//! The visible points of a light, sorted so that the extreme ones are found without looking at all.

use crate::math::Bounds;
use glam::{DVec3, DVec4};
use rayon::prelude::*;

/// Points of a run. Neighbours on the film mostly are neighbours in the scene.
const RUN: usize = 256;

/// Scene points that look maps up, in runs with boxes around them.
#[derive(Clone, Debug)]
pub struct Visible<'a> {
    points: &'a [DVec3],
    runs: Vec<Bounds>,
}

impl<'a> Visible<'a> {
    /// Of points in the order of the film.
    pub fn new(points: &'a [DVec3]) -> Visible<'a> {
        Visible { points, runs: points.par_chunks(RUN).map(|run| Bounds::of(run.iter().copied())).collect() }
    }

    /// At most about `count` of the points that `holds` accepts, evenly thinned.
    pub(super) fn few(&self, count: usize, holds: &impl Fn(DVec3) -> bool) -> Vec<DVec3> {
        let stride = self.points.len().div_ceil(count).max(1);
        self.points.iter().step_by(stride).copied().filter(|p| holds(*p)).collect()
    }

    /// The largest value of a row on (X, 1) over the points that `holds` accepts; all of them lie where `planes`, rows too,
    /// are not negative. At least `least`.
    pub(super) fn largest(&self, row: DVec4, planes: &[DVec4], holds: &impl Fn(DVec3) -> bool, least: f64) -> f64 {
        let mut best = least;
        for (bounds, run) in self.runs.iter().zip(self.points.chunks(RUN)) {
            let corners = [bounds.min, bounds.max];
            if most(row, corners) <= best || planes.iter().any(|plane| most(*plane, corners) < 0.0) {
                continue;
            }
            for p in run {
                let value = row.dot(p.extend(1.0));
                if value > best && holds(*p) {
                    best = value;
                }
            }
        }
        best
    }
}

/// The largest value of a row on (X, 1) over a box.
pub(super) fn most(row: DVec4, [low, high]: [DVec3; 2]) -> f64 {
    let linear = row.truncate();
    linear.dot((low + high) * 0.5) + linear.abs().dot((high - low) * 0.5) + row.w
}
