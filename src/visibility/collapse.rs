//! A binary tree over boxes → nodes of eight children.
//!
//! After Wald, Benthin and Boulos 2008 ("Getting rid of packets"): a node's children are opened, largest surface first,
//! until there are eight. A tree that grows too deep for the walk's stack is given up there and its boxes split evenly.

use std::ops::Range;

use glam::Vec3;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;

use super::wide::{BOX_MARGIN, EMPTY_NODE, LEAF, Node, WIDTH};

/// Nodes of eight children; node 0 is the root. Leaf references count through `runs`.
pub(super) struct Collapsed {
    pub(super) nodes: Vec<Node>,
    /// Of `order`, one a leaf.
    pub(super) runs: Vec<Range<usize>>,
    /// Indices of the boxes.
    pub(super) order: Vec<u32>,
}

/// Collapses a binary tree over `boxes`, whose leaves hold at most `leaf_max` of them, to at most `depth_max` levels.
pub(super) fn collapse(binary: &Bvh2, boxes: &[Aabb], leaf_max: usize, depth_max: usize) -> Collapsed {
    let order = binary.primitive_indices.clone();
    let mut tree = Topology { binary, boxes, leaf_max, depth_max, order, nodes: Vec::new(), leaves: Vec::new() };
    tree.collapse();
    Collapsed { nodes: tree.nodes, runs: tree.leaves, order: tree.order }
}

/// A balanced tree over 2³² triangles is no deeper than this: ⌈32 / log2(8)⌉.
const BALANCED_DEPTH: usize = 11;

/// A part of the tree to be.
#[derive(Clone, Debug)]
enum Part {
    /// A node of the binary tree with everything below it.
    Node(usize),
    /// Triangles, as positions in `Topology::order`.
    Run(Range<usize>),
}

/// A tree in the making.
struct Topology<'a> {
    binary: &'a Bvh2,
    boxes: &'a [Aabb],
    leaf_max: usize,
    depth_max: usize,
    /// Indices into `boxes`; leaves are runs of them.
    order: Vec<u32>,
    nodes: Vec<Node>,
    leaves: Vec<Range<usize>>,
}

