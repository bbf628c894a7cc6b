//! What holds for every method.

use crate::fixture::{ALL, Setup, assert_covers, place, room};
use glam::{DQuat, DVec2, DVec3};
use lixel::fit::Aspect;
use lixel::math::Domain;
use lixel::methods::{Inapplicable, Method, Region};
use lixel::resolution::{predict, shares};
use lixel::scene::{LightKind, Projection};

/// Lights of every kind and from every side.
pub(crate) fn lights() -> Vec<(&'static str, LightKind)> {
    let sun = |x: f64, y: f64, z: f64| LightKind::Directional { direction: DVec3::new(x, y, z).normalize() };
    vec![
        ("overhead", sun(0.0, -1.0, 0.0)),
        ("side", sun(0.6, -0.8, -0.35)),
        ("behind the camera", sun(0.1, -0.3, -1.0)),
        ("towards the camera", sun(0.2, -0.4, 0.9)),
        ("lamp ahead", LightKind::Point { position: DVec3::new(2.0, 9.0, -14.0), range: None }),
        ("lamp behind", LightKind::Point { position: DVec3::new(-3.0, 6.0, 9.0), range: None }),
        ("far lamp", LightKind::Point { position: DVec3::new(1e7, 2e7, 3e6), range: None }),
        ("spot", {
            let direction = DVec3::new(-0.1, -0.9, -0.3).normalize();
            LightKind::Spot { position: DVec3::new(1.0, 25.0, -8.0), direction, cone_rad: 1.1, range: None }
        }),
    ]
}

fn solved(setup: &Setup, method: Method) -> Option<Vec<Region>> {
    setup.solve(method).ok()
}

#[test]
fn every_covered_point_lies_in_the_map() {
    for (name, kind) in lights() {
        for aspect in [Aspect::Fixed(1.0), Aspect::Free] {
            let setup = Setup { aspect, ..room().with_light(kind) };
            for method in ALL {
                match setup.solve(method) {
                    Ok(regions) => assert_covers(&setup, &regions, &format!("{method:?}, {name}")),
                    Err(reason) => assert!(may_refuse(method, reason), "{method:?}, {name}: {reason}"),
                }
            }
        }
    }
}

/// Reasons that belong to the published methods; the general ones never come from these lights.
fn may_refuse(method: Method, reason: Inapplicable) -> bool {
    matches!(
        (method, reason),
        (Method::Psm, Inapplicable::LightInView) | (Method::PlaneOptimal, Inapplicable::StraddlesVanishingLine)
    )
}

#[test]
fn the_same_inputs_give_the_same_bits() {
    for (_, kind) in lights() {
        let setup = room().with_light(kind);
        for method in ALL {
            let bits = || solved(&setup, method).map(|r| r.iter().map(|r| (r.h, r.aspect)).collect::<Vec<_>>());
            assert_eq!(bits(), bits(), "{method:?}");
        }
    }
}

/// How much a method may differ between equal worlds: rounding for direct ones; a search that stops at a tolerance
/// answers differently, but equally well.
pub(crate) fn is_search(method: Method) -> bool {
    matches!(method, Method::Lixel | Method::HomographyArea | Method::Partitioned)
}

