//! The quick part of the suite that `docs/stability.md` is written by: every axis, fewer cases, the same limits.

#[path = "../examples/stability/amounts.rs"]
mod amounts;
#[path = "../examples/stability/cameras.rs"]
mod cameras;
#[path = "../examples/stability/cases.rs"]
mod cases;
#[path = "../examples/stability/lights.rs"]
mod lights;
#[path = "../examples/stability/plane.rs"]
mod plane;
#[path = "../examples/stability/problems.rs"]
mod problems;
#[path = "../examples/stability/setup.rs"]
mod setup;
#[path = "../examples/stability/sums.rs"]
mod sums;
#[path = "../examples/stability/surfaces.rs"]
mod surfaces;
#[path = "../examples/stability/table.rs"]
mod table;
#[path = "../examples/stability/trial.rs"]
mod trial;
#[path = "../examples/stability/worlds.rs"]
mod worlds;

/// Every row keeps its limits.
fn holds(table: &table::Table) {
    let faults = table.faults();
    assert!(faults.is_empty(), "{faults:#?}\n{}", table.markdown());
    assert!(table.rows.iter().all(|row| row.cells.len() <= table.columns.len()), "{}", table.markdown());
}

#[test]
fn worlds_of_any_scale_place_and_turn_plan_alike() {
    holds(&worlds::table(true));
}

#[test]
fn a_far_lamp_plans_like_the_sun() {
    holds(&lights::distances(true));
}

#[test]
fn lights_in_awkward_places_get_an_answer() {
    holds(&lights::places(true));
}

#[test]
fn cameras_and_images_at_their_limits_get_an_answer() {
    holds(&cameras::table(true));
    holds(&cameras::shadows(true));
}

#[test]
fn bad_triangles_get_an_answer() {
    holds(&surfaces::table(true));
}

#[test]
fn few_and_many_get_an_answer() {
    holds(&amounts::table(true, false));
}

#[test]
fn the_search_comes_near_the_best_of_all() {
    holds(&problems::gap_table(100));
}

#[test]
fn the_moment_form_keeps_its_digits() {
    holds(&sums::table(200));
}
