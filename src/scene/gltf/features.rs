//! What a glTF file may need, and what of it is refused by name rather than planned wrongly.
//!
//! Only what the active scene uses is refused: an unused skin elsewhere in the file does no harm.

use super::document::{Document, Node, Primitive};
use crate::scene::model::place;
use std::collections::BTreeSet;

/// Extensions whose data are read.
const SUPPORTED: [&str; 7] = [
    "KHR_lights_punctual",
    "KHR_mesh_quantization",
    "KHR_draco_mesh_compression",
    "KHR_meshopt_compression",
    "EXT_meshopt_compression",
    "KHR_texture_transform",
    "EXT_texture_webp",
];

/// Extensions that may even be required: those of materials and metadata, which change no triangle, named exactly or by
/// prefix; and two that are judged where they are used.
const HARMLESS: [&str; 10] = [
    "KHR_materials_",
    "KHR_texture_",
    "EXT_texture_",
    "EXT_lights_image_based",
    "EXT_lights_ies",
    "KHR_xmp",
    "MSFT_texture_dds",
    "MSFT_packing_",
    "KHR_animation_pointer",
    "KHR_node_visibility",
];

/// Animation pointers to these change no triangle.
const HARMLESS_POINTERS: [&str; 4] = ["/materials/", "/textures/", "/images/", "/extensions/EXT_lights_image_based/"];

const MORPH: (&str, &str) = ("morph targets", "bake the shape into plain meshes on export");
const SKIN: (&str, &str) = ("skins", "bake the skinning into plain meshes on export");
const INSTANCING: (&str, &str) = ("EXT_mesh_gpu_instancing", "export instances as nodes");
const POINTER: (&str, &str) = ("KHR_animation_pointer", "animate node translation, rotation and scale instead");
const HIDDEN: (&str, &str) = ("KHR_node_visibility", "delete hidden nodes before export");

/// What stands in the way of reading a file, and what the user should know of it.
#[derive(Debug, Default)]
pub(super) struct Findings {
    /// Needed but not supported: one text a feature, with its remedy. Empty = the file can be read.
    pub refused: Vec<String>,
    /// Remarks.
    pub notes: Vec<String>,
    seen: BTreeSet<&'static str>,
}

impl Findings {
    /// Records a feature where it is first needed.
    fn refuse(&mut self, (feature, remedy): (&'static str, &str), place: &str) {
        if self.seen.insert(feature) {
            self.refused.push(format!("{feature} at {place} ({remedy})"));
        }
    }
}

/// Looks through a document. `nodes` are indices of the nodes of the active scene.
pub(super) fn examine(document: &Document, nodes: &[usize]) -> Findings {
    let mut findings = Findings::default();
    extensions(document, &mut findings);
    for (index, node) in nodes.iter().filter_map(|&index| Some((index, document.nodes.get(index)?))) {
        node_features(document, index, node, &mut findings);
    }
    for (index, animation) in document.animations.iter().enumerate() {
        for pointer in animation.channels.iter().filter_map(|c| c.target.extensions.pointer.as_ref()) {
            if !HARMLESS_POINTERS.iter().any(|harmless| pointer.pointer.starts_with(harmless)) {
                let at = format!("{}, {}", place("animation", index, animation.name.as_deref()), pointer.pointer);
                findings.refuse(POINTER, &at);
            }
        }
    }
    findings
}

/// Required extensions are refused unless known; others that are merely used are noted.
fn extensions(document: &Document, findings: &mut Findings) {
    let harmless =
        |name: &str| HARMLESS.iter().any(|known| name == *known || known.ends_with('_') && name.starts_with(known));
    for required in &document.extensions_required {
        let name = required.as_str();
        match [INSTANCING].into_iter().find(|feature| feature.0 == name) {
            Some(feature) => findings.refuse(feature, "extensionsRequired"),
            None if SUPPORTED.contains(&name) || harmless(name) => {}
            None => findings.refused.push(format!("{name} at extensionsRequired (export without it)")),
        }
    }
    let ignored: BTreeSet<&str> =
        document.extensions_used.iter().map(String::as_str).filter(|name| !SUPPORTED.contains(name)).collect();
    if !ignored.is_empty() {
        let names: Vec<&str> = ignored.into_iter().collect();
        findings.notes.push(format!("extensions ignored: {}", names.join(", ")));
    }
}

fn node_features(document: &Document, index: usize, node: &Node, findings: &mut Findings) {
    let at = place("node", index, node.name.as_deref());
    if node.extensions.visibility.as_ref().is_some_and(|v| v.visible == Some(false)) {
        findings.refuse(HIDDEN, &at);
    }
    let Some(mesh) = node.mesh.and_then(|mesh| document.meshes.get(mesh)) else { return };
    if node.skin.is_some() {
        findings.refuse(SKIN, &at);
    }
    if node.extensions.instancing.is_some() {
        findings.refuse(INSTANCING, &at);
    }
    for primitive in &mesh.primitives {
        primitive_features(primitive, &at, findings);
    }
}

fn primitive_features(primitive: &Primitive, at: &str, findings: &mut Findings) {
    if !primitive.targets.is_empty() {
        findings.refuse(MORPH, at);
    }
}
