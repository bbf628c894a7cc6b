//! Temporal reprojection with confidence, as a renderer has it: what it leaves of wrong pixels and flicker.
//!
//! After the course *Real-Time Shadows* ("Fighting undersampling: temporal reprojection"; the method is that of Scherzer,
//! Jeschke, Wimmer 2007). A film-sized buffer holds a value in [0, 1] for each light, and every frame
//!
//! ```text
//! cache(n) := w s(n) + (1 - w) cache(n-1),    w := conf^m,    conf := 1 - dist
//! ```
//!
//! s is the map's answer (1 = in shadow), dist the distance of the looked-up position from the centre of its texel: in the
//! maximum norm, 0 at the centre, 1 at the border. cache(n-1) is taken where the pixel's surface point was in the frame
//! before, bilinearly from those of the four pixels there that see the same surface. Without one, and outside all maps,
//! cache(n) := s(n).
//!
//! Deviations. The renderer shows the cached value as a grey; here the pixel is taken for shadowed above 1/2, so that its
//! errors are counted like all others. The paper shifts the map by parts of a texel every frame so that other points come to
//! lie at texel centres; here maps are looked up as they are planned. A map that stands still answers alike in every frame,
//! and repeating it adds nothing: what there is to gain is gained under matrices that change.

use super::count::{Drawn, Outside, answers_shadowed, confidence};
use super::flicker::{Earlier, Flickering, Moment};
use super::receivers::Receivers;
use crate::scene::Light;
use crate::visibility::{Answer, View, answer};
use rayon::prelude::*;

/// What a renderer keeps of a light from frame to frame: a value in [0, 1] a pixel of the film, NaN where the light is not
/// asked.
#[derive(Clone, Debug, Default)]
pub struct Cache(Vec<f32>);

/// The frame before, and what was kept of a light there.
#[derive(Clone, Copy)]
pub struct Past<'a> {
    /// The frame.
    pub moment: Moment<'a>,
    /// What its camera saw.
    pub view: &'a View,
    /// The light as it stood.
    pub light: &'a Light,
    /// What was kept.
    pub cache: &'a Cache,
    /// Where the pixels of the later frame were.
    pub earlier: &'a [Option<Earlier>],
}

/// A frame's answers under the model.
#[derive(Clone, Debug, Default)]
pub struct Blended {
    /// For the next frame.
    pub cache: Cache,
    /// Receivers answered wrongly, ascending.
    pub wrong: Vec<u32>,
    /// Changes since the frame before that nothing accounts for.
    pub flicker: Flickering,
}

/// Above this a cached value is taken for shadow.
const HALF: f32 = 0.5;

/// Two depths closer than this part of them are one surface to the renderer: neighbouring pixels of a slope differ.
const SAME_SURFACE: f64 = 0.01;

/// Blends the answers of maps with what was kept. `power` is m.
pub fn blend(
    past: Option<&Past>,
    pixels: usize,
    receivers: &Receivers,
    maps: &[Drawn],
    outside: Outside,
    power: f64,
) -> Blended {
    let one = |i: usize| -> (f32, bool, Flickering) {
        let position = receivers.positions[i];
        let shadowed = answers_shadowed(maps, position, outside);
        let now = if shadowed { 1.0 } else { 0.0 };
        let fetched = past.and_then(|past| past.fetch(receivers.pixels[i]));
        let value = match (fetched, confidence(maps, position)) {
            (Some(before), Some(confidence)) => {
                let w = confidence.powf(power) as f32;
                w * now + (1.0 - w) * before
            }
            _ => now,
        };
        let taken = if value == HALF { shadowed } else { value > HALF };
        let flicker = match (past, fetched) {
            (Some(past), Some(before)) => past.flicker(i, receivers, before > HALF, taken),
            _ => Flickering::default(),
        };
        (value, taken, flicker)
    };
    let all: Vec<(f32, bool, Flickering)> = (0..receivers.len()).into_par_iter().with_min_len(1024).map(one).collect();
    let mut cache = vec![f32::NAN; pixels];
    let mut blended = Blended::default();
    for (i, (value, taken, flicker)) in all.into_iter().enumerate() {
        cache[receivers.pixels[i] as usize] = value;
        if taken != receivers.shadowed[i] {
            blended.wrong.push(i as u32);
        }
        blended.flicker = blended.flicker + flicker;
    }
    blended.cache = Cache(cache);
    blended
}

