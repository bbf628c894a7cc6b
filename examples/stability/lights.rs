//! Lights at every distance, and in every awkward place.

use super::cases::{ANY, COLUMNS, NO_MAP, PLANNED, SEVERAL, row};
use super::plane::Edges;
use super::setup::{SUN, Setup, block, camera, floor, lamp, sun, yard};
use super::table::{Row, Table, short};
use super::trial::{Trial, only_map, plan};
use super::worlds::{COUNT, apart, fit_alone, steps_apart};
use glam::{DMat4, DVec3, dvec3};
use lixel::math::matrix_from_rows;

/// The middle of the yard, from which light distances are taken.
const MIDDLE: DVec3 = dvec3(-0.625, 0.625, -2.5);
/// Corner to corner of the yard, metres.
const DIAGONAL: f64 = 56.7;
/// From this distance on, in scene sizes, a lamp has to plan like the sun.
const LIKE_SUN: f64 = 1e9;
/// Largest relative difference of the metric between lamp and sun there, at the same matrix.
const METRIC: f64 = 1e-6;

/// The yard's lamp at a distance against the light's direction.
fn lamp_at(scenes: f64) -> Setup {
    yard().with_lights(vec![lamp(MIDDLE - SUN.normalize() * (scenes * DIAGONAL))])
}

/// The matrix of the far lamp that takes the light plane to the map as the sun's does.
fn as_lamp(rows: &[DVec3; 3], size: [u32; 2], of_sun: &DMat4, edges: &Edges) -> DMat4 {
    let of_plane = edges.normalisation.normal_from_plane.transpose() * (1.0 / edges.space.offset.z);
    let [u, v, w] = rows.map(|row| edges.space.row_from_q(of_plane * row));
    let clip = |texels: glam::DVec4, side: u32| texels * (2.0 / f64::from(side)) - w;
    DMat4::from_cols(clip(u, size[0]), clip(v, size[1]), of_sun.row(2), w).transpose()
}

fn distance_row(scenes: f64, sun: &Trial) -> Result<(Vec<String>, Vec<String>), String> {
    let trial = plan(&lamp_at(scenes), fit_alone)?;
    let light = trial.first()?;
    let measured = light.error.as_ref().and_then(|e| e.measured.as_ref());
    let mut cells = vec![
        format!("{:?}", light.status),
        light.maps.len().to_string(),
        light.maps.iter().map(|m| m.texels()).sum::<u64>().to_string(),
        measured.map_or("-".to_owned(), |m| m.misclassified.to_string()),
        short(light.maps.iter().map(|m| m.f32_roundtrip_texels).fold(0.0, f64::max)),
    ];
    let mut faults = Vec::new();
    if let (Ok(own), Ok(map)) = (only_map(light), only_map(sun.first()?)) {
        let (size, clip) = ([map.width, map.height], matrix_from_rows(&map.clip_from_world));
        let edges = |trial: &Trial| Edges::of(trial.light(), &trial.samples());
        let (of_sun, of_lamp) = (edges(sun)?, edges(&trial)?);
        let rows = of_sun.rows(&clip, size);
        let metric = apart(of_sun.cost(&rows), of_lamp.cost(&rows));
        let wrong = |trial: &Trial, m: &DMat4| trial.measured(m, map).map(|v| v.certain.wrong());
        let counts = [wrong(sun, &clip)?, wrong(&trial, &as_lamp(&rows, size, &clip, &of_lamp))?];
        let steps = steps_apart(size, [own.width, own.height], sun.plan.job.job.map.step);
        cells.extend([short(metric), format!("{}, {}", counts[0], counts[1]), format!("{steps:.1}")]);
        if scenes >= LIKE_SUN {
            if metric > METRIC {
                faults.push(format!("metric differs from the sun's by {metric:.1e}, limit {METRIC:e}"));
            }
            if apart(counts[0] as f64, counts[1] as f64) > COUNT {
                faults.push(format!("{} wrong pixels, the sun {}", counts[1], counts[0]));
            }
            if steps > 1.0 {
                faults.push(format!("{steps:.1} steps of size from the sun's"));
            }
        }
    } else if scenes >= LIKE_SUN {
        faults.push("no single map like the sun's".to_owned());
    }
    Ok((cells, faults))
}

