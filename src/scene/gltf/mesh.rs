//! Primitives → indexed triangles, with what deforms them. Lists, strips and fans with the winding of glTF 2.0, section 3.7.2.1; points and
//! lines cast no shadow and are skipped.

use super::accessor::Source;
use super::document::{Mesh as GltfMesh, Primitive};
use super::{morph, skin};
use crate::scene::SceneError;
use crate::scene::mesh::MeshBuilder;
use crate::scene::model::{Mesh, place};
use glam::DVec3;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

/// Decoded POSITION accessors by index: exporters let many primitives share one.
pub(super) type Positions = BTreeMap<usize, Vec<DVec3>>;

/// What was left out of the meshes of a file.
#[derive(Debug, Default)]
pub(super) struct Skipped {
    /// Primitives of points or lines.
    pub points_or_lines: usize,
    /// Triangles without area.
    pub degenerate: usize,
    /// Vertices with joints but no weight.
    pub weightless: usize,
}

/// All triangles of a mesh, with the joints of their vertices where it is `skinned`.
///
/// # Errors
/// [`SceneError::Malformed`] naming mesh and accessor: bad accessors, indices out of range, vertices not finite.
pub(super) fn read(
    source: Source<'_>,
    index: usize,
    mesh: &GltfMesh,
    skinned: bool,
    positions: &mut Positions,
    skipped: &mut Skipped,
) -> Result<Mesh, SceneError> {
    let morphs = mesh.primitives.iter().any(|primitive| !primitive.targets.is_empty());
    let mut builder = MeshBuilder { deforms: skinned || morphs, ..MeshBuilder::default() };
    for (k, primitive) in mesh.primitives.iter().enumerate() {
        let at = format!("{}, primitive {k}", place("mesh", index, mesh.name.as_deref()));
        let mode = primitive.mode.unwrap_or(4);
        let triangles_of: fn(&[u32]) -> Vec<[u32; 3]> = match mode {
            0..=3 => {
                skipped.points_or_lines += 1;
                continue;
            }
            4 => list,
            5 => strip,
            6 => fan,
            _ => return Err(source.fail(&at, format!("mode {mode} is not 0 to 6"))),
        };
        let taken = add_primitive(source, &at, primitive, triangles_of, positions, &mut builder)?;
        morph::append_targets(source, &at, primitive, &taken, &mut builder.mesh)?;
        if skinned {
            skipped.weightless += skin::append_influences(source, &at, primitive, &taken, &mut builder.mesh)?;
        }
    }
    builder.mesh.rest_weights = mesh.weights.clone();
    skipped.degenerate += builder.degenerate;
    Ok(builder.mesh)
}

/// Adds the triangles of a primitive; returns the indices of the vertices that the mesh took over.
fn add_primitive(
    source: Source<'_>,
    at: &str,
    primitive: &Primitive,
    triangles_of: fn(&[u32]) -> Vec<[u32; 3]>,
    positions: &mut Positions,
    builder: &mut MeshBuilder,
) -> Result<Vec<u32>, SceneError> {
    // Without positions there is nothing to draw (section 3.7.2.1).
    let Some(accessor) = primitive.attributes.position else { return Ok(Vec::new()) };
    let vertices = match positions.entry(accessor) {
        Entry::Occupied(known) => known.into_mut(),
        Entry::Vacant(slot) => {
            let read = source.read::<3>(accessor, "VEC3")?;
            slot.insert(read.into_iter().map(DVec3::from_array).collect())
        }
    };
    let indices = match primitive.indices {
        Some(indices) => source.read_indices(indices)?,
        None => (0..u32::try_from(vertices.len()).unwrap_or(u32::MAX)).collect(),
    };
    builder.add(vertices, &triangles_of(&indices)).map_err(|flaw| {
        let indices = primitive.indices.map_or(String::new(), |i| format!(", index accessor {i}"));
        source.fail(&format!("{at}, accessor {accessor}{indices}"), flaw.to_string())
    })
}

fn list(indices: &[u32]) -> Vec<[u32; 3]> {
    indices.as_chunks().0.to_vec()
}

fn strip(indices: &[u32]) -> Vec<[u32; 3]> {
    let turned = |(k, w): (usize, &[u32])| if k % 2 == 0 { [w[0], w[1], w[2]] } else { [w[0], w[2], w[1]] };
    indices.windows(3).enumerate().map(turned).collect()
}

fn fan(indices: &[u32]) -> Vec<[u32; 3]> {
    let Some((&hub, rim)) = indices.split_first() else { return Vec::new() };
    rim.windows(2).map(|w| [w[0], w[1], hub]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_and_fans_wind_as_the_specification_says() {
        assert_eq!(list(&[0, 1, 2, 3, 4, 5, 6]), [[0, 1, 2], [3, 4, 5]]);
        assert_eq!(strip(&[0, 1, 2, 3, 4]), [[0, 1, 2], [1, 3, 2], [2, 3, 4]]);
        assert_eq!(fan(&[0, 1, 2, 3]), [[1, 2, 0], [2, 3, 0]]);
        for short in [&[][..], &[0], &[0, 1]] {
            assert!(list(short).is_empty() && strip(short).is_empty() && fan(short).is_empty());
        }
    }
}
