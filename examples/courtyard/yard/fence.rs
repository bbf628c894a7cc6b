//! The wrought-iron fence along the west side: eight panels of ten bars, 2 cm thick, and a gate that swings.

use super::authoring::document::{Content, Document, Keys, Placement};
use super::authoring::mesh::{Mesh, cuboid, lathe, rounded, tube};
use super::authoring::pose::frame_time_s;
use super::{FOOTING_M, Palette};
use glam::{DMat4, DQuat, DVec2, DVec3, dvec3};
use std::f64::consts::FRAC_PI_2;

const FENCE_X: f64 = -8.2;
const SOUTH_END_Z: f64 = 10.1;
const PANEL: f64 = 1.5;
const GATE: f64 = 1.4;
const BARS: u32 = 10;
/// Thickness of a bar.
const BAR: f64 = 0.02;
/// Top of the kerb the panels stand on.
const KERB: f64 = 0.18;

/// The gate's swing: frame, degrees from closed.
const SWING: [(f64, f64); 5] = [(1.0, 18.0), (25.0, 62.0), (45.0, 74.0), (70.0, 40.0), (90.0, 12.0)];

pub(super) fn build(doc: &mut Document, palette: &Palette) -> usize {
    let panel = doc.mesh("fence panel", palette.iron, &panel());
    let post = doc.mesh("fence post", palette.stone, &post());
    let kerb = cuboid(dvec3(-0.1, -0.2, -0.16), dvec3(4.0 * PANEL + 0.1, KERB, 0.16));
    let kerb = doc.mesh("kerb", palette.stone, &kerb);

    // Along the fence x runs north: a turn about y by 90 degrees.
    let mut children = Vec::new();
    for (half, start) in [("south", 0.0), ("north", 4.0 * PANEL + GATE)] {
        children.push(doc.node(format!("{half} kerb"), Content::Mesh(kerb), Placement::at(start, 0.0, 0.0), vec![]));
        for i in 0..4 {
            let place = Placement::at(start + PANEL * f64::from(i), KERB, 0.0);
            children.push(doc.node(format!("{half} panel {}", i + 1), Content::Mesh(panel), place, vec![]));
        }
        for (end, x) in [("south", start), ("north", start + 4.0 * PANEL)] {
            let place = Placement::at(x, -FOOTING_M, 0.0);
            children.push(doc.node(format!("{half} half, {end} post"), Content::Mesh(post), place, vec![]));
        }
    }
    children.push(gate(doc, palette));
    let rotation = DQuat::from_rotation_y(FRAC_PI_2);
    let place = Placement { rotation, ..Placement::at(FENCE_X, 0.0, SOUTH_END_Z) };
    doc.node("fence", Content::Group, place, children)
}

/// One square bar with a spear head.
fn bar(height: f64) -> Mesh {
    // The radius of a square's corner is its side over the root of two.
    let corner = BAR * std::f64::consts::FRAC_1_SQRT_2;
    let profile = [(corner, 0.0), (corner, height - 0.16), (2.2 * corner, height - 0.12), (0.0, height)];
    lathe(&profile.map(DVec2::from), 4)
}

fn panel() -> Mesh {
    let mut mesh = Mesh::default();
    for i in 0..BARS {
        let x = PANEL * (f64::from(i) + 0.5) / f64::from(BARS);
        mesh.add(&bar(1.75), DMat4::from_translation(dvec3(x, -0.02, 0.0)));
    }
    for y in [0.16, 1.42] {
        mesh.add_block(dvec3(0.5 * PANEL, y, 0.0), dvec3(PANEL, 0.03, 0.012));
    }
    mesh
}

/// A stone post with a ball.
fn post() -> Mesh {
    let mut mesh = cuboid(dvec3(-0.17, -0.1, -0.17), dvec3(0.17, 2.05, 0.17));
    mesh.add_block(dvec3(0.0, 2.08, 0.0), dvec3(0.44, 0.1, 0.44));
    let ball = [(0.08, 2.12), (0.07, 2.16), (0.13, 2.22), (0.16, 2.31), (0.11, 2.42), (0.0, 2.46)];
    mesh.add(&lathe(&rounded(&ball.map(DVec2::from), 2), 20), DMat4::IDENTITY);
    mesh
}

/// The gate, hinged at its south end, opening into the court; the only thing in the scene that moves.
fn gate(doc: &mut Document, palette: &Palette) -> usize {
    let (left, right, bottom, top) = (0.04, GATE - 0.40, 0.08, 1.72);
    let mut mesh = Mesh::default();
    for x in [left, right] {
        mesh.add_box(dvec3(x - 0.02, bottom, -0.02), dvec3(x + 0.02, top, 0.02));
    }
    for y in [bottom + 0.02, 0.5 * (bottom + top), top - 0.02] {
        mesh.add_box(dvec3(left, y - 0.018, -0.014), dvec3(right, y + 0.018, 0.014));
    }
    for i in 1..8 {
        let x = left + (right - left) * f64::from(i) / 8.0;
        mesh.add(&bar(1.78), DMat4::from_translation(dvec3(x, 0.09, 0.0)));
    }
    let brace = [(dvec3(left, bottom + 0.05, 0.0), 0.012), (dvec3(right, 0.5 * (bottom + top), 0.0), 0.012)];
    mesh.add(&tube(&brace, 6), DMat4::IDENTITY);
    let mesh = doc.mesh("gate", palette.iron, &mesh);
    // The hinge stands clear of the post's face.
    let place = Placement::at(4.0 * PANEL + 0.17, 0.0, 0.0);
    let gate = doc.node("gate", Content::Mesh(mesh), place, vec![]);
    let turn = |(_, degrees): (f64, f64)| DQuat::from_axis_angle(DVec3::NEG_Y, degrees.to_radians());
    doc.animate(gate, &SWING.map(|(frame, _)| frame_time_s(frame)), Keys::Rotation(SWING.map(turn).to_vec()));
    gate
}
