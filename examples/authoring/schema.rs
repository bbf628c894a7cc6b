//! The part of glTF 2.0 (and KHR_lights_punctual) that the examples use, in the order in which it is written. Structs
//! rather than a JSON map, so that the order of keys, hence every byte, is ours.

use serde::Serialize;

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Gltf {
    pub(crate) asset: Asset,
    pub(crate) extensions_used: [&'static str; 1],
    pub(crate) scene: usize,
    pub(crate) scenes: [Scene; 1],
    pub(crate) nodes: Vec<Node>,
    pub(crate) cameras: Vec<Camera>,
    pub(crate) meshes: Vec<Mesh>,
    pub(crate) materials: Vec<Material>,
    pub(crate) animations: [Animation; 1],
    pub(crate) accessors: Vec<Accessor>,
    pub(crate) buffer_views: Vec<BufferView>,
    pub(crate) buffers: [Buffer; 1],
    pub(crate) extensions: Extensions<Lights>,
}

#[derive(Serialize)]
pub(crate) struct Asset {
    pub(crate) version: &'static str,
    pub(crate) generator: String,
}

#[derive(Serialize)]
pub(crate) struct Scene {
    pub(crate) name: &'static str,
    pub(crate) nodes: Vec<usize>,
}

#[derive(Serialize, Default)]
pub(crate) struct Node {
    pub(crate) name: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) mesh: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) camera: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) extensions: Option<Extensions<LightIndex>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) translation: Option<[f32; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) rotation: Option<[f32; 4]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) scale: Option<[f32; 3]>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(crate) children: Vec<usize>,
}

#[derive(Serialize)]
pub(crate) struct Extensions<T> {
    #[serde(rename = "KHR_lights_punctual")]
    pub(crate) lights_punctual: T,
}

#[derive(Serialize)]
pub(crate) struct LightIndex {
    pub(crate) light: usize,
}

#[derive(Serialize)]
pub(crate) struct Lights {
    pub(crate) lights: Vec<Light>,
}

#[derive(Serialize)]
pub(crate) struct Light {
    pub(crate) name: &'static str,
    #[serde(rename = "type")]
    pub(crate) kind: &'static str,
    pub(crate) color: [f32; 3],
    /// Lux for directional lights, candela for the others.
    pub(crate) intensity: f32,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) range: Option<f32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) spot: Option<Spot>,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Spot {
    pub(crate) inner_cone_angle: f32,
    pub(crate) outer_cone_angle: f32,
}

#[derive(Serialize)]
pub(crate) struct Camera {
    pub(crate) name: &'static str,
    #[serde(rename = "type")]
    pub(crate) kind: &'static str,
    pub(crate) perspective: Perspective,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Perspective {
    pub(crate) aspect_ratio: f32,
    pub(crate) yfov: f32,
    pub(crate) znear: f32,
    pub(crate) zfar: f32,
}

#[derive(Serialize)]
pub(crate) struct Mesh {
    pub(crate) name: &'static str,
    pub(crate) primitives: [Primitive; 1],
}

#[derive(Serialize)]
pub(crate) struct Primitive {
    pub(crate) attributes: Attributes,
    pub(crate) indices: usize,
    pub(crate) material: usize,
}

#[derive(Serialize)]
pub(crate) struct Attributes {
    #[serde(rename = "POSITION")]
    pub(crate) position: usize,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Material {
    pub(crate) name: &'static str,
    pub(crate) pbr_metallic_roughness: Surface,
    pub(crate) double_sided: bool,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Surface {
    pub(crate) base_color_factor: [f32; 4],
    pub(crate) metallic_factor: f32,
    pub(crate) roughness_factor: f32,
}

#[derive(Serialize, Default)]
pub(crate) struct Animation {
    pub(crate) name: &'static str,
    pub(crate) samplers: Vec<Sampler>,
    pub(crate) channels: Vec<Channel>,
}

#[derive(Serialize)]
pub(crate) struct Sampler {
    pub(crate) input: usize,
    pub(crate) interpolation: &'static str,
    pub(crate) output: usize,
}

#[derive(Serialize)]
pub(crate) struct Channel {
    pub(crate) sampler: usize,
    pub(crate) target: Target,
}

#[derive(Serialize)]
pub(crate) struct Target {
    pub(crate) node: usize,
    pub(crate) path: &'static str,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Accessor {
    pub(crate) buffer_view: usize,
    pub(crate) byte_offset: usize,
    pub(crate) component_type: u32,
    pub(crate) count: usize,
    #[serde(rename = "type")]
    pub(crate) kind: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) min: Option<Vec<f32>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) max: Option<Vec<f32>>,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct BufferView {
    pub(crate) buffer: usize,
    pub(crate) byte_offset: usize,
    pub(crate) byte_length: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) target: Option<u32>,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Buffer {
    pub(crate) byte_length: usize,
}
