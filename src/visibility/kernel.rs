//! One ray against the eight-wide tree.
//!
//! Boxes by slabs; triangles by the watertight test of Woop, Benthin and Wald 2013 ("Watertight ray/triangle
//! intersection", JCGT 2(1)), eight at once. Deviations: both sides count; where an edge function rounds to zero the edge
//! counts as inside, instead of being decided in f64 (without fused multiply-add the sign of a nonzero one is exact, so
//! no ray slips between two triangles, and at worst both answer); and the ray's parameter is the distance along its
//! dominant axis, which makes the shear's scale ±1.
//!
//! Rounding, in units u = 2⁻²⁴ of the unit cube that holds all vertices and the ray's origin: vertex minus origin 2,
//! shear 4, edge functions and the weighted depth 6, box planes minus origin 2; together less than the 32 by which boxes
//! are grown (`wide::BOX_MARGIN`). So the slab test needs no factor of its own.

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
        let inside = zero.at_most(u.min(v).min(w)) | u.max(v).max(w).at_most(zero);
        if inside == 0 {
            return (0, zero);
        }
        let determinant = u.plus(v).plus(w);
        let weighted = u.times(az).plus(v.times(bz)).plus(w.times(cz));
        let t = weighted.times(self.sign).over(determinant);
        (inside & self.t_min.at_most(t) & t.at_most(L::splat(t_max)), t)
    }
}
