//! Skins, morph targets and instances: where their vertices are, and what is refused.

use crate::fixture::Gltf;
use glam::Vec3;
use lixel::scene::Shot;
use serde_json::{Value, json};

/// The first triangle at a time.
fn triangle(shot: &Shot, time_s: f64) -> [Vec3; 3] {
    let moving = shot.scene.frame(time_s).unwrap().moving;
    *shot.scene.still.first().or(moving.first()).unwrap()
}

#[track_caller]
fn near(got: [Vec3; 3], want: [[f32; 3]; 3]) {
    for (got, want) in got.into_iter().zip(want) {
        assert!(got.abs_diff_eq(want.into(), 1e-6), "{got} instead of {want:?}");
    }
}

/// The triangle of the fixture on two joints: vertex 0 on `root`, vertex 1 on `tip`, vertex 2 half and half. `tip` lies
/// below `root`, one metre up when bound.
fn skinned() -> Gltf {
    let mut gltf = Gltf::triangle();
    let joints = gltf.accessor("VEC4", 5121, 3, &[0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0]);
    let weights = gltf.f32s("VEC4", &[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.5, 0.5, 0.0, 0.0]);
    let attributes = &mut gltf.json["meshes"][0]["primitives"][0]["attributes"];
    (attributes["JOINTS_0"], attributes["WEIGHTS_0"]) = (json!(joints), json!(weights));
    let root = gltf.root(json!({ "name": "root", "children": [4] }));
    let tip = gltf.push("nodes", json!({ "name": "tip", "translation": [0, 1, 0] }));
    let identity = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    let mut down = identity;
    down[13] = -1.0;
    let inverse_bind = gltf.f32s("MAT4", &[identity, down].concat());
    gltf.push("skins", json!({ "name": "rig", "joints": [root, tip], "inverseBindMatrices": inverse_bind }));
    gltf.json["nodes"][0]["skin"] = json!(0);
    gltf
}

