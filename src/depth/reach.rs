//! How far along the light a frame's maps have to reach, whatever their matrices come to be.
//!
//! A depth row has to hold the receivers that look a map up and their casters, over all frames that share the map. Which
//! these are hangs on the map's square, which is settled after the frames were seen; so each frame keeps a grid of tiles as
//! seen from the light, and of each tile that holds receivers the nearest and the farthest thing that a map of the tile alone
//! would keep ([`Kept`]). Tiles are fine over the box of what the frame has to cover, and in rings around it twice as large
//! each: maps are little larger than what they cover. Later the near and far ends of the tiles, cut at the map's square,
//! stand for what is between them: their hull holds it.

use super::kept::{Kept, Polygon, constant, vector};
use super::visible::Visible;
use crate::math::{Domain, LightSpace};
use crate::scene::Light;
use crate::visibility::Tracer;
use glam::{DMat3, DVec2, DVec3, DVec4};
use rayon::prelude::*;

/// Tiles along a side of the box, and of each ring. Depth within a tile is taken to be that of its extremes, so that a row
/// that follows a slope is wider than it need be by what the slope rises in a tile.
const TILES: u32 = 8;
/// Rings around the box: the last one ends 32 times as far out as the box. What is beyond holds no depth row.
const RINGS: u32 = 5;
/// The hull of the tiles' ends is widened by this part of its extent, for rounding.
const WIDENED: f64 = 1e-3;
/// Room left around the square of a map, as [`Kept`] does for casters.
const BORDER: f64 = 0.01;
/// Half side of a box without extent, relative to the distance or in metres: a cover of one point still has depth.
const THIN: f64 = 1e-6;

/// The ends of the tiles of one light in one frame: scene points, four corners an end; empty when nothing is covered. `cover`
/// are the points that maps have to hold, `visible` those that may look a map up.
pub fn reach(tracer: &Tracer, light: &Light, cover: &[DVec3], visible: &Visible) -> Vec<DVec3> {
    let Some(position) = light.position() else {
        return match LightSpace::around(light, cover) {
            Ok(space) => tiles(tracer, &space, cover, visible),
            Err(_) => Vec::new(),
        };
    };
    let mut ends = Vec::new();
    for face in 0..6 {
        let (axis, positive) = (face / 2, face % 2 == 0);
        let domain = Domain::CubeFace { position, axes: DVec3::AXES, axis, positive };
        let inside: Vec<DVec3> = cover.iter().copied().filter(|p| domain.holds(*p)).collect();
        let direction = DVec3::AXES[axis] * if positive { 1.0 } else { -1.0 };
        let space = LightSpace::perspective(position, direction, position + direction);
        ends.extend(tiles(tracer, &space, &inside, visible));
    }
    ends
}

/// The tiles over the box of some points in one light plane.
fn tiles(tracer: &Tracer, space: &LightSpace, cover: &[DVec3], visible: &Visible) -> Vec<DVec3> {
    let flat = cover.iter().map(|p| space.q(*p)).filter(|q| q.z > 0.0).map(|q| q.truncate() / q.z);
    let (low, high) = flat.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(l, h), p| (l.min(p), h.max(p)));
    if !(low.is_finite() && high.is_finite()) {
        return Vec::new();
    }
    let thin = THIN * (1.0 + low.abs().max(high.abs()).max_element());
    let (low, high) = (low - thin, high + thin);
    let (middle, half) = ((low + high) * 0.5, (high - low) * 0.5);
    // Ring 0 is the box; of the others the tiles of the half as large one before are left out.
    let tile = |k: u32| -> Vec<DVec3> {
        let (ring, k) = (k / (TILES * TILES), k % (TILES * TILES));
        let (column, row) = (k % TILES, k / TILES);
        let inner = TILES / 4..TILES - TILES / 4;
        if ring > 0 && inner.contains(&column) && inner.contains(&row) {
            return Vec::new();
        }
        let half = half * 2.0_f64.powi(ring as i32);
        let at = |column: u32, row: u32| {
            middle + half * (DVec2::new(f64::from(column), f64::from(row)) * (2.0 / f64::from(TILES)) - 1.0)
        };
        ends(tracer, space, [at(column, row), at(column + 1, row + 1)], visible)
    };
    (0..(RINGS + 1) * TILES * TILES).into_par_iter().flat_map_iter(tile).collect()
}

