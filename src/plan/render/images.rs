//! What a renderer would write of a shot besides its pictures: depth, positions, normals and a shadow layer a light, with the
//! camera in the header. `[visibility] source = "aov"` plans from such files.

use std::fs;
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use super::super::make::load_shot;
use super::super::stage::Posed;
use super::super::{PlanError, Stage, Watch};
use super::file_name;
use crate::aov::{HeaderCamera, frame_file, has_frame_number, header_of};
use crate::job::LoadedJob;
use crate::picture::{CameraAttributes, Channel, write_exr_of_camera};
use crate::scene::Camera;
use crate::visibility::{Answer, Bvh, RayOffset, classify, see};

/// Writes an OpenEXR file for every frame of a job and says which: `Z` (along the view axis, metres, infinite for the
/// background), `P.x P.y P.z` and `N.x N.y N.z` (world), and for each light `shadow_NAME`, 1 in shadow. `pattern` has
/// `####` or `%04d` for the frame number.
///
/// # Errors
/// Those of loading, [`PlanError::Write`], and [`PlanError::Pattern`] for several frames and one file name.
pub fn render_images(loaded: &LoadedJob, pattern: &Path, watch: &Watch) -> Result<Vec<PathBuf>, PlanError> {
    let shot = load_shot(loaded)?;
    if shot.frames.len() > 1 && !has_frame_number(pattern) {
        return Err(PlanError::Pattern { pattern: pattern.to_owned(), frames: shot.frames.len() });
    }
    if let Some(folder) = pattern.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        fs::create_dir_all(folder).map_err(|source| PlanError::Write { dest: folder.display().to_string(), source })?;
    }
    let still = Bvh::build(&shot.scene.still);
    let total = shot.frames.len() as u64;
    let mut written = Vec::with_capacity(shot.frames.len());
    for (done, time) in (0..).zip(&shot.frames) {
        watch.step(Stage::Lights, done, total)?;
        let posed = Posed::new(&shot, time.time_s)?;
        let (tracer, frame) = (posed.tracer(&shot, &still), &posed.frame);
        let (camera, film) = (&frame.camera, shot.film);
        let view = see(&tracer, camera, film);
        let offset = RayOffset::for_scene(&tracer);
        let surfaces: Vec<_> =
            (0..film.pixels()).into_par_iter().map(|pixel| view.surface(&tracer, camera, pixel)).collect();
        let channel = |name: String, value: &dyn Fn(usize) -> f64| Channel {
            name,
            values: (0..film.pixels()).map(|pixel| value(pixel) as f32).collect(),
        };
        let mut channels = vec![channel("Z".to_owned(), &|pixel| view.depths_m[pixel])];
        for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
            let position = |p: usize| surfaces[p].map_or(0.0, |s| (s.position + shot.scene.origin)[k]);
            channels.push(channel(format!("P.{axis}"), &position));
            channels.push(channel(format!("N.{axis}"), &|p| surfaces[p].map_or(0.0, |s| s.normal[k])));
        }
        let names: Vec<&str> = frame.lights.iter().map(|light| light.name.as_str()).collect();
        for light in &frame.lights {
            watch.check()?;
            let answers = classify(&tracer, &view, camera, light, offset);
            let shadow = |pixel: usize| f64::from(u8::from(answers[pixel] == Answer::Shadowed));
            channels.push(channel(format!("shadow_{}", file_name(&light.name, &names)), &shadow));
        }
        let in_world = Camera { position: camera.position + shot.scene.origin, ..camera.clone() };
        let HeaderCamera { world_to_camera, world_to_ndc, near } = header_of(&in_world, film);
        let attributes = CameraAttributes {
            world_to_camera: world_to_camera.unwrap_or_default(),
            world_to_ndc: world_to_ndc.unwrap_or_default(),
            near: near.unwrap_or_default(),
        };
        let path = frame_file(pattern, time.frame);
        write_exr_of_camera(film.width, film.height, channels, &attributes)
            .and_then(|bytes| fs::write(&path, bytes))
            .map_err(|source| PlanError::Write { dest: path.display().to_string(), source })?;
        written.push(path);
    }
    watch.step(Stage::Lights, total, total)?;
    Ok(written)
}
