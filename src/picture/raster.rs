//! A picture in memory and as a PNG file.

use glam::DVec2;
use std::io;

/// sRGB.
pub type Colour = [u8; 3];

/// An image, row 0 at the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
    /// Row by row from the top, `width * height` of them.
    pub pixels: Vec<Colour>,
}

impl Picture {
    /// From the colour of each pixel, by its number row by row.
    pub fn from_fn(width: u32, height: u32, colour: impl Fn(usize) -> Colour) -> Picture {
        let pixels = (0..width as usize * height as usize).map(colour).collect();
        Picture { width, height, pixels }
    }

    /// Colours a square of `side` pixels around a position (pixels, y down), as far as it lies inside.
    pub fn dot(&mut self, at: DVec2, side: u32, colour: Colour) {
        let from = at - DVec2::splat(0.5 * f64::from(side - side % 2));
        for dy in 0..side {
            for dx in 0..side {
                let (x, y) = (from.x + f64::from(dx), from.y + f64::from(dy));
                if x >= 0.0 && y >= 0.0 && x < f64::from(self.width) && y < f64::from(self.height) {
                    self.pixels[y as usize * self.width as usize + x as usize] = colour;
                }
            }
        }
    }

    /// Draws a straight line between two positions, one pixel wide; both must be finite.
    pub fn line(&mut self, from: DVec2, to: DVec2, colour: Colour) {
        let steps = (to - from).abs().max_element().ceil().clamp(1.0, f64::from(u16::MAX)) as u32;
        for step in 0..=steps {
            self.dot(from.lerp(to, f64::from(step) / f64::from(steps)), 1, colour);
        }
    }

    /// The bytes of a PNG file.
    ///
    /// # Errors
    /// What the encoder says; a picture without pixels cannot be encoded.
    pub fn to_png(&self) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.width, self.height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(self.pixels.as_flattened())?;
        writer.finish()?;
        Ok(bytes)
    }
}

/// Pictures in rows and columns, `gap` white pixels between them; columns and rows are as wide and high as the first picture.
pub fn tiled(rows: &[Vec<Picture>], gap: u32) -> Picture {
    let first = rows.iter().flatten().next().map_or((1, 1), |p| (p.width, p.height));
    let columns = rows.iter().map(Vec::len).max().unwrap_or(1).max(1) as u32;
    let along = |count: u32, side: u32| count * side + (count - 1) * gap;
    let (width, height) = (along(columns, first.0), along(rows.len().max(1) as u32, first.1));
    Picture::from_fn(width, height, |i| {
        let (x, y) = (i as u32 % width, i as u32 / width);
        let (column, row) = (x / (first.0 + gap), y / (first.1 + gap));
        let (x, y) = (x % (first.0 + gap), y % (first.1 + gap));
        let picture = rows.get(row as usize).and_then(|r| r.get(column as usize));
        let inside = picture.filter(|p| x < p.width && y < p.height);
        inside.map_or([255; 3], |p| p.pixels[(y * p.width + x) as usize])
    })
}

/// A colour `share` of the way to another; 0 leaves the first.
pub fn mix(from: Colour, to: Colour, share: f64) -> Colour {
    std::array::from_fn(|i| (f64::from(from[i]) * (1.0 - share) + f64::from(to[i]) * share).round() as u8)
}

/// A colour times a factor, clamped.
pub fn scaled(colour: Colour, factor: f64) -> Colour {
    colour.map(|c| (f64::from(c) * factor).round().clamp(0.0, 255.0) as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_stand_in_rows_and_columns() {
        let flat = |colour: Colour| Picture::from_fn(3, 2, |_| colour);
        let all = tiled(&[vec![flat([1; 3]), flat([2; 3])], vec![flat([3; 3])]], 1);
        assert_eq!((all.width, all.height), (7, 5));
        let at = |x: usize, y: usize| all.pixels[y * 7 + x][0];
        assert_eq!((at(0, 0), at(3, 0), at(4, 1), at(2, 3), at(0, 2), at(5, 4)), (1, 255, 2, 3, 255, 255));
    }

    #[test]
    fn marks_stay_inside_and_the_file_reads_back() {
        let mut picture = Picture::from_fn(7, 5, |i| [i as u8, 0, 0]);
        picture.dot(DVec2::new(0.0, 0.0), 3, [1, 2, 3]);
        picture.dot(DVec2::new(6.5, 4.5), 1, [4, 5, 6]);
        picture.line(DVec2::new(-100.0, 2.5), DVec2::new(100.0, 2.5), [7, 8, 9]);
        assert_eq!(picture.pixels[0], [1, 2, 3]);
        assert_eq!(picture.pixels[34], [4, 5, 6]);
        assert!((14..21).all(|i| picture.pixels[i] == [7, 8, 9]));
        let bytes = picture.to_png().unwrap();
        let mut reader = png::Decoder::new(io::Cursor::new(bytes)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut pixels).unwrap();
        assert_eq!((info.width, info.height), (7, 5));
        assert_eq!(pixels, picture.pixels.as_flattened());
    }
}
