//! Broken, hostile and unsupported glTF files: an error that names the place, never a panic.

use crate::fixture::{Gltf, Job, write};
use serde_json::{Value, json};

/// Breaks the one-triangle file at a JSON pointer and returns the message.
fn broken(pointer: &str, value: Value) -> String {
    let mut gltf = Gltf::triangle();
    let indices = gltf.indices(&[0, 1, 2]);
    gltf.json["meshes"][0]["primitives"][0]["indices"] = json!(indices);
    gltf.animate(0, "rotation", "LINEAR", &[0.0, 1.0], &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
    let (parent, key) = pointer.rsplit_once('/').unwrap();
    let parent = gltf.json.pointer_mut(parent).unwrap();
    match parent {
        Value::Array(list) => list[key.parse::<usize>().unwrap()] = value,
        parent => parent[key] = value,
    }
    let error = gltf.error();
    assert!(error.contains("scene.glb"), "{error}");
    error
}

#[test]
fn broken_references_and_bounds_are_named() {
    let cases = [
        ("/asset/version", json!("1.0"), "asset: version \"1.0\""),
        ("/scene", json!(7), "scene 7"),
        ("/nodes/0/skin", json!(0), "node 0: refers to skin 0"),
        ("/scenes/0/nodes", json!([9]), "the scene: refers to node 9"),
        ("/nodes/0/children", json!([1]), "met twice"),
        ("/nodes/0/children", json!([0]), "node 0: is met twice"),
        ("/nodes/0/children", json!([99]), "node 0: refers to node 99"),
        ("/nodes/0/children", json!([-1]), "glTF JSON"),
        ("/nodes/0/mesh", json!(5), "node 0: refers to mesh 5"),
        ("/nodes/0/matrix", json!([1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]), "not affine"),
        ("/nodes/1/camera", json!(5), "node 1 \"eye\": refers to camera 5"),
        ("/nodes/2/extensions/KHR_lights_punctual/light", json!(1), "light 1"),
        ("/nodes/2/rotation", json!([0, 0, 0, 0]), "node 2 \"sky\": its rotation"),
        ("/nodes/0/rotation", json!([f64::INFINITY, 0, 0, 0]), "glTF JSON"),
        ("/meshes/0/primitives/0/mode", json!(7), "mode 7"),
        ("/meshes/0/primitives/0/attributes/POSITION", json!(4), "accessor 4"),
        ("/meshes/0/primitives/0/indices", json!(0), "accessor 0"),
        ("/accessors/0/count", json!(4), "accessor 0: 4 elements"),
        ("/accessors/0/count", json!(4_294_967_296_u64), "do not fit"),
        ("/accessors/0/count", json!(u64::MAX), "do not fit"),
        ("/accessors/0/byteOffset", json!(u64::MAX), "do not fit"),
        ("/accessors/0/bufferView", Value::Null, "no triangles"),
        ("/accessors/0/componentType", json!(5124), "componentType 5124"),
        ("/accessors/0/type", json!("VEC2"), "\"VEC2\""),
        ("/accessors/0/bufferView", json!(77), "bufferView 77"),
        ("/accessors/1/componentType", json!(5126), "not unsigned"),
        ("/accessors/1/normalized", json!(true), "normalized"),
        ("/bufferViews/0/byteOffset", json!(u64::MAX), "bufferView 0"),
        ("/bufferViews/0/byteLength", json!(1_u64 << 40), "bufferView 0"),
        ("/bufferViews/0/byteStride", json!(0), "byteStride 0"),
        ("/bufferViews/0/buffer", json!(3), "buffer 3"),
        ("/buffers", json!([{ "byteLength": 1_u64 << 40 }]), "buffer 0: holds"),
        ("/animations/0/channels/0/target/node", json!(50), "node 50"),
        ("/animations/0/channels/0/target/path", json!("colour"), "\"colour\""),
        ("/animations/0/channels/0/sampler", json!(3), "sampler 3"),
        ("/animations/0/samplers/0/interpolation", json!("BEZIER"), "\"BEZIER\""),
        ("/animations/0/samplers/0/input", json!(0), "\"VEC3\""),
        ("/animations/0/samplers/0/interpolation", json!("CUBICSPLINE"), "2 values for 2 keys of 3"),
        ("/nodes/0/matrix", json!([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]), "node 0: is animated"),
        ("/cameras/0/perspective/yfov", json!(3.2), "camera 0: yfov 3.2"),
        ("/cameras/0/perspective/znear", json!(0), "znear 0"),
        ("/cameras/0/perspective/zfar", json!(0.05), "zfar 0.05"),
        ("/cameras/0/perspective/aspectRatio", json!(-1), "aspectRatio -1"),
        ("/cameras/0/type", json!("orthographic"), "camera 0: type \"orthographic\""),
        ("/extensions/KHR_lights_punctual/lights/0/type", json!("area"), "light 0 \"sun\": type \"area\""),
        ("/extensions/KHR_lights_punctual/lights/0/range", json!(0), "range 0"),
        ("/nodes/0/scale", json!([1e300, 1, 1]), "node 0: a vertex overflows"),
        ("/nodes/1/scale", json!([1, 1, 0]), "node 1 \"eye\": the camera has no orientation"),
        ("/nodes/2/scale", json!([1, 1, 0]), "node 2 \"sky\": the light has no direction"),
    ];
    for (pointer, value, want) in cases {
        let error = match (pointer, want) {
            // Found when the frame is posed.
            ("/nodes/1/scale" | "/nodes/2/scale", _) => {
                let mut gltf = Gltf::triangle();
                *gltf.json.pointer_mut(pointer.rsplit_once('/').unwrap().0).unwrap() = {
                    let mut node = gltf.json.pointer(pointer.rsplit_once('/').unwrap().0).unwrap().clone();
                    node["scale"] = value.clone();
                    node
                };
                gltf.load().unwrap().scene.frame(0.0).unwrap_err().to_string()
            }
            _ => broken(pointer, value.clone()),
        };
        assert!(error.contains(want), "{pointer} = {value}: {error}");
    }
}

#[test]
fn bad_numbers_in_buffers_are_named() {
    let mut gltf = Gltf::triangle();
    gltf.bin[0..4].copy_from_slice(&f32::NAN.to_le_bytes());
    assert!(gltf.error().contains("mesh 0, primitive 0, accessor 0: vertex 0 is not finite"), "{}", gltf.error());

    let mut gltf = Gltf::triangle();
    let indices = gltf.indices(&[0, 1, 3]);
    gltf.json["meshes"][0]["primitives"][0]["indices"] = json!(indices);
    let want = "accessor 0, index accessor 1: index 3 lies beyond the 3 vertices";
    assert!(gltf.error().contains(want), "{}", gltf.error());

    let animated = |times: &[f32], values: &[f32]| {
        let mut gltf = Gltf::triangle();
        gltf.animate(0, "rotation", "LINEAR", times, values);
        gltf.error()
    };
    let unit = [0.0, 0.0, 0.0, 1.0];
    let twice = [unit, unit].concat();
    assert!(animated(&[1.0, 0.5], &twice).contains("animation 0, channel 0, accessor 1: key times run backwards"));
    assert!(animated(&[0.0, f32::NAN], &twice).contains("accessor 1: key times"));
    assert!(animated(&[], &[]).contains("accessor 1: key times are missing"));
    assert!(animated(&[0.0, 1.0], &[unit, [0.0; 4]].concat()).contains("accessor 2: quaternion 1 has no length"));
    assert!(animated(&[0.0, 1.0], &unit).contains("holds 1 values for 2 keys"));
    assert!(animated(&[0.0, 1e30], &twice).contains("frames.range"));
}

#[test]
fn a_hierarchy_100_000_deep_is_read() {
    let mut gltf = Gltf::triangle();
    let depth = 100_000;
    let first = gltf.json["nodes"].as_array().unwrap().len();
    let chain = (0..depth).map(|k| json!({ "translation": [1e-3, 0, 0], "children": [first + k + 1] }));
    let nodes: Vec<Value> = chain.chain([json!({ "mesh": 0 })]).collect();
    gltf.json["nodes"].as_array_mut().unwrap().extend(nodes);
    gltf.json["scenes"][0]["nodes"] = json!([1, 2, first]);
    let shot = gltf.load().unwrap();
    let at = shot.scene.still[0][0].as_dvec3() + shot.scene.origin;
    assert!((at.x - 100.0).abs() < 1e-4, "{at}");
    // The same, closed to a circle at its end.
    gltf.json["nodes"][first + depth]["children"] = json!([first]);
    assert!(gltf.error().contains("is met twice"), "{}", gltf.error());
}

#[test]
fn infinite_vertices_are_named() {
    for bad in [f32::INFINITY, f32::NEG_INFINITY, f32::NAN] {
        let mut gltf = Gltf::triangle();
        gltf.bin[16..20].copy_from_slice(&bad.to_le_bytes());
        assert!(gltf.error().contains("mesh 0, primitive 0, accessor 0: vertex 1 is not finite"), "{}", gltf.error());
    }
}

#[test]
fn accessors_without_bytes_cannot_ask_for_memory() {
    let mut gltf = Gltf::triangle();
    gltf.json["accessors"][0] = json!({ "componentType": 5126, "count": 4_294_967_296_u64, "type": "VEC3" });
    assert!(gltf.error().contains("accessor 0: counts 4294967296 elements but has no bufferView"), "{}", gltf.error());
    let mut gltf = Gltf::triangle();
    let view = gltf.view(&[200]);
    gltf.json["accessors"][0]["sparse"] = json!({ "count": 1,
        "indices": { "bufferView": view, "componentType": 5121 }, "values": { "bufferView": 0 } });
    assert!(gltf.error().contains("sparse index 200"), "{}", gltf.error());
}

#[test]
fn features_that_are_needed_but_missing_are_refused_by_name() {
    let mut gltf = Gltf::triangle();
    gltf.json["extensionsRequired"] = json!(["ACME_magic"]);
    let error = gltf.error();
    assert!(error.contains("scene.glb: not supported yet"), "{error}");
    assert!(error.contains("ACME_magic at extensionsRequired"), "{error}");
}

#[test]
fn harmless_features_are_noted_at_most() {
    let mut gltf = Gltf::triangle();
    gltf.json["extensionsRequired"] = json!(["KHR_materials_unlit", "EXT_texture_webp", "KHR_texture_transform"]);
    gltf.json["extensionsUsed"] = json!(["KHR_materials_unlit", "ACME_sparkle", "KHR_lights_punctual"]);
    // A skin on a node that is not in the scene does no harm.
    gltf.push("nodes", json!({ "mesh": 0, "skin": 0 }));
    let notes = gltf.load().unwrap().scene.notes;
    assert_eq!(notes.len(), 1, "{notes:?}");
    assert!(notes[0].ends_with("extensions ignored: ACME_sparkle, KHR_materials_unlit"), "{notes:?}");
}

/// A linear congruential generator (Knuth's MMIX constants): the same damage every time.
struct Damage(u64);

impl Damage {
    fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % bound
    }

    /// One to three bytes replaced, by likely ones or by any.
    fn apply(&mut self, whole: &[u8], likely: &[u8]) -> Vec<u8> {
        let mut bytes = whole.to_vec();
        for _ in 0..=self.below(3) {
            let at = self.below(bytes.len());
            bytes[at] = if self.below(2) == 0 { likely[self.below(likely.len())] } else { self.below(256) as u8 };
        }
        bytes
    }
}

