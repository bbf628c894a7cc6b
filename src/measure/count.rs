//! Looks receivers up in drawn maps as a renderer would, and counts the wrong answers.
//!
//! Rules: the first map whose domain holds the point answers; w ≤ 0 or outside the rectangle is "outside" (w is tested
//! before the division); receiver depth is clamped to [0, 1]; nearest texel; shadowed when the receiver's depth, rounded
//! to f32, is greater than the stored depth.

use super::Receivers;
use super::batch::look_up_all;
use crate::math::Domain;
use crate::raster::DepthMap;
use glam::{DMat4, DVec3};
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};

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

impl Drawn {
    /// Where a scene point lies in it, texels, and its window depth; `None` outside.
    fn place_of(&self, point: DVec3) -> Option<[f64; 3]> {
        place_in(&self.clip_from_scene, [self.map.width, self.map.height], point)
    }
}

/// Wrong answers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
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
    maps.iter().find(|m| m.domain.holds(point)).map_or(Looked::Outside, |drawn| look_up_in(drawn, point))
}

/// Looks a scene point up in one map, whatever its domain.
fn look_up_in(drawn: &Drawn, point: DVec3) -> Looked {
    let Some([u, v, z]) = drawn.place_of(point) else { return Looked::Outside };
    let stored = drawn.map.depth[v as usize * drawn.map.width as usize + u as usize];
    Looked::Answered { shadowed: z.clamp(0.0, 1.0) as f32 > stored }
}

/// Where a scene point lies in a map of a size in texels, and its window depth; `None` outside.
pub(super) fn place_in(clip_from_scene: &DMat4, size: [u32; 2], point: DVec3) -> Option<[f64; 3]> {
    let clip = *clip_from_scene * point.extend(1.0);
    if clip.w <= 0.0 {
        return None;
    }
    let [width, height] = size.map(f64::from);
    let u = (clip.x / clip.w * 0.5 + 0.5) * width;
    let v = (clip.y / clip.w * 0.5 + 0.5) * height;
    let inside = u >= 0.0 && u < width && v >= 0.0 && v < height;
    inside.then_some([u, v, clip.z / clip.w * 0.5 + 0.5])
}

/// How near a scene point is looked up to the centre of its texel, in the maximum norm: 1 there, 0 at the texel's border;
/// `None` where no map holds it.
pub(super) fn confidence(maps: &[Drawn], point: DVec3) -> Option<f64> {
    let drawn = maps.iter().find(|m| m.domain.holds(point))?;
    let [u, v, _] = drawn.place_of(point)?;
    let off = |c: f64| 2.0 * (c.fract() - 0.5).abs();
    Some(1.0 - off(u).max(off(v)))
}

/// Looks every receiver up.
pub fn count(receivers: &Receivers, maps: &[Drawn], outside: Outside) -> Counts {
    by_chunk(receivers, |range| {
        let mut counts = Counts::default();
        answers(receivers, maps, range, |i, looked| {
            let expected = receivers.shadowed[i];
            let answer = answer_of(looked, outside);
            counts.false_lit += u64::from(expected && !answer);
            counts.false_shadow += u64::from(!expected && answer);
            counts.uncovered += u64::from(looked == Looked::Outside && expected != answer);
        });
        counts
    })
    .into_iter()
    .fold(Counts::default(), |a, b| Counts {
        false_lit: a.false_lit + b.false_lit,
        false_shadow: a.false_shadow + b.false_shadow,
        uncovered: a.uncovered + b.uncovered,
    })
}

/// Indices of the receivers that are answered wrongly, ascending.
pub fn wrong(receivers: &Receivers, maps: &[Drawn], outside: Outside) -> Vec<u32> {
    fewer_wrong(receivers, maps, outside, u64::MAX).unwrap_or_default()
}

/// [`wrong`], if there are fewer than `limit`; looking up ends where there are not.
pub fn fewer_wrong(receivers: &Receivers, maps: &[Drawn], outside: Outside, limit: u64) -> Option<Vec<u32>> {
    let found = AtomicU64::new(0);
    let wrong = by_chunk(receivers, |range| {
        let mut wrong = Vec::new();
        if found.load(Ordering::Relaxed) < limit {
            answers(receivers, maps, range, |i, looked| {
                if answer_of(looked, outside) != receivers.shadowed[i] {
                    wrong.push(i as u32);
                }
            });
            found.fetch_add(wrong.len() as u64, Ordering::Relaxed);
        }
        wrong
    });
    // Chunks were left out only when those before them held `limit` already.
    (found.into_inner() < limit).then(|| wrong.concat())
}

