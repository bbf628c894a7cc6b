//! The film: what every pixel sees, and what a light does there.

use rayon::prelude::*;

use super::shadow::{Answer, RayOffset, answer};
use super::surface::{Surface, first_hit};
use super::trace::Tracer;
use crate::scene::{Camera, Film, FilmRays, Light};

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
        self.surface_on(tracer, &camera.rays(self.film), pixel)
    }

    /// The same, given the camera's rays.
    fn surface_on(&self, tracer: &Tracer, rays: &FilmRays, pixel: usize) -> Option<Surface> {
        let (&triangle, &depth_m) = (self.triangles.get(pixel)?, self.depths_m.get(pixel)?);
        (triangle != NO_TRIANGLE).then(|| Surface::on_ray(tracer, rays.through_pixel(pixel), (triangle, depth_m)))
    }
}

/// One ray through the centre of every pixel. The same for any number of threads.
pub fn see(tracer: &Tracer, camera: &Camera, film: Film) -> View {
    let (mut triangles, mut depths_m) = (vec![0; film.pixels()], vec![0.0; film.pixels()]);
    let (rays, strip) = (camera.rays(film), strip(film));
    let strips = triangles.par_chunks_mut(strip).zip(depths_m.par_chunks_mut(strip)).enumerate();
    strips.for_each(|(number, (triangles, depths_m))| {
        for_pixels(film, triangles.len(), |i| {
            let hit = first_hit(tracer, camera, rays.through_pixel(number * strip + i));
            (triangles[i], depths_m[i]) = hit.map_or((NO_TRIANGLE, f64::INFINITY), |hit| (hit.triangle, hit.t));
        });
    });
    View { film, triangles, depths_m }
}

/// One shadow ray from every pixel that faces the light. The same for any number of threads.
pub fn classify(tracer: &Tracer, view: &View, camera: &Camera, light: &Light, offset: RayOffset) -> Vec<Answer> {
    let film = view.film;
    let mut answers = vec![Answer::default(); film.pixels()];
    let (rays, strip) = (camera.rays(film), strip(film));
    answers.par_chunks_mut(strip).enumerate().for_each(|(number, answers)| {
        for_pixels(film, answers.len(), |i| {
            if let Some(surface) = view.surface_on(tracer, &rays, number * strip + i) {
                answers[i] = answer(tracer, &surface, light, offset);
            }
        });
    });
    answers
}

/// Pixels that one thread takes at a time: rows of tiles.
fn strip(film: Film) -> usize {
    (film.width.max(1) * TILE) as usize
}

/// The pixels of a strip, tile by tile.
fn for_pixels(film: Film, pixels: usize, mut each: impl FnMut(usize)) {
    let width = film.width as usize;
    let height = pixels / width.max(1);
    for left in (0..width).step_by(TILE as usize) {
        for y in 0..height {
            for x in left..(left + TILE as usize).min(width) {
                each(y * width + x);
            }
        }
    }
}
