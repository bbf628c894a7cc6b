//! Dueling frusta: the sun swept through the view direction in steps of 0.01°.
//!
//! What is compared is the texel grid, g = ∂(u, v)ᵀ ∂(u, v) on the light's plane at the covered points: half a turn of a
//! map, which the published constructions make where the projected view direction turns round, is the same grid. A step
//! that changes it much is bisected: a change that stays when the step is a few millionths of a degree is a jump.

use crate::fixture::{Setup, gradients, place, room};
use glam::{DMat3, DQuat, DVec2};
use lixel::methods::{CascadeFit, CascadeSplit, Inapplicable, Method, Region};

/// Relative change of the grid that is looked into.
const CHANGE: f64 = 0.02;
/// Halvings of a step of 0.01°.
const HALVINGS: u32 = 14;

/// Grids at a few covered points, each with the place of the map that answers there.
type Grids = Vec<(usize, DMat3)>;

fn grids(setup: &Setup, method: Method) -> Result<Grids, Inapplicable> {
    let regions = setup.solve(method)?;
    let grid =
        |g: [glam::DVec3; 2]| g.iter().fold(DMat3::ZERO, |sum, g| sum + DMat3::from_cols(*g * g.x, *g * g.y, *g * g.z));
    let at = |p: &glam::DVec3| place(&regions, *p).map(|(map, ..)| (map, grid(gradients(&regions[map], *p))));
    Ok(setup.covered.iter().step_by(16).filter_map(at).collect())
}

/// Largest change of a grid. A point that a border has passed, from one map to the next, tells nothing of either.
fn change(a: &Grids, b: &Grids) -> f64 {
    let norm = |m: &DMat3| m.x_axis.length() + m.y_axis.length() + m.z_axis.length();
    let pairs = a.iter().zip(b).filter(|(a, b)| a.0 == b.0);
    pairs.map(|((_, a), (_, b))| norm(&(*a - *b)) / norm(a).min(norm(b))).fold(0.0, f64::max)
}

/// The sun at an angle before or after the view direction, which it passes `aside` degrees beside it.
fn light(setup: &Setup, degrees: f64, aside: f64) -> Setup {
    let camera = setup.camera.world_from_camera;
    let turn = DQuat::from_axis_angle(camera.x_axis, degrees.to_radians())
        * DQuat::from_axis_angle(camera.y_axis, f64::to_radians(aside));
    setup.with_direction(turn * setup.camera.forward())
}

/// Jumps and refusals, by angle, over `reach` steps before and after the view direction.
fn sweep(setup: &Setup, method: Method, aside: f64, reach: i32) -> (Vec<f64>, Vec<(f64, Inapplicable)>) {
    let at = |degrees: f64| grids(&light(setup, degrees, aside), method);
    let (mut jumps, mut refused) = (Vec::new(), Vec::new());
    let mut last: Option<Grids> = None;
    for k in -reach..=reach {
        let degrees = f64::from(k) * 0.01;
        let here = match at(degrees) {
            Ok(here) => here,
            Err(reason) => {
                refused.push((degrees, reason));
                last = None;
                continue;
            }
        };
        if let Some(mut low) = last
            && change(&low, &here) > CHANGE
        {
            let (mut lo, mut hi, mut high) = (degrees - 0.01, degrees, here.clone());
            for _ in 0..HALVINGS {
                let middle = 0.5 * (lo + hi);
                let Ok(half) = at(middle) else { break };
                if change(&low, &half) > change(&half, &high) {
                    (hi, high) = (middle, half);
                } else {
                    (lo, low) = (middle, half);
                }
            }
            if change(&low, &high) > CHANGE {
                jumps.push(degrees);
            }
        }
        last = Some(here);
    }
    (jumps, refused)
}

/// Steps before and after the view direction.
const REACH: i32 = 100;