impl Past<'_> {
    /// The value kept where a pixel's surface point was; `None` without one.
    fn fetch(&self, pixel: u32) -> Option<f32> {
        let earlier = self.earlier.get(pixel as usize)?.as_ref()?;
        let film = self.moment.film;
        let (x, y, depth_m) = self.moment.camera.project(film, earlier.surface.position)?;
        let (left, top) = ((x - 0.5).floor(), (y - 0.5).floor());
        let (right_part, lower_part) = (x - 0.5 - left, y - 0.5 - top);
        let (mut sum, mut weights) = (0.0, 0.0);
        for (dx, dy) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
            let (x, y) = (left + dx, top + dy);
            if !(x >= 0.0 && y >= 0.0 && x < f64::from(film.width) && y < f64::from(film.height)) {
                continue;
            }
            let tap = y as usize * film.width as usize + x as usize;
            let Some(value) = self.cache.0.get(tap).filter(|v| !v.is_nan()) else { continue };
            let same = self.view.triangles[tap] == earlier.surface.triangle
                || (self.view.depths_m[tap] - depth_m).abs() <= SAME_SURFACE * depth_m;
            if same {
                let part = |near_end: bool, part: f64| if near_end { 1.0 - part } else { part };
                let weight = part(dx == 0.0, right_part) * part(dy == 0.0, lower_part);
                sum += weight * f64::from(*value);
                weights += weight;
            }
        }
        (weights > 0.0).then_some((sum / weights) as f32)
    }

    fn flicker(&self, i: usize, receivers: &Receivers, then: bool, now: bool) -> Flickering {
        let Some(Some(earlier)) = self.earlier.get(receivers.pixels[i] as usize) else { return Flickering::default() };
        let exact = answer(self.moment.tracer, &earlier.surface, self.light, self.moment.offset);
        let same = exact == if receivers.shadowed[i] { Answer::Shadowed } else { Answer::Lit };
        Flickering::of(same, then != now, earlier.moved)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Domain;
    use crate::raster::DepthMap;
    use glam::{DMat4, DVec3};

    /// A map of 2 x 1 texels over [-1, 1]², the left one in shadow.
    fn map() -> Drawn {
        let map = DepthMap { width: 2, height: 1, depth: vec![0.1, 0.9] };
        Drawn { domain: Domain::All, clip_from_scene: DMat4::IDENTITY, map }
    }

    #[test]
    fn confidence_is_1_at_the_centre_of_a_texel_and_0_at_its_border() {
        let maps = [map()];
        let at = |x: f64, y: f64| confidence(&maps, DVec3::new(x, y, 0.0));
        assert!((at(-0.5, 0.0).unwrap() - 1.0).abs() < 1e-12);
        assert!(at(-1e-9, 0.0).unwrap() < 1e-6 && at(-0.5, 0.999_999).unwrap() < 1e-5);
        assert!((at(0.25, 0.0).unwrap() - 0.5).abs() < 1e-12);
        assert_eq!(at(1.5, 0.0), None);
    }

    #[test]
    fn a_first_frame_is_what_the_maps_answer() {
        let receivers = Receivers {
            pixels: vec![0, 3],
            positions: vec![DVec3::new(-0.5, 0.0, 0.0), DVec3::new(0.9, 0.0, 0.0)],
            shadowed: vec![true, true],
        };
        let blended = blend(None, 4, &receivers, &[map()], Outside::Lit, 1.0);
        assert_eq!(blended.wrong, [1]);
        assert_eq!((blended.cache.0[0], blended.cache.0[3]), (1.0, 0.0));
        assert!(blended.cache.0[1].is_nan());
        assert_eq!(blended.flicker, Flickering::default());
    }
}
