//! The same yard in worlds of other scale, place and orientation.

use super::plane::Edges;
use super::setup::{World, yard};
use super::table::{Row, Table, short};
use super::trial::{Trial, only_map, plan};
use glam::{DMat3, DMat4, DQuat, DVec3, dvec3};
use lixel::job::Job;
use lixel::math::matrix_from_rows;
use lixel::resolution::Measure;

/// Largest relative change of the metric at a given matrix where f32 holds the same scene.
const METRIC_EXACT: f64 = 1e-6;
/// The same where vertices round to other f32 numbers: edges move by some 1e-4 pixels, and a position of the film that
/// lies so near to one may fall to its other side, with the piece of edge between them. The yard has some 2000 pieces, so
/// this is a few of them.
const METRIC_ROUNDED: f64 = 2e-3;
/// Of the solver here. At the default of 1e-3 worlds that differ by rounding may stop at different ends of it; what tolerance
/// costs is another table's.
const TOLERANCE: f64 = 1e-6;
/// Largest relative change of a measured count.
pub(crate) const COUNT: f64 = 0.02;

/// Step of the size grid, the default of `map.step`.
const STEP: f64 = 1.02;

/// How far two planned sizes are apart in steps of the size grid, over both sides; a texel of rounding is none. A quarter
/// turn of a map is the same grid of texels.
pub(crate) fn steps_apart(a: [u32; 2], b: [u32; 2], step: f64) -> f64 {
    let side = |a: u32, b: u32| {
        let (low, high) = (f64::from(a.min(b)), f64::from(a.max(b)));
        ((high - 1.0).max(low) / low).ln() / step.ln()
    };
    let apart = |b: [u32; 2]| side(a[0], b[0]).max(side(a[1], b[1]));
    apart(b).min(apart([b[1], b[0]]))
}

/// Relative difference.
pub(crate) fn apart(a: f64, b: f64) -> f64 {
    if a == b { 0.0 } else { (a - b).abs() / a.abs().max(b.abs()) }
}

/// The turn about a tilted axis whose matrix has the entries of 3-4-5 triangles: it takes the yard's coordinates to exact
/// ones.
fn exact_turn() -> DMat3 {
    let about_y = DMat3::from_cols(dvec3(0.6, 0.0, -0.8), DVec3::Y, dvec3(0.8, 0.0, 0.6));
    let quarter = DMat3::from_cols(DVec3::Z, DVec3::X, DVec3::Y);
    quarter * about_y
}

fn any_turn() -> DMat3 {
    DMat3::from_quat(DQuat::from_axis_angle(dvec3(0.4, -0.7, 0.2).normalize(), 1.1))
}

/// Name, world, and whether f32 holds the same scene there.
fn worlds(quick: bool) -> Vec<(String, World, bool)> {
    let scaled = |scale: f64| World { scale, ..World::AUTHORED };
    let shifted = |x: f64, y: f64, z: f64| World { shift: dvec3(x, y, z), ..World::AUTHORED };
    let mut all = vec![
        ("scale 2^-20 (9.5e-7)".to_owned(), scaled((-20.0_f64).exp2()), true),
        ("scale 1e-6".to_owned(), scaled(1e-6), false),
        ("scale 1e9".to_owned(), scaled(1e9), false),
        ("offset 6.4e6 along z, -6.4e6 along x".to_owned(), shifted(-6.4e6, 0.0, 6.4e6), true),
        ("turned by 3-4-5".to_owned(), World { turn: exact_turn(), ..World::AUTHORED }, true),
    ];
    if !quick {
        all.extend([1e-3, 0.01, 100.0, 1e4, 1e6].map(|s| (format!("scale {s:e}"), scaled(s), false)));
        all.extend([
            ("scale 2^30 (1.07e9)".to_owned(), scaled(30.0_f64.exp2()), true),
            ("offset 2e7 along every axis".to_owned(), shifted(2e7, 2e7, 2e7), true),
            ("offset 6378137.3, 12.7, -0.1".to_owned(), shifted(6_378_137.3, 12.7, -0.1), false),
            ("turned by 1.1 about a tilted axis".to_owned(), World { turn: any_turn(), ..World::AUTHORED }, false),
            (
                "turned, scale 1e6, offset 2e7".to_owned(),
                World { turn: any_turn(), scale: 1e6, shift: dvec3(2e7, -6.4e6, 2e7) },
                false,
            ),
        ]);
    }
    all
}

/// Authored scene space from the scene space of another world.
fn authored_from(world: &World, authored: &Trial, other: &Trial) -> DMat4 {
    let linear = world.turn.transpose() * (1.0 / world.scale);
    // Origins first: differences of like numbers are exact.
    let shift = linear * (other.shot.scene.origin - world.shift) - authored.shot.scene.origin;
    DMat4::from_mat3_translation(linear, shift)
}

