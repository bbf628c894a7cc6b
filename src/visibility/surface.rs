//! The surface behind a film position.
//!
//! A camera ray x ↦ o(x) + t d(x) meets a plane n·p = n·v at t = n·(v - o) / n·d. Differentiating n·(o + t d) = n·v by a
//! film coordinate gives ∂t = -n·(∂o + t ∂d) / n·d and with it ∂p = ∂o + t ∂d + d ∂t.

use glam::DVec3;

use super::trace::{Hit, Tracer};
use crate::scene::{Camera, Film};

/// A point seen by the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// Index through [`crate::scene::Geometry`].
    pub triangle: u32,
    /// Distance along the view axis, metres.
    pub depth_m: f64,
    /// Scene space, metres: on the plane of the triangle, along the film position's ray, both in f64.
    pub position: DVec3,
    /// Unit normal of the triangle, on the side of the camera.
    pub normal: DVec3,
}

impl Surface {
    /// The point where the ray through a film position meets a triangle, at `depth_m` along the view axis.
    pub(crate) fn new(tracer: &Tracer, camera: &Camera, film: Film, [x, y]: [f64; 2], hit: (u32, f64)) -> Surface {
        Surface::on_ray(tracer, camera.ray(film, x, y), hit)
    }

    /// The same on a given ray.
    pub(super) fn on_ray(tracer: &Tracer, ray: (DVec3, DVec3), hit: (u32, f64)) -> Surface {
        let ((origin, direction), (triangle, depth_m)) = (ray, hit);
        let [a, b, c] = tracer.geometry().triangle_f64(triangle);
        // Triangles without area are not traced; of the thinnest slivers the length may still underflow.
        let normal = (b - a).cross(c - a).try_normalize().unwrap_or_else(|| -direction.normalize_or_zero());
        let normal = if normal.dot(direction) > 0.0 { -normal } else { normal };
        Surface { triangle, depth_m, position: origin + direction * depth_m, normal }
    }

    /// ∂position/∂x and ∂position/∂y, metres per film pixel, along the plane of the triangle. `camera`, `film` and the
    /// film position are those the surface was found with. Not finite where the plane is seen exactly edge-on.
    pub fn film_derivatives(&self, camera: &Camera, film: Film, x: f64, y: f64) -> [DVec3; 2] {
        let (_, direction) = camera.ray(film, x, y);
        let facing = self.normal.dot(direction);
        camera.ray_derivatives(film).map(|(origin_by, direction_by)| {
            let step = origin_by + direction_by * self.depth_m;
            step - direction * (self.normal.dot(step) / facing)
        })
    }
}

/// The first surface, of either orientation, between the camera's near and far planes behind a film position (pixels, y
/// down); `None` for the background.
pub fn surface_at(tracer: &Tracer, camera: &Camera, film: Film, x: f64, y: f64) -> Option<Surface> {
    let ray = camera.ray(film, x, y);
    let hit = first_hit(tracer, camera, ray)?;
    Some(Surface::on_ray(tracer, ray, (hit.triangle, hit.t)))
}

/// What a ray of a camera meets between its near and far planes.
pub(crate) fn first_hit(tracer: &Tracer, camera: &Camera, (origin, direction): (DVec3, DVec3)) -> Option<Hit> {
    tracer.closest(origin, direction, camera.near, camera.far.unwrap_or(f64::INFINITY))
}
