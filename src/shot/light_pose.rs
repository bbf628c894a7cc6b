//! Where a light stands from frame to frame.
//!
//! A light knows its direction, not how it is turned about it: from frame to frame it is taken to turn by the smallest
//! rotation between its directions (parallel transport), so that its frame has no jump where a fixed rule would have one.

use crate::math::RigidMotion;
use crate::scene::{Light, LightKind};
use glam::{DMat3, DQuat, DVec3};

/// Scene from light for the same light in consecutive frames, from an arbitrary first one. Equal lights stand equally, to
/// the bit.
pub fn light_poses<'a>(lights: impl IntoIterator<Item = &'a Light>) -> Vec<RigidMotion> {
    let mut poses: Vec<RigidMotion> = Vec::new();
    let mut last: Option<&Light> = None;
    for light in lights {
        let pose = match (last, poses.last()) {
            (Some(before), Some(pose)) if before == light => *pose,
            (Some(before), Some(pose)) => {
                let turn = match (direction(before), direction(light)) {
                    (Some(a), Some(b)) if a != b => DMat3::from_quat(DQuat::from_rotation_arc(a, b)),
                    _ => DMat3::IDENTITY,
                };
                RigidMotion { rotation: turn * pose.rotation, translation: position(light) }
            }
            _ => RigidMotion { rotation: DMat3::IDENTITY, translation: position(light) },
        };
        poses.push(pose);
        last = Some(light);
    }
    poses
}

/// What takes a scene point of one frame to where it stands, seen from the light, in another one. `None` when the light
/// stands the same in both.
pub fn carry(there: &RigidMotion, here: &RigidMotion) -> Option<RigidMotion> {
    (there != here).then(|| here.after(&there.inverse()))
}

fn direction(light: &Light) -> Option<DVec3> {
    match light.kind {
        LightKind::Directional { direction } | LightKind::Spot { direction, .. } => Some(direction),
        LightKind::Point { .. } => None,
    }
}

fn position(light: &Light) -> DVec3 {
    light.position().unwrap_or(DVec3::ZERO)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spot(position: DVec3, direction: DVec3) -> Light {
        let kind = LightKind::Spot { position, direction: direction.normalize(), cone_rad: 0.5, range: None };
        Light { name: "s".into(), kind }
    }

    #[test]
    fn a_point_that_moves_with_the_light_stays_put_for_it() {
        let lights = [
            spot(DVec3::new(0.0, 3.0, 0.0), DVec3::NEG_Y),
            spot(DVec3::new(1.0, 3.0, 0.5), DVec3::new(0.3, -1.0, 0.2)),
            spot(DVec3::new(1.0, 3.0, 0.5), DVec3::new(0.3, 0.4, 0.2)),
        ];
        let poses = light_poses(&lights);
        for (light, pose) in lights.iter().zip(&poses) {
            let motion =
                carry(pose, &poses[0]).unwrap_or(RigidMotion { rotation: DMat3::IDENTITY, translation: DVec3::ZERO });
            let LightKind::Spot { position, direction, .. } = light.kind else { panic!("a spot") };
            assert!((motion.point(position + direction * 2.0) - DVec3::new(0.0, 1.0, 0.0)).length() < 1e-12);
            let p = DVec3::new(0.2, -0.7, 5.0);
            assert!((motion.inverse_point(motion.point(p)) - p).length() < 1e-12);
            assert!((motion.matrix().transform_point3(p) - motion.point(p)).length() < 1e-12);
        }
        assert!(carry(&poses[1], &poses[1]).is_none());
        let still = light_poses([&lights[1], &lights[1]]);
        assert_eq!(still[0], still[1]);
    }
}
