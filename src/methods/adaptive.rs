//! Quadtree tiles over the light plane: adaptive shadow maps (Fernando, Fernandez, Bala and Greenberg 2001) with the level
//! of a tile from the footprints of the pixels in it, as in resolution-matched shadow maps (Lefohn, Sengupta and Owens
//! 2007), for a given number of tiles.
//!
//! The root is the square around the cover in the light's image plane. As long as there is room, the tile that is most
//! undersampled is cut into its four children; those without covered points are dropped. `adaptive` gives all tiles equal
//! texels and cuts where side over finest pixel footprint is largest. `edges` cuts the tile whose
//! shadow edges cost most, which leaves tiles without any whole, and splits the texels by cost (math note §6): surfaces that are lit or shadowed
//! throughout answer rightly at any resolution.
//!
//! Deviations: levels are chosen for a budget, where the papers ask for a texel a pixel; footprints are those of a surface
//! that faces the camera, at covered points, since normals are not known here; texels that tiles do not need are not
//! virtual but not there.

use super::plane::Plane;
use super::region::{Region, Report};
use super::{Inapplicable, Inputs, lixel};
use crate::fit::Aspect;
use crate::math::{Domain, LightSpace, row_at};
use crate::samples::EdgePoint;
use glam::{DVec2, DVec3};

/// Room left around a tile on its map, relative to its side: more than rounding of matrix or domain moves a point, less
/// than a texel.
const BORDER: f64 = 1.0 / 4096.0;
/// Deepest level: a tile of the root's side / 2^20 is smaller than any texel.
const DEEPEST: u32 = 20;

/// What decides which tile is cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Level {
    /// The finest pixel footprint on the tile; equal texels.
    Footprint,
    /// What its shadow edges cost; texels by cost.
    Edges,
}

/// A covered point on the light plane.
#[derive(Clone, Copy)]
struct Spot {
    at: DVec2,
    /// Side of the pixel's footprint in units of the plane q3 = 1.
    footprint: f64,
    point: DVec3,
}

struct Tile {
    min: DVec2,
    max: DVec2,
    level: u32,
    spots: Vec<Spot>,
    edges: Vec<(DVec2, EdgePoint)>,
    region: Region,
}

/// Solves all tiles of a cover that fits a half-space.
pub(super) fn solve(inputs: &Inputs, axis: Option<DVec3>, level: Level) -> Result<Vec<Region>, Inapplicable> {
    let space = match (axis, inputs.light.position()) {
        (Some(axis), Some(position)) => LightSpace::perspective(position, axis, lixel::centre(inputs.covered)),
        _ => LightSpace::around(inputs.light, inputs.covered)?,
    };
    // To the bit as the tiles' domains evaluate it.
    let rows = space.plane_from_scene();
    let flat = |point: DVec3| {
        let [x, y, w] = rows.map(|row| row_at(row, point));
        (w > 0.0).then(|| DVec2::new(x / w, y / w))
    };
    let spots: Vec<Spot> = inputs
        .covered
        .iter()
        .map(|point| Some(Spot { at: flat(*point)?, footprint: footprint(inputs, &space, *point), point: *point }))
        .collect::<Option<_>>()
        .ok_or(Inapplicable::CoveredBehindLight)?;
    let (lo, hi) = spots
        .iter()
        .fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(lo, hi): (DVec2, DVec2), s| (lo.min(s.at), hi.max(s.at)));
    let finest = spots.iter().map(|s| s.footprint).fold(f64::INFINITY, f64::min);
    let side = (hi - lo).max_element().max(finest) * (1.0 + 2.0 * BORDER);
    let edges = inputs.edges.iter().filter_map(|e| Some((flat(e.position)?, *e))).collect();
    let min = 0.5 * (lo + hi) - DVec2::splat(0.5 * side);
    let root =
        Tile::new(inputs, space, (min, min + DVec2::splat(side), 0), spots, edges).ok_or(Inapplicable::NoFiniteFit)?;
    let most = inputs.solver.tiles as usize;
    // Children are made once, when their parent is first looked at.
    let mut tiles = vec![(root, None::<(f64, Vec<Tile>)>)];
    loop {
        for (tile, children) in tiles.iter_mut().filter(|(_, children)| children.is_none()) {
            *children = Some(tile.cut(inputs, space, level, most));
        }
        let need = |k: usize| tiles[k].1.as_ref().map_or(0.0, |c| c.0);
        let fits = |k: usize| tiles[k].1.as_ref().is_some_and(|c| tiles.len() - 1 + c.1.len() <= most);
        let best = (0..tiles.len()).filter(|k| fits(*k)).fold(None, |best: Option<usize>, k| match best {
            Some(b) if need(k) <= need(b) => Some(b),
            _ => Some(k),
        });
        match best {
            Some(best) if need(best) > 0.0 => {
                let (_, children) = tiles.swap_remove(best);
                tiles.extend(children.into_iter().flat_map(|c| c.1).map(|tile| (tile, None)));
            }
            _ => break,
        }
    }
    let share = (level == Level::Footprint).then_some(1.0);
    Ok(tiles.into_iter().map(|(tile, _)| Region { share, ..tile.region }).collect())
}

