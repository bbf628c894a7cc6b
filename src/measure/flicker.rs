//! Pixels whose answer from the maps changes between two frames although the exact answer at the same point of the same
//! surface does not: shadows that swim or pop.
//!
//! Every pixel of the later frame is followed back: a point of a still triangle stays where it is, one of a moving triangle
//! keeps its barycentric coordinates. It is compared when the earlier camera sees it too. Both frames' maps and exact
//! visibility are asked at the point itself, so that the resampling of the film is no part of the figure.

use super::count::{Drawn, Outside, answers_shadowed};
use super::receivers::Receivers;
use crate::scene::{Camera, Film, Light};
use crate::visibility::{Answer, NO_TRIANGLE, RayOffset, Surface, Tracer, View, answer, surface_at};
use glam::DVec3;
use rayon::prelude::*;
use std::ops::Add;

/// What can be asked of a frame.
#[derive(Clone, Copy)]
pub struct Moment<'a> {
    /// Its triangles.
    pub tracer: &'a Tracer<'a>,
    /// Its camera.
    pub camera: &'a Camera,
    /// Its film.
    pub film: Film,
    /// Lift of its shadow rays.
    pub offset: RayOffset,
}

/// Where a pixel's surface point was in the frame before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Earlier {
    /// The surface then, seen by the camera then.
    pub surface: Surface,
    /// Its triangle has moved since.
    pub moved: bool,
}

/// Flickering pixels of one light between two frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Flickering {
    /// On surfaces that did not move.
    pub still: u64,
    /// On surfaces that moved.
    pub moved: u64,
    /// Pixels that could have flickered: facing the light, seen in both frames, with the same exact answer in both.
    pub compared: u64,
}

/// Two depths along one ray closer than this part of them are the same surface: rounding of rays through f32 vertices.
const SAME_DEPTH: f64 = 1e-4;

/// Where the surface points of a view's pixels were in the frame before; `None` where they were not seen.
pub fn reproject(before: &Moment, now: &Moment, view: &View) -> Vec<Option<Earlier>> {
    let (then, today) = (before.tracer.geometry(), now.tracer.geometry());
    let seen = |pixel: usize| -> Option<Earlier> {
        let index = view.triangles[pixel];
        if index == NO_TRIANGLE {
            return None;
        }
        let position = view.surface(now.tracer, now.camera, pixel)?.position;
        let still = (index as usize) < then.still_len();
        // A triangle that has lost its area in one of the frames shifts the numbers of those after it.
        if !still && then.moving_len() != today.moving_len() {
            return None;
        }
        let moved = !still && then.triangle(index) != today.triangle(index);
        let point =
            if moved { follow(position, today.triangle_f64(index), then.triangle_f64(index))? } else { position };
        let (x, y, depth_m) = before.camera.project(before.film, point)?;
        let inside = x >= 0.0 && y >= 0.0 && x < f64::from(before.film.width) && y < f64::from(before.film.height);
        if !inside {
            return None;
        }
        let hit = surface_at(before.tracer, before.camera, before.film, x, y)?;
        let same = hit.triangle == index || (hit.depth_m - depth_m).abs() <= SAME_DEPTH * depth_m;
        same.then_some(Earlier { surface: Surface { position: point, ..hit }, moved })
    };
    (0..view.triangles.len()).into_par_iter().with_min_len(1024).map(seen).collect()
}

/// The point of a triangle with the barycentric coordinates that `point` has in another; `None` without area.
fn follow(point: DVec3, [a, b, c]: [DVec3; 3], [d, e, f]: [DVec3; 3]) -> Option<DVec3> {
    let normal = (b - a).cross(c - a);
    let inverse = 1.0 / normal.length_squared();
    let v = (point - a).cross(c - a).dot(normal) * inverse;
    let w = (b - a).cross(point - a).dot(normal) * inverse;
    let there = d + (e - d) * v + (f - d) * w;
    there.is_finite().then_some(there)
}

/// One light in two frames: as it stands and its maps then and now.
#[derive(Clone, Copy)]
pub struct LightThenNow<'a> {
    /// The light in the earlier frame.
    pub then: &'a Light,
    /// Its maps in the earlier frame.
    pub maps_then: &'a [Drawn],
    /// Its maps now.
    pub maps_now: &'a [Drawn],
}

/// Counts flicker over the receivers of a light in the later frame.
pub fn flicker(
    before: &Moment,
    earlier: &[Option<Earlier>],
    receivers: &Receivers,
    light: &LightThenNow,
    outside: Outside,
) -> Flickering {
    let one = |i: usize| compared(before, earlier, receivers, light, outside, i);
    (0..receivers.len()).into_par_iter().with_min_len(1024).map(one).reduce(Flickering::default, Add::add)
}

/// The receivers that flicker, ascending, on surfaces that moved or not.
pub fn flickering(
    before: &Moment,
    earlier: &[Option<Earlier>],
    receivers: &Receivers,
    light: &LightThenNow,
    outside: Outside,
) -> Vec<u32> {
    let flickers = |i: &u32| {
        let found = compared(before, earlier, receivers, light, outside, *i as usize);
        found.still + found.moved > 0
    };
    (0..receivers.len() as u32).into_par_iter().with_min_len(1024).filter(flickers).collect()
}

/// One receiver.
fn compared(
    before: &Moment,
    earlier: &[Option<Earlier>],
    receivers: &Receivers,
    light: &LightThenNow,
    outside: Outside,
    i: usize,
) -> Flickering {
    let Some(Some(earlier)) = earlier.get(receivers.pixels[i] as usize) else { return Flickering::default() };
    let then = answers_shadowed(light.maps_then, earlier.surface.position, outside);
    let now = answers_shadowed(light.maps_now, receivers.positions[i], outside);
    let exact = answer(before.tracer, &earlier.surface, light.then, before.offset);
    let same = exact == if receivers.shadowed[i] { Answer::Shadowed } else { Answer::Lit };
    Flickering::of(same, then != now, earlier.moved)
}

impl Flickering {
    /// Of one pixel, whose exact answer is the `same` in both frames or not and whose answer `changes` or not.
    pub(super) fn of(same: bool, changes: bool, moved: bool) -> Flickering {
        let flickers = u64::from(same && changes);
        let (still, moved) = if moved { (0, flickers) } else { (flickers, 0) };
        Flickering { still, moved, compared: u64::from(same) }
    }
}

impl Add for Flickering {
    type Output = Flickering;

    fn add(self, other: Flickering) -> Flickering {
        Flickering {
            still: self.still + other.still,
            moved: self.moved + other.moved,
            compared: self.compared + other.compared,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_follows_its_triangle() {
        let here = [DVec3::ZERO, DVec3::X * 2.0, DVec3::Y * 3.0];
        let turn = glam::DQuat::from_rotation_z(0.7);
        let there = here.map(|p| turn * p * 1.5 + DVec3::new(1.0, 2.0, 3.0));
        let point = DVec3::new(0.4, 0.9, 0.0);
        let followed = follow(point, here, there).unwrap();
        assert!((followed - (turn * point * 1.5 + DVec3::new(1.0, 2.0, 3.0))).length() < 1e-12);
        assert!(follow(point, [DVec3::ZERO; 3], there).is_none());
    }
}
