//! The images of a shot: which files, how large, by which camera; and one frame of them read.

use super::exr_file::ExrFile;
use super::film::{Depths, SeenFilm};
use super::header_camera::camera_of_header;
use super::layers::{Found, find};
use super::params::LIGHT_NAME;
use super::pattern::{frame_file, frames_there, has_frame_number};
use super::{AovError, AovParams, DepthKind, NormalSpace, ShadowValue};
use crate::scene::{Camera, Film, Light, LightParams, Projection, UpAxis, parse_range};
use glam::{DMat3, DVec3};
use std::path::{Path, PathBuf};

/// The images of a shot.
#[derive(Clone, Debug)]
pub struct Images {
    params: AovParams,
    /// `[[light]]`, for the layers that they name.
    lights: Vec<LightParams>,
    /// Size of all images.
    pub film: Film,
    /// In the order of the job's range, or ascending.
    pub frames: Vec<i64>,
    /// Cameras of the headers, in the world and in metres, one a frame; empty where the job states the camera.
    pub cameras: Vec<Camera>,
    /// Every file, frame by frame.
    pub files: Vec<PathBuf>,
    /// Remarks for the user.
    pub notes: Vec<String>,
}

/// A frame of the images.
#[derive(Clone, Debug)]
pub struct ImagesFrame {
    /// What the pixels see.
    pub film: SeenFilm,
    /// For each light, by name, its shadow layer, 1 in shadow, row by row.
    pub shadows: Vec<(String, Vec<f32>)>,
}

/// Depths and coordinates from here on, in the file's unit, are a renderer's way of writing "nothing".
const NOTHING: f64 = 1e9;
/// A point may be seen this far from its pixel's centre: a corner of the pixel, and filters wider than it.
const OFF_PX: f64 = 1.0;
/// Part of the points that may be off: at silhouettes renderers average surfaces into points of none.
const OFF_PART: f64 = 0.25;
/// A shadow layer may leave 0…1 by this: ringing of filters.
const RINGING: f32 = 0.25;

/// The camera that a job asks for besides the headers'.
#[derive(Clone, Copy, Debug)]
pub struct Wanted<'a> {
    /// `[frames] range`; absent = all that are there.
    pub range: Option<&'a str>,
    /// `[image] size`.
    pub size: Option<[u32; 2]>,
    /// True where the job says where the camera is.
    pub own_camera: bool,
    /// `[camera] fov`, degrees, `near` and `far`, metres.
    pub lens: [Option<f64>; 3],
}

impl Images {
    /// Finds the files and reads their headers. The paths of `params` can be opened.
    ///
    /// # Errors
    /// Any [`AovError`] but those of pixels.
    pub fn open(params: &AovParams, lights: &[LightParams], wanted: &Wanted) -> Result<Images, AovError> {
        let frames = frames(params, wanted.range)?;
        let mut images = Images {
            params: params.clone(),
            lights: lights.to_vec(),
            film: Film { width: 0, height: 0 },
            frames,
            cameras: Vec::new(),
            files: Vec::new(),
            notes: Vec::new(),
        };
        let mut size = wanted.size.map(|size| (size, "[image] size".to_owned()));
        for frame in images.frames.clone() {
            let files = images.files_of(frame)?;
            for file in &files {
                let found = [file.film.width, file.film.height];
                let (expected, whose) = size.get_or_insert_with(|| (found, file.path.display().to_string()));
                if *expected != found {
                    let (path, whose, wanted) = (file.path.clone(), whose.clone(), *expected);
                    return Err(AovError::Size { path, found, whose, wanted });
                }
                if !images.files.contains(&file.path) {
                    images.files.push(file.path.clone());
                }
                images.film = file.film;
            }
            let (found, layer) = images.find_surfaces(&files)?;
            if found.half && images.notes.is_empty() {
                let path = files[found.file].path.display();
                let note = format!("{path}: layer \"{layer}\" has 16 bits, too few for slopes: write 32-bit floats");
                images.notes.push(note);
            }
            if !wanted.own_camera {
                let camera = images.camera(&files, wanted)?;
                images.cameras.push(camera);
            }
        }
        Ok(images)
    }

    fn files_of(&self, frame: i64) -> Result<Vec<ExrFile>, AovError> {
        self.params.file.iter().map(|pattern| ExrFile::open(&frame_file(pattern, frame))).collect()
    }

    /// World axes from those of the files.
    fn axes(&self) -> DMat3 {
        match self.params.up {
            UpAxis::Y => DMat3::IDENTITY,
            UpAxis::Z => DMat3::from_cols(DVec3::X, DVec3::NEG_Z, DVec3::Y),
        }
    }

