//! What the pixels of an image see: the depth behind each, the plane of the surface there from its neighbours, and which
//! neighbours are one surface.

use super::slope::{acceleration, bent, joined, slope};
use crate::scene::{Camera, Film, Light, Projection};
use crate::visibility::{Answer, NO_TRIANGLE, Surface};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// A film seen through images.
#[derive(Clone, Debug)]
pub struct SeenFilm {
    /// The camera of the frame.
    pub camera: Camera,
    /// The film.
    pub film: Film,
    /// Along the view axis, metres; infinite for the background.
    depths_m: Vec<f64>,
    /// Unit normals on the side of the camera; NaN where neither a layer nor neighbours tell.
    normals: Vec<[f32; 3]>,
    /// Those by which a light's side is told: the layer's, where there is one, as it is.
    facing: Option<Vec<[f32; 3]>>,
    /// How bent its surfaces may be, as a part of their slopes.
    bent: f64,
    /// For each pixel, whether it is one surface with its right (bit 0) and its lower (bit 1) neighbour.
    joins: Vec<u8>,
}

/// The depths of an image, row by row from the top.
#[derive(Clone, Debug)]
pub enum Depths {
    /// Along the view axis, metres; what is not finite and above 0 is background.
    Planar(Vec<f64>),
    /// Along the ray, metres; likewise.
    Distance(Vec<f64>),
}

const RIGHT: u8 = 1;
const DOWN: u8 = 2;

impl SeenFilm {
    /// Of depths, and of normals in the world where there is a layer of them. Both row by row, one a pixel; missing depths
    /// are background.
    pub fn new(camera: &Camera, film: Film, depths: Depths, layer: Option<Vec<[f32; 3]>>) -> SeenFilm {
        let mut depths_m = match depths {
            Depths::Planar(depths) => depths,
            Depths::Distance(distances) => {
                let along = |(pixel, distance): (usize, f64)| {
                    let [x, y] = centre(film, pixel);
                    distance / camera.ray(film, x, y).1.length()
                };
                distances.into_iter().enumerate().map(along).collect()
            }
        };
        depths_m.resize(film.pixels(), f64::INFINITY);
        let layer = layer.filter(|layer| layer.len() == film.pixels());
        for depth in &mut depths_m {
            if !(*depth > 0.0 && depth.is_finite()) {
                *depth = f64::INFINITY;
            }
        }
        let mut seen = SeenFilm {
            camera: camera.clone(),
            film,
            depths_m,
            normals: Vec::new(),
            facing: layer,
            bent: 0.0,
            joins: Vec::new(),
        };
        seen.bent = bent((0..film.pixels()).into_par_iter().filter_map(|pixel| seen.acceleration_at(pixel)).collect());
        seen.joins = (0..film.pixels()).into_par_iter().map(|pixel| seen.joins_of(pixel)).collect();
        seen.normals = (0..film.pixels()).into_par_iter().map(|pixel| seen.normal_of(pixel)).collect();
        seen
    }

    /// ρ of a pixel, linear in film coordinates on a plane; NaN for the background and outside.
    fn rho(&self, x: i64, y: i64) -> f64 {
        let inside = x >= 0 && y >= 0 && x < i64::from(self.film.width) && y < i64::from(self.film.height);
        if !inside {
            return f64::NAN;
        }
        let depth = self.depths_m[y as usize * self.film.width as usize + x as usize];
        if depth.is_infinite() {
            return f64::NAN;
        }
        match self.camera.projection {
            Projection::Perspective { .. } => 1.0 / depth,
            Projection::Orthographic { .. } => depth,
        }
    }

    /// The width of a pixel at a depth, metres; and the step of ρ over that width of a surface at 45°, at a ρ.
    fn pixel_step(&self, at: f64) -> f64 {
        let height = f64::from(self.film.height);
        match self.camera.projection {
            Projection::Perspective { yfov_rad } => at * 2.0 * (0.5 * yfov_rad).tan() / height,
            Projection::Orthographic { half_height } => 2.0 * half_height / height,
        }
    }

    fn place(&self, pixel: usize) -> [i64; 2] {
        let width = self.film.width as usize;
        [(pixel % width) as i64, (pixel / width) as i64]
    }

