//! Maps of one orientation and size that move by whole texels: a window of the shot's map for each frame.
//!
//! A window of W texels is one texel wider than what it has to hold, so that its corner can stand on a whole texel of the
//! shot's map: what is drawn to a texel is then the same in every frame (the "texel snapping" of cascades).

use super::held::Held;
use crate::resolution::JudgedMap;
use crate::shot::{Asked, LightParts};
use glam::{DMat4, DVec2, DVec3, DVec4};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Room around what a frame has to hold, relative to it: rounding, and film pixels at the very border.
const ROOM: f64 = 1e-4;

/// The part of a region that a frame's map holds, in units of the region's map.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
pub(in crate::plan) struct Window {
    /// The same in all frames.
    pub(in crate::plan) size: DVec2,
    /// Its lower left corner, by frame, before snapping.
    pub(in crate::plan) low: BTreeMap<usize, DVec2>,
}

impl Window {
    /// Corner and size of a map of some texels, snapped.
    pub(in crate::plan) fn snapped(&self, frame: usize, size: [u32; 2]) -> [DVec2; 2] {
        let texels = DVec2::new(f64::from(size[0]), f64::from(size[1]));
        let pitch = self.size / (texels - 1.0).max(DVec2::ONE);
        let low = self.low.get(&frame).copied().unwrap_or_default();
        [(low / pitch).floor() * pitch, pitch * texels]
    }
}

/// Finds the windows of a segment. The error is the reason why there are none.
pub(in crate::plan) fn open(held: &mut Held, light: &LightParts, asked: &Asked) -> Result<(), String> {
    let regions = &held.fitted.regions;
    let mut windows = vec![Window::default(); regions.len()];
    for &frame in &held.segment.needing {
        for (i, (region, window)) in regions.iter().zip(&mut windows).enumerate() {
            let of_region = |p: &DVec3| regions.iter().position(|r| r.domain.holds(*p)) == Some(i);
            let cover: Vec<DVec3> = light.parts[frame].cover.iter().copied().filter(of_region).collect();
            if cover.is_empty() {
                continue;
            }
            let [low, high] = region.extent(&cover).ok_or("a covered point lies behind the map of the shot")?;
            let room = (high - low) * ROOM;
            window.low.insert(frame, low - room);
            window.size = window.size.max(high - low + room * 2.0);
        }
    }
    for window in &mut windows {
        // A region that holds nothing, or a line, still needs a window.
        window.size = window.size.max(DVec2::splat(ROOM));
    }
    held.windows = windows;
    held.refit(asked);
    Ok(())
}

/// The maps of a segment in a frame at a place on the grid, in the light's frame.
pub(in crate::plan) fn maps(held: &Held, frame: usize, place: usize) -> Vec<JudgedMap> {
    if held.windows.is_empty() {
        return held.maps.clone();
    }
    let windowed = |((map, window), size): ((&JudgedMap, &Window), &[u32; 2])| {
        let [low, extent] = window.snapped(frame, *size);
        // Clip space [-1, 1]² of the window from that of the region; rows 3 and 4, the depth, stay.
        let scale = DVec2::ONE / extent;
        let shift = scale * (1.0 - 2.0 * low) - 1.0;
        let clip_from_clip = DMat4::from_cols(
            DVec4::new(scale.x, 0.0, 0.0, 0.0),
            DVec4::new(0.0, scale.y, 0.0, 0.0),
            DVec4::Z,
            DVec4::new(shift.x, shift.y, 0.0, 1.0),
        );
        JudgedMap {
            region: map.region.window(low, extent),
            clip_from_scene: clip_from_clip * map.clip_from_scene,
            depth: map.depth,
        }
    };
    held.maps.iter().zip(&held.windows).zip(held.grid.sizes(place)).map(windowed).collect()
}