fn row(base: &Trial, world: &World, exact: bool) -> Result<(Vec<String>, Vec<String>), String> {
    let other = plan(&yard().placed(world), fit_alone)?;
    let (a, b) = (base.first()?, other.first()?);
    let (map, own) = (only_map(a)?, only_map(b)?);
    let (size, clip) = ([map.width, map.height], matrix_from_rows(&map.clip_from_world));
    let same = clip * authored_from(world, base, &other);

    let metric = |trial: &Trial, m: &DMat4| -> Result<f64, String> {
        let edges = Edges::of(trial.light(), &trial.samples())?;
        Ok(edges.cost(&edges.rows(m, size)))
    };
    let metric = apart(metric(base, &clip)?, metric(&other, &same)?);
    let count = |trial: &Trial, m: &DMat4| trial.measured(m, map).map(|v| v.certain.wrong());
    let counts = [count(base, &clip)?, count(&other, &same)?];
    let steps = steps_apart(size, [own.width, own.height], base.plan.job.job.map.step);
    let planned = b.error.as_ref().and_then(|e| e.measured.as_ref()).map_or(0, |m| m.misclassified);

    let limit = if exact { METRIC_EXACT } else { METRIC_ROUNDED };
    let mut faults = Vec::new();
    if metric > limit {
        faults.push(format!("metric changes by {metric:.1e}, limit {limit:e}"));
    }
    if apart(counts[0] as f64, counts[1] as f64) > COUNT {
        faults.push(format!("{} and {} wrong pixels at the same matrix", counts[0], counts[1]));
    }
    if !b.met() {
        faults.push(format!("the bound is not met: {:?}", b.reason));
    }
    let cells = vec![
        if exact { "yes" } else { "rounded" }.to_owned(),
        short(metric),
        format!("{}, {}", counts[0], counts[1]),
        format!("{}x{}", own.width, own.height),
        format!("{steps:.1}"),
        planned.to_string(),
        short(own.f32_roundtrip_texels),
    ];
    Ok((cells, faults))
}

/// A job without the choice by measurement, which is a search of its own: its steps at random go another way after the first
/// count that differs, and end at another place that is as good.
pub(crate) fn fit_alone(job: &mut Job) {
    job.solver.measured_rounds = 0;
    job.solver.tolerance = TOLERANCE;
}

/// The size of the yard's map in a world by the fit and its prediction, without any count.
fn predicted(world: &World) -> Result<[u32; 2], String> {
    let never = |job: &mut Job| {
        fit_alone(job);
        job.quality.measure = Measure::Never;
    };
    plan(&yard().placed(world), never)?.fitted_size()
}

/// The size and the wrong pixels of the yard in a world, by measured choice.
fn chosen(world: &World) -> Result<([u32; 2], u64), String> {
    let trial = plan(&yard().placed(world), |_| {})?;
    let light = trial.first()?;
    let map = only_map(light)?;
    let measured = light.error.as_ref().and_then(|e| e.measured.as_ref());
    if !light.met() {
        return Err(format!("by measured choice the bound is not met: {:?}", light.reason));
    }
    Ok(([map.width, map.height], measured.map_or(0, |m| m.misclassified)))
}

pub(crate) fn table(quick: bool) -> Table {
    let (mut rows, mut sizes) = (Vec::new(), Vec::new());
    match plan(&yard(), fit_alone) {
        Err(fault) => rows.push(Row { cells: vec!["as authored".to_owned()], faults: vec![fault] }),
        Ok(base) => {
            let fit = predicted(&World::AUTHORED);
            let authored = ("as authored".to_owned(), World::AUTHORED, true);
            for (name, world, exact) in std::iter::once(authored).chain(worlds(quick)) {
                let found = row(&base, &world, exact).and_then(|(mut cells, mut faults)| {
                    let (here, there) = (predicted(&world)?, fit.clone()?);
                    let steps = steps_apart(there, here, STEP);
                    cells.push(format!("{}x{}, {steps:.1}", here[0], here[1]));
                    if steps > 1.0 {
                        faults.push(format!("{steps:.1} steps apart by the fit, limit 1"));
                    }
                    let (size, wrong) = chosen(&world)?;
                    cells.push(format!("{}x{}, {wrong}", size[0], size[1]));
                    sizes.push(size);
                    Ok((cells, faults))
                });
                rows.push(Row::of(name, found));
            }
        }
    }
    let first = sizes.first().copied().unwrap_or([1, 1]);
    let aside = |size: &[u32; 2]| steps_apart(first, *size, STEP);
    let spread = sizes.iter().map(aside).fold(0.0, f64::max);
    let elsewhere = sizes.iter().filter(|size| aside(size) > 1.0).count();
    Table {
        title: "Scale, offset, rotation",
        text: format!(
            "One yard with one sun. *Metric*: relative change of the metric at the matrix planned for the world as \
             authored, carried over; limit {METRIC_EXACT:e} where f32 holds the same scene (*f32*: yes) and \
             {METRIC_ROUNDED:e} where vertices round to other numbers. *Count*: wrong pixels at that matrix and size, as \
             authored and here; limit 2 %. *Fit*: size and distance in steps of {STEP} along a side by the fit and its \
             prediction (`solver.measured_rounds = 0`, `solver.tolerance = {TOLERANCE:e}`), without any count; limit 1. *f32*: \
             shift of a point when the matrix is rounded to f32, texels.\n\n\
             *Size*, *steps*, *planned count*: the fitted matrix certified by counting. *Measured choice*: the same as planned \
             by default, where candidates and steps from them are chosen by counted pixels. The limit of both is the bound \
             alone. Nothing is claimed of these sizes: near a bound of 230 pixels some pixels decide where a certified size \
             ends, counts do not fall strictly with size, and one pixel that a rounding of the last digit turns over sends a \
             search to another map that meets the bound. Of these {} worlds {elsewhere} end more than a step from the world as \
             authored by measured choice, the farthest {spread:.1} steps.",
            sizes.len()
        ),
        columns: &[
            "world",
            "f32",
            "metric",
            "count",
            "size",
            "steps",
            "planned count",
            "f32 texels",
            "fit",
            "measured choice",
        ],
        rows,
    }
}