/// What the published methods do on the way through the view direction, and nothing else does:
/// * TSM has no centre line where the camera looks exactly along the light, and says so there.
/// * Scene-optimal takes the best of nine fixed rotations, three times, and the minimum-area rectangle; it jumps where
///   another of them becomes the best.
/// * lixel and homography-area answer with the best matrix found, which may be another one after any step; what they
///   minimise does not jump.
/// * Stable cascades move by whole steps of their grid, which keep the texel grid; `several.rs` looks at the steps.
/// * Refocused separating planes jump at the view direction, where neither map has a warp and the plane changes sides.
/// * The maps of faces jump where the light shines across the view, far from here: the other end of its rays is then the
///   nearer one. `faces_jump_under_light_across_the_view` looks at it.
#[test]
fn direct_methods_have_no_jumps() {
    let mut cases: Vec<(Method, Setup)> = [
        Method::Normal,
        Method::Focused,
        Method::Psm,
        Method::Tsm,
        Method::Lispsm,
        Method::PlaneOptimal,
        Method::Faces,
    ]
    .map(|method| (method, room()))
    .into();
    for cascade_fit in [CascadeFit::Plain, CascadeFit::Stable, CascadeFit::Warped] {
        for cascade_split in [CascadeSplit::Blend, CascadeSplit::Samples] {
            let mut setup = room();
            (setup.solver.cascade_fit, setup.solver.cascade_split) = (cascade_fit, cascade_split);
            cases.push((Method::Cascades, setup));
        }
    }
    for iterations in [1, 2] {
        let mut setup = room();
        setup.solver.separating_iterations = iterations;
        cases.push((Method::SeparatingPlane, setup));
    }
    let mut found = Vec::new();
    for (method, setup) in cases {
        for aside in [0.0, 0.003, 1.0] {
            let (jumps, refused) = sweep(&setup, method, aside, REACH);
            let what = format!("{method:?} {:?} {aside}", setup.solver.cascade_fit);
            let refocused = method == Method::SeparatingPlane && setup.solver.separating_iterations > 1;
            let jumps: Vec<f64> = jumps.into_iter().filter(|d| !refocused || d.abs() > 0.015).collect();
            found.extend((!jumps.is_empty()).then(|| format!("{what} jumps at {jumps:?}")));
            let listed: &[_] =
                if method == Method::Tsm && aside == 0.0 { &[(0.0, Inapplicable::NoCentreLine)] } else { &[] };
            found.extend((refused != listed).then(|| format!("{what} refuses at {refused:?}")));
        }
    }
    assert!(found.is_empty(), "{found:#?}");
}

#[test]
fn scene_optimal_jumps_where_another_rotation_wins() {
    let (jumps, refused) = sweep(&room(), Method::SceneOptimal, 0.0, REACH);
    assert!(jumps.len() <= 4 && refused.is_empty(), "{jumps:?} {refused:?}");
}

#[test]
fn faces_jump_under_light_across_the_view() {
    let setup = room();
    let axes = setup.camera.world_from_camera;
    let across = |degrees: f64| {
        let turn = DQuat::from_axis_angle(axes.x_axis, degrees.to_radians());
        grids(&setup.with_direction(turn * (axes.x_axis * 0.3 - axes.y_axis)), Method::Faces).unwrap()
    };
    assert!(change(&across(-0.01), &across(0.01)) > CHANGE, "one end of the rays takes over from the other");
    assert!(change(&across(0.01), &across(0.02)) < CHANGE);
}

/// The predicted wrong pixels of lixel, and Colbert's areas (eq. 10) of homography-area.
#[test]
fn the_cost_of_searches_has_no_jumps() {
    let setup = room();
    let areas = |regions: &[Region]| {
        let terms = setup.edges.iter().map(|e| {
            let [u, v] = gradients(&regions[0], e.position);
            let [a, b] = e.derivatives.map(|d| DVec2::new(u.dot(d), v.dot(d)));
            let area = (a.perp_dot(b) * setup.texels).abs();
            e.length_px * (area - 1.0 / area).powi(2)
        });
        terms.sum::<f64>()
    };
    let wrong = |regions: &[Region]| regions[0].predict(setup.texels).misclassified;
    type Cost<'a> = &'a dyn Fn(&[Region]) -> f64;
    for (method, cost) in [(Method::Lixel, &wrong as Cost), (Method::HomographyArea, &areas as Cost)] {
        let mut last: Option<f64> = None;
        for k in -20..=20 {
            let cost = cost(&light(&setup, f64::from(k) * 0.01, 0.0).solve(method).unwrap());
            assert!(last.is_none_or(|l| (cost / l - 1.0).abs() < CHANGE), "{method:?} {k}: {last:?} {cost}");
            last = Some(cost);
        }
    }
}
