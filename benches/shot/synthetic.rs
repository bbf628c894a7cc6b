//! Parts of a walk over flat ground under a still sun, without a scene.
//!
//! Whoever includes this file brings `Camera`, `EdgePoint`, `Light`, `LightKind`, `LightPart` and `Projection` into scope.

use super::{Camera, EdgePoint, Light, LightKind, LightPart, Projection};
use glam::{DMat3, DVec2, DVec3};

/// Focal length of the film, pixels.
const FOCAL_PX: f64 = 1000.0;
/// Height of the eye, metres.
const EYE_M: f64 = 1.7;

/// Numbers in [0, 1) without pattern.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f64 / f64::from(1 << 24)
    }
}

/// A walk of `frames` frames, `step_m` metres each, of the light numbered `seed`, with `edges` edge samples a frame.
pub(crate) fn walk(seed: u64, frames: usize, step_m: f64, edges: usize) -> Vec<LightPart> {
    let mut random = Random(seed * 7919 + 1);
    let direction = DVec3::new(random.next() - 0.5, -0.4 - random.next(), random.next() - 0.5).normalize();
    let light = Light { name: format!("sun {seed}"), kind: LightKind::Directional { direction } };
    let (mut at, mut heading, mut turn) = (DVec2::ZERO, 0.0_f64, 0.0_f64);
    (0..frames)
        .map(|_| {
            // A walker who looks about: the heading swings, the more the longer it has.
            turn = (turn + (random.next() - 0.5) * 0.02).clamp(-0.05, 0.05);
            heading += turn;
            at += DVec2::from_angle(heading) * step_m;
            frame(&light, at, heading, edges, &mut random)
        })
        .collect()
}

/// What is seen of the ground in one frame: shadow edges anywhere in a wedge before the camera.
fn frame(light: &Light, at: DVec2, heading: f64, edges: usize, random: &mut Random) -> LightPart {
    let ground = |distance: f64, angle: f64| {
        let p = at + DVec2::from_angle(heading + angle) * distance;
        DVec3::new(p.x, 0.0, p.y)
    };
    let edge = |_| {
        // Evenly spread over the film's rows below the horizon.
        let (below, angle) = (0.05 + random.next() * 0.6, (random.next() - 0.5) * 1.1);
        let distance = EYE_M / below;
        let (ahead, aside) = (DVec2::from_angle(heading + angle), DVec2::from_angle(heading + angle).perp());
        let across = distance / FOCAL_PX;
        let along = distance * distance / (EYE_M * FOCAL_PX);
        EdgePoint {
            film: [640.0 + FOCAL_PX * angle, 360.0 + FOCAL_PX * below],
            position: ground(distance, angle),
            derivatives: [DVec3::new(aside.x, 0.0, aside.y) * across, DVec3::new(-ahead.x, 0.0, -ahead.y) * along],
            normal: DVec2::from_angle(random.next() * std::f64::consts::TAU),
            length_px: 4.0 * 600.0 / edges as f64,
            room_px: 20.0 + 40.0 * random.next(),
            uncertain: false,
        }
    };
    let edges: Vec<EdgePoint> = (0..edges).map(edge).collect();
    let cover = [EYE_M / 0.05, EYE_M / 0.65].into_iter().flat_map(|d| [-0.56, -0.2, 0.2, 0.56].map(|a| ground(d, a)));
    let camera = Camera {
        name: String::new(),
        position: DVec3::new(at.x, EYE_M, at.y),
        world_from_camera: DMat3::IDENTITY,
        projection: Projection::Perspective { yfov_rad: 0.7 },
        near: 0.1,
        far: None,
    };
    let facing = 500_000;
    LightPart { cover: cover.collect(), edges, facing, needed: facing / 4, ..LightPart::blank(light.clone(), camera) }
}
