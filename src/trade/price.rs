//! What planned maps come to, on the exact answers of the film.

use crate::compare::sizes_of;
use crate::job::Job;
use crate::measure::Receivers;
use crate::plan::{FrameStage, LightPlan, PlanError, Settled};
use crate::raster::{Bias, RasterError};
use crate::resolution::{
    BiasParams, Bound, FilmQuestion, Judge, MapParams, Measure, OnFilm, grid_of, smallest, texels, trial,
};
use crate::scene::Light;
use crate::visibility::View;

/// Ratio of neighbouring sizes in the search for the texels that maps need, whatever the point's own step.
const JUDGED_STEP: f64 = 1.02;

/// A light of a frame, with the exact answer at every film pixel that faces it.
pub(super) struct Truth<'a> {
    /// The frame.
    pub(super) stage: &'a FrameStage<'a>,
    /// Its film, every pixel seen.
    pub(super) view: &'a View,
    /// Place in the frame's list of lights.
    pub(super) index: usize,
    /// The light.
    pub(super) light: &'a Light,
    /// The pixels that ask.
    pub(super) receivers: Receivers,
    /// The user's job: bound and limits of maps.
    pub(super) job: &'a Job,
}

/// What a plan of a light comes to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Price {
    /// Texels of all maps.
    pub(super) planned: u64,
    /// Texels of the smallest size that meets the bound; `None` when none does.
    pub(super) needed: Option<u64>,
    /// Texels of the largest size allowed.
    pub(super) largest: u64,
    /// What the plan says.
    pub(super) said_met: bool,
    /// What its maps say.
    pub(super) truly_met: bool,
}

impl Price {
    /// Texels that the maps need, or the most that they may have.
    pub(super) fn asks_for(&self) -> u64 {
        self.needed.unwrap_or(self.largest)
    }
}

impl Truth<'_> {
    /// Whether a map has to be looked up for some pixel.
    pub(super) fn needs_a_map(&self) -> bool {
        self.receivers.needing(self.job.map.outside) > 0
    }

    /// What a plan made with the settings of `point` comes to: its entry, and its maps where it has any.
    pub(super) fn price(&self, entry: &LightPlan, settled: Option<&Settled>, point: &Job) -> Result<Price, PlanError> {
        let said_met = entry.met();
        let Some(settled) = settled else {
            let meets = self.unanswered().0;
            let largest = u64::from(self.job.map.max).pow(2);
            return Ok(Price { planned: 0, needed: meets.then_some(0), largest, said_met, truly_met: meets });
        };
        let Settled { fitted, certified, .. } = settled;
        let planned = texels(&certified.sizes);
        // What was measured with a certificate at the judged step is not measured again.
        let certificate =
            matches!(point.quality.measure, Measure::Always | Measure::Full) && point.map.step <= JUDGED_STEP;
        let (found, largest) = self.with_judge(settled, |question, judge, bias| {
            let grid = grid_of(question, fitted);
            let largest = grid.texels(grid.len().saturating_sub(1)) as u64;
            if certificate {
                return Ok(((said_met, said_met.then_some(planned)), largest));
            }
            let mut probe = |sizes: Vec<[u32; 2]>| {
                let drawn = judge.draw(&sizes, bias)?;
                let wrong = judge.wrong(&drawn);
                Ok::<_, RasterError>(trial(question, judge, (&drawn, &wrong), sizes).0)
            };
            let truly_met = probe(certified.sizes.clone())?.meets;
            let guess = grid.at_least(planned as f64);
            let found = smallest(grid.len(), guess, JUDGED_STEP, |k| probe(grid.sizes(k).to_vec()))?;
            Ok(((truly_met, found.map(|k| grid.texels(k) as u64)), largest))
        })?;
        let (truly_met, needed) = found;
        Ok(Price { planned, needed, largest, said_met, truly_met })
    }

    /// Certainly wrong pixels with so many texels in all, and the plan's bias.
    pub(super) fn wrong_at(&self, settled: Option<&Settled>, total: f64) -> Result<u64, PlanError> {
        let Some(settled) = settled else { return Ok(self.unanswered().1) };
        self.with_judge(settled, |_, judge, bias| {
            let sizes = sizes_of(&settled.fitted.regions, &settled.fitted.shares, total);
            let drawn = judge.draw(&sizes, bias)?;
            let wrong = judge.wrong(&drawn);
            Ok(judge.verdict(&wrong).certain.wrong())
        })
    }

    fn on_film(&self) -> OnFilm<'_> {
        let FrameStage { tracer, offset, .. } = *self.stage;
        OnFilm { tracer, view: self.view, receivers: &self.receivers, offset }
    }

    /// Hands over the maps of a plan, to be drawn at any size with the plan's bias.
    fn with_judge<R>(
        &self,
        settled: &Settled,
        work: impl FnOnce(&FilmQuestion, &mut Judge, Bias) -> Result<R, RasterError>,
    ) -> Result<R, PlanError> {
        let bias = settled.certified.bias;
        let fixed = BiasParams { constant: Some(bias.constant), slope: Some(bias.slope), clamp: Some(bias.clamp) };
        let map = MapParams { step: JUDGED_STEP, bias: fixed, ..self.job.map.clone() };
        let question = FilmQuestion { map: &map, ..self.stage.question(self.light, self.job) };
        let maps = settled.maps.clone();
        let mut judge = Judge::of_maps(self.on_film(), &question, maps);
        Ok(work(&question, &mut judge, bias)?)
    }

    /// Whether the bound holds with no map, every pixel getting the answer of `map.outside`; and the certainly wrong ones.
    fn unanswered(&self) -> (bool, u64) {
        let question = self.stage.question(self.light, self.job);
        let judge = Judge::of_maps(self.on_film(), &question, Vec::new());
        let wrong = judge.wrong(&[]);
        let certain = judge.verdict(&wrong).certain.wrong();
        let meets = match question.quality.bound {
            Bound::Misclassified => trial(&question, &judge, (&[], &wrong), Vec::new()).0.meets,
            Bound::Displacement | Bound::Footprint => certain == 0,
        };
        (meets, certain)
    }
}
