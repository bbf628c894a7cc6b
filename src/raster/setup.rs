//! Triangles in window space → what filling needs: snapped vertices, bounding box, depth plane with bias.
//!
//! Many triangles at once, one array per quantity ([`Lanes`]), in loops without branches that compilers turn into SIMD.

use super::view::View;

/// Subtexels per texel: OpenGL asks for at least 4 bits, GPUs have 8.
pub(super) const SUBTEXELS: i32 = 256;

/// Adding this to an f64 of magnitude below 2^31 leaves the nearest integer in the low 32 bits (1.5 * 2^52: the unit in
/// the last place is 1). Rounds ties to even, without a call to `round` on machines that have no instruction for it.
const ROUND: f64 = 6_755_399_441_055_744.0;

/// A triangle ready to be filled: one cache line.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct Setup {
    /// Snapped vertices, subtexels, counter-clockwise (y up).
    pub(super) x: [i32; 3],
    /// As `x`.
    pub(super) y: [i32; 3],
    /// First and last texel whose centre is in the bounding box, within the map.
    pub(super) x_texels: [u16; 2],
    /// As `x_texels`, rows.
    pub(super) y_texels: [u16; 2],
    /// Window depth, bias included, at the centre of texel (`x_texels[0]`, `y_texels[0]`).
    pub(super) z: f64,
    /// ∂z/∂x per texel.
    pub(super) z_u: f64,
    /// ∂z/∂y per texel.
    pub(super) z_v: f64,
    /// Least and greatest depth of the triangle, bias included, within [0, 1].
    pub(super) z_range: [f32; 2],
}

impl Setup {
    /// The depth plane at the centre of a texel of the box.
    #[inline(always)]
    pub(super) fn depth_at(&self, x: i32, y: i32) -> f64 {
        let z = self.z + self.z_v * f64::from(y - i32::from(self.y_texels[0]));
        z + self.z_u * f64::from(x - i32::from(self.x_texels[0]))
    }
}

/// Up to `N` triangles in window space: `x[corner][triangle]` and so on. Lanes not in use hold anything.
pub(super) struct Lanes<const N: usize> {
    /// Texels from the left.
    pub(super) x: [[f64; N]; 3],
    /// Texels from the bottom.
    pub(super) y: [[f64; N]; 3],
    /// Window depth.
    pub(super) z: [[f64; N]; 3],
    /// Slope of the depth plane, per texel; not finite for a triangle without area.
    pub(super) z_u: [f64; N],
    /// As `z_u`.
    pub(super) z_v: [f64; N],
    /// True for triangles to be set up.
    pub(super) live: [bool; N],
}

impl<const N: usize> Lanes<N> {
    /// No triangle.
    pub(super) fn new() -> Self {
        Self { x: [[0.0; N]; 3], y: [[0.0; N]; 3], z: [[0.0; N]; 3], z_u: [0.0; N], z_v: [0.0; N], live: [false; N] }
    }

    /// Derives the slopes from the vertices.
    #[inline(always)]
    pub(super) fn derive_slopes(&mut self) {
        let Self { x, y, z, z_u, z_v, .. } = self;
        for i in 0..N {
            let (x1, y1, z1) = (x[1][i] - x[0][i], y[1][i] - y[0][i], z[1][i] - z[0][i]);
            let (x2, y2, z2) = (x[2][i] - x[0][i], y[2][i] - y[0][i], z[2][i] - z[0][i]);
            let inverse = 1.0 / (x1 * y2 - x2 * y1);
            z_u[i] = (z1 * y2 - z2 * y1) * inverse;
            z_v[i] = (z2 * x1 - z1 * x2) * inverse;
        }
    }

    /// Sets the live triangles up, but for those whose box holds no texel centre of the map or whose snapped vertices
    /// no area; returns how many there were.
    #[inline(always)]
    pub(super) fn set_up(&self, view: &View, setups: &mut Vec<Setup>) -> usize {
        let snapped = Snapped::of(self, view);
        let planes = Planes::of(self, view, &snapped);
        let before = setups.len();
        for i in 0..N {
            if self.live[i] && snapped.covering[i] {
                // Counter-clockwise, y up.
                let [a, b, c] = if snapped.area[i] > 0.0 { [0, 1, 2] } else { [0, 2, 1] };
                let (x, y) = (&snapped.x, &snapped.y);
                setups.push(Setup {
                    x: [x[a][i], x[b][i], x[c][i]],
                    y: [y[a][i], y[b][i], y[c][i]],
                    x_texels: [snapped.x_first[i] as u16, snapped.x_last[i] as u16],
                    y_texels: [snapped.y_first[i] as u16, snapped.y_last[i] as u16],
                    z: planes.z[i],
                    z_u: planes.z_u[i],
                    z_v: planes.z_v[i],
                    z_range: [planes.z_least[i], planes.z_most[i]],
                });
            }
        }
        setups.len() - before
    }
}

