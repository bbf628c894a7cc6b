//! Plans for renderers that blend answers over time (`measure::blend`): what that leaves of wrong pixels and flicker, and
//! the sizes of maps that need less for it.
//!
//! The frames are gone through in order, as the renderer does. A frame whose maps are its own (modes `per-frame` and
//! `hysteresis`) takes the smallest size that meets epsilon with what the frames before left in the cache. Maps that several
//! frames share keep the size that they need without: where map and surface stand still every frame answers alike, and
//! blending adds nothing.

use super::budget::{Case, Counts, Ladder, Sizes, resized};
use super::remeasure::{Before, Remeasured, Seeing};
use super::stage::Stages;
use super::{Flicker, LightPlan, PlanError, Reprojected, Status};
use crate::job::Job;
use crate::measure::{Blended, Cache, Certainty, Drawn, Earlier, Past, Verdict, blend, wrong};
use crate::resolution::{Probe, smallest};
use crate::scene::{Light, Shot};
use crate::visibility::Bvh;
use std::sync::Arc;

/// A frame and the one before it.
pub(super) struct Steps<'a> {
    pub(super) shot: &'a Shot,
    pub(super) still: &'a Bvh,
    pub(super) job: &'a Job,
    pub(super) seeing: Seeing<'a>,
    pub(super) before: Option<&'a Before>,
    pub(super) earlier: Option<&'a [Option<Earlier>]>,
}

impl Steps<'_> {
    /// The answers of a light's maps, blended with those of the frame before.
    fn blended(&self, light: &str, measured: &Remeasured, drawn: &[Drawn]) -> Blended {
        let (pixels, map) = (self.seeing.view.film.pixels(), &self.job.map);
        let power = self.job.lookup.confidence_power;
        let without = || blend(None, pixels, &measured.receivers, drawn, map.outside, power);
        let (Some(before), Some(earlier)) = (self.before, self.earlier) else { return without() };
        let Some(left) = &before.left else { return without() };
        let kept = left.caches.iter().find(|(name, _)| name == light);
        let then = before.posed.frame.lights.iter().find(|l| l.name == light);
        let (Some((_, cache)), Some(then)) = (kept, then) else { return without() };
        let tracer = before.posed.tracer(self.shot, self.still);
        let moment = before.moment(&tracer, self.shot.film);
        let past = Past { moment, view: &left.view, light: then, cache, earlier };
        blend(Some(&past), pixels, &measured.receivers, drawn, map.outside, power)
    }

    /// What the renderer shows of a light, and what it keeps.
    pub(super) fn shown(&self, light: &Light, measured: &Remeasured) -> (Reprojected, Cache) {
        let blended = self.blended(&light.name, measured, &measured.drawn);
        let certainty = self.certainty(light, measured);
        let verdict = certainty.verdict(&blended.wrong);
        let flicker = self.before.map(|before| {
            let found = blended.flicker;
            Flicker { since: before.number, still: found.still, moved: found.moved, compared: found.compared }
        });
        let (misclassified, uncertain) = (verdict.certain.wrong(), verdict.uncertain);
        let met = verdict.meets(self.limit());
        (Reprojected { misclassified, uncertain, met, flicker }, blended.cache)
    }

    /// Wrong pixels allowed.
    fn limit(&self) -> f64 {
        self.job.quality.epsilon() * self.seeing.view.film.pixels() as f64
    }

    fn certainty<'b>(&'b self, light: &'b Light, measured: &'b Remeasured) -> Certainty<'b> {
        let Seeing { tracer, camera, view, offset } = self.seeing;
        Certainty::new(tracer, view, camera, light, &measured.receivers, offset)
    }

    /// An entry with the smallest maps that meet epsilon with what the frame before left, and these maps; `None` where it
    /// keeps its own.
    pub(super) fn smaller(
        &self,
        stages: &Stages,
        light: &Light,
        entry: &LightPlan,
        measured: &Remeasured,
    ) -> Result<Option<(LightPlan, Remeasured)>, PlanError> {
        let shared = entry.temporal.as_ref().is_some_and(|t| t.segment.is_some());
        if shared || entry.maps.is_empty() || entry.budget.is_some() || self.before.is_none() {
            return Ok(None);
        }
        let ladder = Ladder::of(&[entry], &self.job.map, self.job.map.step);
        let certainty = self.certainty(light, measured);
        let Seeing { tracer, camera, view, offset } = self.seeing;
        let (receivers, place) = (&measured.receivers, [0, 0]);
        let case = Case { tracer, camera, view, offset, light, entry, receivers, certainty: &certainty, place };
        let mut counts = Counts::new();
        let guess = ladder.at_most(entry.maps.iter().map(|m| m.texels() as f64).sum());
        let found = smallest(ladder.texels.len(), guess, self.job.map.step, |k| {
            let sizes: Sizes = ladder.sizes(k);
            let drawn = case.draw(&sizes, None, stages)?;
            let alone = wrong(receivers, &drawn, self.job.map.outside);
            counts.insert(sizes, vec![certainty.verdict(&alone)]);
            let verdict: Verdict = certainty.verdict(&self.blended(&light.name, measured, &drawn).wrong);
            let (meets, ratio) = (verdict.meets(self.limit()), verdict.least_limit() / self.limit());
            Ok::<_, PlanError>(Probe { meets, ratio })
        })?;
        let Some(k) = found else { return Ok(None) };
        let chosen = ladder.sizes(k);
        let entry = resized(stages, &case, &counts, &chosen)?;
        let drawn = case.draw(&chosen, None, stages)?;
        let wrong = wrong(receivers, &drawn, self.job.map.outside);
        let uncertain = certainty.uncertain(&wrong);
        let verdict = Verdict::of(receivers, &wrong, &uncertain);
        let receivers = receivers.clone();
        Ok(Some((entry, Remeasured { receivers, drawn: Arc::new(drawn), wrong, uncertain, verdict })))
    }
}

/// Writes what the renderer shows into an entry with maps: the bound is judged by it.
pub(super) fn enter(entry: &mut LightPlan, shown: Reprojected) {
    if entry.maps.is_empty() {
        return;
    }
    if entry.budget.is_none() {
        if let Some(error) = &mut entry.error {
            error.met = shown.met;
        }
        entry.status = if shown.met { Status::Planned } else { Status::NotMet };
        if shown.met {
            entry.reason = None;
        } else if entry.reason.is_none() {
            entry.reason = Some(format!(
                "with reprojection {} certain and {} uncertain pixels are wrong, more than without: raise epsilon or \
                 map.max, or set lookup.temporal = \"none\"",
                shown.misclassified, shown.uncertain
            ));
        }
    }
    entry.reprojected = Some(shown);
}
