//! Domains between the plan's words and the predicate that evaluates them.

use glam::{DVec2, DVec3, DVec4};

use super::{CubeFace, Domain};
use crate::math;

/// By axis, then negative and positive side.
const FACES: [[CubeFace; 2]; 3] = [
    [CubeFace::NegativeX, CubeFace::PositiveX],
    [CubeFace::NegativeY, CubeFace::PositiveY],
    [CubeFace::NegativeZ, CubeFace::PositiveZ],
];

/// A domain as a plan writes it. Ends of a view depth that are infinite are left out.
pub(super) fn written(domain: &math::Domain) -> Domain {
    match domain {
        math::Domain::All => Domain::All,
        math::Domain::HalfSpace { plane } => Domain::HalfSpace { plane: plane.to_array() },
        math::Domain::ViewDepth { position, forward, from_m, to_m } => Domain::ViewDepth {
            position: position.to_array(),
            forward: forward.to_array(),
            from: from_m.is_finite().then_some(*from_m),
            to: to_m.is_finite().then_some(*to_m),
        },
        math::Domain::LightPlaneRectangle { plane_from_scene, min, max } => Domain::LightPlaneRectangle {
            plane_from_world: plane_from_scene.map(|row| row.to_array()),
            min: min.to_array(),
            max: max.to_array(),
        },
        math::Domain::LightPlanePolygon { plane_from_scene, sides } => Domain::LightPlanePolygon {
            plane_from_world: plane_from_scene.map(|row| row.to_array()),
            sides: sides.iter().map(|side| side.to_array()).collect(),
        },
        math::Domain::CubeFace { position, axes, axis, positive } => Domain::CubeFace {
            position: position.to_array(),
            axes: axes.map(|a| a.to_array()),
            face: FACES[*axis][usize::from(*positive)],
        },
        math::Domain::Intersection(all) => Domain::Intersection { of: all.iter().map(written).collect() },
    }
}

/// A plan's domain as a predicate.
pub(super) fn read(domain: &Domain) -> math::Domain {
    let rows = |rows: &[[f64; 4]; 3]| rows.map(DVec4::from_array);
    match domain {
        Domain::All => math::Domain::All,
        Domain::HalfSpace { plane } => math::Domain::HalfSpace { plane: DVec4::from_array(*plane) },
        Domain::ViewDepth { position, forward, from, to } => math::Domain::ViewDepth {
            position: DVec3::from_array(*position),
            forward: DVec3::from_array(*forward),
            from_m: from.unwrap_or(f64::NEG_INFINITY),
            to_m: to.unwrap_or(f64::INFINITY),
        },
        Domain::LightPlaneRectangle { plane_from_world, min, max } => math::Domain::LightPlaneRectangle {
            plane_from_scene: rows(plane_from_world),
            min: DVec2::from_array(*min),
            max: DVec2::from_array(*max),
        },
        Domain::LightPlanePolygon { plane_from_world, sides } => math::Domain::LightPlanePolygon {
            plane_from_scene: rows(plane_from_world),
            sides: sides.iter().map(|side| DVec3::from_array(*side)).collect(),
        },
        Domain::CubeFace { position, axes, face } => {
            let (axis, positive) = match face {
                CubeFace::PositiveX => (0, true),
                CubeFace::NegativeX => (0, false),
                CubeFace::PositiveY => (1, true),
                CubeFace::NegativeY => (1, false),
                CubeFace::PositiveZ => (2, true),
                CubeFace::NegativeZ => (2, false),
            };
            let axes = axes.map(DVec3::from_array);
            math::Domain::CubeFace { position: DVec3::from_array(*position), axes, axis, positive }
        }
        Domain::Intersection { of } => math::Domain::Intersection(of.iter().map(read).collect()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_reads_back_as_it_was() {
        let plane_from_scene = [DVec4::new(0.1, -0.3, 7.0, 1e-3), DVec4::Y, DVec4::W];
        let tile =
            math::Domain::LightPlaneRectangle { plane_from_scene, min: DVec2::new(-0.25, 1e-9), max: DVec2::ONE };
        let half = math::Domain::HalfSpace { plane: DVec4::new(0.6, 0.0, -0.8, 12.5) };
        let (position, forward) = (DVec3::new(1.0, 2.0, -3.0), DVec3::NEG_Z);
        let depth = |from_m, to_m| math::Domain::ViewDepth { position, forward, from_m, to_m };
        let all = [
            math::Domain::All,
            half.clone(),
            depth(f64::NEG_INFINITY, 4.0),
            depth(4.0, 9.5),
            depth(9.5, f64::INFINITY),
            tile.clone(),
            math::Domain::LightPlanePolygon { plane_from_scene, sides: vec![DVec3::X, DVec3::new(-1.0, 0.5, 2.0)] },
            math::Domain::CubeFace { position, axes: DVec3::AXES, axis: 2, positive: false },
            math::Domain::Intersection(vec![half, tile]),
        ];
        for domain in all {
            let text = serde_json::to_string(&written(&domain)).unwrap();
            let again: Domain = serde_json::from_str(&text).unwrap();
            assert_eq!(read(&again), domain, "{text}");
        }
    }
}
