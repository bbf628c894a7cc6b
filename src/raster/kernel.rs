//! The two hot loops.

use super::bins::{self, Bins};
use super::fill::{self, Band};
use super::view::View;
use crate::scene::Triangle;

/// [`bins::set_up_chunk`].
pub(super) fn set_up_chunk(view: &View, first: u32, triangles: &[Triangle], keep: &impl Fn(u32) -> bool) -> Bins {
    bins::set_up_chunk(view, first, triangles, keep)
}

/// Draws what every chunk has listed for a band.
pub(super) fn fill_band(view: &View, band: usize, depth: &mut [f32], chunks: &[Bins]) {
    let rows = depth.len() as i32 / view.width as i32;
    let mut target = Band { depth, width: view.width as i32, y: band as i32 * view.bands.rows as i32, rows };
    for chunk in chunks {
        for &i in chunk.tall.iter().chain(chunk.band(band)) {
            fill::fill(&mut target, &chunk.setups[i as usize]);
        }
    }
}
