//! The eight-wide tree the kernel walks: a binary tree collapsed, with leaves of up to eight triangles side by side.
//!
//! Collapse after Wald, Benthin and Boulos 2008 ("Getting rid of packets"): a node's children are opened, largest surface
//! first, until there are eight. Every subtree of at most eight triangles is a leaf, because the kernel tests eight
//! triangles at once for about the price of eight boxes.

use glam::Vec3;
use obvhs::bvh2::Bvh2;

use super::walk::Nearest;
use crate::scene::Triangle;

/// Children of a node, and triangles of a leaf.
pub(super) const WIDTH: usize = 8;

/// Deepest tree that may be walked: the kernel's stack holds [`WIDTH`] entries a level.
pub(super) const DEPTH_MAX: usize = 64;

/// Set in a child reference that names a leaf.
pub(super) const LEAF: u32 = 1 << 31;

/// Boxes are grown on every side by this much of the unit cube that holds all coordinates: 32 roundings of f32 at 1.
/// The kernel's own arithmetic on vertices and box planes errs by less than 16 of them (see `kernel`), so a triangle
/// it would call hit always lies behind boxes it calls hit, and the tree never changes an answer.
pub(super) const BOX_MARGIN: f32 = 32.0 * f32::EPSILON / 2.0;

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

const EMPTY_NODE: Node = Node {
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
    /// Collapses a binary tree over `kept`, whose entries index `triangles`; stored coordinates are multiplied by
    /// `scale`, a power of two.
    pub(super) fn collapse(binary: &Bvh2, kept: &[u32], triangles: &[Triangle], scale: f64) -> Wide {
        let mut wide = Wide::default();
        if binary.nodes.is_empty() {
            return wide;
        }
        let tree = Ranges::new(binary, kept, triangles, scale as f32);
        wide.nodes.push(EMPTY_NODE);
        let root = Subtree { node: Some(0), start: 0, end: tree.order.len() };
        let mut open = vec![(root, 0, 1)];
        while let Some((from, to, depth)) = open.pop() {
            let balanced = depth + BALANCED_DEPTH > DEPTH_MAX;
            for (slot, child) in tree.children(&from, balanced).into_iter().enumerate() {
                let [low, high] = tree.bounds(&child);
                for axis in 0..3 {
                    wide.nodes[to].planes[2 * axis][slot] = low[axis] - BOX_MARGIN;
                    wide.nodes[to].planes[2 * axis + 1][slot] = high[axis] + BOX_MARGIN;
                }
                if child.len() <= WIDTH {
                    wide.nodes[to].children[slot] = LEAF | wide.leaves.len() as u32;
                    wide.leaves.push(tree.leaf(&child));
                } else {
                    wide.nodes[to].children[slot] = wide.nodes.len() as u32;
                    open.push((child, wide.nodes.len(), depth + 1));
                    wide.nodes.push(EMPTY_NODE);
                }
            }
        }
        wide
    }
}

impl Wide {
    /// The corners of a triangle found, stored coordinates.
    pub(super) fn corners(&self, found: &Nearest) -> [Vec3; 3] {
        let leaf = &self.leaves[found.leaf as usize];
        let lane = found.lane as usize % WIDTH;
        leaf.vertices.map(|[x, y, z]| Vec3::new(x[lane], y[lane], z[lane]))
    }
}

/// A balanced tree over 2³² triangles is no deeper than this: ⌈32 / log2(8)⌉.
const BALANCED_DEPTH: usize = 11;

/// A run of triangles in depth-first order, and the binary node above exactly these where there is one.
struct Subtree {
    node: Option<usize>,
    start: usize,
    end: usize,
}

impl Subtree {
    fn len(&self) -> usize {
        self.end - self.start
    }
}

/// A binary tree whose triangles stand in depth-first order, so that each node is a run of them.
struct Ranges<'a> {
    binary: &'a Bvh2,
    triangles: &'a [Triangle],
    scale: f32,
    /// Indices into `triangles`, depth first.
    order: Vec<u32>,
    /// By binary node: first and past-the-last position in `order`.
    runs: Vec<[u32; 2]>,
    /// By binary node: exact bounds, scaled.
    bounds: Vec<[Vec3; 2]>,
}

