//! The properties of a glTF 2.0 document that bear on shadows, as serde types; all others are skipped.
//!
//! Not the `gltf` crate's document: that one holds transforms in f32 (a node at 1,000,000.1 m comes out 2.5 cm off),
//! rejects files for flaws in materials and images that shadows never see, and fails as a whole on
//! KHR_animation_pointer. Here every reference between properties is an unchecked index, resolved through [`entry`].

use crate::scene::SceneError;
use serde::Deserialize;
use serde::de::IgnoredAny;
use std::collections::BTreeMap;
use std::path::Path;

/// Declares a struct whose keys are camelCase and may all be absent.
macro_rules! properties {
    ($($(#[$meta:meta])* $name:ident { $($(#[$field_meta:meta])* $field:ident: $type:ty,)* })*) => { $(
        $(#[$meta])*
        #[derive(Debug, Default, Deserialize)]
        #[serde(rename_all = "camelCase", default)]
        pub(super) struct $name { $($(#[$field_meta])* pub $field: $type,)* }
    )* };
}

properties! {
    Document {
        asset: Asset,
        scene: Option<usize>,
        scenes: Vec<SceneEntry>,
        nodes: Vec<Node>,
        meshes: Vec<Mesh>,
        cameras: Vec<Camera>,
        materials: Vec<Material>,
        textures: Vec<Texture>,
        samplers: Vec<TextureSampler>,
        images: Vec<Image>,
        skins: Vec<Skin>,
        animations: Vec<Animation>,
        accessors: Vec<Accessor>,
        buffer_views: Vec<BufferView>,
        buffers: Vec<Buffer>,
        extensions_used: Vec<String>,
        extensions_required: Vec<String>,
        extensions: DocumentExtensions,
    }
    AnyVersion { asset: Asset, }
    Asset { version: String, }
    SceneEntry { name: Option<String>, nodes: Vec<usize>, }
    DocumentExtensions {
        #[serde(rename = "KHR_lights_punctual")]
        lights: Lights,
    }
    Lights { lights: Vec<Light>, }
    Light {
        name: Option<String>,
        #[serde(rename = "type")]
        kind: String,
        range: Option<f64>,
        spot: Option<Spot>,
    }
    Spot { outer_cone_angle: Option<f64>, }
    Node {
        name: Option<String>,
        children: Vec<usize>,
        mesh: Option<usize>,
        camera: Option<usize>,
        skin: Option<usize>,
        translation: Option<[f64; 3]>,
        rotation: Option<[f64; 4]>,
        scale: Option<[f64; 3]>,
        matrix: Option<[f64; 16]>,
        weights: Option<Vec<f64>>,
        extensions: NodeExtensions,
    }
    NodeExtensions {
        #[serde(rename = "KHR_lights_punctual")]
        light: Option<LightReference>,
        #[serde(rename = "EXT_mesh_gpu_instancing")]
        instancing: Option<Instancing>,
        #[serde(rename = "KHR_node_visibility")]
        visibility: Option<Visibility>,
    }
    LightReference { light: usize, }
    Instancing { attributes: BTreeMap<String, usize>, }
    Visibility { visible: Option<bool>, }
    Mesh { name: Option<String>, primitives: Vec<Primitive>, weights: Vec<f64>, }
    Primitive {
        attributes: Attributes,
        indices: Option<usize>,
        mode: Option<u64>,
        material: Option<usize>,
        targets: Vec<Attributes>,
        extensions: PrimitiveExtensions,
    }
    Attributes {
        #[serde(rename = "POSITION")]
        position: Option<usize>,
        /// By name: `JOINTS_0`, `WEIGHTS_0`, ...
        #[serde(flatten)]
        others: BTreeMap<String, usize>,
    }
    PrimitiveExtensions {
        #[serde(rename = "KHR_draco_mesh_compression")]
        draco: Option<Draco>,
    }
    Draco { buffer_view: usize, attributes: BTreeMap<String, u32>, }
    Skin { name: Option<String>, joints: Vec<usize>, inverse_bind_matrices: Option<usize>, }
    Material {
        name: Option<String>,
        alpha_mode: Option<String>,
        alpha_cutoff: Option<f64>,
        double_sided: bool,
        pbr_metallic_roughness: Metallic,
        extensions: MaterialExtensions,
    }
    Metallic { base_color_factor: Option<[f64; 4]>, base_color_texture: Option<TextureInfo>, }
    MaterialExtensions {
        #[serde(rename = "KHR_materials_pbrSpecularGlossiness")]
        specular_glossiness: Option<Glossiness>,
    }
    Glossiness { diffuse_factor: Option<[f64; 4]>, diffuse_texture: Option<TextureInfo>, }
    TextureInfo { index: usize, tex_coord: usize, extensions: TextureInfoExtensions, }
    TextureInfoExtensions {
        #[serde(rename = "KHR_texture_transform")]
        transform: Option<TextureTransform>,
    }
    TextureTransform {
        offset: Option<[f64; 2]>,
        rotation: Option<f64>,
        scale: Option<[f64; 2]>,
        tex_coord: Option<usize>,
    }
    Texture { source: Option<usize>, sampler: Option<usize>, extensions: TextureExtensions, }
    TextureExtensions {
        #[serde(rename = "EXT_texture_webp")]
        webp: Option<TextureSource>,
        #[serde(rename = "KHR_texture_basisu")]
        basisu: Option<IgnoredAny>,
    }
    TextureSource { source: usize, }
    TextureSampler { mag_filter: Option<u64>, wrap_s: Option<u64>, wrap_t: Option<u64>, }
    Image { name: Option<String>, uri: Option<String>, buffer_view: Option<usize>, }
    Camera {
        name: Option<String>,
        #[serde(rename = "type")]
        kind: String,
        perspective: Option<Perspective>,
        orthographic: Option<Orthographic>,
    }
    Perspective { aspect_ratio: Option<f64>, yfov: f64, znear: f64, zfar: Option<f64>, }
    Orthographic { xmag: f64, ymag: f64, znear: f64, zfar: f64, }
    Animation { name: Option<String>, channels: Vec<Channel>, samplers: Vec<Sampler>, }
    Channel { sampler: usize, target: Target, }
    Target { node: Option<usize>, path: String, extensions: TargetExtensions, }
    TargetExtensions {
        #[serde(rename = "KHR_animation_pointer")]
        pointer: Option<Pointer>,
    }
    Pointer { pointer: String, }
    Sampler { input: usize, output: usize, interpolation: Option<String>, }
    Accessor {
        buffer_view: Option<usize>,
        byte_offset: u64,
        component_type: u64,
        normalized: bool,
        count: u64,
        #[serde(rename = "type")]
        kind: String,
        sparse: Option<Sparse>,
    }
    Sparse { count: u64, indices: SparseIndices, values: SparseValues, }
    SparseIndices { buffer_view: usize, byte_offset: u64, component_type: u64, }
    SparseValues { buffer_view: usize, byte_offset: u64, }
    BufferView {
        buffer: usize,
        byte_offset: u64,
        byte_length: u64,
        byte_stride: Option<u64>,
        extensions: BufferViewExtensions,
    }
    BufferViewExtensions {
        #[serde(rename = "KHR_meshopt_compression")]
        meshopt: Option<MeshoptView>,
        #[serde(rename = "EXT_meshopt_compression")]
        meshopt_ext: Option<MeshoptView>,
    }
    MeshoptView {
        buffer: usize,
        byte_offset: u64,
        byte_length: u64,
        byte_stride: u64,
        count: u64,
        mode: String,
        filter: Option<String>,
    }
    Buffer { uri: Option<String>, byte_length: u64, extensions: BufferExtensions, }
    BufferExtensions {
        #[serde(rename = "KHR_meshopt_compression")]
        meshopt: MeshoptBuffer,
        #[serde(rename = "EXT_meshopt_compression")]
        meshopt_ext: MeshoptBuffer,
    }
    MeshoptBuffer { fallback: bool, }
}

impl BufferView {
    /// What of either extension stands for the view's bytes.
    pub(super) fn meshopt(&self) -> Option<&MeshoptView> {
        self.extensions.meshopt.as_ref().or(self.extensions.meshopt_ext.as_ref())
    }
}

impl Buffer {
    /// True for bytes that only readers without EXT_meshopt_compression need.
    pub(super) fn is_fallback(&self) -> bool {
        self.extensions.meshopt.fallback || self.extensions.meshopt_ext.fallback
    }
}

impl Attributes {
    /// The accessor of an attribute.
    pub(super) fn accessor(&self, name: &str) -> Option<usize> {
        if name == "POSITION" { self.position } else { self.others.get(name).copied() }
    }
}

/// Reads the JSON of a file and checks its version.
///
/// # Errors
/// [`SceneError::Malformed`] with line and column.
pub(super) fn parse(path: &Path, json: &[u8]) -> Result<Document, SceneError> {
    let json = json.strip_prefix(b"\xef\xbb\xbf").unwrap_or(json);
    let parsed = serde_json::from_slice::<Document>(json);
    // Other versions may have other types: why it fails comes after which it is.
    let version = match &parsed {
        Ok(document) => Some(document.asset.version.clone()),
        Err(_) => serde_json::from_slice::<AnyVersion>(json).ok().map(|any| any.asset.version),
    };
    if let Some(version) = version.filter(|version| !version.starts_with("2.")) {
        let problem = format!("version {version:?} is not 2.x; convert the file to glTF 2.0");
        return Err(malformed(path, "asset", problem));
    }
    parsed.map_err(|error| malformed(path, "glTF JSON", format!("{error}; export the file again")))
}

/// A [`SceneError::Malformed`].
pub(super) fn malformed(path: &Path, place: impl Into<String>, problem: impl Into<String>) -> SceneError {
    SceneError::Malformed { path: path.to_owned(), place: place.into(), problem: problem.into() }
}

/// The property with an index, or an error that says who asked for it.
pub(super) fn entry<'a, T>(
    path: &Path,
    asked_by: &str,
    kind: &str,
    entries: &'a [T],
    index: usize,
) -> Result<&'a T, SceneError> {
    entries.get(index).ok_or_else(|| {
        malformed(
            path,
            asked_by,
            format!("refers to {kind} {index}, but the file has {}; export it again", entries.len()),
        )
    })
}
