//! Maps looked up without being drawn: the ray through the centre of the texel that a point falls into meets what drawing
//! would store there.
//!
//! One ray a point, and a few short ones behind steep surfaces, whatever the size of the map: so a sample of the points tells
//! for a few thousand rays what drawing tells for all of them.

use super::count::{answer_of, place_in};
use super::{Looked, Outside, Seen};
use crate::depth::MapAt;
use crate::math::{Domain, first_holding};
use crate::raster::Bias;
use crate::scene::Light;
use crate::visibility::{Tracer, edge_on_at};
use glam::{DMat4, DVec3, DVec4};
use rayon::prelude::*;

/// A map that is not drawn.
#[derive(Clone, Copy, Debug)]
pub struct Undrawn<'a> {
    /// Which points look it up.
    pub domain: &'a Domain,
    /// OpenGL clip space from scene space.
    pub clip_from_scene: &'a DMat4,
    /// Width and height, texels.
    pub size: [u32; 2],
}

/// What a point found.
#[derive(Clone, Copy, Debug)]
pub struct LookedUp {
    /// The exact answer.
    shadowed: bool,
    /// It is not certain: the light grazes the surface.
    pub uncertain: bool,
    texel: Texel,
}

#[derive(Clone, Copy, Debug)]
enum Texel {
    /// No map holds the point.
    Outside,
    /// What would be drawn there, from the light on, as far as it may be what is stored.
    Inside([Option<Surface>; SURFACES]),
}

#[derive(Clone, Copy, Debug)]
struct Surface {
    /// Window depth from it to the point.
    gap: f64,
    /// |z_u| and |z_v| of its plane, window depth per texel.
    slopes: [f64; 2],
}

/// Surfaces looked at in a texel. One behind the nearest counts where that is so steep that its bias reaches beyond it: mostly
/// the other side of the same thing.
const SURFACES: usize = 4;

/// How far behind a surface the next ray starts, relative to the way so far: f32 decides between hits, to some units in the last
/// place of 2⁻²⁴.
const BEHIND: f64 = 1.0 / (1 << 20) as f64;

impl LookedUp {
    /// Whether the answer is wrong under a bias.
    pub fn wrong(&self, bias: Bias, outside: Outside) -> bool {
        let looked = match self.texel {
            Texel::Outside => Looked::Outside,
            Texel::Inside(surfaces) => {
                Looked::Answered { shadowed: surfaces.iter().flatten().any(|s| s.gap > bias.of(s.slopes)) }
            }
        };
        answer_of(looked, outside) != self.shadowed
    }
}

/// Looks points up, in their order. Answers hold for biases whose factor on slopes is at most `slope_max`.
pub fn look_up_by_rays(
    tracer: &Tracer,
    light: &Light,
    maps: &[Undrawn],
    points: &[Seen],
    slope_max: f64,
) -> Vec<LookedUp> {
    let scene_from_clip: Vec<DMat4> = maps.iter().map(|map| map.clip_from_scene.inverse()).collect();
    let texel = |point: DVec3| {
        let Some(k) = first_holding(maps.iter().map(|map| map.domain), point) else { return Texel::Outside };
        texel((tracer, light, slope_max), &maps[k], &scene_from_clip[k], point)
    };
    let look_up = |seen: &Seen| LookedUp {
        shadowed: seen.shadowed,
        uncertain: edge_on_at(seen.position, seen.normal, light),
        texel: texel(seen.position),
    };
    points.par_iter().map(look_up).collect()
}

/// What is drawn into the texel of a point.
fn texel(
    (tracer, light, slope_max): (&Tracer, &Light, f64),
    map: &Undrawn,
    scene_from_clip: &DMat4,
    point: DVec3,
) -> Texel {
    let Some([u, v, depth]) = place_in(map.clip_from_scene, map.size, point) else { return Texel::Outside };
    let center = |texels: f64, size: u32| (texels.floor() + 0.5) / f64::from(size) * 2.0 - 1.0;
    let (x, y) = (center(u, map.size[0]), center(v, map.size[1]));
    let at = |depth: f64| {
        let scene = *scene_from_clip * DVec4::new(x, y, 2.0 * depth - 1.0, 1.0);
        scene.truncate() / scene.w
    };
    let (origin, depth) = (at(0.0), depth.clamp(0.0, 1.0));
    let direction = -light.towards(origin);
    // Window depth that nothing stored exceeds, and where the ray comes to it: never, where the far plane lies beyond infinity.
    let end = |depth: f64| {
        let t = (at(depth) - origin).dot(direction) / direction.length_squared();
        if t > 0.0 { t } else { f64::INFINITY }
    };
    let (mut stored, mut t_min, mut t_max) = (1.0, 0.0, end(1.0));
    let mut surfaces = [None; SURFACES];
    for surface in &mut surfaces {
        let Some(hit) = tracer.closest(origin, direction, t_min, t_max) else { break };
        t_min = hit.t * (1.0 + BEHIND);
        let [a, b, c] = tracer.geometry().triangle_f64(hit.triangle);
        let plane = MapAt::new(map.clip_from_scene, map.size, origin + direction * hit.t);
        let (Some(plane), Some(normal)) = (plane, (b - a).cross(c - a).try_normalize()) else { continue };
        let (its, slopes) = (plane.window_depth(), plane.slopes(normal));
        if its > 1.0 {
            break;
        }
        *surface = Some(Surface { gap: depth - its, slopes });
        let most = its + slope_max * slopes[0].max(slopes[1]);
        if most < stored {
            stored = most;
            t_max = end(stored);
        }
        if t_max <= t_min {
            break;
        }
    }
    Texel::Inside(surfaces)
}
