//! glTF 2.0 (`.gltf`, `.glb`) → the [`Model`].
//!
//! Reads node hierarchies, meshes of triangles, cameras, KHR_lights_punctual and TRS animation; [`features`] says what
//! is refused. Cameras: yfov, aspect, near and far as written; scale on the node changes none of them.

mod accessor;
mod animation;
mod buffers;
mod container;
mod document;
mod draco;
mod features;
mod materials;
mod mesh;
mod meshopt;
mod nodes;
mod views;

use super::model::{FileCamera, FileLight, FileLightKind, Model, Part, place};
use super::{BlendRule, Projection, SceneError};
use accessor::Source;
use document::{Camera, Document, Light, entry, malformed};
use materials::Materials;
use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};
use std::path::Path;
use std::sync::Arc;

/// True for the first bytes of a `.glb`.
pub(super) fn is_glb(bytes: &[u8]) -> bool {
    bytes.starts_with(container::GLB_MAGIC)
}

/// Adds a file, whose bytes have been read, to the model.
///
/// # Errors
/// [`SceneError::Malformed`], [`SceneError::Read`] for external buffers, [`SceneError::Unsupported`].
pub(super) fn read(path: &Path, mut bytes: Vec<u8>, blend: BlendRule, model: &mut Model) -> Result<(), SceneError> {
    let container = container::locate(path, &bytes)?;
    let document = document::parse(path, &bytes[container.json])?;
    let visits = nodes::walk(path, &document)?;
    let in_scene: Vec<usize> = visits.iter().map(|visit| visit.index).collect();
    let findings = features::examine(&document, &in_scene);
    if !findings.refused.is_empty() {
        return Err(SceneError::Unsupported { path: path.to_owned(), features: findings.refused });
    }
    let mut notes = findings.notes;
    if document.scenes.len() > 1 {
        notes.push(format!(
            "{} scenes in the file; scene {} is used",
            document.scenes.len(),
            document.scene.unwrap_or(0)
        ));
    }
    let bin = container.bin.map(|bin| {
        bytes.truncate(bin.end);
        bytes.split_off(bin.start)
    });
    let mut buffers = buffers::load(path, &document, bin, &mut model.inputs)?;
    let meshes = in_scene.iter().filter_map(|&node| document.nodes[node].mesh).collect::<BTreeSet<_>>();
    buffers.draco = draco::decode(Source { path, document: &document, buffers: &buffers }, meshes.into_iter())?;
    let source = Source { path, document: &document, buffers: &buffers };

    let file: Arc<Path> = Arc::from(path);
    let base = model.nodes.len();
    let mut model_node = vec![None; document.nodes.len()];
    for visit in &visits {
        let node = &document.nodes[visit.index];
        model_node[visit.index] = Some(model.nodes.len());
        model.nodes.push(nodes::convert(&file, visit.index, node, visit.parent.map(|parent| base + parent))?);
    }
    let materials = Materials::new(source, blend);
    add_meshes(source, materials, &model_node, &in_scene, model, &mut notes)?;
    for &index in &in_scene {
        add_camera_and_light(path, &document, index, model_node[index].unwrap_or(0), model)?;
    }
    let (last_key_s, animation_notes) = animation::attach(source, &mut model.nodes, &model_node)?;
    model.last_key_s = latest(model.last_key_s, last_key_s);
    notes.extend(animation_notes);
    model.notes.extend(notes.into_iter().map(|note| format!("{}: {note}", path.display())));
    Ok(())
}

/// The later of two times, where there are any.
fn latest(a: Option<f64>, b: Option<f64>) -> Option<f64> {
    a.into_iter().chain(b).reduce(f64::max)
}

fn add_meshes(
    source: Source<'_>,
    materials: Materials<'_>,
    model_node: &[Option<usize>],
    in_scene: &[usize],
    model: &mut Model,
    notes: &mut Vec<String>,
) -> Result<(), SceneError> {
    let mut reader = mesh::Reader::new(source, materials);
    let mut model_mesh = BTreeMap::new();
    for &index in in_scene {
        let (Some(node), Some(mesh)) = (model_node[index], source.document.nodes[index].mesh) else { continue };
        let place = model.nodes[node].place();
        let gltf_mesh = entry(source.path, &place, "mesh", &source.document.meshes, mesh)?;
        let mesh = match model_mesh.entry(mesh) {
            Entry::Occupied(known) => *known.get(),
            Entry::Vacant(slot) => {
                let read = reader.read(mesh, gltf_mesh, &mut model.masks, &mut model.inputs)?;
                model.meshes.push(read);
                *slot.insert(model.meshes.len() - 1)
            }
        };
        model.parts.push(Part { node, mesh });
    }
    let skipped = reader.skipped;
    if skipped.points_or_lines > 0 {
        notes.push(format!("{} primitives of points or lines ignored", skipped.points_or_lines));
    }
    if skipped.degenerate > 0 {
        notes.push(format!("{} triangles without area dropped", skipped.degenerate));
    }
    if skipped.transparent > 0 {
        notes.push(format!("{} wholly transparent triangles left out", skipped.transparent));
    }
    Ok(())
}

