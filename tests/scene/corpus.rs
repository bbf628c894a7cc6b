//! Loads every scene under the folder that LIXEL_SCENES names, and prints what came of it. Nothing is asserted but
//! that each file either loads, with sound frames, or is refused with a message that names it. Without the variable
//! there is nothing to do. LIXEL_POSES=1 prints every camera and light, for comparison with other readers;
//! LIXEL_DUMP=folder writes the triangles of up to five frames of each file there, for `tests/oracle/gltf_pose.py`;
//! LIXEL_ANIMATION chooses an animation by name.

use lixel::scene::{
    CameraParams, FramesParams, ImageParams, LightKindName, LightParams, Shot, ShotParams, VisibilityParams, load,
};
use std::path::{Path, PathBuf};

fn files(folder: &Path, out: &mut Vec<PathBuf>) {
    let mut entries: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            files(&path, out);
        } else if path.extension().is_some_and(|ending| ["gltf", "glb", "obj"].iter().any(|known| ending == *known)) {
            out.push(path);
        }
    }
}

/// The file's own camera and lights where they settle it, else a view of everything and a sun.
fn try_load(path: &Path) -> Result<Shot, String> {
    let scene = [path.into()];
    let own = CameraParams::default();
    let all = CameraParams { frame_all: true, ..CameraParams::default() };
    let sun = [LightParams {
        name: "sun".into(),
        kind: Some(LightKindName::Directional),
        direction: Some([-1.0, -2.0, -0.5]),
        ..LightParams::default()
    }];
    let (frames, image) = (FramesParams::default(), ImageParams::default());
    let animation: Option<[String; 1]> = std::env::var("LIXEL_ANIMATION").ok().map(|name| [name]);
    let animation = animation.as_ref().map(<[String; 1]>::as_slice);
    let mut last = Err(String::new());
    for (camera, lights) in [(&own, &[][..]), (&own, &sun), (&all, &[]), (&all, &sun)] {
        let params = ShotParams {
            scene: &scene,
            active_scene: None,
            animation,
            frames: &frames,
            image: &image,
            camera,
            lights,
            visibility: &VisibilityParams::default(),
            allow_outside: false,
        };
        last = load(&params).map_err(|error| error.to_string());
        if last.is_ok() {
            break;
        }
    }
    last
}

fn describe(shot: &Shot) -> String {
    let mut moving = 0;
    for time in &shot.frames {
        let frame = shot.scene.frame(time.time_s).unwrap();
        let m = frame.camera.world_from_camera;
        assert!((m.transpose() * m).abs_diff_eq(glam::DMat3::IDENTITY, 1e-12) && m.determinant() > 0.0);
        moving = moving.max(frame.moving.len());
        if std::env::var_os("LIXEL_POSES").is_some() {
            println!("POSE {} {:?} {:?}", time.frame, frame.camera.position.to_array(), m.to_cols_array());
            for light in &frame.lights {
                println!("LIGHT {} {light:?}", time.frame);
            }
        }
    }
    let frame = shot.scene.frame(shot.frames[0].time_s).unwrap();
    let cross = |[a, b, c]: [glam::DVec3; 3]| (b - a).cross(c - a).length() * 0.5;
    let all = shot.scene.still.iter().chain(&frame.moving);
    let area: f64 = all.map(|triangle| cross(triangle.map(|v| v.as_dvec3()))).sum();
    let lights: Vec<&str> = frame.lights.iter().map(|light| light.name.as_str()).collect();
    format!(
        "{} still + {moving} moving triangles ({area:.6e} m²), {} frames, {:?}, camera {:?}, lights {lights:?}, origin {}, {:?}",
        shot.scene.still.len(),
        shot.frames.len(),
        shot.film,
        frame.camera.name,
        shot.scene.origin,
        shot.scene.notes
    )
}

/// Up to five frames, evenly spread, as `<folder>/<file name>/<seconds>.f32`.
fn dump(shot: &Shot, folder: &Path) {
    std::fs::create_dir_all(folder).unwrap();
    let [x, y, z] = shot.scene.origin.to_array();
    std::fs::write(folder.join("origin.txt"), format!("{x} {y} {z}\n")).unwrap();
    for time in shot.frames.iter().step_by(shot.frames.len().div_ceil(5)) {
        let frame = shot.scene.frame(time.time_s).unwrap();
        let triangles = shot.scene.still.iter().chain(&frame.moving).flatten();
        let bytes: Vec<u8> = triangles.flat_map(|v| v.to_array()).flat_map(f32::to_le_bytes).collect();
        std::fs::write(folder.join(format!("{}.f32", time.time_s)), bytes).unwrap();
    }
}

#[test]
fn scenes_load_or_are_refused_by_name() {
    let Some(folder) = std::env::var_os("LIXEL_SCENES") else { return };
    let mut paths = Vec::new();
    files(Path::new(&folder), &mut paths);
    for path in paths {
        match try_load(&path) {
            Ok(shot) => {
                println!("{}: {}", path.display(), describe(&shot));
                if let Some(folder) = std::env::var_os("LIXEL_DUMP") {
                    dump(&shot, &Path::new(&folder).join(path.file_name().unwrap()));
                }
            }
            Err(message) => {
                println!("refused: {message}");
                assert!(message.contains(path.file_name().unwrap().to_str().unwrap()), "{message}");
            }
        }
    }
}