/// Vertices on the subtexel grid and the texels they can cover.
struct Snapped<const N: usize> {
    /// Subtexels.
    x: [[i32; N]; 3],
    /// Subtexels.
    y: [[i32; N]; 3],
    /// First column whose centre is in the bounding box, within the map.
    x_first: [i32; N],
    /// Last such column.
    x_last: [i32; N],
    /// First such row.
    y_first: [i32; N],
    /// Last such row.
    y_last: [i32; N],
    /// Twice the signed area, subtexels². Exact: within the guard band, each product stays below 2^52.
    area: [f64; N],
    /// True with an area and a texel centre in the bounding box.
    covering: [bool; N],
}

impl<const N: usize> Snapped<N> {
    #[inline(always)]
    fn of(lanes: &Lanes<N>, view: &View) -> Self {
        let mut s = Self {
            x: [[0; N]; 3],
            y: [[0; N]; 3],
            x_first: [0; N],
            x_last: [0; N],
            y_first: [0; N],
            y_last: [0; N],
            area: [0.0; N],
            covering: [false; N],
        };
        let snap = |t: f64| t * f64::from(SUBTEXELS) + ROUND;
        for i in 0..N {
            let x = [snap(lanes.x[0][i]), snap(lanes.x[1][i]), snap(lanes.x[2][i])];
            let y = [snap(lanes.y[0][i]), snap(lanes.y[1][i]), snap(lanes.y[2][i])];
            s.area[i] = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
            for corner in 0..3 {
                s.x[corner][i] = x[corner].to_bits() as i32;
                s.y[corner][i] = y[corner].to_bits() as i32;
            }
        }
        let [width, height] = [view.width as i32, view.height as i32];
        for i in 0..N {
            (s.x_first[i], s.x_last[i]) = centres([s.x[0][i], s.x[1][i], s.x[2][i]], width);
            (s.y_first[i], s.y_last[i]) = centres([s.y[0][i], s.y[1][i], s.y[2][i]], height);
            s.covering[i] = (s.x_first[i] <= s.x_last[i]) & (s.y_first[i] <= s.y_last[i]) & (s.area[i] != 0.0);
        }
        s
    }
}

/// First and last texel whose centre, half a texel above its corner, lies between three coordinates; within `0..size`.
#[inline(always)]
fn centres(t: [i32; 3], size: i32) -> (i32, i32) {
    let (shift, half) = (SUBTEXELS.trailing_zeros(), SUBTEXELS / 2);
    let least = t[0].min(t[1]).min(t[2]);
    let most = t[0].max(t[1]).max(t[2]);
    // ceil((least - 128) / 256) and floor((most - 128) / 256); wrapping for lanes that are not in use.
    let first = least.wrapping_add(half - 1) >> shift;
    let last = most.wrapping_sub(half) >> shift;
    (first.max(0), last.min(size - 1))
}

/// Depth planes with their bias.
struct Planes<const N: usize> {
    /// As in [`Setup`].
    z: [f64; N],
    z_u: [f64; N],
    z_v: [f64; N],
    z_least: [f32; N],
    z_most: [f32; N],
}

impl<const N: usize> Planes<N> {
    #[inline(always)]
    fn of(lanes: &Lanes<N>, view: &View, snapped: &Snapped<N>) -> Self {
        let mut p = Self { z: [0.0; N], z_u: [0.0; N], z_v: [0.0; N], z_least: [0.0; N], z_most: [0.0; N] };
        let bias = view.bias;
        for i in 0..N {
            let (z_u, z_v) = (lanes.z_u[i], lanes.z_v[i]);
            let steepest = greater(z_u.abs(), z_v.abs());
            let offset = lesser(bias.slope * steepest, bias.clamp);
            // Without area before snapping but with some after, a triangle is a filler between neighbours: it becomes
            // level, at its farthest depth, which cannot hang a false shadow in front of them.
            let sound = (z_u.abs() < f64::INFINITY) & (z_v.abs() < f64::INFINITY) & (offset.abs() < f64::INFINITY);
            let z = [lanes.z[0][i], lanes.z[1][i], lanes.z[2][i]];
            let (least, most) = (lesser(lesser(z[0], z[1]), z[2]), greater(greater(z[0], z[1]), z[2]));
            let dx = f64::from(snapped.x_first[i]) + 0.5 - lanes.x[0][i];
            let dy = f64::from(snapped.y_first[i]) + 0.5 - lanes.y[0][i];
            let added = bias.constant + if sound { offset } else { 0.0 };
            p.z[i] = if sound { (z[0] + (z_u * dx + z_v * dy)) + added } else { most + added };
            p.z_u[i] = if sound { z_u } else { 0.0 };
            p.z_v[i] = if sound { z_v } else { 0.0 };
            p.z_least[i] = lesser(greater(least + added, 0.0), 1.0) as f32;
            p.z_most[i] = lesser(greater(most + added, 0.0), 1.0) as f32;
        }
        p
    }
}

/// One instruction, where `f64::min` also has to look for NaN.
#[inline(always)]
fn lesser(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// As [`lesser`].
#[inline(always)]
fn greater(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}
