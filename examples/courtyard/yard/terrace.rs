//! The ground with a path, the terrace along the north side, its stair and its balustrade.

use super::authoring::document::{Content, Document, Placement};
use super::authoring::mesh::{Mesh, cuboid, lathe, rounded, sheet};
use super::{FOOTING_M, Palette, TERRACE_M};
use glam::{DMat4, DVec2, DVec3, dvec2, dvec3};
use lixel::math::Prng;

/// Front edge of the terrace, and where its back wall hides it.
const FRONT_Z: f64 = -6.2;
const BACK_Z: f64 = -11.2;
const HALF_WIDTH: f64 = 11.3;

/// The stair: steps below the terrace, their depth, half its width between the cheek walls.
const STEPS: usize = 6;
const TREAD: f64 = 0.36;
const STAIR_HALF_WIDTH: f64 = 4.0;

pub(super) fn build(doc: &mut Document, palette: &Palette) -> usize {
    let ground = doc.mesh("ground", palette.paving, &ground());
    let path = doc.mesh("flagstones", palette.stone, &path());
    let body = doc.mesh("terrace", palette.stone, &terrace());
    let stair = doc.mesh("stair", palette.stone, &stair());
    let side = doc.mesh("stair cheek and rails", palette.stone, &side());
    let baluster = doc.mesh("baluster", palette.stone, &baluster());
    let urn = doc.mesh("urn", palette.stone, &urn());

    // The right side, and the same again mirrored.
    let mut sides = Vec::new();
    for (name, mirror) in [("east", 1.0), ("west", -1.0)] {
        let mut parts = vec![doc.node(format!("{name} cheek"), Content::Mesh(side), Placement::default(), vec![])];
        for i in 0..26 {
            let place = Placement::at(4.78 + 0.25 * f64::from(i), TERRACE_M + 0.1, FRONT_Z - 0.25);
            parts.push(doc.node(format!("{name} baluster {}", i + 1), Content::Mesh(baluster), place, vec![]));
        }
        parts.push(doc.node(format!("{name} urn"), Content::Mesh(urn), Placement::at(4.25, 1.37, -4.0), vec![]));
        // A slimmer urn where the rail ends.
        let slim = Placement { scale: dvec3(0.8, 0.9, 0.8), ..Placement::at(11.1, TERRACE_M + 0.92, FRONT_Z - 0.25) };
        parts.push(doc.node(format!("{name} end urn"), Content::Mesh(urn), slim, vec![]));
        let place = Placement { scale: dvec3(mirror, 1.0, 1.0), ..Placement::default() };
        sides.push(doc.node(format!("{name} balustrade"), Content::Group, place, parts));
    }
    let mut children = vec![
        doc.node("ground", Content::Mesh(ground), Placement::default(), vec![]),
        doc.node("path", Content::Mesh(path), Placement::default(), vec![]),
        doc.node("terrace body", Content::Mesh(body), Placement::default(), vec![]),
        doc.node("stair", Content::Mesh(stair), Placement::default(), vec![]),
    ];
    children.extend(sides);
    doc.node("terrace", Content::Group, Placement::default(), children)
}

/// The ground at a place, `above` it. Slopes reach 3 degrees, which a sun at 12 degrees shows well.
fn on_ground(x: f64, z: f64, above: f64) -> DVec3 {
    let long = 0.020 * (0.9 * x + 0.4 * z).sin() + 0.015 * (0.5 * x - 1.1 * z + 1.0).sin();
    dvec3(x, above + long + 0.008 * (2.1 * x + 1.7 * z).sin(), z)
}

/// 30 m x 24 m, gently uneven.
fn ground() -> Mesh {
    let (columns, rows, cell) = (60, 48, 0.5);
    let point = |i: i32, j: i32| on_ground(-15.0 + cell * f64::from(i), -12.0 + cell * f64::from(j), 0.0);
    let line = |i| (0..=rows).map(|j| point(i, j)).collect();
    sheet(&(0..=columns).map(line).collect::<Vec<_>>())
}

