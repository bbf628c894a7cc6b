//! A plan that is certified at the least cost: the film and its planning grid seen and classified, a draft's fit and lookups,
//! the maps drawn and counted once, larger ones where they are over (`quality.measure = "check"`).

use crate::Case;
use lixel::measure::Receivers;
use lixel::resolution::{Measure, OnFilm, planned};
use lixel::samples::{Grid, GridView, LightView, sample_light};
use lixel::visibility::{classify, see};
use std::error::Error;

impl Case<'_> {
    /// In words of JSON: sizes, wrong pixels, whether the bound is met.
    pub(crate) fn certified(&self) -> Result<String, Box<dyn Error>> {
        let Case { tracer, light, offset, .. } = *self;
        let camera = &self.frame.camera;
        let mut job = self.job.clone();
        job.quality.measure = Measure::Check;
        let view = see(tracer, camera, self.film);
        let answers = classify(tracer, &view, camera, light, offset);
        let film = Receivers::new(&view, camera, &answers);
        let grid = GridView::see(tracer, camera, Grid::new(self.film, job.sampling.grid), Some(&view));
        let answers = grid.grid.of_film(&answers);
        let lit = LightView { tracer, camera, view: &grid, light, offset, answers: &answers };
        let samples = sample_light(&lit, job.sampling.refine, false);
        if film.shadowed_count() == 0 {
            return Ok("null".to_owned());
        }
        let question = self.question(&job);
        let on = OnFilm { tracer, view: &view, receivers: &film, offset };
        let certified = planned(&question, &samples, &on, true)??.certified;
        let wrong = certified.chosen.map_or(0, |trial| trial.verdict.certain.wrong());
        let (sizes, tried) = (certified.sizes, certified.tried.len());
        Ok(format!("{{\"maps\": {sizes:?}, \"tried\": {tried}, \"wrong\": {wrong}, \"met\": {}}}", certified.met))
    }
}