impl<'a> Ranges<'a> {
    fn new(binary: &'a Bvh2, kept: &[u32], triangles: &'a [Triangle], scale: f32) -> Ranges<'a> {
        let nodes = &binary.nodes;
        let mut ranges = Ranges {
            binary,
            triangles,
            scale,
            order: Vec::with_capacity(kept.len()),
            runs: vec![[0; 2]; nodes.len()],
            bounds: vec![[Vec3::ZERO; 2]; nodes.len()],
        };
        let mut before_children = Vec::with_capacity(nodes.len());
        let mut open = vec![0];
        while let Some(index) = open.pop() {
            before_children.push(index);
            let node = &nodes[index];
            if node.is_leaf() {
                let start = ranges.order.len();
                let own = &binary.primitive_indices[node.first_index as usize..][..node.prim_count as usize];
                ranges.order.extend(own.iter().map(|&k| kept[k as usize]));
                ranges.runs[index] = [start as u32, ranges.order.len() as u32];
                ranges.bounds[index] = ranges.bounds_of(start, ranges.order.len());
            } else {
                let left = node.first_index as usize;
                open.extend([left + 1, left]);
            }
        }
        for &index in before_children.iter().rev() {
            let node = &nodes[index];
            if !node.is_leaf() {
                let left = node.first_index as usize;
                let ([a, b], [c, d]) = (ranges.bounds[left], ranges.bounds[left + 1]);
                ranges.bounds[index] = [a.min(c), b.max(d)];
                ranges.runs[index] = [ranges.runs[left][0], ranges.runs[left + 1][1]];
            }
        }
        ranges
    }

    fn subtree(&self, node: usize) -> Subtree {
        let [start, end] = self.runs[node];
        Subtree { node: Some(node), start: start as usize, end: end as usize }
    }

    /// Up to [`WIDTH`] parts of a subtree: its binary tree opened, or equal runs of it when `balanced` or when there is
    /// no tree below it.
    fn children(&self, from: &Subtree, balanced: bool) -> Vec<Subtree> {
        if from.len() <= WIDTH {
            return vec![Subtree { node: from.node, start: from.start, end: from.end }];
        }
        match from.node {
            Some(node) if !balanced && !self.binary.nodes[node].is_leaf() => self.opened(node),
            _ => (0..WIDTH)
                .map(|k| (from.start + from.len() * k / WIDTH, from.start + from.len() * (k + 1) / WIDTH))
                .map(|(start, end)| Subtree { node: None, start, end })
                .collect(),
        }
    }

    /// The children of a node, the one of largest area opened until there are [`WIDTH`] or all are leaves.
    fn opened(&self, node: usize) -> Vec<Subtree> {
        let left = self.binary.nodes[node].first_index as usize;
        let mut children = vec![left, left + 1];
        while children.len() < WIDTH {
            let can_open = |&&child: &&usize| {
                self.runs[child][1] - self.runs[child][0] > WIDTH as u32 && !self.binary.nodes[child].is_leaf()
            };
            let largest = children
                .iter()
                .enumerate()
                .filter(|(_, child)| can_open(child))
                .max_by(|(_, a), (_, b)| self.half_area(**a).total_cmp(&self.half_area(**b)));
            let Some((slot, &child)) = largest else { break };
            let left = self.binary.nodes[child].first_index as usize;
            children[slot] = left;
            children.push(left + 1);
        }
        children.into_iter().map(|child| self.subtree(child)).collect()
    }

    fn half_area(&self, node: usize) -> f32 {
        let [low, high] = self.bounds[node];
        let d = high - low;
        d.x * d.y + d.y * d.z + d.z * d.x
    }

    fn bounds(&self, of: &Subtree) -> [Vec3; 2] {
        of.node.map_or_else(|| self.bounds_of(of.start, of.end), |node| self.bounds[node])
    }

    fn bounds_of(&self, start: usize, end: usize) -> [Vec3; 2] {
        let vertices = self.order[start..end].iter().flat_map(|&i| self.triangles[i as usize]);
        let empty = [Vec3::INFINITY, Vec3::NEG_INFINITY];
        let [low, high] = vertices.fold(empty, |[low, high], v| [low.min(v), high.max(v)]);
        [low * self.scale, high * self.scale]
    }

    fn leaf(&self, of: &Subtree) -> Leaf {
        let mut leaf = EMPTY_LEAF;
        for (slot, &index) in self.order[of.start..of.end].iter().enumerate() {
            leaf.triangles[slot] = index;
            for (corner, vertex) in self.triangles[index as usize].iter().enumerate() {
                for axis in 0..3 {
                    leaf.vertices[corner][axis][slot] = vertex[axis] * self.scale;
                }
            }
        }
        leaf
    }
}
