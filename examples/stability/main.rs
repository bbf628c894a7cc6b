//! Numerical stability at the extremes, as a table: `cargo run --release --example stability > docs/stability.md`. With
//! `--large` also ten million triangles and 10,000 instead of 400 problems of the fit: minutes and gigabytes. Ends with
//! code 1 when a figure breaks its limit.

mod amounts;
mod cameras;
mod cases;
mod lights;
mod plane;
mod problems;
mod setup;
mod sums;
mod surfaces;
mod table;
mod trial;
mod worlds;

use std::process::ExitCode;
use table::Table;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let large = match arguments.as_slice() {
        [] => false,
        [flag] if flag == "--large" => true,
        _ => {
            eprintln!("usage: stability [--large] > docs/stability.md");
            return ExitCode::from(2);
        }
    };
    let axes: [&dyn Fn() -> Table; 9] = [
        &|| worlds::table(false),
        &|| lights::distances(false),
        &|| lights::places(false),
        &|| cameras::table(false),
        &|| cameras::shadows(false),
        &|| surfaces::table(false),
        &|| amounts::table(false, large),
        &|| problems::gap_table(if large { 10_000 } else { 400 }),
        &|| sums::table(1000),
    ];
    println!("# Numerical stability\n");
    println!("Written by `cargo run --release --example stability{}`.\n", if large { " -- --large" } else { "" });
    let mut faults = Vec::new();
    let only = std::env::var("ONLY").ok();
    for (k, axis) in axes.into_iter().enumerate() {
        if only.as_ref().is_some_and(|o| !o.contains(&k.to_string())) {
            continue;
        }
        let table = axis();
        println!("{}", table.markdown());
        eprintln!("{}: {} cases", table.title, table.rows.len());
        faults.extend(table.faults());
    }
    for fault in &faults {
        eprintln!("{fault}");
    }
    ExitCode::from(u8::from(!faults.is_empty()))
}
