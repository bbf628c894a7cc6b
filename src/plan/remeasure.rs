//! Measures a light by what its plan says alone: the maps are drawn from the plan's own matrices, sizes and bias, looked
//! up by its domains, and compared with exact visibility at every pixel.
//!
//! Nothing of samples, metric, fit or methods is used: what judges a plan shares none of what chose it.

use std::sync::Arc;

use super::stage::Posed;
use super::{Flicker, MapPlan, domain};
use crate::math::{Domain, matrix_from_rows};
use crate::measure::{
    Cache, Certainty, Drawn, Earlier, LightThenNow, Moment, Outside, Receivers, Verdict, flicker, reproject, wrong,
};
use crate::raster::{Bias, Canvas, RasterError};
use crate::resolution::{MapParams, SingleSided, TEXELS_MAX};
use crate::scene::{Camera, Film, Light, Shot};
use crate::visibility::{Bvh, RayOffset, Tracer, View};
use glam::DMat4;

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
    pub(super) drawn: Arc<Vec<Drawn>>,
    /// Receivers answered wrongly, ascending.
    pub(super) wrong: Vec<u32>,
    /// For each wrong one, whether its exact answer is uncertain.
    pub(super) uncertain: Vec<bool>,
    /// Their counts.
    pub(super) verdict: Verdict,
}

/// A frame whose lights were measured, kept for the comparison with the next one.
pub(super) struct Before {
    pub(super) number: i64,
    pub(super) posed: Posed,
    pub(super) offset: RayOffset,
    /// The maps of each light, by name, as drawn.
    pub(super) maps: Vec<(String, Arc<Vec<Drawn>>)>,
    /// What a renderer that blends answers over time kept; `None` for one that does not.
    pub(super) left: Option<Left>,
}

/// What a frame leaves to a renderer that blends answers over time.
pub(super) struct Left {
    /// What its camera saw.
    pub(super) view: View,
    /// What is kept of each light, by name.
    pub(super) caches: Vec<(String, Cache)>,
}

impl Before {
    /// Flicker of a light of the frame `now` since this one; `None` for a light that was not there.
    pub(super) fn flicker(
        &self,
        of_shot: (&Shot, &Bvh),
        earlier: &[Option<Earlier>],
        light: &str,
        now: &Remeasured,
        outside: Outside,
    ) -> Option<Flicker> {
        let maps_then = self.maps_of(light)?;
        self.flicker_of(of_shot, earlier, (light, maps_then), (&now.receivers, &now.drawn), outside)
    }

    /// The same with the light's maps then, and receivers and maps now.
    pub(super) fn flicker_of(
        &self,
        (shot, still): (&Shot, &Bvh),
        earlier: &[Option<Earlier>],
        (light, maps_then): (&str, &[Drawn]),
        (receivers, maps_now): (&Receivers, &[Drawn]),
        outside: Outside,
    ) -> Option<Flicker> {
        let tracer = self.posed.tracer(shot, still);
        let then = self.posed.frame.lights.iter().find(|l| l.name == light)?;
        let moment = self.moment(&tracer, shot.film);
        let pair = LightThenNow { then, maps_then, maps_now };
        let found = flicker(&moment, earlier, receivers, &pair, outside);
        Some(Flicker { since: self.number, still: found.still, moved: found.moved, compared: found.compared })
    }

    /// The maps of a light.
    pub(super) fn maps_of(&self, light: &str) -> Option<&Arc<Vec<Drawn>>> {
        self.maps.iter().find(|(name, _)| name == light).map(|(_, maps)| maps)
    }

    /// Where the pixels of a later frame were in this one.
    pub(super) fn earlier(&self, (shot, still): (&Shot, &Bvh), now: &Seeing) -> Vec<Option<Earlier>> {
        let tracer = self.posed.tracer(shot, still);
        let moment = Moment { tracer: now.tracer, camera: now.camera, film: now.view.film, offset: now.offset };
        reproject(&self.moment(&tracer, shot.film), &moment, now.view)
    }

    pub(super) fn moment<'a>(&'a self, tracer: &'a Tracer<'a>, film: Film) -> Moment<'a> {
        Moment { tracer, camera: &self.posed.frame.camera, film, offset: self.offset }
    }
}

/// Draws a light's maps, unless they are given as `drawn`, and looks every pixel up. Without maps every answer is
/// `outside`.
pub(super) fn remeasure(
    seeing: &Seeing,
    light: &Light,
    maps: &[MapPlan],
    params: &MapParams,
    drawn: Option<Arc<Vec<Drawn>>>,
) -> Result<Remeasured, RasterError> {
    let Seeing { tracer, camera, view, offset } = *seeing;
    let receivers = Receivers::classify(tracer, view, camera, light, offset);
    let drawn = match drawn {
        Some(drawn) => drawn,
        None if maps.iter().map(MapPlan::texels).sum::<u64>() > TEXELS_MAX => {
            let largest = maps.iter().max_by_key(|map| map.texels()).map_or([0, 0], |map| [map.width, map.height]);
            return Err(RasterError::Size { width: largest[0], height: largest[1] });
        }
        None => Arc::new(
            maps.iter()
                .map(|map| draw_map(tracer, light, map, [map.width, map.height], None, params.single_sided))
                .collect::<Result<Vec<_>, _>>()?,
        ),
    };
    let wrong = wrong(&receivers, &drawn, params.outside);
    let uncertain = Certainty::new(tracer, view, camera, light, &receivers, offset).uncertain(&wrong);
    let verdict = Verdict::of(&receivers, &wrong, &uncertain);
    Ok(Remeasured { receivers, drawn, wrong, uncertain, verdict })
}

/// Draws a map at a size, with a bias where one is given, else with its own.
pub(super) fn draw_map(
    tracer: &Tracer,
    light: &Light,
    map: &MapPlan,
    size: [u32; 2],
    bias: Option<Bias>,
    sides: SingleSided,
) -> Result<Drawn, RasterError> {
    let clip_from_scene = matrix_from_rows(&map.clip_from_world);
    let bias = bias.unwrap_or_else(|| map.bias.drawn());
    Ok(draw(tracer, light, (domain::read(&map.domain), clip_from_scene), size, bias, sides)?.0)
}

/// Draws a map of a light; with the number of triangles that were drawn.
pub(super) fn draw(
    tracer: &Tracer,
    light: &Light,
    (domain, clip_from_scene): (Domain, DMat4),
    [width, height]: [u32; 2],
    bias: Bias,
    sides: SingleSided,
) -> Result<(Drawn, u64), RasterError> {
    let geometry = tracer.geometry();
    let mut canvas = Canvas::default();
    let keep = |index: u32| sides.draws(geometry, light, index);
    let counts = canvas.draw(geometry, &clip_from_scene, width, height, bias, keep)?;
    Ok((Drawn { domain, clip_from_scene, map: canvas.map }, counts.drawn))
}
