//! Wavefront OBJ → one mesh under one node, through tobj. Vertices are kept in f64, as written; points and lines are
//! skipped. Of materials only what cuts holes is read ([`super::mtl`]); v runs up in OBJ, down in images.

use super::beside::{self, Reach};
use super::marks::Mark;
use super::mask::Cutout;
use super::mesh::MeshBuilder;
use super::model::{Local, Model, Node, Part, Tracks};
use super::mtl::{self, Covering, Library};
use super::polygon::triangulate;
use super::{BlendRule, SceneError};
use glam::{DQuat, DVec3};
use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Adds a file, whose bytes have been read, to the model.
///
/// # Errors
/// [`SceneError::Malformed`]: what tobj refuses, indices out of range, vertices not finite.
pub(super) fn read(
    path: &Path,
    bytes: &[u8],
    blend: BlendRule,
    reach: Reach,
    model: &mut Model,
) -> Result<(), SceneError> {
    let fail = |place: String, problem: String| SceneError::Malformed { path: path.to_owned(), place, problem };
    let options = tobj::LoadOptions { ignore_points: true, ignore_lines: true, ..Default::default() };
    let libraries = RefCell::new(Vec::new());
    let loader = |name: &Path| {
        libraries.borrow_mut().push(name.to_owned());
        names_of(&library_text(path, name, reach).map(|(_, text)| text).unwrap_or_default())
    };
    let text = clean(bytes);
    let mut found = tobj::load_obj_buf(&mut text.as_bytes(), &options, loader);
    let mended = match found {
        // Colours on some vertices only; none of them is asked for.
        Err(tobj::LoadError::FaceColorOutOfBounds) => Some(without_colours(&text)),
        Err(tobj::LoadError::MaterialParseError) => Some(with_material_names(&text)),
        _ => None,
    };
    if let Some(text) = mended {
        libraries.borrow_mut().clear();
        found = tobj::load_obj_buf(&mut text.as_bytes(), &options, loader);
    }
    let (objects, materials) = found.map_err(|error| match flawed_line(&text) {
        Some((number, line)) => fail(format!("line {number}"), format!("{error}: {line:?}; export the file again")),
        None => fail("OBJ".into(), format!("{error}; export the file again")),
    })?;
    let materials = materials.unwrap_or_default();
    let library = read_libraries(path, &libraries.into_inner(), (blend, reach), model);
    let mut builder = MeshBuilder::default();
    for object in &objects {
        let vertices: Vec<DVec3> =
            object.mesh.positions.as_chunks().0.iter().map(|&xyz| DVec3::from_array(xyz)).collect();
        let place = format!("object {:?}", object.name);
        let name = object.mesh.material_id.and_then(|id| materials.get(id)).map(|material| &material.name);
        let covering = name.and_then(|name| library.get(name)).copied().unwrap_or(Covering::Opaque);
        let corners = faces(&object.mesh, &vertices);
        let triangles: Vec<[u32; 3]> = corners.iter().map(|t| t.map(|k| object.mesh.indices[k])).collect();
        let mark = |k: usize| mark(&object.mesh, corners[k], covering, model);
        builder
            .add(vertices.into(), &triangles, mark)
            .map_err(|flaw| fail(place, format!("{flaw}; export the file again")))?;
    }
    for (count, what) in [
        (builder.degenerate, "triangles without area dropped"),
        (builder.transparent, "transparent triangles left out"),
    ] {
        if count > 0 {
            model.notes.push(format!("{}: {count} {what}", path.display()));
        }
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

/// What casts of a triangle, given by three places in the mesh's list of indices; `None` = nothing.
fn mark(mesh: &tobj::Mesh, corners: [usize; 3], covering: Covering, model: &Model) -> Option<Mark> {
    let Covering::Masked { mask, scale, offset } = covering else {
        return (covering == Covering::Opaque).then(Mark::default);
    };
    let uv = corners.map(|corner| {
        let index = mesh.texcoord_indices.get(corner).map(|&index| 2 * index as usize);
        let uv = index.and_then(|at| mesh.texcoords.get(at..at + 2)).unwrap_or(&[0.0, 0.0]);
        [(uv[0] * scale[0] + offset[0]) as f32, (1.0 - (uv[1] * scale[1] + offset[1])) as f32]
    });
    let cutout = Cutout { mask, uv, alpha: [1.0; 3] };
    match model.masks.get(mask as usize).and_then(|mask| mask.settled(cutout.alpha)) {
        Some(true) => Some(Mark::default()),
        Some(false) => None,
        None => Some(Mark { two_sided: false, cutout: Some(cutout) }),
    }
}

/// Path and text of a library; the error says why there is none.
fn library_text(path: &Path, name: &Path, reach: Reach) -> Result<(PathBuf, String), String> {
    let file = beside::path(path, &name.to_string_lossy().replace('\\', "/"), reach)?;
    let bytes = beside::bytes(&file).map_err(|error| error.to_string())?;
    Ok((file, clean(&bytes)))
}

/// The materials of a library, by which tobj tells faces apart: only names.
fn names_of(text: &str) -> tobj::MTLLoadResult {
    let statements = text.lines().filter_map(|line| line.trim().strip_prefix("newmtl"));
    let names = statements.filter(|rest| rest.starts_with(char::is_whitespace)).map(|rest| rest.trim().to_owned());
    let materials: Vec<_> = names.map(|name| tobj::Material { name, ..Default::default() }).collect();
    let numbers = materials.iter().enumerate().map(|(k, material)| (material.name.clone(), k)).collect();
    Ok((materials, numbers))
}

fn read_libraries(path: &Path, names: &[PathBuf], (blend, reach): (BlendRule, Reach), model: &mut Model) -> Library {
    let mut library = Library::new();
    for name in names {
        match library_text(path, name, reach) {
            Ok((file, text)) => {
                mtl::read(&file, &text, (blend, reach), &mut library, model);
                if !model.inputs.contains(&file) {
                    model.inputs.push(file);
                }
            }
            Err(problem) => model.notes.push(format!(
                "{}: material library {:?}: {problem}; its materials are taken as opaque",
                path.display(),
                name
            )),
        }
    }
    library
}

/// Text that tobj accepts: UTF-16 where the file begins so, Latin-1 where it is not UTF-8 (names and comments of old
/// exporters), lines that end in `\` joined with the next.
fn clean(bytes: &[u8]) -> String {
    let utf16 = |pairs: &[u8], unit: fn([u8; 2]) -> u16| {
        String::from_utf16_lossy(&pairs.as_chunks().0.iter().map(|pair| unit(*pair)).collect::<Vec<_>>())
    };
    let text = match bytes {
        [0xff, 0xfe, rest @ ..] => utf16(rest, u16::from_le_bytes),
        [0xfe, 0xff, rest @ ..] => utf16(rest, u16::from_be_bytes),
        _ => match std::str::from_utf8(bytes) {
            Ok(text) => text.strip_prefix('\u{feff}').unwrap_or(text).to_owned(),
            Err(_) => bytes.iter().map(|&byte| char::from(byte)).collect(),
        },
    };
    if text.contains('\\') { text.replace("\\\r\n", " ").replace("\\\n", " ") } else { text }
}

/// Vertices without what follows their coordinates.
fn without_colours(text: &str) -> String {
    let line = |line: &str| match line.split_whitespace().collect::<Vec<_>>().as_slice() {
        ["v", x, y, z, ..] => format!("v {x} {y} {z}\n"),
        _ => format!("{line}\n"),
    };
    text.lines().map(line).collect()
}

/// Text in which faces of a material without a name have one that no library has.
fn with_material_names(text: &str) -> String {
    text.lines().map(|line| if line.trim() == "usemtl" { "usemtl ?\n".into() } else { format!("{line}\n") }).collect()
}

/// Most characters of a line that are quoted.
const QUOTED: usize = 60;

/// The first line with a coordinate that is no number, or a face whose vertex is none, by number from 1; tobj does not say
/// where it gave up.
fn flawed_line(text: &str) -> Option<(usize, &str)> {
    let mut vertices = 0_i64;
    let is_vertex = |word: &str, vertices: i64| {
        let index = word.split('/').next().and_then(|index| index.parse::<i64>().ok());
        index.is_some_and(|index| index != 0 && index.unsigned_abs() <= vertices.unsigned_abs())
    };
    for (number, line) in (1..).zip(text.lines()) {
        let mut words = line.split_whitespace();
        let sound = match words.next() {
            Some("v") => {
                vertices += 1;
                words.clone().count() >= 3 && words.take(3).all(|word| word.parse::<f64>().is_ok())
            }
            Some("f") => words.all(|word| is_vertex(word, vertices)),
            _ => true,
        };
        if !sound {
            let end = line.char_indices().nth(QUOTED).map_or(line.len(), |(end, _)| end);
            return Some((number, line[..end].trim()));
        }
    }
    None
}

/// Triangles of all faces of an object, as places in its list of indices. tobj lists no arities when all faces are
/// triangles.
fn faces(mesh: &tobj::Mesh, vertices: &[DVec3]) -> Vec<[usize; 3]> {
    if mesh.face_arities.is_empty() {
        return (0..mesh.indices.len() / 3).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    }
    let mut begin = 0;
    let mut triangles = Vec::with_capacity(mesh.indices.len());
    for &arity in &mesh.face_arities {
        let Some(face) = mesh.indices.get(begin..begin + arity as usize) else { break };
        let corners: Option<Vec<DVec3>> = face.iter().map(|&index| vertices.get(index as usize).copied()).collect();
        match corners {
            _ if arity == 3 => triangles.push([begin, begin + 1, begin + 2]),
            Some(corners) => triangles.extend(triangulate(&corners).into_iter().map(|t| t.map(|k| begin + k))),
            // An index out of range: leave it in a triangle for the builder to report.
            None => triangles.extend((2..face.len()).map(|k| [begin + k - 2, begin + k - 1, begin + k])),
        }
        begin += arity as usize;
    }
    triangles
}
