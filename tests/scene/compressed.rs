//! Meshes in the compressed encodings: the same triangles, within the quantisation, and errors that name the place.

use crate::fixture::{Gltf, Job, write};
use glam::Vec3;
use serde_json::{Value, json};

/// Side of the test grid, vertices.
const SIDE: u16 = 6;

/// A bumpy grid over [0, 1]².
fn grid() -> (Vec<[f32; 3]>, Vec<[u16; 3]>) {
    let at = |k: u16| f32::from(k) / f32::from(SIDE - 1);
    let vertices = (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| [at(x), at(y), 0.2 * (at(x) * 9.0).sin() * at(y)]));
    let quad = |x: u16, y: u16| {
        let corner = y * SIDE + x;
        [[corner, corner + 1, corner + SIDE + 1], [corner, corner + SIDE + 1, corner + SIDE]]
    };
    let triangles = (0..SIDE - 1).flat_map(|y| (0..SIDE - 1).flat_map(move |x| quad(x, y)));
    (vertices.collect(), triangles.collect())
}

/// The triangles of the grid as they must come out, in an order that no encoding changes.
fn sorted(mut triangles: Vec<[Vec3; 3]>) -> Vec<[Vec3; 3]> {
    let centre = |t: &[Vec3; 3]| ((t[0] + t[1] + t[2]) / 3.0 * 1000.0).round().to_array().map(|c| c as i32);
    for triangle in &mut triangles {
        let first = (0..3).min_by(|&a, &b| triangle[a].length().total_cmp(&triangle[b].length())).unwrap();
        triangle.rotate_left(first);
    }
    triangles.sort_by_key(|t| [centre(t)[1], centre(t)[0]]);
    triangles
}

/// Asserts that a file holds the grid, within a distance.
fn holds_the_grid(gltf: &Gltf, tolerance: f32) {
    let (vertices, triangles) = grid();
    let want = triangles.iter().map(|t| t.map(|k| Vec3::from_array(vertices[usize::from(k)]))).collect();
    let got = sorted(gltf.load().unwrap().scene.still);
    let want = sorted(want);
    assert_eq!(got.len(), want.len());
    for (got, want) in got.iter().zip(&want) {
        let off = (0..3).map(|k| got[k].distance(want[k])).fold(0.0, f32::max);
        assert!(off <= tolerance, "{got:?} for {want:?}");
    }
}

/// A version 0 attribute stream in which every group of differences is stored as bytes.
fn meshopt_stream(elements: &[u8], stride: usize) -> Vec<u8> {
    let count = elements.len() / stride;
    assert!(count <= 256 && stride <= 32, "one block");
    let mut stream = vec![0xa0];
    let at = |k: usize, byte: usize| elements[k.min(count - 1) * stride + byte];
    for byte in 0..stride {
        let groups = count.div_ceil(16);
        stream.extend(std::iter::repeat_n(0xff, groups.div_ceil(4)));
        for k in 0..groups * 16 {
            let delta = at(k, byte).wrapping_sub(if k == 0 { 0 } else { at(k - 1, byte) });
            stream.push((delta << 1) ^ (if delta & 0x80 == 0 { 0 } else { 0xff }));
        }
    }
    stream.extend(vec![0; 32]);
    stream
}

/// The grid with positions as 16-bit integers, uncompressed or as a meshopt stream.
fn quantised(meshopt: bool) -> Gltf {
    let (vertices, triangles) = grid();
    let mut gltf = Gltf::triangle();
    let integer = |v: f32| ((v * 32767.0).round() as i16).to_le_bytes();
    let bytes: Vec<u8> =
        vertices.iter().flat_map(|v| v.iter().flat_map(|&c| integer(c)).chain([0, 0]).collect::<Vec<_>>()).collect();
    let length = bytes.len();
    let view = if meshopt {
        let stored = gltf.view(&meshopt_stream(&bytes, 8));
        let stored = gltf.json["bufferViews"][stored].clone();
        let stream = json!({ "buffer": 0, "byteOffset": stored["byteOffset"], "byteLength": stored["byteLength"],
            "byteStride": 8, "count": vertices.len(), "mode": "ATTRIBUTES" });
        gltf.json["extensionsRequired"] = json!(["EXT_meshopt_compression", "KHR_mesh_quantization"]);
        gltf.push(
            "bufferViews",
            json!({ "buffer": 1, "byteLength": length, "byteStride": 8,
                "extensions": { "EXT_meshopt_compression": stream } }),
        )
    } else {
        let view = gltf.view(&bytes);
        gltf.json["bufferViews"][view]["byteStride"] = json!(8);
        view
    };
    let position = gltf.push(
        "accessors",
        json!({ "bufferView": view, "componentType": 5122, "normalized": true, "count": vertices.len(), "type": "VEC3" }),
    );
    let indices = gltf.indices(triangles.as_flattened());
    gltf.json["meshes"][0]["primitives"][0] = json!({ "attributes": { "POSITION": position }, "indices": indices });
    gltf.json["buffers"] = json!([{ "byteLength": gltf.bin.len() },
        { "byteLength": length, "extensions": { "EXT_meshopt_compression": { "fallback": true } } }]);
    gltf
}

