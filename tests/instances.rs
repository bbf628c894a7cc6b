//! Instances against the same scene flattened: the same triangles are seen, the same shadows fall, the same maps are
//! drawn and the same plan is made, to the bit, whatever the matrices of the instances are.

#![expect(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

#[path = "scene/fixture.rs"]
#[expect(dead_code, reason = "shared with the scene tests, which use more of it")]
mod fixture;

use fixture::Gltf;
use glam::{DMat4, DVec3};
use lixel::job;
use lixel::plan::{self, Plan, Watch};
use lixel::raster::{Bias, Canvas};
use lixel::resolution::SingleSided;
use lixel::scene::{Geometry, InstanceRule, Light, LightKind, Shot};
use lixel::shot::content;
use lixel::visibility::{Bvh, NO_TRIANGLE, RayOffset, Tracer, classify, see};
use serde_json::{Value, json};
use std::f32::consts::TAU;
use std::path::Path;
use std::sync::atomic::AtomicBool;

const AROUND: usize = 24;
const ALONG: usize = 16;

/// A dented torus of 768 triangles, off the middle of its own space; every fifth corner is half there.
fn torus(gltf: &mut Gltf) -> usize {
    let mut positions = Vec::new();
    let mut colours = Vec::new();
    for i in 0..AROUND {
        for j in 0..ALONG {
            let (a, b) = (TAU * i as f32 / AROUND as f32, TAU * j as f32 / ALONG as f32);
            let tube = 0.3 + 0.05 * (5.0 * a).sin();
            let radius = 0.8 + tube * b.cos();
            positions.extend([3.0 + radius * a.cos(), tube * b.sin() - 1.0, radius * a.sin()]);
            colours.extend([1.0, 1.0, 1.0, if (i + j) % 5 == 0 { 0.2 } else { 1.0 }]);
        }
    }
    let at = |i: usize, j: usize| (i % AROUND * ALONG + j % ALONG) as u16;
    let quads = (0..AROUND).flat_map(|i| (0..ALONG).map(move |j| (i, j)));
    let indices: Vec<u16> = quads
        .flat_map(|(i, j)| [at(i, j), at(i, j + 1), at(i + 1, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)])
        .collect();
    let position = gltf.f32s("VEC3", &positions);
    let colour = gltf.f32s("VEC4", &colours);
    let indices = gltf.indices(&indices);
    let primitive = |material: usize| {
        json!({
        "attributes": { "POSITION": position, "COLOR_0": colour }, "indices": indices, "material": material })
    };
    gltf.push("meshes", json!({ "primitives": [primitive(0)] }));
    gltf.push("meshes", json!({ "primitives": [primitive(1)] }))
}

/// A floor, tori under all kinds of matrices, a few with holes, and two that move: one of them mirrored.
fn scene(folder: &Path) {
    let mut gltf = Gltf::new();
    gltf.json["scenes"][0]["nodes"] = json!([]);
    gltf.json["materials"] = json!([{}, { "alphaMode": "MASK", "doubleSided": true }]);
    let floor = gltf.f32s("VEC3", &[-9.0, 0.0, -9.0, -9.0, 0.0, 9.0, 9.0, 0.0, 9.0, 9.0, 0.0, -9.0]);
    let corners = gltf.indices(&[0, 1, 2, 0, 2, 3]);
    gltf.push("meshes", json!({ "primitives": [{ "attributes": { "POSITION": floor }, "indices": corners }] }));
    gltf.root(json!({ "mesh": 0 }));
    torus(&mut gltf);
    let placed = [
        json!({ "mesh": 1, "translation": [-3.0, 2.0, 0.0] }),
        json!({ "mesh": 1, "translation": [0.0, 2.2, -3.0], "scale": [-1.0, 1.0, 1.0] }),
        json!({ "mesh": 1, "translation": [-4.0, 1.5, 3.0], "scale": [1.5, 0.4, 0.7], "rotation": [0.0, 0.3827, 0.0, 0.9239] }),
        json!({ "mesh": 2, "translation": [1.0, 3.0, 2.0], "scale": [0.8, -1.1, 0.8], "rotation": [0.2, 0.0, 0.0, 0.9798] }),
        json!({ "mesh": 2, "translation": [-6.0, 2.5, -2.0] }),
        // Sheared, and flat: a matrix without an inverse.
        json!({ "mesh": 1, "matrix": [0.9, 0.4, 0.0, 0.0, -0.3, 0.8, 0.2, 0.0, 0.0, 0.1, -0.7, 0.0, 1.0, 1.2, 4.0, 1.0] }),
        json!({ "mesh": 1, "translation": [-1.0, 1.5, 5.0], "scale": [1.0, 0.0, 1.0] }),
        json!({ "mesh": 1, "translation": [-7.0, 1.0, 4.0], "scale": [1.0, 1e-5, 1.0] }),
    ];
    for node in placed {
        gltf.root(node);
    }
    let shifts = gltf.f32s("VEC3", &[1.0, 1.0, -6.0, -5.0, 2.0, -5.0, 2.5, 0.6, -1.0]);
    let scales = gltf.f32s("VEC3", &[0.5, 0.5, 0.5, 1.0, 2.0, -1.0, 0.3, 1.0, 0.3]);
    let attributes = json!({ "TRANSLATION": shifts, "SCALE": scales });
    gltf.root(json!({ "mesh": 1, "extensions": { "EXT_mesh_gpu_instancing": { "attributes": attributes } } }));
    let mover = gltf.root(json!({ "mesh": 1, "translation": [0.0, 2.0, 0.0] }));
    gltf.animate(mover, "translation", "LINEAR", &[0.0, 0.1], &[-3.0, 3.2, 2.0, -2.0, 3.2, 3.0]);
    let inner = gltf.push("nodes", json!({ "mesh": 2, "scale": [0.7, 0.7, -0.9], "translation": [-3.0, 1.0, 0.0] }));
    let turning = gltf.root(json!({ "children": [inner], "translation": [3.0, 1.0, 1.0] }));
    gltf.animate(turning, "rotation", "LINEAR", &[0.0, 0.1], &[0.0, 0.0, 0.0, 1.0, 0.0, 0.6, 0.0, 0.8]);
    gltf.write(folder);
}

