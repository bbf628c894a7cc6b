//! The film pixels that ask a light's map a question, with the exact answer.

use super::Outside;
use crate::scene::{Camera, Light};
use crate::visibility::{Answer, RayOffset, Tracer, View, classify};
use glam::DVec3;
use rayon::prelude::*;

/// Pixels facing a light and within its reach: structure of arrays.
#[derive(Clone, Debug, Default)]
pub struct Receivers {
    /// Pixel, row by row from the top.
    pub pixels: Vec<u32>,
    /// Scene point seen there.
    pub positions: Vec<DVec3>,
    /// The exact answer.
    pub shadowed: Vec<bool>,
}

impl Receivers {
    /// Classifies a film exactly for one light.
    pub fn classify(tracer: &Tracer, view: &View, camera: &Camera, light: &Light, offset: RayOffset) -> Receivers {
        Receivers::new(view, camera, &classify(tracer, view, camera, light, offset))
    }

    /// Of a film with the exact answer of each pixel.
    pub fn new(view: &View, camera: &Camera, answers: &[Answer]) -> Receivers {
        let facing = answers.iter().enumerate().filter(|(_, answer)| **answer != Answer::Unlit);
        let pixels: Vec<u32> = facing.map(|(pixel, _)| pixel as u32).collect();
        let rays = camera.rays(view.film);
        let position = |pixel: &u32| {
            let (origin, direction) = rays.through_pixel(*pixel as usize);
            origin + direction * view.depths_m[*pixel as usize]
        };
        let positions = pixels.par_iter().map(position).collect();
        let shadowed = pixels.par_iter().map(|pixel| answers[*pixel as usize] == Answer::Shadowed).collect();
        Receivers { pixels, positions, shadowed }
    }

    /// Of a film with the exact answer of each pixel, and the scene point seen there; a pixel without one is none.
    pub fn at(answers: &[Answer], position: impl Fn(usize) -> Option<DVec3>) -> Receivers {
        let mut receivers = Receivers::default();
        for (pixel, answer) in answers.iter().enumerate().filter(|(_, answer)| **answer != Answer::Unlit) {
            let Some(position) = position(pixel) else { continue };
            receivers.pixels.push(pixel as u32);
            receivers.positions.push(position);
            receivers.shadowed.push(*answer == Answer::Shadowed);
        }
        receivers
    }

    /// One of them, with the normal of its surface.
    pub fn seen(&self, receiver: usize, normal: DVec3) -> Seen {
        Seen { position: self.positions[receiver], normal, shadowed: self.shadowed[receiver] }
    }

    /// Number of receivers.
    pub fn len(&self) -> usize {
        self.pixels.len()
    }

    /// True when no pixel faces the light.
    pub fn is_empty(&self) -> bool {
        self.pixels.is_empty()
    }

    /// Positions with the given exact answer.
    pub fn positions_where(&self, shadowed: bool) -> Vec<DVec3> {
        self.positions.iter().zip(&self.shadowed).filter(|(_, s)| **s == shadowed).map(|(p, _)| *p).collect()
    }

    /// Number of receivers whose exact answer is not that of `outside`: they need a map.
    pub fn needing(&self, outside: Outside) -> u64 {
        let shadowed = self.shadowed_count();
        if outside == Outside::Lit { shadowed } else { self.len() as u64 - shadowed }
    }

    /// Number of receivers in shadow.
    pub fn shadowed_count(&self) -> u64 {
        self.shadowed.iter().filter(|s| **s).count() as u64
    }
}

/// A visible point that may look a map up.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    /// Scene space, metres.
    pub position: DVec3,
    /// Unit, towards the camera.
    pub normal: DVec3,
    /// The exact answer.
    pub shadowed: bool,
}
