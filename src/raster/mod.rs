//! Triangles and a light matrix → shadow-map depth, in software, by the rules a GPU follows.
//!
//! Rules, those of OpenGL with `DEPTH_COMPONENT32F` and no colour: triangles are clipped in homogeneous space against
//! -w ≤ z ≤ w, so that w > 0 remains; vertices are snapped to 1/256 texel and a texel is covered when its centre is
//! inside by exact integer edge functions, ties by the top-left rule, so that meshes neither crack nor draw a texel
//! twice (Pineda, *A Parallel Algorithm for Polygon Rasterization*, 1988). Both faces are drawn; the nearest depth wins.
//! Window depth is 0.5 z/w + 0.5. It is affine in window space even under a projective warp, because one matrix makes
//! x/w, y/w and z/w, so each triangle has one plane; it is evaluated in f64, and clamped to the triangle's own
//! depths, which tames slivers. Then the bias is added and the sum is rounded to f32.
//!
//! Instances are drawn run by run, their triangles placed on the spot; those whose box lies beside the map are passed over.
//! Triangles with holes are drawn after the others, texel by texel as their masks say (`cutout`).
//!
//! Deviation from hardware: the plane comes from the unsnapped vertices, so that depth does not jitter by 1/256 texel.
//!
//! The work is sort-middle: chunks of triangles are transformed and set up in parallel and binned by bands of rows
//! (`bins`), then each band is cleared and filled by one thread (`fill`). No texel is shared, and a minimum does not
//! ask for order: the same bytes for any number of threads.

mod bins;
mod clip;
mod cutout;
mod fill;
mod kernel;
mod setup;
mod view;

use glam::DMat4;
use rayon::prelude::*;

use crate::scene::{Geometry, Room};
use bins::Bins;
use serde::{Deserialize, Serialize};
use view::View;

/// Largest map width and height, texels: what GPUs offer; edge functions stay exact far beyond it.
pub const SIZE_MAX: u32 = 16384;

/// The depth of a texel that nothing was drawn to.
pub const FAR: f32 = 1.0;

/// Triangles set up by one task. Large enough that a chunk's lists cost nothing, small enough to share out and to stay in
/// a second-level cache.
const CHUNK_TRIANGLES: usize = 4096;

/// Triangles set up before their bands are filled: bounds the memory of set-up triangles to about 64 MiB.
const BATCH_CHUNKS: usize = 256;

/// A shadow map.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DepthMap {
    /// Texels.
    pub width: u32,
    /// Texels.
    pub height: u32,
    /// Window depth, row by row from the bottom, `width * height` values in [0, 1]; [`FAR`] where nothing was drawn.
    pub depth: Vec<f32>,
}

/// Depth added to what is stored: `constant + min(slope * max(|z_u|, |z_v|), clamp)`, as GL's polygon offset.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
pub struct Bias {
    /// Window depth.
    pub constant: f64,
    /// Factor on max(|z_u|, |z_v|), the plane's slope in window depth per texel.
    pub slope: f64,
    /// Largest slope term, window depth; infinity = none.
    pub clamp: f64,
}

impl Bias {
    /// Depth as it is.
    pub const NONE: Self = Self { constant: 0.0, slope: 0.0, clamp: f64::INFINITY };

    /// What it adds to the depth of a plane with slopes |z_u| and |z_v|, window depth.
    pub fn of(self, slopes: [f64; 2]) -> f64 {
        self.constant + (self.slope * slopes[0].max(slopes[1])).min(self.clamp)
    }
}

/// What drawing took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Triangles that the caller kept; of instances that lie beside the map none is asked for.
    pub kept: u64,
    /// Of those, triangles with a texel centre in the bounding box of what lies inside the clip volume.
    pub drawn: u64,
}

