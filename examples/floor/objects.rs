//! What stands on the floor: round, hollow, thin and slatted things, about 31,000 triangles and a metre and a half each.

use super::authoring::document::Document;
use super::authoring::mesh::{Mesh, lathe, rounded, tube};
use glam::{DMat4, DQuat, DVec2, DVec3, dvec3};
use std::f64::consts::{PI, TAU};

/// A name, and what builds the mesh.
type Kind = (&'static str, fn() -> Mesh);

/// Adds one mesh of every kind; with each, its lowest point below its origin, metres.
pub(super) fn all(doc: &mut Document, material: usize) -> Vec<(usize, f64)> {
    let kinds: [Kind; 9] = [
        ("ball", ball),
        ("stone", stone),
        ("ring", ring),
        ("knot", knot),
        ("vase", vase),
        ("column", column),
        ("chair", chair),
        ("crate", slatted),
        ("spring", spring),
    ];
    kinds
        .into_iter()
        .map(|(name, build)| {
            let mesh = build();
            let lowest = mesh.positions.iter().fold(f64::INFINITY, |low, p| low.min(p.y));
            (doc.mesh(name, material, &mesh), -lowest)
        })
        .collect()
}

/// A surface over (turn, height angle), both in steps: `radius` gives the distance from the middle.
fn globe(radius: impl Fn(f64, f64) -> f64) -> Mesh {
    const TURNS: usize = 176;
    const HEIGHTS: usize = 88;
    let ring = |i: usize| {
        let height = PI * (i as f64 / HEIGHTS as f64 - 0.5);
        let pole = i == 0 || i == HEIGHTS;
        let point = |j: usize| {
            let turn = if pole { 0.0 } else { TAU * j as f64 / TURNS as f64 };
            let level = if pole { 0.0 } else { height.cos() };
            radius(turn, height) * dvec3(level * turn.cos(), height.sin(), -level * turn.sin())
        };
        (0..TURNS).map(point).collect::<Vec<DVec3>>()
    };
    let mut mesh = Mesh::default();
    mesh.add_rings(&(0..=HEIGHTS).map(ring).collect::<Vec<_>>(), true);
    mesh
}

fn ball() -> Mesh {
    globe(|_, _| 0.7)
}

/// A boulder: waves of three lengths over a ball.
fn stone() -> Mesh {
    globe(|turn, height| {
        let fade = height.cos().powi(2);
        0.65 + fade
            * (0.12 * (2.0 * turn + 1.0).sin()
                + 0.07 * (5.0 * turn).cos() * (3.0 * height).sin()
                + 0.03 * (11.0 * turn + 7.0 * height).sin())
    })
}

/// A rod through points of a closed curve over 0...1; it comes back to where it began.
fn rod(curve: impl Fn(f64) -> DVec3, radius: f64, steps: usize, sides: usize) -> Mesh {
    let path: Vec<_> = (0..=steps).map(|i| (curve(i as f64 / steps as f64), radius)).collect();
    tube(&path, sides)
}

fn ring() -> Mesh {
    rod(|t| dvec3(0.65 * (TAU * t).cos(), 0.65 * (TAU * t).sin(), 0.0), 0.16, 320, 48)
}

/// The trefoil on a torus.
fn knot() -> Mesh {
    let curve = |t: f64| {
        let (a, b) = (2.0 * TAU * t, 3.0 * TAU * t);
        let r = 0.55 + 0.2 * b.cos();
        dvec3(r * a.cos(), 0.35 * b.sin(), r * a.sin())
    };
    rod(curve, 0.08, 640, 24)
}

fn spring() -> Mesh {
    let curve = |t: f64| dvec3(0.4 * (7.0 * TAU * t).cos(), 1.6 * t, 0.4 * (7.0 * TAU * t).sin());
    rod(curve, 0.03, 960, 16)
}

fn vase() -> Mesh {
    let outside = [(0.0, 0.0), (0.3, 0.0), (0.5, 0.45), (0.42, 0.9), (0.16, 1.25), (0.3, 1.5)];
    let inside = [(0.27, 1.49), (0.12, 1.25), (0.38, 0.9), (0.0, 0.1)];
    let mut profile = rounded(&outside.map(DVec2::from), 18);
    profile.extend(rounded(&inside.map(DVec2::from), 12));
    lathe(&profile, 124)
}

fn column() -> Mesh {
    let profile =
        [(0.0, 0.0), (0.34, 0.0), (0.34, 0.12), (0.22, 0.22), (0.2, 1.2), (0.18, 2.2), (0.32, 2.32), (0.0, 2.34)];
    lathe(&rounded(&profile.map(DVec2::from), 20), 110)
}

/// A box whose faces are finely divided by being a lathe of four sides, turned to stand square.
fn beam(middle: DVec3, size: DVec3, rows: usize) -> (Mesh, DMat4) {
    let corner = std::f64::consts::FRAC_1_SQRT_2;
    let mut profile = vec![DVec2::new(0.0, -0.5)];
    profile.extend((0..=rows).map(|i| DVec2::new(corner, i as f64 / rows as f64 - 0.5)));
    profile.push(DVec2::new(0.0, 0.5));
    (lathe(&profile, 4), DMat4::from_scale_rotation_translation(size, DQuat::IDENTITY, middle))
}

/// Four thin legs, a seat, a back of five bars.
fn chair() -> Mesh {
    let mut mesh = Mesh::default();
    let mut put = |middle: DVec3, size: DVec3| {
        let (part, place) = beam(middle, size, 320);
        mesh.add(&part, place);
    };
    for (x, z) in [(-0.22, -0.22), (0.22, -0.22), (-0.22, 0.22), (0.22, 0.22)] {
        put(dvec3(x, 0.23, z), dvec3(0.04, 0.46, 0.04));
    }
    put(dvec3(0.0, 0.48, 0.0), dvec3(0.5, 0.04, 0.5));
    for i in 0..5 {
        put(dvec3(-0.2 + 0.1 * f64::from(i), 0.75, -0.23), dvec3(0.03, 0.5, 0.03));
    }
    put(dvec3(0.0, 1.02, -0.23), dvec3(0.5, 0.05, 0.04));
    mesh
}

/// A crate of slats with gaps between them.
fn slatted() -> Mesh {
    let mut mesh = Mesh::default();
    let mut put = |middle: DVec3, size: DVec3| {
        let (part, place) = beam(middle, size, 110);
        mesh.add(&part, place);
    };
    for i in 0..7 {
        let y = 0.06 + 0.14 * f64::from(i);
        for side in [-0.48, 0.48] {
            put(dvec3(0.0, y, side), dvec3(1.0, 0.09, 0.03));
            put(dvec3(side, y, 0.0), dvec3(0.03, 0.09, 1.0));
        }
    }
    for i in 0..5 {
        put(dvec3(-0.4 + 0.2 * f64::from(i), 0.02, 0.0), dvec3(0.14, 0.03, 0.93));
    }
    mesh
}
