//! Building a [`Mesh`] from vertices and indices of any origin: only vertices in use are kept, flaws are found.

use super::marks::Mark;
use super::model::Mesh;
use super::tasks;
use glam::DVec3;
use std::borrow::Cow;
use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

/// Collects triangles of one mesh.
#[derive(Debug, Default)]
pub(super) struct MeshBuilder {
    /// So far.
    pub mesh: Mesh,
    /// True for a mesh that deforms: a triangle without area at rest may get one.
    pub deforms: bool,
    /// Triangles left out because they have no area.
    pub degenerate: usize,
    /// Triangles left out because nothing of them is there.
    pub transparent: usize,
}

/// Why triangles cannot be used.
#[derive(Debug, thiserror::Error)]
pub(super) enum MeshFlaw {
    /// An index beyond the vertices.
    #[error("index {index} lies beyond the {vertices} vertices")]
    Index { index: u32, vertices: usize },
    /// NaN or infinity.
    #[error("vertex {index} is not finite: {vertex}")]
    NotFinite { index: u32, vertex: DVec3 },
    /// The mesh outgrows its indices.
    #[error("a mesh of more than 2^32 - 1 vertices")]
    TooLarge,
}

/// Instead of its place in the mesh: a vertex that no triangle uses.
const UNUSED: u32 = u32::MAX;

/// What becomes of a triangle.
enum Fate {
    Kept(Mark),
    Degenerate,
    Transparent,
}

/// What becomes of several triangles.
#[derive(Default)]
struct Found {
    /// Kept ones without holes: single-sided, two-sided.
    whole: [usize; 2],
    degenerate: usize,
    transparent: usize,
}

impl MeshBuilder {
    /// Adds triangles that index `vertices`; those for whose number `mark` has none are left out. It is asked only for
    /// triangles whose indices are valid. Returns the indices of the vertices that the mesh took over, in its order, which
    /// is that of `vertices`.
    ///
    /// # Errors
    /// The first [`MeshFlaw`] in the order of the triangles; vertices that no triangle uses are not looked at.
    pub(super) fn add(
        &mut self,
        vertices: Cow<'_, [DVec3]>,
        triangles: &[[u32; 3]],
        mark: impl Fn(usize) -> Option<Mark> + Sync,
    ) -> Result<Vec<u32>, MeshFlaw> {
        let deforms = self.deforms;
        let mut place_of: Vec<AtomicU32> = vertices.iter().map(|_| AtomicU32::new(UNUSED)).collect();
        let look = |run: Range<usize>| -> Result<Found, MeshFlaw> {
            let mut found = Found::default();
            for number in run {
                match fate(&vertices, triangles[number], deforms, || mark(number))? {
                    Fate::Kept(mark) => {
                        triangles[number].iter().for_each(|&k| place_of[k as usize].store(0, Relaxed));
                        found.whole[usize::from(mark.two_sided)] += usize::from(mark.cutout.is_none());
                    }
                    Fate::Degenerate => found.degenerate += 1,
                    Fate::Transparent => found.transparent += 1,
                }
            }
            Ok(found)
        };
        let mut found = Found::default();
        for run in tasks::runs(triangles.len(), look) {
            let run = run?;
            found.whole = [0, 1].map(|side| found.whole[side] + run.whole[side]);
            found.degenerate += run.degenerate;
            found.transparent += run.transparent;
        }
        let taken = self.number(&mut place_of)?;
        self.mesh.triangles.reserve(triangles.len());
        let mut placed = |run: Range<usize>| place(&triangles[run], &place_of, &mut self.mesh.triangles);
        if let Some(side) = found.whole.iter().position(|&whole| whole == triangles.len()) {
            placed(0..triangles.len());
            self.mesh.marks.push_whole(side == 1, triangles.len());
        } else {
            for (number, &triangle) in triangles.iter().enumerate() {
                if let Fate::Kept(mark) = fate(&vertices, triangle, deforms, || mark(number))? {
                    placed(number..number + 1);
                    self.mesh.marks.push(mark);
                }
            }
        }
        self.degenerate += found.degenerate;
        self.transparent += found.transparent;
        self.take(vertices, &taken);
        Ok(taken)
    }

