//! The two walls: the house behind the arcade, its openings closed by shutters; and the garden wall in the east, which
//! light and sight pass through, with the bracket of the light `spot`.

use super::authoring::document::{Content, Document, Keys, Placement, units};
use super::authoring::mesh::{Mesh, lathe, tube};
use super::authoring::pose::frame_time_s;
use super::authoring::schema;
use super::{FOOTING_M, Palette, TERRACE_M, shot};
use glam::{DMat4, DQuat, DVec2, DVec3, dvec3};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_8};

/// Front of the house wall, and of the garden wall.
const HOUSE_Z: f64 = -11.0;
const GARDEN_X: f64 = 13.4;
const THICKNESS: f64 = 0.45;

/// The spot: where it is, and a point it is aimed at.
const SPOT: DVec3 = dvec3(GARDEN_X - 0.95, 3.1, 3.2);
const SPOT_TARGET: DVec3 = dvec3(8.4, 0.3, 3.9);
/// Late in the shot, when its pool has left the picture, the spot swivels in its shade and shows the edge of the pool again:
/// bare ground, on which it throws no shadow. Frames of the turn, and the point it is aimed at then.
const SPOT_TURNS: [f64; 2] = [70.0, 72.0];
const SPOT_LATE_TARGET: DVec3 = dvec3(9.0, 0.0, 2.5);
const SPOT_RANGE_M: f64 = 11.0;
/// Half angles.
const SPOT_INNER_DEGREES: f64 = 28.0;
const SPOT_OUTER_DEGREES: f64 = 35.0;

/// A rectangular hole: left, right, bottom, top.
type Opening = [f64; 4];

pub(super) fn build(doc: &mut Document, palette: &Palette) -> usize {
    let (house, shutters) = house();
    let house = doc.mesh("house wall", palette.plaster, &house);
    let shutters = doc.mesh("door and shutters", palette.wood, &shutters);
    let (garden, grilles) = garden();
    let garden = doc.mesh("garden wall", palette.plaster, &garden);
    let grilles = doc.mesh("grilles", palette.iron, &grilles);
    let place = Placement::at(-15.0, -FOOTING_M, HOUSE_Z - THICKNESS);
    let shutters = doc.node("door and shutters", Content::Mesh(shutters), Placement::default(), vec![]);
    let house = doc.node("house", Content::Mesh(house), place, vec![shutters]);
    // The wall's x runs along world -z... +z: a turn about y by -90 degrees, its front to the west.
    let place =
        Placement { rotation: DQuat::from_rotation_y(-FRAC_PI_2), ..Placement::at(GARDEN_X, -FOOTING_M, HOUSE_Z) };
    let place = Placement { translation: place.translation + dvec3(THICKNESS, 0.0, 0.0), ..place };
    let grilles = doc.node("grilles", Content::Mesh(grilles), Placement::default(), vec![]);
    let garden = doc.node("garden wall", Content::Mesh(garden), place, vec![grilles]);
    let bracket = bracket(doc, palette);
    doc.node("walls", Content::Group, Placement::default(), vec![house, garden, bracket])
}

