//! Chooses the lanes at run time. Both give the same answers, bit for bit.

use super::bvh::Bvh;
use super::lanes::{Lanes, Portable};
use super::ray::{LocalRay, SceneRay};
use super::shared::SharedTree;
use super::solid::Solid;
use super::top::Top;
use super::trace::Hit;
use super::{through, walk};

/// Which lanes this machine has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Simd {
    /// Plain Rust.
    Portable,
    /// AVX2; made by [`Simd::detect`] only.
    #[cfg(target_arch = "x86_64")]
    Avx2,
}

impl Simd {
    /// The best there is.
    pub(super) fn detect() -> Simd {
        #[cfg(target_arch = "x86_64")]
        if is_x86_feature_detected!("avx2") {
            return Simd::Avx2;
        }
        Simd::Portable
    }

    /// The nearest solid triangle along a ray, of two equally near the one of the lower index, and where the ray meets it.
    pub(super) fn closest(self, bvh: &Bvh, ray: &SceneRay, solid: &impl Solid) -> Option<Hit> {
        match self {
            Simd::Portable => closest::<Portable>(bvh, ray, solid),
            #[cfg(target_arch = "x86_64")]
            Simd::Avx2 => avx2::closest(bvh, ray, solid),
        }
    }

    /// The nearest solid triangle of instances along a ray, or any of them with `ANY`; indices count within the list.
    pub(super) fn through<const ANY: bool>(
        self,
        instances: (&Top, &[SharedTree]),
        ray: &SceneRay,
        solid: &impl Solid,
    ) -> Option<Hit> {
        match self {
            Simd::Portable => through::<Portable, ANY>(instances, ray, solid),
            #[cfg(target_arch = "x86_64")]
            Simd::Avx2 => avx2::through::<ANY>(instances, ray, solid),
        }
    }

    /// True when any solid triangle lies on the ray.
    pub(super) fn occluded(self, bvh: &Bvh, ray: &SceneRay, solid: &impl Solid) -> bool {
        match self {
            Simd::Portable => occluded::<Portable>(bvh, ray, solid),
            #[cfg(target_arch = "x86_64")]
            Simd::Avx2 => avx2::occluded(bvh, ray, solid),
        }
    }
}

#[inline(always)]
fn closest<L: Lanes>(bvh: &Bvh, ray: &SceneRay, solid: &impl Solid) -> Option<Hit> {
    let local = LocalRay::new(bvh.listed_bounds()?, bvh.scale(), ray)?;
    let found = walk::nearest::<L>(&bvh.wide, &local.ray, solid)?;
    Some(Hit { triangle: found.triangle, t: local.meet(bvh.wide.corners(&found), found.t) })
}

#[inline(always)]
fn occluded<L: Lanes>(bvh: &Bvh, ray: &SceneRay, solid: &impl Solid) -> bool {
    let local = bvh.listed_bounds().and_then(|bounds| LocalRay::new(bounds, bvh.scale(), ray));
    match local {
        Some(local) => walk::any::<L>(&bvh.wide, &local.ray, solid),
        None => false,
    }
}

#[inline(always)]
fn through<L: Lanes, const ANY: bool>(
    (top, meshes): (&Top, &[SharedTree]),
    ray: &SceneRay,
    solid: &impl Solid,
) -> Option<Hit> {
    let local = LocalRay::new(top.bounds?, top.scale, ray)?;
    let found = through::first::<L, ANY>(top, meshes, &local, solid)?;
    Some(Hit { triangle: found.triangle, t: local.meet(found.corners, found.t) })
}

/// Each from the ray in f64 to the answer, so that nothing on the way changes between instruction sets.
#[cfg(target_arch = "x86_64")]
mod avx2 {
    #![expect(unsafe_code, reason = "calls functions compiled for AVX2")]

    use super::{Bvh, Hit, SceneRay, SharedTree, Solid, Top};
    use crate::visibility::lanes::Avx2;

    pub(super) fn closest(bvh: &Bvh, ray: &SceneRay, solid: &impl Solid) -> Option<Hit> {
        #[target_feature(enable = "avx2")]
        fn compiled(bvh: &Bvh, ray: &SceneRay, solid: &impl Solid) -> Option<Hit> {
            super::closest::<Avx2>(bvh, ray, solid)
        }
        // SAFETY: `Simd::Avx2` is made only where AVX2 was detected.
        unsafe { compiled(bvh, ray, solid) }
    }

    pub(super) fn through<const ANY: bool>(
        instances: (&Top, &[SharedTree]),
        ray: &SceneRay,
        solid: &impl Solid,
    ) -> Option<Hit> {
        #[target_feature(enable = "avx2")]
        fn compiled<const ANY: bool>(
            instances: (&Top, &[SharedTree]),
            ray: &SceneRay,
            solid: &impl Solid,
        ) -> Option<Hit> {
            super::through::<Avx2, ANY>(instances, ray, solid)
        }
        // SAFETY: as above.
        unsafe { compiled::<ANY>(instances, ray, solid) }
    }

    pub(super) fn occluded(bvh: &Bvh, ray: &SceneRay, solid: &impl Solid) -> bool {
        #[target_feature(enable = "avx2")]
        fn compiled(bvh: &Bvh, ray: &SceneRay, solid: &impl Solid) -> bool {
            super::occluded::<Avx2>(bvh, ray, solid)
        }
        // SAFETY: as above.
        unsafe { compiled(bvh, ray, solid) }
    }
}

#[cfg(test)]
mod tests {
    use glam::{DVec3, Vec3};

    use super::*;
    use crate::scene::Triangle;
    use crate::visibility::solid::Everything;

    /// A coarse grid of points, so that rays often meet edges and vertices exactly.
    fn grid_point(state: &mut u32) -> Vec3 {
        let mut next = || {
            *state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (*state >> 28) as f32 / 4.0
        };
        Vec3::new(next(), next(), next())
    }

    #[test]
    fn lanes_give_the_same_answers_bit_for_bit() {
        let mut state = 1;
        let triangles: Vec<Triangle> = (0..500).map(|_| std::array::from_fn(|_| grid_point(&mut state))).collect();
        let bvh = Bvh::build(&triangles);
        let fast = Simd::detect();
        let mut hits = 0;
        for _ in 0..5000 {
            let (from, to) = (grid_point(&mut state), grid_point(&mut state));
            let (origin, direction) = (from.as_dvec3() * 2.0 - DVec3::ONE, (to - from).as_dvec3());
            let ray = SceneRay { origin, direction, t_min: 0.0, t_max: f64::INFINITY };
            let (ours, portable) =
                (fast.closest(&bvh, &ray, &Everything), Simd::Portable.closest(&bvh, &ray, &Everything));
            assert_eq!(ours.map(|h| (h.triangle, h.t.to_bits())), portable.map(|h| (h.triangle, h.t.to_bits())));
            assert_eq!(fast.occluded(&bvh, &ray, &Everything), ours.is_some());
            assert_eq!(Simd::Portable.occluded(&bvh, &ray, &Everything), ours.is_some());
            hits += u32::from(ours.is_some());
        }
        assert!(hits > 500, "{hits} hits");
    }
}
