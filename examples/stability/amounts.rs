//! From nothing to very much.

use super::cases::{ANY, COLUMNS, NO_MAP, SEVERAL, row, tuned};
use super::setup::{Setup, Soup, lamp, sun, yard};
use super::table::{Row, Table};
use super::trial::plan;
use glam::{DVec3, dvec3};
use lixel::scene::LightParams;

/// Numbers of lights and triangles.
pub(crate) fn table(quick: bool, large: bool) -> Table {
    let one: Soup = vec![[dvec3(-3.0, 0.0, 1.0), dvec3(3.0, 0.0, 1.0), dvec3(0.0, 0.0, -6.0)]];
    let single = Setup { triangles: one.clone(), ..yard() };
    let above = one[0].map(|p| p * 0.3 + DVec3::Y);
    let mut rows = vec![
        Row::of("no light", none()),
        row("1 triangle", &single, NO_MAP),
        row("1 triangle over another", &single.with([above]), ANY),
        Row::of(if quick { "24 lights" } else { "1000 lights" }, many(if quick { 24 } else { 1000 })),
    ];
    if large {
        let terrain = terrain(2237);
        let name = format!("{} triangles", terrain.triangles.len());
        let large = |job: &mut lixel::job::Job| job.image.size = Some([640, 360]);
        rows.push(tuned(name, &terrain.with_lights(vec![sun(dvec3(0.8, -0.3, -0.4))]), large, ANY));
    }
    let lamps = yard().with_lights(vec![lamp(dvec3(0.0, 0.9375, -3.4375))]);
    rows.push(tuned("maps of at most 16 texels", &lamps, |job| job.map.max = 16, SEVERAL));
    Table {
        title: "Amounts",
        text: "The yard, or less, or more. The limit: an answer or a reason, for each of the lights; a message where there is \
               no light."
            .to_owned(),
        columns: COLUMNS,
        rows,
    }
}

/// A job without any light is refused in words.
fn none() -> Result<(Vec<String>, Vec<String>), String> {
    match plan(&yard().with_lights(Vec::new()), |_| {}) {
        Err(message) if message.starts_with("no light to plan for") => {
            let short = message.split("; ").next().unwrap_or_default().to_owned();
            Ok((
                vec![
                    "refused".to_owned(),
                    String::new(),
                    String::new(),
                    String::new(),
                    String::new(),
                    String::new(),
                    short,
                ],
                vec![],
            ))
        }
        Err(message) => Err(message),
        Ok(_) => Err("planned without a light".to_owned()),
    }
}

/// Suns and lamps all around, each of them planned.
fn many(count: u32) -> Result<(Vec<String>, Vec<String>), String> {
    let light = |k: u32| {
        let turn = f64::from(k) * 2.399_963;
        let height = (f64::from(k) + 0.5) / f64::from(count);
        let at = dvec3(turn.cos(), 0.1 + 2.0 * height, turn.sin());
        let light = if k.is_multiple_of(2) { sun(-at) } else { lamp(at * (2.0 + 6.0 * height)) };
        LightParams { name: format!("light {k}"), ..light }
    };
    let setup = yard().with_image([64, 36]).with_lights((0..count).map(light).collect());
    let trial = plan(&setup, |job| job.solver.measured_rounds = 0)?;
    let planned = trial.lights().count();
    let maps: usize = trial.lights().map(|(_, light)| light.maps.len()).sum();
    let faults = if planned == count as usize { vec![] } else { vec![format!("{planned} lights in the plan")] };
    Ok((vec![format!("{planned} entries"), maps.to_string()], faults))
}

/// Rolling ground of 2 (side - 1)² triangles.
fn terrain(side: u32) -> Setup {
    let at = |i: u32, k: u32| {
        let (x, z) = (f64::from(i) / f64::from(side - 1) - 0.5, f64::from(k) / f64::from(side - 1) - 0.5);
        let height = (x * 37.0).sin() * (z * 29.0).cos() + 0.2 * (x * 211.0).sin() * (z * 173.0).sin();
        dvec3(x * 40.0, 0.4 * height, z * 40.0)
    };
    let mut triangles = Soup::with_capacity(2 * (side as usize - 1).pow(2));
    for k in 0..side - 1 {
        for i in 0..side - 1 {
            let [a, b, c, d] = [at(i, k), at(i, k + 1), at(i + 1, k + 1), at(i + 1, k)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    Setup { triangles, ..yard() }
}