/// Side of a pixel's footprint around a covered point, in units of the plane q3 = 1.
fn footprint(inputs: &Inputs, space: &LightSpace, point: DVec3) -> f64 {
    let [(by_origin, by_direction), _] = inputs.camera.ray_derivatives(inputs.film);
    let depth = inputs.camera.forward().dot(point - inputs.camera.position);
    (by_origin + by_direction * depth).length() / space.q(point).z
}

impl Tile {
    fn new(
        inputs: &Inputs,
        space: LightSpace,
        (min, max, level): (DVec2, DVec2, u32),
        spots: Vec<Spot>,
        edges: Vec<(DVec2, EdgePoint)>,
    ) -> Option<Tile> {
        let covered: Vec<DVec3> = spots.iter().map(|s| s.point).collect();
        let points: Vec<EdgePoint> = edges.iter().map(|e| e.1).collect();
        let plane = Plane::new(inputs, space, &covered, &points, true)?;
        let side = (max - min).max_element();
        let scale = 1.0 / (side * (1.0 + 2.0 * BORDER));
        let row =
            |axis: DVec3, at: f64| plane.normalisation.row(axis * scale + DVec3::Z * ((BORDER * side - at) * scale));
        let rows = [row(DVec3::X, min.x), row(DVec3::Y, min.y), plane.normalisation.row(DVec3::Z)];
        let aspect = match inputs.aspect {
            Aspect::Fixed(ratio) => ratio,
            Aspect::Free => 1.0,
        };
        let report = Report::direct(&plane, 1);
        let mut region = Region::new(plane, rows, aspect, report);
        let plane_from_scene = space.plane_from_scene();
        region.domain = Domain::LightPlaneRectangle { plane_from_scene, min, max };
        (region.h.is_finite() && region.h.determinant() > 0.0).then_some(Tile { min, max, level, spots, edges, region })
    }

    /// How much it needs to be cut, and its children that hold covered points.
    fn cut(&self, inputs: &Inputs, space: LightSpace, level: Level, tiles: usize) -> (f64, Vec<Tile>) {
        if self.level >= DEEPEST || (level == Level::Edges && self.edges.is_empty()) {
            return (0.0, Vec::new());
        }
        let middle = 0.5 * (self.min + self.max);
        // Halves meet at one value; each point lies in exactly one child.
        let quadrant = |at: DVec2| usize::from(at.x >= middle.x) + 2 * usize::from(at.y >= middle.y);
        let mut children = Vec::with_capacity(4);
        for k in 0..4 {
            let spots: Vec<Spot> = self.spots.iter().filter(|s| quadrant(s.at) == k).copied().collect();
            if spots.is_empty() {
                continue;
            }
            let edges = self.edges.iter().filter(|e| quadrant(e.0) == k).copied().collect();
            let min = DVec2::new(
                if k % 2 == 0 { self.min.x } else { middle.x },
                if k / 2 == 0 { self.min.y } else { middle.y },
            );
            let max = DVec2::new(
                if k % 2 == 0 { middle.x } else { self.max.x },
                if k / 2 == 0 { middle.y } else { self.max.y },
            );
            match Tile::new(inputs, space, (min, max, self.level + 1), spots, edges) {
                Some(tile) => children.push(tile),
                None => return (0.0, Vec::new()),
            }
        }
        let need = match level {
            Level::Footprint => {
                let finest = self.spots.iter().map(|s| s.footprint).fold(f64::INFINITY, f64::min);
                (self.max - self.min).max_element() / finest
            }
            Level::Edges => self.region.predict(inputs.texels / tiles as f64).misclassified,
        };
        (need, children)
    }
}
