//! What sets triangles of a list apart from plain ones: being two-sided, having holes. Nothing is stored for a list of
//! plain triangles.

use super::mask::Cutout;

/// No holes, in [`Marks::of`].
const WHOLE: u32 = u32::MAX >> 1;
/// Set in [`Marks::of`] for two-sided triangles.
const TWO_SIDED: u32 = 1 << 31;

/// What is special about one triangle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mark {
    /// Drawn from both sides even where a renderer leaves out fronts or backs.
    pub two_sided: bool,
    /// Its holes.
    pub cutout: Option<Cutout>,
}

impl Mark {
    /// Of the triangle with its second and third corner exchanged.
    pub(super) fn turned(self) -> Self {
        let turn = |c: Cutout| {
            let ([u, v, w], [a, b, c_]) = (c.uv, c.alpha);
            Cutout { uv: [u, w, v], alpha: [a, c_, b], ..c }
        };
        Mark { cutout: self.cutout.map(turn), ..self }
    }
}

/// Marks of a list of triangles, in its order.
#[derive(Clone, Debug, Default)]
pub struct Marks {
    triangles: usize,
    /// By triangle: index into `cutouts` or [`WHOLE`], and [`TWO_SIDED`]. Empty while all are plain.
    of: Vec<u32>,
    cutouts: Vec<Cutout>,
    /// The triangle of each cutout, ascending.
    cut: Vec<u32>,
}

impl Marks {
    /// Of no triangles.
    pub const fn new() -> Self {
        Marks { triangles: 0, of: Vec::new(), cutouts: Vec::new(), cut: Vec::new() }
    }

    /// The mark of the next triangle. Lists hold fewer than 2³¹ triangles with holes: their corners alone would fill 72 GB.
    pub fn push(&mut self, mark: Mark) {
        let slot = mark.cutout.map_or(WHOLE, |_| self.cutouts.len() as u32);
        if let Some(cutout) = mark.cutout {
            self.cutouts.push(cutout);
            self.cut.push(self.triangles as u32);
        }
        self.extend(slot, mark.two_sided, 1);
    }

    /// Marks of the next triangles, which have no holes.
    pub(super) fn push_whole(&mut self, two_sided: bool, count: usize) {
        self.extend(WHOLE, two_sided, count);
    }

    /// Marks of the next triangles: those of another list, or of its triangles turned.
    pub(super) fn append(&mut self, other: &Marks, turned: bool) {
        if other.of.is_empty() {
            return self.push_whole(false, other.triangles);
        }
        for mark in (0..other.triangles as u32).map(|k| other.get(k)) {
            self.push(if turned { mark.turned() } else { mark });
        }
    }

    fn extend(&mut self, slot: u32, two_sided: bool, count: usize) {
        let of = slot | if two_sided { TWO_SIDED } else { 0 };
        if self.of.is_empty() && of != WHOLE {
            self.of = vec![WHOLE; self.triangles];
        }
        if !self.of.is_empty() || of != WHOLE {
            self.of.resize(self.of.len() + count, of);
        }
        self.triangles += count;
    }

    /// The mark of a triangle; plain for one that has none.
    pub fn get(&self, triangle: u32) -> Mark {
        Mark { two_sided: self.two_sided(triangle), cutout: self.cutout(triangle).copied() }
    }

    /// True when a triangle is two-sided.
    pub fn two_sided(&self, triangle: u32) -> bool {
        self.of.get(triangle as usize).is_some_and(|of| of & TWO_SIDED != 0)
    }

    /// The holes of a triangle.
    #[inline]
    pub fn cutout(&self, triangle: u32) -> Option<&Cutout> {
        let slot = self.of.get(triangle as usize)? & !TWO_SIDED;
        self.cutouts.get(slot as usize)
    }

    /// Triangles with holes, ascending.
    pub fn cut(&self) -> &[u32] {
        &self.cut
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_keep_step_with_their_triangles() {
        let cutout = Cutout { mask: 3, uv: [[0.5; 2]; 3], alpha: [1.0; 3] };
        let given = [
            Mark::default(),
            Mark { two_sided: true, cutout: None },
            Mark { two_sided: false, cutout: Some(cutout) },
            Mark::default(),
            Mark { two_sided: true, cutout: Some(cutout) },
        ];
        let mut marks = Marks::new();
        given.into_iter().for_each(|mark| marks.push(mark));
        assert_eq!([0, 1, 2, 3, 4].map(|k| marks.get(k)), given);
        assert_eq!(marks.cut(), [2, 4]);
        let mut all = Marks::new();
        all.push_whole(false, 3);
        all.append(&marks, false);
        all.push_whole(true, 2);
        all.append(&marks, true);
        let whole = [0, 1, 2, 8, 9].map(|k| all.get(k));
        assert_eq!(
            whole.map(|mark| (mark.two_sided, mark.cutout)),
            [false, false, false, true, true].map(|t| (t, None))
        );
        assert_eq!([3, 4, 5, 6, 7].map(|k| all.get(k)), given);
        assert_eq!([10, 11, 12, 13, 14].map(|k| all.get(k)), given.map(Mark::turned));
        assert_eq!(all.cut(), [5, 7, 12, 14]);
        assert_eq!(marks.get(99), Mark::default());
    }
}
