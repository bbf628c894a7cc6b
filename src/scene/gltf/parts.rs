//! Meshes, skins and instances of the scene's nodes → parts of the model.

use super::accessor::Source;
use super::document::{Node as GltfNode, entry};
use super::materials::Materials;
use super::{instancing, mesh, skin};
use crate::scene::SceneError;
use crate::scene::model::{Model, Part, place};
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

/// Meshes and skins read so far, by index in the file.
struct Known<'a> {
    meshes: BTreeMap<(usize, bool), usize>,
    skins: BTreeMap<usize, usize>,
    reader: mesh::Reader<'a>,
}

/// Adds a part for each mesh of the nodes of the scene, or one for each of its instances. `model_node` maps a node's
/// index in the file to its place in the model.
///
/// # Errors
/// [`SceneError::Malformed`] for whatever is wrong with a mesh, a skin or instances.
pub(super) fn add<'a>(
    source: Source<'a>,
    materials: Materials<'a>,
    model_node: &[Option<usize>],
    in_scene: &[usize],
    model: &mut Model,
    notes: &mut Vec<String>,
) -> Result<(), SceneError> {
    let mut known =
        Known { meshes: BTreeMap::new(), skins: BTreeMap::new(), reader: mesh::Reader::new(source, materials) };
    for &index in in_scene {
        let node = &source.document.nodes[index];
        if let (Some(place), Some(mesh)) = (model_node[index], node.mesh) {
            add_node(source, node, place, mesh, model_node, &mut known, model, notes)?;
        }
    }
    let skipped = known.reader.skipped;
    if skipped.points_or_lines > 0 {
        notes.push(format!("{} primitives of points or lines ignored", skipped.points_or_lines));
    }
    if skipped.degenerate > 0 {
        notes.push(format!("{} triangles without area dropped", skipped.degenerate));
    }
    if skipped.transparent > 0 {
        notes.push(format!("{} wholly transparent triangles left out", skipped.transparent));
    }
    if skipped.weightless > 0 {
        notes.push(format!("{} vertices with joints but no weight follow their first joint", skipped.weightless));
    }
    Ok(())
}

#[expect(clippy::too_many_arguments, reason = "one node of `add`, with its state")]
fn add_node(
    source: Source<'_>,
    gltf_node: &GltfNode,
    node: usize,
    gltf_mesh: usize,
    model_node: &[Option<usize>],
    known: &mut Known<'_>,
    model: &mut Model,
    notes: &mut Vec<String>,
) -> Result<(), SceneError> {
    let at = model.nodes[node].place();
    let document = source.document;
    let found = entry(source.path, &at, "mesh", &document.meshes, gltf_mesh)?;
    let mesh = match known.meshes.entry((gltf_mesh, gltf_node.skin.is_some())) {
        Entry::Occupied(known) => *known.get(),
        Entry::Vacant(slot) => {
            let skinned = gltf_node.skin.is_some();
            let read = known.reader.read(gltf_mesh, found, skinned, &mut model.masks, &mut model.inputs)?;
            model.meshes.push(read);
            *slot.insert(model.meshes.len() - 1)
        }
    };
    let skin = match gltf_node.skin {
        None => None,
        Some(index) => Some(match known.skins.entry(index) {
            Entry::Occupied(known) => *known.get(),
            Entry::Vacant(slot) => {
                let found = entry(source.path, &at, "skin", &document.skins, index)?;
                model.skins.push(skin::read(source, index, found, model_node)?);
                *slot.insert(model.skins.len() - 1)
            }
        }),
    };
    if let Some(skin) = skin.map(|skin| &model.skins[skin])
        && let Some((vertex, joint)) = skin::joint_beyond(&model.meshes[mesh], skin)
    {
        let name = place("mesh", gltf_mesh, found.name.as_deref());
        let problem =
            format!("vertex {vertex} of {name} follows joint {joint}, but its skin has {} joints", skin.joints.len());
        return Err(source.fail(&at, problem));
    }
    let part = Part { node, mesh, skin, instance: None };
    match &gltf_node.extensions.instancing {
        Some(_) if skin.is_some() => {
            notes.push(format!("{at}: instances of a skinned mesh have no meaning; it is drawn once"));
            model.parts.push(part);
        }
        Some(instancing) => {
            let first = model.instances.len();
            model.instances.extend(instancing::read(source, &at, instancing)?);
            let instances = first..model.instances.len();
            model.parts.extend(instances.map(|instance| Part { instance: Some(instance), ..part }));
        }
        None => model.parts.push(part),
    }
    Ok(())
}
