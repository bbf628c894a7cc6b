//! Draws a light's maps at a size and judges every film pixel, certain and uncertain apart.

use super::{Bound, FilmQuestion, FittedLight, QualityParams};
use crate::depth::{DepthError, DepthRow, Kept, fit_row, kept_points};
use crate::measure::{Certainty, Drawn, Receivers, Verdict, edge_distance, footprint, wrong};
use crate::methods::Region;
use crate::raster::{Bias, Canvas, RasterError};
use crate::scene::Geometry;
use crate::visibility::{RayOffset, Tracer, View};
use glam::{DMat4, DVec3, DVec4};

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
#[derive(Clone, Debug)]
pub struct JudgedMap {
    /// The region.
    pub region: Region,
    /// OpenGL clip space from scene space.
    pub clip_from_scene: DMat4,
    /// Its depth row and range.
    pub depth: DepthRow,
}

impl JudgedMap {
    /// The matrix of a region with the depth row that holds `receivers` and their casters.
    pub fn new(region: Region, geometry: Geometry, receivers: &[DVec3]) -> Result<JudgedMap, DepthError> {
        let kept = JudgedMap::kept(&region, geometry, receivers);
        JudgedMap::holding(region, &kept)
    }

    /// What a region's depth range has to hold: those of `receivers` that look it up, and their casters.
    pub fn kept(region: &Region, geometry: Geometry, receivers: &[DVec3]) -> Kept {
        let looks_up = |p: &DVec3| region.domain.holds(*p) && region.contains(*p);
        let inside: Vec<DVec3> = receivers.iter().copied().filter(looks_up).collect();
        kept_points(geometry, &region.space, &region.h, &inside)
    }

    /// The matrix of a region with the depth row that holds what is kept.
    pub fn holding(region: Region, kept: &Kept) -> Result<JudgedMap, DepthError> {
        let depth = fit_row(&region.space, &region.h, kept, region.is_camera())?;
        Ok(JudgedMap { clip_from_scene: clip_from_scene(&region, depth.row), region, depth })
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
    pub fn new(
        tracer: &'a Tracer<'a>,
        view: &'a View,
        question: &'a FilmQuestion<'a>,
        fitted: &FittedLight,
        receivers: &'a Receivers,
        offset: RayOffset,
    ) -> Result<Judge<'a>, DepthError> {
        let new = |region: &Region| JudgedMap::new(region.clone(), tracer.geometry(), &receivers.positions);
        let maps = fitted.regions.iter().map(new).collect::<Result<_, _>>()?;
        Ok(Judge::of_maps(tracer, view, question, maps, receivers, offset))
    }

    /// For maps whose depth rows are settled.
    pub fn of_maps(
        tracer: &'a Tracer<'a>,
        view: &'a View,
        question: &'a FilmQuestion<'a>,
        maps: Vec<JudgedMap>,
        receivers: &'a Receivers,
        offset: RayOffset,
    ) -> Judge<'a> {
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

    /// The matrix of a region over the same receivers.
    pub fn judged(&self, region: &Region) -> Result<JudgedMap, DepthError> {
        JudgedMap::new(region.clone(), self.tracer.geometry(), &self.receivers.positions)
    }

    /// Draws all maps at sizes with a bias.
    pub fn draw(&mut self, sizes: &[[u32; 2]], bias: Bias) -> Result<Vec<Drawn>, RasterError> {
        let mut drawn = Vec::with_capacity(self.maps.len());
        for (map, [width, height]) in self.maps.iter().zip(sizes) {
            let counts =
                self.canvas.draw(self.tracer.geometry(), &map.clip_from_scene, *width, *height, bias, |_| true)?;
            self.texels_drawn += u64::from(*width) * u64::from(*height);
            self.triangles_drawn += counts.drawn;
            drawn.push(Drawn {
                domain: map.region.domain,
                clip_from_scene: map.clip_from_scene,
                map: std::mem::take(&mut self.canvas.map),
            });
        }
        Ok(drawn)
    }

    /// Receivers answered wrongly by drawn maps.
    pub fn wrong(&self, drawn: &[Drawn]) -> Vec<u32> {
        wrong(self.receivers, drawn, self.question.map.outside)
    }

    /// The measured value of a bound at a quantile, pixels: edge distance, or texel footprint.
    pub fn at_quantile(&self, drawn: &[Drawn], wrong: &[u32]) -> f64 {
        let QualityParams { bound, quantile, .. } = *self.question.quality;
        if bound == Bound::Footprint {
            footprint(self.tracer, self.view, self.question.camera, self.receivers, drawn, quantile)
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
        /// How much larger the larger bias is.
        const LARGER: f64 = 4.0;
        let larger =
            Bias { constant: bias.constant * LARGER * LARGER, slope: bias.slope * LARGER, clamp: bias.clamp * LARGER };
        let mut edge = wrong.to_vec();
        for other in [larger, Bias::NONE] {
            let drawn = self.draw(sizes, other)?;
            let still_wrong = self.wrong(&drawn);
            edge.retain(|i| still_wrong.binary_search(i).is_ok());
        }
        Ok(edge)
    }
}