impl Topology<'_> {
    fn collapse(&mut self) {
        if self.binary.nodes.is_empty() {
            return;
        }
        self.nodes.push(EMPTY_NODE);
        let mut open = vec![(Part::Node(0), 0, 1)];
        while let Some((part, to, depth)) = open.pop() {
            let part = if depth + BALANCED_DEPTH > self.depth_max { self.flattened(part) } else { part };
            for (slot, child) in self.children(part).into_iter().enumerate() {
                let [low, high] = self.bounds(&child);
                let reference = match self.run(&child) {
                    Some(run) if run.len() <= self.leaf_max => {
                        self.leaves.push(run);
                        LEAF | (self.leaves.len() - 1) as u32
                    }
                    _ => {
                        open.push((child, self.nodes.len(), depth + 1));
                        self.nodes.push(EMPTY_NODE);
                        (self.nodes.len() - 1) as u32
                    }
                };
                let node = &mut self.nodes[to];
                node.children[slot] = reference;
                for axis in 0..3 {
                    node.planes[2 * axis][slot] = low[axis] - BOX_MARGIN;
                    node.planes[2 * axis + 1][slot] = high[axis] + BOX_MARGIN;
                }
            }
        }
    }

    /// Up to [`WIDTH`] parts of a part.
    fn children(&self, part: Part) -> Vec<Part> {
        match (self.run(&part), part) {
            (Some(run), _) if run.len() <= self.leaf_max => vec![Part::Run(run)],
            (Some(run), _) => (0..WIDTH)
                .map(|k| run.start + run.len() * k / WIDTH..run.start + run.len() * (k + 1) / WIDTH)
                .filter(|part| !part.is_empty())
                .map(Part::Run)
                .collect(),
            (None, Part::Node(node)) => self.opened(node),
            (None, Part::Run(_)) => Vec::new(),
        }
    }

    /// The children of a node, the one of largest area opened until there are [`WIDTH`] or all are leaves.
    fn opened(&self, node: usize) -> Vec<Part> {
        let left = self.binary.nodes[node].first_index as usize;
        let mut children = Vec::with_capacity(WIDTH);
        children.extend([left, left + 1]);
        while children.len() < WIDTH {
            let area = |&child: &usize| {
                let node = &self.binary.nodes[child];
                if node.is_leaf() { f32::NEG_INFINITY } else { node.aabb().half_area() }
            };
            let largest = (0..children.len()).max_by(|&a, &b| area(&children[a]).total_cmp(&area(&children[b])));
            let Some(slot) = largest.filter(|&slot| area(&children[slot]) > f32::NEG_INFINITY) else { break };
            let left = self.binary.nodes[children[slot]].first_index as usize;
            children[slot] = left;
            children.push(left + 1);
        }
        // A walk for any hit goes to the last child first: a leaf costs no more than a node and may end it.
        children.sort_by_key(|&child| self.binary.nodes[child].is_leaf());
        children.into_iter().map(Part::Node).collect()
    }

    /// The triangles of a part, where it has no tree below it.
    fn run(&self, part: &Part) -> Option<Range<usize>> {
        match part {
            Part::Run(run) => Some(run.clone()),
            Part::Node(node) => {
                let node = &self.binary.nodes[*node];
                node.is_leaf().then(|| node.first_index as usize..(node.first_index + node.prim_count) as usize)
            }
        }
    }

    /// The triangles below a part as one run, depth first: its tree is given up, because it is too deep.
    fn flattened(&mut self, part: Part) -> Part {
        if self.run(&part).is_some() {
            return part;
        }
        let start = self.order.len();
        let mut open = vec![part];
        while let Some(part) = open.pop() {
            match (self.run(&part), part) {
                (Some(run), _) => self.order.extend_from_within(run),
                (None, Part::Node(node)) => {
                    let left = self.binary.nodes[node].first_index as usize;
                    open.extend([Part::Node(left + 1), Part::Node(left)]);
                }
                (None, Part::Run(_)) => {}
            }
        }
        Part::Run(start..self.order.len())
    }

    fn bounds(&self, part: &Part) -> [Vec3; 2] {
        let aabb = match part {
            Part::Node(node) => *self.binary.nodes[*node].aabb(),
            Part::Run(run) => self.order[run.clone()]
                .iter()
                .map(|&i| self.boxes[i as usize])
                .reduce(|a, b| a.union(&b))
                .unwrap_or_else(Aabb::empty),
        };
        [aabb.min.into(), aabb.max.into()]
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3A;
    use obvhs::bvh2::node::Bvh2Node;

    use super::super::wide::{DEPTH_MAX, Wide};
    use super::*;
    use crate::scene::Triangle;

    fn boxes(triangles: &[Triangle]) -> Vec<Aabb> {
        triangles.iter().map(|t| Aabb::from_points(&t.map(Vec3A::from))).collect()
    }

    /// A tree that is a chain: every node has one leaf of one triangle and the rest.
    fn chain(triangles: &[Triangle]) -> Bvh2 {
        let leaf = |i: usize| Bvh2Node::new(Aabb::from_points(&triangles[i].map(Vec3A::from)), 1, i as u32);
        let everything = triangles.iter().flatten().fold(Aabb::empty(), |mut all, &v| *all.extend(v.into()));
        let mut nodes = vec![Bvh2Node::new(everything, 0, 1)];
        for i in 0..triangles.len() - 2 {
            nodes.push(leaf(i));
            nodes.push(Bvh2Node::new(everything, 0, nodes.len() as u32 + 1));
        }
        nodes.extend([leaf(triangles.len() - 2), leaf(triangles.len() - 1)]);
        Bvh2 { nodes, primitive_indices: (0..triangles.len() as u32).collect(), ..Default::default() }
    }

    fn depth(wide: &Wide, node: u32) -> usize {
        let inner = wide.nodes[node as usize].children.iter().filter(|&&child| child & LEAF == 0);
        1 + inner.map(|&child| depth(wide, child)).max().unwrap_or(0)
    }

    #[test]
    fn a_tree_that_is_too_deep_is_cut_and_keeps_every_triangle() {
        let corner = |i: usize| Vec3::new(i as f32 / 2048.0, 0.0, 0.0);
        let triangles: Vec<Triangle> =
            (0..2000).map(|i| [corner(i), corner(i) + Vec3::Y * 0.1, corner(i) + Vec3::Z * 0.1]).collect();
        let kept: Vec<u32> = (0..2000).collect();
        let mut wide = Wide::default();
        wide.append(&collapse(&chain(&triangles), &boxes(&triangles), WIDTH, DEPTH_MAX), &kept, &triangles, 1.0);
        assert!(depth(&wide, 0) <= DEPTH_MAX, "{} deep", depth(&wide, 0));
        let mut found: Vec<u32> =
            wide.leaves.iter().flat_map(|leaf| leaf.triangles).filter(|&i| i != u32::MAX).collect();
        found.sort_unstable();
        assert_eq!(found, kept);
    }

    #[test]
    fn boxes_hold_what_is_below_them() {
        let corner =
            |i: usize, k: usize| Vec3::new((i * 37 % 101) as f32, (i * 53 % 97) as f32, (i + k) as f32) / 128.0;
        let triangles: Vec<Triangle> = (0..100).map(|i| [corner(i, 0), corner(i, 1), corner(i + 1, 0)]).collect();
        let kept: Vec<u32> = (0..100).collect();
        let mut wide = Wide::default();
        wide.append(&collapse(&chain(&triangles), &boxes(&triangles), WIDTH, DEPTH_MAX), &kept, &triangles, 1.0);
        let mut checked = 0;
        for node in &wide.nodes {
            for slot in (0..WIDTH).filter(|&slot| node.children[slot] & LEAF != 0 && node.children[slot] != u32::MAX) {
                let leaf = &wide.leaves[(node.children[slot] & !LEAF) as usize];
                for &index in leaf.triangles.iter().filter(|&&index| index != u32::MAX) {
                    for (axis, vertex) in triangles[index as usize].iter().flat_map(|v| [(0, v.x), (1, v.y), (2, v.z)])
                    {
                        assert!(node.planes[2 * axis][slot] < vertex && vertex < node.planes[2 * axis + 1][slot]);
                        checked += 1;
                    }
                }
            }
        }
        assert_eq!(checked, 100 * 9);
    }
}
