//! Pictures of one frame: what was seen, and where the plan's maps are wrong.
//!
//! The frame is planned, and then measured from the plan alone, as `verify` does; the pictures show that measurement.

mod film;
mod map;
mod strip;

use std::fs;
use std::path::{Path, PathBuf};

use super::make::load_shot;
use super::remeasure::{Seeing, remeasure};
use super::{LightPlan, PlanError, Watch, make};
use crate::job::LoadedJob;
use crate::picture::write_exr;
use crate::samples::{Grid, GridView, LightView, sample_light};
use crate::scene::{Light, LightParams};
use crate::visibility::{Bvh, RayOffset, Tracer, see};
use film::Film;
pub use strip::strip;

/// Writes what was seen in one frame to a folder, and says which files it wrote. With `light`, only that light is planned
/// and shown.
///
/// # Errors
/// As [`super::make`], and [`PlanError::Write`].
pub fn render(
    loaded: &LoadedJob,
    frame: i64,
    light: Option<&str>,
    dir: &Path,
    watch: &Watch,
) -> Result<Vec<PathBuf>, PlanError> {
    let mut files = Files { dir: dir.to_owned(), written: Vec::new() };
    fs::create_dir_all(dir).map_err(|source| PlanError::Write { dest: dir.display().to_string(), source })?;
    let mut loaded = loaded.clone();
    let job = &mut loaded.job;
    job.frames.range = Some(frame.to_string());
    if let Some(name) = light {
        // The scene's reader says which lights there are when this one is not among them.
        let given = job.light.iter().find(|l| l.name == name).cloned();
        job.light = vec![given.unwrap_or(LightParams { name: name.to_owned(), ..LightParams::default() })];
    }
    let plan = make(&loaded, dir, false, watch)?;
    watch.check()?;

    let shot = load_shot(&loaded)?;
    let (Some(planned), Some(time)) = (plan.frames.first(), shot.frames.first()) else { return Ok(files.written) };
    let still = Bvh::still(&shot.scene);
    let posed = shot.scene.frame(time.time_s)?;
    let geometry = shot.scene.geometry(&posed);
    let moving = Bvh::moving(&shot.scene, &posed);
    let tracer = Tracer::new(geometry, &still, moving.as_ref());
    let view = see(&tracer, &posed.camera, shot.film);
    let offset = RayOffset::for_scene(&tracer);
    let seeing = Seeing { tracer: &tracer, camera: &posed.camera, view: &view, offset };
    let grid = GridView::see(&tracer, &posed.camera, Grid::new(shot.film, loaded.job.sampling.grid), Some(&view));

    let mut film = Film::new(&seeing);
    for (entry, light) in planned.lights.iter().zip(&posed.lights) {
        watch.check()?;
        let measured = remeasure(&seeing, light, &entry.maps, &loaded.job.map, None)?;
        let answers = &grid.answers(&tracer, &posed.camera, light, offset);
        let lit = LightView { tracer: &tracer, camera: &posed.camera, view: &grid, light, offset, answers };
        let samples = sample_light(&lit, loaded.job.sampling.refine, false);
        let name = file_name(entry, &planned.lights);
        film.add(&seeing, light, &name, &measured, &samples.edges);
        files.png(&format!("{name}.shadow.png"), film.shadow_mask(&measured, &samples.edges))?;
        files.png(&format!("{name}.error.png"), film.error_mask(&measured))?;
        for (k, map) in entry.maps.iter().enumerate() {
            let number = if entry.maps.len() > 1 { format!(".{k}") } else { String::new() };
            files.png(&format!("{name}.map{number}.png"), map::depth_view(map, k, &measured))?;
            let depth = map::depth_channel(&measured.drawn[k].map);
            files.write(&format!("{name}.map{number}.exr"), write_exr(map.width, map.height, vec![depth]))?;
        }
    }
    files.png("shaded.png", film.shaded())?;
    files.write("seen.exr", write_exr(shot.film.width, shot.film.height, film.channels))?;
    Ok(files.written)
}

/// Files of a folder, as they are written.
struct Files {
    dir: PathBuf,
    written: Vec<PathBuf>,
}

impl Files {
    fn png(&mut self, name: &str, picture: crate::picture::Picture) -> Result<(), PlanError> {
        self.write(name, picture.to_png())
    }

    fn write(&mut self, name: &str, bytes: std::io::Result<Vec<u8>>) -> Result<(), PlanError> {
        let path = self.dir.join(name);
        bytes
            .and_then(|bytes| fs::write(&path, bytes))
            .map_err(|source| PlanError::Write { dest: path.display().to_string(), source })?;
        self.written.push(path);
        Ok(())
    }
}

/// A light's name in file and channel names: ASCII letters, digits, `-` and `_`; numbered where that is ambiguous.
fn file_name(entry: &LightPlan, lights: &[LightPlan]) -> String {
    /// Most characters of a light's name that are kept: file systems and OpenEXR allow 255 bytes for all of a name.
    const LONGEST: usize = 100;
    let plain = |name: &str| -> String {
        let kept = |c: char| if c.is_ascii_alphanumeric() || c == '-' || c == '_' { c } else { '_' };
        name.chars().take(LONGEST).map(kept).collect()
    };
    let name = plain(&entry.light);
    let alike = |l: &&LightPlan| plain(&l.light).eq_ignore_ascii_case(&name);
    if lights.iter().filter(alike).count() < 2 {
        return name;
    }
    let number = lights.iter().position(|l| l.light == entry.light).unwrap_or(0);
    format!("{name}_{number}")
}

/// How much of a light's brightness arrives at a point: all of a directional light's, a point's or spot's falling off
/// towards its range, for pictures only.
fn falloff(light: &Light, point: glam::DVec3) -> f64 {
    use crate::scene::LightKind::{Directional, Point, Spot};
    match light.kind {
        Directional { .. } => 1.0,
        Point { range: None, .. } | Spot { range: None, .. } => 1.0,
        Point { position, range: Some(range) } | Spot { position, range: Some(range), .. } => {
            let part = point.distance(position) / range;
            (1.0 - part * part).max(0.0)
        }
    }
}
