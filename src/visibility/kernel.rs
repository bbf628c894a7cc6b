//! One ray against the eight-wide tree.
//!
//! Boxes by slabs; triangles by the watertight test of Woop, Benthin and Wald 2013 ("Watertight ray/triangle
//! intersection", JCGT 2(1)), eight at once, with its fallback to f64 where an edge function rounds to zero. So no ray
//! slips between two triangles that share an edge. Deviations: both sides count; the ray's parameter is the distance
//! along its dominant axis, which makes the shear's scale ±1; and there is no fused multiply-add, which would give other
//! answers on other machines and spoil the sign of the edge functions.
//!
//! Rounding, in units of u = 2⁻²⁴, for vertices in [-1, 1] and origins in [-2, 2] on every axis: vertex minus origin 2,
//! shear 8, weighted depth 12, slab 9. The boxes are grown by twice the sum (`wide::BOX_MARGIN`), so a triangle that is
//! called hit lies behind boxes that are called hit, and the slab test needs no factor of its own.

use glam::{DVec3, Vec3};

use super::lanes::Lanes;
use super::ray::Ray;
use super::wide::{Leaf, Node, WIDTH};

/// The ray in lanes.
pub(super) struct Spread<L> {
    origin: [L; 3],
    /// By `Ray::axes`.
    permuted: [L; 3],
    inverse: [L; 3],
    shear: [L; 2],
    sign: L,
    t_min: L,
}

// No closures here: a closure is a function of its own, which would be compiled without AVX2.
impl<L: Lanes> Spread<L> {
    #[inline(always)]
    pub(super) fn new(ray: &Ray) -> Self {
        let [ox, oy, oz] = ray.origin;
        let [ix, iy, iz] = ray.inverse;
        let [sx, sy] = ray.shear;
        let [kx, ky, kz] = ray.axes;
        Spread {
            origin: [L::splat(ox), L::splat(oy), L::splat(oz)],
            permuted: [L::splat(ray.origin[kx]), L::splat(ray.origin[ky]), L::splat(ray.origin[kz])],
            inverse: [L::splat(ix), L::splat(iy), L::splat(iz)],
            shear: [L::splat(sx), L::splat(sy)],
            sign: L::splat(ray.sign),
            t_min: L::splat(ray.t_min),
        }
    }

    /// Where the ray meets eight parallel planes.
    #[inline(always)]
    fn slab(&self, axis: usize, planes: &[f32; WIDTH]) -> L {
        L::load(planes).minus(self.origin[axis]).times(self.inverse[axis])
    }

    /// Children whose boxes the ray meets up to `t_max`, as bits, and where it enters each.
    #[inline(always)]
    pub(super) fn boxes(&self, ray: &Ray, node: &Node, t_max: f32) -> (u32, L) {
        let [x, y, z] = ray.near_row;
        let planes = &node.planes;
        let near_x = self.slab(0, &planes[x]);
        let near_y = self.slab(1, &planes[y]);
        let near_z = self.slab(2, &planes[z]);
        let far_x = self.slab(0, &planes[x ^ 1]);
        let far_y = self.slab(1, &planes[y ^ 1]);
        let far_z = self.slab(2, &planes[z ^ 1]);
        let enter = near_x.max(near_y).max(near_z.max(self.t_min));
        let leave = far_x.min(far_y).min(far_z.min(L::splat(t_max)));
        (enter.at_most(leave), enter)
    }

    /// A corner of eight triangles, seen from the origin and sheared along the ray.
    #[inline(always)]
    fn corner(&self, ray: &Ray, rows: &[[f32; WIDTH]; 3]) -> [L; 3] {
        let [kx, ky, kz] = ray.axes;
        let along = L::load(&rows[kz]).minus(self.permuted[2]);
        let x = L::load(&rows[kx]).minus(self.permuted[0]).minus(self.shear[0].times(along));
        let y = L::load(&rows[ky]).minus(self.permuted[1]).minus(self.shear[1].times(along));
        [x, y, along]
    }

