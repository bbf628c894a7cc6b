//! Settling a shot: cameras, lights, frames, film, several files, OBJ.

use crate::fixture::{Gltf, Job, sun, write};
use glam::{DVec3, Vec3};
use lixel::scene::{CameraKey, LightKind, LightKindName, LightParams, Projection};
use serde_json::json;

#[test]
fn an_unsettled_camera_lists_what_there_is() {
    let folder = tempfile::tempdir().unwrap();
    let mut gltf = Gltf::triangle();
    let eye = |gltf: &mut Gltf, name: &str| {
        let node = gltf.push("nodes", json!({ "name": name, "camera": 0 }));
        gltf.json["scenes"][0]["nodes"].as_array_mut().unwrap().push(json!(node));
    };
    eye(&mut gltf, "left");
    eye(&mut gltf, "left");
    let mut job = Job::of(&[gltf.write(folder.path())]);
    let error = job.error();
    for part in ["3 cameras, and none is chosen", "\"eye\", \"left\", \"left-2\"", "--camera NAME", "frame_all = true"]
    {
        assert!(error.contains(part), "{error}");
    }
    job.camera.name = Some("lft".into());
    assert!(job.error().contains("no camera is named \"lft\" (did you mean \"left\"?)"), "{}", job.error());
    job.camera.name = Some("left-2".into());
    assert_eq!(job.load().unwrap().scene.frame(0.0).unwrap().camera.name, "left-2");

    job.camera.frame_all = true;
    assert!(job.error().contains("camera.frame_all"), "{}", job.error());
    job.camera.frame_all = false;
    job.camera.position = Some([0.0; 3]);
    assert!(job.error().contains("camera.name"), "{}", job.error());

    let mut none = Gltf::triangle();
    none.json["nodes"][1] = json!({});
    assert!(none.error().contains("no camera to plan for; cameras in the scene: none"), "{}", none.error());
}

#[test]
fn file_cameras_take_lens_keys_from_the_job() {
    let folder = tempfile::tempdir().unwrap();
    let mut job = Job::of(&[Gltf::triangle().write(folder.path())]);
    (job.camera.fov, job.camera.near, job.camera.far) = (Some(90.0), Some(0.5), Some(50.0));
    job.image.size = Some([640, 480]);
    let shot = job.load().unwrap();
    let camera = shot.scene.frame(0.0).unwrap().camera;
    assert_eq!(camera.projection, Projection::Perspective { yfov_rad: std::f64::consts::FRAC_PI_2 });
    assert_eq!((camera.near, camera.far), (0.5, Some(50.0)));
    assert_eq!((shot.film.width, shot.film.height), (640, 480));
    job.camera.far = Some(0.25);
    assert!(job.error().contains("camera.far = 0.25"), "{}", job.error());
    (job.camera.far, job.image.size) = (None, Some([0, 480]));
    assert!(job.error().contains("image.size = [0, 480]"), "{}", job.error());
}

#[test]
fn a_view_of_everything_holds_all_vertices() {
    let folder = tempfile::tempdir().unwrap();
    let mut gltf = Gltf::triangle();
    gltf.json["nodes"][0]["translation"] = json!([3e6, 0, 0]);
    let mut job = Job::of(&[gltf.write(folder.path())]);
    job.camera.frame_all = true;
    let shot = job.load().unwrap();
    let camera = shot.scene.frame(0.0).unwrap().camera;
    assert_ne!(shot.scene.origin, DVec3::ZERO);
    for vertex in shot.scene.still.as_flattened() {
        let (x, y, depth) = camera.project(shot.film, vertex.as_dvec3()).unwrap();
        assert!((0.0..=1920.0).contains(&x) && (0.0..=1080.0).contains(&y), "{x} {y}");
        assert!(depth > camera.near && depth < camera.far.unwrap());
    }
}

#[test]
fn camera_keys_set_the_length_of_the_shot() {
    let folder = tempfile::tempdir().unwrap();
    let mut job = Job::of(&[Gltf::triangle().write(folder.path())]);
    job.camera.look_at = Some([0.0; 3]);
    job.camera.key = vec![
        CameraKey { frame: 1.0, position: Some([0.0, 0.0, 4.0]), ..CameraKey::default() },
        CameraKey { frame: 11.0, position: Some([0.0, 0.0, 9.0]), ..CameraKey::default() },
    ];
    let shot = job.load().unwrap();
    assert_eq!(shot.frames.len(), 11);
    let camera = shot.scene.frame(shot.frames[2].time_s).unwrap().camera;
    assert!(camera.position.abs_diff_eq(DVec3::new(0.0, 0.0, 5.0), 1e-12));
    assert_eq!(camera.near, 1e-3 * 2.0_f64.sqrt());
}

#[test]
fn frames_follow_range_and_rate() {
    let folder = tempfile::tempdir().unwrap();
    let mut job = Job::of(&[Gltf::triangle().write(folder.path())]);
    assert_eq!(job.load().unwrap().frames.len(), 1);
    (job.frames.range, job.frames.fps) = (Some("3-1,101".into()), Some(25.0));
    let frames = job.load().unwrap().frames;
    assert_eq!(frames.iter().map(|time| time.frame).collect::<Vec<_>>(), [3, 2, 1, 101]);
    assert_eq!(frames[3].time_s, 4.0);
    job.frames.fps = Some(0.0);
    assert!(job.error().contains("frames.fps = 0"), "{}", job.error());
}

