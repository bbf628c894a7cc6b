//! World matrices and visibility of all nodes at a time. Nodes stand parents first, so one pass without recursion does it.

use super::SceneError;
use super::model::Node;
use glam::{DAffine3, DMat3, DVec3};

/// World matrices and visibility, kept up to date from time to time by re-posing only what is animated.
#[derive(Clone, Debug)]
pub(super) struct Pose {
    /// World-from-node, one a node.
    pub world_from_node: Vec<DAffine3>,
    /// True for a node that hides itself or lies below one that does.
    pub hidden: Vec<bool>,
}

/// Nodes whose world matrix or visibility may change: those animated themselves or below an animated one, parents first.
pub(super) fn animated_nodes(nodes: &[Node]) -> Vec<usize> {
    let mut animated = vec![false; nodes.len()];
    for (index, node) in nodes.iter().enumerate() {
        animated[index] = !node.tracks.is_still() || node.parent.is_some_and(|parent| animated[parent]);
    }
    (0..nodes.len()).filter(|&index| animated[index]).collect()
}

impl Pose {
    /// All nodes at a time.
    ///
    /// # Errors
    /// [`SceneError::Pose`] for a rotation without length or an overflow.
    pub(super) fn at(nodes: &[Node], time_s: f64) -> Result<Self, SceneError> {
        let mut pose =
            Pose { world_from_node: vec![DAffine3::IDENTITY; nodes.len()], hidden: vec![false; nodes.len()] };
        pose.move_to(nodes, 0..nodes.len(), time_s)?;
        Ok(pose)
    }

    /// The same at another time, where only `which` (parents first) have moved.
    pub(super) fn move_to(
        &mut self,
        nodes: &[Node],
        which: impl IntoIterator<Item = usize>,
        time_s: f64,
    ) -> Result<(), SceneError> {
        for index in which {
            let node = &nodes[index];
            let local = node.parent_from_node(time_s)?;
            let world = node.parent.map_or(local, |parent| self.world_from_node[parent] * local);
            if !world.is_finite() {
                return Err(node.pose_error("the transform overflows; check scales and matrices above it", time_s));
            }
            self.world_from_node[index] = world;
            self.hidden[index] = node.hides(time_s) || node.parent.is_some_and(|parent| self.hidden[parent]);
        }
        Ok(())
    }
}

/// The rotation of a camera or light from its node's world matrix, by Gram-Schmidt: the view axis z is kept, then y is
/// made orthogonal to it, and x = y × z. Scale, shear and mirroring thus change neither the view axis nor the picture.
/// `None` when the matrix is singular in z or y.
pub(super) fn orthonormal_rotation(linear: DMat3) -> Option<DMat3> {
    let z = linear.z_axis.try_normalize()?;
    // Two passes: y may be nearly parallel to z, and one pass leaves a component along z behind.
    let y = linear.y_axis.try_normalize()?.reject_from_normalized(z).try_normalize()?;
    let y = y.reject_from_normalized(z).try_normalize()?;
    Some(DMat3::from_cols(y.cross(z), y, z))
}

/// Unit direction of the node's -z in world space; `None` when that axis has no length.
pub(super) fn minus_z(linear: DMat3) -> Option<DVec3> {
    (-linear.z_axis).try_normalize()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;

    #[test]
    fn rotation_survives_scale_mirror_and_shear() {
        let q = DMat3::from_quat(DQuat::from_rotation_y(0.4) * DQuat::from_rotation_x(-0.9));
        let scaled = q * DMat3::from_diagonal(DVec3::new(-3.0, 0.01, 200.0));
        assert!(orthonormal_rotation(scaled).unwrap().abs_diff_eq(q, 1e-14));
        let sheared = DMat3::from_cols(q.x_axis, q.y_axis + 1e6 * q.z_axis, q.z_axis);
        let r = orthonormal_rotation(sheared).unwrap();
        assert!((r.transpose() * r).abs_diff_eq(DMat3::IDENTITY, 1e-14));
        assert!((r.determinant() - 1.0).abs() < 1e-14);
        assert!(orthonormal_rotation(DMat3::ZERO).is_none());
        assert!(minus_z(q).unwrap().abs_diff_eq(-q.z_axis, 1e-15));
    }
}
