//! Image files → the alpha of their texels. PNG, JPEG and WebP, through `image`; told apart by their first bytes.

use super::mask::AlphaImage;
use image::{DynamicImage, ImageReader, Limits};
use std::io::Cursor;

/// Longest side of an image, texels: what GPUs offer.
const SIDE_MAX: u32 = 16_384;

/// Most memory that decoding an image may take, bytes: a 16-bit RGBA image of the largest size is twice that, and is
/// refused.
const DECODER_BYTES_MAX: u64 = 1 << 30;

/// Which numbers of an image are its opacity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Opacity {
    /// Alpha; 1 where the image has none.
    Alpha,
    /// Alpha, or the luminance of an image that has none.
    AlphaOrLuminance,
}

/// The opacity of an encoded image; the error says what stands in the way.
pub(super) fn decode(bytes: &[u8], opacity: Opacity) -> Result<AlphaImage, String> {
    let mut reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(|error| error.to_string())?;
    let mut limits = Limits::default();
    limits.max_image_width = Some(SIDE_MAX);
    limits.max_image_height = Some(SIDE_MAX);
    limits.max_alloc = Some(DECODER_BYTES_MAX);
    reader.limits(limits);
    let image = reader.decode().map_err(|error| error.to_string())?;
    let (width, height) = (image.width(), image.height());
    let alpha = match (image.color().has_alpha(), opacity) {
        (true, _) => alpha_of(image),
        (false, Opacity::Alpha) => vec![u8::MAX; width as usize * height as usize],
        (false, Opacity::AlphaOrLuminance) => image.into_luma8().into_raw(),
    };
    AlphaImage::new(width, height, alpha).ok_or_else(|| "it has no texels".to_owned())
}

fn alpha_of(image: DynamicImage) -> Vec<u8> {
    match image {
        DynamicImage::ImageLumaA8(image) => image.pixels().map(|pixel| pixel.0[1]).collect(),
        other => other.into_rgba8().pixels().map(|pixel| pixel.0[3]).collect(),
    }
}