#[test]
fn lights_come_from_the_file_the_job_or_both() {
    let folder = tempfile::tempdir().unwrap();
    let mut job = Job::of(&[Gltf::triangle().write(folder.path())]);
    let spot = LightParams {
        name: "lamp".into(),
        kind: Some(LightKindName::Spot),
        position: Some([0.0, 3.0, 0.0]),
        direction: Some([0.0, -9.0, 0.0]),
        cone: Some(30.0),
        range: Some(7.0),
        importance: None,
        aov: None,
        near: None,
        far: None,
    };
    let named = |name: &str| LightParams { name: name.into(), ..LightParams::default() };
    job.lights = vec![spot.clone(), named("sky")];
    let lights = job.load().unwrap().scene.frame(0.0).unwrap().lights;
    let LightKind::Spot { position, direction, cone_rad, range } = lights[0].kind else { panic!("{:?}", lights[0]) };
    assert_eq!((position, direction, range), (3.0 * DVec3::Y, DVec3::NEG_Y, Some(7.0)));
    assert!((cone_rad - 30.0_f64.to_radians()).abs() < 1e-15);
    assert_eq!((lights[1].name.as_str(), lights[1].kind), ("sky", LightKind::Directional { direction: DVec3::NEG_Z }));

    let cases = [
        (vec![named("sunn")], "no light is named \"sunn\" (did you mean \"sun\"?)"),
        (vec![named("sun"), named("sun")], "two [[light]] are named \"sun\""),
        (vec![LightParams { direction: Some([1.0; 3]), ..named("sun") }], "light \"sun\": direction: "),
        (vec![LightParams { cone: None, ..spot.clone() }], "light \"lamp\": cone: missing"),
        (vec![LightParams { cone: Some(91.0), ..spot.clone() }], "cone = 91"),
        (vec![LightParams { direction: Some([0.0; 3]), ..spot.clone() }], "light \"lamp\": direction"),
        (vec![LightParams { range: Some(-1.0), ..spot.clone() }], "range = -1"),
        (vec![LightParams { position: Some([f64::NAN; 3]), ..spot.clone() }], "light \"lamp\": position"),
        (vec![LightParams { kind: Some(LightKindName::Point), ..spot }], "light \"lamp\": direction: "),
        (vec![LightParams { position: Some([0.0; 3]), ..sun() }], "light \"day\": position: a Directional"),
    ];
    for (lights, want) in cases {
        job.lights = lights;
        assert!(job.error().contains(want), "{want}: {}", job.error());
    }
    let mut dark = Gltf::triangle();
    dark.json["nodes"][2] = json!({});
    assert!(dark.error().contains("no light to plan for; lights in the scene: none; add lights"), "{}", dark.error());
}

#[test]
fn several_files_become_one_scene() {
    let folder = tempfile::tempdir().unwrap();
    let gltf = Gltf::triangle().write(folder.path());
    let obj = write(folder.path(), "ground.obj", b"v 0 -1 0\nv 9 -1 0\nv 0 -1 9\nf 1 2 3\n");
    let shot = Job::of(&[obj.clone(), gltf.clone()]).load().unwrap();
    assert_eq!(shot.scene.still.len(), 2);
    assert_eq!(shot.scene.inputs, [obj.clone(), gltf]);
    assert!(Job::of(&[obj]).error().contains("no light"));
    let other = write(folder.path(), "scene.fbx", b"Kaydara");
    assert!(Job::of(&[other]).error().contains("scene.fbx: neither glTF"));
    assert!(Job::of(&[folder.path().join("none.glb")]).error().contains("none.glb: cannot be read"));
    assert!(Job::supplied(&[]).error().contains("no triangles"));
}

#[test]
fn obj_files_with_their_quirks() {
    let folder = tempfile::tempdir().unwrap();
    let load = |text: &[u8]| Job::supplied(&[write(folder.path(), "a.obj", text)]).load();
    // Latin-1, a missing material file, a concave polygon across two lines, points and lines, an object per shape.
    let text = b"# caf\xe9\nmtllib gone.mtl\no caf\xe9\nusemtl none\nv 0 0 0\nv 4 0 0\nv 4 4 0\nv 2 1 0\nv 0 4 0\n\
                 f 1 2 3 \\\n 4 5\np 1\nl 1 2\no two\nf -5 -4 -3\n";
    let shot = load(text).unwrap();
    let area = |t: &[Vec3; 3]| (t[1] - t[0]).cross(t[2] - t[0]).z / 2.0;
    assert_eq!(shot.scene.still.len(), 3 + 1);
    assert!(shot.scene.still.iter().all(|t| area(t) > 0.0));
    assert_eq!(shot.scene.still[..3].iter().map(area).sum::<f32>(), 10.0);
    // A material without a name; UTF-16, and a byte order mark before UTF-8.
    let triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl \nf 1 2 3\n";
    let utf16 = |unit: fn(u16) -> [u8; 2]| "\u{feff}".chars().chain(triangle.chars()).flat_map(move |c| unit(c as u16));
    let utf8 = format!("\u{feff}{triangle}").into_bytes();
    for text in [utf8, utf16(u16::to_le_bytes).collect(), utf16(u16::to_be_bytes).collect()] {
        assert_eq!(load(&text).unwrap().scene.still.len(), 1);
    }
    // World coordinates keep what f32 would lose.
    let far = load(b"v 500000.125 0 0\nv 500000.375 0 0\nv 500000.125 0.25 0\nf 1 2 3\n").unwrap();
    let [a, b, _] = far.scene.still[0];
    assert_eq!((b - a).x, 0.25);
    for (text, want) in [
        (&b"v 0 0 0\nf 1 2 3\n"[..], "out of bounds"),
        (b"v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "vertex 0 is not finite"),
        (b"v x\n", "position parse error"),
        (b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 0\n", "a.obj"),
        (b"", "no triangles"),
        (b"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", "no triangles"),
    ] {
        let error = load(text).unwrap_err().to_string();
        assert!(error.contains(want) && error.contains("a.obj"), "{error}");
    }
}
