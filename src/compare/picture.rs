//! The picture strip of one light: the image with exact shadows, grey, and over it each method's wrong pixels, one column
//! a method.
//!
//! | | answered lit, in shadow | answered in shadow, lit |
//! |---|---|---|
//! | misplaced shadow edge | red | blue |
//! | owed to bias | orange | cyan |

use super::entry::{Case, Mask};
use super::glyphs;
use rayon::prelude::*;
use std::io;

type Rgb = [u8; 3];

/// A method's column.
pub(super) struct Column<'a> {
    pub(super) title: String,
    pub(super) mask: &'a Mask,
}

/// Side of a title's pixel, pixels.
const LETTER_SCALE: usize = 3;
/// Room around a title, and between columns, pixels.
const GAP: usize = 4;
const BACKGROUND: Rgb = [24, 24, 24];
const TITLE: Rgb = [235, 235, 235];
const EDGE: [Rgb; 2] = [[235, 50, 40], [40, 100, 245]];
const BIAS: [Rgb; 2] = [[245, 165, 30], [50, 205, 215]];

/// Rows of pixels.
struct Image {
    width: usize,
    pixels: Vec<Rgb>,
}

impl Image {
    fn new(width: usize, height: usize) -> Image {
        Image { width, pixels: vec![BACKGROUND; width * height] }
    }

    /// A title from its top left corner; what lies past `right` is cut off.
    fn write(&mut self, text: &str, left: usize, top: usize, right: usize) {
        let [width, height] = glyphs::SIZE;
        for (k, letter) in text.chars().enumerate() {
            for (row, bits) in glyphs::rows(letter).into_iter().enumerate().take(height) {
                for column in (0..width).filter(|c| bits >> (width - 1 - c) & 1 == 1) {
                    let x = left + (k * (width + 1) + column) * LETTER_SCALE;
                    let y = top + row * LETTER_SCALE;
                    for (dx, dy) in (0..LETTER_SCALE).flat_map(|dx| (0..LETTER_SCALE).map(move |dy| (dx, dy))) {
                        if x + dx < right
                            && let Some(pixel) = self.pixels.get_mut((y + dy) * self.width + x + dx)
                        {
                            *pixel = TITLE;
                        }
                    }
                }
            }
        }
    }
}

/// The strip as PNG.
pub(super) fn strip(case: &Case, columns: &[Column]) -> io::Result<Vec<u8>> {
    let (film_width, film_height) = (case.stage.film.width as usize, case.stage.film.height as usize);
    let head = glyphs::SIZE[1] * LETTER_SCALE + 2 * GAP;
    let width = columns.len() * (film_width + GAP) - GAP.min(columns.len() * GAP);
    let height = head + film_height;
    let mut image = Image::new(width.max(1), height);
    let base = shaded(case);
    for (k, column) in columns.iter().enumerate() {
        let left = k * (film_width + GAP);
        image.write(&column.title, left + GAP, GAP, left + film_width);
        let mut film = base.clone();
        for receiver in &column.mask.certain {
            let i = *receiver as usize;
            let colours = if column.mask.edge.binary_search(receiver).is_ok() { EDGE } else { BIAS };
            film[case.receivers.pixels[i] as usize] = colours[usize::from(!case.receivers.shadowed[i])];
        }
        for (y, row) in film.chunks(film_width.max(1)).enumerate() {
            let start = (head + y) * image.width + left;
            image.pixels[start..start + row.len()].copy_from_slice(row);
        }
    }
    encode(width.max(1), height, image.pixels.as_flattened())
}

/// The film in grey: by the cosine to the light where it is lit, darker in shadow, darkest where it faces away.
fn shaded(case: &Case) -> Vec<Rgb> {
    let mut film: Vec<Rgb> = (0..case.stage.film.pixels())
        .into_par_iter()
        .with_min_len(4096)
        .map(|pixel| match case.view.surface(case.stage.tracer, case.stage.camera, pixel) {
            Some(surface) => {
                let cosine = surface.normal.dot(case.light.towards(surface.position).normalize_or_zero());
                // Half the slope remains in shadow, so that shapes are seen there too.
                [(70.0 + 150.0 * cosine.max(0.0) + 20.0 * cosine.min(0.0)) as u8; 3]
            }
            None => BACKGROUND,
        })
        .collect();
    for (pixel, _) in case.receivers.pixels.iter().zip(&case.receivers.shadowed).filter(|(_, shadowed)| **shadowed) {
        film[*pixel as usize] = film[*pixel as usize].map(|v| 40 + v / 6);
    }
    film
}

fn encode(width: usize, height: usize, bytes: &[u8]) -> io::Result<Vec<u8>> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width as u32, height as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(bytes)?;
    writer.finish()?;
    Ok(file)
}
