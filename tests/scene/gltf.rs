//! glTF features: what a sound file means in scene space.

use crate::fixture::{Gltf, Job, write};
use glam::{DQuat, DVec3, Vec3};
use lixel::scene::{LightKind, Projection};
use serde_json::json;

fn vec3s(triangle: [Vec3; 3]) -> [[f32; 3]; 3] {
    triangle.map(|v| v.to_array())
}

#[test]
fn hierarchies_of_trs_and_matrices_multiply() {
    let mut gltf = Gltf::triangle();
    let half = std::f64::consts::FRAC_1_SQRT_2;
    gltf.json["nodes"][0] = json!({ "translation": [10, 0, 0], "rotation": [0, half, 0, half], "children": [3] });
    gltf.push("nodes", json!({ "matrix": [2,0,0,0, 0,3,0,0, 0,0,4,0, 0,1,0,1], "children": [4] }));
    gltf.push("nodes", json!({ "mesh": 0, "translation": [1, 0, 0] }));
    // (x, y, z) → 2(x + 1), 3y + 1, 4z → a quarter turn about y: (x, y, z) → (z, y, -x).
    let shot = gltf.load().unwrap();
    let want = [[10.0, 1.0, -2.0], [10.0, 1.0, -4.0], [10.0, 4.0, -2.0]].map(Vec3::from_array);
    for (got, want) in shot.scene.still[0].into_iter().zip(want) {
        assert!(got.abs_diff_eq(want, 1e-6), "{got} {want}");
    }
    assert!(shot.scene.frame(0.0).unwrap().moving.is_empty());
}

#[test]
fn mirroring_turns_the_winding() {
    let mut gltf = Gltf::triangle();
    gltf.json["nodes"][0]["scale"] = json!([-1, 2, 3]);
    let shot = gltf.load().unwrap();
    assert_eq!(vec3s(shot.scene.still[0]), [[0.0, 0.0, 0.0], [0.0, 2.0, 0.0], [-1.0, 0.0, 0.0]]);
}

#[test]
fn a_hundred_thousand_levels_are_no_trouble() {
    let mut gltf = Gltf::triangle();
    let depth = 100_000;
    for k in 0..depth {
        gltf.push("nodes", json!({ "children": [k + 4], "translation": [0, 0.5, 0] }));
    }
    gltf.push("nodes", json!({ "mesh": 0 }));
    gltf.json["scenes"][0]["nodes"] = json!([1, 2, 3]);
    let shot = gltf.load().unwrap();
    assert_eq!(shot.scene.still[0][0], Vec3::new(0.0, 50_000.0, 0.0) - shot.scene.origin.as_vec3());
}

#[test]
fn strips_fans_and_points() {
    let mut gltf = Gltf::triangle();
    let position = gltf.f32s("VEC3", &[0., 0., 0., 1., 0., 0., 0., 1., 0., 1., 1., 0., 0., 2., 0.]);
    let indices = gltf.indices(&[0, 1, 2, 3, 4, 4]);
    let fan = gltf.indices(&[0, 1, 3, 2]);
    let attributes = json!({ "POSITION": position });
    gltf.json["meshes"][0]["primitives"] = json!([
        { "attributes": attributes, "indices": indices, "mode": 5 },
        { "attributes": attributes, "indices": fan, "mode": 6 },
        { "attributes": attributes, "mode": 0 },
        { "attributes": attributes, "mode": 3 },
        { "attributes": {}, "mode": 4 },
    ]);
    let shot = gltf.load().unwrap();
    assert_eq!(shot.scene.still.len(), 3 + 2);
    for [a, b, c] in &shot.scene.still {
        assert!((b - a).cross(c - a).z > 0.0);
    }
    assert!(shot.scene.notes.iter().any(|note| note.contains("2 primitives of points or lines ignored")));
    assert!(shot.scene.notes.iter().any(|note| note.contains("1 triangles without area dropped")));
}

