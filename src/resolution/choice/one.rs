//! The maps of a light by one method, measured on a film.

use super::super::{
    Certified, FilmQuestion, FittedLight, Judge, JudgedMap, OnFilm, certify, choose, fit_light, refined,
};
use crate::raster::RasterError;
use crate::samples::LightSamples;

/// A light's maps, measured.
#[derive(Clone, Debug)]
pub struct Planned {
    /// Matrices and depth rows.
    pub maps: Vec<JudgedMap>,
    /// The regions, and how the maps share texels.
    pub fitted: FittedLight,
    /// Size and bias.
    pub certified: Certified,
    /// Texels and triangles drawn for it, and evaluations of its fits.
    pub spent: [u64; 3],
}

/// The maps of a question's method; with better ones near them where `improve` and the job ask for them. The inner error is
/// the reason why the method has none.
pub fn planned(
    question: &FilmQuestion,
    samples: &LightSamples,
    on: &OnFilm,
    improve: bool,
) -> Result<Result<Planned, String>, RasterError> {
    let mut fitted = match fit_light(question, samples, Some(on.receivers)) {
        Ok(fitted) => fitted,
        Err(reason) => return Ok(Err(reason.to_string())),
    };
    let mut judge = match Judge::new(*on, question, &fitted) {
        Ok(judge) => judge,
        Err(reason) => return Ok(Err(reason.to_string())),
    };
    let certified = if improve {
        choose(question, samples, &mut fitted, &mut judge)?
    } else {
        certify(question, &fitted, &mut judge)?
    };
    let spent = [judge.texels_drawn, judge.triangles_drawn, fitted.evaluations];
    Ok(Ok(Planned { maps: judge.maps, fitted, certified, spent }))
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
    let spent = [spent[0] + judge.texels_drawn, spent[1] + judge.triangles_drawn, spent[2]];
    Ok(Planned { maps: judge.maps, fitted, certified, spent })
}
