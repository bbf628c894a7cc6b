//! The sizes that a unit's maps may have, finely enough that marginal gains can be equal.

use super::super::LightPlan;
use super::measure::Sizes;
use crate::resolution::{AspectRule, MapParams, SizeGrid, texels};

/// Ratio of neighbouring sides before rounding to whole texels: 0.4 % of the texels, and of their gain less than 1 %.
pub(super) const STEP: f64 = 1.002;

/// Ratio of the texels of neighbouring sizes that a curve is first measured at.
pub(super) const COARSE: f64 = 2.0;

/// Legal sizes, ascending.
pub(in crate::plan) struct Ladder {
    grid: SizeGrid,
    /// Texels of each place.
    pub(in crate::plan) texels: Vec<f64>,
}

impl Ladder {
    /// Of entries that share maps, along the aspects and shares that these were planned with; `step` is the ratio of
    /// neighbouring sides before rounding to whole texels.
    pub(in crate::plan) fn of(entries: &[&LightPlan], params: &MapParams, step: f64) -> Ladder {
        let planned: Sizes = entries.first().map(|e| sizes_of(e)).unwrap_or_default();
        let all = texels(&planned) as f64;
        let share = |size: [u32; 2]| texels(&[size]) as f64 / all;
        let mut maps: Vec<(f64, f64)> = planned.iter().map(|size| (aspect(*size), share(*size))).collect();
        if let [(alone, _)] = &mut maps[..] {
            // Of the sizes tried the largest is rounded least.
            let tried = entries.iter().flat_map(|e| e.error.iter().flat_map(|e| &e.tried)).map(|t| [t.width, t.height]);
            *alone = tried.chain(planned).max_by_key(|size| texels(&[*size])).map_or(1.0, aspect);
        }
        if params.square || params.aspect == AspectRule::Fixed {
            maps.iter_mut().for_each(|(aspect, _)| *aspect = 1.0);
        }
        let grid = SizeGrid::new(&maps, &MapParams { step, ..params.clone() });
        let texels = (0..grid.len()).map(|place| grid.texels(place)).collect();
        Ladder { grid, texels }
    }

    /// The sizes of a place.
    pub(in crate::plan) fn sizes(&self, place: usize) -> Sizes {
        self.grid.sizes(place).to_vec()
    }

    /// The last place with at most so many texels; else the first.
    pub(in crate::plan) fn at_most(&self, texels: f64) -> usize {
        self.texels.partition_point(|t| *t <= texels).saturating_sub(1)
    }

    /// Places to measure a curve at: from the smallest up to some texels, each [`COARSE`] times the one before.
    pub(super) fn coarse(&self, most: f64) -> Vec<usize> {
        let mut places = vec![self.at_most(most)];
        let mut texels = self.texels[places[0]];
        while places.last() != Some(&0) {
            texels /= COARSE;
            places.push(self.at_most(texels));
        }
        places.dedup();
        places.reverse();
        places
    }
}

/// The sizes of an entry's maps.
pub(super) fn sizes_of(entry: &LightPlan) -> Sizes {
    entry.maps.iter().map(|m| [m.width, m.height]).collect()
}

fn aspect([width, height]: [u32; 2]) -> f64 {
    f64::from(width) / f64::from(height)
}
