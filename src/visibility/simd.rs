//! Chooses the lanes at run time. Both give the same answers, bit for bit.

use super::lanes::Portable;
use super::ray::Ray;
use super::walk::{self, Nearest};
use super::wide::Wide;

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

    /// The nearest triangle along a ray; of two equally near, the one of the lower index.
    pub(super) fn nearest(self, tree: &Wide, ray: &Ray) -> Option<Nearest> {
        match self {
            Simd::Portable => walk::nearest::<Portable>(tree, ray),
            #[cfg(target_arch = "x86_64")]
            Simd::Avx2 => avx2::nearest(tree, ray),
        }
    }

    /// True when any triangle lies on the ray.
    pub(super) fn any(self, tree: &Wide, ray: &Ray) -> bool {
        match self {
            Simd::Portable => walk::any::<Portable>(tree, ray),
            #[cfg(target_arch = "x86_64")]
            Simd::Avx2 => avx2::any(tree, ray),
        }
    }
}

#[cfg(target_arch = "x86_64")]
mod avx2 {
    #![expect(unsafe_code, reason = "calls functions compiled for AVX2")]

    use super::{Nearest, Ray, Wide, walk};
    use crate::visibility::lanes::Avx2;

    pub(super) fn nearest(tree: &Wide, ray: &Ray) -> Option<Nearest> {
        #[target_feature(enable = "avx2")]
        fn compiled(tree: &Wide, ray: &Ray) -> Option<Nearest> {
            walk::nearest::<Avx2>(tree, ray)
        }
        // SAFETY: `Simd::Avx2` is made only where AVX2 was detected.
        unsafe { compiled(tree, ray) }
    }

    pub(super) fn any(tree: &Wide, ray: &Ray) -> bool {
        #[target_feature(enable = "avx2")]
        fn compiled(tree: &Wide, ray: &Ray) -> bool {
            walk::any::<Avx2>(tree, ray)
        }
        // SAFETY: as above.
        unsafe { compiled(tree, ray) }
    }
}
