//! Rays of a film, as any ray tracer takes them.

use glam::{DVec3, Vec3};
use lixel::scene::{Camera, Film, Light};
use lixel::visibility::{RayOffset, Tracer, see};

/// Origin, t_min, direction, t_max: f32, so that any ray tracer gets exactly the same ray.
#[derive(Clone, Copy)]
pub(crate) struct Ray(pub(crate) [f32; 8]);

impl Ray {
    fn new(origin: DVec3, direction: DVec3, t_min: f64, t_max: f64) -> Ray {
        let ([ox, oy, oz], [dx, dy, dz]) = (origin.as_vec3().to_array(), direction.as_vec3().to_array());
        Ray([ox, oy, oz, t_min as f32, dx, dy, dz, t_max as f32])
    }
    fn origin(&self) -> DVec3 {
        Vec3::new(self.0[0], self.0[1], self.0[2]).as_dvec3()
    }
    fn direction(&self) -> DVec3 {
        Vec3::new(self.0[4], self.0[5], self.0[6]).as_dvec3()
    }
    fn t_min(&self) -> f64 {
        f64::from(self.0[3])
    }
    fn t_max(&self) -> f64 {
        f64::from(self.0[7])
    }
}

/// The rays of a workload, in the order in which a film's tiles send them.
pub(crate) struct Rays {
    pub(crate) closest: Vec<Ray>,
    pub(crate) any: Vec<Ray>,
}

const TILE: u32 = 16;

impl Rays {
    /// Camera rays through all pixel centres, and shadow rays from what they meet where it faces a light.
    pub(crate) fn of(tracer: &Tracer, camera: &Camera, film: Film, lights: &[Light]) -> Rays {
        let view = see(tracer, camera, film);
        let offset = RayOffset::for_scene(tracer);
        let pixels: Vec<(u32, u32)> = (0..film.height)
            .step_by(TILE as usize)
            .flat_map(|top| (0..film.width).step_by(TILE as usize).map(move |left| (left, top)))
            .flat_map(|(left, top)| {
                let rows = top..(top + TILE).min(film.height);
                rows.flat_map(move |y| (left..(left + TILE).min(film.width)).map(move |x| (x, y)))
            })
            .collect();
        let far = camera.far.unwrap_or(f64::INFINITY);
        let closest = pixels.iter().map(|&(x, y)| {
            let (origin, direction) = camera.ray(film, f64::from(x) + 0.5, f64::from(y) + 0.5);
            Ray::new(origin, direction, camera.near, far)
        });
        let any = lights.iter().flat_map(|light| {
            pixels.iter().filter_map(|&(x, y)| {
                let surface = view.surface(tracer, camera, (y * film.width + x) as usize)?;
                let origin = surface.position + surface.normal * offset.metres;
                let towards = light.towards(origin);
                let end = if light.position().is_some() { 1.0 } else { f64::INFINITY };
                let asked = surface.normal.dot(towards) > 0.0 && light.reaches(surface.position);
                asked.then(|| Ray::new(origin, towards, 0.0, end))
            })
        });
        Rays { closest: closest.collect(), any: any.collect() }
    }
    /// A triangle for each ray, or -1.
    pub(crate) fn trace_closest(&self, tracer: &Tracer, answers: &mut [i32]) {
        for (ray, answer) in self.closest.iter().zip(answers) {
            let hit = tracer.closest(ray.origin(), ray.direction(), ray.t_min(), ray.t_max());
            *answer = hit.map_or(-1, |hit| hit.triangle as i32);
        }
    }

    /// 1 for each ray that meets anything.
    pub(crate) fn trace_any(&self, tracer: &Tracer, answers: &mut [i32]) {
        for (ray, answer) in self.any.iter().zip(answers) {
            *answer = i32::from(tracer.occluded(ray.origin(), ray.direction(), ray.t_min(), ray.t_max()));
        }
    }
}
