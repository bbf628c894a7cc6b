//! Planning from a renderer's images: what they give in place of rays.

use std::path::{Path, PathBuf};

use super::stage::Lit;
use super::{PlanError, relative_path};
use crate::aov::{Images, ImagesFrame, Wanted};
use crate::depth::Unseen;
use crate::job::{Job, LoadedJob};
use crate::math::Bounds;
use crate::measure::{Outside, Receivers};
use crate::scene::{CameraParams, Light};

/// Said once to who plans from images.
pub(super) const NOTE: &str = "planned from images: casters are not seen, nothing is drawn, sizes are predicted";

/// Finds the images of a job, and reads their headers.
///
/// # Errors
/// [`PlanError::Aov`].
pub(super) fn open(loaded: &LoadedJob) -> Result<Images, PlanError> {
    let job = &loaded.job;
    let mut params = job.aov.clone().unwrap_or_default();
    params.file = loaded.image_files();
    let camera = &job.camera;
    // A lens goes with the header's camera; anything else says where the camera is.
    let lens = CameraParams { fov: camera.fov, near: camera.near, far: camera.far, ..CameraParams::default() };
    let wanted = Wanted {
        range: job.frames.range.as_deref(),
        size: job.image.size,
        own_camera: *camera != lens,
        lens: [camera.fov, camera.near, camera.far],
    };
    Ok(Images::open(&params, &job.light, &wanted)?)
}

/// A file name with a place for the frame number, as seen from the plan's folder.
pub(super) fn relative_pattern(pattern: &Path, plan_dir: &Path) -> PathBuf {
    let folder = pattern.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let folder = PathBuf::from(relative_path(folder, plan_dir));
    folder.join(pattern.file_name().unwrap_or_default())
}

/// What the images say of one light.
pub(super) fn look(images: &ImagesFrame, light: &Light, job: &Job) -> Lit {
    let shadow = images.shadow(light);
    let answers = images.film.answers(light, shadow);
    let film = Receivers::at(&answers, |pixel| images.film.position(pixel));
    let samples = images.film.sample(light, shadow, &answers, job.map.outside == Outside::Shadowed);
    Lit { answers, film: Some(film), samples, rays: 0 }
}

/// The pixels that face a light.
pub(super) fn receivers(images: &ImagesFrame, light: &Light) -> Receivers {
    let answers = images.film.answers(light, images.shadow(light));
    Receivers::at(&answers, |pixel| images.film.position(pixel))
}

/// How far the depth range of a light's maps reaches past what is seen: as the job says, else a directional light's by the
/// extent of all that is seen.
pub(super) fn unseen(light: &Light, job: &Job, seen: Bounds) -> Unseen {
    let own = job.light.iter().find(|l| l.name == light.name);
    Unseen { near_m: own.and_then(|l| l.near), far_m: own.and_then(|l| l.far), reach_m: seen.diagonal() }
}
