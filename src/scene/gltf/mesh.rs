//! Primitives → indexed triangles, with what deforms them and what of them is there. Lists, strips and fans with the winding
//! of glTF 2.0, section 3.7.2.1; points and lines cast no shadow and are skipped.

use super::accessor::Source;
use super::document::{Mesh as GltfMesh, Primitive, entry};
use super::materials::{Cover, MaskedCover, Materials};
use super::{morph, skin};
use crate::scene::SceneError;
use crate::scene::marks::Mark;
use crate::scene::mask::{Cutout, Mask};
use crate::scene::mesh::MeshBuilder;
use crate::scene::model::{Mesh, place};
use glam::{DVec2, DVec3};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::path::PathBuf;

/// What was left out of the meshes of a file.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Skipped {
    /// Primitives of points or lines.
    pub points_or_lines: usize,
    /// Triangles without area.
    pub degenerate: usize,
    /// Triangles of which nothing is there.
    pub transparent: usize,
    /// Vertices with joints but no weight.
    pub weightless: usize,
}

/// Reads the meshes of a file.
pub(super) struct Reader<'a> {
    source: Source<'a>,
    materials: Materials<'a>,
    /// Decoded POSITION accessors that several primitives share, as some exporters let them, by index.
    positions: BTreeMap<usize, Vec<DVec3>>,
    /// POSITION accessors by index: how many primitives use them.
    uses: BTreeMap<usize, usize>,
    /// So far.
    pub skipped: Skipped,
}

impl<'a> Reader<'a> {
    /// Nothing read yet.
    pub(super) fn new(source: Source<'a>, materials: Materials<'a>) -> Self {
        let mut uses = BTreeMap::new();
        let primitives = source.document.meshes.iter().flat_map(|mesh| &mesh.primitives);
        for accessor in primitives.filter_map(|primitive| primitive.attributes.position) {
            *uses.entry(accessor).or_default() += 1;
        }
        Reader { source, materials, positions: BTreeMap::new(), uses, skipped: Skipped::default() }
    }

    /// All triangles of a mesh, with the joints of their vertices where it is `skinned`. New masks are appended to `masks`,
    /// image files to `inputs`.
    ///
    /// # Errors
    /// [`SceneError::Malformed`] naming mesh and accessor: bad accessors, indices out of range, vertices not finite; those
    /// of [`Materials::cover`].
    pub(super) fn read(
        &mut self,
        index: usize,
        mesh: &GltfMesh,
        skinned: bool,
        masks: &mut Vec<Mask>,
        inputs: &mut Vec<PathBuf>,
    ) -> Result<Mesh, SceneError> {
        let source = self.source;
        let morphs = mesh.primitives.iter().any(|primitive| !primitive.targets.is_empty());
        let mut builder = MeshBuilder { deforms: skinned || morphs, ..MeshBuilder::default() };
        for (k, primitive) in mesh.primitives.iter().enumerate() {
            let at = format!("{}, primitive {k}", place("mesh", index, mesh.name.as_deref()));
            let mode = primitive.mode.unwrap_or(4);
            let triangles_of: TrianglesOf = match mode {
                0..=3 => {
                    self.skipped.points_or_lines += 1;
                    continue;
                }
                4 => list,
                5 => strip,
                6 => fan,
                _ => return Err(source.fail(&at, format!("mode {mode} is not 0 to 6"))),
            };
            let (two_sided, cover) = match primitive.material {
                None => (false, Cover::Opaque),
                Some(material) => {
                    let (material, cover) = self.materials.cover(material, &at, masks, inputs)?;
                    (material.double_sided, cover)
                }
            };
            let laid = (two_sided, &cover, masks.as_slice());
            let taken = self.add_primitive(&at, primitive, triangles_of, laid, &mut builder)?;
            morph::append_targets(source, &at, primitive, &taken, &mut builder.mesh)?;
            if skinned {
                self.skipped.weightless += skin::append_influences(source, &at, primitive, &taken, &mut builder.mesh)?;
            }
        }
        builder.mesh.rest_weights = mesh.weights.clone();
        self.skipped.degenerate += builder.degenerate;
        self.skipped.transparent += builder.transparent;
        Ok(builder.mesh)
    }

