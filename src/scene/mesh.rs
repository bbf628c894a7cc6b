//! Building a [`Mesh`] from vertices and indices of any origin: only vertices in use are kept, flaws are found.

use super::marks::Mark;
use super::model::Mesh;
use glam::DVec3;

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

/// Marks a vertex that has no place in the mesh yet.
const UNUSED: u32 = u32::MAX;

impl MeshBuilder {
    /// Adds triangles that index `vertices`; those for whose number `mark` has none are left out. It is asked only for
    /// triangles whose indices are valid. Returns the indices of the vertices that the mesh took over, in its order.
    ///
    /// # Errors
    /// The first [`MeshFlaw`]; vertices that no triangle uses are not looked at.
    pub(super) fn add(
        &mut self,
        vertices: &[DVec3],
        triangles: &[[u32; 3]],
        mark: impl Fn(usize) -> Option<Mark>,
    ) -> Result<Vec<u32>, MeshFlaw> {
        let mut taken = Vec::new();
        let mut place_of = vec![UNUSED; vertices.len()];
        let most = vertices.len().min(triangles.len().saturating_mul(3));
        self.mesh.vertices.reserve(most);
        self.mesh.triangles.reserve(triangles.len());
        for (number, triangle) in triangles.iter().enumerate() {
            let mut corners = [DVec3::ZERO; 3];
            for (corner, &index) in corners.iter_mut().zip(triangle) {
                let vertex = vertices.get(index as usize);
                *corner = *vertex.ok_or(MeshFlaw::Index { index, vertices: vertices.len() })?;
                if !corner.is_finite() {
                    return Err(MeshFlaw::NotFinite { index, vertex: *corner });
                }
            }
            let [a, b, c] = *triangle;
            let collapsed = a == b || b == c || c == a;
            if collapsed || !self.deforms && !has_area(corners) {
                self.degenerate += 1;
                continue;
            }
            let Some(mark) = mark(number) else {
                self.transparent += 1;
                continue;
            };
            let mut kept = [0; 3];
            for (kept, (&index, corner)) in kept.iter_mut().zip(triangle.iter().zip(corners)) {
                let place = &mut place_of[index as usize];
                if *place == UNUSED {
                    *place = u32::try_from(self.mesh.vertices.len()).map_err(|_| MeshFlaw::TooLarge)?;
                    if *place == UNUSED {
                        return Err(MeshFlaw::TooLarge);
                    }
                    self.mesh.vertices.push(corner);
                    taken.push(index);
                }
                *kept = *place;
            }
            self.mesh.triangles.push(kept);
            self.mesh.marks.push(mark);
        }
        Ok(taken)
    }
}

/// True when a triangle has an area, hence a normal. Exactly zero only: for f32 vertices of similar size the differences
/// and products below are exact in f64, and a merely thin triangle casts a shadow like any other.
pub(super) fn has_area(corners: [DVec3; 3]) -> bool {
    let [a, b, c] = corners;
    (b - a).cross(c - a) != DVec3::ZERO
}
