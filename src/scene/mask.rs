//! Alpha masks: which points of a triangle are there at all.
//!
//! The texel decision, the only one there is; exact rays and drawn maps both ask it:
//! 1. The point's barycentric weights, cut off at 0 and scaled to a sum of 1, weigh the corners' texture coordinates and
//!    vertex alphas.
//! 2. The image is looked up at full size (no smaller levels): its nearest texel, or the four around the point by linear
//!    weights, each coordinate wrapped on its own; (0, 0) is the upper left corner of the image.
//! 3. The point is there when texel × factor × vertex alpha ≥ cutoff.

use glam::{DVec2, DVec3};
use std::sync::Arc;

/// The alpha of an image, 8 bits a texel.
#[derive(Debug, PartialEq)]
pub struct AlphaImage {
    width: u32,
    height: u32,
    /// Row by row from the top.
    alpha: Vec<u8>,
    /// Least and greatest.
    range: [u8; 2],
}

impl AlphaImage {
    /// From `width * height` values, row by row from the top; `None` for another number of them, or none.
    pub fn new(width: u32, height: u32, alpha: Vec<u8>) -> Option<Self> {
        let range = [*alpha.iter().min()?, *alpha.iter().max()?];
        (width as usize * height as usize == alpha.len()).then_some(AlphaImage { width, height, alpha, range })
    }
}

/// What lies beyond an image's border.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// The image again.
    #[default]
    Repeat,
    /// The image mirrored, then again.
    Mirror,
    /// The texels of the border.
    Clamp,
}

/// How a material's alpha is found and judged.
#[derive(Clone, Debug, PartialEq)]
pub struct Mask {
    /// `None` = 1 everywhere.
    pub image: Option<Arc<AlphaImage>>,
    /// Along the image's width and height.
    pub wrap: [Wrap; 2],
    /// Linear weights between texels, or else the nearest.
    pub linear: bool,
    /// Multiplied in.
    pub factor: f64,
    /// From this alpha on a point is there.
    pub cutoff: f64,
}

/// A triangle with a mask.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cutout {
    /// Index of its [`Mask`].
    pub mask: u32,
    /// Texture coordinates of the corners.
    pub uv: [[f32; 2]; 3],
    /// Vertex alphas of the corners.
    pub alpha: [f32; 3],
}

impl Mask {
    /// The alpha of the image at texture coordinates, 0 to 1.
    pub fn texel(&self, uv: DVec2) -> f64 {
        let Some(image) = &self.image else { return 1.0 };
        let (width, height) = (f64::from(image.width), f64::from(image.height));
        let at = |x: f64, y: f64| {
            let (x, y) = (wrapped(self.wrap[0], x, width), wrapped(self.wrap[1], y, height));
            f64::from(image.alpha[y * image.width as usize + x]) / 255.0
        };
        let (x, y) = (uv.x * width, uv.y * height);
        if !self.linear {
            return at(x.floor(), y.floor());
        }
        let (x, y) = (x - 0.5, y - 0.5);
        let (left, top) = (x.floor(), y.floor());
        let (u, v) = (x - left, y - top);
        let row = |y: f64| at(left, y) * (1.0 - u) + at(left + 1.0, y) * u;
        row(top) * (1.0 - v) + row(top + 1.0) * v
    }

    /// Whether a point of a triangle is there, by its barycentric weights.
    pub fn is_solid(&self, cutout: &Cutout, weights: DVec3) -> bool {
        let inside = weights.max(DVec3::ZERO);
        let [a, b, c] = (inside / inside.element_sum()).to_array();
        let [u, v, w] = cutout.uv.map(|uv| DVec2::new(f64::from(uv[0]), f64::from(uv[1])));
        let [i, j, k] = cutout.alpha.map(f64::from);
        self.texel(u * a + v * b + w * c) * self.factor * (i * a + j * b + k * c) >= self.cutoff
    }