/// How two answers for the same covered points differ, if they do. A quarter turn of a square map is the same texel grid,
/// and which one a minimum-area rectangle takes is rounding.
pub(crate) fn difference(
    method: Method,
    a: (&Setup, &[Region]),
    b: (&Setup, &[Region]),
    tolerance: f64,
) -> Option<String> {
    if is_search(method) {
        let sum = |regions: &[Region]| predict(regions, &shares(regions), a.0.texels).misclassified;
        let (x, y) = (sum(a.1), sum(b.1));
        return ((x / y - 1.0).abs() > SEARCHED).then(|| format!("{x} and {y} wrong pixels"));
    }
    if a.1.len() != b.1.len() {
        return Some(format!("{} maps and {}", a.1.len(), b.1.len()));
    }
    let placed: Vec<_> = (a.0.covered.iter().zip(&b.0.covered))
        .map(|(p, q)| (place(a.1, *p).unwrap(), place(b.1, *q).unwrap()))
        .collect();
    // Which side of a border a point on it lies is rounding.
    let pairs: Vec<(usize, DVec2, DVec2)> =
        placed.iter().filter(|(p, q)| p.0 == q.0).map(|((map, u, _), (_, v, _))| (*map, *u, *v)).collect();
    if pairs.len() + ON_BORDERS < placed.len() {
        return Some(format!("{} points in other maps", placed.len() - pairs.len()));
    }
    let off = |map: usize, turn: DVec2| {
        let turned = |v: DVec2| turn.rotate(v - 0.5) + 0.5;
        let here = pairs.iter().filter(|p| p.0 == map);
        here.map(|(_, u, v)| (*u - turned(*v)).abs().max_element()).fold(0.0, f64::max)
    };
    let least = |map: usize| {
        [DVec2::X, DVec2::Y, -DVec2::X, -DVec2::Y].map(|t| off(map, t)).into_iter().fold(f64::INFINITY, f64::min)
    };
    // The light plane rounds as a whole: a small tile shows more of it.
    let side = |region: &Region| match region.domain {
        Domain::LightPlaneRectangle { min, max, .. } => (max - min).max_element(),
        _ => 1.0,
    };
    let widest = a.1.iter().map(side).fold(0.0, f64::max);
    let worst = (0..a.1.len()).map(|map| least(map) * side(&a.1[map]) / widest).fold(0.0, f64::max);
    (worst > tolerance).then(|| format!("off by {worst}"))
}

/// Points of the setups that lie on the border of two maps: a corner of the film lies on two faces of the view.
const ON_BORDERS: usize = 1;
/// Relative difference in predicted wrong pixels that two runs of a search may have.
const SEARCHED: f64 = 0.02;

#[test]
fn the_order_of_samples_does_not_matter() {
    for (name, kind) in lights() {
        let setup = room().with_light(kind);
        let mut shuffled = setup.clone();
        shuffled.edges.reverse();
        shuffled.covered.reverse();
        shuffled.edges.rotate_left(17);
        shuffled.covered.rotate_left(17);
        for method in ALL {
            let (Some(a), Some(b)) = (solved(&setup, method), solved(&shuffled, method)) else { continue };
            // Compared at the points of the first.
            let same = Setup { covered: setup.covered.clone(), ..shuffled.clone() };
            let differs = difference(method, (&setup, &a), (&same, &b), 1e-6);
            assert_eq!(differs, None, "{method:?}, {name}");
        }
    }
}

#[test]
fn the_world_may_be_turned_scaled_and_moved() {
    let turn = DQuat::from_axis_angle(DVec3::new(0.4, -0.7, 0.2).normalize(), 1.1);
    let mut found = Vec::new();
    for (name, kind) in lights() {
        let setup = room().with_light(kind);
        let reference: Vec<_> = ALL.iter().map(|m| solved(&setup, *m)).collect();
        for (what, rotation, scale, translation, tolerance) in [
            ("moved", DQuat::IDENTITY, 1.0, DVec3::new(30.0, -7.0, 11.0), 1e-6),
            ("scaled up", DQuat::IDENTITY, 1e7, DVec3::ZERO, 1e-6),
            ("scaled down", DQuat::IDENTITY, 1e-6, DVec3::ZERO, 1e-6),
            ("turned", turn, 1.0, DVec3::ZERO, 1e-6),
            // Eleven digits before a scene of 60 m leave nine behind it: the bounds' planes round there.
            ("far out", turn, 1.0, DVec3::new(6.4e6, 2e7, -3e6), 1e-4),
        ] {
            let other = setup.moved(rotation, scale, translation);
            for (method, a) in ALL.iter().zip(&reference) {
                if *method == Method::Normal && rotation != DQuat::IDENTITY {
                    continue; // its box stands in a fixed frame of the light, around axis-aligned bounds
                }
                let b = solved(&other, *method);
                let differs = match (a, &b) {
                    // The cube around a light among the geometry stands on the world's axes.
                    (Some(a), Some(b)) if rotation != DQuat::IDENTITY && a.len().max(b.len()) > 1 => None,
                    (Some(a), Some(b)) => difference(*method, (&setup, a), (&other, b), tolerance),
                    (None, None) => None,
                    _ => Some("an answer and a refusal".to_owned()),
                };
                found.extend(differs.map(|d| format!("{method:?}, {name}, {what}: {d}")));
            }
        }
    }
    assert!(found.is_empty(), "{found:#?}");
}

