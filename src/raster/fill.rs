//! Set-up triangles → texels of one band.
//!
//! An edge from a to b holds a point p when E(p) = (b - a) x (p - a) ≥ 0, or > 0 unless the edge is a top or left one
//! (y up, counter-clockwise: it runs left, or down). Small triangles test [`LANES`] texels at a time with i32 edge
//! functions; others get each row's exact span by integer division in i64.

use super::setup::{SUBTEXELS, Setup};
use std::ops::{Range, RangeInclusive};

/// Texels tested at once: one 256-bit register of f32 or i32.
const LANES: usize = 8;

/// Widest box tested texel by texel; wider triangles waste fewer texels when filled by spans.
const TESTED_WIDTH_MAX: i32 = 16;

/// Longest side of a triangle whose edge functions fit i32, subtexels: two products of at most 2^14 by
/// 2^14 + 24 texels' worth each stay below 2^30.
const EXTENT_I32_MAX: i32 = 1 << 14;

/// The rows that one thread owns.
pub(super) struct Band<'a> {
    /// Rows from `y` up, `width` texels each.
    pub(super) depth: &'a mut [f32],
    /// Texels.
    pub(super) width: i32,
    /// First row.
    pub(super) y: i32,
    /// Number of rows.
    pub(super) rows: i32,
}

/// Draws the part of a triangle that lies in the band.
#[inline(always)]
pub(super) fn fill(band: &mut Band, setup: &Setup) {
    let [x0, x1] = setup.x_texels.map(i32::from);
    let y0 = i32::from(setup.y_texels[0]).max(band.y);
    let y1 = i32::from(setup.y_texels[1]).min(band.y + band.rows - 1);
    if y0 > y1 {
        return;
    }
    let extent = |t: &[i32; 3]| t[0].max(t[1]).max(t[2]) - t[0].min(t[1]).min(t[2]);
    let small = x1 - x0 < TESTED_WIDTH_MAX
        && band.width >= LANES as i32
        && extent(&setup.x) <= EXTENT_I32_MAX
        && extent(&setup.y) <= EXTENT_I32_MAX;
    if small { fill_tested(band, setup, y0, y1) } else { fill_spans(band, setup) }
}

/// The edge function's offset that leaves the points of edges that are not top or left outside.
#[inline(always)]
fn tie(dx: i32, dy: i32) -> i32 {
    if dy < 0 || (dy == 0 && dx < 0) { 0 } else { -1 }
}

/// Tests blocks of [`LANES`] texels.
#[inline(always)]
fn fill_tested(band: &mut Band, setup: &Setup, y0: i32, y1: i32) {
    let [x0, x1] = setup.x_texels.map(i32::from);
    let mut x = x0;
    while x <= x1 {
        // At the right border the block moves left: texels outside the triangle fail the test.
        let block = x.min(band.width - LANES as i32);
        fill_block(band, setup, block, y0, y1);
        x = block + LANES as i32;
    }
}

/// Tests the texels of [`LANES`] columns from `block`.
#[inline(always)]
fn fill_block(band: &mut Band, setup: &Setup, block: i32, y0: i32, y1: i32) {
    let half = SUBTEXELS / 2;
    let mut edges = [[0_i32; LANES]; 3];
    let mut rise = [0_i32; 3];
    for i in 0..3 {
        let j = (i + 1) % 3;
        let (dx, dy) = (setup.x[j] - setup.x[i], setup.y[j] - setup.y[i]);
        let e = dx * (y0 * SUBTEXELS + half - setup.y[i]) - dy * (block * SUBTEXELS + half - setup.x[i]) + tie(dx, dy);
        for (lane, edge) in edges[i].iter_mut().enumerate() {
            *edge = e - dy * SUBTEXELS * lane as i32;
        }
        rise[i] = dx * SUBTEXELS;
    }
    let column = block - i32::from(setup.x_texels[0]);
    let mut across = [0.0_f64; LANES];
    for (lane, a) in across.iter_mut().enumerate() {
        *a = setup.z_u * f64::from(column + lane as i32);
    }
    let [least, most] = setup.z_range;
    for y in y0..=y1 {
        let start = (y - band.y) as usize * band.width as usize + block as usize;
        let z = setup.z + setup.z_v * f64::from(y - i32::from(setup.y_texels[0]));
        if let Some(texels) = band.depth[start..].first_chunk_mut::<LANES>() {
            for lane in 0..LANES {
                let inside = edges[0][lane] | edges[1][lane] | edges[2][lane];
                let depth = nearer(farther((z + across[lane]) as f32, least), most);
                let depth = if inside >= 0 { depth } else { f32::INFINITY };
                texels[lane] = nearer(depth, texels[lane]);
            }
        }
        for (edge, rise) in edges.iter_mut().zip(rise) {
            for lane in edge {
                *lane = lane.wrapping_add(rise);
            }
        }
    }
}

