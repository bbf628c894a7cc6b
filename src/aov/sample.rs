//! Shadow edges between the pixels of an image: where the shadow layer crosses ½.
//!
//! Layers of 0 and 1 know an edge to a pixel only: joined at the middles between pixels it would be a staircase, 5 % too
//! long and with eight directions. The layer is therefore smoothed over the surface (binomial, 5 × 5, only over pixels on
//! the plane of the one asked) before the crossing is looked for: straight edges then come out straight, with lengths
//! right to 2 % at any angle. Their directions come from farther around (`edge_normal`).

use super::edge_normal::Gradients;
use super::film::{SHADOWED_ABOVE, SeenFilm, centre};
use crate::samples::{Changes, Crossing, CrossingKind, EdgeLook, Grid, LightSamples};
use crate::scene::Light;
use crate::visibility::Answer;
use glam::DVec2;

/// Weights of the smoothing, each way.
const BINOMIAL: [f64; 5] = [1.0, 4.0, 6.0, 4.0, 1.0];
/// A crossing keeps this part of a step away from either pixel: they are known to differ.
const INSIDE: f64 = 0.05;

impl SeenFilm {
    /// The grid of all pixels.
    pub fn grid(&self) -> Grid {
        Grid { film: self.film, columns: self.film.width, rows: self.film.height }
    }

    /// Samples one light, given its shadow layer (1 in shadow) and the answers from it, both of every pixel; `cover_lit` as in
    /// [`crate::samples::sample_light`].
    pub fn sample(&self, light: &Light, shadow: &[f32], answers: &[Answer], cover_lit: bool) -> LightSamples {
        if [shadow.len(), answers.len()] != [self.film.pixels(); 2] {
            return LightSamples::default();
        }
        let changes =
            Changes::find(self.grid(), answers, |shadowed, other| self.crossing(shadow, answers, shadowed, other));
        let asked = |pixel: usize| answers[pixel] != Answer::Unlit;
        let corner = |pixel: usize| (!self.between_its_like(answers, pixel)).then(|| self.position(pixel)).flatten();
        let gradients = Gradients::new(self, shadow, answers);
        let look = EdgeLook { seen_at: |at| self.surface_at(at, asked), normal_at: |at| gradients.normal_at(at) };
        changes.samples(&self.camera, light, &look, corner, cover_lit)
    }

    /// The change between a pixel in shadow and a neighbour that is not.
    fn crossing(&self, shadow: &[f32], answers: &[Answer], shadowed: usize, other: usize) -> Option<Crossing> {
        let edge = answers[other] == Answer::Lit && self.are_joined(shadowed, other);
        let part = if edge { self.part_of_step(shadow, answers, shadowed, other) } else { 0.5 };
        let [from, to] = [shadowed, other].map(|pixel| DVec2::from(centre(self.film, pixel)));
        let at = from.lerp(to, part);
        let own = self.surface(shadowed)?;
        let kind = if edge { CrossingKind::ShadowEdge } else { CrossingKind::Discontinuity };
        // Past its end a surface is not continued.
        let reached = if edge { self.moved(own, at).unwrap_or(own) } else { own };
        let other_lit = answers[other] == Answer::Lit;
        Some(Crossing { film: at.to_array(), kind, shadowed: reached, other: self.surface(other), other_lit })
    }

    /// Where between two pixels the layer crosses ½, 0 at the shadowed one.
    fn part_of_step(&self, shadow: &[f32], answers: &[Answer], shadowed: usize, other: usize) -> f64 {
        let half = f64::from(SHADOWED_ABOVE);
        let between =
            |a: f64, b: f64| (a > half && b < half).then(|| ((a - half) / (a - b)).clamp(INSIDE, 1.0 - INSIDE));
        let smooth = |pixel| self.smoothed(shadow, answers, pixel);
        between(smooth(shadowed), smooth(other))
            .or_else(|| between(f64::from(shadow[shadowed]), f64::from(shadow[other])))
            .unwrap_or(half)
    }

    /// The layer around a pixel, over its surface.
    fn smoothed(&self, shadow: &[f32], answers: &[Answer], pixel: usize) -> f64 {
        let (mut sum, mut weights) = (0.0, 0.0);
        self.around(pixel, 2, |near, [column, row]| {
            if near == pixel || (answers[near] != Answer::Unlit && self.on_plane(pixel, near)) {
                let weight = BINOMIAL[(column + 2) as usize] * BINOMIAL[(row + 2) as usize];
                sum += weight * f64::from(shadow[near]);
                weights += weight;
            }
        });
        sum / weights
    }

    /// Whether the pixels to the left and right have a pixel's answer on its surface. Its point then lies on or near the
    /// line between theirs; what film-resolution covers finds outside joins later.
    fn between_its_like(&self, answers: &[Answer], pixel: usize) -> bool {
        let column = pixel % self.film.width as usize;
        let like = |other: usize| answers[other] == answers[pixel] && self.are_joined(other, pixel);
        column > 0 && column + 1 < self.film.width as usize && like(pixel - 1) && like(pixel + 1)
    }
}
