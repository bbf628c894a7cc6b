//! Collects nodes, meshes, lights and keys, and writes them as a binary glTF 2.0 file (GLB: a JSON chunk and a BIN chunk).

use super::mesh::Mesh;
use super::schema;
use glam::{DQuat, DVec3};
use std::io::{Error, ErrorKind, Result};

/// Lengths are rounded to this many steps a metre (0.12 mm). The steps are binary fractions, hence exact in f32; they
/// swallow the last-bit differences between the sines of different platforms, so the file is the same everywhere.
const STEPS_PER_METRE: f64 = 8192.0;

/// The same for quaternions, sines and angles; a unit quaternion stays one within 1e-6.
const STEPS_PER_UNIT: f64 = 1_048_576.0;

const FLOAT: u32 = 5126;
const UNSIGNED_SHORT: u32 = 5123;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// Rounds a length.
fn metres(value: f64) -> f32 {
    ((value * STEPS_PER_METRE).round() / STEPS_PER_METRE) as f32
}

/// Rounds an angle or a number about one.
pub(crate) fn units(value: f64) -> f32 {
    ((value * STEPS_PER_UNIT).round() / STEPS_PER_UNIT) as f32
}

fn metres3(v: DVec3) -> [f32; 3] {
    v.to_array().map(metres)
}

/// What a node holds besides children.
pub(crate) enum Content {
    Group,
    Mesh(usize),
    Camera(usize),
    Light(usize),
}

/// Parent-from-node: scale first, then rotation, then translation.
#[derive(Clone, Copy)]
pub(crate) struct Placement {
    pub(crate) translation: DVec3,
    pub(crate) rotation: DQuat,
    pub(crate) scale: DVec3,
}

impl Default for Placement {
    fn default() -> Self {
        Placement { translation: DVec3::ZERO, rotation: DQuat::IDENTITY, scale: DVec3::ONE }
    }
}

impl Placement {
    /// A mere shift.
    pub(crate) fn at(x: f64, y: f64, z: f64) -> Self {
        Placement { translation: DVec3::new(x, y, z), ..Placement::default() }
    }
}

/// Values of an animated node over time; the key times come with them.
pub(crate) enum Keys {
    /// CUBICSPLINE: tangent in, value, tangent out for each key; tangents in metres per second.
    Translation(Vec<[DVec3; 3]>),
    /// LINEAR.
    Rotation(Vec<DQuat>),
}

/// A glTF file in the making. Its methods return the index of what they add.
#[derive(Default)]
pub(crate) struct Document {
    nodes: Vec<schema::Node>,
    cameras: Vec<schema::Camera>,
    lights: Vec<schema::Light>,
    meshes: Vec<schema::Mesh>,
    materials: Vec<schema::Material>,
    animation: schema::Animation,
    accessors: Vec<schema::Accessor>,
    /// Contents of the three buffer views: positions, indices, keys.
    views: [Vec<u8>; 3],
}

impl Document {
    pub(crate) fn material(&mut self, name: &'static str, rgb: [f32; 3], metallic: f32, roughness: f32) -> usize {
        let [r, g, b] = rgb;
        let surface = schema::Surface {
            base_color_factor: [r, g, b, 1.0],
            metallic_factor: metallic,
            roughness_factor: roughness,
        };
        self.materials.push(schema::Material { name, pbr_metallic_roughness: surface, double_sided: true });
        self.materials.len() - 1
    }

    pub(crate) fn mesh(&mut self, name: &'static str, material: usize, mesh: &Mesh) -> usize {
        let rows: Vec<[f32; 3]> = mesh.positions.iter().map(|&p| metres3(p)).collect();
        let position = self.float_accessor(0, "VEC3", &rows, true);
        let byte_offset = self.views[1].len();
        let indices = mesh.triangles.as_flattened();
        // An index too large for u16 becomes 65535, which glTF forbids as a vertex: `into_glb` refuses it.
        let shorts = indices.iter().map(|&i| u16::try_from(i).unwrap_or(u16::MAX));
        self.views[1].extend(shorts.flat_map(u16::to_le_bytes));
        self.accessors.push(schema::Accessor {
            buffer_view: 1,
            byte_offset,
            component_type: UNSIGNED_SHORT,
            count: indices.len(),
            kind: "SCALAR",
            min: None,
            max: None,
        });
        let attributes = schema::Attributes { position };
        let primitive = schema::Primitive { attributes, indices: self.accessors.len() - 1, material };
        self.meshes.push(schema::Mesh { name, primitives: [primitive] });
        self.meshes.len() - 1
    }

    pub(crate) fn camera(&mut self, camera: schema::Camera) -> usize {
        self.cameras.push(camera);
        self.cameras.len() - 1
    }

    pub(crate) fn light(&mut self, light: schema::Light) -> usize {
        self.lights.push(light);
        self.lights.len() - 1
    }