    /// The camera of the first file that has one.
    fn camera(&self, files: &[ExrFile], wanted: &Wanted) -> Result<Camera, AovError> {
        let [fov, near, far] = wanted.lens;
        for file in files {
            let path = &file.path;
            let read = camera_of_header(&file.camera, file.film, fov);
            let read = read.map_err(|problem| AovError::Camera { path: path.clone(), problem })?;
            let Some(camera) = read else { continue };
            let metres = self.params.unit.metres();
            let own_near = if file.camera.near.is_some() { camera.near * metres } else { camera.near };
            let projection = match camera.projection {
                Projection::Orthographic { half_height } => {
                    Projection::Orthographic { half_height: half_height * metres }
                }
                perspective => perspective,
            };
            return Ok(Camera {
                position: self.axes() * camera.position * metres,
                world_from_camera: self.axes() * camera.world_from_camera,
                projection,
                near: near.unwrap_or(own_near),
                far,
                ..camera
            });
        }
        let path = files.first().map(|f| f.path.clone()).unwrap_or_default();
        Err(AovError::NoCamera { path })
    }

    /// Reads a frame: what `camera` sees, and the shadow layers of `lights`.
    ///
    /// # Errors
    /// Missing layers and pixels that hold no number.
    pub fn frame(&self, frame: i64, camera: &Camera, lights: &[Light]) -> Result<ImagesFrame, AovError> {
        let files = self.files_of(frame)?;
        if let Some(file) = files.iter().find(|file| file.film != self.film) {
            let [found, wanted] = [file.film, self.film].map(|f| [f.width, f.height]);
            let whose = "the rest of the shot".to_owned();
            return Err(AovError::Size { path: file.path.clone(), found, whose, wanted });
        }
        let (found, layer) = self.find_surfaces(&files)?;
        let file = &files[found.file];
        let depths = match &self.params.depth {
            Some(depth) => self.depths(file, &found, &layer, depth.kind)?,
            None => self.depths_of_points(file, &found, &layer, camera)?,
        };
        let normals = self.normals(&files, camera)?;
        let shadow = |light: &Light| Ok((light.name.clone(), self.shadow(&files, light)?));
        let shadows = lights.iter().map(shadow).collect::<Result<_, AovError>>()?;
        Ok(ImagesFrame { film: SeenFilm::new(camera, self.film, depths, normals), shadows })
    }

    /// The layer that says where surfaces are, and its name.
    fn find_surfaces(&self, files: &[ExrFile]) -> Result<(Found, String), AovError> {
        let (key, layer, count) = match (&self.params.depth, &self.params.position) {
            (Some(depth), _) => ("aov.depth.layer", &depth.layer, 1),
            (None, Some(position)) => ("aov.position.layer", &position.layer, 3),
            (None, None) => {
                let pattern = self.params.file.first().cloned().unwrap_or_default();
                let problem = "neither depth nor position is named; add depth = { kind = \"planar\" }".to_owned();
                return Err(AovError::Frames { pattern, problem });
            }
        };
        Ok((find(files, key, layer, count)?, layer.clone()))
    }

    fn depths(&self, file: &ExrFile, found: &Found, layer: &str, kind: DepthKind) -> Result<Depths, AovError> {
        let planes = file.read(&found.channels, f32::INFINITY)?;
        let values = planes.into_iter().next().unwrap_or_default();
        refuse(file, layer, &values, "NaN", |v| v.is_nan())?;
        let metres = self.params.unit.metres();
        let depth = |v: f32| if f64::from(v) < NOTHING { f64::from(v) * metres } else { f64::INFINITY };
        let depths = values.into_iter().map(depth).collect();
        Ok(match kind {
            DepthKind::Planar => Depths::Planar(depths),
            DepthKind::Distance => Depths::Distance(depths),
        })
    }

    /// Depths along the view axis of world points, which have to be seen in their own pixels.
    fn depths_of_points(
        &self,
        file: &ExrFile,
        found: &Found,
        layer: &str,
        camera: &Camera,
    ) -> Result<Depths, AovError> {
        let planes = file.read(&found.channels, f32::INFINITY)?;
        for plane in &planes {
            refuse(file, layer, plane, "NaN", |v| v.is_nan())?;
        }
        let [x, y, z] = <[Vec<f32>; 3]>::try_from(planes).unwrap_or_default();
        let to_world = self.axes() * self.params.unit.metres();
        let mut off = Vec::new();
        let mut there = 0;
        let depths = (0..x.len()).map(|pixel| {
            let point = DVec3::new(f64::from(x[pixel]), f64::from(y[pixel]), f64::from(z[pixel]));
            let nothing = point == DVec3::ZERO || !point.is_finite() || point.abs().max_element() >= NOTHING;
            if nothing {
                return f64::INFINITY;
            }
            there += 1;
            let [px, py] = super::film::centre(self.film, pixel);
            let seen = camera.project(self.film, to_world * point);
            let distance = seen.map_or(f64::INFINITY, |(sx, sy, _)| (sx - px).abs().max((sy - py).abs()));
            match seen {
                Some((_, _, depth)) if distance <= OFF_PX => depth,
                _ => {
                    off.push(distance);
                    f64::INFINITY
                }
            }
        });
        let depths: Vec<f64> = depths.collect();
        if off.len() as f64 > OFF_PART * f64::from(there.max(1)) {
            off.sort_by(f64::total_cmp);
            let (path, median_px) = (file.path.clone(), off[off.len() / 2]);
            return Err(AovError::Elsewhere {
                path,
                layer: layer.into(),
                off: off.len(),
                of: there as usize,
                median_px,
            });
        }
        Ok(Depths::Planar(depths))
    }

