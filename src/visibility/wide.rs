//! The eight-wide tree the kernel walks, with leaves of up to eight triangles side by side.

use glam::Vec3;
use rayon::prelude::*;

use super::collapse::Collapsed;
use super::walk::Nearest;
use crate::scene::Triangle;

/// Children of a node, and triangles of a leaf.
pub(super) const WIDTH: usize = 8;

/// Deepest tree that may be walked: the kernel's stack holds [`WIDTH`] entries a level.
pub(super) const DEPTH_MAX: usize = 64;

/// Set in a child reference that names a leaf.
pub(super) const LEAF: u32 = 1 << 31;

/// Boxes are grown on every side by this much of the unit cube that holds all vertices: 64 roundings of f32 at 1, twice
/// what the kernel's arithmetic can err by (worked out in `kernel`). So the tree never changes an answer.
pub(super) const BOX_MARGIN: f32 = 64.0 * f32::EPSILON / 2.0;

/// Eight boxes side by side.
#[repr(C, align(64))]
#[derive(Clone, Debug)]
pub(super) struct Node {
    /// Rows: x low, x high, y low, y high, z low, z high. Absent children are boxes that no ray meets.
    pub(super) planes: [[f32; WIDTH]; 6],
    /// Index of a node, or of a leaf with [`LEAF`] set.
    pub(super) children: [u32; WIDTH],
}

/// Eight triangles side by side.
#[repr(C, align(64))]
#[derive(Clone, Debug)]
pub(super) struct Leaf {
    /// By vertex and axis. Absent triangles are NaN, which every test rejects.
    pub(super) vertices: [[[f32; WIDTH]; 3]; 3],
    /// Indices of the triangles as they were given.
    pub(super) triangles: [u32; WIDTH],
}

/// The tree; node 0 is the root. Without triangles there are no nodes.
#[derive(Default, Debug)]
pub(super) struct Wide {
    pub(super) nodes: Vec<Node>,
    pub(super) leaves: Vec<Leaf>,
}

pub(super) const EMPTY_NODE: Node = Node {
    planes: [
        [f32::INFINITY; WIDTH],
        [f32::NEG_INFINITY; WIDTH],
        [f32::INFINITY; WIDTH],
        [f32::NEG_INFINITY; WIDTH],
        [f32::INFINITY; WIDTH],
        [f32::NEG_INFINITY; WIDTH],
    ],
    children: [u32::MAX; WIDTH],
};

const EMPTY_LEAF: Leaf = Leaf { vertices: [[[f32::NAN; WIDTH]; 3]; 3], triangles: [u32::MAX; WIDTH] };

impl Wide {
    /// Appends a tree over `kept`, indices of `triangles`, and returns its root. The tree's boxes are in stored coordinates,
    /// which are `scale`, a power of two, times those of `triangles`.
    pub(super) fn append(&mut self, tree: &Collapsed, kept: &[u32], triangles: &[Triangle], scale: f32) -> u32 {
        let (root, first_leaf) = (self.nodes.len() as u32, self.leaves.len() as u32);
        self.nodes.extend(tree.nodes.iter().cloned().map(|mut node| {
            for child in node.children.iter_mut().filter(|child| **child != u32::MAX) {
                *child += if *child & LEAF != 0 { first_leaf } else { root };
            }
            node
        }));
        self.leaves.par_extend(tree.runs.par_iter().map(|run| {
            let mut leaf = EMPTY_LEAF;
            for (slot, &position) in tree.order[run.clone()].iter().enumerate() {
                let index = kept[position as usize];
                leaf.triangles[slot] = index;
                for (corner, vertex) in triangles[index as usize].iter().enumerate() {
                    for axis in 0..3 {
                        leaf.vertices[corner][axis][slot] = vertex[axis] * scale;
                    }
                }
            }
            leaf
        }));
        root
    }

    /// The corners of a triangle found, stored coordinates.
    #[inline(always)]
    pub(super) fn corners(&self, found: &Nearest) -> [Vec3; 3] {
        self.leaves[found.leaf as usize].corners(found.lane as usize)
    }
}

impl Leaf {
    /// The corners of a triangle, stored coordinates.
    #[inline(always)]
    pub(super) fn corners(&self, lane: usize) -> [Vec3; 3] {
        // No `map`: it would copy all eight triangles, and be compiled without AVX2.
        let [a, b, c] = &self.vertices;
        [corner(a, lane), corner(b, lane), corner(c, lane)]
    }
}

#[inline(always)]
fn corner([x, y, z]: &[[f32; WIDTH]; 3], lane: usize) -> Vec3 {
    let lane = lane % WIDTH;
    Vec3::new(x[lane], y[lane], z[lane])
}
