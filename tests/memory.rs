//! What small hostile files can make the reader take: never 100 MiB for a kilobyte. One test, so that the process's peak
//! is that of the files read here. Where the system does not tell the peak, nothing is asserted, and that is said.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

#[path = "scene/fixture.rs"]
#[allow(dead_code, reason = "this test uses a part of the builder")]
mod fixture;

use fixture::{Gltf, Job, write};
use serde_json::{Value, json};

/// Bytes that a hostile file may have here.
const FILE: usize = 1400;
/// Bytes that reading one may take.
const LIMIT: u64 = 100 << 20;

/// Peak of the process's memory so far, bytes.
fn peak() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok().map(|kib| kib << 10)
}

/// A triangle whose JSON is as small as may be, changed.
fn small(change: impl Fn(&mut Gltf)) -> Vec<u8> {
    let mut gltf = Gltf::triangle();
    gltf.json["nodes"] = json!([{ "mesh": 0 }]);
    gltf.json["scenes"] = json!([{ "nodes": [0] }]);
    for unused in ["cameras", "extensions"] {
        gltf.json.as_object_mut().unwrap().remove(unused);
    }
    change(&mut gltf);
    gltf.glb()
}

/// An accessor of zeros.
fn zeros(count: u64, kind: &str) -> Value {
    json!({ "componentType": 5126, "count": count, "type": kind })
}

/// What the file's buffers allow of them.
const MOST_ZEROS: u64 = 4096 + 16 * 36;

fn hostile() -> Vec<(&'static str, Vec<u8>)> {
    let with_mask = |image: &[u8]| {
        small(|gltf| {
            let view = gltf.view(image);
            gltf.json["images"] = json!([{ "bufferView": view }]);
            gltf.json["textures"] = json!([{ "source": 0 }]);
            gltf.json["materials"] = json!([{ "alphaMode": "MASK",
                "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }]);
            gltf.json["accessors"].as_array_mut().unwrap().push(zeros(3, "VEC2"));
            let primitive = &mut gltf.json["meshes"][0]["primitives"][0];
            primitive["material"] = json!(0);
            primitive["attributes"]["TEXCOORD_0"] = json!(1);
        })
    };
    // A lossless WebP of 16383 x 16383 texels that are all the same: codes without bits.
    let webp = {
        let bits: [u8; 9] = [0x2f, 0xfe, 0xbf, 0xff, 0x0f, 0x88, 0x88, 0x88, 0x08];
        let mut webp = b"RIFF\x16\0\0\0WEBPVP8L\x09\0\0\0".to_vec();
        webp.extend(bits);
        webp.push(0);
        webp
    };
    let png = b"\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR\0\0\x40\0\0\0\x40\0\x10\x06\0\0\0".to_vec();
    vec![
        ("zeros beyond counting", small(|gltf| gltf.json["accessors"][0] = zeros(u64::MAX, "VEC3"))),
        ("2^32 zeros", small(|gltf| gltf.json["accessors"][0] = zeros(1 << 32, "VEC3"))),
        ("2^24 zeros", small(|gltf| gltf.json["accessors"][0] = zeros(1 << 24, "VEC3"))),
        ("many instances of zeros", {
            small(|gltf| {
                gltf.json["accessors"].as_array_mut().unwrap().push(zeros(MOST_ZEROS, "VEC3"));
                let extension = json!({ "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": 1 } } });
                gltf.json["nodes"][0]["extensions"] = extension;
                let primitive = gltf.json["meshes"][0]["primitives"][0].clone();
                gltf.json["meshes"][0]["primitives"] = vec![primitive; 12].into();
            })
        }),
        ("many morph targets of zeros", {
            small(|gltf| {
                gltf.json["accessors"].as_array_mut().unwrap().push(zeros(MOST_ZEROS, "VEC3"));
                let targets = vec![json!({ "POSITION": 1 }); 30];
                gltf.json["meshes"][0]["primitives"][0]["targets"] = targets.into();
            })
        }),
        ("a meshopt view of 2 GiB", {
            small(|gltf| {
                gltf.json["bufferViews"][0]["extensions"] = json!({ "EXT_meshopt_compression": { "buffer": 0,
                    "byteLength": 36, "byteStride": 256, "count": 8_000_000, "mode": "ATTRIBUTES" } });
            })
        }),
        ("a draco stream of 2 GiB", {
            small(|gltf| {
                let indices =
                    gltf.push("accessors", json!({ "componentType": 5125, "count": 60_000_000, "type": "SCALAR" }));
                let primitive = &mut gltf.json["meshes"][0]["primitives"][0];
                primitive["indices"] = json!(indices);
                primitive["extensions"] =
                    json!({ "KHR_draco_mesh_compression": { "bufferView": 0, "attributes": { "POSITION": 0 } } });
            })
        }),
        ("a mask of 16383 x 16383 texels, webp", with_mask(&webp)),
        ("a mask of 16384 x 16384 texels, png", with_mask(&png)),
        ("a camera for a film of 1920 x 10^9", {
            small(|gltf| {
                gltf.json["cameras"] = json!([{ "type": "perspective", "perspective": { "yfov": 0.8, "znear": 0.1, "aspectRatio": 2e-6 } }]);
                gltf.root(json!({ "camera": 0 }));
            })
        }),
        ("an animation of 10^9 frames", small(|gltf| gltf.animate(0, "translation", "STEP", &[0.0, 4e7], &[0.0; 6]))),
    ]
}

#[test]
fn a_kilobyte_takes_no_hundred_megabytes() {
    let folder = tempfile::tempdir().unwrap();
    let load = |name: &str, bytes: &[u8], own_camera: bool| {
        let path = write(folder.path(), name, bytes);
        let mut job = Job::supplied(&[path]);
        job.camera.frame_all = !own_camera;
        job.load().and_then(|shot| shot.scene.frame(0.0).map(drop)).err().map(|error| error.to_string())
    };
    assert_eq!(load("scene.glb", &small(|_| {}), false), None);
    let Some(before) = peak() else {
        println!("skipped: this system does not tell the peak of a process's memory");
        return;
    };
    for (name, bytes) in hostile() {
        assert!(bytes.len() <= FILE, "{name}: {} bytes", bytes.len());
        let outcome = load("scene.glb", &bytes, name.contains("camera"));
        let taken = peak().unwrap() - before;
        println!("{name}: {} bytes, {} KiB so far, {outcome:?}", bytes.len(), taken >> 10);
        assert!(taken < LIMIT, "{name}: {} MiB, {outcome:?}", taken >> 20);
    }
    let faces: String = "f 1 2 3 1 2 3 1 2 3\n".repeat(40);
    let obj = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{faces}f 4294967295 1 2\nf -9223372036854775808 1 2\n");
    assert!(load("scene.obj", obj.as_bytes(), false).is_some());
    assert!(peak().unwrap() - before < LIMIT);
}
