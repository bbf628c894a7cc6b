//! A chunk of triangles, set up and listed by the bands they touch.

use super::clip;
use super::setup::{Lanes, Setup};
use super::view::{View, divided};
use crate::scene::Triangle;

/// Triangles set up at once: loops long enough to be vectorised, arrays that stay in the first-level cache.
const LANES: usize = 64;

/// Bands above which a triangle is not listed per band but looked at by all: bounds the lists.
const BANDS_LISTED_MAX: u32 = 16;

/// A chunk's set-up triangles by band.
#[derive(Debug, Default)]
pub(super) struct Bins {
    /// Triangles ready to be filled.
    pub(super) setups: Vec<Setup>,
    /// Indices into `setups`, band after band.
    entries: Vec<u32>,
    /// Start of each band's entries; one more than there are bands.
    starts: Vec<u32>,
    /// Indices into `setups` of triangles over more than [`BANDS_LISTED_MAX`] bands.
    pub(super) tall: Vec<u32>,
    /// Triangles that the caller kept.
    pub(super) kept: u32,
    /// Triangles of which something was set up.
    pub(super) drawn: u32,
}

impl Bins {
    /// Indices of the triangles listed for a band.
    #[inline(always)]
    pub(super) fn band(&self, band: usize) -> &[u32] {
        &self.entries[self.starts[band] as usize..self.starts[band + 1] as usize]
    }
}

/// Transforms, clips and sets up the triangles whose index (from `first`) is kept, and lists them by band in `bins`.
#[inline(always)]
pub(super) fn set_up_chunk(
    view: &View,
    first: u32,
    triangles: &[Triangle],
    keep: &impl Fn(u32) -> bool,
    bins: &mut Bins,
) {
    bins.setups.clear();
    bins.setups.reserve(triangles.len());
    let (mut kept, mut drawn) = (0, 0);
    let mut lanes = Lanes::<LANES>::new();
    let mut inside = [false; LANES];
    for (block, triangles) in triangles.chunks(LANES).enumerate() {
        project(view, triangles, &mut lanes, &mut inside);
        for i in 0..LANES {
            let wanted = i < triangles.len() && keep(first + (block * LANES + i) as u32);
            kept += u32::from(wanted);
            lanes.live[i] = wanted && inside[i];
            if wanted && !inside[i] {
                let projected = triangles[i].map(|v| view.project(f64::from(v.x), f64::from(v.y), f64::from(v.z)));
                drawn += u32::from(clip::clip(view, &projected, &mut bins.setups) > 0);
            }
        }
        lanes.derive_slopes();
        drawn += lanes.set_up(view, &mut bins.setups) as u32;
    }
    (bins.kept, bins.drawn) = (kept, drawn);
    list_by_band(view, bins);
}

/// Window positions of up to [`LANES`] triangles, and which lie inside the near and far planes and the guard band.
#[inline(always)]
fn project(view: &View, triangles: &[Triangle], lanes: &mut Lanes<LANES>, inside: &mut [bool; LANES]) {
    *inside = [true; LANES];
    for corner in 0..3 {
        let (mut x, mut y, mut z) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        for (i, triangle) in triangles.iter().enumerate() {
            let v = triangle[corner];
            (x[i], y[i], z[i]) = (f64::from(v.x), f64::from(v.y), f64::from(v.z));
        }
        for i in 0..LANES {
            let p = view.project(x[i], y[i], z[i]);
            inside[i] &= view.holds(p);
            [lanes.x[corner][i], lanes.y[corner][i], lanes.z[corner][i]] = divided(p);
        }
    }
}

/// A counting sort of references to the set-up triangles.
#[inline(always)]
pub(super) fn list_by_band(view: &View, bins: &mut Bins) {
    let span = |setup: &Setup| setup.y_texels.map(|y| u32::from(y) >> view.bands.rows_log2);
    let Bins { setups, entries, starts, tall, .. } = bins;
    tall.clear();
    starts.clear();
    starts.resize(view.bands.count as usize + 1, 0);
    for (i, setup) in setups.iter().enumerate() {
        let [first, last] = span(setup);
        if last - first >= BANDS_LISTED_MAX {
            tall.push(i as u32);
            continue;
        }
        for band in first..=last {
            starts[band as usize] += 1;
        }
    }
    let mut total = 0;
    for start in starts.iter_mut() {
        total += *start;
        *start = total;
    }
    entries.clear();
    entries.resize(total as usize, 0);
    // Filled from the end: afterwards each start is where its band begins.
    for (i, setup) in setups.iter().enumerate().rev() {
        let [first, last] = span(setup);
        if last - first >= BANDS_LISTED_MAX {
            continue;
        }
        for band in first..=last {
            let start = &mut starts[band as usize];
            *start -= 1;
            entries[*start as usize] = i as u32;
        }
    }
}