/// Lamps from within the scene to beyond any.
pub(crate) fn distances(quick: bool) -> Table {
    let scenes: Vec<f64> = match quick {
        true => vec![1e-3, 0.1, 10.0, 1e9, 1e12],
        false => (-3..=12).map(|k| 10.0_f64.powi(k)).collect(),
    };
    let rows = match plan(&yard(), fit_alone) {
        Err(fault) => vec![Row { cells: vec!["the sun".to_owned()], faults: vec![fault] }],
        Ok(sun) => scenes.into_iter().map(|s| Row::of(format!("{s:e}"), distance_row(s, &sun))).collect(),
    };
    Table {
        title: "Light distance",
        text: "By the fit alone. A point light at a distance, in sizes of the scene, from the middle of the yard against the direction of its \
               sun. *Metric*: relative difference from the sun's at the sun's matrix, in the light plane. *Count*: wrong \
               pixels of the sun at its map, and of the lamp at the same one. *Steps*: sides of the planned map from the \
               sun's, in steps of 1.02. From 1e9 on the limits are 1e-6, 2 % and 1; before, the light is another one."
            .to_owned(),
        columns: &["scenes", "status", "maps", "texels", "wrong", "f32 texels", "metric", "count", "steps"],
        rows,
    }
}

/// A room with the camera inside, walls that face in.
fn room() -> Setup {
    let mut triangles: Vec<[DVec3; 3]> = block(dvec3(-4.0, 0.0, -6.0), dvec3(4.0, 3.0, 6.0));
    triangles.extend(block(dvec3(-1.0, 0.0, -2.0), dvec3(0.0, 1.0, -1.0)));
    triangles.extend(block(dvec3(1.5, 0.0, -4.0), dvec3(2.0, 2.5, -3.5)));
    Setup { triangles, camera: camera(dvec3(0.5, 1.6, 5.0), dvec3(0.0, 1.0, -4.0), 60.0), ..yard() }
}

/// Directions from the view's axis outwards, degrees; negative ones shine into the camera.
fn dueling() -> Vec<Row> {
    let setup = yard();
    let (at, target) = (dvec3(1.25, 2.5, 7.5), dvec3(-0.625, 0.625, -2.5));
    let forward = (target - at).normalize();
    let aside = forward.cross(DVec3::Y).normalize();
    let swept = |degrees: f64, towards: f64| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        setup.with_lights(vec![sun((forward * cos + aside * sin) * towards)])
    };
    let mut rows = Vec::new();
    for degrees in [3.0, 0.1, 1e-3, 1e-6, 1e-12, 0.0, -1e-12, -1e-6, -1e-3, -0.1, -3.0] {
        rows.push(row(format!("with the view, {degrees:e}° aside"), &swept(degrees, 1.0), ANY));
    }
    for degrees in [0.1, 1e-6, 0.0, -1e-6] {
        // A sun that shines up from under the floor: the floor is seen from above, and lies in the dark.
        rows.push(row(format!("against the view, {degrees:e}° aside"), &swept(degrees, -1.0), ANY));
    }
    let level = setup.with_camera(camera(dvec3(1.25, 1.25, 12.0), dvec3(1.25, 1.25, -2.5), 50.0));
    for (name, direction) in [("with", DVec3::NEG_Z), ("against", DVec3::Z)] {
        let setup = level.with_lights(vec![sun(direction)]);
        rows.push(row(format!("{name} a level view, along the floor"), &setup, ANY));
    }
    rows
}

