//! One case a thing that can be wrong with a file.

use crate::fixture::{Gltf, Job, write};
use serde_json::{Value, json};
use std::path::Path;

/// Writes the files of a case into a folder and gives the job that reads them.
pub(crate) type Build = fn(&Path) -> Job;

/// The job of a file with these bytes.
fn file(folder: &Path, name: &str, bytes: &[u8]) -> Job {
    Job::supplied(&[write(folder, name, bytes)])
}

/// The one-triangle file, changed.
fn changed(folder: &Path, change: impl Fn(&mut Gltf)) -> Job {
    let mut gltf = Gltf::triangle();
    change(&mut gltf);
    Job::of(&[write(folder, "scene.glb", &gltf.glb())])
}

/// The same with one value replaced, by JSON pointer.
fn set(folder: &Path, pointer: &str, value: Value) -> Job {
    changed(folder, |gltf| {
        let (parent, key) = pointer.rsplit_once('/').unwrap();
        match gltf.json.pointer_mut(parent).unwrap() {
            Value::Array(list) => list[key.parse::<usize>().unwrap()] = value.clone(),
            parent => parent[key] = value.clone(),
        }
    })
}

/// A file whose only buffer is behind a URI.
fn with_uri(folder: &Path, uri: &str) -> Job {
    let mut json = Gltf::triangle().json;
    json["buffers"] = json!([{ "uri": uri, "byteLength": 36 }]);
    file(folder, "scene.gltf", json.to_string().as_bytes())
}

/// A vertex replaced.
fn vertex(folder: &Path, x: f32) -> Job {
    changed(folder, |gltf| gltf.bin[12..16].copy_from_slice(&x.to_le_bytes()))
}

/// Turned by keys.
fn keys(folder: &Path, times: &[f32], last: [f32; 4]) -> Job {
    let values = [[0.0, 0.0, 0.0, 1.0], last].concat();
    changed(folder, |gltf| gltf.animate(0, "rotation", "LINEAR", times, &values))
}

