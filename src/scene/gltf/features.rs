//! What a glTF file may need, and what of it is refused by name rather than planned wrongly.
//!
//! Only what the active scene uses is refused: a compressed mesh elsewhere in the file does no harm. Alpha MASK and BLEND
//! are taken as opaque, with a note.

use super::document::{Document, Node, Primitive};
use crate::scene::model::place;
use std::collections::BTreeSet;

/// Extensions whose data are read.
const SUPPORTED: [&str; 5] = [
    "KHR_lights_punctual",
    "KHR_mesh_quantization",
    "KHR_animation_pointer",
    "KHR_node_visibility",
    "EXT_mesh_gpu_instancing",
];

/// Extensions that may even be required: those of materials and metadata, which change no triangle, named exactly or by
/// prefix.
const HARMLESS: [&str; 8] = [
    "KHR_materials_",
    "KHR_texture_",
    "EXT_texture_",
    "EXT_lights_image_based",
    "EXT_lights_ies",
    "KHR_xmp",
    "MSFT_texture_dds",
    "MSFT_packing_",
];

const DRACO: (&str, &str) = ("KHR_draco_mesh_compression", "export without compression");
const MESHOPT: (&str, &str) = ("EXT_meshopt_compression", "export without compression");

/// What stands in the way of reading a file, and what the user should know of it.
#[derive(Debug, Default)]
pub(super) struct Findings {
    /// Needed but not supported: one text a feature, with its remedy. Empty = the file can be read.
    pub refused: Vec<String>,
    /// Remarks.
    pub notes: Vec<String>,
    seen: BTreeSet<&'static str>,
    /// Names of materials with another alphaMode than OPAQUE.
    not_opaque: BTreeSet<String>,
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
    for (index, view) in document.buffer_views.iter().enumerate() {
        let no_fallback = || document.buffers.get(view.buffer).is_some_and(|b| b.uri.is_none() && view.buffer != 0);
        if view.extensions.meshopt.is_some() && no_fallback() {
            findings.refuse(MESHOPT, &format!("bufferView {index}"));
        }
    }
    if !findings.not_opaque.is_empty() {
        let names: Vec<&str> = findings.not_opaque.iter().map(String::as_str).collect();
        findings.notes.push(format!("alphaMode MASK or BLEND taken as opaque: {}", names.join(", ")));
    }
    findings
}

/// Required extensions are refused unless known; others that are merely used are noted.
fn extensions(document: &Document, findings: &mut Findings) {
    let harmless =
        |name: &str| HARMLESS.iter().any(|known| name == *known || known.ends_with('_') && name.starts_with(known));
    for required in &document.extensions_required {
        let name = required.as_str();
        match [DRACO, MESHOPT].into_iter().find(|feature| feature.0 == name) {
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
    let Some(mesh) = node.mesh.and_then(|mesh| document.meshes.get(mesh)) else { return };
    for primitive in &mesh.primitives {
        primitive_features(document, primitive, &at, findings);
    }
}

fn primitive_features(document: &Document, primitive: &Primitive, at: &str, findings: &mut Findings) {
    let uncompressed = || {
        let accessor = document.accessors.get(primitive.attributes.position?)?;
        accessor.buffer_view
    };
    if primitive.extensions.draco.is_some() && uncompressed().is_none() {
        findings.refuse(DRACO, at);
    }
    let Some(material) = primitive.material else { return };
    if let Some(found) = document.materials.get(material)
        && found.alpha_mode.as_deref().is_some_and(|mode| mode != "OPAQUE")
    {
        findings.not_opaque.insert(place("material", material, found.name.as_deref()));
    }
}
