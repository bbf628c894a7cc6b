//! Image files → the alpha of their texels. PNG, JPEG and WebP, through `image`; told apart by their first bytes.

use super::mask::AlphaImage;
use image::{DynamicImage, ImageReader, Limits};
use std::io::Cursor;

/// Longest side of an image, texels: what GPUs offer.
const SIDE_MAX: u32 = 16_384;

/// Most memory that decoding an image may take, bytes: a 16-bit RGBA image of the largest size is twice that, and is
/// refused.
const DECODER_BYTES_MAX: u64 = 1 << 30;

/// Texels that an image may have whatever its file's size, and for each byte of the file: formats that code equal texels
/// in no bits at all let 30 bytes stand for a gigabyte. A mask has outlines: they take far more than a bit in 1000 texels.
const TEXELS_FREE: u64 = 1 << 22;
const TEXELS_PER_BYTE: u64 = 1024;

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
    let read = || ImageReader::new(Cursor::new(bytes)).with_guessed_format();
    let (width, height) =
        read().and_then(|r| r.into_dimensions().map_err(std::io::Error::other)).map_err(|error| error.to_string())?;
    let most = TEXELS_FREE + TEXELS_PER_BYTE * bytes.len() as u64;
    if u64::from(width) * u64::from(height) > most {
        let size = bytes.len();
        return Err(format!("{width} x {height} texels in {size} bytes, more than the {most} that are decoded of it"));
    }
    let mut reader = read().map_err(|error| error.to_string())?;
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