    /// Gives the vertices in use their places, after those of the mesh; returns their indices.
    fn number(&self, place_of: &mut [AtomicU32]) -> Result<Vec<u32>, MeshFlaw> {
        let mut taken = Vec::with_capacity(place_of.len());
        for (place, index) in place_of.iter_mut().zip(0_u32..) {
            let place = place.get_mut();
            if *place != UNUSED {
                let next = self.mesh.vertices.len() + taken.len();
                *place = u32::try_from(next).ok().filter(|&next| next != UNUSED).ok_or(MeshFlaw::TooLarge)?;
                taken.push(index);
            }
        }
        Ok(taken)
    }

    /// Appends the vertices in use.
    fn take(&mut self, vertices: Cow<'_, [DVec3]>, taken: &[u32]) {
        match vertices {
            // The first ones of a mesh, often all there are, need no copy.
            Cow::Owned(mut own) if self.mesh.vertices.is_empty() => {
                if taken.len() < own.len() {
                    for (place, &index) in taken.iter().enumerate() {
                        own[place] = own[index as usize];
                    }
                    own.truncate(taken.len());
                    own.shrink_to_fit();
                }
                self.mesh.vertices = own;
            }
            vertices => tasks::extend(&mut self.mesh.vertices, taken.len(), |k| vertices[taken[k] as usize]),
        }
    }
}

/// Appends triangles whose vertices have places.
fn place(triangles: &[[u32; 3]], place_of: &[AtomicU32], out: &mut Vec<[u32; 3]>) {
    tasks::extend(out, triangles.len(), |k| triangles[k].map(|index| place_of[index as usize].load(Relaxed)));
}

/// What becomes of a triangle. Inlined, as what it returns is large.
#[inline(always)]
fn fate(
    vertices: &[DVec3],
    [a, b, c]: [u32; 3],
    deforms: bool,
    mark: impl FnOnce() -> Option<Mark>,
) -> Result<Fate, MeshFlaw> {
    let corners = [corner(vertices, a)?, corner(vertices, b)?, corner(vertices, c)?];
    if a == b || b == c || c == a || !deforms && !has_area(corners) {
        return Ok(Fate::Degenerate);
    }
    Ok(mark().map_or(Fate::Transparent, Fate::Kept))
}

/// A corner of a triangle.
#[inline(always)]
fn corner(vertices: &[DVec3], index: u32) -> Result<DVec3, MeshFlaw> {
    match vertices.get(index as usize) {
        None => Err(MeshFlaw::Index { index, vertices: vertices.len() }),
        Some(vertex) if !vertex.is_finite() => Err(MeshFlaw::NotFinite { index, vertex: *vertex }),
        Some(vertex) => Ok(*vertex),
    }
}