    /// The larger of the accelerations across and down a pixel.
    fn acceleration_at(&self, pixel: usize) -> Option<f64> {
        let [x, y] = self.place(pixel);
        let width = self.pixel_step(self.rho(x, y));
        let across = acceleration([-1, 0, 1].map(|k| self.rho(x + k, y)), width);
        let down = acceleration([-1, 0, 1].map(|k| self.rho(x, y + k)), width);
        (across.is_finite() && down.is_finite()).then_some(across.max(down))
    }

    fn joins_of(&self, pixel: usize) -> u8 {
        let [x, y] = self.place(pixel);
        let own = self.rho(x, y);
        let along = |dx: i64, dy: i64| {
            joined([-1, 0, 1, 2].map(|k| self.rho(x + k * dx, y + k * dy)), self.pixel_step(own), self.bent)
        };
        u8::from(along(1, 0)) * RIGHT + u8::from(along(0, 1)) * DOWN
    }

    /// Whether neighbouring pixels are one surface.
    pub(super) fn are_joined(&self, a: usize, b: usize) -> bool {
        let (first, second) = (a.min(b), a.max(b));
        self.joins[first] & if second - first == 1 { RIGHT } else { DOWN } != 0
    }

    /// ∂ρ/∂x (axis 0) or ∂ρ/∂y (axis 1) at a pixel.
    fn slope_of(&self, pixel: usize, axis: usize) -> Option<f64> {
        let [x, y] = self.place(pixel);
        let [dx, dy] = [[1, 0], [0, 1]][axis];
        let (width, height) = (i64::from(self.film.width), i64::from(self.film.height));
        let joined = [-2, -1, 0, 1].map(|k| {
            let (x, y) = (x + k * dx, y + k * dy);
            let inside = x >= 0 && y >= 0 && x < width && y < height;
            inside && self.joins[(y * width + x) as usize] & (RIGHT << axis) != 0
        });
        let rho = [-2, -1, 0, 1, 2].map(|k| self.rho(x + k * dx, y + k * dy));
        slope(rho, joined, self.pixel_step(rho[2]), self.bent)
    }

    /// The normal of the plane through a pixel and its joined neighbours, or of the layer where there are none.
    fn normal_of(&self, pixel: usize) -> [f32; 3] {
        const NONE: [f32; 3] = [f32::NAN; 3];
        let depth = self.depths_m[pixel];
        if depth.is_infinite() {
            return NONE;
        }
        let [x, y] = centre(self.film, pixel);
        let (_, direction) = self.camera.ray(self.film, x, y);
        let towards_camera = |n: DVec3| (if n.dot(direction) > 0.0 { -n } else { n }).as_vec3().to_array();
        let (Some(by_x), Some(by_y)) = (self.slope_of(pixel, 0), self.slope_of(pixel, 1)) else {
            let layer = self.facing.as_ref().map(|layer| DVec3::from(layer[pixel].map(f64::from)));
            let normal = layer.and_then(DVec3::try_normalize).filter(|n| n.dot(direction) != 0.0);
            return normal.map_or(NONE, towards_camera);
        };
        // ∂z of ρ = 1/z is -z² ∂ρ; of ρ = z it is ∂ρ.
        let perspective = matches!(self.camera.projection, Projection::Perspective { .. });
        let dz = [by_x, by_y].map(|by| if perspective { -depth * depth * by } else { by });
        let [across, down] = self.camera.ray_derivatives(self.film);
        let tangent = |(origin_by, direction_by): (DVec3, DVec3), dz| origin_by + direction_by * depth + direction * dz;
        let normal = tangent(across, dz[0]).cross(tangent(down, dz[1])).try_normalize();
        normal.map_or(NONE, towards_camera)
    }

    /// The point seen at a pixel's centre, metres.
    pub fn position(&self, pixel: usize) -> Option<DVec3> {
        let depth = *self.depths_m.get(pixel)?;
        let [x, y] = centre(self.film, pixel);
        let (origin, direction) = self.camera.ray(self.film, x, y);
        depth.is_finite().then(|| origin + direction * depth)
    }

    /// The surface at a pixel, as a plane; where that is not known, one that faces the camera.
    pub fn surface(&self, pixel: usize) -> Option<Surface> {
        let position = self.position(pixel)?;
        let [x, y] = centre(self.film, pixel);
        let normal = DVec3::from(self.normals[pixel].map(f64::from));
        let normal = if normal.is_finite() { normal } else { -self.camera.ray(self.film, x, y).1.normalize_or_zero() };
        Some(Surface { triangle: NO_TRIANGLE, depth_m: self.depths_m[pixel], position, normal })
    }

