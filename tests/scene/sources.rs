//! Scene files with units, axes and placements, OBJ masks, and cameras from files.

use crate::fixture::{Gltf, Job, write};
use glam::{DVec3, Vec3};
use lixel::scene::{
    CameraParams, FramesParams, ImageParams, KeyInterpolation, LengthUnit, Projection, SceneFile, ShotParams, UpAxis,
    VisibilityParams, load,
};
use std::path::Path;

#[test]
fn files_are_converted_and_placed_once() {
    let folder = tempfile::tempdir().unwrap();
    let obj = write(folder.path(), "a.obj", b"v 0 0 100\nv 100 0 100\nv 0 100 100\nf 1 2 3\n");
    let mut gltf = Gltf::triangle();
    gltf.json["extensions"]["KHR_lights_punctual"]["lights"][0] =
        serde_json::json!({ "name": "lamp", "type": "point", "range": 300 });
    gltf.animate_pointer("/cameras/0/perspective/znear", "SCALAR", &[0.1, 0.3]);
    gltf.animate_pointer("/cameras/0/perspective/yfov", "SCALAR", &[0.8, 0.4]);
    gltf.animate_pointer("/extensions/KHR_lights_punctual/lights/0/range", "SCALAR", &[300.0, 100.0]);
    let gltf = gltf.write(folder.path());
    let raised = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 7.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
    let scene = [
        SceneFile { up: UpAxis::Z, unit: LengthUnit::Cm, transform: Some(raised), ..SceneFile::from(obj.clone()) },
        SceneFile { unit: LengthUnit::Cm, ..SceneFile::from(gltf) },
        SceneFile::from(obj),
    ];
    let shot = load(&ShotParams {
        scene: &scene,
        active_scene: None,
        animation: None,
        frames: &FramesParams::default(),
        image: &ImageParams::default(),
        camera: &CameraParams::default(),
        lights: &[],
        visibility: &VisibilityParams::default(),
        allow_outside: false,
    })
    .unwrap();
    assert_eq!(shot.scene.still[0], [Vec3::new(0.0, 8.0, 0.0), Vec3::new(1.0, 8.0, 0.0), Vec3::new(0.0, 8.0, -1.0)]);
    assert_eq!(shot.scene.still[1][1], Vec3::new(0.01, 0.0, 0.0));
    assert_eq!(shot.scene.still[2][0], Vec3::new(0.0, 0.0, 100.0));
    let frame = shot.scene.frame(0.0).unwrap();
    assert!(frame.camera.position.abs_diff_eq(DVec3::new(0.0, 0.0, 0.05), 1e-12));
    assert!((frame.camera.near - 0.001).abs() < 1e-9, "{}", frame.camera.near);
    assert!(frame.lights[0].reaches(DVec3::X * 2.9) && !frame.lights[0].reaches(DVec3::X * 3.1));
    let last = shot.scene.frame(1.0).unwrap();
    assert!((last.camera.near - 0.003).abs() < 1e-9, "{}", last.camera.near);
    assert!(matches!(last.camera.projection, Projection::Perspective { yfov_rad } if (yfov_rad - 0.4).abs() < 1e-6));
    assert!(last.lights[0].reaches(DVec3::X * 0.9) && !last.lights[0].reaches(DVec3::X * 1.1));
}

#[test]
fn a_camera_file_brings_its_animations_but_no_light_of_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let range = "/extensions/KHR_lights_punctual/lights/0/range";
    let lamp = serde_json::json!({ "name": "lamp", "type": "point", "range": 3 });
    let mut set = Gltf::triangle();
    set.json["extensions"]["KHR_lights_punctual"]["lights"][0] = lamp.clone();
    set.animate_pointer("/cameras/0/perspective/znear", "SCALAR", &[0.1, 0.3]);
    set.animate_pointer(range, "SCALAR", &[3.0, 1.0]);
    let set = set.write(folder.path());
    let mut film = Gltf::triangle();
    film.json["extensions"]["KHR_lights_punctual"]["lights"][0] = lamp;
    film.animate_pointer("/cameras/0/perspective/yfov", "SCALAR", &[0.8, 0.4]);
    film.animate_pointer(range, "SCALAR", &[3.0, 7.0]);
    let film = write(folder.path(), "film.glb", &film.glb());
    let mut job = Job::of(&[set]);
    job.camera.file = Some(film);
    let shot = job.load().unwrap();
    let last = shot.scene.frame(1.0).unwrap();
    assert!((last.camera.near - 0.1).abs() < 1e-9, "the set's camera has no say: {}", last.camera.near);
    assert!(matches!(last.camera.projection, Projection::Perspective { yfov_rad } if (yfov_rad - 0.4).abs() < 1e-6));
    assert_eq!(last.lights.len(), 1);
    assert!(last.lights[0].reaches(DVec3::X * 0.9) && !last.lights[0].reaches(DVec3::X * 1.1));
    assert_eq!(shot.scene.animations, [range, "/cameras/0/perspective/yfov"]);
}

