//! A ray's way through the eight-wide tree, nearest children first.

#![expect(
    unsafe_code,
    reason = "measured kernel: the stack is not initialised, and indices the tree gives are trusted"
)]

use std::mem::MaybeUninit;

use super::kernel::Spread;
use super::lanes::Lanes;
use super::ray::Ray;
use super::solid::Solid;
use super::wide::{DEPTH_MAX, LEAF, Leaf, Node, WIDTH, Wide};

/// The nearest triangle found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Nearest {
    /// Index as given to the build.
    pub(super) triangle: u32,
    /// Its leaf, and its place there.
    pub(super) leaf: u32,
    pub(super) lane: u32,
    /// The ray's parameter.
    pub(super) t: f32,
}

/// What is still to be visited. There is room for the deepest tree, so nothing is checked.
pub(super) struct Stack {
    visits: [MaybeUninit<u64>; DEPTH_MAX * WIDTH],
    len: usize,
}

impl Stack {
    #[inline(always)]
    pub(super) fn new() -> Stack {
        Stack { visits: [const { MaybeUninit::uninit() }; DEPTH_MAX * WIDTH], len: 0 }
    }

    #[inline(always)]
    pub(super) fn push(&mut self, visit: u64) {
        debug_assert!(self.len < self.visits.len());
        // SAFETY: a walk leaves at most WIDTH - 1 visits a level, and `Wide` is no deeper than DEPTH_MAX.
        unsafe { self.visits.get_unchecked_mut(self.len).write(visit) };
        self.len += 1;
    }

    #[inline(always)]
    fn pop(&mut self) -> Option<u64> {
        if self.len == 0 {
            return None;
        }
        self.len -= 1;
        // SAFETY: below `len` everything has been written.
        Some(unsafe { self.visits.get_unchecked(self.len).assume_init() })
    }

    /// The top visit: where the ray enters, and the child.
    #[inline(always)]
    pub(super) fn pop_parts(&mut self) -> Option<(f32, u32)> {
        self.pop().map(|visit| (f32::from_bits((visit >> 32) as u32), visit as u32))
    }

    /// Visits on the stack.
    #[inline(always)]
    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// Sorts the visits from `first` on, nearest last.
    #[inline(always)]
    pub(super) fn sort_from(&mut self, first: usize) {
        for end in first + 1..self.len {
            let mut at = end;
            // SAFETY: first < at < len, all written.
            unsafe {
                let visit = self.visits.get_unchecked(at).assume_init();
                while at > first && self.visits.get_unchecked(at - 1).assume_init() < visit {
                    *self.visits.get_unchecked_mut(at) = *self.visits.get_unchecked(at - 1);
                    at -= 1;
                }
                self.visits.get_unchecked_mut(at).write(visit);
            }
        }
    }
}

/// Where the ray enters and the child, so that whole visits compare by distance (of numbers that are not negative the
/// bits are in order; negative ones are only visited in another order).
#[inline(always)]
pub(super) fn visit(enter: f32, child: u32) -> u64 {
    u64::from(enter.to_bits()) << 32 | u64::from(child)
}

#[inline(always)]
fn node_of(tree: &Wide, child: u32) -> &Node {
    debug_assert!((child as usize) < tree.nodes.len());
    // SAFETY: `Wide` refers to nodes it has.
    unsafe { tree.nodes.get_unchecked(child as usize) }
}

#[inline(always)]
fn leaf_of(tree: &Wide, child: u32) -> &Leaf {
    debug_assert!(((child & !LEAF) as usize) < tree.leaves.len());
    // SAFETY: `Wide` refers to leaves it has.
    unsafe { tree.leaves.get_unchecked((child & !LEAF) as usize) }
}

