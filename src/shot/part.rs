//! What is kept of one light in one frame: enough to solve any interval of the shot that holds the frame.
//!
//! A few hundred edge samples (600 were enough in the first check, math note §9), and the vertices of the convex hull of
//! what the maps have to hold, as seen from the light. Film-resolution data of all frames could not be held at once.

use super::content::{Content, content};
use crate::math::{Domain, LightSpace, convex_hull};
use crate::measure::{Outside, Receivers};
use crate::samples::{EdgePoint, LightSamples};
use crate::scene::{Camera, Geometry, Light};
use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};

/// Most edge samples kept of a frame and light.
pub(super) const EDGES_KEPT: usize = 600;

/// One light of one frame.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct LightPart {
    /// The light, at the frame.
    pub light: Light,
    /// The camera of the frame.
    pub camera: Camera,
    /// Shadow edges, thinned evenly; their lengths keep their sum.
    pub edges: Vec<EdgePoint>,
    /// The points that maps have to hold: vertices of their hull as seen from the light.
    pub cover: Vec<DVec3>,
    /// How far maps have to reach along the light: see [`crate::depth::reach`]. As [`light_part`] leaves it, empty.
    pub reach: Vec<DVec3>,
    /// Receivers: pixels, or planning-grid positions where nothing is measured.
    pub facing: u64,
    /// Of them those that need a map.
    pub needed: u64,
    /// The moving triangles near what is covered.
    pub content: Content,
    /// Edge samples found.
    pub samples: u64,
    /// Rays cast.
    pub rays: u64,
}

/// Keeps of a light's samples what an interval needs. `film` holds every pixel's answer, where sizes are measured.
pub fn light_part(
    light: &Light,
    camera: &Camera,
    samples: &LightSamples,
    film: Option<&Receivers>,
    outside: Outside,
    geometry: Geometry<'_>,
) -> LightPart {
    let wanted_shadowed = outside == Outside::Lit;
    let (facing, shadowed) = match film {
        Some(film) => (film.len() as u64, film.shadowed_count()),
        None => (samples.facing, samples.shadowed),
    };
    let mut covered = film.map(|f| f.positions_where(wanted_shadowed)).unwrap_or_default();
    covered.extend_from_slice(&samples.covered);
    let cover = extremes_for_light(light, &covered);
    LightPart {
        light: light.clone(),
        camera: camera.clone(),
        edges: thinned(&samples.edges, EDGES_KEPT),
        content: content(geometry, light, &cover),
        cover,
        reach: Vec::new(),
        facing,
        needed: if wanted_shadowed { shadowed } else { facing - shadowed },
        samples: samples.edges.len() as u64,
        rays: samples.rays + film.map_or(0, |f| f.len() as u64),
    }
}

impl LightPart {
    /// A frame that a light is not on in, or that it is alone known of where it stands.
    pub fn blank(light: Light, camera: Camera) -> LightPart {
        LightPart {
            light,
            camera,
            edges: Vec::new(),
            cover: Vec::new(),
            reach: Vec::new(),
            facing: 0,
            needed: 0,
            content: Content::default(),
            samples: 0,
            rays: 0,
        }
    }
}

/// At most `count` of the edges, evenly spread, with lengths scaled to keep the sum.
pub(super) fn thinned(edges: &[EdgePoint], count: usize) -> Vec<EdgePoint> {
    if edges.len() <= count {
        return edges.to_vec();
    }
    let scale = edges.len() as f64 / count as f64;
    let kept = |k: usize| {
        let edge = edges[k * edges.len() / count];
        EdgePoint { length_px: edge.length_px * scale, ..edge }
    };
    (0..count).map(kept).collect()
}

/// Those of some points that span their hull as seen from a light. Around a point or spot light they are found in each
/// face of a cube apart: the hull of all is then spanned too, wherever they fit one half-space.
pub fn extremes_for_light(light: &Light, points: &[DVec3]) -> Vec<DVec3> {
    let Some(position) = light.position() else {
        return match LightSpace::around(light, points) {
            Ok(space) => extremes_in(&space, points),
            Err(_) => Vec::new(),
        };
    };
    let mut extremes = Vec::new();
    for face in 0..6 {
        let (axis, positive) = (face / 2, face % 2 == 0);
        let domain = Domain::CubeFace { position, axes: DVec3::AXES, axis, positive };
        let inside: Vec<DVec3> = points.iter().copied().filter(|p| domain.holds(*p)).collect();
        let direction = DVec3::AXES[axis] * if positive { 1.0 } else { -1.0 };
        extremes.extend(extremes_in(&LightSpace::perspective(position, direction, position + direction), &inside));
    }
    extremes
}

fn extremes_in(space: &LightSpace, points: &[DVec3]) -> Vec<DVec3> {
    let flat = |p: &DVec3| {
        let q = space.q(*p);
        (q.z > 0.0).then(|| q.truncate() / q.z)
    };
    let order = |a: &DVec2, b: &DVec2| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y));
    let mut hull = convex_hull(&points.iter().filter_map(flat).collect::<Vec<_>>());
    hull.sort_by(order);
    let mut taken = vec![false; hull.len()];
    let mut extremes = Vec::with_capacity(hull.len());
    for point in points {
        let Some(at) = flat(point) else { continue };
        if let Ok(i) = hull.binary_search_by(|h| order(h, &at))
            && !taken[i]
        {
            taken[i] = true;
            extremes.push(*point);
        }
    }
    extremes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::LightKind;

    fn grid() -> Vec<DVec3> {
        (0..400)
            .map(|i| DVec3::new(f64::from(i % 20) - 9.5, 0.01 * f64::from(i % 7), f64::from(i / 20) - 9.5))
            .collect()
    }

    #[test]
    fn extremes_span_the_hull_from_a_sun_and_all_sides_of_a_bulb() {
        let sun = Light { name: "sun".into(), kind: LightKind::Directional { direction: DVec3::NEG_Y } };
        let from_sun = extremes_for_light(&sun, &grid());
        assert_eq!(from_sun.len(), 4, "the corners of a square");
        let bulb =
            Light { name: "b".into(), kind: LightKind::Point { position: DVec3::new(0.0, 1.0, 0.0), range: None } };
        let from_bulb = extremes_for_light(&bulb, &grid());
        assert!(from_bulb.len() < 120, "{}", from_bulb.len());
        for side in [DVec3::X, DVec3::NEG_X, DVec3::Z, DVec3::NEG_Z] {
            let farthest = |points: &[DVec3]| points.iter().map(|p| p.dot(side)).fold(f64::MIN, f64::max);
            assert_eq!(farthest(&from_bulb), farthest(&grid()));
        }
    }

    #[test]
    fn thinning_keeps_the_length() {
        let edge = EdgePoint {
            film: [0.0; 2],
            position: DVec3::ZERO,
            derivatives: [DVec3::X, DVec3::Y],
            normal: DVec2::X,
            length_px: 0.7,
            room_px: 3.0,
            uncertain: false,
        };
        let kept = thinned(&vec![edge; 1001], 100);
        assert_eq!(kept.len(), 100);
        assert!((kept.iter().map(|e| e.length_px).sum::<f64>() - 700.7).abs() < 1e-9);
    }
}
