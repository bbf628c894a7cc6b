//! Texels of each map from the budget of a light.

use super::Question;
use crate::fit::Aspect;
use crate::methods::Region;
use crate::raster::SIZE_MAX;
use crate::resolution::{AspectRule, MapParams};

/// The texels that the methods are told of; `None` when they are searched.
pub(super) fn texels(question: Question) -> Option<f64> {
    match question {
        Question::Texels(texels) => Some(f64::from(texels)),
        Question::Resolution([width, height]) => Some(f64::from(width) * f64::from(height)),
        Question::Epsilon => None,
    }
}

/// The aspect that the methods are told of.
pub(super) fn aspect(question: Question, map: &MapParams) -> Aspect {
    match question {
        Question::Resolution([width, height]) => Aspect::Fixed(f64::from(width) / f64::from(height)),
        _ if map.aspect == AspectRule::Fixed || map.square => Aspect::Fixed(1.0),
        _ => Aspect::Free,
    }
}

/// Width and height of each region's map: its share of the texels at its aspect, never more.
pub(crate) fn sizes(regions: &[Region], shares: &[f64], texels: f64) -> Vec<[u32; 2]> {
    regions.iter().zip(shares).map(|(region, share)| size(region.aspect, texels * share)).collect()
}

/// The same of one map.
pub(super) fn size(aspect: f64, texels: f64) -> [u32; 2] {
    let most = f64::from(SIZE_MAX);
    let side = |t: f64| t.clamp(1.0, most);
    // The longer side is rounded: the other one then changes least.
    if aspect >= 1.0 {
        let width = side((texels * aspect).sqrt().round().min(texels));
        [width as u32, side((texels / width).floor()) as u32]
    } else {
        let height = side((texels / aspect).sqrt().round().min(texels));
        [side((texels / height).floor()) as u32, height as u32]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_spend_the_texels_and_no_more() {
        for aspect in [1e-9, 0.01, 0.3, 1.0, 1.7, 25.0, 1e9] {
            let [w, h] = size(aspect, 160_000.0);
            let spent = u64::from(w) * u64::from(h);
            assert!(spent <= 160_000, "{aspect}: {w}x{h}");
            if (0.01..100.0).contains(&aspect) {
                assert!(spent as f64 > 0.97 * 160_000.0, "{aspect}: {w}x{h}");
                let got = f64::from(w) / f64::from(h);
                assert!((got / aspect).ln().abs() < 0.03, "{aspect}: {w}x{h}");
            }
        }
        assert_eq!(size(1.0, 160_000.0), [400, 400]);
        assert_eq!(size(1.0, 0.2), [1, 1]);
    }
}
