//! Where a search by measurement looks next: random steps about the best map so far, longer after a gain and shorter after
//! none, a (1+1) evolution strategy (Rechenberg 1973).
//!
//! Counts of wrong pixels are rugged: they change with every texel that an edge falls on. A search along differences of
//! them would follow noise; this one only asks which of two counts is smaller.

use crate::fit::Step;
use crate::math::Prng;
use glam::DVec2;

/// The seed of every search: the same input gives the same steps.
const SEED: u64 = 1;
/// Deviation of the first steps: part of the legal range of p4, radians, and half the logarithm of the aspect.
const FIRST: f64 = 0.02;
/// Steps of p4 alone are so many times longer.
const COARSER: f64 = 3.0;
/// Deviations stay within these: the smaller moves a texel of a large map, the larger loses the map.
const RANGE: [f64; 2] = [1e-3, 0.2];
/// Factors after a gain and after none. They balance at one gain in five or six steps (Rechenberg's rule of one in five).
const LONGER: f64 = 1.2;
const SHORTER: f64 = 0.96;

/// The steps of one search.
pub(super) struct Nearby {
    stream: Prng,
    deviation: f64,
}

impl Nearby {
    /// Before the first step. Searches of different numbers take different steps.
    pub(super) fn new(number: u64) -> Nearby {
        Nearby { stream: Prng::new(SEED, number), deviation: FIRST }
    }

    /// The next step of p4 alone.
    pub(super) fn warp(&mut self) -> DVec2 {
        let deviation = COARSER * self.deviation;
        DVec2::new(self.stream.normal(), self.stream.normal()) * deviation
    }

    /// The next step.
    pub(super) fn step(&mut self) -> Step {
        let mut normal = || self.stream.normal() * self.deviation;
        Step { warp: DVec2::new(normal(), normal()), turn_rad: [normal(), normal()], stretch: 2.0 * normal() }
    }

    /// Learns whether the last step led to a better map.
    pub(super) fn heed(&mut self, gained: bool) {
        let factor = if gained { LONGER } else { SHORTER };
        self.deviation = (self.deviation * factor).clamp(RANGE[0], RANGE[1]);
    }
}