/// The corners of a tile at the depths of the nearest and the farthest thing kept; none where nothing looks it up.
fn ends(tracer: &Tracer, space: &LightSpace, [low, high]: [DVec2; 2], visible: &Visible) -> Vec<DVec3> {
    let (scale, shift) = (DVec2::ONE / (high - low), -low / (high - low));
    let rows = [DVec3::new(scale.x, 0.0, shift.x), DVec3::new(0.0, scale.y, shift.y), DVec3::Z];
    let h = DMat3::from_cols(rows[0], rows[1], rows[2]).transpose();
    let kept = Kept::new(tracer, space, &h, visible, &Domain::All);
    if kept.is_empty() {
        return Vec::new();
    }
    // Depth along the light is e of a directional light, q3 = 1 / (1 / q3) of the others.
    let depth_of = |v: DVec4| if space.directional { v.w } else { v.z };
    let along = if space.directional { DVec4::W } else { -constant(space) };
    let extreme = |row: DVec4| kept.largest(row, DVec4::Z, f64::NEG_INFINITY, 0.0).map(|(_, v)| depth_of(v));
    let depths = [extreme(-along), extreme(along)].into_iter().flatten();
    let corners = [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)];
    let end = |depth: f64| corners.map(|at| point(space, at, depth));
    depths.map(end).filter(|end| end.iter().all(|p| p.is_finite())).flatten().collect()
}

/// The scene point at a place of the plane q3 = 1 and a depth along the light: metres past the plane's centre for a
/// directional light, from the light for others.
fn point(space: &LightSpace, at: DVec2, depth: f64) -> DVec3 {
    let along = if space.directional { at.extend(depth) } else { (at * depth).extend(depth) - space.offset };
    space.center + space.axes[0] * along.x + space.axes[1] * along.y + space.axes[2] * along.z
}

