//! Which way a shadow edge runs across the pixels of an image.
//!
//! The chord between two crossings is a pixel long and off by several degrees; under grazing light, where a texel is ten
//! times as long as wide, that alone makes an edge along the light look worse by half. The structure tensor (Förstner and
//! Gülch 1987; Bigün and Granlund 1987), Σ w g gᵀ over the gradients g of the layer nearby, is right to 2° on edges, strips
//! and rows of strips down to a pixel wide, whose gradients cancel in a mean but not in the tensor.

use super::film::SeenFilm;
use crate::visibility::Answer;
use glam::DVec2;
use rayon::prelude::*;

/// Smoothing across and derivative along each axis, of the gradients.
const BINOMIAL: [f64; 5] = [1.0, 4.0, 6.0, 4.0, 1.0];
const DERIVATIVE: [f64; 5] = [-1.0, -2.0, 0.0, 2.0, 1.0];
/// Gradients this many pixels away count, by a Gaussian of half that deviation.
const REACH: i64 = 4;
/// Difference of the tensor's eigenvalues over their sum, below which there is no one direction: a corner.
const COHERENT: f64 = 0.3;

/// Gradients of a shadow layer over its surfaces, where it is not even.
pub(super) struct Gradients<'a> {
    film: &'a SeenFilm,
    answers: &'a [Answer],
    by_pixel: Vec<[f32; 2]>,
}

impl<'a> Gradients<'a> {
    pub(super) fn new(film: &'a SeenFilm, shadow: &[f32], answers: &'a [Answer]) -> Gradients<'a> {
        let by_pixel = (0..film.film.pixels()).into_par_iter().map(|pixel| gradient(film, shadow, answers, pixel));
        Gradients { film, answers, by_pixel: by_pixel.collect() }
    }

    /// The unit normal of the edge at a film position, of either sign; `None` at corners and where there is no edge.
    pub(super) fn normal_at(&self, at: DVec2) -> Option<DVec2> {
        let own = self.film.pixel_at(at)?;
        let [mut xx, mut xy, mut yy] = [0.0; 3];
        self.film.around(own, REACH, |near, [column, row]| {
            let [gx, gy] = self.by_pixel[near].map(f64::from);
            if (gx == 0.0 && gy == 0.0) || self.answers[near] == Answer::Unlit || !self.film.on_plane(own, near) {
                return;
            }
            let square = (column * column + row * row) as f64;
            let weight = (-2.0 * square / (REACH * REACH) as f64).exp();
            xx += weight * gx * gx;
            xy += weight * gx * gy;
            yy += weight * gy * gy;
        });
        let (sum, difference) = (xx + yy, (xx - yy).hypot(2.0 * xy));
        (difference > COHERENT * sum).then(|| DVec2::from_angle(0.5 * (2.0 * xy).atan2(xx - yy)))
    }
}

/// The gradient of the layer at a pixel; pixels of other surfaces count as equal to it.
fn gradient(film: &SeenFilm, shadow: &[f32], answers: &[Answer], pixel: usize) -> [f32; 2] {
    if answers[pixel] == Answer::Unlit {
        return [0.0; 2];
    }
    let own = shadow[pixel];
    let mut gradient = DVec2::ZERO;
    film.around(pixel, 2, |near, [column, row]| {
        let difference = f64::from(shadow[near] - own);
        if difference == 0.0 || answers[near] == Answer::Unlit || !film.on_plane(pixel, near) {
            return;
        }
        let [i, j] = [(column + 2) as usize, (row + 2) as usize];
        gradient += difference * DVec2::new(DERIVATIVE[i] * BINOMIAL[j], BINOMIAL[i] * DERIVATIVE[j]);
    });
    gradient.as_vec2().to_array()
}