/// True when a triangle has an area, hence a normal. Exactly zero only: for f32 vertices of similar size the differences
/// and products below are exact in f64, and a merely thin triangle casts a shadow like any other.
#[inline]
pub(super) fn has_area(corners: [DVec3; 3]) -> bool {
    let [a, b, c] = corners;
    (b - a).cross(c - a) != DVec3::ZERO
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::mask::Cutout;

    /// Enough triangles for several tasks.
    const MANY: u32 = 50_000;

    /// Vertices of a strip of triangles, every third of them in no triangle.
    fn strip() -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let vertices = (0..3 * MANY).map(|k| DVec3::new(f64::from(k), f64::from(k % 7), 0.0)).collect();
        (vertices, (0..MANY - 2).map(|k| [3 * k + 3, 3 * k, 3 * k + 7]).collect())
    }

    fn corners_of(mesh: &Mesh) -> Vec<[DVec3; 3]> {
        mesh.triangles.iter().map(|t| t.map(|k| mesh.vertices[k as usize])).collect()
    }

    #[test]
    fn a_mesh_is_the_same_whether_added_at_once_or_in_parts() {
        let (vertices, triangles) = strip();
        let cutout = Cutout { mask: 0, uv: [[0.5; 2]; 3], alpha: [1.0; 3] };
        let marks: [&(dyn Fn(usize) -> Option<Mark> + Sync); 3] =
            [&|_| Some(Mark::default()), &|_| Some(Mark { two_sided: true, cutout: None }), &|k| {
                (k % 5 > 0).then_some(Mark { two_sided: k % 2 > 0, cutout: (k % 3 > 0).then_some(cutout) })
            }];
        for mark in marks {
            let mut whole = MeshBuilder::default();
            let taken = whole.add(Cow::Borrowed(&vertices), &triangles, mark).unwrap();
            assert!(taken.iter().zip(&whole.mesh.vertices).all(|(&k, vertex)| vertices[k as usize] == *vertex));
            assert_eq!(taken.len(), whole.mesh.vertices.len());
            let mut own = MeshBuilder::default();
            assert_eq!(own.add(Cow::Owned(vertices.clone()), &triangles, mark).unwrap(), taken);
            assert_eq!(own.mesh.vertices, whole.mesh.vertices);
            assert_eq!(own.mesh.triangles, whole.mesh.triangles);
            let mut parts = MeshBuilder::default();
            for (k, triangle) in triangles.iter().enumerate() {
                let near = 3 * k..3 * k + 9;
                let local = triangle.map(|index| index - near.start as u32);
                parts.add(Cow::Borrowed(&vertices[near]), &[local], |_| mark(k)).unwrap();
            }
            assert_eq!(corners_of(&parts.mesh), corners_of(&whole.mesh));
            assert_eq!([parts.transparent, parts.degenerate], [whole.transparent, whole.degenerate]);
            let marks = 0..whole.mesh.triangles.len() as u32;
            assert!(marks.into_iter().all(|k| parts.mesh.marks.get(k) == whole.mesh.marks.get(k)));
        }
    }

    #[test]
    fn the_first_flaw_is_found() {
        let (mut vertices, mut triangles) = strip();
        let flaw = |vertices: &[DVec3], triangles: &[[u32; 3]]| {
            let mut builder = MeshBuilder::default();
            builder.add(Cow::Borrowed(vertices), triangles, |_| Some(Mark::default())).unwrap_err().to_string()
        };
        triangles[40_000][1] = u32::MAX;
        assert_eq!(flaw(&vertices, &triangles), "index 4294967295 lies beyond the 150000 vertices");
        vertices[3 * 30_000] = DVec3::NAN;
        assert_eq!(flaw(&vertices, &triangles), "vertex 90000 is not finite: [NaN, NaN, NaN]");
        triangles[20_000] = [0, 1, 150_000];
        assert_eq!(flaw(&vertices, &triangles), "index 150000 lies beyond the 150000 vertices");
    }

    #[test]
    fn triangles_without_area_are_counted_and_their_vertices_left_out() {
        let (vertices, mut triangles) = strip();
        triangles[25_000] = [1, 1, 2];
        triangles[30_000] = [2, 9, 16];
        let mut builder = MeshBuilder::default();
        let taken = builder.add(Cow::Borrowed(&vertices), &triangles, |_| Some(Mark::default())).unwrap();
        assert_eq!((builder.degenerate, builder.mesh.triangles.len()), (2, triangles.len() - 2));
        assert!(!taken.contains(&2));
        let mut deforms = MeshBuilder { deforms: true, ..MeshBuilder::default() };
        let taken = deforms.add(Cow::Borrowed(&vertices), &triangles, |_| Some(Mark::default())).unwrap();
        assert_eq!((deforms.degenerate, taken.contains(&2)), (1, true));
    }
}
