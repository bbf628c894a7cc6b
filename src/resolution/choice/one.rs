//! The maps of a light by one method, measured on a film.

use super::super::{
    Certified, FilmQuestion, FittedLight, Judge, JudgedMap, Measure, OnFilm, Sampled, Unmeasured, certify, check,
    fit_light, refined,
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
    /// Texels and triangles drawn for it, evaluations of its fits, rays of lookups.
    pub spent: [u64; 4],
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
    let (first, mut fitted, mut judge) = match sampled {
        Some(sampled) => match looked_up(question, samples, on, &sampled) {
            Ok(Planned { maps, mut fitted, certified, .. }) => {
                let mut judge = Judge::of_maps(*on, question, maps);
                (check(question, &mut fitted, &mut judge, &sampled, certified)?, fitted, judge)
            }
            Err(reason) => return Ok(Err(reason)),
        },
        None => {
            let fitted = match fit_light(question, samples, Some(on.receivers)) {
                Ok(fitted) => fitted,
                Err(reason) => return Ok(Err(reason.to_string())),
            };
            let mut judge = match Judge::new(*on, question, &fitted) {
                Ok(judge) => judge,
                Err(reason) => return Ok(Err(reason.to_string())),
            };
            (certify(question, &fitted, &mut judge)?, fitted, judge)
        }
    };
    let certified = if improve { refined(question, samples, &mut fitted, &mut judge, first)? } else { first };
    let spent = judge.spent(fitted.evaluations);
    Ok(Ok(Planned { maps: judge.maps, fitted, certified, spent }))
}

/// The maps that lookups settle on, not drawn.
fn looked_up(
    question: &FilmQuestion,
    samples: &LightSamples,
    on: &OnFilm,
    sampled: &Sampled,
) -> Result<Planned, String> {
    let receivers = &on.receivers.positions;
    let maps_of = |fitted: &FittedLight, receivers: &[DVec3]| JudgedMap::of_all(&fitted.regions, on.tracer, receivers);
    let unmeasured = Unmeasured { question, receivers, sampled: Some(sampled), maps_of: &maps_of };
    unmeasured.planned(samples, Some(on.receivers))
}

/// The same maps, or better ones near them, where they were not looked for yet.
pub fn improved(
    question: &FilmQuestion,
    samples: &LightSamples,
    on: &OnFilm,
    planned: Planned,
) -> Result<Planned, RasterError> {
    let Planned { maps, mut fitted, certified, spent } = planned;
    let mut judge = Judge::of_maps(*on, question, maps);
    let certified = refined(question, samples, &mut fitted, &mut judge, certified)?;
    let more = judge.spent(0);
    let spent = std::array::from_fn(|k| spent[k] + more[k]);
    Ok(Planned { maps: judge.maps, fitted, certified, spent })
}
