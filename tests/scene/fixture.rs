//! Small glTF files for the scene tests, built in code.

use lixel::scene::{
    CameraParams, FramesParams, ImageParams, LightKindName, LightParams, SceneError, Shot, ShotParams,
    VisibilityParams, load,
};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// A glTF document under construction, with one buffer.
pub(crate) struct Gltf {
    pub(crate) json: Value,
    pub(crate) bin: Vec<u8>,
}

impl Gltf {
    /// One root-level list of nodes, no meshes yet.
    pub(crate) fn new() -> Self {
        let json = json!({
            "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [0] }], "nodes": [], "meshes": [],
            "accessors": [], "bufferViews": [], "buffers": []
        });
        Gltf { json, bin: Vec::new() }
    }

    /// The usual start: node 0 holds mesh 0, one triangle (0,0,0) (1,0,0) (0,1,0); node 1 a camera, node 2 a sun.
    pub(crate) fn triangle() -> Self {
        let mut gltf = Gltf::new();
        let position = gltf.f32s("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
        gltf.push("meshes", json!({ "primitives": [{ "attributes": { "POSITION": position } }] }));
        gltf.push("nodes", json!({ "mesh": 0 }));
        gltf.push("nodes", json!({ "name": "eye", "camera": 0, "translation": [0, 0, 5] }));
        gltf.push("nodes", json!({ "name": "sky", "extensions": { "KHR_lights_punctual": { "light": 0 } } }));
        gltf.json["scenes"][0]["nodes"] = json!([0, 1, 2]);
        gltf.json["cameras"] = json!([{ "type": "perspective", "perspective": { "yfov": 0.8, "znear": 0.1 } }]);
        gltf.json["extensions"] =
            json!({ "KHR_lights_punctual": { "lights": [{ "name": "sun", "type": "directional" }] } });
        gltf
    }

    /// Appends to a list of the document and returns the index.
    pub(crate) fn push(&mut self, list: &str, entry: Value) -> usize {
        if self.json[list].is_null() {
            self.json[list] = json!([]);
        }
        let list = self.json[list].as_array_mut().unwrap();
        list.push(entry);
        list.len() - 1
    }

    /// A buffer view over new bytes.
    pub(crate) fn view(&mut self, bytes: &[u8]) -> usize {
        let offset = self.bin.len();
        self.bin.extend(bytes);
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        self.push("bufferViews", json!({ "buffer": 0, "byteOffset": offset, "byteLength": bytes.len() }))
    }

    /// An accessor of a type over new bytes.
    pub(crate) fn accessor(&mut self, kind: &str, component: u32, count: usize, bytes: &[u8]) -> usize {
        let view = self.view(bytes);
        self.push("accessors", json!({ "bufferView": view, "componentType": component, "count": count, "type": kind }))
    }

    /// An f32 accessor.
    pub(crate) fn f32s(&mut self, kind: &str, values: &[f32]) -> usize {
        let width = match kind {
            "SCALAR" => 1,
            "VEC3" => 3,
            "MAT4" => 16,
            _ => 4,
        };
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        self.accessor(kind, 5126, values.len() / width, &bytes)
    }

    /// A u16 index accessor.
    pub(crate) fn indices(&mut self, values: &[u16]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        self.accessor("SCALAR", 5123, values.len(), &bytes)
    }

    /// The usual start with indices and animations, a skinned and morphed copy, an instanced one, a hidden one, and a camera
    /// whose lens moves.
    pub(crate) fn everything() -> Self {
        let mut gltf = Gltf::triangle();
        let indices = gltf.indices(&[0, 1, 2]);
        gltf.json["meshes"][0]["primitives"][0]["indices"] = json!(indices);
        gltf.animate(1, "rotation", "LINEAR", &[0.0, 1.0], &[0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0]);
        gltf.animate(0, "translation", "CUBICSPLINE", &[0.0, 1.0], &[0.5; 18]);
        let joints = gltf.accessor("VEC4", 5121, 3, &[0; 12]);
        let weights = gltf.f32s("VEC4", &[0.25; 12]);
        let target = gltf.f32s("VEC3", &[0.5; 9]);
        let mut primitive = gltf.json["meshes"][0]["primitives"][0].clone();
        primitive["attributes"]["JOINTS_0"] = json!(joints);
        primitive["attributes"]["WEIGHTS_0"] = json!(weights);
        primitive["targets"] = json!([{ "POSITION": target }]);
        let mesh = gltf.push("meshes", json!({ "primitives": [primitive], "weights": [0.5] }));
        let inverse_bind = gltf.f32s("MAT4", glam::Mat4::IDENTITY.to_cols_array().as_slice());
        gltf.push("skins", json!({ "joints": [1], "inverseBindMatrices": inverse_bind }));
        let bent = gltf.root(json!({ "mesh": mesh, "skin": 0 }));
        gltf.animate(bent, "weights", "LINEAR", &[0.0, 1.0], &[0.0, 1.0]);
        let places = gltf.f32s("VEC3", &[1.0; 6]);
        gltf.root(
            json!({ "mesh": 0, "extensions": { "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": places } },
            "KHR_node_visibility": { "visible": true } } }),
        );
        let visible = format!("/nodes/{}/extensions/KHR_node_visibility/visible", bent + 1);
        gltf.animate_pointer(&visible, "SCALAR", &[0.0, 1.0]);
        gltf.animate_pointer("/cameras/0/perspective/yfov", "SCALAR", &[0.5, 1.0]);
        gltf
    }

    /// Animates a node's property.
    pub(crate) fn animate(&mut self, node: usize, path: &str, interpolation: &str, times: &[f32], values: &[f32]) {
        let input = self.f32s("SCALAR", times);
        let kind = match path {
            "rotation" => "VEC4",
            "weights" => "SCALAR",
            _ => "VEC3",
        };
        let output = self.f32s(kind, values);
        self.push(
            "animations",
            json!({
                "channels": [{ "sampler": 0, "target": { "node": node, "path": path } }],
                "samplers": [{ "input": input, "output": output, "interpolation": interpolation }]
            }),
        );
    }

    /// Animates what a JSON pointer names, linearly from 0 to 1 s between two rows of values.
    pub(crate) fn animate_pointer(&mut self, pointer: &str, kind: &str, values: &[f32]) {
        let (input, output) = (self.f32s("SCALAR", &[0.0, 1.0]), self.f32s(kind, values));
        let extension = json!({ "KHR_animation_pointer": { "pointer": pointer } });
        self.push(
            "animations",
            json!({
                "name": pointer,
                "channels": [{ "sampler": 0, "target": { "path": "pointer", "extensions": extension } }],
                "samplers": [{ "input": input, "output": output }]
            }),
        );
    }

    /// Adds a node to the scene's roots.
    pub(crate) fn root(&mut self, node: Value) -> usize {
        let index = self.push("nodes", node);
        self.json["scenes"][0]["nodes"].as_array_mut().unwrap().push(json!(index));
        index
    }

    /// The file as a GLB.
    pub(crate) fn glb(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        if json["buffers"].as_array().is_some_and(Vec::is_empty) {
            json["buffers"] = json!([{ "byteLength": self.bin.len() }]);
        }
        let mut text = serde_json::to_vec(&json).unwrap();
        text.resize(text.len().next_multiple_of(4), b' ');
        let mut out = b"glTF".to_vec();
        out.extend(2_u32.to_le_bytes());
        out.extend((28 + text.len() as u32 + self.bin.len() as u32).to_le_bytes());
        for (kind, chunk) in [(0x4E4F_534A_u32, &text), (0x004E_4942, &self.bin)] {
            out.extend((chunk.len() as u32).to_le_bytes());
            out.extend(kind.to_le_bytes());
            out.extend(chunk);
        }
        out
    }

    /// Writes the GLB into a folder.
    pub(crate) fn write(&self, folder: &Path) -> PathBuf {
        write(folder, "scene.glb", &self.glb())
    }

    /// Loads the file with its own camera and lights.
    pub(crate) fn load(&self) -> Result<Shot, SceneError> {
        let folder = tempfile::tempdir().unwrap();
        Job::of(&[self.write(folder.path())]).load()
    }

    /// The message of the error that loading must end in.
    pub(crate) fn error(&self) -> String {
        self.load().unwrap_err().to_string()
    }
}

