//! The pinhole camera of a frame and the film it exposes.

use glam::{DMat3, DMat4, DVec3, DVec4};
use serde::{Deserialize, Serialize};

/// How directions become film positions.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
pub enum Projection {
    /// A pinhole with this vertical field of view; the film's own aspect gives the horizontal one (square pixels).
    Perspective {
        /// Full vertical angle, radians, in (0, π).
        yfov_rad: f64,
    },
    /// Parallel rays; the film's own aspect gives the width.
    Orthographic {
        /// Half the height of the view, metres.
        half_height: f64,
    },
}

/// A camera in scene space.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct Camera {
    /// As in the file or job.
    pub name: String,
    /// Centre of projection, scene space, metres; of an orthographic camera, which has none, where it stands.
    pub position: DVec3,
    /// Columns: right, up, backward (the camera looks along -z), orthonormal, right-handed.
    pub world_from_camera: DMat3,
    /// Perspective or orthographic.
    pub projection: Projection,
    /// Distance of the near plane along the view axis, metres. Surfaces nearer are not seen.
    pub near: f64,
    /// Distance of the far plane; `None` = infinite.
    pub far: Option<f64>,
}

/// Most pixels of an image. Planning holds about 100 bytes for each, so this takes 6.4 GiB.
pub const FILM_PIXELS_MAX: u64 = 1 << 26;

/// The image: square pixels, row 0 at the top.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Film {
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
}

impl Film {
    /// Width over height.
    pub fn aspect(&self) -> f64 {
        f64::from(self.width) / f64::from(self.height)
    }

    /// Number of pixels.
    pub fn pixels(&self) -> usize {
        self.width as usize * self.height as usize
    }
}

/// Rays through the positions of a film, as [`Camera::ray`].
#[derive(Clone, Copy, Debug)]
pub struct FilmRays<'a> {
    camera: &'a Camera,
    film: Film,
    aspect: f64,
    /// Of the view: one metre along the axis, or anywhere where rays are parallel.
    half_height: f64,
}

impl FilmRays<'_> {
    /// The ray through the centre of a pixel, counted row by row.
    pub fn through_pixel(&self, pixel: usize) -> (DVec3, DVec3) {
        let width = self.film.width as usize;
        self.through((pixel % width) as f64 + 0.5, (pixel / width) as f64 + 0.5)
    }

    /// The ray through a film position.
    pub fn through(&self, x: f64, y: f64) -> (DVec3, DVec3) {
        let FilmRays { camera, film, aspect, half_height } = *self;
        let ndc_x = 2.0 * x / f64::from(film.width) - 1.0;
        let ndc_y = 1.0 - 2.0 * y / f64::from(film.height);
        let (right, up) = (ndc_x * half_height * aspect, ndc_y * half_height);
        let m = &camera.world_from_camera;
        match camera.projection {
            Projection::Perspective { .. } => (camera.position, *m * DVec3::new(right, up, -1.0)),
            Projection::Orthographic { .. } => (camera.position + *m * DVec3::new(right, up, 0.0), camera.forward()),
        }
    }
}

impl Camera {
    /// View axis, unit, the way the camera looks.
    pub fn forward(&self) -> DVec3 {
        -self.world_from_camera.z_axis
    }

    /// A ray through a film position (pixels, y down): its origin, and its direction scaled so that one unit of the
    /// parameter is one metre *along the view axis*. The near and far planes are then plain parameter bounds.
    pub fn ray(&self, film: Film, x: f64, y: f64) -> (DVec3, DVec3) {
        self.rays(film).through(x, y)
    }

    /// The rays through a film, for many of them.
    pub fn rays(&self, film: Film) -> FilmRays<'_> {
        let half_height = match self.projection {
            Projection::Perspective { yfov_rad } => (0.5 * yfov_rad).tan(),
            Projection::Orthographic { half_height } => half_height,
        };
        FilmRays { camera: self, film, aspect: film.aspect(), half_height }
    }

    /// Derivatives of the ray by film x and y: (∂origin/∂x, ∂direction/∂x), (∂origin/∂y, ∂direction/∂y); constant
    /// over the film.
    pub fn ray_derivatives(&self, film: Film) -> [(DVec3, DVec3); 2] {
        let px = 2.0 / f64::from(film.width);
        let py = -2.0 / f64::from(film.height);
        let m = &self.world_from_camera;
        match self.projection {
            Projection::Perspective { yfov_rad } => {
                let t = (0.5 * yfov_rad).tan();
                [(DVec3::ZERO, m.x_axis * (px * t * film.aspect())), (DVec3::ZERO, m.y_axis * (py * t))]
            }
            Projection::Orthographic { half_height } => [
                (m.x_axis * (px * half_height * film.aspect()), DVec3::ZERO),
                (m.y_axis * (py * half_height), DVec3::ZERO),
            ],
        }
    }

    /// OpenGL clip space from scene space for a film, with an infinite far plane where there is none.
    pub fn clip_from_scene(&self, film: Film) -> DMat4 {
        let n = self.near;
        let clip_from_camera = match self.projection {
            Projection::Perspective { yfov_rad } => {
                let f = 1.0 / (0.5 * yfov_rad).tan();
                let (a, b) = match self.far {
                    Some(far) => ((far + n) / (n - far), 2.0 * far * n / (n - far)),
                    None => (-1.0, -2.0 * n),
                };
                DMat4::from_cols(
                    DVec4::new(f / film.aspect(), 0.0, 0.0, 0.0),
                    DVec4::new(0.0, f, 0.0, 0.0),
                    DVec4::new(0.0, 0.0, a, -1.0),
                    DVec4::new(0.0, 0.0, b, 0.0),
                )
            }
            Projection::Orthographic { half_height } => {
                let far = self.far.unwrap_or(n + 1.0);
                DMat4::from_cols(
                    DVec4::new(1.0 / (half_height * film.aspect()), 0.0, 0.0, 0.0),
                    DVec4::new(0.0, 1.0 / half_height, 0.0, 0.0),
                    DVec4::new(0.0, 0.0, -2.0 / (far - n), 0.0),
                    DVec4::new(0.0, 0.0, -(far + n) / (far - n), 1.0),
                )
            }
        };
        let camera_from_world = self.world_from_camera.transpose();
        let view = DMat4::from_mat3(camera_from_world) * DMat4::from_translation(-self.position);
        clip_from_camera * view
    }

    /// Film position (pixels, y down) and distance along the view axis of a scene point; `None` behind the camera.
    pub fn project(&self, film: Film, point: DVec3) -> Option<(f64, f64, f64)> {
        let p = self.world_from_camera.transpose() * (point - self.position);
        let depth = -p.z;
        let (sx, sy) = match self.projection {
            Projection::Perspective { yfov_rad } => {
                if depth <= 0.0 {
                    return None;
                }
                let t = (0.5 * yfov_rad).tan();
                (p.x / (depth * t * film.aspect()), p.y / (depth * t))
            }
            Projection::Orthographic { half_height } => (p.x / (half_height * film.aspect()), p.y / half_height),
        };
        Some(((sx + 1.0) * 0.5 * f64::from(film.width), (1.0 - sy) * 0.5 * f64::from(film.height), depth))
    }
}
