//! Draws a light's maps at a size and judges every film pixel, certain and uncertain apart.

use super::{Bound, FilmQuestion, FittedLight, Measure, QualityParams};
use crate::depth::{DepthError, DepthRow, Kept, RowKind, Visible, fit_row};
use crate::fit::Shape;
use crate::math::first_holding;
use crate::measure::{
    Certainty, Drawn, Receivers, UNCERTAIN_SLACK, Verdict, edge_distance, fewer_wrong, footprint, wrong,
};
use crate::methods::Region;
use crate::raster::{Bias, Canvas, RasterError};
use crate::visibility::{RayOffset, Tracer, View};
use glam::{DMat4, DVec3, DVec4};
use serde::{Deserialize, Serialize};
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

/// Everything needed to judge one light's maps at any size.
pub struct Judge<'a> {
    tracer: &'a Tracer<'a>,
    view: &'a View,
    question: &'a FilmQuestion<'a>,
    receivers: &'a Receivers,
    /// Matrices and depth ranges, in the order of the regions.
    pub maps: Vec<JudgedMap>,
    /// Scratch of drawing.
    canvas: Canvas,
    certainty: Certainty<'a>,
    /// Texels drawn so far.
    pub texels_drawn: u64,
    /// Triangles drawn so far.
    pub triangles_drawn: u64,
}

/// A region's matrix.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct JudgedMap {
    /// The region.
    pub region: Region,
    /// OpenGL clip space from scene space.
    pub clip_from_scene: DMat4,
    /// Its depth row and range.
    pub depth: DepthRow,
}

impl JudgedMap {
    /// The matrices of all regions of a light; each receiver counts for the region that answers for it.
    ///
    /// # Errors
    /// [`DepthError`]: nothing visible looks a map up, or it has no finite depth row.
    pub fn of_all(regions: &[Region], tracer: &Tracer, receivers: &[DVec3]) -> Result<Vec<JudgedMap>, DepthError> {
        JudgedMap::of_all_by(regions, receivers, |region, own| JudgedMap::kept(region, tracer, &Visible::new(own)))
    }

    /// The same, with what a region keeps, given the receivers it answers for, found by the caller.
    ///
    /// # Errors
    /// As [`JudgedMap::of_all`].
    pub fn of_all_by<'a>(
        regions: &[Region],
        receivers: &[DVec3],
        kept: impl Fn(&Region, &[DVec3]) -> Kept<'a>,
    ) -> Result<Vec<JudgedMap>, DepthError> {
        if let [region] = regions {
            return Ok(vec![JudgedMap::holding(region.clone(), &kept(region, receivers))?]);
        }
        let mut own = vec![Vec::new(); regions.len()];
        for point in receivers {
            if let Some(k) = first_holding(regions.iter().map(|r| &r.domain), *point) {
                own[k].push(*point);
            }
        }
        regions.iter().zip(own).map(|(region, own)| JudgedMap::holding(region.clone(), &kept(region, &own))).collect()
    }

    /// The matrix of a region with the depth row that holds what is visible and its casters.
    ///
    /// # Errors
    /// [`DepthError`]: nothing visible looks the map up, or it has no finite depth row.
    pub fn new(region: Region, tracer: &Tracer, visible: &Visible) -> Result<JudgedMap, DepthError> {
        let kept = JudgedMap::kept(&region, tracer, visible);
        JudgedMap::holding(region, &kept)
    }

    /// What a region's depth range has to hold: those of the visible points that look it up, and their casters.
    pub fn kept<'a>(region: &Region, tracer: &'a Tracer<'a>, visible: &Visible) -> Kept<'a> {
        Kept::new(tracer, &region.space, &region.h, visible, &region.domain)
    }

    /// The matrix of a region with the depth row that holds what is kept.
    ///
    /// # Errors
    /// [`DepthError`]: nothing is kept, or it has no finite row.
    pub fn holding(region: Region, kept: &Kept) -> Result<JudgedMap, DepthError> {
        let depth = fit_row(kept, row_kind(&region))?;
        Ok(JudgedMap { clip_from_scene: clip_from_scene(&region, depth.row), region, depth })
    }
}

/// A larger and no bias: what is wrong under a bias and right under one of these is owed to the bias.
pub fn other_biases(bias: Bias) -> [Bias; 2] {
    /// How much larger the larger bias is.
    const LARGER: f64 = 4.0;
    let (constant, slope, clamp) = (bias.constant * LARGER * LARGER, bias.slope * LARGER, bias.clamp * LARGER);
    [Bias { constant, slope, clamp }, Bias::NONE]
}

/// Which depth rows a region may have. A camera's: for directional lights when p4 is constant, that is without a warp; for
/// point and spot lights wherever the job asks for cameras, and else unless that costs depth.
fn row_kind(region: &Region) -> RowKind {
    let p4 = region.h.row(2);
    match (region.space.directional, region.shape()) {
        (true, _) if p4.x == 0.0 && p4.y == 0.0 => RowKind::Plain,
        (true, _) => RowKind::Free,
        (false, Shape::Projective) => RowKind::PlainIfFine,
        (false, Shape::Affine | Shape::Rectangle) => RowKind::Plain,
    }
}

