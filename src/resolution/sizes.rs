//! The grid of sizes that a search may choose from.

use super::{AspectRule, MapParams, TEXELS_MAX};
use serde::{Deserialize, Serialize};

/// Sizes along the optimal aspects of a light's maps, ascending; each entry has a size for every map.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct SizeGrid {
    sizes: Vec<Vec<[u32; 2]>>,
}

impl SizeGrid {
    /// `maps` are (aspect, share of the texels) of each map. Neighbouring entries differ by `step` along each side before
    /// rounding; entries that round to the same sizes are one. Ends where a map would pass `max`, or all of them together
    /// [`TEXELS_MAX`].
    pub fn new(maps: &[(f64, f64)], params: &MapParams) -> SizeGrid {
        let mut sizes: Vec<Vec<[u32; 2]>> = Vec::new();
        let mut side = f64::from(params.min);
        let last = f64::from(params.max) * f64::from(params.max);
        while side <= last {
            let entry: Vec<[u32; 2]> = maps
                .iter()
                .map(|(aspect, share)| {
                    let texels = side * side * share;
                    let (w, h) = ((texels * aspect).sqrt(), (texels / aspect).sqrt());
                    legal(w, h, params)
                })
                .collect();
            // Raw sides past the largest legal one end the grid; the last entry may touch it.
            let over = maps.iter().any(|(aspect, share)| {
                side * (share * aspect.max(1.0 / aspect)).sqrt() > f64::from(params.max) * params.step
            });
            if (over || texels(&entry) > TEXELS_MAX) && !sizes.is_empty() {
                break;
            }
            if sizes.last() != Some(&entry) {
                sizes.push(entry);
            }
            side *= params.step;
        }
        SizeGrid { sizes }
    }

    /// Number of entries; at least one.
    pub fn len(&self) -> usize {
        self.sizes.len()
    }

    /// True without entries.
    pub fn is_empty(&self) -> bool {
        self.sizes.is_empty()
    }

    /// The sizes of an entry, one for each map.
    pub fn sizes(&self, index: usize) -> &[[u32; 2]] {
        &self.sizes[index]
    }

    /// Texels of an entry.
    pub fn texels(&self, index: usize) -> f64 {
        texels(&self.sizes[index]) as f64
    }

    /// The first entry with at least so many texels, else the last.
    pub fn at_least(&self, texels: f64) -> usize {
        (0..self.len()).find(|i| self.texels(*i) >= texels).unwrap_or(self.len().saturating_sub(1))
    }
}

/// The nearest legal size.
fn legal(width: f64, height: f64, params: &MapParams) -> [u32; 2] {
    let [mut w, mut h] = [width, height].map(|side| {
        let side = side.clamp(f64::from(params.min), f64::from(params.max));
        if params.power_of_two {
            2_u32.pow(side.log2().round().clamp(0.0, 31.0) as u32)
        } else {
            let unit = params.multiple_of.max(1);
            ((side / f64::from(unit)).round() as u32).max(1) * unit
        }
        .clamp(1, params.max)
    });
    if params.square || params.aspect == AspectRule::Fixed {
        w = w.max(h);
        h = w;
    }
    [w, h]
}

/// Texels of maps together.
pub fn texels(sizes: &[[u32; 2]]) -> u64 {
    sizes.iter().map(|[w, h]| u64::from(*w) * u64::from(*h)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grids_ascend_and_stay_legal() {
        let base = MapParams::default();
        for params in [
            base.clone(),
            MapParams { power_of_two: true, ..base.clone() },
            MapParams { multiple_of: 64, min: 64, ..base.clone() },
            MapParams { square: true, max: 1000, ..base.clone() },
        ] {
            let grid = SizeGrid::new(&[(3.0, 0.75), (0.5, 0.25)], &params);
            assert!(grid.len() > 3);
            for i in 0..grid.len() {
                for [w, h] in grid.sizes(i) {
                    assert!((*w).max(*h) <= params.max && (*w).min(*h) >= params.min.min(params.max));
                    assert!(!params.power_of_two || (w.is_power_of_two() && h.is_power_of_two()));
                    assert!(!params.square || w == h);
                    assert!(w % params.multiple_of == 0 && h % params.multiple_of == 0);
                }
                assert!(i == 0 || grid.texels(i) > grid.texels(i - 1));
            }
        }
    }

    #[test]
    fn steps_are_those_asked_for() {
        let grid = SizeGrid::new(&[(1.0, 1.0)], &MapParams { min: 100, max: 4096, ..MapParams::default() });
        for i in 1..grid.len() {
            let ratio = f64::from(grid.sizes(i)[0][0]) / f64::from(grid.sizes(i - 1)[0][0]);
            assert!(ratio > 1.0 && ratio < 1.035, "{ratio}");
        }
    }
}