/// With a mask whose image has these bytes.
fn masked(folder: &Path, image: &[u8]) -> Job {
    changed(folder, |gltf| {
        let view = gltf.view(image);
        let uv = gltf.accessor("VEC2", 5126, 3, &[0; 24]);
        gltf.json["images"] = json!([{ "bufferView": view, "name": "leaf" }]);
        gltf.json["textures"] = json!([{ "source": 0 }]);
        gltf.json["materials"] = json!([{ "name": "leaves", "alphaMode": "MASK",
            "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }]);
        let primitive = &mut gltf.json["meshes"][0]["primitives"][0];
        primitive["material"] = json!(0);
        primitive["attributes"]["TEXCOORD_0"] = json!(uv);
    })
}

/// A PNG that declares a size and ends.
fn png_header(side: u32) -> Vec<u8> {
    let mut header = b"IHDR".to_vec();
    header.extend([side.to_be_bytes(), side.to_be_bytes()].concat());
    header.extend([8, 6, 0, 0, 0]);
    let mut png = b"\x89PNG\r\n\x1a\n\0\0\0\x0d".to_vec();
    png.extend(&header);
    png.extend(crc32(&header).to_be_bytes());
    png
}

/// CRC-32 of PNG (ISO 3309), bit by bit.
fn crc32(bytes: &[u8]) -> u32 {
    let step = |crc: u32, _| if crc & 1 == 1 { (crc >> 1) ^ 0xedb8_8320 } else { crc >> 1 };
    !bytes.iter().fold(!0_u32, |crc, byte| (0..8).fold(crc ^ u32::from(*byte), step))
}

const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

/// All of them, by name.
pub(crate) fn all() -> Vec<(&'static str, Build)> {
    let mut cases: Vec<(&'static str, Build)> = containers();
    cases.extend(documents());
    cases.extend(numbers());
    cases.extend(others());
    cases
}

fn containers() -> Vec<(&'static str, Build)> {
    vec![
        ("file missing", |f| Job::supplied(&[f.join("scene.glb")])),
        ("file is a folder", |f| {
            std::fs::create_dir(f.join("scene.glb")).unwrap();
            Job::supplied(&[f.join("scene.glb")])
        }),
        #[cfg(unix)]
        ("file is a device", |f| {
            std::os::unix::fs::symlink("/dev/zero", f.join("scene.glb")).unwrap();
            Job::supplied(&[f.join("scene.glb")])
        }),
        ("format unknown", |f| file(f, "scene.fbx", b"Kaydara FBX Binary")),
        ("glb empty", |f| file(f, "scene.glb", b"")),
        ("glb cut in its header", |f| file(f, "scene.glb", &Gltf::triangle().glb()[..10])),
        ("glb cut in its json", |f| file(f, "scene.glb", &Gltf::triangle().glb()[..60])),
        ("glb cut in its binary chunk", |f| {
            let glb = Gltf::triangle().glb();
            file(f, "scene.glb", &glb[..glb.len() - 8])
        }),
        ("glb of version 1", |f| {
            let mut glb = Gltf::triangle().glb();
            glb[4] = 1;
            file(f, "scene.glb", &glb)
        }),
        ("json broken", |f| file(f, "scene.gltf", br#"{ "asset": { "version": "2.0" }, "nodes": [ }"#)),
        ("gltf of version 1", |f| set(f, "/asset/version", json!("1.0"))),
        ("gltf of version 1, properties by name", |f| {
            file(f, "scene.gltf", br#"{ "asset": { "version": "1.0" }, "nodes": { "a": {} } }"#)
        }),
        ("buffer missing", |f| with_uri(f, "triangle.bin")),
        ("buffer too short", |f| {
            write(f, "triangle.bin", &[0; 35]);
            with_uri(f, "triangle.bin")
        }),
        ("uri leaves the folder", |f| with_uri(f, "../../secret.bin")),
        ("uri leaves the folder in disguise", |f| with_uri(f, "%2e%2e/secret.bin")),
        ("uri absolute", |f| with_uri(f, "/etc/passwd")),
        ("uri of the web", |f| with_uri(f, "https://example.org/a.bin")),
        ("uri of data that does not decode", |f| with_uri(f, "data:application/octet-stream;base64,@@@")),
    ]
}

fn documents() -> Vec<(&'static str, Build)> {
    vec![
        ("nodes in a circle", |f| set(f, "/nodes/0/children", json!([0]))),
        ("node with two parents", |f| set(f, "/nodes/0/children", json!([1]))),
        ("node missing", |f| set(f, "/scenes/0/nodes", json!([0, 99]))),
        ("mesh missing", |f| set(f, "/nodes/0/mesh", json!(7))),
        ("matrix not affine", |f| set(f, "/nodes/0/matrix", json!([1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]))),
        ("primitive mode unknown", |f| set(f, "/meshes/0/primitives/0/mode", json!(7))),
        ("accessor counts 2^32", |f| set(f, "/accessors/0/count", json!(4_294_967_296_u64))),
        ("accessor without bytes counts 2^32", |f| {
            set(f, "/accessors/0", json!({ "componentType": 5126, "count": 4_294_967_296_u64, "type": "VEC3" }))
        }),
        ("accessor of another type", |f| set(f, "/accessors/0/type", json!("VEC2"))),
        ("accessor of an unknown component", |f| set(f, "/accessors/0/componentType", json!(5124))),
        ("stride below the element", |f| set(f, "/bufferViews/0/byteStride", json!(0))),
        ("buffer view beyond its buffer", |f| set(f, "/bufferViews/0/byteLength", json!(1_u64 << 40))),
        ("extension required and unknown", |f| set(f, "/extensionsRequired", json!(["ACME_subsurface_cages"]))),
        ("camera lens impossible", |f| set(f, "/cameras/0/perspective/yfov", json!(3.2))),
        ("camera too narrow for an image", |f| set(f, "/cameras/0/perspective/aspectRatio", json!(0.001))),
        ("light kind unknown", |f| set(f, "/extensions/KHR_lights_punctual/lights/0/type", json!("area"))),
        ("mask needs basisu", |f| {
            let mut job = masked(f, b"");
            let mut gltf = Gltf::triangle();
            let uv = gltf.accessor("VEC2", 5126, 3, &[0; 24]);
            gltf.json["textures"] = json!([{ "extensions": { "KHR_texture_basisu": { "source": 0 } } }]);
            gltf.json["materials"] = json!([{ "name": "leaves", "alphaMode": "MASK",
                "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }]);
            let primitive = &mut gltf.json["meshes"][0]["primitives"][0];
            primitive["material"] = json!(0);
            primitive["attributes"]["TEXCOORD_0"] = json!(uv);
            job.scene = vec![write(f, "scene.glb", &gltf.glb())];
            job
        }),
        ("mask does not decode", |f| masked(f, b"GIF89a not today")),
        ("mask much larger than its file", |f| masked(f, &png_header(16_384))),
    ]
}

fn numbers() -> Vec<(&'static str, Build)> {
    vec![
        ("vertex nan", |f| vertex(f, f32::NAN)),
        ("vertex infinite", |f| vertex(f, f32::INFINITY)),
        ("index beyond the vertices", |f| {
            changed(f, |gltf| {
                let indices = gltf.indices(&[0, 1, 3]);
                gltf.json["meshes"][0]["primitives"][0]["indices"] = json!(indices);
            })
        }),
        ("sparse index beyond the elements", |f| {
            changed(f, |gltf| {
                let view = gltf.view(&[200]);
                gltf.json["accessors"][0]["sparse"] = json!({ "count": 1,
                    "indices": { "bufferView": view, "componentType": 5121 }, "values": { "bufferView": 0 } });
            })
        }),
        ("scale overflows", |f| set(f, "/nodes/0/scale", json!([1e300, 1, 1]))),
        ("rotation without length", |f| set(f, "/nodes/0/rotation", json!([0, 0, 0, 0]))),
        ("key without length", |f| keys(f, &[0.0, 1.0], [0.0; 4])),
        ("key times run backwards", |f| keys(f, &[1.0, 0.5], [0.0, 0.0, 0.0, 1.0])),
        ("key times endless", |f| keys(f, &[0.0, 1e30], [0.0, 0.0, 0.0, 1.0])),
        ("joint beyond the skin", |f| {
            changed(f, |gltf| {
                let joints = gltf.accessor("VEC4", 5121, 3, &[9; 12]);
                let weights = gltf.f32s("VEC4", &[0.25; 12]);
                let attributes = &mut gltf.json["meshes"][0]["primitives"][0]["attributes"];
                attributes["JOINTS_0"] = json!(joints);
                attributes["WEIGHTS_0"] = json!(weights);
                gltf.push("skins", json!({ "joints": [1] }));
                gltf.json["nodes"][0]["skin"] = json!(0);
            })
        }),
        ("meshopt stream damaged", |f| {
            changed(f, |gltf| {
                gltf.json["bufferViews"][0]["extensions"] = json!({ "EXT_meshopt_compression": { "buffer": 0,
                    "byteLength": 36, "byteStride": 12, "count": 3, "mode": "ATTRIBUTES" } });
            })
        }),
        ("meshopt view declares too much", |f| {
            changed(f, |gltf| {
                gltf.json["bufferViews"][0]["extensions"] = json!({ "EXT_meshopt_compression": { "buffer": 0,
                    "byteLength": 36, "byteStride": 12, "count": 100_000_000, "mode": "ATTRIBUTES" } });
            })
        }),
        ("draco stream damaged", |f| {
            changed(f, |gltf| {
                let indices = gltf.indices(&[0, 1, 2]);
                let primitive = &mut gltf.json["meshes"][0]["primitives"][0];
                primitive["indices"] = json!(indices);
                primitive["extensions"] = json!({ "KHR_draco_mesh_compression": {
                    "bufferView": 0, "attributes": { "POSITION": 0 } } });
            })
        }),
    ]
}

fn others() -> Vec<(&'static str, Build)> {
    vec![
        ("obj without faces", |f| file(f, "scene.obj", OBJ.as_bytes())),
        ("obj face beyond its vertices", |f| file(f, "scene.obj", format!("{OBJ}f 1 2 9\n").as_bytes())),
        ("obj vertex nan", |f| file(f, "scene.obj", format!("v nan 0 0\n{OBJ}f 1 2 3\n").as_bytes())),
        ("obj vertex not a number", |f| file(f, "scene.obj", format!("v one 0 0\n{OBJ}f 1 2 3\n").as_bytes())),
        ("triangles without area only", |f| file(f, "scene.obj", format!("{OBJ}f 1 1 1\nf 1 2 2\n").as_bytes())),
        ("camera missing", |f| {
            changed(f, |gltf| {
                gltf.json["nodes"][1].as_object_mut().unwrap().remove("camera");
            })
        }),
        ("camera unknown", |f| {
            let mut job = changed(f, |_| {});
            job.camera.name = Some("eyes".into());
            job
        }),
        ("light missing", |f| {
            changed(f, |gltf| {
                gltf.json["nodes"][2].as_object_mut().unwrap().remove("extensions");
            })
        }),
        ("animation unknown", |f| {
            let mut job = keys(f, &[0.0, 1.0], [0.0, 0.0, 0.0, 1.0]);
            job.animation = Some(vec!["walk".into()]);
            job
        }),
        ("camera path broken", |f| {
            let mut job = changed(f, |_| {});
            job.camera.file = Some(write(f, "camera.chan", b"1 0 0 0 0 0 0 45\n2 0 0 zero 0 0 0 45\n"));
            job
        }),
    ]
}
