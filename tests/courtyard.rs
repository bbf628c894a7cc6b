//! The example scene is what its generator writes, and holds the trouble it promises.

#![expect(clippy::unwrap_used, reason = "the helpers of a test may panic as the test itself may")]

#[path = "../examples/courtyard/yard/mod.rs"]
mod yard;

use glam::{DMat4, DQuat, DVec3};
use gltf::animation::Interpolation;
use gltf::animation::util::ReadOutputs;
use gltf::khr_lights_punctual::Kind;
use lixel::plan::{self, Status, Watch};
use std::collections::HashMap;
use std::path::Path;
use std::sync::atomic::AtomicBool;

const COMMITTED: &[u8] = include_bytes!("../examples/courtyard/courtyard.glb");

/// The document and its binary chunk. The gltf crate validates on the way.
fn courtyard() -> (gltf::Document, Vec<u8>) {
    let gltf = gltf::Gltf::from_slice(COMMITTED).unwrap();
    (gltf.document, gltf.blob.unwrap())
}

/// World from node at rest, for every node of the scene.
fn placed(document: &gltf::Document) -> Vec<(gltf::Node<'_>, DMat4)> {
    let mut placed: Vec<_> = document.default_scene().unwrap().nodes().map(|node| (node, DMat4::IDENTITY)).collect();
    let mut next = 0;
    while next < placed.len() {
        let (node, world_from_parent) = placed[next].clone();
        let columns = node.transform().matrix().map(|column| column.map(f64::from));
        placed[next].1 = world_from_parent * DMat4::from_cols_array_2d(&columns);
        let world_from_node = placed[next].1;
        placed.extend(node.children().map(|child| (child, world_from_node)));
        next += 1;
    }
    placed
}

fn triangles(mesh: &gltf::Mesh, blob: &[u8]) -> Vec<[DVec3; 3]> {
    let primitive = mesh.primitives().next().unwrap();
    let reader = primitive.reader(|_| Some(blob));
    let positions: Vec<DVec3> = reader.read_positions().unwrap().map(|p| DVec3::from(p.map(f64::from))).collect();
    let indices: Vec<usize> = reader.read_indices().unwrap().into_u32().map(|i| i as usize).collect();
    indices.chunks_exact(3).map(|t| [positions[t[0]], positions[t[1]], positions[t[2]]]).collect()
}

