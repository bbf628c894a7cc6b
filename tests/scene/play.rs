//! What plays: the choice of animations and scenes, JSON pointers, visibility, cameras and lights that change.

use crate::fixture::{Gltf, Job};
use glam::{DVec3, Vec3};
use lixel::scene::{LightKind, Projection, SceneFrame};
use serde_json::{Value, json};

/// Loads a file with some animations chosen.
fn playing(gltf: &Gltf, names: Option<&[&str]>) -> Result<lixel::scene::Shot, String> {
    let folder = tempfile::tempdir().unwrap();
    let mut job = Job::of(&[gltf.write(folder.path())]);
    job.animation = names.map(|names| names.iter().map(|name| (*name).to_owned()).collect());
    job.load().map_err(|error| error.to_string())
}

/// Three animations: two alternatives of node 0, and one of the camera; lengths 1, 2 and 3 s.
fn alternatives() -> Gltf {
    let mut gltf = Gltf::triangle();
    gltf.animate(0, "translation", "LINEAR", &[0.0, 1.0], &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
    gltf.animate(0, "translation", "LINEAR", &[0.0, 2.0], &[0.0, 0.0, 0.0, 0.0, 2.0, 0.0]);
    gltf.animate(1, "translation", "LINEAR", &[0.0, 3.0], &[0.0, 0.0, 5.0, 0.0, 0.0, 8.0]);
    for (k, name) in ["walk", "jump", "eye"].into_iter().enumerate() {
        gltf.json["animations"][k]["name"] = json!(name);
    }
    gltf
}

#[test]
fn animations_that_go_together_play_unless_others_are_named() {
    let gltf = alternatives();
    let corner = |names: Option<&[&str]>| {
        let shot = playing(&gltf, names).unwrap();
        let frame = shot.scene.frame(1.0).unwrap();
        let triangle = *shot.scene.still.first().or(frame.moving.first()).unwrap();
        (shot.scene.animations.join(" "), shot.frames.len(), triangle[0], frame.camera.position.z)
    };
    assert_eq!(corner(None), ("walk eye".into(), 73, Vec3::X, 6.0));
    assert_eq!(corner(Some(&["jump"])), ("jump".into(), 49, Vec3::Y, 5.0));
    assert_eq!(corner(Some(&["jump", "walk", "jump"])), ("jump walk".into(), 49, Vec3::Y, 5.0));
    assert_eq!(corner(Some(&[])), (String::new(), 1, Vec3::ZERO, 5.0));
    let error = playing(&gltf, Some(&["wakl"])).unwrap_err();
    let want =
        "no animation is named \"wakl\" (did you mean \"walk\"?); animations in the scene: \"walk\", \"jump\", \"eye\"";
    assert!(error.contains(want), "{error}");
    let notes = playing(&gltf, None).unwrap().scene.notes;
    assert!(notes[0].contains("play: \"walk\", \"eye\"; that do not: \"jump\""), "{notes:?}");
    let notes = playing(&gltf, Some(&["jump", "walk"])).unwrap().scene.notes;
    assert!(
        notes[1].contains("animation 0 \"walk\": 1 properties are driven by an animation named before"),
        "{notes:?}"
    );
}

#[test]
fn a_scene_is_chosen_by_name() {
    let mut gltf = Gltf::triangle();
    gltf.push("nodes", json!({ "mesh": 0, "translation": [0, 0, -9] }));
    gltf.json["scenes"] = json!([{ "name": "day", "nodes": [0, 1, 2] }, { "name": "night", "nodes": [3, 1, 2] }]);
    let folder = tempfile::tempdir().unwrap();
    let mut job = Job::of(&[gltf.write(folder.path())]);
    let depth = |job: &Job| job.load().unwrap().scene.still[0][0].z;
    assert_eq!(depth(&job), 0.0);
    job.active_scene = Some("night".into());
    assert_eq!(depth(&job), -9.0);
    let notes = job.load().unwrap().scene.notes;
    assert!(notes[0].contains("scene 1 \"night\" of 2 in the file is used"), "{notes:?}");
    job.active_scene = Some("dusk".into());
    assert!(job.error().contains("no glTF scene is named \"dusk\"; scenes in the files: \"day\", \"night\""));
}

/// The fixture's frame half way through an animation of a pointer between two values.
fn half_way(gltf: &Gltf, pointer: &str, kind: &str, values: &[f32]) -> Result<SceneFrame, String> {
    let mut gltf = Gltf { json: gltf.json.clone(), bin: gltf.bin.clone() };
    gltf.animate_pointer(pointer, kind, values);
    let shot = gltf.load().map_err(|error| error.to_string())?;
    let mut frame = shot.scene.frame(0.5).map_err(|error| error.to_string())?;
    frame.moving.extend(&shot.scene.still);
    Ok(frame)
}

#[test]
fn pointers_move_nodes_cameras_and_lights() {
    let mut gltf = Gltf::triangle();
    gltf.json["cameras"][0]["perspective"]["zfar"] = json!(100);
    gltf.json["extensions"]["KHR_lights_punctual"]["lights"][0] =
        json!({ "type": "spot", "range": 3, "spot": { "outerConeAngle": 0.5 } });
    let at = |pointer: &str, kind: &str, values: &[f32]| half_way(&gltf, pointer, kind, values).unwrap();
    let light = |frame: &SceneFrame| match frame.lights[0].kind {
        LightKind::Spot { cone_rad, range, position, .. } => (cone_rad, range, position),
        other => panic!("{other:?}"),
    };

    let frame = at("/nodes/1/translation", "VEC3", &[0.0, 0.0, 5.0, 2.0, 0.0, 5.0]);
    assert_eq!(frame.camera.position, DVec3::new(1.0, 0.0, 5.0));
    let frame = at("/nodes/0/scale", "VEC3", &[1.0, 1.0, 1.0, 3.0, 1.0, 1.0]);
    assert_eq!(frame.moving[0][1], 2.0 * Vec3::X);
    let frame = at("/nodes/2/translation", "VEC3", &[0.0, 0.0, 0.0, 4.0, 0.0, 0.0]);
    assert_eq!(light(&frame).2, 2.0 * DVec3::X);
    let frame = at("/cameras/0/perspective/yfov", "SCALAR", &[0.5, 1.0]);
    assert_eq!(frame.camera.projection, Projection::Perspective { yfov_rad: 0.75 });
    assert_eq!(at("/cameras/0/perspective/znear", "SCALAR", &[0.5, 1.0]).camera.near, 0.75);
    assert_eq!(at("/cameras/0/perspective/zfar", "SCALAR", &[50.0, 100.0]).camera.far, Some(75.0));
    let frame = at("/extensions/KHR_lights_punctual/lights/0/range", "SCALAR", &[1.0, 2.0]);
    assert_eq!(light(&frame).1, Some(1.5));
    let frame = at("/extensions/KHR_lights_punctual/lights/0/spot/outerConeAngle", "SCALAR", &[0.25, 0.75]);
    assert_eq!(light(&frame).0, 0.5);
}

#[test]
fn orthographic_cameras_grow_by_their_ymag() {
    let mut gltf = Gltf::triangle();
    let lens = json!({ "xmag": 3, "ymag": 1.5, "znear": 0, "zfar": 100 });
    gltf.json["cameras"][0] = json!({ "type": "orthographic", "orthographic": lens });
    let frame = half_way(&gltf, "/cameras/0/orthographic/ymag", "SCALAR", &[1.0, 2.0]).unwrap();
    assert_eq!(frame.camera.projection, Projection::Orthographic { half_height: 1.5 });
    // A perspective property of it does not exist.
    let frame = half_way(&gltf, "/cameras/0/perspective/znear", "SCALAR", &[1.0, 2.0]).unwrap();
    assert_eq!(frame.camera.near, 0.0);
}

#[test]
fn pointers_move_morph_weights() {
    let mut gltf = Gltf::triangle();
    let up = gltf.f32s("VEC3", &[0.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0]);
    gltf.json["meshes"][0]["primitives"][0]["targets"] = json!([{ "POSITION": up }, { "POSITION": up }]);
    gltf.json["meshes"][0]["weights"] = json!([0.0, 1.0]);
    let raised = |pointer: &str, values: &[f32]| half_way(&gltf, pointer, "SCALAR", values).unwrap().moving[0][1].z;
    assert_eq!(raised("/nodes/0/weights", &[0.0, 0.0, 1.0, 0.0]), 1.0);
    assert_eq!(raised("/nodes/0/weights/0", &[0.0, 1.0]), 3.0);
    assert_eq!(raised("/meshes/0/weights", &[0.0, 0.0, 1.0, 0.0]), 1.0);
    assert_eq!(raised("/meshes/0/weights/1", &[0.0, 1.0]), 1.0);
}

#[test]
fn pointers_that_cannot_be_are_named_and_others_noted() {
    let gltf = Gltf::triangle();
    let error = |pointer: &str, values: &[f32]| half_way(&gltf, pointer, "SCALAR", values).unwrap_err();
    let range = "/extensions/KHR_lights_punctual/lights";
    assert!(error("/nodes/9/scale", &[0.0, 1.0]).contains("channel 0, /nodes/9/scale: refers to node 9"));
    assert!(error(&format!("{range}/4/range"), &[0.0, 1.0]).contains("refers to light 4"));
    assert!(error("/nodes/0/scale", &[0.0, 1.0]).contains("\"SCALAR\" where \"VEC3\""));
    assert!(error("/cameras/0/perspective/yfov", &[0.0, 1.0, 2.0]).contains("3 values for 2 keys"));
    let late = error("/cameras/0/perspective/yfov", &[0.5, -1.5]);
    assert!(
        late.contains("node 1 \"eye\": the animated yfov of its camera is -0.5; fix its keys at t = 0.5 s"),
        "{late}"
    );

    let mut gltf = Gltf::triangle();
    gltf.animate_pointer("/materials/3/alphaCutoff", "SCALAR", &[0.0, 1.0]);
    gltf.animate_pointer("/extensions/KHR_lights_punctual/lights/0/intensity", "SCALAR", &[0.0, 1.0]);
    let shot = gltf.load().unwrap();
    let want = "animated properties that are not followed: /extensions/KHR_lights_punctual/lights/*/intensity, \
                /materials/*/alphaCutoff";
    assert!(shot.scene.notes[0].ends_with(want), "{:?}", shot.scene.notes);
    assert_eq!(shot.frames.len(), 1);
}

fn hidden() -> Value {
    json!({ "KHR_node_visibility": { "visible": false } })
}

#[test]
fn hidden_subtrees_are_neither_seen_nor_cast_nor_shine() {
    let mut gltf = Gltf::triangle();
    let child = gltf.push("nodes", json!({ "mesh": 0, "extensions": { "KHR_node_visibility": { "visible": true } } }));
    gltf.root(json!({ "children": [child, child + 2], "extensions": hidden() }));
    let lamp = json!({ "KHR_lights_punctual": { "light": 0 } });
    gltf.push("nodes", json!({ "name": "lamp", "extensions": lamp }));
    gltf.json["nodes"][1]["extensions"] = hidden();
    gltf.json["extensionsRequired"] = json!(["KHR_node_visibility"]);
    let shot = gltf.load().unwrap();
    assert_eq!(shot.scene.still.len(), 1);
    let frame = shot.scene.frame(0.0).unwrap();
    assert_eq!(frame.camera.name, "eye", "a camera sees from a hidden node too");
    assert_eq!(frame.lights.iter().map(|light| light.name.as_str()).collect::<Vec<_>>(), ["sky"]);
}

#[test]
fn visibility_switches_by_its_keys() {
    let mut gltf = Gltf::triangle();
    let parent = gltf.root(json!({ "children": [4], "extensions": hidden() }));
    gltf.push("nodes", json!({ "mesh": 0 }));
    let pointer = format!("/nodes/{parent}/extensions/KHR_node_visibility/visible");
    gltf.animate_pointer(&pointer, "SCALAR", &[1.0, 0.0]);
    let shot = gltf.load().unwrap();
    let moving = |time_s: f64| shot.scene.frame(time_s).unwrap().moving.len();
    assert_eq!((shot.scene.still.len(), moving(0.0), moving(0.99), moving(1.0)), (1, 1, 1, 0));
}

#[test]
fn a_shot_may_begin_with_nothing_to_see() {
    let mut gltf = Gltf::triangle();
    gltf.animate_pointer("/nodes/0/extensions/KHR_node_visibility/visible", "SCALAR", &[0.0, 1.0]);
    let shot = gltf.load().unwrap();
    let moving = |time_s: f64| shot.scene.frame(time_s).unwrap().moving.len();
    assert_eq!((shot.scene.still.len(), moving(0.0), moving(1.0)), (0, 0, 1));
}