/// The light matrix of a region: its unit square becomes clip space [-1, 1]².
fn clip_from_scene(region: &Region, depth_row: DVec4) -> DMat4 {
    let unit = region.space.clip_from_scene(&region.h, depth_row);
    let clip_from_unit = DMat4::from_cols(
        DVec4::new(2.0, 0.0, 0.0, 0.0),
        DVec4::new(0.0, 2.0, 0.0, 0.0),
        DVec4::new(0.0, 0.0, 1.0, 0.0),
        DVec4::new(-1.0, -1.0, 0.0, 1.0),
    );
    clip_from_unit * unit
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
        Judge {
            tracer,
            view,
            question,
            receivers,
            maps,
            canvas: Canvas::default(),
            certainty,
            texels_drawn: 0,
            triangles_drawn: 0,
        }
    }

    /// For each map the receivers that look it up, in the order of the film.
    pub fn own_receivers(&self) -> Vec<Cow<'a, Receivers>> {
        if self.maps.len() == 1 {
            return vec![Cow::Borrowed(self.receivers)];
        }
        let mut own = vec![Receivers::default(); self.maps.len()];
        for (i, point) in self.receivers.positions.iter().enumerate() {
            if let Some(k) = first_holding(self.maps.iter().map(|m| &m.region.domain), *point) {
                own[k].pixels.push(self.receivers.pixels[i]);
                own[k].positions.push(*point);
                own[k].shadowed.push(self.receivers.shadowed[i]);
            }
        }
        own.into_iter().map(Cow::Owned).collect()
    }

    /// The matrix of a region over some visible points.
    ///
    /// # Errors
    /// [`DepthError`], as [`JudgedMap::new`].
    pub fn judged(&self, region: &Region, visible: &Visible) -> Result<JudgedMap, DepthError> {
        JudgedMap::new(region.clone(), self.tracer, visible)
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
        if own.len() < self.receivers.len() {
            // Both are in the order of the film.
            let pixels = &self.receivers.pixels;
            wrong = wrong
                .iter()
                .filter_map(|i| pixels.binary_search(&own.pixels[*i as usize]).ok())
                .map(|i| i as u32)
                .collect();
        }
        Ok(Some(self.verdict(&wrong).least_limit()).filter(|found| *found < limit))
    }

    fn drawn(&mut self, map: &JudgedMap, [width, height]: [u32; 2], bias: Bias) -> Result<Drawn, RasterError> {
        let (geometry, light, sides) = (self.tracer.geometry(), self.question.light, self.question.map.single_sided);
        let keep = |index: u32| sides.draws(geometry, light, index);
        let counts = self.canvas.draw(geometry, &map.clip_from_scene, width, height, bias, keep)?;
        self.texels_drawn += u64::from(width) * u64::from(height);
        self.triangles_drawn += counts.drawn;
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
        wrong(self.receivers, drawn, self.question.map.outside)
    }

    /// The measured value of a bound at a quantile, pixels: edge distance, or texel footprint.
    pub fn at_quantile(&self, drawn: &[Drawn], wrong: &[u32]) -> f64 {
        let QualityParams { bound, quantile, .. } = *self.question.quality;
        if bound == Bound::Footprint {
            let surface = |pixel: usize| self.view.surface(self.tracer, self.question.camera, pixel);
            footprint(surface, self.view.film, self.question.camera, self.receivers, drawn, quantile)
        } else {
            edge_distance(self.receivers, wrong, self.question.film, quantile)
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

    /// Triangles of the scene.
    pub fn triangles(&self) -> u64 {
        self.tracer.geometry().len() as u64
    }

    /// The receivers judged.
    pub fn receivers(&self) -> &Receivers {
        self.receivers
    }

    /// Wrong receivers that a larger or no bias answers right: self-shadowing and what the bias hides, not edges.
    pub fn self_shadowed(&mut self, sizes: &[[u32; 2]], bias: Bias, wrong: &[u32]) -> Result<u64, RasterError> {
        Ok((wrong.len() - self.misplaced(sizes, bias, wrong)?.len()) as u64)
    }

    /// Wrong receivers that neither a larger nor no bias answers right: misplaced shadow edges.
    pub fn misplaced(&mut self, sizes: &[[u32; 2]], bias: Bias, wrong: &[u32]) -> Result<Vec<u32>, RasterError> {
        let mut edge = wrong.to_vec();
        for other in other_biases(bias) {
            let drawn = self.draw(sizes, other)?;
            let still_wrong = self.wrong(&drawn);
            edge.retain(|i| still_wrong.binary_search(i).is_ok());
        }
        Ok(edge)
    }
}