/// Fills each row from its first to its last covered texel.
#[inline(always)]
fn fill_spans(band: &mut Band, setup: &Setup) {
    let Some(spans) = Spans::new(band, setup) else { return };
    let [least, most] = setup.z_range;
    let x_first = i32::from(setup.x_texels[0]);
    for y in spans.rows() {
        let row = spans.row(y);
        if row.is_empty() {
            continue;
        }
        let z = setup.z + setup.z_v * f64::from(y - i32::from(setup.y_texels[0]));
        let start = (y - band.y) as usize * band.width as usize;
        let texels = &mut band.depth[start + row.start as usize..start + row.end as usize];
        for (i, texel) in texels.iter_mut().enumerate() {
            let depth =
                nearer(farther((z + setup.z_u * f64::from(row.start - x_first + i as i32)) as f32, least), most);
            *texel = nearer(depth, *texel);
        }
    }
}

/// The texels of a band that a triangle covers, row by row.
pub(super) struct Spans {
    /// Of each edge: its function at the centre of the first texel, what a texel to the right takes and one up adds.
    edges: [(i64, i64, i64); 3],
    x: [i32; 2],
    y: [i32; 2],
}

impl Spans {
    /// `None` when the triangle's box and the band have no row in common.
    #[inline(always)]
    pub(super) fn new(band: &Band, setup: &Setup) -> Option<Spans> {
        let (half, step) = (i64::from(SUBTEXELS / 2), i64::from(SUBTEXELS));
        let x = setup.x_texels.map(i32::from);
        let y = [i32::from(setup.y_texels[0]).max(band.y), i32::from(setup.y_texels[1]).min(band.y + band.rows - 1)];
        if y[0] > y[1] {
            return None;
        }
        let edges = std::array::from_fn(|i| {
            let j = (i + 1) % 3;
            let (ax, ay) = (i64::from(setup.x[i]), i64::from(setup.y[i]));
            let (dx, dy) = (i64::from(setup.x[j]) - ax, i64::from(setup.y[j]) - ay);
            let e = dx * (i64::from(y[0]) * step + half - ay) - dy * (i64::from(x[0]) * step + half - ax)
                + i64::from(tie(setup.x[j] - setup.x[i], setup.y[j] - setup.y[i]));
            (e, dy * step, dx * step)
        });
        Some(Spans { edges, x, y })
    }

    /// Rows that may hold covered texels.
    #[inline(always)]
    pub(super) fn rows(&self) -> RangeInclusive<i32> {
        self.y[0]..=self.y[1]
    }

    /// Columns covered in a row.
    #[inline(always)]
    pub(super) fn row(&self, y: i32) -> Range<i32> {
        let (mut first, mut last) = (0, i64::from(self.x[1] - self.x[0]));
        for (e, fall, rise) in self.edges {
            let e = e + rise * i64::from(y - self.y[0]);
            if fall < 0 {
                // e - fall k ≥ 0 from k = ceil(e / fall) on.
                first = first.max(-e.div_euclid(-fall));
            } else if fall > 0 {
                last = last.min(e.div_euclid(fall));
            } else if e < 0 {
                last = -1;
            }
        }
        if first > last {
            return 0..0;
        }
        self.x[0] + first as i32..self.x[0] + last as i32 + 1
    }
}

/// The lesser; one instruction, where `f32::min` also has to look for NaN.
#[inline(always)]
pub(super) fn nearer(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The greater.
#[inline(always)]
pub(super) fn farther(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}
