//! Measures a light by what its plan says alone: the maps are drawn from the plan's own matrices, sizes and bias, looked
//! up by its domains, and compared with exact visibility at every pixel.
//!
//! Nothing of samples, metric, fit or methods is used: what judges a plan shares none of what chose it.

use super::{MapPlan, domain};
use crate::math::matrix_from_rows;
use crate::measure::{Certainty, Drawn, Receivers, Verdict, wrong};
use crate::raster::{Bias, Canvas, RasterError};
use crate::resolution::{MapParams, SingleSided};
use crate::scene::{Camera, Light};
use crate::visibility::{RayOffset, Tracer, View};

/// What a frame gives to each of its lights.
#[derive(Clone, Copy)]
pub(super) struct Seeing<'a> {
    pub(super) tracer: &'a Tracer<'a>,
    pub(super) camera: &'a Camera,
    pub(super) view: &'a View,
    pub(super) offset: RayOffset,
}

/// A light, measured.
pub(super) struct Remeasured {
    /// The pixels that ask, with their exact answers.
    pub(super) receivers: Receivers,
    /// The maps as drawn.
    pub(super) drawn: Vec<Drawn>,
    /// Receivers answered wrongly, ascending.
    pub(super) wrong: Vec<u32>,
    /// For each wrong one, whether its exact answer is uncertain.
    pub(super) uncertain: Vec<bool>,
    /// Their counts.
    pub(super) verdict: Verdict,
}

/// Draws a light's maps and looks every pixel up. Without maps every answer is that of `outside`.
pub(super) fn remeasure(
    seeing: &Seeing,
    light: &Light,
    maps: &[MapPlan],
    params: &MapParams,
) -> Result<Remeasured, RasterError> {
    let Seeing { tracer, camera, view, offset } = *seeing;
    let receivers = Receivers::classify(tracer, view, camera, light, offset);
    let drawn =
        maps.iter().map(|map| draw_map(tracer, light, map, params.single_sided)).collect::<Result<Vec<_>, _>>()?;
    let wrong = wrong(&receivers, &drawn, params.outside);
    let uncertain = Certainty::new(tracer, view, camera, light, &receivers, offset).uncertain(&wrong);
    let verdict = Verdict::of(&receivers, &wrong, &uncertain);
    Ok(Remeasured { receivers, drawn, wrong, uncertain, verdict })
}

fn draw_map(tracer: &Tracer, light: &Light, map: &MapPlan, sides: SingleSided) -> Result<Drawn, RasterError> {
    let clip_from_scene = matrix_from_rows(&map.clip_from_world);
    let bias =
        Bias { constant: map.bias.constant, slope: map.bias.slope, clamp: map.bias.clamp.unwrap_or(f64::INFINITY) };
    let geometry = tracer.geometry();
    let mut canvas = Canvas::default();
    let keep = |index: u32| sides.draws(geometry, light, index);
    canvas.draw(geometry, &clip_from_scene, map.width, map.height, bias, keep)?;
    Ok(Drawn { domain: domain::read(&map.domain), clip_from_scene, map: canvas.map })
}
