//! The arcade on the terrace: eight columns, seven arches, rafters, and the lantern that holds the light `lamp`.

use super::authoring::document::{Content, Document, Placement, units};
use super::authoring::mesh::{Mesh, lathe, rounded, sheet, tube};
use super::authoring::schema;
use super::{Palette, TERRACE_M};
use glam::{DMat4, DVec2, DVec3, dvec2, dvec3};
use std::f64::consts::PI;

const BAY: f64 = 3.0;
const COLUMNS: u32 = 8;
const ROW_Z: f64 = -7.3;
const COLUMN_HEIGHT: f64 = 2.75;
const ARCH_RADIUS: f64 = 1.2;
/// From the springing of an arch to the top of its wall.
const ARCH_RISE: f64 = 1.65;
/// Half the thickness of the arches.
const ARCH_HALF: f64 = 0.25;
const RAFTER_Y: f64 = TERRACE_M + COLUMN_HEIGHT + 1.35;
/// Where the lamp hangs: in the middle bay, at two metres above the terrace.
const LAMP: DVec3 = dvec3(0.0, TERRACE_M + 2.1, -9.0);

pub(super) fn build(doc: &mut Document, palette: &Palette) -> usize {
    let column = doc.mesh("column", palette.stone, &column());
    let arch = doc.mesh("arch", palette.stone, &arch());
    let cornice = doc.mesh("cornice", palette.stone, &cornice());
    let rafters = doc.mesh("rafters", palette.wood, &rafters());

    let mut children = Vec::new();
    for i in 0..COLUMNS {
        let x = BAY * (f64::from(i) - 0.5 * f64::from(COLUMNS - 1));
        // The eastern columns are mirrored, the outermost ones stouter.
        let stout = if i == 0 || i == COLUMNS - 1 { 1.15 } else { 1.0 };
        let scale = dvec3(if x > 0.0 { -stout } else { stout }, 1.0, stout);
        let place = Placement { scale, ..Placement::at(x, 0.0, 0.0) };
        children.push(doc.node(format!("column {}", i + 1), Content::Mesh(column), place, vec![]));
    }
    for i in 0..COLUMNS - 1 {
        let x = BAY * (f64::from(i) - 0.5 * f64::from(COLUMNS - 2));
        let place = Placement::at(x, COLUMN_HEIGHT - 0.01, 0.0);
        children.push(doc.node(format!("arch {}", i + 1), Content::Mesh(arch), place, vec![]));
    }
    children.push(doc.node("cornice", Content::Mesh(cornice), Placement::at(0.0, COLUMN_HEIGHT, 0.0), vec![]));
    let row = doc.node("row", Content::Group, Placement::at(0.0, TERRACE_M, ROW_Z), children);
    let rafters = doc.node("rafters", Content::Mesh(rafters), Placement::default(), vec![]);
    let lantern = lantern(doc, palette);
    doc.node("arcade", Content::Group, Placement::default(), vec![row, rafters, lantern])
}

/// Plinth, base mouldings, a shaft with entasis, capital, abacus.
fn column() -> Mesh {
    let mut mesh = Mesh::default();
    mesh.add_box(dvec3(-0.31, -0.02, -0.31), dvec3(0.31, 0.12, 0.31));
    mesh.add_box(dvec3(-0.31, COLUMN_HEIGHT - 0.12, -0.31), dvec3(0.31, COLUMN_HEIGHT, 0.31));
    let torus = [(0.27, 0.11), (0.30, 0.15), (0.29, 0.19), (0.25, 0.205), (0.245, 0.23)].map(DVec2::from);
    let shaft =
        [(0.265, 0.25), (0.255, 0.275), (0.225, 0.30), (0.225, 0.9), (0.215, 1.6), (0.19, 2.36)].map(DVec2::from);
    let capital = [(0.19, 2.37), (0.215, 2.385), (0.21, 2.41), (0.19, 2.42), (0.195, 2.48), (0.28, 2.60), (0.27, 2.64)];
    let mut profile = rounded(&torus, 2);
    profile.extend(shaft);
    profile.extend(rounded(&capital.map(DVec2::from), 2));
    mesh.add(&lathe(&profile, 24), DMat4::IDENTITY);
    mesh
}

