//! Searches over triangles that need not look at all of them: a walk through the tree that the caller steers.

use glam::DVec3;

use super::bvh::Bvh;
use super::trace::Tracer;
use super::wide::{BOX_MARGIN, LEAF, WIDTH};

/// What a walk comes by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Part {
    /// Everything in a box, lower and upper corner, scene space, metres. What is in it is passed over when the caller
    /// answers `false`. A box may be larger than what it holds by 2⁻²³ of the largest coordinate.
    Box([DVec3; 2]),
    /// A triangle, by its index through [`crate::scene::Geometry`]. The answer means nothing.
    Triangle(u32),
}

impl Tracer<'_> {
    /// Shows the caller boxes and, of those it wants, the triangles; always in the same order. Triangles without area are
    /// in no box.
    pub fn walk(&self, mut wanted: impl FnMut(Part) -> bool) {
        let (still, moving) = self.trees();
        walk(still, 0, &mut wanted);
        if let Some(moving) = moving {
            walk(moving, self.geometry().still.len() as u32, &mut wanted);
        }
    }
}

fn walk(bvh: &Bvh, first: u32, wanted: &mut impl FnMut(Part) -> bool) {
    // A power of two: the products are exact.
    let unit = 1.0 / bvh.scale();
    let mut open: Vec<u32> = if bvh.wide.nodes.is_empty() { Vec::new() } else { vec![0] };
    while let Some(reference) = open.pop() {
        if reference & LEAF != 0 {
            let leaf = &bvh.wide.leaves[(reference & !LEAF) as usize];
            for triangle in leaf.triangles.into_iter().filter(|t| *t != u32::MAX) {
                wanted(Part::Triangle(first + triangle));
            }
            continue;
        }
        let node = &bvh.wide.nodes[reference as usize];
        for child in (0..WIDTH).filter(|&c| node.children[c] != u32::MAX) {
            let corner = |side: usize, margin: f32| {
                let at = |axis: usize| (f64::from(node.planes[2 * axis + side][child]) + f64::from(margin)) * unit;
                DVec3::new(at(0), at(1), at(2))
            };
            // Rays want grown boxes; a rounding of f32 remains, which the vertices' own precision covers.
            let margin = BOX_MARGIN - f32::EPSILON / 2.0;
            if wanted(Part::Box([corner(0, margin), corner(1, -margin)])) {
                open.push(node.children[child]);
            }
        }
    }
}