    fn normals(&self, files: &[ExrFile], camera: &Camera) -> Result<Option<Vec<[f32; 3]>>, AovError> {
        let Some(normal) = &self.params.normal else { return Ok(None) };
        let found = find(files, "aov.normal.layer", &normal.layer, 3)?;
        let planes = files[found.file].read(&found.channels, 0.0)?;
        for plane in &planes {
            refuse(&files[found.file], &normal.layer, plane, "NaN or infinite", |v| !v.is_finite())?;
        }
        let [x, y, z] = <[Vec<f32>; 3]>::try_from(planes).unwrap_or_default();
        let to_world = match normal.space {
            NormalSpace::World => self.axes(),
            NormalSpace::Camera => camera.world_from_camera,
        }
        .as_mat3();
        Ok(Some((0..x.len()).map(|k| (to_world * glam::Vec3::new(x[k], y[k], z[k])).to_array()).collect()))
    }

    /// The name of a light's layer, and the key that says so.
    fn layer_of(&self, light: &str) -> (String, String) {
        match self.lights.iter().find(|l| l.name == light).and_then(|l| l.aov.clone()) {
            Some(layer) => (layer, format!("light \"{light}\": aov")),
            None => (self.params.shadow.layer.replace(LIGHT_NAME, light), "aov.shadow.layer".to_owned()),
        }
    }

    fn shadow(&self, files: &[ExrFile], light: &Light) -> Result<Vec<f32>, AovError> {
        let (layer, key) = self.layer_of(&light.name);
        let found = find(files, &key, &layer, 1)?;
        let file = &files[found.file];
        let values = file.read(&found.channels, 0.0)?.into_iter().next().unwrap_or_default();
        refuse(file, &layer, &values, "NaN or infinite", |v| !v.is_finite())?;
        refuse(file, &layer, &values, "outside 0 to 1", |v| !(-RINGING..=1.0 + RINGING).contains(&v))?;
        Ok(match self.params.shadow.one {
            ShadowValue::Shadowed => values,
            ShadowValue::Lit => values.into_iter().map(|v| 1.0 - v).collect(),
        })
    }
}

impl ImagesFrame {
    /// The shadow layer of a light of the frame; empty for another light.
    pub fn shadow(&self, light: &Light) -> &[f32] {
        self.shadows.iter().find(|(name, _)| *name == light.name).map_or(&[], |(_, layer)| layer)
    }
}

/// The frames of a range, or those whose files are there.
fn frames(params: &AovParams, range: Option<&str>) -> Result<Vec<i64>, AovError> {
    let pattern = params.file.first().cloned().unwrap_or_default();
    let refused = |problem: String| AovError::Frames { pattern: pattern.clone(), problem };
    let numbered = params.file.iter().find(|file| has_frame_number(file));
    let frames = match (range, numbered) {
        (Some(range), _) => parse_range(range).map_err(|e| refused(e.to_string()))?,
        (None, None) => vec![1],
        (None, Some(pattern)) => frames_there(pattern).map_err(|e| refused(format!("its folder: {e}")))?,
    };
    if frames.is_empty() {
        return Err(refused("no file of this pattern is there; check the folder and the number of #".to_owned()));
    }
    if numbered.is_none() && frames.len() > 1 {
        let problem = format!("one image cannot show {} frames; put #### where the frame number goes", frames.len());
        return Err(refused(problem));
    }
    Ok(frames)
}

/// Refuses a layer some of whose pixels are bad.
fn refuse(file: &ExrFile, layer: &str, values: &[f32], what: &str, bad: impl Fn(f32) -> bool) -> Result<(), AovError> {
    let Some(first) = values.iter().position(|v| bad(*v)) else { return Ok(()) };
    let count = values.iter().filter(|v| bad(**v)).count();
    let width = file.film.width as usize;
    let path = Path::to_owned(&file.path);
    let at = [first % width, first / width];
    Err(AovError::Pixels { path, layer: layer.to_owned(), count, what: what.to_owned(), at })
}