#[test]
fn accessors_with_stride_normalisation_and_sparse_values() {
    let mut gltf = Gltf::triangle();
    // Interleaved u16 positions, 8 bytes apart, normalised.
    let mut bytes = Vec::new();
    for v in [[0, 0, 0, 7], [65535, 0, 0, 7], [0, 65535, 0, 7_u16]] {
        bytes.extend(v.iter().flat_map(|c| c.to_le_bytes()));
    }
    let quantised = gltf.accessor("VEC3", 5123, 3, &bytes);
    gltf.json["accessors"][quantised]["normalized"] = json!(true);
    let view = gltf.json["accessors"][quantised]["bufferView"].as_u64().unwrap() as usize;
    gltf.json["bufferViews"][view]["byteStride"] = json!(8);
    // No bytes at all but two sparse vertices.
    let at = gltf.view(&[1, 2]);
    let values: Vec<u8> = [0.0, 0.0, 5.0_f32, 0.0, 6.0, 0.0].iter().flat_map(|v| v.to_le_bytes()).collect();
    let values = gltf.view(&values);
    let sparse = gltf.push(
        "accessors",
        json!({ "componentType": 5126, "count": 3, "type": "VEC3", "sparse": { "count": 2,
            "indices": { "bufferView": at, "componentType": 5121 }, "values": { "bufferView": values } } }),
    );
    gltf.json["meshes"][0]["primitives"] =
        json!([{ "attributes": { "POSITION": quantised } }, { "attributes": { "POSITION": sparse } }]);
    gltf.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    let shot = gltf.load().unwrap();
    assert_eq!(vec3s(shot.scene.still[0]), [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    assert_eq!(vec3s(shot.scene.still[1]), [[0.0; 3], [0.0, 0.0, 5.0], [0.0, 6.0, 0.0]]);
}

#[test]
fn still_and_moving_parts_are_told_apart() {
    let mut gltf = Gltf::triangle();
    gltf.push("nodes", json!({ "mesh": 0, "children": [4] }));
    gltf.push("nodes", json!({ "mesh": 0, "translation": [0, 0, 1] }));
    gltf.push("nodes", json!({ "mesh": 0 }));
    gltf.push("nodes", json!({ "mesh": 0 }));
    gltf.json["scenes"][0]["nodes"] = json!([0, 1, 2, 3, 5, 6]);
    gltf.animate(3, "translation", "LINEAR", &[0.0, 1.0], &[0.0, 0.0, 0.0, 24.0, 0.0, 0.0]);
    gltf.animate(5, "translation", "LINEAR", &[0.0, 1.0], &[7.0, 0.0, 0.0, 7.0, 0.0, 0.0]);
    gltf.animate(6, "scale", "STEP", &[0.0, 0.5], &[1.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
    let shot = gltf.load().unwrap();
    assert_eq!(shot.frames.len(), 25);
    assert_eq!(shot.scene.still.len(), 2, "node 0, and node 5, whose keys are all equal");
    let at = |frame: usize| shot.scene.frame(shot.frames[frame - 1].time_s).unwrap().moving;
    assert_eq!(at(1).len(), 3);
    assert_eq!(at(4)[0][0], Vec3::new(3.0, 0.0, 0.0));
    assert_eq!(at(4)[1][0], Vec3::new(3.0, 0.0, 1.0));
    assert_eq!(at(25).len(), 2, "a node scaled to nothing has no triangles");
}

#[test]
fn rotations_of_all_interpolations() {
    let q = |angle: f64| DQuat::from_rotation_y(angle).as_quat().to_array();
    let negated = q(1.0).map(|c| -c);
    let keys = [q(0.0), negated].concat();
    let zero = [0.0; 4];
    let spline = [zero, q(0.0), zero, zero, q(1.0), zero].concat();
    let forward = |interpolation: &str, values: &[f32], time_s: f64| {
        let mut gltf = Gltf::triangle();
        gltf.animate(1, "rotation", interpolation, &[0.0, 1.0], values);
        gltf.load().unwrap().scene.frame(time_s).unwrap().camera.forward()
    };
    let turned = |angle: f64| DQuat::from_rotation_y(angle) * DVec3::NEG_Z;
    assert!(forward("LINEAR", &keys, 0.25).abs_diff_eq(turned(0.25), 1e-7));
    assert!(forward("STEP", &keys, 0.99).abs_diff_eq(turned(0.0), 1e-7));
    assert!(forward("STEP", &keys, 1.0).abs_diff_eq(turned(1.0), 1e-7));
    assert!(forward("CUBICSPLINE", &spline, 0.5).abs_diff_eq(turned(0.5), 1e-7));
}

#[test]
fn cameras_keep_their_pose_under_scale_and_give_the_film_its_shape() {
    let mut gltf = Gltf::triangle();
    gltf.json["nodes"][1] = json!({ "scale": [-2, 3, 0.5], "translation": [0, 0, 9], "children": [3] });
    gltf.push("nodes", json!({ "name": "eye", "camera": 0, "translation": [1, 1, 0] }));
    gltf.json["cameras"][0]["perspective"]["aspectRatio"] = json!(1.5);
    let shot = gltf.load().unwrap();
    let camera = shot.scene.frame(0.0).unwrap().camera;
    assert_eq!(camera.position, DVec3::new(-2.0, 3.0, 9.0));
    assert!(camera.world_from_camera.abs_diff_eq(glam::DMat3::IDENTITY, 1e-15));
    assert_eq!((camera.projection, camera.near, camera.far), (Projection::Perspective { yfov_rad: 0.8 }, 0.1, None));
    assert_eq!((camera.name.as_str(), shot.film.width, shot.film.height), ("eye", 1920, 1280));

    gltf.json["cameras"][0] = json!({ "type": "orthographic",
        "orthographic": { "xmag": 3, "ymag": 1.5, "znear": 0, "zfar": 100 } });
    let shot = gltf.load().unwrap();
    let camera = shot.scene.frame(0.0).unwrap().camera;
    assert_eq!((camera.projection, camera.far), (Projection::Orthographic { half_height: 1.5 }, Some(100.0)));
    assert_eq!(shot.film.height, 960);
}

#[test]
fn lights_shine_along_minus_z_of_their_nodes() {
    let mut gltf = Gltf::triangle();
    let half = std::f64::consts::FRAC_1_SQRT_2;
    gltf.json["nodes"][2]["rotation"] = json!([-half, 0, 0, half]);
    gltf.json["extensions"]["KHR_lights_punctual"]["lights"] = json!([
        { "type": "spot", "range": 5, "spot": { "outerConeAngle": 0.5 } },
        { "type": "spot", "spot": {} },
        { "type": "point", "name": "bulb" }
    ]);
    for (light, position) in [(1, [1, 2, 3]), (2, [4, 5, 6]), (2, [0, 0, 0])] {
        let extension = json!({ "KHR_lights_punctual": { "light": light } });
        let node = gltf.push("nodes", json!({ "translation": position, "scale": [2, 2, 2], "extensions": extension }));
        gltf.json["scenes"][0]["nodes"].as_array_mut().unwrap().push(json!(node));
    }
    let lights = gltf.load().unwrap().scene.frame(0.0).unwrap().lights;
    let names: Vec<&str> = lights.iter().map(|light| light.name.as_str()).collect();
    assert_eq!(names, ["sky", "light-1", "bulb", "bulb-2"]);
    let LightKind::Spot { direction, cone_rad, range, .. } = lights[0].kind else { panic!("{:?}", lights[0]) };
    assert!(direction.abs_diff_eq(DVec3::NEG_Y, 1e-15));
    assert_eq!((cone_rad, range), (0.5, Some(5.0)));
    let LightKind::Spot { cone_rad, range, .. } = lights[1].kind else { panic!("{:?}", lights[1]) };
    assert_eq!((cone_rad, range), (std::f64::consts::FRAC_PI_4, None));
    assert_eq!(lights[2].kind, LightKind::Point { position: DVec3::new(4.0, 5.0, 6.0), range: None });
}

#[test]
fn animations_that_clash_are_noted() {
    let mut gltf = Gltf::triangle();
    gltf.animate(0, "translation", "STEP", &[0.0], &[1.0, 0.0, 0.0]);
    gltf.animate(0, "translation", "STEP", &[0.0], &[2.0, 0.0, 0.0]);
    let shot = gltf.load().unwrap();
    assert_eq!(shot.scene.still[0][0].x, 1.0);
    assert!(
        shot.scene.notes.iter().any(|note| note.contains("that do not: \"animation-1\"")),
        "{:?}",
        shot.scene.notes
    );
}

#[test]
fn buffers_come_from_files_and_data_uris() {
    let folder = tempfile::tempdir().unwrap();
    let mut gltf = Gltf::triangle();
    let bytes = std::mem::take(&mut gltf.bin);
    write(folder.path(), "a b.bin", &bytes);
    let load = |gltf: &Gltf| {
        let path = write(folder.path(), "scene.gltf", &serde_json::to_vec(&gltf.json).unwrap());
        Job::of(&[path]).load()
    };
    gltf.json["buffers"] = json!([{ "uri": "a%20b.bin", "byteLength": bytes.len() }]);
    let shot = load(&gltf).unwrap();
    assert_eq!(shot.scene.inputs, [folder.path().join("scene.gltf"), folder.path().join("a b.bin")]);

    let uri: String = bytes.iter().map(|byte| format!("%{byte:02X}")).collect();
    gltf.json["buffers"] =
        json!([{ "uri": format!("data:application/octet-stream,{uri}"), "byteLength": bytes.len() }]);
    assert_eq!(load(&gltf).unwrap().scene.still, shot.scene.still);

    for (buffer, want) in [
        (json!({ "uri": "gone.bin", "byteLength": 1 }), "gone.bin: cannot be read"),
        (json!({ "uri": "a%20b.bin", "byteLength": 9999 }), "buffer 0: holds 36 of the 9999 bytes"),
        (json!({ "uri": "../x.bin", "byteLength": 1 }), "leaves the scene's folder"),
        (json!({ "uri": "file:///etc/passwd", "byteLength": 1 }), "not a relative path"),
        (json!({ "uri": "data:;base64,!!!", "byteLength": 1 }), "data URI that does not decode"),
        (json!({ "byteLength": 36 }), "buffer 0: has neither a uri"),
    ] {
        gltf.json["buffers"] = json!([buffer]);
        let error = load(&gltf).unwrap_err().to_string();
        assert!(error.contains(want), "{error}");
    }
}

#[test]
fn far_scenes_move_to_an_origin_and_keep_their_detail() {
    let mut gltf = Gltf::triangle();
    let far = DVec3::new(1_000_000.1, 0.0, -2_000_000.3);
    for node in [0, 1] {
        gltf.json["nodes"][node]["translation"] = json!(far.to_array());
    }
    let shot = gltf.load().unwrap();
    let origin = shot.scene.origin;
    assert_eq!(origin, DVec3::new(1_000_001.0, 0.0, -2_000_000.0));
    for (vertex, local) in shot.scene.still[0].into_iter().zip([DVec3::ZERO, DVec3::X, DVec3::Y]) {
        assert!((vertex.as_dvec3() + origin).abs_diff_eq(far + local, 1e-7));
    }
    assert!(shot.scene.frame(0.0).unwrap().camera.position.abs_diff_eq(far - origin, 1e-9));
}