/// Why no map was drawn.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum RasterError {
    /// A side is zero or above [`SIZE_MAX`].
    #[error("a shadow map of {width} x {height} texels cannot be drawn: choose sides of 1 to {SIZE_MAX} texels")]
    Size {
        /// Texels.
        width: u32,
        /// Texels.
        height: u32,
    },
    /// The matrix has an entry that is NaN or infinite.
    #[error(
        "the light matrix has the value {value} in row {row}, column {column} (from 0): only finite matrices can be drawn"
    )]
    Matrix {
        /// From 0.
        row: usize,
        /// From 0.
        column: usize,
        /// The entry.
        value: f64,
    },
    /// The bias is NaN, or its constant or slope is infinite.
    #[error(
        "the depth bias {bias:?} cannot be applied: constant and slope must be finite, and clamp a number or infinity"
    )]
    Bias {
        /// As given.
        bias: Bias,
    },
}

/// Draws all triangles into a new map of `width` x `height` texels, seen through `clip_from_scene` (OpenGL clip space).
///
/// # Errors
/// [`RasterError`]: a size, matrix or bias that cannot be drawn.
pub fn draw(
    geometry: Geometry,
    clip_from_scene: &DMat4,
    width: u32,
    height: u32,
    bias: Bias,
) -> Result<DepthMap, RasterError> {
    let mut canvas = Canvas::default();
    canvas.draw(geometry, clip_from_scene, width, height, bias, |_| true)?;
    Ok(canvas.map)
}

/// A map, and the memory it took to draw it, for drawing many maps one after the other: the system hands out fresh memory
/// about as slowly as triangles are drawn to it.
#[derive(Debug, Default)]
pub struct Canvas {
    /// What was drawn last; 0 x 0 at first.
    pub map: DepthMap,
    /// One for each chunk of a batch.
    bins: Vec<Bins>,
}

impl Canvas {
    /// Draws the triangles whose index `keep` accepts, as [`draw`] does, into [`Canvas::map`].
    ///
    /// # Errors
    /// [`RasterError`]: a size, matrix or bias that cannot be drawn; the map is then as it was.
    pub fn draw(
        &mut self,
        geometry: Geometry,
        clip_from_scene: &DMat4,
        width: u32,
        height: u32,
        bias: Bias,
        keep: impl Fn(u32) -> bool + Sync,
    ) -> Result<Counts, RasterError> {
        let view = View::new(clip_from_scene, width, height, bias)?;
        let texels = width as usize * height as usize;
        if self.map.depth.capacity() < texels {
            // Zeroed memory is handed out untouched, so that the threads that clear it touch it first.
            self.map.depth = vec![0.0; texels];
        }
        self.map.depth.resize(texels, FAR);
        (self.map.width, self.map.height) = (width, height);

        let any_cut = geometry.cut().next().is_some();
        let whole = |index: u32| keep(index) && !(any_cut && geometry.cutout(index).is_some());
        let chunks = geometry.runs(CHUNK_TRIANGLES);
        if chunks.is_empty() {
            self.map.depth.fill(FAR);
        }
        let mut counts = Counts::default();
        for (number, batch) in chunks.chunks(BATCH_CHUNKS).enumerate() {
            if self.bins.len() < batch.len() {
                self.bins.resize_with(batch.len(), Bins::default);
            }
            let bins = &mut self.bins[..batch.len()];
            batch.par_iter().zip(bins.par_iter_mut()).for_each_init(Room::default, |room, (run, bins)| {
                let beside = run.instance_bounds().is_some_and(|corners| clip::box_is_outside(&view, corners));
                let triangles = if beside { &[] } else { run.triangles(room) };
                kernel::set_up_chunk(&view, run.first, triangles, &whole, bins);
            });
            let band_texels = (width as usize) << view.bands.rows_log2;
            self.map.depth.par_chunks_mut(band_texels).enumerate().for_each(|(band, depth)| {
                if number == 0 {
                    depth.fill(FAR);
                }
                kernel::fill_band(&view, band, depth, bins);
            });
            counts.kept += bins.iter().map(|b| u64::from(b.kept)).sum::<u64>();
            counts.drawn += bins.iter().map(|b| u64::from(b.drawn)).sum::<u64>();
        }
        let cut = cutout::draw(&view, geometry, &keep, &mut self.map.depth);
        counts.kept += cut.kept;
        counts.drawn += cut.drawn;
        Ok(counts)
    }
}
