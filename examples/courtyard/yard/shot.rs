//! The shot: 90 frames at 24 a second from the fence to the stair, and the sun.

use super::authoring::document::{Content, Document, Keys, Placement, units};
use super::authoring::pose::{frame_time_s, looking};
use super::authoring::schema;
use glam::{DVec3, dvec3};

/// The shot ends with this frame.
pub(super) const LAST_FRAME: f64 = 90.0;

/// The camera's keys: frame, where it is, what it looks at.
const WALK: [(f64, DVec3, DVec3); 6] = [
    (1.0, dvec3(-5.4, 1.62, 11.2), dvec3(-2.7, 1.0, 0.0)),
    (18.0, dvec3(-4.9, 1.64, 9.2), dvec3(-0.3, 1.1, 0.0)),
    (36.0, dvec3(-4.2, 1.60, 6.8), dvec3(2.6, 1.1, 1.6)),
    (54.0, dvec3(-3.0, 1.64, 4.2), dvec3(2.4, 1.5, -2.6)),
    (72.0, dvec3(-1.8, 1.62, 1.6), dvec3(0.8, 2.0, -6.5)),
    (LAST_FRAME, dvec3(-0.9, 1.66, -0.5), dvec3(0.3, 2.3, -8.0)),
];

/// Height of the sun above the horizon, and the compass bearing its light travels to, from east (+x) to north (-z).
const SUN_HEIGHT_DEGREES: f64 = 12.0;
const SUN_BEARING_DEGREES: f64 = 24.0;

/// The node of the walking camera. Tangents are central differences, one-sided at the ends.
pub(super) fn camera(doc: &mut Document) -> usize {
    let camera = doc.camera(schema::Camera {
        name: "walk",
        kind: "perspective",
        perspective: schema::Perspective {
            aspect_ratio: units(16.0 / 9.0),
            yfov: units(48_f64.to_radians()),
            znear: 0.125,
            zfar: 100.0,
        },
    });
    let times = WALK.map(|(frame, ..)| frame_time_s(frame));
    let mut positions = Vec::new();
    for (i, &(_, position, _)) in WALK.iter().enumerate() {
        let (before, after) = (i.saturating_sub(1), (i + 1).min(WALK.len() - 1));
        let tangent = (WALK[after].1 - WALK[before].1) / (times[after] - times[before]);
        positions.push([tangent, position, tangent]);
    }
    let rotations = WALK.map(|(_, from, at)| looking(from, at));
    let place = Placement { translation: WALK[0].1, rotation: rotations[0], ..Placement::default() };
    let node = doc.node("walk", Content::Camera(camera), place, vec![]);
    doc.animate(node, &times, Keys::Translation(positions));
    doc.animate(node, &times, Keys::Rotation(rotations.to_vec()));
    node
}

/// The node of the sun: its light travels along its -z.
pub(super) fn sun(doc: &mut Document) -> usize {
    let (rise, level) = SUN_HEIGHT_DEGREES.to_radians().sin_cos();
    let (north, east) = SUN_BEARING_DEGREES.to_radians().sin_cos();
    let travels = dvec3(level * east, -rise, -level * north);
    let light = doc.light(schema::Light {
        name: "sun",
        kind: "directional",
        color: [1.0, 0.83, 0.62],
        intensity: units(12_000.0),
        range: None,
        spot: None,
    });
    // Somewhere up along the rays, for viewers that draw lights.
    let place =
        Placement { translation: -20.0 * travels, rotation: looking(-travels, DVec3::ZERO), ..Placement::default() };
    doc.node("sun", Content::Light(light), place, vec![])
}
