//! The planning grid: film positions that include the outermost pixel centres, so that what touches the image border is
//! seen.

use crate::scene::{Camera, Film, Light};
use crate::visibility::{Answer, NO_TRIANGLE, RayOffset, Surface, Tracer, View, answer, first_hit};
use rayon::prelude::*;
use std::borrow::Cow;

/// Film positions, each the centre of a pixel, evenly spread.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Grid {
    /// The film.
    pub film: Film,
    /// Positions across.
    pub columns: u32,
    /// Positions down.
    pub rows: u32,
}

impl Grid {
    /// About `short_side` positions along the film's short side, square cells; never more than pixels.
    pub fn new(film: Film, short_side: u32) -> Grid {
        let short = film.width.min(film.height);
        let step = (f64::from(short) / f64::from(short_side.max(2))).max(1.0);
        let count = |pixels: u32| ((f64::from(pixels) / step).round() as u32).clamp(1, pixels);
        Grid { film, columns: count(film.width), rows: count(film.height) }
    }

    /// Number of positions.
    pub fn len(&self) -> usize {
        self.columns as usize * self.rows as usize
    }

    /// True without positions.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// True when the positions are all pixels of the film.
    pub fn is_film(&self) -> bool {
        (self.columns, self.rows) == (self.film.width, self.film.height)
    }

    /// Number of a position, row by row.
    pub fn index(&self, column: u32, row: u32) -> usize {
        row as usize * self.columns as usize + column as usize
    }

    /// The film position of a grid position counted row by row.
    pub fn position_of(&self, index: usize) -> [f64; 2] {
        let columns = self.columns.max(1) as usize;
        self.position((index % columns) as u32, (index / columns) as u32)
    }

    /// What the positions have of a value for every pixel of the film.
    pub fn of_film<'a, T: Copy>(&self, film: &'a [T]) -> Cow<'a, [T]> {
        if self.is_film() {
            return Cow::Borrowed(film);
        }
        let pixel = |[x, y]: [f64; 2]| y as usize * self.film.width as usize + x as usize;
        (0..self.len()).map(|i| film[pixel(self.position_of(i))]).collect()
    }

    /// The film position of a grid position: the centre of a pixel; the first and last ones are those of the film.
    pub fn position(&self, column: u32, row: u32) -> [f64; 2] {
        let at = |k: u32, count: u32, pixels: u32| {
            let last = f64::from(count.max(2) - 1);
            (f64::from(k) / last * f64::from(pixels - 1)).round() + 0.5
        };
        [at(column, self.columns, self.film.width), at(row, self.rows, self.film.height)]
    }
}

/// What the positions of a grid see, row by row from the top.
#[derive(Clone, Debug)]
pub struct GridView<'a> {
    /// The grid.
    pub grid: Grid,
    /// Triangle of each position, or [`NO_TRIANGLE`].
    triangles: Cow<'a, [u32]>,
    /// Distance along the view axis, metres.
    depths_m: Cow<'a, [f64]>,
}

impl<'a> GridView<'a> {
    /// One ray for each position; none where the film has been seen.
    pub fn see(tracer: &Tracer, camera: &Camera, grid: Grid, film: Option<&'a View>) -> GridView<'a> {
        if let Some(view) = film {
            return GridView { grid, triangles: grid.of_film(&view.triangles), depths_m: grid.of_film(&view.depths_m) };
        }
        let rays = camera.rays(grid.film);
        let (triangles, depths_m): (Vec<u32>, Vec<f64>) = (0..grid.len())
            .into_par_iter()
            .map(|i| {
                let [x, y] = grid.position_of(i);
                let hit = first_hit(tracer, camera, rays.through(x, y));
                hit.map_or((NO_TRIANGLE, f64::INFINITY), |hit| (hit.triangle, hit.t))
            })
            .unzip();
        GridView { grid, triangles: triangles.into(), depths_m: depths_m.into() }
    }

    /// A grid that nothing is asked of.
    pub fn unseen(grid: Grid) -> GridView<'a> {
        GridView { grid, triangles: Cow::Borrowed(&[]), depths_m: Cow::Borrowed(&[]) }
    }

    /// The surface at a position; `None` for the background. `tracer` and `camera` are those it was seen with.
    pub fn surface(&self, tracer: &Tracer, camera: &Camera, index: usize) -> Option<Surface> {
        let seen = (self.triangles[index], self.depths_m[index]);
        (seen.0 != NO_TRIANGLE)
            .then(|| Surface::new(tracer, camera, self.grid.film, self.grid.position_of(index), seen))
    }

    /// The triangle at a position, or [`NO_TRIANGLE`].
    pub(super) fn triangle(&self, index: usize) -> u32 {
        self.triangles[index]
    }

    /// What a light does at every position, by one shadow ray from each that faces it.
    pub fn answers(&self, tracer: &Tracer, camera: &Camera, light: &Light, offset: RayOffset) -> Vec<Answer> {
        let at = |i| self.surface(tracer, camera, i).map_or(Answer::Unlit, |s| answer(tracer, &s, light, offset));
        (0..self.grid.len()).into_par_iter().map(at).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_grid_holds_the_border_pixels() {
        for (width, height, side) in [(1920, 1080, 256), (7, 3, 256), (1, 1, 8), (1, 4096, 64)] {
            let film = Film { width, height };
            let grid = Grid::new(film, side);
            assert_eq!(grid.position(0, 0), [0.5, 0.5]);
            let last = grid.position(grid.columns - 1, grid.rows - 1);
            if grid.columns > 1 {
                assert_eq!(last[0], f64::from(width) - 0.5);
            }
            if grid.rows > 1 {
                assert_eq!(last[1], f64::from(height) - 0.5);
            }
        }
    }
}