    /// Whether all points of a triangle are there (`Some(true)`) or none (`Some(false)`), whatever its place on the image.
    pub fn settled(&self, alpha: [f32; 3]) -> Option<bool> {
        let [low, high] = self.image.as_ref().map_or([1.0; 2], |image| image.range.map(|a| f64::from(a) / 255.0));
        let least = alpha.into_iter().fold(f32::INFINITY, f32::min);
        let most = alpha.into_iter().fold(f32::NEG_INFINITY, f32::max);
        if low * self.factor * f64::from(least) >= self.cutoff {
            return Some(true);
        }
        (high * self.factor * f64::from(most) < self.cutoff).then_some(false)
    }
}

/// A whole-numbered coordinate as a texel of a side; NaN is texel 0.
fn wrapped(wrap: Wrap, at: f64, side: f64) -> usize {
    let texel = match wrap {
        Wrap::Repeat => at.rem_euclid(side),
        Wrap::Clamp => at,
        Wrap::Mirror => {
            let twice = at.rem_euclid(2.0 * side);
            if twice < side { twice } else { 2.0 * side - 1.0 - twice }
        }
    };
    // rem_euclid can round up to the side itself.
    texel.clamp(0.0, side - 1.0) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Four texels in a row, 0 to 255.
    fn row(wrap: Wrap, linear: bool) -> Mask {
        let image = AlphaImage::new(4, 1, vec![0, 85, 170, 255]).map(Arc::new);
        Mask { image, wrap: [wrap, Wrap::Repeat], linear, factor: 1.0, cutoff: 0.5 }
    }

    fn texels(mask: &Mask, at: &[f64]) -> Vec<f64> {
        at.iter().map(|&u| (mask.texel(DVec2::new(u, 0.3)) * 3.0 * 1e9).round() / 1e9).collect()
    }

    #[test]
    fn coordinates_wrap() {
        let at = [-0.375, -0.125, 0.125, 0.875, 1.125, 1.375, 2.125];
        assert_eq!(texels(&row(Wrap::Repeat, false), &at), [2.0, 3.0, 0.0, 3.0, 0.0, 1.0, 0.0]);
        assert_eq!(texels(&row(Wrap::Mirror, false), &at), [1.0, 0.0, 0.0, 3.0, 3.0, 2.0, 0.0]);
        assert_eq!(texels(&row(Wrap::Clamp, false), &at), [0.0, 0.0, 0.0, 3.0, 3.0, 3.0, 3.0]);
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
            for u in [f64::NAN, f64::INFINITY, -1e300, -1e-18] {
                assert!(
                    row(wrap, true).texel(DVec2::splat(u)).is_nan() || row(wrap, false).texel(DVec2::splat(u)) <= 1.0
                );
            }
        }
    }

    #[test]
    fn linear_weights_run_between_texel_centres() {
        let at = [0.125, 0.25, 0.375, 1.0];
        assert_eq!(texels(&row(Wrap::Repeat, true), &at), [0.0, 0.5, 1.0, 1.5]);
        assert_eq!(texels(&row(Wrap::Clamp, true), &at), [0.0, 0.5, 1.0, 3.0]);
    }

    #[test]
    fn a_point_is_there_from_the_cutoff_on() {
        let cutout = Cutout { mask: 0, uv: [[0.0, 0.0], [1.0, 0.0], [1.0, 0.0]], alpha: [1.0; 3] };
        let mask = Mask { cutoff: 170.0 / 255.0, ..row(Wrap::Clamp, false) };
        let solid = |mask: &Mask, b: f64| mask.is_solid(&cutout, DVec3::new(1.0 - b, b, 0.0));
        assert!(!solid(&mask, 0.49) && solid(&mask, 0.51));
        assert!(!solid(&Mask { factor: 0.9, ..mask.clone() }, 0.51));
        assert!(solid(&mask, 1.5), "weights are cut off at 0");
        assert_eq!(mask.settled([1.0; 3]), None);
        assert_eq!(mask.settled([0.6; 3]), Some(false));
        assert_eq!(Mask { image: None, ..mask }.settled([1.0, 0.7, 1.0]), Some(true));
    }
}