/// A wall from the origin to (length, height, thickness), pierced. Only its own faces: cells of the grid that the
/// openings' edges draw are either stone or air, and each border between the two is one rectangle.
fn pierced_wall(length: f64, height: f64, openings: &[Opening]) -> Mesh {
    let cuts = |low: usize, end: f64| -> Vec<f64> {
        let edges = openings.iter().flat_map(|o| [o[low], o[low + 1]]);
        let mut cuts: Vec<f64> = [0.0, end].into_iter().chain(edges).collect();
        cuts.sort_by(f64::total_cmp);
        cuts.dedup();
        cuts
    };
    let (xs, ys) = (cuts(0, length), cuts(2, height));
    let solid = |i: usize, j: usize| {
        // Indices beyond the grid wrap to usize::MAX or pass the end: air.
        let (Some(x), Some(y)) = (xs.get(i), ys.get(j)) else { return false };
        let open = |o: &Opening| o[0] <= *x && *x < o[1] && o[2] <= *y && *y < o[3];
        i + 1 < xs.len() && j + 1 < ys.len() && !openings.iter().any(open)
    };
    let mut mesh = Mesh::default();
    let t = THICKNESS;
    for i in 0..xs.len() - 1 {
        for j in 0..ys.len() - 1 {
            if !solid(i, j) {
                continue;
            }
            let (a, b, c, d) = (xs[i], xs[i + 1], ys[j], ys[j + 1]);
            mesh.add_quad([dvec3(a, c, t), dvec3(b, c, t), dvec3(b, d, t), dvec3(a, d, t)]);
            mesh.add_quad([dvec3(b, c, 0.0), dvec3(a, c, 0.0), dvec3(a, d, 0.0), dvec3(b, d, 0.0)]);
            if !solid(i.wrapping_sub(1), j) {
                mesh.add_quad([dvec3(a, c, 0.0), dvec3(a, c, t), dvec3(a, d, t), dvec3(a, d, 0.0)]);
            }
            if !solid(i + 1, j) {
                mesh.add_quad([dvec3(b, c, t), dvec3(b, c, 0.0), dvec3(b, d, 0.0), dvec3(b, d, t)]);
            }
            if !solid(i, j.wrapping_sub(1)) {
                mesh.add_quad([dvec3(a, c, 0.0), dvec3(b, c, 0.0), dvec3(b, c, t), dvec3(a, c, t)]);
            }
            if !solid(i, j + 1) {
                mesh.add_quad([dvec3(a, d, t), dvec3(b, d, t), dvec3(b, d, 0.0), dvec3(a, d, 0.0)]);
            }
        }
    }
    mesh
}

/// The house wall with sills and coping, and the leaves that close its openings.
fn house() -> (Mesh, Mesh) {
    let floor = TERRACE_M + FOOTING_M;
    let (length, height) = (30.0, 6.6);
    let mut openings = vec![[14.1, 15.9, floor + 0.02, floor + 2.7]];
    for x in [-9.0, -6.0, -3.0, 3.0, 6.0, 9.0] {
        openings.push([15.0 + x - 0.55, 15.0 + x + 0.55, floor + 0.95, floor + 2.55]);
    }
    let mut wall = pierced_wall(length, height, &openings);
    let mut leaves = Mesh::default();
    for [left, right, bottom, top] in openings {
        wall.add_box(dvec3(left - 0.1, bottom - 0.09, 0.3), dvec3(right + 0.1, bottom - 0.01, THICKNESS + 0.07));
        wall.add_box(dvec3(left - 0.15, top + 0.01, 0.3), dvec3(right + 0.15, top + 0.13, THICKNESS + 0.05));
        // Two leaves of planks, slightly ajar in depth, a third of the way into the wall.
        let middle = 0.5 * (left + right);
        for (a, b) in [(left - 0.01, middle - 0.006), (middle + 0.006, right + 0.01)] {
            leaves.add_box(dvec3(a, bottom - 0.02, 0.2), dvec3(b, top + 0.02, 0.24));
            for y in [bottom + 0.2, 0.5 * (bottom + top), top - 0.2] {
                leaves.add_box(dvec3(a + 0.04, y - 0.05, 0.235), dvec3(b - 0.04, y + 0.05, 0.265));
            }
        }
    }
    wall.add_box(dvec3(-0.02, height - 0.02, -0.12), dvec3(length + 0.02, height + 0.1, THICKNESS + 0.14));
    wall.add_box(dvec3(0.0, height + 0.08, -0.02), dvec3(length, height + 0.2, THICKNESS + 0.04));
    (wall, leaves)
}