    /// Triangles of a leaf that the ray hits within `t_min ..= t_max`, as bits, and where.
    #[inline(always)]
    pub(super) fn triangles(&self, ray: &Ray, leaf: &Leaf, t_max: f32) -> (u32, L) {
        let [ax, ay, az] = self.corner(ray, &leaf.vertices[0]);
        let [bx, by, bz] = self.corner(ray, &leaf.vertices[1]);
        let [cx, cy, cz] = self.corner(ray, &leaf.vertices[2]);
        let u = cx.times(by).minus(cy.times(bx));
        let v = ax.times(cy).minus(ay.times(cx));
        let w = bx.times(ay).minus(by.times(ax));
        let zero = L::splat(0.0);
        let (low, high) = (u.min(v).min(w), u.max(v).max(w));
        let mut inside = zero.at_most(low) | high.at_most(zero);
        if inside == 0 {
            return (0, zero);
        }
        let determinant = u.plus(v).plus(w);
        let weighted = u.times(az).plus(v.times(bz)).plus(w.times(cz));
        let mut t = weighted.times(self.sign).over(determinant);
        let on_edge = inside & low.times(high).at_most(zero);
        if on_edge != 0 {
            let mut exact = t.store();
            inside &= !on_edge | decide_in_f64(ray, leaf, on_edge, &mut exact);
            t = L::load(&exact);
        }
        (inside & self.t_min.at_most(t) & t.at_most(L::splat(t_max)), t)
    }
}

/// Boxes grown by a margin of each axis's own, for rays in the space of a mesh.
pub(super) struct GrownBoxes<L> {
    /// What near and far planes are measured from: the origin moved against the planes' growth.
    near: [L; 3],
    far: [L; 3],
    inverse: [L; 3],
    t_min: L,
}

impl<L: Lanes> GrownBoxes<L> {
    #[inline(always)]
    pub(super) fn new(ray: &Ray, margin: Vec3) -> Self {
        let [ox, oy, oz] = ray.origin;
        let [ix, iy, iz] = ray.inverse;
        let (mx, my, mz) = (margin.x.copysign(ix), margin.y.copysign(iy), margin.z.copysign(iz));
        GrownBoxes {
            near: [L::splat(ox + mx), L::splat(oy + my), L::splat(oz + mz)],
            far: [L::splat(ox - mx), L::splat(oy - my), L::splat(oz - mz)],
            inverse: [L::splat(ix), L::splat(iy), L::splat(iz)],
            t_min: L::splat(ray.t_min),
        }
    }

    /// As [`Spread::boxes`].
    #[inline(always)]
    pub(super) fn boxes(&self, ray: &Ray, node: &Node, t_max: f32) -> (u32, L) {
        let (mut enter, mut leave) = (self.t_min, L::splat(t_max));
        for axis in 0..3 {
            let row = ray.near_row[axis];
            let near = L::load(&node.planes[row]).minus(self.near[axis]).times(self.inverse[axis]);
            let far = L::load(&node.planes[row ^ 1]).minus(self.far[axis]).times(self.inverse[axis]);
            (enter, leave) = (near.max(enter), far.min(leave));
        }
        (enter.at_most(leave), enter)
    }
}

/// Decides the lanes of a leaf in which an edge function rounded to zero: products of two f32 are exact in f64, so there
/// the signs are. Returns those inside, and replaces their t.
#[cold]
fn decide_in_f64(ray: &Ray, leaf: &Leaf, lanes: u32, t: &mut [f32; WIDTH]) -> u32 {
    let [kx, ky, kz] = ray.axes;
    let mut inside = 0;
    for lane in (0..WIDTH).filter(|lane| lanes >> lane & 1 == 1) {
        // The corners in f32, exactly as the lanes have them.
        let [a, b, c] = leaf.vertices.map(|rows| {
            let along = rows[kz][lane] - ray.origin[kz];
            let x = rows[kx][lane] - ray.origin[kx] - ray.shear[0] * along;
            let y = rows[ky][lane] - ray.origin[ky] - ray.shear[1] * along;
            DVec3::new(f64::from(x), f64::from(y), f64::from(along))
        });
        let edges = DVec3::new(c.x * b.y - c.y * b.x, a.x * c.y - a.y * c.x, b.x * a.y - b.y * a.x);
        let determinant = edges.element_sum();
        if (edges.min_element() >= 0.0 || edges.max_element() <= 0.0) && determinant != 0.0 {
            inside |= 1 << lane;
            t[lane] = (edges.dot(DVec3::new(a.z, b.z, c.z)) / determinant * f64::from(ray.sign)) as f32;
        }
    }
    inside
}
