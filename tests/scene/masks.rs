//! Alpha masks of glTF materials: which points are there, and that rays and drawn maps agree on them.

use crate::fixture::{Gltf, Job, write};
use base64_of::data_uri;
use glam::{DMat4, DVec3, DVec4};
use lixel::raster::{Bias, FAR, draw};
use lixel::scene::{BlendRule, Geometry};
use lixel::visibility::{Bvh, Tracer};
use serde_json::{Value, json};

/// Data URIs without a crate for them.
mod base64_of {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

    pub(super) fn data_uri(bytes: &[u8]) -> String {
        let mut text = "data:image/png;base64,".to_owned();
        for three in bytes.chunks(3) {
            let word = (0..3).fold(0_u32, |word, k| word << 8 | u32::from(three.get(k).copied().unwrap_or(0)));
            for k in 0..4 {
                let letter = char::from(LETTERS[(word >> (18 - 6 * k) & 63) as usize]);
                text.push(if k > three.len() { '=' } else { letter });
            }
        }
        text
    }
}

/// A PNG of RGBA texels whose alphas are given, row by row.
fn png(width: u32, alphas: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, alphas.len() as u32 / width);
    encoder.set_color(png::ColorType::Rgba);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&alphas.iter().flat_map(|&a| [90, 160, 40, a]).collect::<Vec<_>>()).unwrap();
    writer.finish().unwrap();
    bytes
}