const JOB: &str = "
scene = 'scene.glb'
[frames]
range = '1-2'
[image]
size = [160, 90]
[quality]
epsilon = 0.01
[map]
max = 1024
step = 1.2
[camera]
position = [9.0, 6.0, 9.0]
look_at = [0.0, 0.5, 0.0]
[[light]]
name = 'sun'
kind = 'directional'
direction = [0.5, -0.9, 0.3]
[[light]]
name = 'lamp'
kind = 'point'
position = [0.3, 7.0, -0.2]
";

fn loaded(folder: &Path, rule: &str) -> job::LoadedJob {
    std::fs::write(folder.join("job.toml"), JOB).unwrap();
    let overrides = format!("visibility.instances = '{rule}'");
    job::load(&folder.join("job.toml"), &overrides.parse().unwrap()).unwrap()
}

fn shot(folder: &Path, rule: InstanceRule) -> Shot {
    let mut job = fixture::Job::supplied(&[folder.join("scene.glb")]);
    job.frames.range = Some("1-3".into());
    job.visibility.instances = rule;
    job.load().unwrap()
}

/// Everything that is asked of a frame, as bits.
struct Seen {
    depths: Vec<u64>,
    corners: Vec<Option<[[u32; 3]; 3]>>,
    answers: Vec<u8>,
    maps: Vec<Vec<u32>>,
    drawn: Vec<u64>,
    content: lixel::shot::Content,
    bounds: [DVec3; 2],
}

fn look(shot: &Shot, frame: usize) -> Seen {
    let posed = shot.scene.frame(shot.frames[frame].time_s).unwrap();
    let geometry = shot.scene.geometry(&posed);
    let (still, moving) = (Bvh::still(&shot.scene), Bvh::moving(&shot.scene, &posed));
    let tracer = Tracer::new(geometry, &still, moving.as_ref());
    let film = lixel::scene::Film { width: 320, height: 180 };
    let camera = lixel::scene::Camera {
        position: DVec3::new(9.0, 6.0, 9.0),
        world_from_camera: glam::DMat3::from_quat(glam::DQuat::from_euler(glam::EulerRot::YXZ, 0.785, -0.44, 0.0)),
        near: 0.1,
        far: None,
        ..posed.camera.clone()
    };
    let view = see(&tracer, &camera, film);
    let sun = Light { name: "sun".into(), kind: LightKind::Directional { direction: DVec3::new(0.4, -0.9, 0.2) } };
    let answers = classify(&tracer, &view, &camera, &sun, RayOffset::for_scene(&tracer));
    let mut maps = Vec::new();
    let mut drawn = Vec::new();
    let warped = DMat4::from_cols_array(&[
        0.12, 0.02, 0.03, 0.01, 0.0, 0.05, -0.1, 0.02, -0.03, 0.11, 0.02, 0.03, 0.1, -0.2, 0.1, 1.0,
    ]);
    for sides in [SingleSided::Both, SingleSided::CullFront, SingleSided::CullBack] {
        // The second one looks at a corner only, with most instances beside it.
        for zoom in [
            DMat4::IDENTITY,
            DMat4::from_translation(DVec3::new(2.0, 3.0, 0.0)) * DMat4::from_scale(DVec3::new(5.0, 5.0, 1.0)),
        ] {
            let mut canvas = Canvas::default();
            let keep = |index: u32| sides.draws(geometry, &sun, index);
            let bias = Bias { constant: 1e-5, slope: 1.0, clamp: f64::INFINITY };
            drawn.push(canvas.draw(geometry, &(zoom * warped), 200, 150, bias, keep).unwrap().drawn);
            maps.push(canvas.map.depth.iter().map(|d| d.to_bits()).collect());
        }
    }
    let corners =
        |&index: &u32| (index != NO_TRIANGLE).then(|| geometry.triangle(index).map(|v| v.to_array().map(f32::to_bits)));
    Seen {
        depths: view.depths_m.iter().map(|d| d.to_bits()).collect(),
        corners: view.triangles.iter().map(corners).collect(),
        answers: answers.iter().map(|a| *a as u8).collect(),
        maps,
        drawn,
        content: content(
            geometry,
            &sun,
            &[DVec3::new(-4.0, 0.0, -4.0), DVec3::new(5.0, 0.0, 5.0), DVec3::new(-4.0, 0.0, 5.0)],
        ),
        bounds: tracer.bounds().unwrap(),
    }
}

