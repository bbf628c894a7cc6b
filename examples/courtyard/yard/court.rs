//! What stands in the court: a fountain, a table with two benches, pots.

use super::authoring::document::{Content, Document, Placement};
use super::authoring::mesh::{Mesh, lathe, rounded};
use super::{FOOTING_M, Palette};
use glam::{DMat4, DQuat, DVec2, dvec3};

pub(super) fn build(doc: &mut Document, palette: &Palette) -> usize {
    let fountain = fountain(doc, palette);
    let table = doc.mesh("table", palette.wood, &trestle(1.9, 0.74, 4, 0.2));
    let bench = doc.mesh("bench", palette.wood, &trestle(1.7, 0.44, 2, 0.17));
    let pot = doc.mesh("pot", palette.plaster, &pot());

    let mut seats = vec![doc.node("table", Content::Mesh(table), Placement::default(), vec![])];
    for (name, z, turn) in [("north bench", -0.78, 0.04), ("south bench", 0.86, -0.12)] {
        let place = Placement { rotation: DQuat::from_rotation_y(turn), ..Placement::at(0.05, 0.0, z) };
        seats.push(doc.node(name, Content::Mesh(bench), place, vec![]));
    }
    // On the table; half size, so it is a jar.
    let jar = Placement { scale: dvec3(0.42, 0.5, 0.42), ..Placement::at(-0.35, 0.735, 0.08) };
    seats.push(doc.node("jar", Content::Mesh(pot), jar, vec![]));
    let place = Placement { rotation: DQuat::from_rotation_y(0.35), ..Placement::at(8.6, -0.03, 3.9) };
    let seats = doc.node("seats", Content::Group, place, seats);

    let mut children = vec![fountain, seats];
    let pots = [(5.1, -5.5, 1.0), (5.75, -5.35, 0.7), (-5.2, -5.4, 0.9), (12.7, 1.7, 1.1), (12.85, 6.2, 1.0)];
    for (i, (x, z, size)) in pots.into_iter().enumerate() {
        let place = Placement { scale: dvec3(size, 1.1 * size, size), ..Placement::at(x, -FOOTING_M, z) };
        children.push(doc.node(format!("pot {}", i + 1), Content::Mesh(pot), place, vec![]));
    }
    doc.node("court", Content::Group, Placement::default(), children)
}

/// Two round steps, a basin with a curved lip, a bowl on a foot, and water in both.
fn fountain(doc: &mut Document, palette: &Palette) -> usize {
    let mut stone = Mesh::default();
    let steps = [(2.1, -0.05), (2.1, 0.10), (2.07, 0.13), (1.72, 0.13), (1.72, 0.25), (1.69, 0.28), (1.3, 0.28)];
    stone.add(&lathe(&steps.map(DVec2::from), 48), DMat4::IDENTITY);
    let basin = [
        (1.38, 0.26),
        (1.36, 0.36),
        (1.29, 0.42),
        (1.28, 0.58),
        (1.36, 0.68),
        (1.41, 0.73),
        (1.39, 0.78),
        (1.31, 0.80),
        (1.20, 0.77),
        (1.14, 0.70),
        (1.13, 0.40),
    ];
    stone.add(&lathe(&rounded(&basin.map(DVec2::from), 2), 48), DMat4::IDENTITY);
    let bowl = [
        (0.30, 0.30),
        (0.29, 0.72),
        (0.20, 0.80),
        (0.12, 0.95),
        (0.10, 1.15),
        (0.15, 1.26),
        (0.38, 1.34),
        (0.60, 1.46),
        (0.67, 1.54),
        (0.64, 1.57),
        (0.52, 1.50),
        (0.20, 1.43),
        (0.09, 1.50),
        (0.07, 1.70),
        (0.13, 1.80),
        (0.10, 1.92),
        (0.0, 2.02),
    ];
    stone.add(&lathe(&rounded(&bowl.map(DVec2::from), 2), 32), DMat4::IDENTITY);
    let mut water = lathe(&[(1.2, 0.66), (0.2, 0.66)].map(DVec2::from), 48);
    water.add(&lathe(&[(0.6, 1.515), (0.05, 1.515)].map(DVec2::from), 32), DMat4::IDENTITY);
    let stone = doc.mesh("fountain", palette.stone, &stone);
    let water = doc.mesh("water", palette.water, &water);
    let water = doc.node("water", Content::Mesh(water), Placement::default(), vec![]);
    doc.node("fountain", Content::Mesh(stone), Placement::at(4.4, 0.0, 1.4), vec![water])
}

/// A top of planks with gaps between them, on four legs: a table or a bench.
fn trestle(length: f64, height: f64, planks: u32, plank: f64) -> Mesh {
    let mut mesh = Mesh::default();
    let depth = plank * f64::from(planks);
    for i in 0..planks {
        let z = plank * (f64::from(i) + 0.5) - 0.5 * depth;
        mesh.add_block(dvec3(0.0, height - 0.02, z), dvec3(length, 0.04, plank - 0.012));
    }
    let (x, z) = (0.5 * length - 0.16, 0.5 * depth - 0.06);
    for side in [-1.0, 1.0] {
        mesh.add_block(dvec3(side * x, height - 0.065, 0.0), dvec3(0.06, 0.06, depth - 0.04));
        for front in [-1.0, 1.0] {
            let min = dvec3(side * x - 0.035, -0.1, front * z - 0.035);
            mesh.add_box(min, dvec3(side * x + 0.035, height - 0.04, front * z + 0.035));
        }
    }
    mesh.add_block(dvec3(0.0, 0.35 * height, 0.0), dvec3(2.0 * x, 0.06, 0.04));
    for side in [-1.0, 1.0] {
        mesh.add_block(dvec3(side * x, 0.35 * height, 0.0), dvec3(0.05, 0.05, 2.0 * z));
    }
    mesh
}

/// A flower pot with a rim and earth in it.
fn pot() -> Mesh {
    let outline = [(0.17, 0.0), (0.25, 0.38), (0.29, 0.40), (0.30, 0.48), (0.27, 0.49), (0.25, 0.44), (0.0, 0.43)];
    lathe(&outline.map(DVec2::from), 20)
}
