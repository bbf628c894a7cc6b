//! Many triangles in pieces of few, so that the memory of building a tree is bounded: 200 to 300 bytes a triangle of one piece.
//!
//! Halved at the median of their boxes' centres along the axis on which these spread most. Answers do not depend on the
//! tree, and its quality hardly on its first few splits.

use std::cmp::Ordering;
use std::ops::Range;

use glam::Vec3;

use crate::scene::Triangle;

/// Most triangles of a piece.
pub(super) const PIECE: usize = 1 << 20;

/// Sorts indices of triangles into pieces; one piece stays in its order.
pub(super) fn split(kept: &mut [u32], triangles: &[Triangle]) -> Vec<Range<usize>> {
    split_into(kept, triangles, PIECE, 0)
}

#[expect(clippy::single_range_in_vec_init, reason = "one piece is one range")]
fn split_into(kept: &mut [u32], triangles: &[Triangle], most: usize, first: usize) -> Vec<Range<usize>> {
    if kept.len() <= most {
        return vec![first..first + kept.len()];
    }
    let (low, high) = kept.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), &i| {
        let at = twice_centre(&triangles[i as usize]);
        (low.min(at), high.max(at))
    });
    let axis = (high - low).max_position();
    let by_centre = |a: &u32, b: &u32| -> Ordering {
        let at = |i: u32| twice_centre(&triangles[i as usize])[axis];
        at(*a).total_cmp(&at(*b)).then(a.cmp(b))
    };
    let half = kept.len() / 2;
    kept.select_nth_unstable_by(half, by_centre);
    let (left, right) = kept.split_at_mut(half);
    let (mut left, right) =
        rayon::join(|| split_into(left, triangles, most, first), || split_into(right, triangles, most, first + half));
    left.extend(right);
    left
}

/// Twice the centre of a triangle's box; infinite for the largest of numbers, which only makes the split a poor one.
fn twice_centre([a, b, c]: &Triangle) -> Vec3 {
    a.min(*b).min(*c) + a.max(*b).max(*c)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_hold_every_index_once_and_lie_apart() {
        let at = |k: u32| Vec3::new((k * 7919 % 1000) as f32, (k % 3) as f32, 0.0);
        let triangles: Vec<Triangle> = (0..1000).map(|k| [at(k), at(k) + Vec3::Y, at(k) + Vec3::Z]).collect();
        let mut kept: Vec<u32> = (0..1000).collect();
        let pieces = split_into(&mut kept, &triangles, 100, 0);
        assert!(pieces.iter().all(|piece| (1..=100).contains(&piece.len())));
        assert!(pieces.windows(2).all(|pair| pair[0].end == pair[1].start));
        let most = |piece: &Range<usize>| kept[piece.clone()].iter().map(|&k| at(k).x).fold(f32::MIN, f32::max);
        assert!(pieces.windows(2).all(|pair| most(&pair[0]) < most(&pair[1])));
        kept.sort_unstable();
        assert_eq!(kept, (0..1000).collect::<Vec<_>>());
    }
}