impl<'a> Kept<'a> {
    /// What lies in the hull of the ends of tiles, four points each, and of single points, as far as the square of the map
    /// `h` holds it: the [`reach`] and the covers of several frames.
    pub fn of_reach(space: &LightSpace, h: &DMat3, ends: &[DVec3], points: &[DVec3]) -> Kept<'a> {
        let (p1, p2, p4) = (h.row(0), h.row(1), h.row(2));
        let grown = 1.0 + BORDER;
        let planes = [p1 + p4 * BORDER, p4 * grown - p1, p2 + p4 * BORDER, p4 * grown - p2, p4].map(|p| p.extend(0.0));
        let mut polygon = Polygon::default();
        let mut found: Vec<DVec4> = Vec::new();
        let mut hold = |corners: [DVec3; 3]| {
            polygon.clip(corners.map(|p| vector(space, p)), &planes);
            let over_w = |v: &DVec4| *v / p4.dot(v.truncate());
            found.extend(polygon.corners.iter().map(over_w).filter(|v| v.is_finite() && p4.dot(v.truncate()) > 0.0));
        };
        for end in ends.chunks_exact(4) {
            hold([end[0], end[1], end[2]]);
            hold([end[0], end[2], end[3]]);
        }
        points.iter().for_each(|p| hold([*p; 3]));
        let mean = found.iter().fold(DVec4::ZERO, |s, v| s + *v / found.len() as f64);
        // 1/w falls with the distance from a lamp: half of it is left, so that a widened far end stays in front of infinity.
        let one = constant(space);
        let widened = |v: &DVec4| {
            let (here, falls) = (one.dot(*v), one.dot(mean) - one.dot(*v));
            let part = if falls * WIDENED > 0.5 * here { 0.5 * here / falls } else { WIDENED };
            mean + (*v - mean) * (1.0 + part)
        };
        Kept::of_points(space, h, found.iter().map(widened).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::depth::{RowKind, fit_row};
    use crate::scene::{Geometry, LightKind, Triangle};
    use crate::visibility::Bvh;
    use glam::Vec3;

    /// Rolling ground, and triangles above it.
    fn triangles() -> Vec<Triangle> {
        let at = |i: u32, k: u32| {
            let (x, z) = (i as f32 * 0.5 - 5.0, k as f32 * 0.5 - 5.0);
            Vec3::new(x, (x * 1.3).sin() * 0.4 + (z * 0.9).cos() * 0.3, z)
        };
        let cells = (0..20).flat_map(|i| (0..20).map(move |k| (i, k)));
        let ground = cells.flat_map(|(i, k)| {
            [[at(i, k), at(i + 1, k), at(i, k + 1)], [at(i + 1, k), at(i + 1, k + 1), at(i, k + 1)]]
        });
        let above = (0..30_u16).map(|i| {
            let f = f32::from(i);
            let p = Vec3::new((f * 1.7).sin() * 3.0, 1.0 + (f * 0.61).sin().abs() * 2.0, (f * 2.3).cos() * 3.0);
            [p, p + Vec3::new(0.5, 0.1, 0.1), p + Vec3::new(0.1, 0.2, 0.6)]
        });
        ground.chain(above).collect()
    }

    #[test]
    fn a_row_over_the_reach_holds_receivers_and_casters() {
        let triangles = triangles();
        let bvh = Bvh::build(&triangles);
        let tracer = Tracer::new(Geometry::plain(&triangles, &[]), &bvh, None);
        let ground: Vec<DVec3> =
            triangles[..800].iter().map(|t| t.iter().map(|v| v.as_dvec3()).sum::<DVec3>() / 3.0).collect();
        let cover: Vec<DVec3> = ground.iter().copied().filter(|p| p.length() < 3.0).collect();
        for kind in [
            LightKind::Directional { direction: DVec3::new(0.4, -1.0, 0.2).normalize() },
            LightKind::Point { position: DVec3::new(2.0, 9.0, -3.0), range: None },
        ] {
            let light = Light { name: "l".into(), kind };
            let ends = reach(&tracer, &light, &cover, &Visible::new(&ground));
            assert!(!ends.is_empty() && ends.len().is_multiple_of(4));
            let space = LightSpace::around(&light, &cover).unwrap();
            // A map of the box of the cover, warped a little.
            let flat: Vec<DVec2> = cover.iter().map(|p| space.q(*p)).map(|q| q.truncate() / q.z).collect();
            let low = flat.iter().fold(DVec2::INFINITY, |m, p| m.min(*p));
            let size = flat.iter().fold(DVec2::NEG_INFINITY, |m, p| m.max(*p)) - low;
            let p4 = DVec3::new(0.1 / size.x, 0.0, 1.0 - 0.1 * low.x / size.x);
            let rows = [DVec3::new(1.0 / size.x, 0.0, -low.x / size.x), DVec3::new(0.0, 1.0 / size.y, -low.y / size.y)];
            let h = DMat3::from_cols(rows[0], rows[1], p4).transpose();
            let row = fit_row(&Kept::of_reach(&space, &h, &ends, &cover), RowKind::Free).unwrap();
            let m = space.clip_from_scene(&h, row.row);
            let in_square = |p: &DVec3| {
                let clip = m * p.extend(1.0);
                let uv = clip.truncate().truncate() / clip.w;
                clip.w > 0.0 && uv.cmpge(DVec2::ZERO).all() && uv.cmple(DVec2::ONE).all()
            };
            let held = |p: &DVec3| {
                let clip = m * p.extend(1.0);
                (clip.z / clip.w).abs() <= 1.0
            };
            // Every receiver that looks the map up, and every caster over tiles that hold some: here all.
            let casters = triangles[800..].iter().flatten().map(|v| v.as_dvec3());
            let asked: Vec<DVec3> = ground.iter().copied().chain(casters).filter(in_square).collect();
            assert!(asked.len() > 300 && asked.iter().all(held), "{}", asked.len());
            // A far larger map, as long as the rings hold it: receivers outside the cover are held too.
            let wide = DMat3::from_diagonal(DVec3::new(0.25, 0.25, 1.0)) * h
                + DMat3::from_cols(DVec3::ZERO, DVec3::ZERO, DVec3::new(0.375, 0.375, 0.0));
            let row = fit_row(&Kept::of_reach(&space, &wide, &ends, &cover), RowKind::Plain);
            assert!(row.is_ok_and(|row| row.far_m > row.near_m));
        }
    }

    #[test]
    fn nothing_covered_reaches_nowhere() {
        let triangles = triangles();
        let bvh = Bvh::build(&triangles);
        let tracer = Tracer::new(Geometry::plain(&triangles, &[]), &bvh, None);
        let light = Light { name: "l".into(), kind: LightKind::Directional { direction: DVec3::NEG_Y } };
        assert!(reach(&tracer, &light, &[], &Visible::new(&[DVec3::ZERO])).is_empty());
        // A single point: a map without extent still has a depth.
        let one = [DVec3::new(0.1, 0.0, 0.1)];
        let ends = reach(&tracer, &light, &one, &Visible::new(&one));
        assert!(ends.iter().all(|p| p.is_finite()));
    }
}
