//! Dueling frusta: the sun swept through the view direction in steps of 0.01°.
//!
//! What is compared is the texel grid, g = ∂(u, v)ᵀ ∂(u, v) on the light's plane at the covered points: half a turn of a
//! map, which the published constructions make where the projected view direction turns round, is the same grid.

use crate::fixture::{Setup, gradients, room};
use glam::{DMat3, DQuat, DVec3};
use lixel::methods::{Inapplicable, Method};

/// Relative change of the grid in one step that counts as a jump. A turn of the light by 0.01° moves the body's outline
/// by less than a thousandth.
const JUMP: f64 = 0.02;

/// Grids at a few covered points.
fn grids(setup: &Setup, method: Method) -> Result<Vec<DMat3>, Inapplicable> {
    let regions = setup.solve(method)?;
    Ok(setup
        .covered
        .iter()
        .step_by(16)
        .map(|p| {
            gradients(&regions[0], *p)
                .iter()
                .fold(DMat3::ZERO, |sum, g| sum + DMat3::from_cols(*g * g.x, *g * g.y, *g * g.z))
        })
        .collect())
}

/// Angles of jumps and of refusals over a sweep that passes the view direction at `aside` degrees.
fn sweep(method: Method, aside: f64) -> (Vec<f64>, Vec<(f64, Inapplicable)>) {
    let setup = room();
    let camera = setup.camera.world_from_camera;
    let norm = |m: &DMat3| m.x_axis.length() + m.y_axis.length() + m.z_axis.length();
    let (mut jumps, mut refused) = (Vec::new(), Vec::new());
    let mut last: Option<Vec<DMat3>> = None;
    for k in -150..=150 {
        let degrees = f64::from(k) * 0.01;
        let turn = DQuat::from_axis_angle(camera.x_axis, degrees.to_radians())
            * DQuat::from_axis_angle(camera.y_axis, f64::to_radians(aside));
        match grids(&setup.with_direction(turn * setup.camera.forward()), method) {
            Err(reason) => refused.push((degrees, reason)),
            Ok(here) => {
                let jumped = |last: &Vec<DMat3>| {
                    last.iter().zip(&here).any(|(a, b)| norm(&(*a - *b)) > JUMP * norm(a).min(norm(b)))
                };
                if last.as_ref().is_some_and(jumped) {
                    jumps.push(degrees);
                }
                last = Some(here);
            }
        }
    }
    (jumps, refused)
}

#[test]
fn print_all() {
    for method in crate::fixture::ALL {
        for aside in [0.0, 0.003, 1.0] {
            let (jumps, refused) = sweep(method, aside);
            println!("{method:?} {aside}: jumps {jumps:?} refused {} {:?}", refused.len(), refused.first());
        }
    }
    let _ = DVec3::ZERO;
}
