//! A segment on its way through the frames: what is settled so far.

use super::super::LightPlan;
use super::window::Window;
use crate::measure::Drawn;
use crate::raster::Bias;
use crate::resolution::{FittedLight, JudgedMap, SizeGrid, Trial};
use crate::shot::{Asked, Content, LightParts, Segment};
use std::collections::BTreeMap;

/// A segment and what is known of it.
pub(super) struct Held {
    pub(super) segment: Segment,
    /// Its regions, in the light's frame.
    pub(super) fitted: FittedLight,
    /// The sizes it may have.
    pub(super) grid: SizeGrid,
    /// Of each region the part that a frame's map holds; none when that is all of it.
    pub(super) windows: Vec<Window>,
    /// Its matrices, once the depth range is known.
    pub(super) maps: Vec<JudgedMap>,
    pub(super) bias: Option<Bias>,
    /// Place on the grid: the size so far.
    pub(super) size: usize,
    /// Place of the frame that needs this size; `None` when nothing is measured.
    pub(super) decided_by: Option<usize>,
    /// What moves in the maps, by frame.
    pub(super) contents: BTreeMap<usize, Content>,
    /// All sizes tried, by frame, in order, each with its place on the grid.
    pub(super) tried: BTreeMap<usize, Vec<(usize, Trial)>>,
    /// Finished entries with the place on the grid they were measured at.
    pub(super) entries: BTreeMap<usize, LightPlan>,
    /// The place on the grid of each finished entry.
    pub(super) entered_at: BTreeMap<usize, usize>,
    /// The maps drawn last: frame and place on the grid.
    pub(super) drawn: Option<(usize, usize, Vec<Drawn>)>,
    /// The bound is missed at the largest size.
    pub(super) missed: bool,
}

impl Held {
    /// Nothing settled yet.
    pub(super) fn new(segment: Segment, asked: &Asked) -> Held {
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
            contents: BTreeMap::new(),
            tried: BTreeMap::new(),
            entries: BTreeMap::new(),
            entered_at: BTreeMap::new(),
            drawn: None,
            missed: false,
        };
        held.refit(asked);
        held
    }

    /// After the regions were changed.
    pub(super) fn refit(&mut self, asked: &Asked) {
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
    pub(super) fn predicted_decider(&self) -> usize {
        self.segment.needing[self.segment.interval.decides]
    }

    /// Whether two frames draw the same maps at a place on the grid.
    pub(super) fn same_maps(&self, a: usize, b: usize, place: usize, light: &LightParts) -> bool {
        let (sizes, windows) = (self.grid.sizes(place), self.windows.iter());
        windows.zip(sizes).all(|(w, size)| w.snapped(a, *size) == w.snapped(b, *size))
            && light.poses[a] == light.poses[b]
            && self.contents.contains_key(&a)
            && self.contents.get(&a) == self.contents.get(&b)
    }

    /// Measured over predicted texels; where the largest size was not enough, by the error left there.
    pub(super) fn measured_over_predicted(&self) -> f64 {
        let ratio = self.grid.texels(self.size) / self.segment.interval.texels.max(1.0);
        // Errors fall with the side, so that texels grow with the square of the error.
        if self.missed { ratio.max(1.0) * 4.0 } else { ratio }
    }
}
