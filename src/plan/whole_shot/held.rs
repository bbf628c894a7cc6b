//! A segment on its way from a matrix to a certified size.

use super::super::Choice;
use super::super::pieces::as_json;
use super::window::{self, Window};
use crate::math::RigidMotion;
use crate::raster::Bias;
use crate::resolution::{FittedLight, JudgedMap, SizeGrid};
use crate::shot::{Asked, Segment};
use serde::{Deserialize, Serialize};

/// A segment and what is known of it.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(in crate::plan) struct Held {
    pub(in crate::plan) segment: Segment,
    /// Its regions, in the light's frame.
    pub(in crate::plan) fitted: FittedLight,
    /// The sizes it may have.
    pub(in crate::plan) grid: SizeGrid,
    /// Of each region the part that a frame's map holds; none when that is all of it.
    pub(in crate::plan) windows: Vec<Window>,
    /// Its matrices, once the depth range is known.
    pub(in crate::plan) maps: Vec<JudgedMap>,
    /// Absent where nothing is measured.
    pub(in crate::plan) bias: Option<Bias>,
    /// Place on the grid: the size so far.
    pub(in crate::plan) size: usize,
    /// Place of the frame that needs this size; `None` when nothing is measured.
    pub(in crate::plan) decided_by: Option<usize>,
    /// The bound is missed at the largest size.
    pub(in crate::plan) missed: bool,
    /// How its method was chosen, where that was asked.
    #[serde(with = "as_json")]
    pub(in crate::plan) choice: Option<Choice>,
}

impl Held {
    /// Nothing settled yet.
    pub(in crate::plan) fn new(segment: Segment, asked: &Asked) -> Held {
        let fitted = segment.interval.fitted.clone();
        let mut held = Held {
            segment,
            grid: SizeGrid::new(&[], asked.map),
            fitted,
            windows: Vec::new(),
            maps: Vec::new(),
            bias: None,
            size: 0,
            decided_by: None,
            missed: false,
            choice: None,
        };
        held.refit(asked);
        held
    }

    /// After the regions were changed.
    pub(in crate::plan) fn refit(&mut self, asked: &Asked) {
        let parts = self.fitted.regions.iter().zip(&self.fitted.shares);
        let maps: Vec<(f64, f64)> = if self.windows.is_empty() {
            parts.map(|(r, share)| (r.aspect, *share)).collect()
        } else {
            let areas: Vec<f64> = parts.clone().zip(&self.windows).map(|((_, s), w)| s * w.size.x * w.size.y).collect();
            let all: f64 = areas.iter().sum();
            self.fitted.texels *= all;
            let aspects = parts.zip(&self.windows).map(|((r, _), w)| r.aspect * w.size.x / w.size.y);
            aspects.zip(&areas).map(|(aspect, area)| (aspect, area / all)).collect()
        };
        self.grid = SizeGrid::new(&maps, asked.map);
        self.size = self.grid.at_least(self.fitted.texels);
    }

    /// The frame that is predicted to need most texels.
    pub(in crate::plan) fn predicted_decider(&self) -> usize {
        self.segment.needing[self.segment.interval.decides]
    }

    /// The maps of a frame at a place on the grid, as they stand where `motion` takes the frame's points to where they stand
    /// for the segment. `None` where a domain does not move with its light.
    pub(in crate::plan) fn maps_at(
        &self,
        frame: usize,
        place: usize,
        motion: Option<&RigidMotion>,
    ) -> Option<Vec<JudgedMap>> {
        let maps = window::maps(self, frame, place);
        let Some(motion) = motion else { return Some(maps) };
        let matrix = motion.matrix();
        maps.into_iter()
            .map(|map| {
                let mut depth = map.depth;
                depth.row = matrix.transpose() * depth.row;
                let clip_from_scene = map.clip_from_scene * matrix;
                Some(JudgedMap { region: map.region.carried(motion)?, clip_from_scene, depth })
            })
            .collect()
    }

    /// Whether the maps of two frames are the same part of the segment's.
    pub(in crate::plan) fn same_window(&self, a: usize, b: usize) -> bool {
        let sizes = self.grid.sizes(self.size);
        self.windows.iter().zip(sizes).all(|(w, size)| w.snapped(a, *size) == w.snapped(b, *size))
    }

    /// Measured over predicted texels; where the largest size was not enough, by the error left there.
    pub(in crate::plan) fn measured_over_predicted(&self) -> f64 {
        let ratio = self.grid.texels(self.size) / self.segment.interval.texels.max(1.0);
        // Errors fall with the side, so that texels grow with the square of the error.
        if self.missed { ratio.max(1.0) * 4.0 } else { ratio }
    }

    /// Without the edges that its regions were fitted to, which nothing asks for once the matrix is settled.
    pub(in crate::plan) fn settled(mut self) -> Held {
        self.fitted
            .regions
            .iter_mut()
            .chain(&mut self.segment.interval.fitted.regions)
            .for_each(|r| *r = r.over(&[], 0));
        self.maps.iter_mut().for_each(|map| map.region = map.region.over(&[], 0));
        self.fitted.covered.clear();
        self.segment.interval.fitted.covered.clear();
        self
    }
}