/// The grid as a Draco stream: `draco-core` 2.3's encoder with 14 bits of position and else its defaults.
const DRACO: &str = "445241434f020201010000002432003205000f5ffb54ab4fd553d5a7aa5a557daa0aff011101ff00000100090300000201010100\
    0f235515c901c911e5085505e5080d0064f8f4a25cfefc3b89d6ae8033f3ccac7e64e6cc6c75343300081b0004bc160000ef0100\
    00a00340003f071020760000002090000000050800003080002000060820406c01005e0700003f070000f6090000ec130002f027\
    0002107400025e07000080062a000000d9290000f60100a00f00007d0002e603400010200000c0000a00301f0000fa0000c01600\
    00c091020000400f000080191c0000d8270004c04f00000000ff3f000000000000000000001d431ebe0000803f0e";

/// The unique id of the stream's positions.
const DRACO_POSITION: u32 = 0;

/// The grid as a Draco stream of 14 bits.
fn draco() -> Gltf {
    let (vertices, triangles) = grid();
    let stream: Vec<u8> =
        DRACO.as_bytes().chunks(2).map(|b| u8::from_str_radix(str::from_utf8(b).unwrap(), 16).unwrap()).collect();
    let mut gltf = Gltf::triangle();
    let view = gltf.view(&stream);
    let position = gltf.push("accessors", json!({ "componentType": 5126, "count": vertices.len(), "type": "VEC3" }));
    let indices =
        gltf.push("accessors", json!({ "componentType": 5123, "count": triangles.len() * 3, "type": "SCALAR" }));
    gltf.json["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    gltf.json["meshes"][0]["primitives"][0] = json!({
        "attributes": { "POSITION": position }, "indices": indices,
        "extensions": { "KHR_draco_mesh_compression": { "bufferView": view, "attributes": { "POSITION": DRACO_POSITION } } }
    });
    gltf
}

#[test]
fn every_encoding_holds_the_same_triangles() {
    let sixteen_bits = 0.5 * f32::sqrt(3.0) / 32767.0 + f32::EPSILON;
    holds_the_grid(&quantised(false), sixteen_bits);
    holds_the_grid(&quantised(true), sixteen_bits);
    // Fourteen bits over the longest side of the box, which is 1.
    holds_the_grid(&draco(), 0.5 * f32::sqrt(3.0) / 16383.0 + f32::EPSILON);
}

#[test]
fn flaws_of_compressed_meshes_are_named() {
    let extension = "/bufferViews/2/extensions/EXT_meshopt_compression";
    let primitive = "/meshes/0/primitives/0";
    type Case<'a> = (Gltf, String, Value, &'a str);
    let cases: [Case<'_>; 9] = [
        (quantised(true), format!("{extension}/mode"), json!("SOMETHING"), "meshopt mode \"SOMETHING\""),
        (quantised(true), format!("{extension}/filter"), json!("SOMETHING"), "meshopt filter \"SOMETHING\""),
        (quantised(true), format!("{extension}/filter"), json!("QUATERNION"), "no error"),
        (quantised(true), format!("{extension}/count"), json!(1_u64 << 20), "ends before 1048576 elements"),
        (quantised(true), format!("{extension}/count"), json!(u64::MAX), "that are decompressed of it"),
        (quantised(true), format!("{extension}/byteLength"), json!(1_u64 << 40), "bufferView 2"),
        (draco(), "/accessors/1/count".into(), json!(u64::MAX), "that are decompressed of it"),
        (draco(), "/accessors/2/count".into(), json!(3), "mesh 0, primitive 0: its Draco stream does not decode"),
        (draco(), format!("{primitive}/mode"), json!(5), "no triangle list"),
    ];
    for (mut gltf, pointer, value, want) in cases {
        let (parent, key) = pointer.rsplit_once('/').unwrap();
        gltf.json.pointer_mut(parent).unwrap()[key] = value;
        if want == "no error" {
            // Any eight bytes are a quaternion of this filter: other numbers, not an error.
            gltf.load().unwrap();
            continue;
        }
        assert!(gltf.error().contains(want), "{pointer}: {}", gltf.error());
    }
    let mut gltf = draco();
    gltf.json.pointer_mut(primitive).unwrap()["extensions"]["KHR_draco_mesh_compression"]["attributes"]["POSITION"] =
        json!(7);
    assert!(gltf.error().contains("no usable attribute 7 for POSITION"), "{}", gltf.error());
}

#[test]
fn damaged_streams_never_panic() {
    let folder = tempfile::tempdir().unwrap();
    for gltf in [quantised(true), draco()] {
        let whole = gltf.glb();
        let bin = whole.len() - gltf.bin.len();
        let mut state = 1_u64;
        let mut below = |bound: usize| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as usize % bound
        };
        for _ in 0..1500 {
            let mut damaged = whole.clone();
            for _ in 0..=below(3) {
                damaged[bin + below(gltf.bin.len())] = [0, 1, 0x7f, 0x80, 0xff, below(256) as u8][below(6)];
            }
            // Whatever comes of it.
            let _ = Job::of(&[write(folder.path(), "scene.glb", &damaged)]).load();
        }
    }
}
