//! Cameras and images at their limits.

use super::cases::{ANY, COLUMNS, NO_MAP, PLANNED, row};
use super::setup::{SUN, Setup, block, camera, floor, yard};
use super::table::{Row, Table};
use glam::{DVec3, dvec3};
use lixel::scene::CameraParams;

const AT: DVec3 = dvec3(1.25, 2.5, 7.5);
/// The foot of a post's shadow.
const TARGET: DVec3 = dvec3(-0.9375, 0.0, -4.0625);

/// Fields of view, ranges of depth, sizes of image.
pub(crate) fn table(quick: bool) -> Table {
    let mut rows = fields(quick);
    rows.extend(ranges(quick));
    let setup = yard();
    let sizes: &[[u32; 2]] =
        if quick { &[[1, 1], [1, 4096]] } else { &[[1, 1], [2, 1], [3, 3], [1, 4096], [4096, 1], [16_384, 9]] };
    for [width, height] in sizes {
        rows.push(row(format!("image {width}x{height}"), &setup.with_image([*width, *height]), ANY));
    }
    Table {
        title: "Cameras and images",
        text: "The yard and its sun. *Moved back*: so far that the picture stays. The limit: an answer or a reason."
            .to_owned(),
        columns: COLUMNS,
        rows,
    }
}

fn fields(quick: bool) -> Vec<Row> {
    let all = [0.01, 0.1, 1.0, 10.0, 90.0, 150.0, 170.0, 179.0];
    let some = [0.01, 179.0];
    let mut rows = Vec::new();
    for fov in if quick { &some[..] } else { &all[..] } {
        rows.push(row(format!("field of view {fov}°"), &yard().with_camera(camera(AT, TARGET, *fov)), ANY));
        if *fov < 50.0 {
            let back = 25.0_f64.to_radians().tan() / (0.5 * fov.to_radians()).tan();
            let camera = camera(TARGET + (AT - TARGET) * back, TARGET, *fov);
            let camera = CameraParams { near: Some(back), ..camera };
            rows.push(row(format!("field of view {fov}°, moved back"), &yard().with_camera(camera), PLANNED));
        }
    }
    rows
}

fn ranges(quick: bool) -> Vec<Row> {
    let all = [(1e-6, 1e3), (0.1, 1e8), (1e-3, 1e6), (5.0, 12.0), (1e-9, 1e9)];
    let some = [(0.1, 1e8)];
    let named = |&(near, far): &(f64, f64)| {
        let camera = CameraParams { near: Some(near), far: Some(far), ..camera(AT, TARGET, 50.0) };
        row(format!("near {near:e}, far {far:e}"), &yard().with_camera(camera), PLANNED)
    };
    (if quick { &some[..] } else { &all[..] }).iter().map(named).collect()
}

/// How much of the frame is in shadow.
pub(crate) fn shadows(quick: bool) -> Table {
    let open = Setup { triangles: floor(20.0, 0.0), ..yard() };
    let roofed = open.with(block(dvec3(-40.0, 8.0, -40.0), dvec3(40.0, 8.5, 40.0)));
    // A leaf of a size whose shadow falls on the floor where the middle of the image looks, which is half a pixel aside of
    // the centre of one.
    let leaf = |size: f64| {
        let middle = TARGET - SUN * 0.8;
        let [a, b] = [dvec3(size, 0.0, -size), dvec3(size, 0.0, size)];
        let at_middle = camera(AT, TARGET, 50.0);
        open.with([[middle - a, middle - b, middle + a], [middle - a, middle + a, middle + b]]).with_camera(at_middle)
    };
    let mut rows = vec![
        row("fully lit", &open, NO_MAP),
        row("fully shadowed", &roofed, ANY),
        row("shadow of a few pixels", &leaf(0.1), PLANNED),
        row("shadow of a hundredth of a pixel", &leaf(0.003), ANY),
        row("shadow of one pixel, a hundredth of it", &leaf(0.003).with_image([639, 359]), PLANNED),
    ];
    if !quick {
        let one_lit = block(dvec3(-40.0, 8.0, -40.0), dvec3(40.0, 8.5, -8.0))
            .into_iter()
            .chain(block(dvec3(-40.0, 8.0, -7.96), dvec3(40.0, 8.5, 40.0)));
        rows.push(row("a slit of light", &open.with(one_lit), ANY));
        let leaves = (0..400).flat_map(|k| {
            let p = dvec3(-6.0 + 0.03 * f64::from(k), 0.4, -3.0 - 0.01 * f64::from(k % 37));
            [[p, p + dvec3(0.004, 0.0, 0.0), p + dvec3(0.0, 0.0, 0.004)]]
        });
        rows.push(row("400 shadows below a pixel", &open.with(leaves), ANY));
        rows.push(row("nothing in view", &open.with_camera(camera(AT, AT + dvec3(0.0, 1.0, -0.1), 30.0)), NO_MAP));
    }
    Table {
        title: "Shadows in the frame",
        text: "A floor under a sun. The limit: an answer or a reason; no map where there is no shadow.".to_owned(),
        columns: COLUMNS,
        rows,
    }
}
