//! The part of glTF 2.0 (and KHR_lights_punctual) that the courtyard uses, in the order in which it is written. Structs
//! rather than a JSON map, so that the order of keys, hence every byte, is ours.

use serde::Serialize;

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Gltf {
    pub(super) asset: Asset,
    pub(super) extensions_used: [&'static str; 1],
    pub(super) scene: usize,
    pub(super) scenes: [Scene; 1],
    pub(super) nodes: Vec<Node>,
    pub(super) cameras: Vec<Camera>,
    pub(super) meshes: Vec<Mesh>,
    pub(super) materials: Vec<Material>,
    pub(super) animations: [Animation; 1],
    pub(super) accessors: Vec<Accessor>,
    pub(super) buffer_views: Vec<BufferView>,
    pub(super) buffers: [Buffer; 1],
    pub(super) extensions: Extensions<Lights>,
}

#[derive(Serialize)]
pub(super) struct Asset {
    pub(super) version: &'static str,
    pub(super) generator: &'static str,
}

#[derive(Serialize)]
pub(super) struct Scene {
    pub(super) name: &'static str,
    pub(super) nodes: Vec<usize>,
}

#[derive(Serialize, Default)]
pub(super) struct Node {
    pub(super) name: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) mesh: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) camera: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) extensions: Option<Extensions<LightIndex>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) translation: Option<[f32; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) rotation: Option<[f32; 4]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) scale: Option<[f32; 3]>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(super) children: Vec<usize>,
}

#[derive(Serialize)]
pub(super) struct Extensions<T> {
    #[serde(rename = "KHR_lights_punctual")]
    pub(super) lights_punctual: T,
}

#[derive(Serialize)]
pub(super) struct LightIndex {
    pub(super) light: usize,
}

#[derive(Serialize)]
pub(super) struct Lights {
    pub(super) lights: Vec<Light>,
}

#[derive(Serialize)]
pub(super) struct Light {
    pub(super) name: &'static str,
    #[serde(rename = "type")]
    pub(super) kind: &'static str,
    pub(super) color: [f32; 3],
    /// Lux for directional lights, candela for the others.
    pub(super) intensity: f32,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) range: Option<f32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) spot: Option<Spot>,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Spot {
    pub(super) inner_cone_angle: f32,
    pub(super) outer_cone_angle: f32,
}

#[derive(Serialize)]
pub(super) struct Camera {
    pub(super) name: &'static str,
    #[serde(rename = "type")]
    pub(super) kind: &'static str,
    pub(super) perspective: Perspective,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Perspective {
    pub(super) aspect_ratio: f32,
    pub(super) yfov: f32,
    pub(super) znear: f32,
    pub(super) zfar: f32,
}

#[derive(Serialize)]
pub(super) struct Mesh {
    pub(super) name: &'static str,
    pub(super) primitives: [Primitive; 1],
}

#[derive(Serialize)]
pub(super) struct Primitive {
    pub(super) attributes: Attributes,
    pub(super) indices: usize,
    pub(super) material: usize,
}

#[derive(Serialize)]
pub(super) struct Attributes {
    #[serde(rename = "POSITION")]
    pub(super) position: usize,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Material {
    pub(super) name: &'static str,
    pub(super) pbr_metallic_roughness: Surface,
    pub(super) double_sided: bool,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Surface {
    pub(super) base_color_factor: [f32; 4],
    pub(super) metallic_factor: f32,
    pub(super) roughness_factor: f32,
}

#[derive(Serialize, Default)]
pub(super) struct Animation {
    pub(super) name: &'static str,
    pub(super) samplers: Vec<Sampler>,
    pub(super) channels: Vec<Channel>,
}

#[derive(Serialize)]
pub(super) struct Sampler {
    pub(super) input: usize,
    pub(super) interpolation: &'static str,
    pub(super) output: usize,
}

#[derive(Serialize)]
pub(super) struct Channel {
    pub(super) sampler: usize,
    pub(super) target: Target,
}

#[derive(Serialize)]
pub(super) struct Target {
    pub(super) node: usize,
    pub(super) path: &'static str,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Accessor {
    pub(super) buffer_view: usize,
    pub(super) byte_offset: usize,
    pub(super) component_type: u32,
    pub(super) count: usize,
    #[serde(rename = "type")]
    pub(super) kind: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) min: Option<Vec<f32>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) max: Option<Vec<f32>>,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct BufferView {
    pub(super) buffer: usize,
    pub(super) byte_offset: usize,
    pub(super) byte_length: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) target: Option<u32>,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Buffer {
    pub(super) byte_length: usize,
}
