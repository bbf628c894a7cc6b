//! The two hot loops, compiled twice: for any machine, and for AVX2 where the machine has it.
//!
//! Both are the same Rust, which never fuses a product with a sum, so both give the same bytes; AVX2 only runs more
//! lanes at once. Measured gain: see `benches/README.md`.

use super::bins::{self, Bins};
use super::fill::{self, Band};
use super::view::View;
use crate::scene::Triangle;

/// [`bins::set_up_chunk`] by the best instructions there are.
pub(super) fn set_up_chunk(view: &View, first: u32, triangles: &[Triangle], keep: &impl Fn(u32) -> bool) -> Bins {
    #[cfg(target_arch = "x86_64")]
    if is_x86_feature_detected!("avx2") {
        #[expect(unsafe_code, reason = "AVX2 was just detected, which is all that the callee asks for")]
        return unsafe { set_up_chunk_avx2(view, first, triangles, keep) };
    }
    bins::set_up_chunk(view, first, triangles, keep)
}

/// Draws what every chunk has listed for a band, by the best instructions there are.
pub(super) fn fill_band(view: &View, band: usize, depth: &mut [f32], chunks: &[Bins]) {
    #[cfg(target_arch = "x86_64")]
    if is_x86_feature_detected!("avx2") {
        #[expect(unsafe_code, reason = "AVX2 was just detected, which is all that the callee asks for")]
        return unsafe { fill_band_avx2(view, band, depth, chunks) };
    }
    fill_band_here(view, band, depth, chunks);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn set_up_chunk_avx2(view: &View, first: u32, triangles: &[Triangle], keep: &impl Fn(u32) -> bool) -> Bins {
    bins::set_up_chunk(view, first, triangles, keep)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn fill_band_avx2(view: &View, band: usize, depth: &mut [f32], chunks: &[Bins]) {
    fill_band_here(view, band, depth, chunks);
}

#[inline(always)]
fn fill_band_here(view: &View, band: usize, depth: &mut [f32], chunks: &[Bins]) {
    let rows = depth.len() as i32 / view.width as i32;
    let mut target = Band { depth, width: view.width as i32, y: (band as i32) << view.bands.rows_log2, rows };
    for chunk in chunks {
        for &i in chunk.tall.iter().chain(chunk.band(band)) {
            fill::fill(&mut target, &chunk.setups[i as usize]);
        }
    }
}
