//! Looks receivers up in drawn maps as a renderer would, and counts the wrong answers.
//!
//! Rules: the first map whose domain holds the point answers; w ≤ 0 or outside the rectangle is "outside" (w is tested
//! before the division); receiver depth is clamped to [0, 1]; nearest texel; shadowed when the receiver's depth, rounded
//! to f32, is greater than the stored depth.

use super::Receivers;
use crate::math::Domain;
use crate::raster::DepthMap;
use glam::{DMat4, DVec3};
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What the renderer answers where no map is looked up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Outside {
    /// Points outside every map are lit; only what is in shadow has to be covered.
    #[default]
    Lit,
    /// Points outside every map are in shadow; only what is lit has to be covered.
    Shadowed,
}

/// A map as a renderer holds it.
#[derive(Clone, Debug)]
pub struct Drawn {
    /// Which points look it up.
    pub domain: Domain,
    /// OpenGL clip space from scene space.
    pub clip_from_scene: DMat4,
    /// Stored depth, bias included.
    pub map: DepthMap,
}

/// Wrong answers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// In shadow, answered lit.
    pub false_lit: u64,
    /// Lit, answered in shadow.
    pub false_shadow: u64,
    /// Receivers whose answer should differ from `outside` and that no map holds.
    pub uncovered: u64,
}

impl Counts {
    /// All wrong answers.
    pub fn wrong(&self) -> u64 {
        self.false_lit + self.false_shadow
    }
}

/// What a lookup found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Looked {
    /// The map's answer.
    Answered {
        /// In shadow.
        shadowed: bool,
    },
    /// No map holds the point.
    Outside,
}

/// Looks a scene point up.
pub fn look_up(maps: &[Drawn], point: DVec3) -> Looked {
    let Some(drawn) = maps.iter().find(|m| m.domain.holds(point)) else { return Looked::Outside };
    let clip = drawn.clip_from_scene * point.extend(1.0);
    if clip.w <= 0.0 {
        return Looked::Outside;
    }
    let (width, height) = (f64::from(drawn.map.width), f64::from(drawn.map.height));
    let u = (clip.x / clip.w * 0.5 + 0.5) * width;
    let v = (clip.y / clip.w * 0.5 + 0.5) * height;
    if !(u >= 0.0 && u < width && v >= 0.0 && v < height) {
        return Looked::Outside;
    }
    let depth = (clip.z / clip.w * 0.5 + 0.5).clamp(0.0, 1.0) as f32;
    let stored = drawn.map.depth[v as usize * drawn.map.width as usize + u as usize];
    Looked::Answered { shadowed: depth > stored }
}

/// Looks every receiver up.
pub fn count(receivers: &Receivers, maps: &[Drawn], outside: Outside) -> Counts {
    let ranges = 0..receivers.len();
    ranges
        .into_par_iter()
        .with_min_len(4096)
        .fold(Counts::default, |mut counts, i| {
            let looked = look_up(maps, receivers.positions[i]);
            let expected = receivers.shadowed[i];
            let answer = answer_of(looked, outside);
            counts.false_lit += u64::from(expected && !answer);
            counts.false_shadow += u64::from(!expected && answer);
            counts.uncovered += u64::from(looked == Looked::Outside && expected != answer);
            counts
        })
        .reduce(Counts::default, |a, b| Counts {
            false_lit: a.false_lit + b.false_lit,
            false_shadow: a.false_shadow + b.false_shadow,
            uncovered: a.uncovered + b.uncovered,
        })
}

/// Indices of the receivers that are answered wrongly, ascending.
pub fn wrong(receivers: &Receivers, maps: &[Drawn], outside: Outside) -> Vec<u32> {
    (0..receivers.len())
        .into_par_iter()
        .with_min_len(4096)
        .filter(|i| answer_of(look_up(maps, receivers.positions[*i]), outside) != receivers.shadowed[*i])
        .map(|i| i as u32)
        .collect()
}

/// Whether a scene point is taken for shadowed.
pub fn answers_shadowed(maps: &[Drawn], point: DVec3, outside: Outside) -> bool {
    answer_of(look_up(maps, point), outside)
}

/// Whether a looked-up point is taken for shadowed.
fn answer_of(looked: Looked, outside: Outside) -> bool {
    match looked {
        Looked::Answered { shadowed } => shadowed,
        Looked::Outside => outside == Outside::Shadowed,
    }
}