    pub(crate) fn node(
        &mut self,
        name: impl Into<String>,
        content: Content,
        place: Placement,
        children: Vec<usize>,
    ) -> usize {
        let mut node = schema::Node { name: name.into(), children, ..schema::Node::default() };
        match content {
            Content::Group => {}
            Content::Mesh(mesh) => node.mesh = Some(mesh),
            Content::Camera(camera) => node.camera = Some(camera),
            Content::Light(light) => {
                node.extensions = Some(schema::Extensions { lights_punctual: schema::LightIndex { light } });
            }
        }
        node.translation = (place.translation != DVec3::ZERO).then(|| metres3(place.translation));
        node.rotation = (place.rotation != DQuat::IDENTITY).then(|| place.rotation.to_array().map(units));
        node.scale = (place.scale != DVec3::ONE).then(|| place.scale.to_array().map(units));
        self.nodes.push(node);
        self.nodes.len() - 1
    }

    /// Animates a node; one key per time, in seconds.
    pub(crate) fn animate(&mut self, node: usize, times_s: &[f64], keys: Keys) {
        let times: Vec<[f32; 1]> = times_s.iter().map(|&t| [t as f32]).collect();
        let input = self.float_accessor(2, "SCALAR", &times, true);
        let (path, interpolation, output) = match keys {
            Keys::Translation(keys) => {
                let rows: Vec<[f32; 3]> = keys.into_iter().flatten().map(metres3).collect();
                ("translation", "CUBICSPLINE", self.float_accessor(2, "VEC3", &rows, false))
            }
            Keys::Rotation(keys) => {
                let rows: Vec<[f32; 4]> = keys.iter().map(|q| q.to_array().map(units)).collect();
                ("rotation", "LINEAR", self.float_accessor(2, "VEC4", &rows, false))
            }
        };
        self.animation.name = "shot";
        self.animation.samplers.push(schema::Sampler { input, interpolation, output });
        let target = schema::Target { node, path };
        self.animation.channels.push(schema::Channel { sampler: self.animation.samplers.len() - 1, target });
    }

    /// Appends rows of floats to a view; `bounded` states their smallest and largest values.
    fn float_accessor<const N: usize>(
        &mut self,
        view: usize,
        kind: &'static str,
        rows: &[[f32; N]],
        bounded: bool,
    ) -> usize {
        let byte_offset = self.views[view].len();
        self.views[view].extend(rows.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
        let bound = |pick: fn(f32, f32) -> f32, start: f32| {
            bounded.then(|| (0..N).map(|k| rows.iter().fold(start, |b, row| pick(b, row[k]))).collect())
        };
        self.accessors.push(schema::Accessor {
            buffer_view: view,
            byte_offset,
            component_type: FLOAT,
            count: rows.len(),
            kind,
            min: bound(f32::min, f32::INFINITY),
            max: bound(f32::max, f32::NEG_INFINITY),
        });
        self.accessors.len() - 1
    }

    /// The finished file; `roots` are the top nodes of its only scene, which has a name.
    pub(crate) fn into_glb(self, name: &'static str, roots: &[usize]) -> Result<Vec<u8>> {
        if self.accessors.iter().any(|a| a.buffer_view == 0 && a.count > usize::from(u16::MAX)) {
            return Err(Error::new(ErrorKind::InvalidData, "a mesh has more than 65535 vertices: split it"));
        }
        let targets = [Some(ARRAY_BUFFER), Some(ELEMENT_ARRAY_BUFFER), None];
        let mut bin = Vec::new();
        let mut buffer_views = Vec::new();
        for (bytes, target) in self.views.iter().zip(targets) {
            let byte_offset = bin.len();
            buffer_views.push(schema::BufferView { buffer: 0, byte_offset, byte_length: bytes.len(), target });
            bin.extend_from_slice(bytes);
            bin.resize(bin.len().next_multiple_of(4), 0);
        }
        let gltf = schema::Gltf {
            asset: schema::Asset { version: "2.0", generator: format!("lixel examples/{name}") },
            extensions_used: ["KHR_lights_punctual"],
            scene: 0,
            scenes: [schema::Scene { name, nodes: roots.to_vec() }],
            nodes: self.nodes,
            cameras: self.cameras,
            meshes: self.meshes,
            materials: self.materials,
            animations: [self.animation],
            accessors: self.accessors,
            buffer_views,
            buffers: [schema::Buffer { byte_length: bin.len() }],
            extensions: schema::Extensions { lights_punctual: schema::Lights { lights: self.lights } },
        };
        let mut json = serde_json::to_vec(&gltf)?;
        json.resize(json.len().next_multiple_of(4), b' ');
        let mut glb = Vec::new();
        let total = 12 + 8 + json.len() + 8 + bin.len();
        glb.extend_from_slice(b"glTF");
        for word in [2, total] {
            glb.extend(length(word)?);
        }
        for (kind, chunk) in [(b"JSON", json), (b"BIN\0", bin)] {
            glb.extend(length(chunk.len())?);
            glb.extend_from_slice(kind);
            glb.extend(chunk);
        }
        Ok(glb)
    }
}

/// A GLB length field.
fn length(bytes: usize) -> Result<[u8; 4]> {
    u32::try_from(bytes).map(u32::to_le_bytes).map_err(|error| Error::new(ErrorKind::InvalidData, error))
}
