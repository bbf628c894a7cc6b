//! glTF 2.0 (`.gltf`, `.glb`) → the [`Model`].
//!
//! Reads node hierarchies, meshes of triangles with skins, morph targets and instances, cameras, KHR_lights_punctual,
//! visibility and animation of all of these, KHR_animation_pointer included; [`features`] says what is refused. Cameras:
//! yfov, aspect, near and far as written; scale on the node changes none of them.

mod accessor;
mod animation;
mod buffers;
mod container;
mod document;
mod draco;
mod features;
mod instancing;
mod materials;
mod mesh;
mod meshopt;
mod morph;
mod nodes;
mod parts;
mod pointer;
mod scene;
mod skin;
mod views;

use super::beside::Reach;
use super::light_source::WIDEST_CONE_RAD;
use super::model::{CameraTracks, FileCamera, FileLight, FileLightKind, LightTracks, Model, place};
use super::{BlendRule, Projection, SceneError};
use accessor::Source;
use document::{Camera, Document, Light, entry, malformed};
use materials::Materials;
use scene::Placed;
pub(super) use scene::ScenesMet;
use std::collections::BTreeSet;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};
use std::path::Path;
use std::sync::Arc;

/// True for the first bytes of a `.glb`.
pub(super) fn is_glb(bytes: &[u8]) -> bool {
    bytes.starts_with(container::GLB_MAGIC)
}

/// Adds a file, whose bytes have been read, to the model: its scene named `active_scene`, else its default one.
///
/// # Errors
/// [`SceneError::Malformed`], [`SceneError::Read`] for external buffers, [`SceneError::Unsupported`].
pub(super) fn read(
    path: &Path,
    bytes: &[u8],
    (active_scene, blend, reach): (Option<&str>, BlendRule, Reach),
    scenes: &mut ScenesMet,
    model: &mut Model,
) -> Result<(), SceneError> {
    let container = container::locate(path, bytes)?;
    let document = document::parse(path, &bytes[container.json])?;
    let scene = scenes.choose(&document, active_scene);
    let visits = nodes::walk(path, &document, scene)?;
    let in_scene: Vec<usize> = visits.iter().map(|visit| visit.index).collect();
    let findings = features::examine(&document);
    if !findings.refused.is_empty() {
        return Err(SceneError::Unsupported { path: path.to_owned(), features: findings.refused });
    }
    let mut notes = findings.notes;
    if let Some(scene) = scene.filter(|_| document.scenes.len() > 1) {
        let used = place("scene", scene, document.scenes[scene].name.as_deref());
        let count = document.scenes.len();
        notes.push(format!("{used} of {count} in the file is used; choose another with --active-scene NAME"));
    }
    let bin = container.bin.map(|bin| &bytes[bin]);
    let mut buffers = buffers::load(path, &document, bin, reach, &mut model.inputs)?;
    let meshes = in_scene.iter().filter_map(|&node| document.nodes[node].mesh).collect::<BTreeSet<_>>();
    buffers.draco = draco::decode(Source { path, document: &document, buffers: &buffers, reach }, meshes.into_iter())?;
    let source = Source { path, document: &document, buffers: &buffers, reach };

    let file: Arc<Path> = Arc::from(path);
    let base = model.nodes.len();
    let mut placed = Placed { nodes: vec![None; document.nodes.len()], ..Placed::default() };
    for visit in &visits {
        let node = &document.nodes[visit.index];
        placed.nodes[visit.index] = Some(model.nodes.len());
        model.nodes.push(nodes::convert(&file, visit.index, node, visit.parent.map(|parent| base + parent))?);
    }
    let materials = Materials::new(source, blend);
    parts::add(source, materials, &placed.nodes, &in_scene, model, &mut notes)?;
    for (k, &index) in in_scene.iter().enumerate() {
        add_camera_and_light(path, &document, index, base + k, &mut placed, model)?;
    }
    notes.extend(animation::read(source, &file, &placed, model)?);
    model.notes.extend(notes.into_iter().map(|note| format!("{}: {note}", path.display())));
    Ok(())
}

fn add_camera_and_light(
    path: &Path,
    document: &Document,
    index: usize,
    node: usize,
    placed: &mut Placed,
    model: &mut Model,
) -> Result<(), SceneError> {
    let asked_by = model.nodes[node].place();
    if let Some(camera) = document.nodes[index].camera {
        let found = entry(path, &asked_by, "camera", &document.cameras, camera)?;
        placed.cameras.entry(camera).or_default().push(model.cameras.len());
        model.cameras.push(convert_camera(path, camera, found, node)?);
    }
    if let Some(reference) = &document.nodes[index].extensions.light {
        let lights = &document.extensions.lights.lights;
        let found = entry(path, &asked_by, "KHR_lights_punctual light", lights, reference.light)?;
        placed.lights.entry(reference.light).or_default().push(model.lights.len());
        model.lights.push(convert_light(path, reference.light, found, node)?);
    }
    Ok(())
}

fn convert_camera(path: &Path, index: usize, camera: &Camera, node: usize) -> Result<FileCamera, SceneError> {
    let at = || place("camera", index, camera.name.as_deref());
    let fail = |problem: String| malformed(path, at(), format!("{problem}; fix it in the file"));
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
    Ok(FileCamera { node, name: camera.name.clone(), projection, aspect, near, far, tracks: CameraTracks::default() })
}

fn convert_light(path: &Path, index: usize, light: &Light, node: usize) -> Result<FileLight, SceneError> {
    let at = || place("light", index, light.name.as_deref());
    let fail = |problem: String| malformed(path, at(), format!("{problem}; fix it in the file"));
    if let Some(range) = light.range.filter(|&range| range.is_nan() || range <= 0.0) {
        return Err(fail(format!("range {range} is not positive")));
    }
    let range = light.range;
    let kind = match light.kind.as_str() {
        "directional" => FileLightKind::Directional,
        "point" => FileLightKind::Point { range },
        "spot" => {
            let cone_rad = light.spot.as_ref().and_then(|spot| spot.outer_cone_angle).unwrap_or(FRAC_PI_4);
            if !(cone_rad > 0.0 && cone_rad <= WIDEST_CONE_RAD) {
                return Err(fail(format!("outerConeAngle {cone_rad} is not in (0, π/2]")));
            }
            FileLightKind::Spot { cone_rad: cone_rad.min(FRAC_PI_2), range }
        }
        other => return Err(fail(format!("type {other:?} is neither directional nor point nor spot"))),
    };
    Ok(FileLight { node, name: light.name.clone(), kind, tracks: LightTracks::default() })
}
