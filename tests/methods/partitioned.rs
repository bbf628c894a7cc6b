//! Methods that give several maps a light.

use crate::fixture::{Setup, assert_covers, room};
use glam::DVec3;
use lixel::methods::{Inapplicable, Method, Region, SolverParams};
use lixel::resolution::{predict, shares};
use lixel::scene::LightKind;

const SEVERAL: [Method; 3] = [Method::Partitioned, Method::Adaptive, Method::Edges];

fn setups() -> Vec<(&'static str, Setup)> {
    let sun = |x: f64, y: f64, z: f64| room().with_direction(DVec3::new(x, y, z));
    let lamp =
        |x: f64, y: f64, z: f64| room().with_light(LightKind::Point { position: DVec3::new(x, y, z), range: None });
    vec![
        ("overhead", sun(0.0, -1.0, 0.0)),
        ("side", sun(0.6, -0.8, -0.35)),
        ("towards the camera", sun(0.2, -0.4, 0.9)),
        ("lamp", lamp(2.0, 9.0, -14.0)),
        ("lamp low among the edges", lamp(0.2, 0.05, -9.0)),
        ("far lamp", lamp(1e7, 2e7, 3e6)),
    ]
}

fn with_solver(setup: &Setup, change: impl FnOnce(&mut SolverParams)) -> Setup {
    let mut changed = setup.clone();
    change(&mut changed.solver);
    changed
}

fn wrong(setup: &Setup, regions: &[Region]) -> f64 {
    predict(regions, &shares(regions), setup.texels).misclassified
}

#[test]
fn together_they_cover_and_the_same_inputs_give_the_same_bits() {
    for (name, setup) in setups() {
        for method in SEVERAL {
            let regions = setup.solve(method).unwrap_or_else(|e| panic!("{method:?}, {name}: {e}"));
            assert_covers(&setup, &regions, &format!("{method:?}, {name}"));
            let bits = |r: &[Region]| r.iter().map(|r| (r.h, r.aspect, r.domain.clone())).collect::<Vec<_>>();
            assert_eq!(bits(&regions), bits(&setup.solve(method).unwrap()), "{method:?}, {name}");
            let sum: f64 = shares(&regions).iter().sum();
            assert!((sum - 1.0).abs() < 1e-12);
        }
    }
}

#[test]
fn a_partition_pays() {
    for (name, setup) in setups().into_iter().take(4) {
        let one = setup.solve(Method::Lixel).unwrap();
        let alone = with_solver(&setup, |s| s.maps = 1).solve(Method::Partitioned).unwrap();
        assert_eq!((one[0].h, one.len()), (alone[0].h, alone.len()), "{name}");
        let mut last = wrong(&setup, &one);
        for maps in [2, 4] {
            let regions = with_solver(&setup, |s| s.maps = maps).solve(Method::Partitioned).unwrap();
            assert!(regions.len() <= maps as usize);
            let now = wrong(&setup, &regions);
            // A second pair is made only where it pays; the first does over a floor with a wall.
            let most = if maps == 2 { 0.9 * last } else { last };
            assert!(now <= most, "{name}, {maps} maps: {now} after {last}");
            last = now;
        }
    }
}

/// Tiles are disjoint to the bit, within their number, and squares of the light plane.
#[test]
fn every_covered_point_lies_in_one_tile() {
    for (name, setup) in setups().into_iter().take(4) {
        for method in [Method::Adaptive, Method::Edges] {
            let mut counts = Vec::new();
            for tiles in [1, 9, 40] {
                let setup = with_solver(&setup, |s| s.tiles = tiles);
                let regions = setup.solve(method).unwrap();
                assert!(regions.len() <= tiles as usize, "{name}: {} tiles", regions.len());
                for point in &setup.covered {
                    assert_eq!(regions.iter().filter(|r| r.domain.holds(*point)).count(), 1, "{method:?}, {name}");
                }
                counts.push(wrong(&setup, &regions));
            }
            assert!(counts[2] < counts[0], "{method:?}, {name}: {counts:?}");
        }
        let equal = shares(&setup.solve(Method::Adaptive).unwrap());
        assert!(equal.iter().all(|s| (s - equal[0]).abs() < 1e-15), "{name}");
    }
}

#[test]
fn nothing_to_cover_is_named_and_exactness_has_no_map() {
    let empty = Setup { covered: Vec::new(), edges: Vec::new(), ..room() };
    for method in SEVERAL {
        assert_eq!(empty.solve(method).unwrap_err(), Inapplicable::Empty, "{method:?}");
    }
    assert_eq!(room().solve(Method::Irregular).unwrap_err(), Inapplicable::NoMap);
    // A cover without edges needs no more than one map.
    let plain = Setup { edges: Vec::new(), ..room() };
    assert_eq!(plain.solve(Method::Partitioned).unwrap().len(), 1);
    assert_eq!(plain.solve(Method::Edges).unwrap().len(), 1);
}
