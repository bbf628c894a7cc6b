//! Sound cases that damage starts from: small ones with something of everything, and parts of the example that ships.

use crate::fixture::Gltf;
use crate::plan_sample;
use lixel::plan::{Format, to_text};
use serde_json::{Value, json};

/// The example's job, and one with every table.
pub(crate) fn jobs() -> Vec<Vec<u8>> {
    let example = include_bytes!("../../examples/courtyard/courtyard.toml").to_vec();
    vec![example, toml::to_string(&plan_sample::job()).unwrap().into_bytes()]
}

/// A file with a mesh, its skinned, morphed and instanced kin, animations, a camera and a light, as .glb; and the JSON of
/// the example's nodes, cameras, lights and animations.
pub(crate) fn gltf() -> Vec<Vec<u8>> {
    vec![Gltf::everything().glb(), example()]
}

/// The example without its meshes, its buffer's beginning as data, and a triangle instead.
fn example() -> Vec<u8> {
    let glb = include_bytes!("../../examples/courtyard/courtyard.glb");
    let length = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
    let mut json: Value = serde_json::from_slice(&glb[20..20 + length]).unwrap();
    let triangle = Gltf::triangle();
    let nodes = json["nodes"].as_array_mut().unwrap();
    nodes.truncate(24);
    let count = nodes.len();
    for node in nodes {
        let node = node.as_object_mut().unwrap();
        node.remove("mesh");
        if let Some(children) = node.get_mut("children").and_then(Value::as_array_mut) {
            children.retain(|child| child.as_u64().is_some_and(|child| child < count as u64));
        }
    }
    json["scenes"] = json!([{ "nodes": [0, 1, 2] }]);
    json["nodes"] =
        [triangle.json["nodes"].as_array().unwrap().as_slice(), json["nodes"].as_array().unwrap()].concat().into();
    for list in ["meshes", "accessors", "bufferViews", "cameras", "extensions"] {
        json[list] = triangle.json[list].clone();
    }
    for list in ["animations", "materials"] {
        json.as_object_mut().unwrap().remove(list);
    }
    for node in json["nodes"].as_array_mut().unwrap().iter_mut().skip(3) {
        node.as_object_mut().unwrap().remove("camera");
        node.as_object_mut().unwrap().remove("extensions");
        node.as_object_mut().unwrap().remove("children");
    }
    let digits: String = triangle.bin.iter().map(|byte| format!("%{byte:02x}")).collect();
    json["buffers"] =
        json!([{ "byteLength": triangle.bin.len(), "uri": format!("data:application/octet-stream,{digits}") }]);
    json.to_string().into_bytes()
}

/// Every statement that is read, and some that are not.
pub(crate) fn obj() -> Vec<Vec<u8>> {
    let all = "mtllib a.mtl\no a\nv 0 0 0\nv 1 0 0 1\nv 1 1 0 .5 .5 .5\nv 0 1 0\nvt 0 0\nvt 1 1\nvn 0 0 1\nusemtl m\ns 1\n\
               f 1/1/1 2/2/1 3/1/1 4/2/1\ng b\nf 1//1 2//1 -1//-1\nf -4/-1 2/1 3/2\nf 1 2 3 4\np 1\nl 1 2\n";
    let concave = "v 0 0 0\nv 4 0 0\nv 4 0 4\nv 2 0 1\nv 0 0 4\nf 1 2 3 4 5\n# caf\u{e9}\n";
    vec![all.into(), concave.into()]
}

/// A plan with something in every key, both ways.
pub(crate) fn plans() -> Vec<Vec<u8>> {
    let plan = plan_sample::plan(Vec::new());
    [Format::Json, Format::Toml].map(|format| to_text(&plan, format).unwrap().into_bytes()).to_vec()
}
