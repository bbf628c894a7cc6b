//! Draws a light's maps at a size and judges every film pixel, certain and uncertain apart.

use super::{Bound, FilmQuestion, FittedLight, JudgedMap, Measure, QualityParams, Spent, undrawn};
use crate::depth::{DepthError, Visible};
use crate::math::first_holding;
use crate::measure::{
    Certainty, Drawn, LookedUp, Receivers, Seen, UNCERTAIN_SLACK, Verdict, answers_shadowed, edge_distance,
    fewer_wrong, footprint, look_up_by_rays, wrong,
};
use crate::methods::Region;
use crate::raster::{Bias, Canvas, RasterError};
use crate::scene::Camera;
use crate::visibility::{RayOffset, Tracer, View};
use std::borrow::Cow;

/// What maps are measured on: a frame's film, and the exact answers of one light there.
#[derive(Clone, Copy)]
pub struct OnFilm<'a> {
    /// Rays through the frame.
    pub tracer: &'a Tracer<'a>,
    /// What each pixel sees.
    pub view: &'a View,
    /// The exact answers of the light.
    pub receivers: &'a Receivers,
    /// Of shadow rays.
    pub offset: RayOffset,
}

impl OnFilm<'_> {
    /// A receiver, with the normal of its surface.
    pub(super) fn seen(&self, camera: &Camera, receiver: usize) -> Option<Seen> {
        let surface = self.view.surface(self.tracer, camera, self.receivers.pixels[receiver] as usize)?;
        Some(self.receivers.seen(receiver, surface.normal))
    }
}

/// Everything needed to judge one light's maps at any size.
pub struct Judge<'a> {
    on: OnFilm<'a>,
    question: &'a FilmQuestion<'a>,
    /// Matrices and depth ranges, in the order of the regions.
    pub maps: Vec<JudgedMap>,
    /// Scratch of drawing.
    canvas: Canvas,
    certainty: Certainty<'a>,
    /// What it took so far; no fits.
    pub spent: Spent,
}

/// A larger and no bias: what is wrong under a bias and right under one of these is owed to the bias.
pub fn other_biases(bias: Bias) -> [Bias; 2] {
    /// How much larger the larger bias is.
    const LARGER: f64 = 4.0;
    let (constant, slope, clamp) = (bias.constant * LARGER * LARGER, bias.slope * LARGER, bias.clamp * LARGER);
    [Bias { constant, slope, clamp }, Bias::NONE]
}

