//! Wavefront OBJ → one mesh under one node, through tobj. Geometry only: materials are not opened, so a missing `.mtl`
//! is no error; points and lines are skipped. Vertices are kept in f64, as written.

use super::SceneError;
use super::mesh::MeshBuilder;
use super::model::{Local, Model, Node, Part, Tracks};
use super::polygon::triangulate;
use glam::{DQuat, DVec3};
use std::path::Path;
use std::sync::Arc;

/// Adds a file, whose bytes have been read, to the model.
///
/// # Errors
/// [`SceneError::Malformed`]: what tobj refuses, indices out of range, vertices not finite.
pub(super) fn read(path: &Path, bytes: &[u8], model: &mut Model) -> Result<(), SceneError> {
    let fail = |place: String, problem: String| SceneError::Malformed { path: path.to_owned(), place, problem };
    let options = tobj::LoadOptions { ignore_points: true, ignore_lines: true, ..Default::default() };
    let no_materials = |_: &Path| Ok(Default::default());
    let (objects, _) = tobj::load_obj_buf(&mut clean(bytes).as_bytes(), &options, no_materials)
        .map_err(|error| fail("OBJ".into(), format!("{error}; export the file again")))?;
    let mut builder = MeshBuilder::default();
    for object in &objects {
        let vertices: Vec<DVec3> =
            object.mesh.positions.as_chunks().0.iter().map(|&xyz| DVec3::from_array(xyz)).collect();
        let place = format!("object {:?}", object.name);
        let triangles = faces(&object.mesh, &vertices);
        builder.add(&vertices, &triangles).map_err(|flaw| fail(place, format!("{flaw}; export the file again")))?;
    }
    if builder.degenerate > 0 {
        model.notes.push(format!("{}: {} triangles without area dropped", path.display(), builder.degenerate));
    }
    let local = Local::Trs { translation: DVec3::ZERO, rotation: DQuat::IDENTITY, scale: DVec3::ONE };
    let node = Node {
        file: Arc::from(path),
        name: None,
        index: 0,
        parent: None,
        local,
        hidden: false,
        weights: None,
        tracks: Tracks::default(),
    };
    model.parts.push(Part { node: model.nodes.len(), mesh: model.meshes.len(), skin: None, instance: None });
    model.nodes.push(node);
    model.meshes.push(builder.mesh);
    Ok(())
}

/// Text that tobj accepts: Latin-1 where it is not UTF-8 (names and comments of old exporters), lines that end in `\`
/// joined with the next.
fn clean(bytes: &[u8]) -> String {
    let text = match std::str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => bytes.iter().map(|&byte| char::from(byte)).collect(),
    };
    if text.contains('\\') { text.replace("\\\r\n", " ").replace("\\\n", " ") } else { text }
}

/// Triangles of all faces of an object. tobj lists no arities when all faces are triangles.
fn faces(mesh: &tobj::Mesh, vertices: &[DVec3]) -> Vec<[u32; 3]> {
    if mesh.face_arities.is_empty() {
        return mesh.indices.as_chunks().0.to_vec();
    }
    let mut rest = mesh.indices.as_slice();
    let mut triangles = Vec::with_capacity(mesh.indices.len());
    for &arity in &mesh.face_arities {
        let Some((face, after)) = rest.split_at_checked(arity as usize) else { break };
        rest = after;
        let corners: Option<Vec<DVec3>> = face.iter().map(|&index| vertices.get(index as usize).copied()).collect();
        match (face, corners) {
            (&[a, b, c], _) => triangles.push([a, b, c]),
            (_, Some(corners)) => triangles.extend(triangulate(&corners).into_iter().map(|t| t.map(|k| face[k]))),
            // An index out of range: leave it in a triangle for the builder to report.
            (_, None) => triangles.extend(face.windows(3).map(|w| [w[0], w[1], w[2]])),
        }
    }
    triangles
}