/// The nearest solid triangle along a ray; of two equally near, the one of the lower index.
#[inline(always)]
pub(super) fn nearest<L: Lanes>(tree: &Wide, ray: &Ray, solid: &impl Solid) -> Option<Nearest> {
    if tree.nodes.is_empty() {
        return None;
    }
    let spread = Spread::<L>::new(ray);
    let mut best = Nearest { triangle: u32::MAX, leaf: 0, lane: 0, t: ray.t_max };
    let mut stack = Stack::new();
    let mut current = 0;
    loop {
        while current & LEAF == 0 {
            let node = node_of(tree, current);
            let (mut hits, enter) = spread.boxes(ray, node, best.t);
            let enter = enter.store();
            if hits == 0 {
                current = u32::MAX;
                break;
            }
            let lane = hits.trailing_zeros() as usize;
            hits &= hits - 1;
            if hits == 0 {
                current = node.children[lane];
                continue;
            }
            let a = visit(enter[lane], node.children[lane]);
            let lane = hits.trailing_zeros() as usize;
            hits &= hits - 1;
            let b = visit(enter[lane], node.children[lane]);
            if hits == 0 {
                stack.push(a.max(b));
                current = a.min(b) as u32;
                continue;
            }
            let lane = hits.trailing_zeros() as usize;
            hits &= hits - 1;
            let c = visit(enter[lane], node.children[lane]);
            let (near, far) = (a.min(b), a.max(b));
            let (middle, far) = (far.min(c), far.max(c));
            let (near, middle) = (near.min(middle), near.max(middle));
            let first = stack.len;
            stack.push(far);
            stack.push(middle);
            if hits == 0 {
                current = near as u32;
                continue;
            }
            stack.push(near);
            while hits != 0 {
                let lane = hits.trailing_zeros() as usize;
                hits &= hits - 1;
                stack.push(visit(enter[lane], node.children[lane]));
            }
            stack.sort_from(first);
            current = stack.pop().map_or(u32::MAX, |v| v as u32);
        }
        if current != u32::MAX {
            let leaf = leaf_of(tree, current);
            let (mut hits, t) = spread.triangles(ray, leaf, best.t);
            if hits != 0 {
                let t = t.store();
                while hits != 0 {
                    let lane = hits.trailing_zeros() as usize;
                    hits &= hits - 1;
                    let found = Nearest {
                        triangle: leaf.triangles[lane],
                        leaf: current & !LEAF,
                        lane: lane as u32,
                        t: t[lane],
                    };
                    let nearer = found.t < best.t || (found.t == best.t && found.triangle < best.triangle);
                    if nearer && solid.is_hit(found.triangle) {
                        best = found;
                    }
                }
            }
        }
        loop {
            let Some(next) = stack.pop() else {
                return (best.triangle != u32::MAX).then_some(best);
            };
            if f32::from_bits((next >> 32) as u32) <= best.t {
                current = next as u32;
                break;
            }
        }
    }
}

/// True when any of the triangles of a leaf that a ray hits, at least one, is there.
#[inline(always)]
fn any_solid<S: Solid>(solid: &S, leaf: &Leaf, hits: u32) -> bool {
    S::ALL || (0..WIDTH).any(|lane| hits >> lane & 1 == 1 && solid.is_hit(leaf.triangles[lane]))
}

/// True when any solid triangle lies on the ray.
#[inline(always)]
pub(super) fn any<L: Lanes>(tree: &Wide, ray: &Ray, solid: &impl Solid) -> bool {
    if tree.nodes.is_empty() {
        return false;
    }
    let spread = Spread::<L>::new(ray);
    let mut stack = Stack::new();
    let mut current = 0;
    loop {
        if current & LEAF != 0 {
            let leaf = leaf_of(tree, current);
            let hits = spread.triangles(ray, leaf, ray.t_max).0;
            if hits != 0 && any_solid(solid, leaf, hits) {
                return true;
            }
        } else {
            let node = node_of(tree, current);
            let mut hits = spread.boxes(ray, node, ray.t_max).0;
            if hits != 0 {
                loop {
                    let lane = hits.trailing_zeros() as usize;
                    hits &= hits - 1;
                    if hits == 0 {
                        current = node.children[lane];
                        break;
                    }
                    stack.push(u64::from(node.children[lane]));
                }
                continue;
            }
        }
        match stack.pop() {
            Some(next) => current = next as u32,
            None => return false,
        }
    }
}
