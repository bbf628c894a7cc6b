//! Pictures and channels of the film.

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::super::remeasure::{Remeasured, Seeing};
use super::falloff;
use crate::picture::{Channel, Colour, Picture, mix, scaled};
use crate::samples::EdgePoint;
use crate::scene::{self, Light};

/// Behind everything.
const BACKGROUND: Colour = [40, 46, 56];
/// In shadow exactly, answered lit.
const FALSE_LIT: Colour = [255, 64, 48];
/// Lit exactly, answered in shadow.
const FALSE_SHADOW: Colour = [72, 136, 255];
/// Wrong, but the exact answer is uncertain.
const UNCERTAIN: Colour = [255, 216, 48];
/// Brightness that comes from everywhere in the shaded picture, as a part of the brightest.
const AMBIENT: f64 = 0.1;
/// Lit pixels that the exposure of the shaded picture leaves unclipped.
const EXPOSED: f64 = 0.98;
/// Exponent of displays.
const GAMMA: f64 = 2.2;

/// What the pictures of a frame are made of.
pub(super) struct Film {
    film: scene::Film,
    /// Surfaces lit from the camera: 0 edge-on, 1 facing; `None` for the background.
    headlight: Vec<Option<f64>>,
    /// Light arriving, linear, summed over the lights added.
    light: Vec<f64>,
    /// For the EXR file.
    pub(super) channels: Vec<Channel>,
}

impl Film {
    /// Depth and normals.
    pub(super) fn new(seeing: &Seeing) -> Film {
        let film = seeing.view.film;
        let surfaces: Vec<Option<(DVec3, f64)>> = (0..film.pixels())
            .into_par_iter()
            .map(|pixel| {
                let surface = seeing.view.surface(seeing.tracer, seeing.camera, pixel)?;
                let (x, y) = (pixel % film.width as usize, pixel / film.width as usize);
                let (_, direction) = seeing.camera.ray(film, x as f64 + 0.5, y as f64 + 0.5);
                Some((surface.normal, -surface.normal.dot(direction.normalize())))
            })
            .collect();
        let axis = |name: &str, k: usize| Channel {
            name: name.to_owned(),
            values: surfaces.iter().map(|s| s.map_or(0.0, |(normal, _)| normal[k] as f32)).collect(),
        };
        let depth = seeing.view.depths_m.iter().map(|d| *d as f32).collect();
        let channels =
            vec![Channel { name: "Z".to_owned(), values: depth }, axis("N.x", 0), axis("N.y", 1), axis("N.z", 2)];
        let headlight: Vec<Option<f64>> = surfaces.iter().map(|s| s.map(|(_, facing)| facing)).collect();
        let light = vec![0.0; film.pixels()];
        Film { film, headlight, light, channels }
    }

    /// Adds a light to the shaded picture and its layers to the channels.
    pub(super) fn add(
        &mut self,
        seeing: &Seeing,
        light: &Light,
        name: &str,
        measured: &Remeasured,
        edges: &[EdgePoint],
    ) {
        let receivers = &measured.receivers;
        let [mut facing, mut shadow, mut edge] = [(); 3].map(|()| vec![0.0_f32; self.film.pixels()]);
        let arriving: Vec<f64> = (0..receivers.len())
            .into_par_iter()
            .map(|i| {
                let point = receivers.positions[i];
                let normal = seeing
                    .view
                    .surface(seeing.tracer, seeing.camera, receivers.pixels[i] as usize)
                    .map_or(DVec3::ZERO, |s| s.normal);
                normal.dot(light.towards(point).normalize_or_zero()).max(0.0) * falloff(light, point)
            })
            .collect();
        for (i, arriving) in arriving.into_iter().enumerate() {
            let pixel = receivers.pixels[i] as usize;
            facing[pixel] = 1.0;
            if receivers.shadowed[i] {
                shadow[pixel] = 1.0;
            } else {
                self.light[pixel] += arriving;
            }
        }
        for sample in edges {
            let [x, y] = sample.film;
            let (x, y) = (x.clamp(0.0, f64::from(self.film.width - 1)), y.clamp(0.0, f64::from(self.film.height - 1)));
            edge[y as usize * self.film.width as usize + x as usize] += sample.length_px as f32;
        }
        let [mut false_lit, mut false_shadow, mut uncertain] = [(); 3].map(|()| vec![0.0_f32; self.film.pixels()]);
        for (i, is_uncertain) in measured.wrong.iter().zip(&measured.uncertain) {
            let pixel = receivers.pixels[*i as usize] as usize;
            let kind = if receivers.shadowed[*i as usize] { &mut false_lit } else { &mut false_shadow };
            kind[pixel] = 1.0;
            uncertain[pixel] = f32::from(u8::from(*is_uncertain));
        }
        let layers = [
            ("faces", facing),
            ("shadow", shadow),
            ("edge", edge),
            ("false_lit", false_lit),
            ("false_shadow", false_shadow),
            ("uncertain", uncertain),
        ];
        self.channels.extend(layers.map(|(layer, values)| Channel { name: format!("{name}.{layer}"), values }));
    }

