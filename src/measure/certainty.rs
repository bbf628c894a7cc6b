//! Which wrong answers count: those whose exact answer is certain.
//!
//! An exact answer is uncertain when it changes under a larger ray offset, or when its surface lies nearly edge-on to the
//! light. Only receivers that were answered wrongly are asked, each at most once.

use super::{Counts, Receivers};
use crate::metric::UNCERTAIN_WEIGHT;
use crate::scene::{Camera, Light};
use crate::visibility::{Answer, RayOffset, Tracer, View, answer, edge_on};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::sync::atomic::{AtomicU8, Ordering};

/// Certain and uncertain errors together may pass epsilon by this factor.
pub const UNCERTAIN_SLACK: f64 = 1.0 + UNCERTAIN_WEIGHT;

/// Tells certain from uncertain receivers, and remembers.
pub struct Certainty<'a> {
    tracer: &'a Tracer<'a>,
    view: &'a View,
    camera: &'a Camera,
    light: &'a Light,
    receivers: &'a Receivers,
    offset: RayOffset,
    /// One of [`UNKNOWN`], [`CERTAIN`], [`UNCERTAIN`] for each receiver.
    known: Vec<AtomicU8>,
}

const UNKNOWN: u8 = 0;
const CERTAIN: u8 = 1;
const UNCERTAIN: u8 = 2;

/// Wrong pixels of one light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize)]
pub struct Verdict {
    /// Wrong pixels with a certain exact answer.
    pub certain: Counts,
    /// Further wrong pixels, whose exact answer is uncertain.
    pub uncertain: u64,
}

impl<'a> Certainty<'a> {
    /// `receivers` were classified with this tracer, view, camera, light and offset.
    pub fn new(
        tracer: &'a Tracer<'a>,
        view: &'a View,
        camera: &'a Camera,
        light: &'a Light,
        receivers: &'a Receivers,
        offset: RayOffset,
    ) -> Certainty<'a> {
        let known = (0..receivers.len()).map(|_| AtomicU8::new(UNKNOWN)).collect();
        Certainty { tracer, view, camera, light, receivers, offset, known }
    }

    /// For each of some receivers, whether its exact answer is uncertain.
    pub fn uncertain(&self, receivers: &[u32]) -> Vec<bool> {
        receivers.par_iter().with_min_len(256).map(|i| self.is_uncertain(*i)).collect()
    }

    /// Certain and uncertain among wrong receivers.
    pub fn verdict(&self, wrong: &[u32]) -> Verdict {
        Verdict::of(self.receivers, wrong, &self.uncertain(wrong))
    }

    fn is_uncertain(&self, receiver: u32) -> bool {
        let slot = &self.known[receiver as usize];
        match slot.load(Ordering::Relaxed) {
            UNKNOWN => {
                let pixel = self.receivers.pixels[receiver as usize] as usize;
                let exact = self.receivers.shadowed[receiver as usize];
                let uncertain = self.view.surface(self.tracer, self.camera, pixel).is_some_and(|surface| {
                    let larger = answer(self.tracer, &surface, self.light, self.offset.uncertain());
                    edge_on(&surface, self.light) || (larger == Answer::Shadowed) != exact
                });
                slot.store(if uncertain { UNCERTAIN } else { CERTAIN }, Ordering::Relaxed);
                uncertain
            }
            known => known == UNCERTAIN,
        }
    }
}

impl Verdict {
    /// Counts wrong receivers, given for each whether it is uncertain.
    pub fn of(receivers: &Receivers, wrong: &[u32], uncertain: &[bool]) -> Verdict {
        let mut verdict = Verdict::default();
        for (i, uncertain) in wrong.iter().zip(uncertain) {
            if *uncertain {
                verdict.uncertain += 1;
            } else if receivers.shadowed[*i as usize] {
                verdict.certain.false_lit += 1;
            } else {
                verdict.certain.false_shadow += 1;
            }
        }
        verdict
    }

    /// Whether at most `limit` pixels are wrong: the certain ones alone, and all of them with [`UNCERTAIN_SLACK`].
    pub fn meets(&self, limit: f64) -> bool {
        let certain = self.certain.wrong() as f64;
        certain <= limit && certain + self.uncertain as f64 <= UNCERTAIN_SLACK * limit
    }

    /// The smallest limit that is met, wrong pixels.
    pub fn least_limit(&self) -> f64 {
        least_limit(self.certain.wrong() as f64, self.uncertain as f64)
    }
}

/// The smallest limit that so many certain and uncertain wrong pixels meet.
pub fn least_limit(certain: f64, uncertain: f64) -> f64 {
    certain.max((certain + uncertain) / UNCERTAIN_SLACK)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uncertain_errors_have_their_slack_and_no_more() {
        let verdict = |false_lit, false_shadow, uncertain| Verdict {
            certain: Counts { false_lit, false_shadow, uncovered: 0 },
            uncertain,
        };
        assert!(verdict(60, 40, 14).meets(100.0));
        assert!(!verdict(60, 40, 16).meets(100.0));
        assert!(!verdict(60, 41, 0).meets(100.0));
        assert!(verdict(0, 0, 0).meets(0.0));
        assert_eq!(verdict(60, 40, 10).least_limit(), 100.0);
        assert!((verdict(10, 5, 100).least_limit() - 100.0).abs() < 1e-9);
    }
}
