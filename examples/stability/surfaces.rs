//! Triangles that geometry code dislikes.

use super::cases::{ANY, COLUMNS, PLANNED, row};
use super::setup::{Setup, Soup, block, floor, yard};
use super::table::{Row, Table};
use super::trial::{only_map, plan};
use glam::{DVec3, dvec3};

/// A triangle 20 m long and so much thinner.
fn sliver(aspect: f64, z: f64) -> [DVec3; 3] {
    let thin = 20.0 / aspect;
    [dvec3(-10.0, 1.25, z), dvec3(10.0, 1.25, z), dvec3(-10.0, 1.25 + thin, z)]
}

fn flat() -> Soup {
    let p = dvec3(0.5, 1.0, -2.0);
    vec![[p; 3], [p, p, p + DVec3::X], [p, p + DVec3::X, p + DVec3::X * 2.0], [p, p + DVec3::X, p]]
}

/// Slivers, flat, doubled, coincident and crossing triangles.
pub(crate) fn table(quick: bool) -> Table {
    let setup = yard();
    let doubled = setup.with(setup.triangles.clone());
    let flipped = setup.with(setup.triangles.iter().map(|[a, b, c]| [*a, *c, *b]));
    // The other diagonal, and a hand's breadth aside: the same plane, other triangles.
    let fighting = setup.with(floor(17.3, 0.0)).with(floor(20.0, 1e-7));
    let crossing = setup
        .with(block(dvec3(-2.3, -0.2, -4.1), dvec3(-0.4, 1.0, 1.9)))
        .with(block(dvec3(-1.7, -0.7, -3.3), dvec3(1.1, 0.8, 0.9)));
    let slivers = |aspect: f64| setup.with((0..8).map(|k| sliver(aspect, -1.0 - f64::from(k))));
    let mut rows = vec![
        row("slivers of aspect 1e8", &slivers(1e8), PLANNED),
        same("triangles without area", &setup.with(flat())),
        same("every triangle twice", &doubled),
        row("coincident floors, 0 and 1e-7 m apart", &fighting, ANY),
        row("boxes through each other", &crossing, PLANNED),
    ];
    if !quick {
        rows.extend([
            row("slivers of aspect 1e4", &slivers(1e4), PLANNED),
            row("slivers of aspect 1e12", &slivers(1e12), PLANNED),
            same("every triangle twice, turned over", &flipped),
        ]);
    }
    let only_flat = Setup { triangles: flat(), ..yard() };
    let refused = match plan(&only_flat, |_| {}) {
        Err(message) if message.contains("no triangles") => Ok((vec!["refused".to_owned()], Vec::new())),
        Err(message) => Err(message),
        Ok(_) => Err("planned without a triangle".to_owned()),
    };
    rows.push(Row::of("only triangles without area", refused));
    Table {
        title: "Triangles",
        text:
            "The yard and its sun, with further triangles. The limit: an answer or a reason; the same size and count \
               where the added triangles change no ray (*same*)."
                .to_owned(),
        columns: COLUMNS,
        rows,
    }
}

/// Plans as the yard alone does.
fn same(name: &str, setup: &Setup) -> Row {
    let found = || {
        let of = |setup: &Setup| {
            let trial = plan(setup, |_| {})?;
            let light = trial.first()?;
            let map = only_map(light)?;
            let wrong = light.error.as_ref().and_then(|e| e.measured.as_ref()).map_or(0, |m| m.misclassified);
            Ok::<_, String>(([map.width, map.height], wrong))
        };
        let (alone, with) = (of(&yard())?, of(setup)?);
        let faults = if alone == with { Vec::new() } else { vec![format!("{with:?}, alone {alone:?}")] };
        let ([width, height], wrong) = with;
        Ok((vec!["same".to_owned(), "1".to_owned(), format!("{width}x{height}"), wrong.to_string()], faults))
    };
    Row::of(name, found())
}
