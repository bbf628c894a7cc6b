//! The planning grid: film positions that include the outermost pixel centres, so that what touches the image border is
//! seen.

use crate::scene::{Camera, Film};
use crate::visibility::{Surface, Tracer, surface_at};
use rayon::prelude::*;

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

    /// The film position of a grid position: the centre of a pixel; the first and last ones are those of the film.
    pub fn position(&self, column: u32, row: u32) -> [f64; 2] {
        let at = |k: u32, count: u32, pixels: u32| {
            let last = f64::from(count.max(2) - 1);
            (f64::from(k) / last * f64::from(pixels - 1)).round() + 0.5
        };
        [at(column, self.columns, self.film.width), at(row, self.rows, self.film.height)]
    }
}

/// What the positions of a grid see.
#[derive(Clone, Debug)]
pub struct GridView {
    /// The grid.
    pub grid: Grid,
    /// Row by row from the top.
    pub surfaces: Vec<Option<Surface>>,
}

impl GridView {
    /// One ray for each position.
    pub fn see(tracer: &Tracer, camera: &Camera, grid: Grid) -> GridView {
        let surfaces = (0..grid.rows)
            .into_par_iter()
            .flat_map_iter(|row| {
                (0..grid.columns).map(move |column| {
                    let [x, y] = grid.position(column, row);
                    surface_at(tracer, camera, grid.film, x, y)
                })
            })
            .collect();
        GridView { grid, surfaces }
    }

    /// Index of a position.
    pub fn index(&self, column: u32, row: u32) -> usize {
        row as usize * self.grid.columns as usize + column as usize
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