#[test]
fn vertices_follow_their_joints_and_not_their_node() {
    let mut gltf = skinned();
    gltf.json["nodes"][0]["translation"] = json!([100, 0, 0]);
    gltf.animate(4, "translation", "LINEAR", &[0.0, 1.0], &[0.0, 1.0, 0.0, 0.0, 1.0, 4.0]);
    let shot = gltf.load().unwrap();
    assert!(shot.scene.still.is_empty());
    near(triangle(&shot, 0.0), [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    near(triangle(&shot, 0.5), [[0.0, 0.0, 0.0], [1.0, 0.0, 2.0], [0.0, 1.0, 1.0]]);
    // Turned a quarter about the tip, at (0, 1, 0): x becomes y.
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let mut gltf = skinned();
    gltf.animate(4, "rotation", "STEP", &[0.0, 1.0], &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, half, half]);
    near(triangle(&gltf.load().unwrap(), 1.0), [[0.0, 0.0, 0.0], [1.0, 2.0, 0.0], [0.0, 1.0, 0.0]]);
}

#[test]
fn a_skin_at_rest_is_still() {
    let shot = skinned().load().unwrap();
    assert_eq!(shot.scene.still.len(), 1);
    near(triangle(&shot, 0.0), [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
}

#[test]
fn more_than_four_influences_and_weights_that_do_not_sum_to_one() {
    let mut gltf = skinned();
    let tips = gltf.accessor("VEC4", 5123, 3, &[1, 0, 0, 0, 0, 0, 0, 0].repeat(3));
    let bytes = gltf.accessor("VEC4", 5121, 3, &[[255, 0, 0, 0], [0; 4], [0; 4]].concat());
    gltf.json["accessors"][bytes]["normalized"] = json!(true);
    let attributes = &mut gltf.json["meshes"][0]["primitives"][0]["attributes"];
    (attributes["JOINTS_1"], attributes["WEIGHTS_1"]) = (json!(tips), json!(bytes));
    gltf.animate(4, "translation", "STEP", &[0.0, 1.0], &[0.0, 1.0, 0.0, 0.0, 1.0, 4.0]);
    // Vertex 0: weights 1 on `root` and 1 on `tip`, hence half of each.
    near(triangle(&gltf.load().unwrap(), 1.0), [[0.0, 0.0, 2.0], [1.0, 0.0, 4.0], [0.0, 1.0, 2.0]]);
}

#[test]
fn bad_skins_are_named() {
    let error = |change: &dyn Fn(&mut Gltf)| {
        let mut gltf = skinned();
        change(&mut gltf);
        gltf.error()
    };
    type Case<'a> = (&'a dyn Fn(&mut Gltf), &'a str);
    let cases: [Case<'_>; 8] = [
        (&|g| g.json["skins"][0]["joints"] = json!([9, 4]), "skin 0 \"rig\": refers to node 9"),
        (&|g| g.json["skins"][0]["joints"] = json!([]), "skin 0 \"rig\": has no joints"),
        (
            &|g| g.json["skins"][0]["joints"] = json!([3]),
            "vertex 1 of mesh 0 follows joint 1, but its skin has 1 joints",
        ),
        (&|g| g.json["skins"][0]["joints"] = json!([3, 4, 3]), "holds 2 inverse bind matrices for 3 joints"),
        (&|g| g.json["scenes"][0]["nodes"] = json!([0, 1, 2]), "its joint, node 3 \"root\", is not in the scene"),
        (&|g| g.bin[36 + 12..36 + 16].fill(255), "the joint weight of vertex"),
        (
            &|g| {
                let attributes = &mut g.json["meshes"][0]["primitives"][0]["attributes"];
                attributes.as_object_mut().unwrap().remove("WEIGHTS_0");
            },
            "has only one of JOINTS_0 and WEIGHTS_0",
        ),
        (
            &|g| {
                let at = g.bin.len() - 4;
                g.bin[at..].copy_from_slice(&2.0_f32.to_le_bytes());
            },
            "inverse bind matrix 1 is not finite and affine",
        ),
    ];
    for (change, want) in cases {
        assert!(error(change).contains(want), "{want}: {}", error(change));
    }
}

/// The triangle of the fixture with two morph targets: the first raises vertex 1 by 2 in z, the second, sparse, moves
/// vertex 2 by -3 in x.
fn morphed() -> Gltf {
    let mut gltf = Gltf::triangle();
    let up = gltf.f32s("VEC3", &[0.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0]);
    let at = gltf.view(&[2]);
    let values: Vec<u8> = [-3.0_f32, 0.0, 0.0].iter().flat_map(|v| v.to_le_bytes()).collect();
    let values = gltf.view(&values);
    let aside = gltf.push(
        "accessors",
        json!({ "componentType": 5126, "count": 3, "type": "VEC3", "sparse": { "count": 1,
            "indices": { "bufferView": at, "componentType": 5121 }, "values": { "bufferView": values } } }),
    );
    gltf.json["meshes"][0]["primitives"][0]["targets"] = json!([{ "POSITION": up }, { "POSITION": aside }]);
    gltf
}

#[test]
fn morph_weights_come_from_mesh_node_or_animation() {
    let mut gltf = morphed();
    let still = |gltf: &Gltf| gltf.load().unwrap().scene.still[0];
    near(still(&gltf), [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    gltf.json["meshes"][0]["weights"] = json!([0.5, 0]);
    near(still(&gltf), [[0.0; 3], [1.0, 0.0, 1.0], [0.0, 1.0, 0.0]]);
    gltf.json["nodes"][0]["weights"] = json!([0, -1]);
    near(still(&gltf), [[0.0; 3], [1.0, 0.0, 0.0], [3.0, 1.0, 0.0]]);

    gltf.animate(0, "weights", "LINEAR", &[0.0, 1.0], &[0.0, 1.0, 1.0, 0.0]);
    let shot = gltf.load().unwrap();
    assert!(shot.scene.still.is_empty());
    near(triangle(&shot, 0.25), [[0.0; 3], [1.0, 0.0, 0.5], [-2.25, 1.0, 0.0]]);
}

#[test]
fn weights_run_by_every_interpolation() {
    let at = |interpolation: &str, values: &[f32]| {
        let mut gltf = morphed();
        gltf.animate(0, "weights", interpolation, &[0.0, 1.0], values);
        triangle(&gltf.load().unwrap(), 0.5)
    };
    near(at("STEP", &[1.0, 0.0, 0.0, 0.0]), [[0.0; 3], [1.0, 0.0, 2.0], [0.0, 1.0, 0.0]]);
    // Hermite with flat tangents at the first key; the out-tangent (8, 0) of it adds an eighth of 8.
    let flat = [0.0, 0.0, 0.0, 0.0, 8.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0];
    near(at("CUBICSPLINE", &flat), [[0.0; 3], [1.0, 0.0, 2.0], [-1.5, 1.0, 0.0]]);
}

#[test]
fn triangles_that_open_only_when_morphed_are_kept() {
    let mut gltf = morphed();
    // All vertices on a line at rest.
    gltf.bin[28..32].copy_from_slice(&0.0_f32.to_le_bytes());
    gltf.bin[24..28].copy_from_slice(&2.0_f32.to_le_bytes());
    gltf.animate(0, "weights", "LINEAR", &[0.0, 1.0], &[0.0, 0.0, 1.0, 0.0]);
    let shot = gltf.load().unwrap();
    assert!(shot.scene.frame(0.0).unwrap().moving.is_empty());
    near(triangle(&shot, 1.0), [[0.0; 3], [1.0, 0.0, 2.0], [2.0, 0.0, 0.0]]);
}

#[test]
fn bad_morph_targets_are_named() {
    let mut gltf = morphed();
    gltf.json["accessors"][1]["count"] = json!(2);
    assert!(gltf.error().contains("morph target accessor 1: holds 2 deltas, none for vertex 2"), "{}", gltf.error());
    let mut gltf = morphed();
    gltf.bin[36..40].copy_from_slice(&f32::INFINITY.to_le_bytes());
    assert!(gltf.error().contains("mesh 0, primitive 0, morph target accessor 1: the delta of vertex 0"));
    let mut gltf = morphed();
    gltf.animate(0, "weights", "LINEAR", &[0.0, 1.0], &[0.0, 1.0, 1.0]);
    assert!(gltf.error().contains("holds 3 values for 2 keys of 2"), "{}", gltf.error());
}

/// The triangle of the fixture in instances at (1, 0, 0), turned a quarter about z, and (0, 5, 0), twice as large.
fn instanced() -> Gltf {
    let mut gltf = Gltf::triangle();
    let translation = gltf.f32s("VEC3", &[1.0, 0.0, 0.0, 0.0, 5.0, 0.0]);
    let turned = [0_i16, 0, 23170, 23170];
    let rotation: Vec<u8> = [turned, [0, 0, 0, 32767]].concat().iter().flat_map(|c| c.to_le_bytes()).collect();
    let rotation = gltf.accessor("VEC4", 5122, 2, &rotation);
    gltf.json["accessors"][rotation]["normalized"] = json!(true);
    let scale = gltf.f32s("VEC3", &[1.0, 1.0, 1.0, 2.0, 2.0, 2.0]);
    let attributes = json!({ "TRANSLATION": translation, "ROTATION": rotation, "SCALE": scale });
    gltf.json["nodes"][0]["extensions"] = json!({ "EXT_mesh_gpu_instancing": { "attributes": attributes } });
    gltf.json["extensionsRequired"] = json!(["EXT_mesh_gpu_instancing"]);
    gltf
}

#[test]
fn instances_are_placed_within_their_node() {
    let mut gltf = instanced();
    gltf.json["nodes"][0]["translation"] = json!([0, 0, 7]);
    let still = gltf.load().unwrap().scene.still;
    assert_eq!(still.len(), 2);
    near(still[0], [[1.0, 0.0, 7.0], [1.0, 1.0, 7.0], [0.0, 0.0, 7.0]]);
    near(still[1], [[0.0, 5.0, 7.0], [2.0, 5.0, 7.0], [0.0, 7.0, 7.0]]);
    gltf.animate(0, "translation", "LINEAR", &[0.0, 1.0], &[0.0, 0.0, 0.0, 0.0, 0.0, 2.0]);
    let moving = gltf.load().unwrap().scene.frame(0.5).unwrap().moving;
    near(moving[1], [[0.0, 5.0, 1.0], [2.0, 5.0, 1.0], [0.0, 7.0, 1.0]]);
}

#[test]
fn bad_instances_are_named() {
    let error = |pointer: &str, value: Value| {
        let mut gltf = instanced();
        *gltf.json.pointer_mut(pointer).unwrap() = value;
        gltf.error()
    };
    let want = "node 0, EXT_mesh_gpu_instancing: has 1 translations, 2 rotations and 2 scales";
    assert!(error("/accessors/1/count", json!(1)).contains(want), "{}", error("/accessors/1/count", json!(1)));
    let mut gltf = instanced();
    gltf.bin[60..68].fill(0);
    assert!(gltf.error().contains("the rotation of instance 0 is a quaternion without length"), "{}", gltf.error());
}