#[test]
fn obj_masks_come_from_their_library() {
    let folder = tempfile::tempdir().unwrap();
    let mut image = Vec::new();
    let mut encoder = png::Encoder::new(&mut image, 2, 2);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.write_header().unwrap().write_image_data(&[255, 0, 0, 0]).unwrap();
    write(folder.path(), "leaf 1.png", &image);
    write(
        folder.path(),
        "a.mtl",
        b"newmtl leaf\nmap_d -clamp on leaf 1.png\nnewmtl glass\nd 0.3\nnewmtl lost\nmap_d x.png\n",
    );
    let text = b"mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n\
        usemtl leaf\nf 1/1 2/2 3/3 4/4\nusemtl glass\nf 1 2 3\nusemtl lost\nf 1/1 2/2 3/3\n";
    let mut job = Job::supplied(&[write(folder.path(), "a.obj", text)]);
    let shot = job.load().unwrap();
    assert_eq!((shot.scene.still.len(), shot.scene.still_marks.cut()), (4, &[0, 1][..]));
    let cutout = shot.scene.still_marks.cutout(0).unwrap();
    assert_eq!(cutout.uv, [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0]], "v runs down in images");
    let there = |at: [f64; 2]| shot.scene.masks[0].texel(DVec3::new(at[0], at[1], 0.0).truncate()) >= 0.5;
    assert!(there([0.2, 0.2]) && !there([0.8, 0.2]) && !there([0.2, 0.8]));
    assert_eq!(shot.scene.inputs.len(), 3, "{:?}", shot.scene.inputs);
    let lost = |note: &String| note.contains("\"lost\" taken as opaque: map_d \"x.png\"");
    assert!(shot.scene.notes.iter().any(lost), "{:?}", shot.scene.notes);
    job.visibility.blend = lixel::scene::BlendRule::Ignore;
    assert_eq!(job.load().unwrap().scene.still.len(), 3, "glass is left out");
}

/// A shot of one triangle with a camera file.
fn filmed(folder: &Path, name: &str, text: &[u8], how: Option<KeyInterpolation>) -> Job {
    let mut job = Job::supplied(&[Gltf::triangle().write(folder)]);
    let file = Some(write(folder, name, text));
    job.camera = CameraParams { file, interpolation: how, ..CameraParams::default() };
    job
}

#[test]
fn cameras_come_from_files() {
    let folder = tempfile::tempdir().unwrap();
    let chan = b"1 0 0 5 0 0 0 40\n3 2 0 5 0 0 0 50\n";
    let shot = filmed(folder.path(), "a.chan", chan, None).load().unwrap();
    assert_eq!(shot.frames.len(), 3);
    let camera = shot.scene.frame(shot.frames[1].time_s).unwrap().camera;
    assert!(
        camera.position.abs_diff_eq(DVec3::new(1.0, 0.0, 5.0), 1e-12) && camera.forward().abs_diff_eq(-DVec3::Z, 1e-12)
    );
    assert_eq!(camera.projection, Projection::Perspective { yfov_rad: 45.0_f64.to_radians() });
    assert!(shot.scene.inputs.iter().any(|input| input.ends_with("a.chan")));
    let held = filmed(folder.path(), "a.chan", chan, Some(KeyInterpolation::Constant)).load().unwrap();
    assert_eq!(held.scene.frame(held.frames[1].time_s).unwrap().camera.position.x, 0.0);

    let rows = b"[[[1,0,0,0],[0,1,0,0],[0,0,1,5],[0,0,0,1]],[[1,0,0,4],[0,1,0,0],[0,0,1,5],[0,0,0,1]]]";
    let shot = filmed(folder.path(), "a.json", rows, None).load().unwrap();
    assert_eq!(shot.scene.frame(shot.frames[1].time_s).unwrap().camera.position.x, 4.0);

    let mut other = Gltf::triangle();
    other.json["nodes"][1]["translation"] = serde_json::json!([0, 0, 9]);
    let shot = filmed(folder.path(), "camera.glb", &other.glb(), None).load().unwrap();
    assert_eq!(shot.scene.still.len(), 1, "of the camera's file only the camera is taken");
    assert_eq!(shot.scene.frame(0.0).unwrap().camera.position.z, 9.0);
    assert!(filmed(folder.path(), "a.txt", b"", None).error().contains("camera.file"));
    assert!(filmed(folder.path(), "a.csv", b"1,2", None).error().contains("a.csv: line 1: 2 numbers"));
}