/// A semicircular arch in a piece of wall one bay wide, springing at y = 0, with a raised archivolt in front.
fn arch() -> Mesh {
    let pieces = 24;
    let arc = |radius: f64, z: f64| -> Vec<DVec3> {
        let point = |i| {
            let (sin, cos) = (PI * (1.0 - f64::from(i) / f64::from(pieces))).sin_cos();
            dvec3(radius * cos, radius * sin, z)
        };
        (0..=pieces).map(point).collect()
    };
    let edge = |y: f64, z: f64| [dvec3(-0.5 * BAY, y, z), dvec3(0.5 * BAY, y, z)];
    let lower = |z: f64| -> Vec<DVec3> {
        let [left, right] = edge(0.0, z);
        [vec![left], arc(ARCH_RADIUS, z), vec![right]].concat()
    };
    let upper = |z: f64| -> Vec<DVec3> { lower(z).into_iter().map(|p| dvec3(p.x, ARCH_RISE, z)).collect() };
    let (back, front, raised) = (-ARCH_HALF, ARCH_HALF, ARCH_HALF + 0.05);
    let mut mesh = sheet(&[lower(back), lower(front), upper(front)]);
    mesh.add(&sheet(&[upper(back), lower(back)]), DMat4::IDENTITY);
    let outer = ARCH_RADIUS + 0.17;
    let archivolt = [arc(ARCH_RADIUS, front), arc(ARCH_RADIUS, raised), arc(outer, raised), arc(outer, front)];
    mesh.add(&sheet(&archivolt), DMat4::IDENTITY);
    mesh
}

/// What lies on the arches, and closes their row at both ends.
fn cornice() -> Mesh {
    let mut mesh = Mesh::default();
    let end = 0.5 * BAY * f64::from(COLUMNS - 1);
    for side in [-1.0, 1.0] {
        let size = dvec3(0.34, ARCH_RISE, 2.0 * ARCH_HALF + 0.02);
        mesh.add_block(dvec3(side * (end + 0.16), 0.5 * ARCH_RISE, 0.0), size);
    }
    for (y, height, out) in [(1.63, 0.1, 0.05), (1.72, 0.08, 0.11), (1.79, 0.12, 0.18)] {
        let size = dvec3(2.0 * (end + 0.33 + out), height, 2.0 * (ARCH_HALF + out));
        mesh.add_block(dvec3(0.0, y + 0.5 * height, 0.0), size);
    }
    mesh
}

/// Beams from the arches to the back wall, and thin laths across them.
fn rafters() -> Mesh {
    let mut mesh = Mesh::default();
    for i in -14..=14 {
        let x = 0.75 * f64::from(i);
        mesh.add_box(dvec3(x - 0.05, RAFTER_Y, -11.1), dvec3(x + 0.05, RAFTER_Y + 0.16, ROW_Z - ARCH_HALF + 0.1));
    }
    for i in 0..8 {
        let z = -10.8 + 0.45 * f64::from(i);
        mesh.add_box(dvec3(-10.9, RAFTER_Y + 0.15, z - 0.02), dvec3(10.9, RAFTER_Y + 0.19, z + 0.02));
    }
    mesh
}

/// A hexagonal cage on a rod; the point light shines in its middle.
fn lantern(doc: &mut Document, palette: &Palette) -> usize {
    let mut cage = Mesh::default();
    let roof = [(0.17, 0.17), (0.19, 0.18), (0.17, 0.20), (0.08, 0.28), (0.03, 0.31), (0.0, 0.33)].map(DVec2::from);
    cage.add(&lathe(&[&[dvec2(0.0, 0.17)], &roof[..]].concat(), 12), DMat4::IDENTITY);
    let foot =
        [(0.0, -0.24), (0.05, -0.22), (0.10, -0.19), (0.12, -0.18), (0.12, -0.16), (0.0, -0.15)].map(DVec2::from);
    cage.add(&lathe(&foot, 12), DMat4::IDENTITY);
    for i in 0..6 {
        let (sin, cos) = (PI * (f64::from(i) + 0.5) / 3.0).sin_cos();
        let bar = [(dvec3(0.11 * cos, -0.17, 0.11 * sin), 0.005), (dvec3(0.155 * cos, 0.18, 0.155 * sin), 0.005)];
        cage.add(&tube(&bar, 4), DMat4::IDENTITY);
    }
    let rod = [(dvec3(0.0, 0.3, 0.0), 0.008), (dvec3(0.0, RAFTER_Y + 0.02 - LAMP.y, 0.0), 0.008)];
    cage.add(&tube(&rod, 6), DMat4::IDENTITY);
    let cage = doc.mesh("lantern", palette.iron, &cage);
    let lamp = doc.light(schema::Light {
        name: "lamp",
        kind: "point",
        color: [1.0, 0.72, 0.42],
        intensity: units(220.0),
        range: Some(16.0),
        spot: None,
    });
    let lamp = doc.node("lamp", Content::Light(lamp), Placement::default(), vec![]);
    doc.node("lantern", Content::Mesh(cage), Placement { translation: LAMP, ..Placement::default() }, vec![lamp])
}