/// Receivers that one thread takes at a time.
const CHUNK: usize = 4096;

/// A value for each chunk of receivers, in order.
fn by_chunk<T: Send>(receivers: &Receivers, value: impl Fn(Range<usize>) -> T + Sync) -> Vec<T> {
    let chunks = 0..receivers.len().div_ceil(CHUNK);
    chunks.into_par_iter().map(|k| value(k * CHUNK..receivers.len().min((k + 1) * CHUNK))).collect()
}

/// Looks a range of receivers up, in order.
fn answers(receivers: &Receivers, maps: &[Drawn], range: Range<usize>, mut answered: impl FnMut(usize, Looked)) {
    if let [map @ Drawn { domain: Domain::All, .. }] = maps {
        let first = range.start;
        look_up_all(map, &receivers.positions[range], |i, shadowed| {
            answered(first + i, shadowed.map_or(Looked::Outside, |shadowed| Looked::Answered { shadowed }));
        });
    } else {
        range.for_each(|i| answered(i, look_up(maps, receivers.positions[i])));
    }
}

/// Whether a scene point is taken for shadowed.
pub fn answers_shadowed(maps: &[Drawn], point: DVec3, outside: Outside) -> bool {
    answer_of(look_up(maps, point), outside)
}

/// Whether a looked-up point is taken for shadowed.
pub(super) fn answer_of(looked: Looked, outside: Outside) -> bool {
    match looked {
        Looked::Answered { shadowed } => shadowed,
        Looked::Outside => outside == Outside::Shadowed,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec4;

    /// A shortened count says the same as a full one, for one map and for several.
    #[test]
    fn a_limited_count_is_the_count_or_nothing() {
        let (width, height) = (61, 53);
        let depth = (0..width * height).map(|i| (i * 7919 % 101) as f32 / 100.0).collect();
        let clip_from_scene = DMat4::from_cols(
            DVec4::new(1.1, 0.2, 0.1, 0.1),
            DVec4::new(-0.3, 0.9, 0.4, -0.2),
            DVec4::new(0.2, 0.1, 0.7, 0.1),
            DVec4::new(0.05, -0.1, 0.2, 0.9),
        );
        let drawn = Drawn { domain: Domain::All, clip_from_scene, map: DepthMap { width, height, depth } };
        let face = Domain::CubeFace { position: DVec3::ZERO, axes: DVec3::AXES, axis: 0, positive: true };
        let at =
            |i: u32, k: u32| f64::from(i.wrapping_mul(2_654_435_761).wrapping_mul(k) >> 8) / f64::from(1 << 23) - 1.0;
        let mut receivers = Receivers::default();
        for i in 0..30_000 {
            receivers.pixels.push(i);
            receivers.positions.push(DVec3::new(at(i, 3), at(i, 5), at(i, 7)));
            receivers.shadowed.push(at(i, 11) > 0.0);
        }
        for maps in [vec![drawn.clone()], vec![Drawn { domain: face, ..drawn.clone() }, drawn]] {
            for outside in [Outside::Lit, Outside::Shadowed] {
                let one_by_one: Vec<u32> = (0..receivers.len())
                    .filter(|&i| answer_of(look_up(&maps, receivers.positions[i]), outside) != receivers.shadowed[i])
                    .map(|i| i as u32)
                    .collect();
                let all = one_by_one.len() as u64;
                assert!(all > 1000);
                assert_eq!(wrong(&receivers, &maps, outside), one_by_one);
                assert_eq!(count(&receivers, &maps, outside).wrong(), all);
                for limit in [u64::MAX, all + 1, all, 100, 0] {
                    let found = (limit > all).then(|| one_by_one.clone());
                    assert_eq!(fewer_wrong(&receivers, &maps, outside, limit), found);
                }
            }
        }
    }
}
