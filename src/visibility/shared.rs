//! The tree of a mesh that instances share, in the mesh's own space.
//!
//! Only its boxes are asked there. Its leaves keep the mesh's vertices in f64; a leaf that a ray comes to is placed, by the
//! arithmetic of [`Instance::place`], and tested in the scene with the ray of the scene. So a ray meets what it would
//! meet if the instance's triangles were listed: to the bit, watertight, with the same lift off surfaces.

use glam::{DVec3, Vec3A};
use obvhs::aabb::Aabb;
use rayon::prelude::*;

use super::bvh::{tree_of_triangles, unit_scale};
use super::wide::{DEPTH_MAX, Leaf, Node, WIDTH};
use crate::scene::{Instance, SharedMesh};

/// Eight triangles of a mesh side by side, in its space.
#[derive(Clone, Debug)]
pub(super) struct MeshLeaf {
    /// By vertex and axis. Absent triangles are NaN, which every test rejects.
    vertices: [[[f64; WIDTH]; 3]; 3],
    /// Indices in the mesh; `u32::MAX` for absent ones.
    pub(super) triangles: [u32; WIDTH],
}

/// A tree over the triangles of a mesh.
#[derive(Debug)]
pub(super) struct SharedTree {
    pub(super) nodes: Vec<Node>,
    pub(super) leaves: Vec<MeshLeaf>,
    /// Stored coordinate = scale × (coordinate in the mesh's space - centre); a power of two.
    pub(super) scale: f64,
    pub(super) centre: DVec3,
    /// Lower and upper corner, stored coordinates.
    pub(super) bounds: [DVec3; 2],
}

impl SharedTree {
    /// Over all triangles: which of them have an area is known once they are placed.
    pub(super) fn build(mesh: &SharedMesh) -> SharedTree {
        let (low, high) = mesh
            .vertices
            .iter()
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), v| (low.min(*v), high.max(*v)));
        let centre = low.midpoint(high);
        let half = (high - centre).max(centre - low).max_element();
        // Rounded up, so that no vertex rounds to more than 1; a mesh without extent has no triangles with area.
        let scale = unit_scale((half as f32).next_up().max(f32::MIN_POSITIVE));
        let stored = |v: DVec3| (v - centre) * scale;
        let corners = |k: &[u32; 3]| k.map(|v| Vec3A::from(stored(mesh.vertices[v as usize]).as_vec3()));
        let boxes: Vec<Aabb> = mesh.triangles.par_iter().map(|k| Aabb::from_points(&corners(k))).collect();
        let tree = tree_of_triangles(&boxes, DEPTH_MAX);
        let leaves = tree.runs.par_iter().map(|run| MeshLeaf::of(mesh, &tree.order[run.clone()])).collect();
        SharedTree { nodes: tree.nodes, leaves, scale, centre, bounds: [stored(low), stored(high)] }
    }
}

impl MeshLeaf {
    fn of(mesh: &SharedMesh, triangles: &[u32]) -> MeshLeaf {
        let mut leaf = MeshLeaf { vertices: [[[f64::NAN; WIDTH]; 3]; 3], triangles: [u32::MAX; WIDTH] };
        for (slot, &index) in triangles.iter().enumerate().take(WIDTH) {
            leaf.triangles[slot] = index;
            for (corner, vertex) in mesh.triangles[index as usize].into_iter().enumerate() {
                let vertex = mesh.vertices[vertex as usize];
                for axis in 0..3 {
                    leaf.vertices[corner][axis][slot] = vertex[axis];
                }
            }
        }
        leaf
    }

    /// The triangles where an instance has them, `scale` times their scene coordinates. The operations are those of
    /// [`Instance::place`] in their order, eight at a time.
    #[inline(always)]
    pub(super) fn placed(&self, instance: &Instance, scale: f32) -> Leaf {
        let mut leaf = Leaf { vertices: [[[0.0; WIDTH]; 3]; 3], triangles: self.triangles };
        let matrix = instance.world_from_mesh.matrix3;
        let (columns, shift) = ([matrix.x_axis, matrix.y_axis, matrix.z_axis], instance.world_from_mesh.translation);
        let order = if instance.mirrored { [0, 2, 1] } else { [0, 1, 2] };
        for (corner, from) in order.into_iter().enumerate() {
            let [x, y, z] = &self.vertices[from];
            for axis in 0..3 {
                let [a, b, c] = [columns[0][axis], columns[1][axis], columns[2][axis]];
                let (t, origin) = (shift[axis], instance.origin[axis]);
                for lane in 0..WIDTH {
                    let placed = a * x[lane] + b * y[lane] + c * z[lane] + t - origin;
                    leaf.vertices[corner][axis][lane] = placed as f32 * scale;
                }
            }
        }
        leaf
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Marks;
    use glam::{DAffine3, DQuat, Vec3};

    #[test]
    fn a_placed_leaf_has_the_instance_s_triangles_to_the_bit() {
        let at = |k: u32| DVec3::new(f64::from(k * 37 % 11), f64::from(k * 53 % 7) / 3.0, f64::from(k) / 7.0) + 1e5;
        let vertices: Vec<DVec3> = (0..40).map(at).collect();
        let triangles: Vec<[u32; 3]> = (0..38).map(|k| [k, k + 1, k + 2]).collect();
        let mesh = SharedMesh { vertices, triangles, marks: Marks::new() };
        let tree = SharedTree::build(&mesh);
        for mirror in [1.0, -1.0] {
            let scale = DVec3::new(0.1 * mirror, 2.7, 0.9);
            let turn = DQuat::from_rotation_x(0.3) * DQuat::from_rotation_z(1.1);
            let instance = Instance {
                mesh: 0,
                first: 0,
                count: 38,
                world_from_mesh: DAffine3::from_scale_rotation_translation(scale, turn, DVec3::new(-3.3, 0.1, 7.7)),
                origin: DVec3::new(1024.0, 0.0, -5.0),
                mirrored: mirror < 0.0,
                bounds: [Vec3::ZERO; 2],
            };
            let mut seen = 0;
            for leaf in &tree.leaves {
                let placed = leaf.placed(&instance, 0.25);
                for (lane, &index) in leaf.triangles.iter().enumerate().filter(|(_, index)| **index != u32::MAX) {
                    let listed = instance.triangle(&mesh, index as usize).map(|v| v * 0.25);
                    assert_eq!(placed.corners(lane), listed);
                    seen += 1;
                }
            }
            assert_eq!(seen, 38);
        }
    }
}