/// Lights where planners break.
pub(crate) fn places(quick: bool) -> Table {
    let setup = yard();
    let low = |y: f64| setup.with_lights(vec![sun(dvec3(0.5, y, -0.3))]);
    let lamps = |p: DVec3| setup.with_lights(vec![lamp(p)]);
    let mut rows = vec![
        row("sun 0.1° over the horizon", &low(-1e-3), ANY),
        row("sun on the horizon", &low(0.0), ANY),
        row("sun under the horizon", &low(1e-3), ANY),
        row("lamp on the floor", &lamps(dvec3(0.3125, 0.0, 0.9375)), ANY),
        row("lamp on the table's top", &lamps(dvec3(-0.3125, 0.9375, 1.25)), SEVERAL),
        row("lamp at a vertex of the table", &lamps(dvec3(0.9375, 0.9375, 2.1875)), ANY),
        row("lamp inside the table", &lamps(dvec3(-0.3125, 0.78125, 1.25)), ANY),
        row("lamp among the posts", &lamps(dvec3(0.0, 0.9375, -3.4375)), SEVERAL),
        row("lamp and camera in a closed room", &room().with_lights(vec![lamp(dvec3(-0.5, 2.0, -1.5))]), PLANNED),
        row("sun outside a closed room", &room(), ANY),
    ];
    if !quick {
        rows.extend([
            row("sun 1e-6 rad over the horizon", &low(-1e-6), ANY),
            row("sun overhead", &setup.with_lights(vec![sun(DVec3::NEG_Y)]), PLANNED),
            row("lamp 1 mm over the floor", &lamps(dvec3(0.3125, 1e-3, 0.9375)), ANY),
            row("lamp at the camera", &lamps(dvec3(1.25, 2.5, 7.5)), ANY),
            row("lamp on the view's axis", &lamps(dvec3(0.3125, 1.5625, 2.5)), ANY),
            row("lamp under the floor", &lamps(dvec3(0.0, -2.0, 0.0)), ANY),
            row("lamp on the room's wall", &room().with_lights(vec![lamp(dvec3(-4.0, 1.0, -1.0))]), ANY),
            row("lamp in the room's corner", &room().with_lights(vec![lamp(dvec3(-4.0, 3.0, -6.0))]), ANY),
        ]);
        rows.extend(dueling());
    }
    rows.extend(edge_on(quick));
    Table {
        title: "Light places",
        text: "What came of one light: its status, maps, the largest map's size, certain and uncertain wrong pixels of the \
               230 that the bound allows. The limit: an answer or a reason; where a lamp stands among the geometry, several \
               maps. *With the view* and *against the view* are dueling frusta."
            .to_owned(),
        columns: COLUMNS,
        rows,
    }
}

/// A wall whose plane holds the light's direction, or nearly.
fn edge_on(quick: bool) -> Vec<Row> {
    let post = block(dvec3(-0.5, 0.0, -2.0), dvec3(-0.25, 2.0, -1.75));
    let wall = |x: f64| block(dvec3(x, 0.0, -6.0), dvec3(x + 0.25, 3.0, 3.0));
    let setup = Setup { triangles: floor(20.0, 0.0), ..yard() }.with(post).with(wall(-1.5));
    let tilts: &[f64] = if quick { &[0.0, 1e-6] } else { &[0.0, 1e-12, 1e-9, 1e-6, 1e-3, -1e-9, -1e-3] };
    let tilted = |x: f64| {
        let setup = setup.with_lights(vec![sun(dvec3(x, -0.75, -0.5))]);
        row(format!("wall edge-on to the sun, off by {x:e}"), &setup, ANY)
    };
    let mut rows: Vec<Row> = tilts.iter().map(|x| tilted(*x)).collect();
    let only = Setup { triangles: floor(20.0, 0.0), ..yard() }.with_lights(vec![sun(DVec3::X)]);
    rows.push(row("everything edge-on to the sun", &only, NO_MAP));
    rows
}