/// Flagstones on the axis of the stair, none quite level with the next: low steps that cast thin shadows.
fn path() -> Mesh {
    let (across, along, width, depth) = (4, 22, 0.8, 0.7);
    let mut random = Prng::seeded(3);
    let mut mesh = Mesh::default();
    for i in 0..across {
        for j in 0..along {
            let (x, z) = (width * f64::from(i - across / 2), -3.7 + depth * f64::from(j));
            let top = random.between(0.018, 0.032);
            // Corners of the slab at an inset from its cell, counter-clockwise seen from above.
            let ring = |inset: f64, above: f64| {
                let (a, b, c, d) = (x + inset, x + width - inset, z + inset, z + depth - inset);
                [(a, c), (a, d), (b, d), (b, c)].map(|(x, z)| on_ground(x, z, above)).to_vec()
            };
            let sides = [ring(0.012, -0.03), ring(0.012, top - 0.008), ring(0.022, top)];
            mesh.add_rings(&sides, true);
            let lid = ring(0.022, top);
            mesh.add_quad([lid[0], lid[1], lid[2], lid[3]]);
        }
    }
    mesh
}

fn terrace() -> Mesh {
    let mut mesh = cuboid(dvec3(-HALF_WIDTH, -0.2, BACK_Z), dvec3(HALF_WIDTH, TERRACE_M, FRONT_Z));
    // A string course under the balustrades.
    for side in [-1.0, 1.0] {
        let (a, b) = (4.4 * side, (HALF_WIDTH + 0.05) * side);
        mesh.add_box(dvec3(a.min(b), 0.93, FRONT_Z - 0.2), dvec3(a.max(b), TERRACE_M + 0.015, FRONT_Z + 0.06));
    }
    mesh
}

/// Six steps with rounded nosings as one sheet; its ends are inside the cheek walls.
fn stair() -> Mesh {
    let rise = TERRACE_M / (STEPS as f64 + 1.0);
    let mut profile = Vec::new();
    for i in 0..STEPS {
        let front = FRONT_Z + TREAD * (STEPS - i) as f64;
        let top = rise * (i as f64 + 1.0);
        let foot = if i == 0 { -FOOTING_M } else { top - rise };
        let nosing = [(0.0, foot), (0.0, top - 0.045), (0.022, top - 0.035), (0.025, top - 0.012), (0.015, top)];
        profile.extend(nosing.map(|(out, y)| (front + out, y)));
    }
    profile.push((FRONT_Z, rise * STEPS as f64));
    let half = STAIR_HALF_WIDTH + 0.05;
    let line = |&(z, y): &(f64, f64)| vec![dvec3(-half, y, z), dvec3(half, y, z)];
    sheet(&profile.iter().map(line).collect::<Vec<_>>())
}

/// The cheek wall east of the stair with its capstone, and the rails of the balustrade.
fn side() -> Mesh {
    let (near, far) = (STAIR_HALF_WIDTH, STAIR_HALF_WIDTH + 0.5);
    let mut mesh = cuboid(dvec3(near, -0.2, FRONT_Z - 0.5), dvec3(far, 1.3, -3.7));
    mesh.add_box(dvec3(near - 0.05, 1.28, FRONT_Z - 0.55), dvec3(far + 0.05, 1.38, -3.65));
    let middle = FRONT_Z - 0.25;
    for (foot, height, depth) in [(0.0, 0.12, 0.24), (0.72, 0.13, 0.28)] {
        let min = dvec3(far - 0.1, TERRACE_M + foot, middle - 0.5 * depth);
        mesh.add_box(min, dvec3(11.2, TERRACE_M + foot + height, middle + 0.5 * depth));
    }
    mesh.add_box(dvec3(10.92, TERRACE_M - 0.1, middle - 0.18), dvec3(11.28, TERRACE_M + 0.93, middle + 0.18));
    mesh
}

fn baluster() -> Mesh {
    let outline = [(0.075, 0.0), (0.06, 0.06), (0.05, 0.1), (0.085, 0.22), (0.07, 0.34), (0.035, 0.5), (0.065, 0.63)];
    lathe(&rounded(&outline.map(DVec2::from), 2), 8)
}

/// A vase with a curved lip, 0.75 m high.
fn urn() -> Mesh {
    let mut mesh = Mesh::default();
    mesh.add_block(dvec3(0.0, 0.04, 0.0), dvec3(0.34, 0.1, 0.34));
    let outline = [
        dvec2(0.15, 0.08),
        dvec2(0.13, 0.12),
        dvec2(0.06, 0.19),
        dvec2(0.14, 0.26),
        dvec2(0.235, 0.40),
        dvec2(0.205, 0.56),
        dvec2(0.18, 0.63),
        dvec2(0.235, 0.71),
        dvec2(0.25, 0.74),
        dvec2(0.23, 0.75),
        dvec2(0.15, 0.65),
        dvec2(0.17, 0.50),
        dvec2(0.0, 0.45),
    ];
    mesh.add(&lathe(&rounded(&outline, 2), 24), DMat4::IDENTITY);
    mesh
}