/// The light of a name: its place (the light shines along -z) and what it is.
fn light<'a>(document: &'a gltf::Document, name: &str) -> (DMat4, Kind, gltf::khr_lights_punctual::Light<'a>) {
    let holds = |(node, world): (gltf::Node<'a>, DMat4)| node.light().map(|light| (world, light));
    let (world, light) =
        placed(document).into_iter().filter_map(holds).find(|(_, light)| light.name() == Some(name)).unwrap();
    (world, light.kind(), light)
}

#[test]
fn regenerating_gives_the_committed_bytes() {
    let generated = yard::build().unwrap();
    assert!(generated == COMMITTED, "courtyard.glb is stale: run the courtyard example to write it again");
    assert!(COMMITTED.len() < 1_000_000);
}

#[test]
fn scene_has_the_promised_size_and_place() {
    let (document, blob) = courtyard();
    let meshes: Vec<_> = document.meshes().map(|mesh| triangles(&mesh, &blob)).collect();
    let (mut count, mut low, mut high) = (0, DVec3::INFINITY, DVec3::NEG_INFINITY);
    for (node, world) in placed(&document) {
        let Some(mesh) = node.mesh() else { continue };
        for triangle in &meshes[mesh.index()] {
            let corners = triangle.map(|p| world.transform_point3(p));
            let area = 0.5 * (corners[1] - corners[0]).cross(corners[2] - corners[0]).length();
            assert!(area > 1e-8, "{}: a triangle of {area} m2", node.name().unwrap());
            low = corners.iter().fold(low, |low, p| low.min(*p));
            high = corners.iter().fold(high, |high, p| high.max(*p));
            count += 1;
        }
    }
    assert!((40_000..80_000).contains(&count), "{count} triangles");
    let size = high - low;
    assert!((30.0..31.0).contains(&size.x) && (24.0..25.0).contains(&size.z), "{size}");
}

#[test]
fn nodes_are_nested_shared_mirrored_and_stretched() {
    let (document, _) = courtyard();
    let mut users: HashMap<String, usize> = HashMap::new();
    let (mut mirrored, mut stretched) = (0, 0);
    for (node, world) in placed(&document) {
        let Some(mesh) = node.mesh() else { continue };
        *users.entry(mesh.name().unwrap().to_owned()).or_default() += 1;
        mirrored += usize::from(world.determinant() < 0.0);
        let lengths = [world.x_axis, world.y_axis, world.z_axis].map(|axis| axis.truncate().length());
        stretched += usize::from((lengths[0] - lengths[1]).abs() > 0.01);
    }
    assert_eq!(users["column"], 8);
    assert_eq!(users["fence panel"], 8);
    assert!(users["twig"] > 200 && users["baluster"] == 52);
    assert!(mirrored > 30 && stretched > 5, "{mirrored} mirrored, {stretched} stretched");
}

#[test]
fn fence_bars_are_two_centimetres_thick() {
    let (document, blob) = courtyard();
    let panel = document.meshes().find(|mesh| mesh.name() == Some("fence panel")).unwrap();
    // The quarter turns of a bar's foot: at the panel's bottom only the ten bars have vertices.
    let foot: Vec<DVec3> =
        triangles(&panel, &blob).into_iter().flatten().filter(|p| (p.y + 0.02).abs() < 1e-3).collect();
    let thickness = foot.iter().fold(0.0_f64, |z, p| z.max(2.0 * p.z));
    assert!((thickness - 0.02).abs() < 3e-4, "{thickness} m");
    let mut xs: Vec<i64> = foot.iter().map(|p| (p.x / 0.15).floor() as i64).collect();
    xs.sort_unstable();
    xs.dedup();
    assert_eq!(xs.len(), 10);
}

#[test]
fn ninety_frames_of_a_walk_a_gate_and_a_turning_spot() {
    let (document, blob) = courtyard();
    let animation = document.animations().next().unwrap();
    let mut seen = Vec::new();
    for channel in animation.channels() {
        let reader = channel.reader(|_| Some(&blob));
        let times: Vec<f32> = reader.read_inputs().unwrap().collect();
        assert_eq!((times[0], *times.last().unwrap()), (0.0, (89.0_f64 / 24.0) as f32));
        assert!(times.is_sorted_by(|a, b| a < b));
        let interpolation = channel.sampler().interpolation();
        match reader.read_outputs().unwrap() {
            ReadOutputs::Translations(values) => {
                assert_eq!((interpolation, values.count()), (Interpolation::CubicSpline, 3 * times.len()));
            }
            ReadOutputs::Rotations(values) => {
                let values: Vec<_> = values.into_f32().map(|q| DQuat::from_array(q.map(f64::from))).collect();
                assert_eq!((interpolation, values.len()), (Interpolation::Linear, times.len()));
                assert!(values.iter().all(|q| (q.length() - 1.0).abs() < 1e-5));
            }
            _ => panic!("only translations and rotations are animated"),
        }
        seen.push((channel.target().node().name().unwrap().to_owned(), interpolation));
    }
    let expected = [
        ("spot", Interpolation::Linear),
        ("gate", Interpolation::Linear),
        ("walk", Interpolation::CubicSpline),
        ("walk", Interpolation::Linear),
    ];
    assert_eq!(seen, expected.map(|(node, how)| (node.to_owned(), how)));
}

#[test]
fn sun_grazes_lamp_and_spot_are_bounded() {
    let (document, _) = courtyard();
    assert_eq!(document.lights().unwrap().count(), 3);
    let (world, kind, _) = light(&document, "sun");
    assert!(matches!(kind, Kind::Directional));
    let height_degrees = world.z_axis.truncate().normalize().y.asin().to_degrees();
    assert!((height_degrees - 12.0).abs() < 0.01, "{height_degrees}");
    let (_, kind, lamp) = light(&document, "lamp");
    assert!(matches!(kind, Kind::Point) && lamp.range().is_some());
    let (_, kind, spot) = light(&document, "spot");
    let Kind::Spot { outer_cone_angle, .. } = kind else { panic!("the spot is no spot") };
    assert!((outer_cone_angle.to_degrees() - 35.0).abs() < 0.01 && spot.range().is_some());
}

/// The spot lights ground that is seen and throws no shadow there, at the film's full resolution; then all it reaches has
/// left the picture.
#[test]
fn spot_throws_no_shadow_and_then_leaves_the_picture() {
    let never = AtomicBool::new(false);
    let watch = Watch { progress: &|_| (), cancel: &never, notes: &|_| () };
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/courtyard"));
    let only_the_spot =
        "light = [{ name = 'spot' }]\n[frames]\nrange = '60,72,74,76,86'\n[shot]\ntemporal = 'per-frame'";
    let job = lixel::job::load(&folder.join("courtyard.toml"), &only_the_spot.parse().unwrap()).unwrap();
    let plan = plan::make(&job, folder, false, &watch).unwrap();
    let statuses: Vec<Status> = plan.frames.iter().map(|f| f.lights[0].status).collect();
    let none = Status::NoVisibleShadow;
    assert_eq!(statuses, [Status::Planned, none, none, none, Status::Unlit]);
    let lit = &plan.frames[1].lights[0];
    assert!(lit.maps.is_empty() && lit.cost.solver_evaluations == 0 && lit.cost.texels_drawn == 0);
    // Of its rays, those that are not the picture's own ask pixels which the spot lights.
    let film = u64::from(plan.frames[1].camera.width) * u64::from(plan.frames[1].camera.height);
    let unlit = &plan.frames[4].lights[0].cost;
    assert!(unlit.rays >= film && lit.cost.rays > unlit.rays + 5000, "{} lit", lit.cost.rays - unlit.rays);
    assert!(plan::verify(&plan, folder, &watch).unwrap().passed);
}