#[test]
fn damaged_glb_files_never_panic() {
    let whole = Gltf::everything().glb();
    let folder = tempfile::tempdir().unwrap();
    let try_load = |bytes: &[u8]| {
        let mut job = Job::of(&[write(folder.path(), "scene.glb", bytes)]);
        job.frames.range = Some("1-3".into());
        let shot = job.load()?;
        shot.frames.iter().try_for_each(|time| shot.scene.frame(time.time_s).map(|_| ()))
    };
    try_load(&whole).unwrap();
    for length in (0..whole.len()).step_by(11) {
        assert!(try_load(&whole[..length]).is_err(), "cut at {length}");
    }
    let mut damage = Damage(1);
    let failed = (0..1500).filter(|_| try_load(&damage.apply(&whole, b"0123456789")).is_err()).count();
    assert!(failed > 500, "{failed}");
}

#[test]
fn damaged_obj_files_never_panic() {
    let whole =
        b"mtllib a.mtl\no a\nv 0 0 0\nv 1 0 0 1\nv 1 1 0 .5 .5 .5\nv 0 1 0\nvt 0 0\nvt 1 1\nvn 0 0 1\nusemtl m\n\
                  s 1\nf 1/1/1 2/2/1 3/1/1 4/2/1\ng b\nf 1//1 2//1 -1//-1\nf -4/-1 2/1 3/2\nf 1 2 3 4\np 1\nl 1 2\n";
    let folder = tempfile::tempdir().unwrap();
    let mut damage = Damage(2);
    let failed = (0..1500)
        .filter(|_| {
            let bytes = damage.apply(whole, b"0123456789-/ \n.e#vf");
            Job::supplied(&[write(folder.path(), "a.obj", &bytes)]).load().is_err()
        })
        .count();
    assert!(failed > 100, "{failed}");
}
