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
        if self.of.is_empty() && mark != Mark::default() {
            self.of = vec![WHOLE; self.triangles];
        }
        if !self.of.is_empty() || mark != Mark::default() {
            let slot = mark.cutout.map_or(WHOLE, |_| self.cutouts.len() as u32);
            self.of.push(slot | if mark.two_sided { TWO_SIDED } else { 0 });
        }
        if let Some(cutout) = mark.cutout {
            self.cutouts.push(cutout);
            self.cut.push(self.triangles as u32);
        }
        self.triangles += 1;
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
        assert_eq!(marks.get(99), Mark::default());
    }
}
