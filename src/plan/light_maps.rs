//! The maps of one light in one frame: by the job's method, by those that `auto` and `best` choose among, or as given.

use super::seen::Seen;
use super::stage::{FrameStage, Lit};
use super::{Choice, PlanError, choice};
use crate::job::Job;
use crate::methods::{Method, Region, SolverParams};
use crate::resolution::{
    self, FilmQuestion, FittedLight, Judge, JudgedMap, Need, OnFilm, Planned, Rung, Spent, Unmeasured, certify, climb,
    rungs,
};
use crate::scene::Light;
use crate::shot::in_frame;
use glam::DVec3;

/// A light to find maps for.
pub(super) struct Wanted<'a> {
    pub(super) stage: &'a FrameStage<'a>,
    pub(super) light: &'a Light,
    pub(super) job: &'a Job,
    pub(super) lit: &'a Lit,
    /// Visible points, for what is not measured.
    pub(super) seen: &'a [Seen],
}

/// Maps, and how their method was chosen where that was asked; else the reason why there are none.
pub(super) type Found = (Result<Planned, String>, Option<Choice>);

impl Wanted<'_> {
    /// The maps; of the regions in `given`, where they are not to be fitted here.
    pub(super) fn find(&self, given: Option<&FittedLight>) -> Result<Found, PlanError> {
        let Wanted { stage, light, job, lit, .. } = *self;
        let question = stage.question(light, job);
        let on = self.on_film();
        if let Some(given) = given {
            return Ok((self.given(&question, given, on.as_ref())?, None));
        }
        Ok(match (job.solver.method, on) {
            (Method::Auto, Some(on)) => {
                let (ladder, taken) = resolution::auto(&question, &lit.samples, &on)?;
                chosen(taken, choice::of_ladder(&ladder, &job.solver, ""))
            }
            (Method::Auto, None) => {
                let need = |rung: &Rung| {
                    let found = self.predicted(&rung.solver(&job.solver));
                    Ok::<_, PlanError>(found.map(|found| (Need::of(&question, &found.fitted, &found.certified), found)))
                };
                let (ladder, taken) = climb(&rungs(&job.solver), job.solver.min_saving, need, |_, same| Ok(same))?;
                chosen(taken, choice::of_ladder(&ladder, &job.solver, ", as predicted"))
            }
            (Method::Best, Some(on)) => {
                let (contest, taken) = resolution::best(&question, &lit.samples, &on)?;
                chosen(taken, choice::of_contest(&contest))
            }
            (_, Some(on)) => (resolution::planned(&question, &lit.samples, &on, true)?, None),
            (_, None) => (self.predicted(&job.solver), None),
        })
    }

    /// What maps are measured on; `None` where nothing is.
    fn on_film(&self) -> Option<OnFilm<'_>> {
        self.stage.on_film(self.lit.film.as_ref()?)
    }

    /// Maps of given regions, certified.
    fn given(
        &self,
        question: &FilmQuestion,
        given: &FittedLight,
        on: Option<&OnFilm>,
    ) -> Result<Result<Planned, String>, PlanError> {
        let fitted = FittedLight { regions: in_frame(&given.regions, &self.lit.samples.edges), ..given.clone() };
        let Some(on) = on else { return Ok(self.drawn_by_none(question, fitted)) };
        let mut judge = match Judge::new(*on, question, &fitted) {
            Ok(judge) => judge,
            Err(reason) => return Ok(Err(reason.to_string())),
        };
        let certified = certify(question, &fitted, &mut judge)?;
        let spent = Spent { evaluations: fitted.evaluations, ..judge.spent };
        Ok(Ok(Planned { maps: judge.maps, fitted, certified, spent }))
    }

    /// A method's maps with the size that the prediction asks for.
    fn predicted(&self, solver: &SolverParams) -> Result<Planned, String> {
        let Wanted { stage, light, job, lit, .. } = *self;
        let question = FilmQuestion { solver, ..stage.question(light, job) };
        self.unmeasured(&question, |unmeasured| unmeasured.planned(&lit.samples, lit.film.as_ref()))
    }

    /// The matrices of regions that are not measured, with the predicted size.
    fn drawn_by_none(&self, question: &FilmQuestion, fitted: FittedLight) -> Result<Planned, String> {
        self.unmeasured(question, |unmeasured| unmeasured.of(fitted))
    }

    /// Hands over what maps are made from where nothing is measured.
    fn unmeasured<R>(&self, question: &FilmQuestion, work: impl FnOnce(&Unmeasured) -> R) -> R {
        let Wanted { stage, light, job, lit, seen } = *self;
        let receivers: Vec<DVec3> = match &lit.film {
            Some(film) => film.positions.clone(),
            None => seen.iter().map(|s| s.position).collect(),
        };
        let kept = |region: &Region, own: &[DVec3]| stage.kept(region, own, light, job);
        let maps_of =
            |fitted: &FittedLight, receivers: &[DVec3]| JudgedMap::of_all_by(&fitted.regions, receivers, kept);
        let sampled = stage.sampled(question, seen);
        work(&Unmeasured { question, receivers: &receivers, sampled: sampled.as_ref(), maps_of: &maps_of })
    }
}

fn chosen(taken: Option<Planned>, choice: Choice) -> Found {
    match taken {
        Some(planned) => (Ok(planned), Some(choice)),
        None => {
            let reasons = choice.tried.iter().filter_map(|t| Some((t.method, t.reason.as_ref()?)));
            let listed: Vec<String> = reasons.map(|(method, reason)| format!("{}: {reason}", method.name())).collect();
            (Err(format!("{} ({})", choice.reason, listed.join("; "))), Some(choice))
        }
    }
}
