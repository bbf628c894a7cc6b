//! The viewer, standing slightly above the floor, goes once around the objects in 28 frames; the sun is for plans, the
//! experiments bring lights of their own.

use super::authoring::document::{Content, Document, Keys, Placement, units};
use super::authoring::pose::{frame_time_s, looking};
use super::authoring::schema;
use glam::{DVec3, dvec3};
use std::f64::consts::TAU;

const FRAMES: u32 = 28;
const EYE_M: f64 = 1.7;
const DISTANCE_M: f64 = 11.5;
/// What the viewer looks at.
const TARGET: DVec3 = dvec3(0.0, 0.6, 0.0);
/// From which the sun shines.
const SUN_AT: DVec3 = dvec3(14.0, 16.0, 9.0);

/// The node of the camera.
pub(super) fn camera(doc: &mut Document) -> usize {
    let perspective =
        schema::Perspective { aspect_ratio: 1.0, yfov: units(45_f64.to_radians()), znear: 0.125, zfar: 80.0 };
    let camera = doc.camera(schema::Camera { name: "viewer", kind: "perspective", perspective });
    let seen = |frame: u32| {
        let (sin, cos) = (TAU * f64::from(frame - 1) / f64::from(FRAMES)).sin_cos();
        let position = dvec3(DISTANCE_M * cos, EYE_M, DISTANCE_M * sin);
        (position, looking(position, TARGET))
    };
    let times: Vec<f64> = (1..=FRAMES).map(|frame| frame_time_s(f64::from(frame))).collect();
    let (positions, rotations): (Vec<_>, Vec<_>) = (1..=FRAMES).map(seen).unzip();
    let place = Placement { translation: positions[0], rotation: rotations[0], ..Placement::default() };
    let node = doc.node("viewer", Content::Camera(camera), place, vec![]);
    doc.animate(
        node,
        &times,
        Keys::Translation(positions.into_iter().map(|p| [DVec3::ZERO, p, DVec3::ZERO]).collect()),
    );
    doc.animate(node, &times, Keys::Rotation(rotations));
    node
}

/// The node of the sun.
pub(super) fn sun(doc: &mut Document) -> usize {
    let light = doc.light(schema::Light {
        name: "sun",
        kind: "directional",
        color: [1.0, 0.95, 0.9],
        intensity: units(10_000.0),
        range: None,
        spot: None,
    });
    let place = Placement { translation: SUN_AT, rotation: looking(SUN_AT, DVec3::ZERO), ..Placement::default() };
    doc.node("sun", Content::Light(light), place, vec![])
}