    /// Adds the triangles of a primitive; returns the indices of the vertices that the mesh took over.
    fn add_primitive(
        &mut self,
        at: &str,
        primitive: &Primitive,
        triangles_of: TrianglesOf,
        (two_sided, cover, masks): (bool, &Cover, &[Mask]),
        builder: &mut MeshBuilder,
    ) -> Result<Vec<u32>, SceneError> {
        let source = self.source;
        // Without positions there is nothing to draw (section 3.7.2.1).
        let Some(accessor) = primitive.attributes.position else { return Ok(Vec::new()) };
        let read = || -> Result<Vec<DVec3>, SceneError> {
            // In place: the two are laid out alike.
            Ok(source.read::<3>(accessor, "VEC3")?.into_iter().map(DVec3::from_array).collect())
        };
        let vertices = if self.uses.get(&accessor).is_some_and(|uses| *uses > 1) {
            Cow::Borrowed(match self.positions.entry(accessor) {
                Entry::Occupied(known) => known.into_mut().as_slice(),
                Entry::Vacant(slot) => slot.insert(read()?),
            })
        } else {
            Cow::Owned(read()?)
        };
        let indices = match primitive.indices {
            Some(indices) => source.read_indices(indices)?,
            None => (0..u32::try_from(vertices.len()).unwrap_or(u32::MAX)).collect(),
        };
        let triangles = triangles_of(&indices);
        let added = match cover {
            Cover::Opaque => builder.add(vertices, &triangles, |_| Some(Mark { two_sided, cutout: None })),
            Cover::Nothing => builder.add(vertices, &triangles, |_| None),
            Cover::Masked(cover) => {
                let alphas = Alphas::read(source, at, primitive, cover, vertices.len())?;
                let mask = masks.get(cover.mask as usize);
                builder.add(vertices, &triangles, |k| {
                    let cutout = alphas.cutout(cover.mask, triangles[k]);
                    match mask.and_then(|mask| mask.settled(cutout.alpha)) {
                        Some(false) => None,
                        Some(true) => Some(Mark { two_sided, cutout: None }),
                        None => Some(Mark { two_sided, cutout: Some(cutout) }),
                    }
                })
            }
        };
        added.map_err(|flaw| {
            let indices = primitive.indices.map_or(String::new(), |i| format!(", index accessor {i}"));
            source.fail(&format!("{at}, accessor {accessor}{indices}"), flaw.to_string())
        })
    }
}

/// What the alpha of a primitive's vertices depends on, one entry a vertex.
struct Alphas {
    uv: Option<Vec<[f32; 2]>>,
    alpha: Option<Vec<f32>>,
}

impl Alphas {
    fn read(
        source: Source<'_>,
        at: &str,
        primitive: &Primitive,
        cover: &MaskedCover,
        vertices: usize,
    ) -> Result<Self, SceneError> {
        let enough = |name: &str, count: usize| {
            let problem = || format!("{name} has {count} values for {vertices} vertices");
            if count < vertices { Err(source.fail(at, problem())) } else { Ok(()) }
        };
        let uv = match cover.coordinates {
            None => None,
            Some(set) => {
                let name = format!("TEXCOORD_{set}");
                let accessor = primitive.attributes.accessor(&name);
                let missing = || source.fail(at, format!("its alpha mask needs {name}, which is missing"));
                let values = source.read::<2>(accessor.ok_or_else(missing)?, "VEC2")?;
                enough(&name, values.len())?;
                let placed = |uv: [f64; 2]| cover.turn * DVec2::from_array(uv) + cover.offset;
                Some(values.into_iter().map(|uv| placed(uv).as_vec2().to_array()).collect())
            }
        };
        let alpha = match primitive.attributes.accessor("COLOR_0") {
            None => None,
            Some(accessor) => {
                let kind = &entry(source.path, at, "accessor", &source.document.accessors, accessor)?.kind;
                if kind == "VEC4" {
                    let values = source.read::<4>(accessor, "VEC4")?;
                    enough("COLOR_0", values.len())?;
                    Some(values.into_iter().map(|[.., alpha]| alpha as f32).collect())
                } else {
                    None
                }
            }
        };
        Ok(Alphas { uv, alpha })
    }

    /// Of a triangle with valid indices.
    fn cutout(&self, mask: u32, triangle: [u32; 3]) -> Cutout {
        Cutout {
            mask,
            uv: triangle.map(|k| self.uv.as_ref().map_or([0.0; 2], |uv| uv[k as usize])),
            alpha: triangle.map(|k| self.alpha.as_ref().map_or(1.0, |alpha| alpha[k as usize])),
        }
    }
}

/// Indices → triangles, by the mode of a primitive.
type TrianglesOf = fn(&[u32]) -> Cow<'_, [[u32; 3]]>;

fn list(indices: &[u32]) -> Cow<'_, [[u32; 3]]> {
    Cow::Borrowed(indices.as_chunks().0)
}

fn strip(indices: &[u32]) -> Cow<'_, [[u32; 3]]> {
    let turned = |(k, w): (usize, &[u32])| if k % 2 == 0 { [w[0], w[1], w[2]] } else { [w[0], w[2], w[1]] };
    indices.windows(3).enumerate().map(turned).collect()
}

fn fan(indices: &[u32]) -> Cow<'_, [[u32; 3]]> {
    let Some((&hub, rim)) = indices.split_first() else { return Cow::Borrowed(&[]) };
    rim.windows(2).map(|w| [w[0], w[1], hub]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_and_fans_wind_as_the_specification_says() {
        assert_eq!(*list(&[0, 1, 2, 3, 4, 5, 6]), [[0, 1, 2], [3, 4, 5]]);
        assert_eq!(*strip(&[0, 1, 2, 3, 4]), [[0, 1, 2], [1, 3, 2], [2, 3, 4]]);
        assert_eq!(*fan(&[0, 1, 2, 3]), [[1, 2, 0], [2, 3, 0]]);
        for short in [&[][..], &[0], &[0, 1]] {
            assert!(list(short).is_empty() && strip(short).is_empty() && fan(short).is_empty());
        }
    }
}