    /// All lights with their exact shadows.
    pub(super) fn shaded(&self) -> Picture {
        let mut lit: Vec<f64> = self.light.iter().copied().filter(|l| *l > 0.0).collect();
        lit.sort_unstable_by(f64::total_cmp);
        let brightest = lit.get((lit.len() as f64 * EXPOSED) as usize).copied().unwrap_or(1.0);
        let colour = |pixel: usize| match self.headlight[pixel] {
            None => BACKGROUND,
            Some(facing) => {
                // A little of the headlight keeps the shape of what is in shadow.
                let linear = AMBIENT * (0.4 + 0.6 * facing) + (1.0 - AMBIENT) * self.light[pixel] / brightest;
                let shown = linear.min(1.0).powf(1.0 / GAMMA);
                scaled([255, 250, 240], shown)
            }
        };
        Picture::from_fn(self.film.width, self.film.height, colour)
    }

    /// Grey shading, brighter where lit, warm where in shadow, plain where the light does not ask; edge samples as dots whose
    /// hue is the direction of their lit side.
    pub(super) fn shadow_mask(&self, measured: &Remeasured, edges: &[EdgePoint]) -> Picture {
        let mut picture = self.grey(0.45);
        let receivers = &measured.receivers;
        for (pixel, shadowed) in receivers.pixels.iter().zip(&receivers.shadowed) {
            let facing = self.headlight[*pixel as usize].unwrap_or(1.0);
            let (colour, brightness) = if *shadowed { ([150, 92, 70], 0.35) } else { ([255, 255, 255], 0.5) };
            picture.pixels[*pixel as usize] = scaled(colour, brightness + 0.4 * facing);
        }
        let side = if self.film.width >= 1000 { 2 } else { 1 };
        for edge in edges {
            picture.dot(DVec2::from_array(edge.film), side, hue(edge.normal));
        }
        picture
    }

    /// Wrong pixels over dimmed shading.
    pub(super) fn error_mask(&self, measured: &Remeasured) -> Picture {
        let mut picture = self.grey(0.3);
        let receivers = &measured.receivers;
        for (pixel, shadowed) in receivers.pixels.iter().zip(&receivers.shadowed) {
            if *shadowed {
                let shown = &mut picture.pixels[*pixel as usize];
                *shown = mix(*shown, [0, 0, 0], 0.5);
            }
        }
        for (i, uncertain) in measured.wrong.iter().zip(&measured.uncertain) {
            let colour = match (uncertain, receivers.shadowed[*i as usize]) {
                (true, _) => UNCERTAIN,
                (false, true) => FALSE_LIT,
                (false, false) => FALSE_SHADOW,
            };
            picture.pixels[receivers.pixels[*i as usize] as usize] = colour;
        }
        picture
    }

    fn grey(&self, brightness: f64) -> Picture {
        Picture::from_fn(self.film.width, self.film.height, |pixel| match self.headlight[pixel] {
            None => scaled(BACKGROUND, 0.6),
            Some(facing) => scaled([255; 3], brightness * (0.3 + 0.7 * facing)),
        })
    }
}

/// A saturated colour for a direction on the film.
fn hue(direction: DVec2) -> Colour {
    let angle = direction.y.atan2(direction.x);
    let third = std::f64::consts::TAU / 3.0;
    std::array::from_fn(|k| (255.0 * (0.55 + 0.45 * (angle - third * k as f64).cos())) as u8)
}
