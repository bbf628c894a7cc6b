//! Dueling frusta: the sun swept through the view direction in steps of 0.01°.
//!
//! What is compared is the texel grid, g = ∂(u, v)ᵀ ∂(u, v) on the light's plane at the covered points: half a turn of a
//! map, which the published constructions make where the projected view direction turns round, is the same grid. A step
//! that changes it much is bisected: a change that stays when the step is a few millionths of a degree is a jump.

use crate::fixture::{ALL, Setup, gradients, room};
use glam::{DMat3, DQuat};
use lixel::methods::{Inapplicable, Method};

/// Relative change of the grid that is looked into.
const CHANGE: f64 = 0.02;
/// Halvings of a step of 0.01°.
const HALVINGS: u32 = 14;

/// Grids at a few covered points.
fn grids(setup: &Setup, method: Method) -> Result<Vec<DMat3>, Inapplicable> {
    let regions = setup.solve(method)?;
    let grid =
        |g: [glam::DVec3; 2]| g.iter().fold(DMat3::ZERO, |sum, g| sum + DMat3::from_cols(*g * g.x, *g * g.y, *g * g.z));
    Ok(setup.covered.iter().step_by(16).map(|p| grid(gradients(&regions[0], *p))).collect())
}

fn change(a: &[DMat3], b: &[DMat3]) -> f64 {
    let norm = |m: &DMat3| m.x_axis.length() + m.y_axis.length() + m.z_axis.length();
    a.iter().zip(b).map(|(a, b)| norm(&(*a - *b)) / norm(a).min(norm(b))).fold(0.0, f64::max)
}

/// Jumps and refusals, by angle, over a sweep that passes the view direction at `aside` degrees.
fn sweep(method: Method, aside: f64) -> (Vec<f64>, Vec<(f64, Inapplicable)>) {
    let setup = room();
    let camera = setup.camera.world_from_camera;
    let at = |degrees: f64| {
        let turn = DQuat::from_axis_angle(camera.x_axis, degrees.to_radians())
            * DQuat::from_axis_angle(camera.y_axis, f64::to_radians(aside));
        grids(&setup.with_direction(turn * setup.camera.forward()), method)
    };
    let (mut jumps, mut refused) = (Vec::new(), Vec::new());
    let mut last: Option<Vec<DMat3>> = None;
    for k in -100..=100 {
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

#[test]
fn print_all() {
    for method in ALL {
        for aside in [0.0, 0.003, 1.0] {
            let (jumps, refused) = sweep(method, aside);
            println!(
                "{method:?} {aside}: {} jumps {:?} refused {} {:?}",
                jumps.len(),
                jumps.first(),
                refused.len(),
                refused.first()
            );
        }
    }
}