/// The garden wall with its coping, and the iron grilles in its five openings.
fn garden() -> (Mesh, Mesh) {
    let (length, height) = (23.0, 3.7);
    let openings = [3.0, 7.0, 11.0, 17.0, 21.0].map(|x| [x - 0.7, x + 0.7, 0.95, 2.75]);
    let mut wall = pierced_wall(length, height, &openings);
    let mut grilles = Mesh::default();
    let depth = 0.5 * THICKNESS;
    for [left, right, bottom, top] in openings {
        for i in 1..10 {
            let x = left + 0.14 * f64::from(i);
            grilles
                .add_box(dvec3(x - 0.009, bottom - 0.02, depth - 0.009), dvec3(x + 0.009, top + 0.02, depth + 0.009));
        }
        for y in [bottom + 0.4, top - 0.4] {
            grilles
                .add_box(dvec3(left - 0.02, y - 0.015, depth - 0.012), dvec3(right + 0.02, y + 0.015, depth + 0.012));
        }
        wall.add_box(dvec3(left - 0.1, bottom - 0.09, -0.06), dvec3(right + 0.1, bottom - 0.01, THICKNESS + 0.06));
    }
    wall.add_box(dvec3(-0.02, height - 0.02, -0.1), dvec3(length + 0.02, height + 0.1, THICKNESS + 0.1));
    (wall, grilles)
}

/// An iron arm out of the garden wall, a shade, and the spot light at the mouth of the shade.
fn bracket(doc: &mut Document, palette: &Palette) -> usize {
    // The node's -z is the way the light travels; its origin is the light.
    let aim = SPOT_TARGET - SPOT;
    let rotation = DQuat::from_rotation_arc(DVec3::NEG_Z, aim.normalize());
    let outline = [(0.17, -0.04), (0.17, -0.035), (0.12, 0.09), (0.05, 0.17), (0.045, 0.24), (0.0, 0.25)];
    let mut shade = Mesh::default();
    // The lathe's axis is y: turned to z, the shade lies behind the light.
    shade.add(&lathe(&outline.map(DVec2::from), 20), DMat4::from_rotation_x(FRAC_PI_2));
    let shade = doc.mesh("shade", palette.iron, &shade);
    let light = doc.light(schema::Light {
        name: "spot",
        kind: "spot",
        color: [1.0, 0.85, 0.62],
        intensity: units(900.0),
        range: Some(units(SPOT_RANGE_M)),
        spot: Some(schema::Spot {
            inner_cone_angle: units(SPOT_INNER_DEGREES.to_radians()),
            outer_cone_angle: units(SPOT_OUTER_DEGREES.to_radians()),
        }),
    });
    let light = doc.node("spot", Content::Light(light), Placement::default(), vec![]);
    let late = rotation.conjugate() * DQuat::from_rotation_arc(DVec3::NEG_Z, (SPOT_LATE_TARGET - SPOT).normalize());
    let times = [1.0, SPOT_TURNS[0], SPOT_TURNS[1], shot::LAST_FRAME].map(frame_time_s);
    doc.animate(light, &times, Keys::Rotation(vec![DQuat::IDENTITY, DQuat::IDENTITY, late, late]));
    let place = Placement { translation: SPOT, rotation, ..Placement::default() };
    let shade = doc.node("shade", Content::Mesh(shade), place, vec![light]);

    // A swan neck from the wall to the back of the shade.
    let neck = SPOT - 0.22 * aim.normalize();
    let wall = dvec3(GARDEN_X + 0.05, SPOT.y - 0.25, SPOT.z);
    let arc = |i: u32| {
        let (sin, cos) = (FRAC_PI_8 * f64::from(i)).sin_cos();
        let level = neck.lerp(wall, 0.5 * (1.0 - cos));
        (level + dvec3(0.0, 0.25 * sin, 0.0), 0.014)
    };
    let mut arm = tube(&(0..=8).map(arc).collect::<Vec<_>>(), 8);
    arm.add_block(dvec3(GARDEN_X, wall.y, wall.z), dvec3(0.06, 0.3, 0.14));
    let arm = doc.mesh("bracket arm", palette.iron, &arm);
    let arm = doc.node("arm", Content::Mesh(arm), Placement::default(), vec![]);
    doc.node("bracket", Content::Group, Placement::default(), vec![arm, shade])
}
