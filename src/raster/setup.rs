//! One triangle in window space → what filling needs: snapped vertices, bounding box, depth plane with bias.

use super::view::View;

/// Subtexels per texel: OpenGL asks for at least 4 bits, GPUs have 8.
pub(super) const SUBTEXELS: i32 = 256;

/// Adding this to an f64 of magnitude below 2^31 leaves the nearest integer in the low 32 bits (1.5 * 2^52: the unit in
/// the last place is 1). Rounds ties to even, without a call to `floor` on machines that have no instruction for it.
const ROUND: f64 = 6_755_399_441_055_744.0;

/// A vertex after the division by w.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vertex {
    /// Texels from the left.
    pub(super) x: f64,
    /// Texels from the bottom.
    pub(super) y: f64,
    /// Window depth.
    pub(super) z: f64,
}

impl Vertex {
    /// Divides a homogeneous window position by its w.
    #[inline(always)]
    pub(super) fn from_homogeneous([x, y, z, w]: [f64; 4]) -> Self {
        let inverse = 1.0 / w;
        Self { x: x * inverse, y: y * inverse, z: z * inverse }
    }

    /// True when the division went well.
    pub(super) fn is_finite(self) -> bool {
        self.x.is_finite() && self.y.is_finite() && self.z.is_finite()
    }
}

/// Slope of window depth, per texel along x and y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Slope {
    /// ∂z/∂x.
    pub(super) u: f64,
    /// ∂z/∂y.
    pub(super) v: f64,
}

impl Slope {
    /// From three vertices; not finite for a triangle without area.
    #[inline(always)]
    pub(super) fn of([a, b, c]: &[Vertex; 3]) -> Self {
        let (x1, y1, z1) = (b.x - a.x, b.y - a.y, b.z - a.z);
        let (x2, y2, z2) = (c.x - a.x, c.y - a.y, c.z - a.z);
        let inverse = 1.0 / (x1 * y2 - x2 * y1);
        Self { u: (z1 * y2 - z2 * y1) * inverse, v: (z2 * x1 - z1 * x2) * inverse }
    }
}

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
    /// Sets a triangle up; `None` when its box holds no texel centre of the map or its snapped vertices no area.
    ///
    /// `slope` is the plane's when the caller knows it better than the vertices do (pieces of a clipped triangle).
    #[inline(always)]
    pub(super) fn new(view: &View, vertices: &[Vertex; 3], slope: Option<Slope>) -> Option<Self> {
        let [a, b, c] = vertices;
        let snap = |t: f64| (t * f64::from(SUBTEXELS) + ROUND).to_bits() as i32;
        let mut x = [snap(a.x), snap(b.x), snap(c.x)];
        let mut y = [snap(a.y), snap(b.y), snap(c.y)];
        // A texel's centre is half a texel above its corner: ceil((min - 128) / 256), floor((max - 128) / 256).
        let half = SUBTEXELS / 2;
        let first = |t: [i32; 3]| ((t[0].min(t[1]).min(t[2]) + (half - 1)) >> SUBTEXELS.trailing_zeros()).max(0);
        let last = |t: [i32; 3], size: u32| {
            ((t[0].max(t[1]).max(t[2]) - half) >> SUBTEXELS.trailing_zeros()).min(size as i32 - 1)
        };
        let (x0, x1) = (first(x), last(x, view.width));
        let (y0, y1) = (first(y), last(y, view.height));
        if x0 > x1 || y0 > y1 {
            return None;
        }
        let wide = i64::from;
        let area = (wide(x[1]) - wide(x[0])) * (wide(y[2]) - wide(y[0]))
            - (wide(x[2]) - wide(x[0])) * (wide(y[1]) - wide(y[0]));
        if area == 0 {
            return None;
        }
        if area < 0 {
            x.swap(1, 2);
            y.swap(1, 2);
        }

        let (z_least, z_most) = (a.z.min(b.z).min(c.z), a.z.max(b.z).max(c.z));
        let slope = slope.unwrap_or_else(|| Slope::of(vertices));
        let steepest = slope.u.abs().max(slope.v.abs());
        let offset = (view.bias.slope * steepest).min(view.bias.clamp);
        let (slope, z, bias) = if steepest.is_finite() && offset.is_finite() {
            let z = a.z + slope.u * (f64::from(x0) + 0.5 - a.x) + slope.v * (f64::from(y0) + 0.5 - a.y);
            (slope, z, view.bias.constant + offset)
        } else {
            // No area before snapping, some after: a filler between neighbours. Its farthest depth cannot hang a false
            // shadow in front of them.
            (Slope { u: 0.0, v: 0.0 }, z_most, view.bias.constant)
        };
        let stored = |z: f64| (z + bias).clamp(0.0, 1.0) as f32;
        Some(Self {
            x,
            y,
            x_texels: [x0 as u16, x1 as u16],
            y_texels: [y0 as u16, y1 as u16],
            z: z + bias,
            z_u: slope.u,
            z_v: slope.v,
            z_range: [stored(z_least), stored(z_most)],
        })
    }
}
