//! Rotations with a translation.

use glam::{DMat3, DMat4, DVec3};
use serde::{Deserialize, Serialize};

/// X ↦ rotation X + translation.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
pub struct RigidMotion {
    /// Orthonormal, det = 1.
    pub rotation: DMat3,
    /// Metres.
    pub translation: DVec3,
}

impl RigidMotion {
    /// A point moved.
    pub fn point(&self, p: DVec3) -> DVec3 {
        self.rotation * p + self.translation
    }

    /// A vector turned.
    pub fn vector(&self, v: DVec3) -> DVec3 {
        self.rotation * v
    }

    /// The point that is moved to `p`.
    pub fn inverse_point(&self, p: DVec3) -> DVec3 {
        self.rotation.transpose() * (p - self.translation)
    }

    /// The vector that is turned to `v`.
    pub fn inverse_vector(&self, v: DVec3) -> DVec3 {
        self.rotation.transpose() * v
    }

    /// First `first`, then this one.
    pub fn after(&self, first: &RigidMotion) -> RigidMotion {
        RigidMotion { rotation: self.rotation * first.rotation, translation: self.point(first.translation) }
    }

    /// The motion back.
    pub fn inverse(&self) -> RigidMotion {
        let rotation = self.rotation.transpose();
        RigidMotion { rotation, translation: -(rotation * self.translation) }
    }

    /// As a 4x4 matrix on (X, 1).
    pub fn matrix(&self) -> DMat4 {
        DMat4::from_translation(self.translation) * DMat4::from_mat3(self.rotation)
    }
}
