//! Pictures of a shadow map.

use glam::DVec2;

use super::super::MapPlan;
use super::super::remeasure::Remeasured;
use super::super::seen::uv_of;
use crate::math::{convex_hull, first_holding};
use crate::picture::{Channel, Colour, Picture, mix, scaled};
use crate::raster::{DepthMap, FAR};

/// Longest side of a depth view, pixels; a larger map is shown smaller, each pixel the nearest depth of its texels.
const LONGEST: u32 = 1024;
/// Where nothing was drawn.
const EMPTY: Colour = [22, 26, 44];
/// Looked up by a pixel that is in shadow.
const SHADOWED: Colour = [255, 128, 32];
/// Looked up by a pixel that is lit.
const LIT: Colour = [64, 200, 120];
/// Hull of what is covered: the pixels in shadow.
const OUTLINE: Colour = [255, 255, 255];

/// Depth as grey, nearer is brighter; tinted where film pixels look the map up; the hull of those in shadow as a line.
/// `k` is the number of the map among the light's.
pub(super) fn depth_view(map: &MapPlan, k: usize, measured: &Remeasured) -> Picture {
    let drawn = &measured.drawn[k];
    let block = map.width.max(map.height).div_ceil(LONGEST).max(1);
    let (width, height) = (map.width.div_ceil(block), map.height.div_ceil(block));
    let nearest = nearest_by_block(&drawn.map, block, [width, height]);
    let [near, far] = shown_range(&nearest);
    let mut picture = Picture::from_fn(width, height, |pixel| match nearest[pixel] {
        FAR => EMPTY,
        depth => {
            let part = f64::from((depth - near) / (far - near).max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
            scaled([255; 3], 0.9 - 0.7 * part)
        }
    });
    // Film pixels by where they look the map up: lit first, so that what has to be covered is seen.
    let receivers = &measured.receivers;
    let mut covered = Vec::new();
    for wanted in [false, true] {
        for (point, shadowed) in receivers.positions.iter().zip(&receivers.shadowed) {
            if *shadowed != wanted || first_holding(measured.drawn.iter().map(|d| &d.domain), *point) != Some(k) {
                continue;
            }
            let Some((uv, _)) = uv_of(&drawn.clip_from_scene, *point) else { continue };
            if uv.cmplt(DVec2::ZERO).any() || uv.cmpge(DVec2::ONE).any() {
                continue;
            }
            let at = shown_at(uv, map, block, height);
            let pixel = at.y as usize * width as usize + at.x as usize;
            if let Some(shown) = picture.pixels.get_mut(pixel) {
                *shown = mix(*shown, if wanted { SHADOWED } else { LIT }, 0.5);
            }
            if wanted {
                covered.push(uv);
            }
        }
    }
    let hull = convex_hull(&covered);
    for (i, corner) in hull.iter().enumerate() {
        let next = hull[(i + 1) % hull.len()];
        picture.line(shown_at(*corner, map, block, height), shown_at(next, map, block, height), OUTLINE);
    }
    picture
}

/// Position in the picture of map coordinates: the map's first row is the picture's last.
fn shown_at(uv: DVec2, map: &MapPlan, block: u32, height: u32) -> DVec2 {
    let texel = uv * DVec2::new(f64::from(map.width), f64::from(map.height)) / f64::from(block);
    DVec2::new(texel.x, (f64::from(height) - texel.y).max(0.0))
}

/// The nearest depth of each block of texels, top row first.
fn nearest_by_block(map: &DepthMap, block: u32, [width, height]: [u32; 2]) -> Vec<f32> {
    let mut nearest = vec![FAR; width as usize * height as usize];
    for (row, depths) in map.depth.chunks(map.width.max(1) as usize).enumerate() {
        let y = height as usize - 1 - row / block as usize;
        for (column, depth) in depths.iter().enumerate() {
            let shown = &mut nearest[y * width as usize + column / block as usize];
            *shown = shown.min(*depth);
        }
    }
    nearest
}

/// The depths shown as brightest and darkest: all but the outermost hundredth of what was drawn.
fn shown_range(depths: &[f32]) -> [f32; 2] {
    let mut drawn: Vec<f32> = depths.iter().copied().filter(|d| *d < FAR).collect();
    drawn.sort_unstable_by(f32::total_cmp);
    let at = |part: f64| drawn.get(((drawn.len() as f64 - 1.0) * part).max(0.0) as usize).copied();
    [at(0.01).unwrap_or(0.0), at(0.99).unwrap_or(FAR)]
}

/// The map as it is, top row first.
pub(super) fn depth_channel(map: &DepthMap) -> Channel {
    let rows = map.depth.chunks(map.width.max(1) as usize).rev();
    Channel { name: "Z".to_owned(), values: rows.flatten().copied().collect() }
}
