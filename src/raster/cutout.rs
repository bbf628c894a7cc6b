//! Triangles with holes, drawn after all others: coverage and depth as theirs, but a texel is written only where the mask
//! says that the triangle is there at the texel's centre. Nearest depth wins, so the order does not matter.
//!
//! The centre's barycentric weights come from the vertices' homogeneous window positions p = (X, Y, w), unsnapped and before
//! clipping (Olano and Greer, *Triangle scan conversion using 2D homogeneous coordinates*, 1997): the point that is seen at
//! (x, y) is Σ λᵢ pᵢ ∝ (x, y, 1), so λ₀ ∝ (p₁ × p₂)·(x, y, 1), and so on. They are those of the surface, not of its
//! picture.

use glam::DVec3;
use rayon::prelude::*;

use super::bins::{self, Bins};
use super::fill::{Band, Spans, farther, nearer};
use super::setup::{Lanes, Setup};
use super::view::{View, divided};
use super::{BATCH_CHUNKS, CHUNK_TRIANGLES, Counts, clip};
use crate::scene::{Cutout, Geometry, Mask};

/// What every piece of a triangle needs.
struct Holes<'a> {
    cutout: Cutout,
    mask: &'a Mask,
    /// λᵢ is proportional to `weights[i]`·(x, y, 1), texels.
    weights: [DVec3; 3],
}

/// A chunk's set-up triangles by band, and the holes of each.
struct Chunk<'a> {
    bins: Bins,
    /// One a setup.
    holes: Vec<Holes<'a>>,
}

/// Draws the triangles with holes that are kept over what is drawn already.
pub(super) fn draw(
    view: &View,
    geometry: Geometry<'_>,
    keep: impl Fn(u32) -> bool + Sync,
    depth: &mut [f32],
) -> Counts {
    let kept: Vec<u32> = geometry.cut().filter(|&index| keep(index)).collect();
    let mut drawn = 0;
    for batch in kept.chunks(CHUNK_TRIANGLES * BATCH_CHUNKS) {
        let chunks: Vec<Chunk> = batch.par_chunks(CHUNK_TRIANGLES).map(|part| set_up(view, geometry, part)).collect();
        drawn += chunks.iter().map(|chunk| u64::from(chunk.bins.drawn)).sum::<u64>();
        let rows = 1 << view.bands.rows_log2;
        depth.par_chunks_mut(view.width as usize * rows).enumerate().for_each(|(number, depth)| {
            let rows = depth.len() as i32 / view.width as i32;
            let y = (number as i32) << view.bands.rows_log2;
            let mut band = Band { depth, width: view.width as i32, y, rows };
            for chunk in &chunks {
                for &i in chunk.bins.tall.iter().chain(chunk.bins.band(number)) {
                    fill(&mut band, &chunk.bins.setups[i as usize], &chunk.holes[i as usize]);
                }
            }
        });
    }
    Counts { kept: kept.len() as u64, drawn }
}

fn set_up<'a>(view: &View, geometry: Geometry<'a>, triangles: &[u32]) -> Chunk<'a> {
    let mut chunk = Chunk { bins: Bins::default(), holes: Vec::new() };
    let mut lane = Lanes::<1>::new();
    for &index in triangles {
        let Some((cutout, mask)) = geometry.cutout(index) else { continue };
        let projected = geometry.triangle_f64(index).map(|v| view.project(v.x, v.y, v.z));
        let setups = &mut chunk.bins.setups;
        let pieces = if projected.iter().all(|p| view.holds(*p)) {
            for (corner, &p) in projected.iter().enumerate() {
                [lane.x[corner][0], lane.y[corner][0], lane.z[corner][0]] = divided(p);
            }
            lane.live = [true];
            lane.derive_slopes();
            lane.set_up(view, setups)
        } else {
            clip::clip(view, &projected, setups)
        };
        chunk.bins.drawn += u32::from(pieces > 0);
        let [a, b, c] = projected.map(|[x, y, _, w]| DVec3::new(x, y, w));
        let weights = [b.cross(c), c.cross(a), a.cross(b)];
        chunk.holes.extend((0..pieces).map(|_| Holes { cutout, mask, weights }));
    }
    bins::list_by_band(view, &mut chunk.bins);
    chunk
}

/// Draws the part of a triangle that lies in the band.
fn fill(band: &mut Band, setup: &Setup, holes: &Holes) {
    let Some(spans) = Spans::new(band, setup) else { return };
    let [least, most] = setup.z_range;
    for y in spans.rows() {
        let row = (y - band.y) as usize * band.width as usize;
        for x in spans.row(y) {
            let texel = &mut band.depth[row + x as usize];
            let depth = nearer(farther(setup.depth_at(x, y) as f32, least), most);
            if depth < *texel && holes.is_solid(x, y) {
                *texel = nearer(depth, *texel);
            }
        }
    }
}

impl Holes<'_> {
    /// Whether the triangle is there at the centre of a texel.
    fn is_solid(&self, x: i32, y: i32) -> bool {
        let centre = DVec3::new(f64::from(x) + 0.5, f64::from(y) + 0.5, 1.0);
        let weights = DVec3::from_array(self.weights.map(|w| w.dot(centre)));
        self.mask.is_solid(&self.cutout, weights / weights.element_sum())
    }
}
