//! The film: what every pixel sees, and what a light does there.

use rayon::prelude::*;

use super::shadow::{Answer, RayOffset, answer};
use super::surface::{Surface, surface_at};
use super::trace::Tracer;
use crate::scene::{Camera, Film, Light};

/// In [`View::triangles`]: the background.
pub const NO_TRIANGLE: u32 = u32::MAX;

/// Side of the square tiles that threads take, pixels. Neighbouring rays walk the same nodes.
const TILE: u32 = 16;

/// What the centres of a film's pixels see. Row by row from the top, as [`Film`].
#[derive(Clone, Debug)]
pub struct View {
    /// The film.
    pub film: Film,
    /// Triangle of each pixel, or [`NO_TRIANGLE`].
    pub triangles: Vec<u32>,
    /// Distance of each pixel's surface along the view axis, metres; infinite for the background.
    pub depths_m: Vec<f64>,
}

impl View {
    /// The surface at a pixel, counted row by row; `None` for the background and outside the film. `tracer` and `camera`
    /// are those the view was seen with.
    pub fn surface(&self, tracer: &Tracer, camera: &Camera, pixel: usize) -> Option<Surface> {
        let (&triangle, &depth_m) = (self.triangles.get(pixel)?, self.depths_m.get(pixel)?);
        if triangle == NO_TRIANGLE {
            return None;
        }
        Some(Surface::new(tracer, camera, self.film, pixel_centre(self.film, pixel), (triangle, depth_m)))
    }
}

/// Film position of the centre of a pixel, counted row by row.
fn pixel_centre(film: Film, pixel: usize) -> [f64; 2] {
    let width = film.width as usize;
    [(pixel % width) as f64 + 0.5, (pixel / width) as f64 + 0.5]
}

/// One ray through the centre of every pixel. The same for any number of threads.
pub fn see(tracer: &Tracer, camera: &Camera, film: Film) -> View {
    let seen = by_tile(film, |pixel| {
        let [x, y] = pixel_centre(film, pixel);
        surface_at(tracer, camera, film, x, y).map_or((NO_TRIANGLE, f64::INFINITY), |s| (s.triangle, s.depth_m))
    });
    let (triangles, depths_m) = seen.into_iter().unzip();
    View { film, triangles, depths_m }
}

/// One shadow ray from every pixel that faces the light. The same for any number of threads.
pub fn classify(tracer: &Tracer, view: &View, camera: &Camera, light: &Light, offset: RayOffset) -> Vec<Answer> {
    by_tile(view.film, |pixel| {
        view.surface(tracer, camera, pixel).map_or(Answer::Unlit, |surface| answer(tracer, &surface, light, offset))
    })
}

/// A value for every pixel, row by row, computed tile by tile in parallel.
fn by_tile<T: Copy + Default + Send>(film: Film, value: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let width = film.width as usize;
    let mut image = vec![T::default(); film.pixels()];
    let strips = image.par_chunks_mut(width.max(1) * TILE as usize).enumerate();
    strips.for_each(|(strip, rows)| {
        let first = strip * width * TILE as usize;
        let height = rows.len() / width.max(1);
        for left in (0..width).step_by(TILE as usize) {
            for y in 0..height {
                for x in left..(left + TILE as usize).min(width) {
                    let pixel = y * width + x;
                    rows[pixel] = value(first + pixel);
                }
            }
        }
    });
    image
}
