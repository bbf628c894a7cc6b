//! What a glTF file may require, and what of it is refused by name rather than planned wrongly. (A mask whose image is in a
//! format that is not read is refused where the mask is needed, in [`super::materials`].)

use super::document::Document;
use std::collections::BTreeSet;

/// Extensions whose data are read.
const SUPPORTED: [&str; 10] = [
    "KHR_lights_punctual",
    "KHR_mesh_quantization",
    "KHR_animation_pointer",
    "KHR_node_visibility",
    "EXT_mesh_gpu_instancing",
    "KHR_draco_mesh_compression",
    "KHR_meshopt_compression",
    "EXT_meshopt_compression",
    "KHR_texture_transform",
    "EXT_texture_webp",
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

/// What stands in the way of reading a file, and what the user should know of it.
#[derive(Debug, Default)]
pub(super) struct Findings {
    /// Required but not supported: one text an extension, with its remedy. Empty = the file can be read.
    pub refused: Vec<String>,
    /// Remarks.
    pub notes: Vec<String>,
}

/// Required extensions are refused unless known; others that are merely used are noted.
pub(super) fn examine(document: &Document) -> Findings {
    let known = |name: &str| {
        let harmless = |known: &&str| name == *known || known.ends_with('_') && name.starts_with(*known);
        SUPPORTED.contains(&name) || HARMLESS.iter().any(harmless)
    };
    let unknown: BTreeSet<&str> =
        document.extensions_required.iter().map(String::as_str).filter(|name| !known(name)).collect();
    let refused = unknown.into_iter().map(|name| format!("{name} at extensionsRequired (export without it)")).collect();
    let ignored: Vec<&str> = document
        .extensions_used
        .iter()
        .map(String::as_str)
        .filter(|name| !SUPPORTED.contains(name))
        .collect::<BTreeSet<_>>()
        .into_iter()
        .collect();
    let notes =
        if ignored.is_empty() { Vec::new() } else { vec![format!("extensions ignored: {}", ignored.join(", "))] };
    Findings { refused, notes }
}