fn count(geometry: Geometry) -> (usize, usize) {
    (geometry.instances[0].len(), geometry.instances[1].len())
}

#[test]
fn rays_and_maps_of_instances_are_those_of_their_triangles() {
    let folder = tempfile::tempdir().unwrap();
    scene(folder.path());
    let (flat, shared) = (shot(folder.path(), InstanceRule::Flatten), shot(folder.path(), InstanceRule::Share));
    for frame in 0..3 {
        let posed = shared.scene.frame(shared.frames[frame].time_s).unwrap();
        assert_eq!(count(shared.scene.geometry(&posed)), (12, 2), "with the floor");
        let (a, b) = (look(&flat, frame), look(&shared, frame));
        assert!(b.corners.iter().flatten().count() > 20_000 && b.answers.iter().filter(|a| **a == 2).count() > 2000);
        let differ = a.corners.iter().zip(&b.corners).filter(|(a, b)| a != b).count();
        assert_eq!(differ, 0, "pixels that see another triangle");
        assert_eq!(a.depths, b.depths);
        assert_eq!(a.answers, b.answers);
        assert_eq!(a.drawn, b.drawn);
        for (a, b) in a.maps.iter().zip(&b.maps) {
            assert!(a.iter().any(|d| *d != 1_f32.to_bits()) && a == b);
        }
        assert!(!b.content.is_still());
        assert_eq!(a.content, b.content);
        assert_eq!(a.bounds, b.bounds);
    }
}

#[test]
fn a_plan_with_instances_is_that_of_the_flattened_scene() {
    let folder = tempfile::tempdir().unwrap();
    scene(folder.path());
    let plan = |rule: &str| -> Plan {
        let watch = Watch { progress: &|_| (), cancel: &AtomicBool::new(false), notes: &|_| () };
        plan::make(&loaded(folder.path(), rule), folder.path(), false, &watch).unwrap()
    };
    let text = |plan: &Plan| -> Value {
        let mut plan = serde_json::to_value(plan).unwrap();
        plan["job"]["visibility"].as_object_mut().unwrap().remove("instances");
        plan
    };
    let (flat, shared) = (plan("flatten"), plan("share"));
    assert!(flat.summary.met);
    let (flat, shared) = (text(&flat), text(&shared));
    assert_eq!(flat["frames"], shared["frames"]);
    assert_eq!(flat, shared);
}

/// Tori in rows, over two million triangles: such a scene is not drawn to choose a bias.
#[test]
fn the_bias_of_millions_of_triangles_is_chosen_by_lookups() {
    let folder = tempfile::tempdir().unwrap();
    let mut gltf = Gltf::new();
    gltf.json["scenes"][0]["nodes"] = json!([]);
    gltf.json["materials"] = json!([{}, {}]);
    let floor = gltf.f32s("VEC3", &[-90.0, -2.0, -90.0, -90.0, -2.0, 90.0, 90.0, -2.0, 90.0, 90.0, -2.0, -90.0]);
    let corners = gltf.indices(&[0, 1, 2, 0, 2, 3]);
    gltf.push("meshes", json!({ "primitives": [{ "attributes": { "POSITION": floor }, "indices": corners }] }));
    gltf.root(json!({ "mesh": 0 }));
    torus(&mut gltf);
    let rows = |k: i32| [(k % 52 - 26) as f32 * 3.0, 0.0, (k / 52 - 26) as f32 * 3.0];
    let shifts = gltf.f32s("VEC3", &(0..52 * 52).flat_map(rows).collect::<Vec<f32>>());
    let attributes = json!({ "TRANSLATION": shifts });
    gltf.root(json!({ "mesh": 1, "extensions": { "EXT_mesh_gpu_instancing": { "attributes": attributes } } }));
    gltf.write(folder.path());
    let mut loaded = loaded(folder.path(), "share");
    loaded.job.frames.range = Some("1".into());
    loaded.job.light.truncate(1);
    loaded.job.solver.measured_rounds = 0;
    let watch = Watch { progress: &|_| (), cancel: &AtomicBool::new(false), notes: &|_| () };
    let plan = plan::make(&loaded, folder.path(), false, &watch).unwrap();
    let sun = &plan.frames[0].lights[0];
    let error = sun.error.as_ref().unwrap();
    let tried: u64 = error.tried.iter().map(|t| u64::from(t.width) * u64::from(t.height)).sum();
    assert_eq!(sun.cost.texels_drawn, tried, "nothing is drawn but the sizes tried");
    assert!(sun.met() && error.measured.as_ref().unwrap().misclassified > 0);
    let found = plan::verify(&plan, folder.path(), &watch).unwrap();
    assert!(found.passed, "{:?}", found.lights);
}