    /// The surface at a film position: the plane of the nearest of the four pixels around it for which `of` holds.
    pub(super) fn surface_at(&self, at: DVec2, of: impl Fn(usize) -> bool) -> Option<Surface> {
        let corner = (at - 0.5).floor();
        let pixels = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]].map(|d| corner + DVec2::from(d));
        let inside = |p: &DVec2| {
            p.x >= 0.0 && p.y >= 0.0 && p.x < f64::from(self.film.width) && p.y < f64::from(self.film.height)
        };
        let mut best: Option<(f64, usize)> = None;
        for pixel in pixels.iter().filter(|p| inside(p)) {
            let number = pixel.y as usize * self.film.width as usize + pixel.x as usize;
            let distance = (*pixel + 0.5).distance_squared(at);
            if !self.normals[number][0].is_nan() && of(number) && best.is_none_or(|b| distance < b.0) {
                best = Some((distance, number));
            }
        }
        self.moved(self.surface(best?.1)?, at)
    }

    /// A plane where another ray meets it.
    pub(super) fn moved(&self, surface: Surface, at: DVec2) -> Option<Surface> {
        let (origin, direction) = self.camera.ray(self.film, at.x, at.y);
        let depth_m = surface.normal.dot(surface.position - origin) / surface.normal.dot(direction);
        let position = origin + direction * depth_m;
        (depth_m > 0.0 && position.is_finite()).then_some(Surface { depth_m, position, ..surface })
    }

    /// Whether a pixel's point lies on the plane through another one.
    pub(super) fn on_plane(&self, of: usize, pixel: usize) -> bool {
        let (Some(plane), Some(point)) = (self.surface(of), self.position(pixel)) else { return false };
        let ([x, y], [px, py]) = (self.place(of), self.place(pixel));
        let reach = ON_PLANE_PX * ((px - x) as f64).hypot((py - y) as f64);
        plane.normal.dot(point - plane.position).abs() <= reach * self.pixel_step(self.depths_m[of])
    }

    /// The pixels within a square around one, with the columns and rows they are away.
    pub(super) fn around(&self, pixel: usize, reach: i64, mut visit: impl FnMut(usize, [i64; 2])) {
        let [x, y] = self.place(pixel);
        let (width, height) = (i64::from(self.film.width), i64::from(self.film.height));
        for near_y in (y - reach).max(0)..(y + reach + 1).min(height) {
            for near_x in (x - reach).max(0)..(x + reach + 1).min(width) {
                visit((near_y * width + near_x) as usize, [near_x - x, near_y - y]);
            }
        }
    }

    /// The pixel that a film position lies in.
    pub(super) fn pixel_at(&self, at: DVec2) -> Option<usize> {
        let inside =
            at.cmpge(DVec2::ZERO).all() && at.x < f64::from(self.film.width) && at.y < f64::from(self.film.height);
        inside.then(|| at.y as usize * self.film.width as usize + at.x as usize)
    }

    /// What a light does at every pixel. `shadow` is 1 in shadow and 0 lit; it is asked where the surface faces the light,
    /// and where nobody knows which way it faces but it is in shadow.
    pub fn answers(&self, light: &Light, shadow: &[f32]) -> Vec<Answer> {
        let answer = |pixel: usize| {
            let Some(position) = self.position(pixel).filter(|p| light.reaches(*p)) else { return Answer::Unlit };
            let told = self.facing.as_ref().map_or(self.normals[pixel], |layer| layer[pixel]);
            let facing = DVec3::from(told.map(f64::from)).dot(light.towards(position));
            let shadowed = shadow.get(pixel).is_some_and(|s| *s > SHADOWED_ABOVE);
            match (facing > 0.0, facing.is_nan(), shadowed) {
                (true, _, true) | (_, true, true) => Answer::Shadowed,
                (true, _, false) => Answer::Lit,
                _ => Answer::Unlit,
            }
        };
        (0..self.film.pixels()).into_par_iter().map(answer).collect()
    }
}

/// Pixels farther from a plane than this, in pixel widths for each pixel of distance on the film, are another surface.
const ON_PLANE_PX: f64 = 0.5;
/// A pixel more than half in shadow is in shadow.
pub(super) const SHADOWED_ABOVE: f32 = 0.5;

/// Film position of the centre of a pixel, counted row by row.
pub(super) fn centre(film: Film, pixel: usize) -> [f64; 2] {
    let width = film.width as usize;
    [(pixel % width) as f64 + 0.5, (pixel / width) as f64 + 0.5]
}
