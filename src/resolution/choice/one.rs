//! The maps of a light by one method, measured on a film.

use super::super::{
    Certified, FilmQuestion, FittedLight, Judge, JudgedMap, Measure, OnFilm, Sampled, Spent, Unmeasured, certify,
    check, fit_light, refined,
};
use crate::raster::RasterError;
use crate::samples::LightSamples;
use glam::DVec3;

/// A light's maps, measured.
#[derive(Clone, Debug)]
pub struct Planned {
    /// Matrices and depth rows.
    pub maps: Vec<JudgedMap>,
    /// The regions, and how the maps share texels.
    pub fitted: FittedLight,
    /// Size and bias.
    pub certified: Certified,
    /// What it took.
    pub spent: Spent,
}

/// The maps of a question's method; with better ones near them where `improve` and the job ask for them. The inner error is
/// the reason why the method has none.
pub fn planned(
    question: &FilmQuestion,
    samples: &LightSamples,
    on: &OnFilm,
    improve: bool,
) -> Result<Result<Planned, String>, RasterError> {
    let sampled = (question.quality.measure == Measure::Check).then(|| Sampled::of_film(question, on)).flatten();
    let found = match sampled {
        Some(sampled) => checked(question, samples, on, &sampled)?,
        None => searched(question, samples, on)?,
    };
    let (mut fitted, mut judge, first) = match found {
        Ok(found) => found,
        Err(reason) => return Ok(Err(reason)),
    };
    let certified = if improve { refined(question, samples, &mut fitted, &mut judge, first)? } else { first };
    let spent = Spent { evaluations: fitted.evaluations, ..judge.spent };
    Ok(Ok(Planned { maps: judge.maps, fitted, certified, spent }))
}

/// Fitted maps that are drawn, with bias and size; the inner error is the reason why there are none.
type Found<'a> = Result<(FittedLight, Judge<'a>, Certified), String>;

/// Bias and size by measurement.
fn searched<'a>(
    question: &'a FilmQuestion<'a>,
    samples: &LightSamples,
    on: &OnFilm<'a>,
) -> Result<Found<'a>, RasterError> {
    let fitted = fit_light(question, samples, Some(on.receivers)).map_err(|reason| reason.to_string());
    let judged = fitted.and_then(|fitted| Ok((Judge::new(*on, question, &fitted).map_err(|r| r.to_string())?, fitted)));
    let (mut judge, fitted) = match judged {
        Ok(judged) => judged,
        Err(reason) => return Ok(Err(reason)),
    };
    let certified = certify(question, &fitted, &mut judge)?;
    Ok(Ok((fitted, judge, certified)))
}

/// Bias and size by lookups, checked by measurement.
fn checked<'a>(
    question: &'a FilmQuestion<'a>,
    samples: &LightSamples,
    on: &OnFilm<'a>,
    sampled: &Sampled,
) -> Result<Found<'a>, RasterError> {
    let receivers = &on.receivers.positions;
    let maps_of = |fitted: &FittedLight, receivers: &[DVec3]| JudgedMap::of_all(&fitted.regions, on.tracer, receivers);
    let unmeasured = Unmeasured { question, receivers, sampled: Some(sampled), maps_of: &maps_of };
    let Planned { maps, mut fitted, certified, spent } = match unmeasured.planned(samples, Some(on.receivers)) {
        Ok(undrawn) => undrawn,
        Err(reason) => return Ok(Err(reason)),
    };
    let mut judge = Judge::of_maps(*on, question, maps);
    judge.spent.rays = spent.rays;
    let certified = check(question, &mut fitted, &mut judge, sampled, certified)?;
    Ok(Ok((fitted, judge, certified)))
}

/// The same maps, or better ones near them, where they were not looked for yet.
pub fn improved(
    question: &FilmQuestion,
    samples: &LightSamples,
    on: &OnFilm,
    planned: Planned,
) -> Result<Planned, RasterError> {
    let Planned { maps, mut fitted, certified, mut spent } = planned;
    let mut judge = Judge::of_maps(*on, question, maps);
    let certified = refined(question, samples, &mut fitted, &mut judge, certified)?;
    spent += judge.spent;
    Ok(Planned { maps: judge.maps, fitted, certified, spent })
}
