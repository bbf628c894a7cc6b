//! OpenEXR files: what they hold, and chosen channels of them as planes over the display window.
//!
//! Blocks are decompressed one after the other and only the lines asked for are kept: files of production have a hundred
//! channels and more.

use super::AovError;
use super::header_camera::HeaderCamera;
use crate::scene::Film;
use exr::block::reader::ChunksReader;
use exr::math::Vec2;
use exr::meta::MetaData;
use exr::meta::attribute::SampleType;
use exr::prelude::f16;
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

/// Longest side of an image, pixels: as of a film in a job.
const MAX_SIDE: usize = 16_384;
/// A pixel's width over its height may differ from 1 by this: f32 and a writer's rounding.
const SQUARE: f32 = 1e-3;

/// A file whose header was read.
#[derive(Debug)]
pub(super) struct ExrFile {
    pub(super) path: PathBuf,
    /// Its display window.
    pub(super) film: Film,
    /// Every channel.
    pub(super) channels: Vec<ExrChannel>,
    /// The camera as written.
    pub(super) camera: HeaderCamera,
}

/// A channel of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct ExrChannel {
    /// Number of the part, and of the channel in it.
    pub(super) place: [usize; 2],
    /// Name of its part; empty where it has none.
    pub(super) part: String,
    /// As written.
    pub(super) name: String,
    /// 16 bits.
    pub(super) half: bool,
}

fn problem(path: &Path, problem: impl Into<String>) -> AovError {
    AovError::Exr { path: path.to_owned(), problem: problem.into() }
}

fn broken(path: &Path, error: &exr::error::Error) -> AovError {
    problem(path, format!("cannot be read as OpenEXR: {error}"))
}

impl ExrFile {
    /// Reads the header.
    ///
    /// # Errors
    /// [`AovError::Read`], and [`AovError::Exr`] for another kind of file, deep or subsampled pixels, pixels that are not
    /// square, and sizes beyond reason.
    pub(super) fn open(path: &Path) -> Result<ExrFile, AovError> {
        let file = File::open(path).map_err(|source| AovError::Read { path: path.to_owned(), source })?;
        let meta = MetaData::read_from_buffered(BufReader::new(file), false).map_err(|e| broken(path, &e))?;
        let Some(first) = meta.headers.first() else { return Err(problem(path, "has no image")) };
        let window = first.shared_attributes.display_window.size;
        if window.0 == 0 || window.1 == 0 || window.0 > MAX_SIDE || window.1 > MAX_SIDE {
            let text =
                format!("its display window is {}x{}; a side of 1 to {MAX_SIDE} pixels is wanted", window.0, window.1);
            return Err(problem(path, text));
        }
        let aspect = first.shared_attributes.pixel_aspect;
        if (aspect - 1.0).abs() > SQUARE {
            return Err(problem(path, format!("its pixels are {aspect} wide and 1 high; render square pixels")));
        }
        let mut channels = Vec::new();
        let mut camera = HeaderCamera::default();
        for (p, header) in meta.headers.iter().enumerate() {
            let own = &header.own_attributes;
            camera.world_to_camera = camera.world_to_camera.or(own.world_to_camera);
            camera.world_to_ndc = camera.world_to_ndc.or(own.world_to_normalized_device);
            camera.near = camera.near.or(own.near_clip_plane);
            if header.deep {
                continue;
            }
            let part = own.layer_name.as_ref().map(ToString::to_string).unwrap_or_default();
            for (c, channel) in header.channels.list.iter().enumerate() {
                // Subsampled channels are luminance-chroma pictures, never data.
                if channel.sampling == Vec2(1, 1) {
                    let half = channel.sample_type == SampleType::F16;
                    channels.push(ExrChannel {
                        place: [p, c],
                        part: part.clone(),
                        name: channel.name.to_string(),
                        half,
                    });
                }
            }
        }
        if channels.is_empty() {
            return Err(problem(path, "holds deep or subsampled channels only; write flat ones, one value a pixel"));
        }
        let film = Film { width: window.0 as u32, height: window.1 as u32 };
        Ok(ExrFile { path: path.to_owned(), film, channels, camera })
    }

    /// Reads channels as planes over the display window, row by row from the top; `outside` fills what the data window
    /// leaves out.
    ///
    /// # Errors
    /// [`AovError::Read`] and [`AovError::Exr`].
    pub(super) fn read(&self, wanted: &[[usize; 2]], outside: f32) -> Result<Vec<Vec<f32>>, AovError> {
        let path = &self.path;
        let failed = |e: exr::error::Error| broken(path, &e);
        let file = File::open(path).map_err(|source| AovError::Read { path: path.clone(), source })?;
        let reader = exr::block::read(BufReader::new(file), false).map_err(failed)?;
        let headers = reader.headers().to_vec();
        let (width, height) = (self.film.width as usize, self.film.height as usize);
        let mut planes = vec![vec![outside; width * height]; wanted.len()];
        let chunks = reader.filter_chunks(false, |_, tile, block| {
            tile.level_index == Vec2(0, 0) && wanted.iter().any(|w| w[0] == block.layer)
        });
        let mut blocks = chunks.map_err(failed)?.sequential_decompressor(false);
        while let Some(block) = blocks.decompress_next_block() {
            let block = block.map_err(failed)?;
            let Some(header) = headers.get(block.index.layer) else { continue };
            let display = header.shared_attributes.display_window.position;
            let origin = header.own_attributes.layer_position;
            for line in block.lines(&header.channels) {
                let at = line.location;
                let y = at.position.1 as i64 + i64::from(origin.1) - i64::from(display.1);
                if y < 0 || y >= height as i64 {
                    continue;
                }
                let left = at.position.0 as i64 + i64::from(origin.0) - i64::from(display.0);
                for (plane, _) in planes.iter_mut().zip(wanted).filter(|(_, w)| **w == [at.layer, at.channel]) {
                    let row = &mut plane[y as usize * width..][..width];
                    let mut put = |k: usize, value: f32| {
                        if let Some(pixel) = usize::try_from(left + k as i64).ok().and_then(|x| row.get_mut(x)) {
                            *pixel = value;
                        }
                    };
                    match header.channels.list.get(at.channel).map(|c| c.sample_type) {
                        Some(SampleType::F32) => {
                            for (k, value) in line.read_samples::<f32>().enumerate() {
                                put(k, value.map_err(failed)?);
                            }
                        }
                        Some(SampleType::F16) => {
                            for (k, value) in line.read_samples::<f16>().enumerate() {
                                put(k, value.map_err(failed)?.to_f32());
                            }
                        }
                        Some(SampleType::U32) => {
                            for (k, value) in line.read_samples::<u32>().enumerate() {
                                put(k, value.map_err(failed)? as f32);
                            }
                        }
                        None => {}
                    }
                }
            }
        }
        Ok(planes)
    }
}
