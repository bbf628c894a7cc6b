//! Where the search for the projective part starts: the best points of a polar grid over the legal (a, b) that lie apart.

use super::PolarPolygon;
use glam::DVec2;

/// The polar grid: directions, and parts of the way to the border.
const GRID_DIRECTIONS: u32 = 16;
const GRID_FRACTIONS: [f64; 6] = [0.2, 0.45, 0.65, 0.8, 0.9, 0.96];
/// Points whose affine part is found before the search asks again whether those left can matter.
const LOOKS_AT_ONCE: usize = 4;

/// Starts of simplices lie farther apart than this part of the way to the border: neighbours on a ray of the grid, as long as
/// that is no difference of its fractions, so that rounding does not tell.
const APART: f64 = 0.14;

/// A value and its (a, b).
pub(super) type Seed = (f64, DVec2);

/// Points of the grid that a search looks at.
pub(super) fn coarse_grid<'a>(polar: &'a PolarPolygon) -> impl Iterator<Item = DVec2> + 'a {
    polar_grid(polar, GRID_DIRECTIONS, &GRID_FRACTIONS)
}

/// Points in evenly spread directions, at parts of the way to the border.
pub(super) fn polar_grid<'a>(
    polar: &'a PolarPolygon,
    directions: u32,
    fractions: &'a [f64],
) -> impl Iterator<Item = DVec2> + 'a {
    (0..directions).flat_map(move |k| {
        let direction = DVec2::from_angle(std::f64::consts::TAU * f64::from(k) / f64::from(directions));
        let radius = polar.radius(direction);
        fractions.iter().map(move |f| direction * (radius * f))
    })
}

/// Adds to the seeds the points of a grid, given in the order of their bounds, as long as one may still be a start.
pub(super) fn look(
    grid: Vec<Seed>,
    polar: &PolarPolygon,
    simplices: usize,
    seeds: &mut Vec<Seed>,
    value_at: &mut impl FnMut(DVec2) -> f64,
) {
    for (looked, (least, ab)) in grid.into_iter().enumerate() {
        if looked % LOOKS_AT_ONCE == 0 {
            let starts = starting_points(seeds, polar, simplices);
            if starts.len() == simplices && starts.iter().all(|start| start.0 < least) {
                break;
            }
        }
        seeds.push((value_at(ab), ab));
    }
}

/// Where simplices start: the best of the seeds that lie apart, `most` of them or fewer. Sorts the seeds.
pub(super) fn starting_points(seeds: &mut [Seed], polar: &PolarPolygon, most: usize) -> Vec<Seed> {
    seeds.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.x.total_cmp(&b.1.x)).then(a.1.y.total_cmp(&b.1.y)));
    let mut starts: Vec<Seed> = Vec::with_capacity(most);
    for (value, ab) in seeds.iter().filter(|seed| seed.0.is_finite()) {
        let apart = |s: &Seed| (s.1 - *ab).length() > APART * polar.radius((*ab - s.1).normalize_or(DVec2::X));
        if starts.iter().all(apart) {
            starts.push((*value, *ab));
        }
        if starts.len() == most {
            break;
        }
    }
    starts
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is not looked at would not have been a start.
    #[test]
    fn a_look_that_ends_early_finds_the_starts_of_a_whole_one() {
        let hull = [(-1.0, -0.5), (0.9, -0.7), (1.2, 0.1), (0.3, 1.0)].map(|(x, y)| DVec2::new(x, y));
        let polar = PolarPolygon::new(&hull);
        let points: Vec<DVec2> = coarse_grid(&polar).collect();
        let mut left_out = 0;
        for scene in 0..100 {
            let bumpy = |ab: DVec2| {
                let f = f64::from(scene);
                2.0 + (3.0 * ab.x + f).sin() * (2.0 * ab.y - 0.7 * f).cos() + 0.2 * (40.0 * ab.x + 17.0 * ab.y).sin()
            };
            let mut grid: Vec<Seed> =
                points.iter().map(|ab| (bumpy(*ab) * (0.6 + 0.4 * (90.0 * ab.x).sin().abs()), *ab)).collect();
            grid.sort_by(|a, b| a.0.total_cmp(&b.0));
            for simplices in [1, 3] {
                let (mut some, mut all) = (Vec::new(), points.iter().map(|ab| (bumpy(*ab), *ab)).collect::<Vec<_>>());
                look(grid.clone(), &polar, simplices, &mut some, &mut |ab| bumpy(ab));
                left_out += all.len() - some.len();
                let starts = starting_points(&mut all, &polar, simplices);
                assert_eq!(starting_points(&mut some, &polar, simplices), starts);
            }
        }
        assert!(left_out > 2000, "{left_out}");
    }
}