/// Writes a file.
pub(crate) fn write(folder: &Path, name: &str, bytes: &[u8]) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, bytes).unwrap();
    path
}

/// Owned [`ShotParams`].
#[derive(Default)]
pub(crate) struct Job {
    pub(crate) scene: Vec<PathBuf>,
    pub(crate) active_scene: Option<String>,
    pub(crate) animation: Option<Vec<String>>,
    pub(crate) frames: FramesParams,
    pub(crate) image: ImageParams,
    pub(crate) camera: CameraParams,
    pub(crate) lights: Vec<LightParams>,
    pub(crate) visibility: VisibilityParams,
}

impl Job {
    pub(crate) fn of(scene: &[PathBuf]) -> Self {
        Job { scene: scene.to_vec(), ..Job::default() }
    }

    /// With a view of everything and a sun.
    pub(crate) fn supplied(scene: &[PathBuf]) -> Self {
        let mut job = Job::of(scene);
        job.camera.frame_all = true;
        job.lights = vec![sun()];
        job
    }

    pub(crate) fn load(&self) -> Result<Shot, SceneError> {
        load(&ShotParams {
            scene: &self.scene.iter().map(|path| path.as_path().into()).collect::<Vec<_>>(),
            active_scene: self.active_scene.as_deref(),
            animation: self.animation.as_deref(),
            frames: &self.frames,
            image: &self.image,
            camera: &self.camera,
            lights: &self.lights,
            visibility: &self.visibility,
            allow_outside: false,
            images: None,
        })
    }

    pub(crate) fn error(&self) -> String {
        self.load().unwrap_err().to_string()
    }
}

/// A sun of the job.
pub(crate) fn sun() -> LightParams {
    LightParams {
        name: "day".into(),
        kind: Some(LightKindName::Directional),
        direction: Some([0.0, -2.0, 0.0]),
        ..LightParams::default()
    }
}
