//! What every triangle of a draw shares: the matrix to homogeneous window space, the map's size, the bias, the bands.
//!
//! Homogeneous window space is clip space after the viewport but before the division: (X, Y, Z, w) with X/w and Y/w in
//! texels from the bottom left corner and Z/w the window depth. Clipping is linear there too, and a vertex has one
//! window position whether its triangle was clipped or not: no cracks between the two.

use glam::{DMat4, DVec4};

use super::{Bias, RasterError, SIZE_MAX};

/// Texels beyond which triangles are clipped, on each side of the map. Snapped coordinates then stay within
/// (2^16 + 2^14) * 256 < 2^25 subtexels, and products of their differences below 2^52: exact in i64 and in f64.
pub(super) const GUARD_TEXELS: f64 = 65_536.0;

/// A band's memory, texels: 256 KiB of depth, so that a band is filled within a second-level cache.
const BAND_TEXELS: u32 = 65_536;

/// Binary logarithms of the fewest and most rows of a band: few enough bands that triangles rarely span many, enough to
/// share out.
const BAND_ROWS_LOG2: (u32, u32) = (3, 5);

/// A partition of the map into runs of rows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bands {
    /// Binary logarithm of the rows of each band; the last may have fewer rows.
    pub(super) rows_log2: u32,
    /// Number of bands.
    pub(super) count: u32,
}

/// What every triangle of a draw shares.
#[derive(Clone, Debug)]
pub(super) struct View {
    /// Columns of the matrix to homogeneous window space.
    pub(super) window_from_scene: [[f64; 4]; 4],
    /// Texels.
    pub(super) width: u32,
    /// Texels.
    pub(super) height: u32,
    /// Added to what is stored.
    pub(super) bias: Bias,
    /// Rows by owner.
    pub(super) bands: Bands,
}

impl View {
    /// Checks size, matrix and bias.
    pub(super) fn new(clip_from_scene: &DMat4, width: u32, height: u32, bias: Bias) -> Result<Self, RasterError> {
        let legal = 1..=SIZE_MAX;
        if !legal.contains(&width) || !legal.contains(&height) {
            return Err(RasterError::Size { width, height });
        }
        for (column, entries) in clip_from_scene.to_cols_array_2d().iter().enumerate() {
            for (row, &value) in entries.iter().enumerate() {
                if !value.is_finite() {
                    return Err(RasterError::Matrix { row, column, value });
                }
            }
        }
        if !bias.constant.is_finite() || !bias.slope.is_finite() || bias.clamp.is_nan() {
            return Err(RasterError::Bias { bias });
        }
        let (half_width, half_height) = (0.5 * f64::from(width), 0.5 * f64::from(height));
        let window_from_clip = DMat4::from_cols(
            DVec4::new(half_width, 0.0, 0.0, 0.0),
            DVec4::new(0.0, half_height, 0.0, 0.0),
            DVec4::new(0.0, 0.0, 0.5, 0.0),
            DVec4::new(half_width, half_height, 0.5, 1.0),
        );
        let rows_log2 = (BAND_TEXELS / width).ilog2().clamp(BAND_ROWS_LOG2.0, BAND_ROWS_LOG2.1);
        Ok(Self {
            window_from_scene: (window_from_clip * *clip_from_scene).to_cols_array_2d(),
            width,
            height,
            bias,
            bands: Bands { rows_log2, count: height.div_ceil(1 << rows_log2) },
        })
    }

    /// Homogeneous window position of a scene point.
    #[inline(always)]
    pub(super) fn project(&self, x: f64, y: f64, z: f64) -> [f64; 4] {
        let [c0, c1, c2, c3] = &self.window_from_scene;
        std::array::from_fn(|row| (c0[row] * x + c1[row] * y) + (c2[row] * z + c3[row]))
    }

    /// True for a homogeneous window position within all clip planes; never for NaN.
    #[inline(always)]
    pub(super) fn holds(&self, p: [f64; 4]) -> bool {
        let d = self.distances(p);
        (d[0] >= 0.0) & (d[1] >= 0.0) & (d[2] >= 0.0) & (d[3] >= 0.0) & (d[4] >= 0.0) & (d[5] >= 0.0) & (p[3] > 0.0)
    }

    /// Signed distances of a homogeneous window position to the clip planes, positive inside: near, far, and the guard
    /// band's left, right, bottom and top.
    #[inline(always)]
    pub(super) fn distances(&self, p: [f64; 4]) -> [f64; 6] {
        let [x, y, z, w] = p;
        let guard = GUARD_TEXELS * w;
        [
            z,
            w - z,
            x + guard,
            (f64::from(self.width) * w - x) + guard,
            y + guard,
            (f64::from(self.height) * w - y) + guard,
        ]
    }
}

/// Divides a homogeneous window position by its w: texels, texels, window depth.
#[inline(always)]
pub(super) fn divided([x, y, z, w]: [f64; 4]) -> [f64; 3] {
    let inverse = 1.0 / w;
    [x * inverse, y * inverse, z * inverse]
}
