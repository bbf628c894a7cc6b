//! Whether a map would hold the same depths in two frames, decided from the scene.
//!
//! A map's content is that of the triangles that can reach it. The still ones are the same in all frames; of the moving
//! ones those whose projections overlap the map's square are written down, vertex by vertex, and hashed. Two frames with
//! the same light and the same hash draw the same map, and whoever looks it up stands where it stood: a receiver inside
//! the square is one of these triangles.

use crate::math::{LightSpace, convex_hull};
use crate::methods::Region;
use crate::scene::{Geometry, Light, Room};
use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

/// Moving triangles placed at a time.
const RUN: usize = 4096;

/// What moves in a map, in one frame: a SHA-256 of the triangles; all zero for none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
pub struct Content([u8; 32]);

impl Content {
    /// Nothing that moves during the shot stands in the map.
    pub fn is_still(&self) -> bool {
        *self == Content::default()
    }

    /// Of moving triangles that may reach a map; `reaches` errs towards true.
    pub fn of(geometry: Geometry<'_>, reaches: impl Fn(&[DVec3; 3]) -> bool) -> Content {
        let mut hasher = Sha256::new();
        let mut any = false;
        let mut room = Room::default();
        for run in geometry.moving_runs(RUN) {
            for triangle in run.triangles(&mut room) {
                if reaches(&triangle.map(|v| v.as_dvec3())) {
                    any = true;
                    for bits in triangle.iter().flat_map(|v| v.to_array()).map(f32::to_bits) {
                        hasher.update(bits.to_le_bytes());
                    }
                }
            }
        }
        if any { Content(hasher.finalize().into()) } else { Content::default() }
    }

    /// Of the maps of some regions.
    pub fn in_maps(geometry: Geometry<'_>, regions: &[Region]) -> Content {
        Content::of(geometry, |corners| {
            regions.iter().any(|region| {
                let clip = corners.map(|p| region.h * region.space.q(p));
                // All corners beyond one side of the square, or behind the light.
                let all = |outside: &dyn Fn(DVec3) -> bool| clip.iter().all(|c| outside(*c));
                let beyond = all(&|c| c.x < 0.0) || all(&|c| c.x > c.z) || all(&|c| c.y < 0.0) || all(&|c| c.y > c.z);
                !(beyond || all(&|c| c.z <= 0.0))
            })
        })
    }
}

/// Before there is a map: the moving triangles whose projections overlap the box of what has to be covered.
pub fn content(geometry: Geometry<'_>, light: &Light, cover: &[DVec3]) -> Content {
    let Ok(space) = LightSpace::around(light, cover) else {
        return Content::of(geometry, |_| !cover.is_empty());
    };
    let flat: Vec<DVec2> =
        cover.iter().map(|p| space.q(*p)).filter(|q| q.z > 0.0).map(|q| q.truncate() / q.z).collect();
    let hull = convex_hull(&flat);
    let low = hull.iter().fold(DVec2::INFINITY, |m, p| m.min(*p));
    let high = hull.iter().fold(DVec2::NEG_INFINITY, |m, p| m.max(*p));
    Content::of(geometry, |corners| {
        let q = corners.map(|p| space.q(p));
        if q.iter().all(|q| q.z <= 0.0) {
            return false;
        }
        let all = |outside: &dyn Fn(DVec3) -> bool| q.iter().all(|q| outside(*q));
        let beyond = all(&|q| q.x < low.x * q.z)
            || all(&|q| q.x > high.x * q.z)
            || all(&|q| q.y < low.y * q.z)
            || all(&|q| q.y > high.y * q.z);
        !beyond
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::LightKind;
    use glam::Vec3;

    #[test]
    fn content_changes_with_what_moves_under_the_light_and_with_nothing_else() {
        let sun = Light { name: "sun".into(), kind: LightKind::Directional { direction: DVec3::NEG_Y } };
        let cover: Vec<DVec3> =
            [(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)].map(|(x, z)| DVec3::new(x, 0.0, z)).into();
        let at = |x: f32| [[Vec3::new(x, 2.0, 1.0), Vec3::new(x + 1.0, 2.0, 1.0), Vec3::new(x, 2.0, 2.0)]];
        assert!(content(Geometry::plain(&[], &[]), &sun, &cover).is_still());
        assert!(content(Geometry::plain(&[], &at(9.0)), &sun, &cover).is_still(), "beside the map");
        let inside = content(Geometry::plain(&[], &at(1.0)), &sun, &cover);
        assert!(!inside.is_still());
        assert_eq!(inside, content(Geometry::plain(&[], &at(1.0)), &sun, &cover));
        assert_ne!(inside, content(Geometry::plain(&[], &at(1.000_001)), &sun, &cover));
        assert!(!content(Geometry::plain(&[], &at(-0.5)), &sun, &cover).is_still(), "across its border");
    }
}