/// A unit square in the plane z = 0, texture coordinates (0, 0) at the lower left and v up, under a material with a 2 x 2
/// image: opaque at the upper left and the lower right.
fn square(material: Value) -> Gltf {
    let mut gltf = Gltf::triangle();
    let position = gltf.f32s("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0]);
    let uv: Vec<u8> = [0.0_f32, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0].iter().flat_map(|v| v.to_le_bytes()).collect();
    let uv = gltf.accessor("VEC2", 5126, 4, &uv);
    let indices = gltf.indices(&[0, 1, 2, 0, 2, 3]);
    gltf.json["meshes"][0]["primitives"][0] = json!({
        "attributes": { "POSITION": position, "TEXCOORD_0": uv, "TEXCOORD_1": uv }, "indices": indices, "material": 0 });
    gltf.json["materials"] = json!([material]);
    gltf.json["textures"] = json!([{ "source": 0, "sampler": 0 }]);
    gltf.json["samplers"] = json!([{ "magFilter": 9728 }]);
    gltf.json["images"] = json!([{ "uri": data_uri(&png(2, &[255, 0, 0, 255])) }]);
    gltf
}

fn masked() -> Value {
    json!({ "alphaMode": "MASK", "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } })
}

/// Which of an n x n grid of points of the square are there: by rays along -z, and by a map drawn along -z. From the
/// bottom, `#` and `.`; the two must be the same.
fn picture(gltf: &Gltf, n: u32) -> Vec<String> {
    let shot = gltf.load().unwrap();
    let frame = shot.scene.frame(0.0).unwrap();
    look(shot.scene.geometry(&frame), n)
}

fn look(geometry: Geometry<'_>, n: u32) -> Vec<String> {
    let bvh = Bvh::build(geometry.still);
    let tracer = Tracer::new(geometry, &bvh, None);
    let clip = DMat4::from_cols(
        DVec4::new(2.0, 0.0, 0.0, 0.0),
        DVec4::new(0.0, 2.0, 0.0, 0.0),
        DVec4::new(0.0, 0.0, -0.5, 0.0),
        DVec4::new(-1.0, -1.0, 0.0, 1.0),
    );
    let map = draw(geometry, &clip, n, n, Bias::NONE).unwrap();
    let there = |k: u32| {
        let at = |k: u32| (f64::from(k) + 0.5) / f64::from(n);
        let origin = DVec3::new(at(k % n), at(k / n), 1.0);
        let seen = tracer.closest(origin, -DVec3::Z, 0.0, 9.0).is_some();
        assert_eq!(tracer.occluded(origin, -DVec3::Z, 0.0, 9.0), seen, "both questions");
        assert_eq!(map.depth[k as usize] != FAR, seen, "the map at texel {k}");
        if seen { '#' } else { '.' }
    };
    (0..n).map(|y| (0..n).map(|x| there(y * n + x)).collect()).collect()
}

#[test]
fn a_mask_cuts_holes_for_rays_and_maps_alike() {
    // v runs down the image: its first row is at the square's bottom.
    assert_eq!(picture(&square(masked()), 4), ["##..", "##..", "..##", "..##"]);
    // Linear weights leave the checker's crossing at exactly one half.
    let mut linear = square(masked());
    linear.json["samplers"] = json!([{ "magFilter": 9729, "wrapS": 33071, "wrapT": 33071 }]);
    assert_eq!(picture(&linear, 4), ["##..", "##..", "..##", "..##"]);
    linear.json["materials"][0]["alphaCutoff"] = json!(0.9);
    assert_eq!(picture(&linear, 4), ["#...", "....", "....", "...#"]);
}

#[test]
fn transforms_sets_and_wrapping_move_the_mask() {
    let with = |transform: Value, sampler: Value| {
        let mut gltf = square(masked());
        gltf.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"] =
            json!({ "KHR_texture_transform": transform });
        gltf.json["samplers"] = json!([sampler]);
        gltf.json["extensionsRequired"] = json!(["KHR_texture_transform"]);
        picture(&gltf, 4)
    };
    let nearest = |wrap: u32| json!({ "magFilter": 9728, "wrapS": wrap, "wrapT": wrap });
    assert_eq!(with(json!({ "offset": [0.5, 0] }), nearest(10497)), ["..##", "..##", "##..", "##.."]);
    assert_eq!(with(json!({ "offset": [0.5, 0] }), nearest(33071)), ["....", "....", "####", "####"]);
    assert_eq!(with(json!({ "scale": [2, 2] }), nearest(10497)), ["#.#.", ".#.#", "#.#.", ".#.#"]);
    assert_eq!(with(json!({ "scale": [2, 2] }), nearest(33648)), ["#..#", ".##.", ".##.", "#..#"]);
    // A quarter turn: u' = v, v' = -u.
    let turned = json!({ "rotation": std::f64::consts::FRAC_PI_2, "scale": [1, 0.5], "texCoord": 1 });
    assert_eq!(with(turned, nearest(10497)), ["..##", "..##", "..##", "..##"]);
}

#[test]
fn factors_and_vertex_colours_count() {
    let mut gltf = square(masked());
    gltf.json["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = json!([1, 1, 1, 0.4]);
    assert!(gltf.error().contains("no triangles"), "all of it is below the cutoff: {}", gltf.error());
    gltf.json["materials"][0]["alphaCutoff"] = json!(0.3);
    assert_eq!(picture(&gltf, 2), ["#.", ".#"]);
    // Vertex alpha 0 at the left, 1 at the right, as normalised bytes.
    let colour = gltf.accessor("VEC4", 5121, 4, &[9, 9, 9, 0, 9, 9, 9, 255, 9, 9, 9, 255, 9, 9, 9, 0]);
    gltf.json["accessors"][colour]["normalized"] = json!(true);
    gltf.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(colour);
    assert_eq!(picture(&gltf, 4), ["....", "....", "...#", "...#"]);
}

#[test]
fn blended_materials_follow_the_rule() {
    let mut gltf = square(masked());
    gltf.json["materials"][0]["alphaMode"] = json!("BLEND");
    gltf.json["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = json!([1, 1, 1, 0.6]);
    let folder = tempfile::tempdir().unwrap();
    let mut job = Job::of(&[gltf.write(folder.path())]);
    let mut by = |rule: &str| {
        job.visibility.blend = BlendRule::try_from(rule.to_owned()).unwrap();
        let shot = job.load()?;
        let frame = shot.scene.frame(0.0)?;
        Ok::<_, lixel::scene::SceneError>(look(shot.scene.geometry(&frame), 2))
    };
    assert_eq!(by("opaque").unwrap(), ["##", "##"]);
    assert_eq!(by("threshold:0.5").unwrap(), ["#.", ".#"]);
    assert!(by("threshold:0.7").unwrap_err().to_string().contains("no triangles"));
    assert!(by("ignore").unwrap_err().to_string().contains("no triangles"));
    for bad in ["", "Opaque", "threshold:", "threshold:2", "threshold:nan"] {
        assert!(BlendRule::try_from(bad.to_owned()).unwrap_err().contains("threshold:0.5"), "{bad}");
    }
}

#[test]
fn images_come_from_anywhere_and_their_flaws_are_named() {
    let bytes = png(2, &[255, 0, 0, 255]);
    let mut gltf = square(masked());
    let view = gltf.view(&bytes);
    gltf.json["images"] = json!([{ "bufferView": view, "mimeType": "image/png" }]);
    assert_eq!(picture(&gltf, 2), ["#.", ".#"]);

    let folder = tempfile::tempdir().unwrap();
    let image = write(folder.path(), "leaf.png", &bytes);
    gltf.json["images"] = json!([{ "uri": "leaf.png" }]);
    let job = Job::of(&[gltf.write(folder.path())]);
    assert!(job.load().unwrap().scene.inputs.contains(&image));
    write(folder.path(), "leaf.png", &bytes[..40]);
    assert!(job.error().contains("image 0: the mask of material 0 does not decode"), "{}", job.error());
    // JPEG has no alpha: it is not even opened.
    write(folder.path(), "leaf.png", &[0xff, 0xd8, 0xff, 0xe0]);
    assert_eq!(job.load().unwrap().scene.still_marks.cut(), [0_u32; 0]);

    type Change = fn(&mut Value);
    let cases: [(&str, Change); 7] = [
        ("KHR_texture_basisu at material 0", |j| {
            j["textures"] = json!([{ "extensions": { "KHR_texture_basisu": { "source": 0 } } }]);
        }),
        ("material 0: refers to texture 4", |j| {
            j["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["index"] = json!(4);
        }),
        ("needs TEXCOORD_3, which is missing", |j| {
            j["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] = json!(3);
        }),
        ("alphaMode \"GLASS\" is unknown", |j| j["materials"][0]["alphaMode"] = json!("GLASS")),
        ("wrap mode 7", |j| j["samplers"][0]["wrapS"] = json!(7)),
        ("primitive 0: refers to material 9", |j| j["meshes"][0]["primitives"][0]["material"] = json!(9)),
        ("TEXCOORD_0 has 3 values for 4 vertices", |j| {
            let count = j["accessors"].as_array().unwrap().iter().position(|a| a["type"] == "VEC2").unwrap();
            j["accessors"][count]["count"] = json!(3);
        }),
    ];
    for (want, change) in cases {
        let mut gltf = square(masked());
        change(&mut gltf.json);
        assert!(gltf.error().contains(want), "{want}: {}", gltf.error());
    }
}