fn add_camera_and_light(
    path: &Path,
    document: &Document,
    index: usize,
    node: usize,
    model: &mut Model,
) -> Result<(), SceneError> {
    let asked_by = model.nodes[node].place();
    if let Some(camera) = document.nodes[index].camera {
        let found = entry(path, &asked_by, "camera", &document.cameras, camera)?;
        model.cameras.push(convert_camera(path, camera, found, node)?);
    }
    if let Some(reference) = &document.nodes[index].extensions.light {
        let lights = &document.extensions.lights.lights;
        let found = entry(path, &asked_by, "KHR_lights_punctual light", lights, reference.light)?;
        model.lights.push(convert_light(path, reference.light, found, node)?);
    }
    Ok(())
}

fn convert_camera(path: &Path, index: usize, camera: &Camera, node: usize) -> Result<FileCamera, SceneError> {
    let fail = |problem: String| malformed(path, place("camera", index, camera.name.as_deref()), problem);
    let (projection, aspect, near, far) = match (camera.kind.as_str(), &camera.perspective, &camera.orthographic) {
        ("perspective", Some(p), _) => {
            if !(p.yfov > 0.0 && p.yfov < PI) {
                return Err(fail(format!("yfov {} is not between 0 and π", p.yfov)));
            }
            if let Some(aspect) = p.aspect_ratio.filter(|&aspect| aspect.is_nan() || aspect <= 0.0) {
                return Err(fail(format!("aspectRatio {aspect} is not positive")));
            }
            if p.znear.is_nan() || p.znear <= 0.0 {
                return Err(fail(format!("znear {} is not positive", p.znear)));
            }
            (Projection::Perspective { yfov_rad: p.yfov }, p.aspect_ratio, p.znear, p.zfar)
        }
        ("orthographic", _, Some(o)) => {
            if !(o.xmag > 0.0 && o.ymag > 0.0 && o.znear >= 0.0) {
                return Err(fail(format!(
                    "xmag {}, ymag {} are not positive or znear {} is negative",
                    o.xmag, o.ymag, o.znear
                )));
            }
            (Projection::Orthographic { half_height: o.ymag }, Some(o.xmag / o.ymag), o.znear, Some(o.zfar))
        }
        (kind, ..) => return Err(fail(format!("type {kind:?} is unknown, or its properties are missing"))),
    };
    if let Some(far) = far.filter(|&far| far.is_nan() || far <= near) {
        return Err(fail(format!("zfar {far} is not beyond znear {near}")));
    }
    Ok(FileCamera { node, name: camera.name.clone(), projection, aspect, near, far })
}

fn convert_light(path: &Path, index: usize, light: &Light, node: usize) -> Result<FileLight, SceneError> {
    let fail = |problem: String| malformed(path, place("light", index, light.name.as_deref()), problem);
    if let Some(range) = light.range.filter(|&range| range.is_nan() || range <= 0.0) {
        return Err(fail(format!("range {range} is not positive")));
    }
    let range = light.range;
    let kind = match light.kind.as_str() {
        "directional" => FileLightKind::Directional,
        "point" => FileLightKind::Point { range },
        "spot" => {
            let cone_rad = light.spot.as_ref().and_then(|spot| spot.outer_cone_angle).unwrap_or(FRAC_PI_4);
            // Writers round π/2 up to the next f32.
            let top = f64::from(FRAC_PI_2 as f32);
            if !(cone_rad > 0.0 && cone_rad <= top.max(FRAC_PI_2)) {
                return Err(fail(format!("outerConeAngle {cone_rad} is not in (0, π/2]")));
            }
            FileLightKind::Spot { cone_rad: cone_rad.min(FRAC_PI_2), range }
        }
        other => return Err(fail(format!("type {other:?} is unknown"))),
    };
    Ok(FileLight { node, name: light.name.clone(), kind })
}
