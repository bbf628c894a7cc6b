//! Searches over triangles that need not look at all of them: a walk through the tree that the caller steers.

use glam::{DAffine3, DVec3};

use super::bvh::Bvh;
use super::shared::SharedTree;
use super::top::Top;
use super::trace::Tracer;
use super::wide::{BOX_MARGIN, LEAF, Node, WIDTH};
use crate::scene::Instance;

/// What a walk comes by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Part {
    /// Everything in a box, lower and upper corner, scene space, metres. What is in it is passed over when the caller
    /// answers `false`. A box may be larger than what it holds: by 2⁻²³ of the largest coordinate, and within instances by what
    /// a box grows by when it is turned.
    Box([DVec3; 2]),
    /// A triangle, by its index through [`crate::scene::Geometry`]. The answer means nothing.
    Triangle(u32),
}

impl Tracer<'_> {
    /// Shows the caller boxes and, of those it wants, the triangles; always in the same order. Triangles without area are
    /// in no box, but for those of instances.
    pub fn walk(&self, mut wanted: impl FnMut(Part) -> bool) {
        let (still, moving) = self.trees();
        let begin = self.geometry().still_len() as u32;
        for (bvh, first) in [Some((still, 0)), moving.map(|moving| (moving, begin))].into_iter().flatten() {
            walk_listed(bvh, first, &mut wanted);
            walk_instances(&bvh.top, &still.meshes, first, &mut wanted);
        }
    }
}

fn walk_listed(bvh: &Bvh, first: u32, wanted: &mut impl FnMut(Part) -> bool) {
    // A power of two: the products are exact.
    let unit = 1.0 / bvh.scale();
    let mut open = Vec::new();
    walk(
        &bvh.wide.nodes,
        &mut open,
        |stored| stored.map(|corner| corner * unit),
        wanted,
        |leaf, wanted| {
            for triangle in bvh.wide.leaves[leaf as usize].triangles.into_iter().filter(|t| *t != u32::MAX) {
                wanted(Part::Triangle(first + triangle));
            }
        },
    );
}

fn walk_instances(top: &Top, meshes: &[SharedTree], first: u32, wanted: &mut impl FnMut(Part) -> bool) {
    let unit = 1.0 / top.scale;
    let (mut open, mut open_inside) = (Vec::new(), Vec::new());
    walk(
        &top.nodes,
        &mut open,
        |stored| stored.map(|corner| corner * unit),
        wanted,
        |leaf, wanted| {
            let instance = &top.instances[leaf as usize].instance;
            let tree = &meshes[instance.mesh as usize];
            let place =
                |stored: [DVec3; 2]| placed_box(instance, stored.map(|corner| corner / tree.scale + tree.centre));
            walk(&tree.nodes, &mut open_inside, place, wanted, |leaf, wanted| {
                for triangle in tree.leaves[leaf as usize].triangles.into_iter().filter(|t| *t != u32::MAX) {
                    wanted(Part::Triangle(first + instance.first + triangle));
                }
            });
        },
    );
}

/// The box, in the scene, of a box of an instance's mesh, grown by what placing its triangles rounds.
fn placed_box(instance: &Instance, [low, high]: [DVec3; 2]) -> [DVec3; 2] {
    let DAffine3 { matrix3: m, translation } = instance.world_from_mesh;
    let centre = m * low.midpoint(high) + translation - instance.origin;
    let half = (high - low) * 0.5;
    let half = m.x_axis.abs() * half.x + m.y_axis.abs() * half.y + m.z_axis.abs() * half.z;
    let rounding = (centre.abs() + half).max_element() * f64::from(f32::EPSILON);
    [centre - half - rounding, centre + half + rounding]
}

/// Walks nodes; `place` takes boxes to the scene, `leaf` shows what is in one.
fn walk<W: FnMut(Part) -> bool>(
    nodes: &[Node],
    open: &mut Vec<u32>,
    place: impl Fn([DVec3; 2]) -> [DVec3; 2],
    wanted: &mut W,
    mut leaf: impl FnMut(u32, &mut W),
) {
    open.clear();
    open.extend((!nodes.is_empty()).then_some(0));
    while let Some(reference) = open.pop() {
        if reference & LEAF != 0 {
            leaf(reference & !LEAF, wanted);
            continue;
        }
        let node = &nodes[reference as usize];
        for child in (0..WIDTH).filter(|&c| node.children[c] != u32::MAX) {
            let corner = |side: usize, margin: f32| {
                let at = |axis: usize| f64::from(node.planes[2 * axis + side][child]) + f64::from(margin);
                DVec3::new(at(0), at(1), at(2))
            };
            // Rays want grown boxes; a rounding of f32 remains, which the vertices' own precision covers.
            let margin = BOX_MARGIN - f32::EPSILON / 2.0;
            if wanted(Part::Box(place([corner(0, margin), corner(1, -margin)]))) {
                open.push(node.children[child]);
            }
        }
    }
}
