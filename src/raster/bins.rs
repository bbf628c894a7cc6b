//! A chunk of triangles, set up and listed by the bands they touch.

use super::clip;
use super::setup::{Setup, Vertex};
use super::view::View;
use crate::scene::Triangle;

/// Bands above which a triangle is not listed per band but looked at by all: bounds the lists.
const BANDS_LISTED_MAX: u32 = 16;

/// A chunk's set-up triangles by band.
#[derive(Debug)]
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

/// Transforms, clips and sets up the triangles whose index (from `first`) is kept, and lists them by band.
#[inline(always)]
pub(super) fn set_up_chunk(view: &View, first: u32, triangles: &[Triangle], keep: &impl Fn(u32) -> bool) -> Bins {
    let mut setups: Vec<Setup> = Vec::with_capacity(triangles.len());
    let (mut kept, mut drawn) = (0, 0);
    for (i, triangle) in triangles.iter().enumerate() {
        if !keep(first + i as u32) {
            continue;
        }
        kept += 1;
        let before = setups.len();
        let projected = triangle.map(|v| view.project(v));
        // Written so that NaN is not inside.
        let inside = projected.iter().all(|&p| view.distances(p).iter().all(|&d| d >= 0.0) && p[3] > 0.0);
        if inside {
            setups.extend(Setup::new(view, &projected.map(Vertex::from_homogeneous), None));
        } else {
            clip::clip(view, &projected, |setup| setups.push(setup));
        }
        drawn += u32::from(setups.len() > before);
    }
    list_by_band(view, setups, kept, drawn)
}

/// A counting sort of references to the set-up triangles.
#[inline(always)]
fn list_by_band(view: &View, setups: Vec<Setup>, kept: u32, drawn: u32) -> Bins {
    let span = |setup: &Setup| {
        (u32::from(setup.y_texels[0]) / view.bands.rows, u32::from(setup.y_texels[1]) / view.bands.rows)
    };
    let mut tall = Vec::new();
    let mut starts = vec![0_u32; view.bands.count as usize + 1];
    for (i, setup) in setups.iter().enumerate() {
        let (first, last) = span(setup);
        if last - first >= BANDS_LISTED_MAX {
            tall.push(i as u32);
            continue;
        }
        for band in first..=last {
            starts[band as usize] += 1;
        }
    }
    let mut total = 0;
    for start in &mut starts {
        total += *start;
        *start = total;
    }
    // Filled from the end: afterwards each start is where its band begins.
    let mut entries = vec![0; total as usize];
    for (i, setup) in setups.iter().enumerate().rev() {
        let (first, last) = span(setup);
        if last - first >= BANDS_LISTED_MAX {
            continue;
        }
        for band in first..=last {
            let start = &mut starts[band as usize];
            *start -= 1;
            entries[*start as usize] = i as u32;
        }
    }
    Bins { setups, entries, starts, tall, kept, drawn }
}
