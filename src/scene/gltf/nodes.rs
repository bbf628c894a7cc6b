//! The node hierarchy of the active scene, flattened parents first. No recursion: hierarchies of any depth work, and
//! a node met twice (a cycle, or two parents) is an error.

use super::document::{Document, Node as GltfNode, entry, malformed};
use crate::scene::SceneError;
use crate::scene::model::{Local, Node, Tracks, place};
use crate::scene::track::unit_quat;
use glam::{DAffine3, DMat3, DQuat, DVec3, DVec4};
use std::path::Path;
use std::sync::Arc;

/// A node of the active scene by its index in the file, and its parent's position in the same list.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Visit {
    /// Index in the file.
    pub index: usize,
    /// Position in the list of visits, less than its own.
    pub parent: Option<usize>,
}

/// Nodes of a scene, depth first in file order; without one, all nodes that are nobody's children.
///
/// # Errors
/// [`SceneError::Malformed`] for references to nothing and for nodes met twice.
pub(super) fn walk(path: &Path, document: &Document, scene: Option<usize>) -> Result<Vec<Visit>, SceneError> {
    let roots = match scene {
        Some(scene) => entry(path, "the default scene", "scene", &document.scenes, scene)?.nodes.clone(),
        None => orphans(document),
    };
    let mut met = vec![false; document.nodes.len()];
    let mut visits = Vec::new();
    let mut stack: Vec<Visit> = roots.into_iter().rev().map(|index| Visit { index, parent: None }).collect();
    while let Some(visit) = stack.pop() {
        let asked_by = visit.parent.map_or("the scene".to_owned(), |parent: usize| {
            let Visit { index, .. } = visits[parent];
            place("node", index, document.nodes[index].name.as_deref())
        });
        let node = entry(path, &asked_by, "node", &document.nodes, visit.index)?;
        if std::mem::replace(&mut met[visit.index], true) {
            let problem = "is met twice: it has two parents or is its own ancestor; export the file again";
            return Err(malformed(path, place("node", visit.index, node.name.as_deref()), problem));
        }
        let parent = Some(visits.len());
        visits.push(visit);
        stack.extend(node.children.iter().rev().map(|&index| Visit { index, parent }));
    }
    Ok(visits)
}

fn orphans(document: &Document) -> Vec<usize> {
    let mut orphan = vec![true; document.nodes.len()];
    for &child in document.nodes.iter().flat_map(|node| &node.children) {
        if let Some(orphan) = orphan.get_mut(child) {
            *orphan = false;
        }
    }
    (0..orphan.len()).filter(|&index| orphan[index]).collect()
}

/// A node for the model, without its animation. `parent` is an index into the model.
///
/// # Errors
/// [`SceneError::Malformed`] for a rotation without length or a matrix that is not affine.
pub(super) fn convert(
    file: &Arc<Path>,
    index: usize,
    node: &GltfNode,
    parent: Option<usize>,
) -> Result<Node, SceneError> {
    let fail = |problem: &str| malformed(file, place("node", index, node.name.as_deref()), problem);
    let local = match node.matrix {
        Some(matrix) => {
            let [x, y, z, w] =
                [0, 4, 8, 12].map(|k| DVec4::new(matrix[k], matrix[k + 1], matrix[k + 2], matrix[k + 3]));
            if DVec4::new(x.w, y.w, z.w, w.w) != DVec4::W {
                return Err(fail("its matrix is not affine (last row 0 0 0 1); export the file again"));
            }
            let matrix3 = DMat3::from_cols(x.truncate(), y.truncate(), z.truncate());
            Local::Matrix(DAffine3 { matrix3, translation: w.truncate() })
        }
        None => Local::Trs {
            translation: node.translation.map_or(DVec3::ZERO, DVec3::from_array),
            rotation: match node.rotation {
                None => DQuat::IDENTITY,
                Some(rotation) => unit_quat(DVec4::from_array(rotation))
                    .ok_or_else(|| fail("its rotation is a quaternion without length; export the file again"))?,
            },
            scale: node.scale.map_or(DVec3::ONE, DVec3::from_array),
        },
    };
    Ok(Node {
        file: Arc::clone(file),
        name: node.name.clone(),
        index,
        parent,
        local,
        hidden: node.extensions.visibility.as_ref().is_some_and(|v| v.visible == Some(false)),
        weights: node.weights.clone(),
        tracks: Tracks::default(),
    })
}