impl<'a> Judge<'a> {
    /// For fitted regions; finds their depth rows.
    ///
    /// # Errors
    /// [`DepthError`], as [`JudgedMap::of_all`].
    pub fn new(on: OnFilm<'a>, question: &'a FilmQuestion<'a>, fitted: &FittedLight) -> Result<Judge<'a>, DepthError> {
        let maps = JudgedMap::of_all(&fitted.regions, on.tracer, &on.receivers.positions)?;
        Ok(Judge::of_maps(on, question, maps))
    }

    /// For maps whose depth rows are settled.
    pub fn of_maps(on: OnFilm<'a>, question: &'a FilmQuestion<'a>, maps: Vec<JudgedMap>) -> Judge<'a> {
        let OnFilm { tracer, view, receivers, offset } = on;
        let certainty = Certainty::new(tracer, view, question.camera, question.light, receivers, offset);
        Judge { on, question, maps, canvas: Canvas::default(), certainty, spent: Spent::default() }
    }

    /// For each map the receivers that look it up, in the order of the film.
    pub fn own_receivers(&self) -> Vec<Cow<'a, Receivers>> {
        if self.maps.len() == 1 {
            return vec![Cow::Borrowed(self.on.receivers)];
        }
        let mut own = vec![Receivers::default(); self.maps.len()];
        for (i, point) in self.on.receivers.positions.iter().enumerate() {
            if let Some(k) = first_holding(self.maps.iter().map(|m| &m.region.domain), *point) {
                own[k].pixels.push(self.on.receivers.pixels[i]);
                own[k].positions.push(*point);
                own[k].shadowed.push(self.on.receivers.shadowed[i]);
            }
        }
        own.into_iter().map(Cow::Owned).collect()
    }

    /// The matrix of a region over some visible points.
    ///
    /// # Errors
    /// [`DepthError`], as [`JudgedMap::new`].
    pub fn judged(&self, region: &Region, visible: &Visible) -> Result<JudgedMap, DepthError> {
        JudgedMap::new(region.clone(), self.on.tracer, visible)
    }

    /// The smallest limit on wrong pixels that one map meets on its own receivers, some of those judged, if below `limit`.
    pub fn least_limit(
        &mut self,
        map: &JudgedMap,
        size: [u32; 2],
        bias: Bias,
        own: &Receivers,
        limit: f64,
    ) -> Result<Option<f64>, RasterError> {
        let drawn = [self.drawn(map, size, bias)?];
        // Whatever is certain of them, more wrong ones than this are too many.
        let most = match self.question.quality.measure {
            Measure::Full => u64::MAX,
            _ => (limit * UNCERTAIN_SLACK).ceil() as u64,
        };
        let found = fewer_wrong(own, &drawn, self.question.map.outside, most);
        let [Drawn { map: memory, .. }] = drawn;
        self.canvas.map = memory;
        let Some(mut wrong) = found else { return Ok(None) };
        if own.len() < self.on.receivers.len() {
            // Both are in the order of the film.
            let pixels = &self.on.receivers.pixels;
            wrong = wrong
                .iter()
                .filter_map(|i| pixels.binary_search(&own.pixels[*i as usize]).ok())
                .map(|i| i as u32)
                .collect();
        }
        Ok(Some(self.verdict(&wrong).least_limit()).filter(|found| *found < limit))
    }

    fn drawn(&mut self, map: &JudgedMap, [width, height]: [u32; 2], bias: Bias) -> Result<Drawn, RasterError> {
        let (geometry, light, sides) = (self.on.tracer.geometry(), self.question.light, self.question.map.single_sided);
        let keep = |index: u32| sides.draws(geometry, light, index);
        let counts = self.canvas.draw(geometry, &map.clip_from_scene, width, height, bias, keep)?;
        self.spent.texels_drawn += u64::from(width) * u64::from(height);
        self.spent.triangles_drawn += counts.drawn;
        let depth = std::mem::take(&mut self.canvas.map);
        Ok(Drawn { domain: map.region.domain.clone(), clip_from_scene: map.clip_from_scene, map: depth })
    }

    /// Draws all maps at sizes with a bias.
    pub fn draw(&mut self, sizes: &[[u32; 2]], bias: Bias) -> Result<Vec<Drawn>, RasterError> {
        let maps = std::mem::take(&mut self.maps);
        let drawn = maps.iter().zip(sizes).map(|(map, size)| self.drawn(map, *size, bias)).collect();
        self.maps = maps;
        drawn
    }

    /// Receivers answered wrongly by drawn maps.
    pub fn wrong(&self, drawn: &[Drawn]) -> Vec<u32> {
        wrong(self.on.receivers, drawn, self.question.map.outside)
    }

    /// The measured value of a bound at a quantile, pixels: edge distance, or texel footprint.
    pub fn at_quantile(&self, drawn: &[Drawn], wrong: &[u32]) -> f64 {
        let QualityParams { bound, quantile, .. } = *self.question.quality;
        if bound == Bound::Footprint {
            let surface = |pixel: usize| self.on.view.surface(self.on.tracer, self.question.camera, pixel);
            footprint(surface, self.on.view.film, self.question.camera, self.on.receivers, drawn, quantile)
        } else {
            edge_distance(self.on.receivers, wrong, self.question.film, quantile)
        }
    }

    /// Certain and uncertain among wrong receivers.
    pub fn verdict(&self, wrong: &[u32]) -> Verdict {
        self.certainty.verdict(wrong)
    }

    /// Wrong receivers whose exact answer is certain.
    pub fn certain(&self, wrong: &[u32]) -> Vec<u32> {
        wrong.iter().copied().zip(self.certainty.uncertain(wrong)).filter(|(_, u)| !u).map(|(i, _)| i).collect()
    }

    /// What is measured on.
    pub fn on_film(&self) -> OnFilm<'a> {
        self.on
    }

    /// Triangles of the scene.
    pub fn triangles(&self) -> u64 {
        self.on.tracer.geometry().len() as u64
    }

    /// The receivers judged.
    pub fn receivers(&self) -> &Receivers {
        self.on.receivers
    }

    /// Wrong receivers that a larger or no bias answers right: self-shadowing and what the bias hides, not edges.
    pub fn self_shadowed(&mut self, sizes: &[[u32; 2]], bias: Bias, wrong: &[u32]) -> Result<u64, RasterError> {
        Ok((wrong.len() - self.misplaced(sizes, bias, wrong)?.len()) as u64)
    }

    /// Wrong receivers that neither a larger nor no bias answers right: misplaced shadow edges. Looked up by rays, which
    /// takes a ray for each instead of two more maps; drawn where rays do not tell what would be.
    pub fn misplaced(&mut self, sizes: &[[u32; 2]], bias: Bias, wrong: &[u32]) -> Result<Vec<u32>, RasterError> {
        let others = other_biases(bias);
        let FilmQuestion { light, map, .. } = *self.question;
        if self.question.rays_tell() {
            let maps = undrawn(&self.maps, sizes);
            let seen: Vec<(u32, Seen)> =
                wrong.iter().filter_map(|&i| Some((i, self.on.seen(self.question.camera, i as usize)?))).collect();
            let points: Vec<Seen> = seen.iter().map(|(_, seen)| *seen).collect();
            let found = look_up_by_rays(self.on.tracer, light, &maps, &points, others[0].slope);
            self.spent.rays += points.len() as u64;
            let misplaced = |found: &LookedUp| others.iter().all(|other| found.wrong(*other, map.outside));
            return Ok(seen.iter().zip(&found).filter(|(_, f)| misplaced(f)).map(|((i, _), _)| *i).collect());
        }
        let mut edge = wrong.to_vec();
        for other in others {
            let drawn = self.draw(sizes, other)?;
            let answer = |i: usize| answers_shadowed(&drawn, self.on.receivers.positions[i], map.outside);
            edge.retain(|i| answer(*i as usize) != self.on.receivers.shadowed[*i as usize]);
        }
        Ok(edge)
    }
}