/// The numbered failure modes: an answer that covers, or a named reason; never NaN, never a panic.
#[test]
fn hostile_inputs_get_an_answer_or_a_reason() {
    let room = room();
    let few = |n: usize| Setup { edges: room.edges[..n].to_vec(), covered: room.covered[..n].to_vec(), ..room.clone() };
    let ray = |k: f64| room.camera.position + room.camera.forward() * k + DVec3::new(0.0, -1e-3, 0.0);
    let lamp = |position: DVec3| room.with_light(LightKind::Point { position, range: None });
    let projected = |projection: Projection| {
        let camera = lixel::scene::Camera { projection, ..room.camera.clone() };
        crate::fixture::setup(camera, room.bounds, DVec3::new(0.6, -0.8, -0.35))
    };
    let mut cases = vec![
        ("along the view", room.with_direction(room.camera.forward())),
        ("against the view", room.with_direction(-room.camera.forward())),
        ("along the floor", room.with_direction(DVec3::X)),
        ("nothing", few(0)),
        ("one", few(1)),
        ("two", few(2)),
        ("lamp on the axis", lamp(ray(10.0))),
        ("lamp at the camera", lamp(room.camera.position)),
        ("lamp on the floor", lamp(DVec3::new(1.0, 0.0, -8.0))),
        ("lamp at a covered point", lamp(room.covered[3])),
        ("lamp in the room", lamp(DVec3::new(0.0, 1.0, -9.0))),
        ("thin field", projected(Projection::Perspective { yfov_rad: 1e-4 })),
        ("wide field", projected(Projection::Perspective { yfov_rad: 3.13 })),
        ("parallel", projected(Projection::Orthographic { half_height: 4.0 })),
        ("wide spot", {
            let direction = DVec3::NEG_Y;
            let position = DVec3::new(0.0, 3.0, -5.0);
            room.with_light(LightKind::Spot { position, direction, cone_rad: 1.57, range: None })
        }),
    ];
    let line: Vec<DVec3> = (0..9).map(|k| DVec3::new(f64::from(k) * 0.1, 0.0, -5.0 - f64::from(k))).collect();
    cases.push(("a line without edges", Setup { edges: vec![], covered: line, ..room.clone() }));
    cases.push(("one point many times", Setup { covered: vec![room.covered[5]; 40], ..few(1) }));
    let mut flat = room.clone();
    flat.camera.far = Some(flat.camera.near);
    cases.push(("near = far", flat));
    let mut endless = room.clone();
    endless.camera.far = None;
    cases.push(("no far plane", endless));
    let mut tight = room.clone();
    tight.bounds = lixel::math::Bounds::of(tight.covered.iter().copied());
    cases.push(("bounds of the cover", tight));
    for (scale, name) in [(1e-6, "tiny"), (1e9, "huge")] {
        cases.push((name, room.moved(DQuat::IDENTITY, scale, DVec3::ZERO)));
    }
    for (name, setup) in cases {
        for method in ALL {
            for aspect in [Aspect::Fixed(1.0), Aspect::Free] {
                let setup = Setup { aspect, ..setup.clone() };
                match setup.solve(method) {
                    Ok(regions) => assert_covers(&setup, &regions, &format!("{method:?}, {name}")),
                    Err(reason) => assert!(!reason.to_string().is_empty()),
                }
            }
        }
    }
}
