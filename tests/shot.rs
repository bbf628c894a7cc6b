//! Whole shots: segments of constant matrix, reuse decided from the scene, flicker, and all temporal modes verified.

#![expect(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

mod boxes;
#[path = "scene/fixture.rs"]
#[expect(dead_code, reason = "shared with the scene tests, which use more of it")]
mod fixture;
mod watching;

use boxes::Boxes;
use fixture::Gltf;
use glam::{DMat4, DVec3};
use lixel::compare::{compare_temporal, temporal_json};
use lixel::job;
use lixel::math::matrix_from_rows;
use lixel::plan::{self, LightPlan, Outcome, Plan, Summary, Verification};
use lixel::shot::Temporal;
use serde_json::json;
use std::path::Path;
use watching::watched;

/// A floor with posts, and a box that moves over it or far from it.
fn scene(folder: &Path, mover: Option<[f32; 3]>) {
    let around = (0..7_u8).map(f32::from).map(|f| [(f * 2.4).sin() * 4.0, (f * 1.7).cos() * 4.0]);
    let mut boxes = Boxes::posts([12.0, 12.0], 0.5, around);
    if let Some(to) = mover {
        let node = boxes.add([0.0, 0.5, 0.0], [0.4, 0.5, 0.4]);
        let away: Vec<f32> = [[to[0], to[1], to[2]], [to[0] + 0.9, to[1], to[2] + 0.4]].concat();
        boxes.gltf.animate(node, "translation", "LINEAR", &[0.0, 0.25], &away);
    }
    boxes.write(folder);
}

const WALK: &str = "
scene = 'scene.glb'
[frames]
range = '1-6'
[image]
size = [128, 72]
[quality]
epsilon = 0.01
[map]
max = 2048
step = 1.1
[solver]
measured_rounds = 1
[[light]]
name = 'sun'
kind = 'directional'
direction = [0.6, -0.9, 0.35]
[camera]
look_at = [0.0, 0.5, 0.0]
[[camera.key]]
frame = 1
position = [7.0, 3.0, 4.0]
[[camera.key]]
frame = 6
position = [5.0, 2.6, 6.5]
";

fn load(folder: &Path, text: &str, overrides: &str) -> job::LoadedJob {
    std::fs::write(folder.join("job.toml"), text).unwrap();
    job::load(&folder.join("job.toml"), &overrides.parse().unwrap()).unwrap()
}

fn planned(folder: &Path, overrides: &str) -> Plan {
    watched(|watch| plan::make(&load(folder, WALK, overrides), folder, false, watch)).unwrap()
}

fn verify(plan: &Plan, folder: &Path) -> Verification {
    watched(|watch| plan::verify(plan, folder, watch)).unwrap()
}

fn assert_holds(plan: &Plan, folder: &Path) {
    let found = verify(plan, folder);
    let reasons: Vec<_> = found.lights.iter().flat_map(|l| l.reasons.clone()).chain(found.problems.clone()).collect();
    assert!(found.passed, "{reasons:#?}");
}

fn of(plan: &Plan, light: &str) -> Vec<LightPlan> {
    plan.frames.iter().filter_map(|f| f.lights.iter().find(|l| l.light == light).cloned()).collect()
}

#[test]
fn a_still_light_over_still_casters_is_drawn_once_and_does_not_flicker() {
    let folder = tempfile::tempdir().unwrap();
    scene(folder.path(), None);
    let shot = planned(folder.path(), "");
    assert_holds(&shot, folder.path());
    assert!(shot.summary.met);
    let frames = of(&shot, "sun");
    let first = frames[0].temporal.clone().unwrap();
    assert_eq!((first.mode, first.drawn_at, first.reused_from), (Temporal::Shot, Some(1), None));
    assert_eq!(first.segment, Some([1, 6]));
    for frame in &frames[1..] {
        let temporal = frame.temporal.clone().unwrap();
        assert_eq!((temporal.drawn_at, temporal.reused_from, temporal.segment), (None, Some(1), Some([1, 6])));
        let map = &frame.maps[0];
        assert_eq!(map.clip_from_world, frames[0].maps[0].clip_from_world);
        assert_eq!(
            (map.width, map.height, &map.bias.slope),
            (frames[0].maps[0].width, frames[0].maps[0].height, &frames[0].maps[0].bias.slope)
        );
        let flicker = frame.flicker.unwrap();
        assert_eq!((flicker.still, flicker.moved), (0, 0));
        assert!(flicker.compared > 1000, "{flicker:?}");
    }
    assert!(frames[0].flicker.is_none());
    // The frame that is said to need the size was measured at the next smaller one, and is over there.
    let decider = (first.decided_by.unwrap() - 1) as usize;
    let limit = 0.01 * 128.0 * 72.0;
    let texels = frames[decider].maps[0].texels();
    let tried = &frames[decider].error.as_ref().unwrap().tried;
    let smaller = tried.iter().filter(|t| u64::from(t.width) * u64::from(t.height) < texels);
    let next = smaller.max_by_key(|t| t.width * t.height).unwrap();
    assert!(next.misclassified as f64 > limit || (next.misclassified + next.uncertain) as f64 > 1.15 * limit);

    let alone = planned(folder.path(), "[shot]\ntemporal = 'per-frame'");
    assert_holds(&alone, folder.path());
    assert_eq!(alone.summary.changes, 5);
    assert_eq!(alone.summary.texels_drawn, alone.summary.texels);
    assert!(alone.summary.flicker.unwrap() > 20, "{:?}", alone.summary);
    assert_eq!((shot.summary.changes, shot.summary.flicker), (0, Some(0)));
    assert_eq!(shot.summary.texels_drawn, frames[0].maps[0].texels());
    assert!(shot.summary.texels_drawn * 2 < alone.summary.texels_drawn);
}

/// A camera that pauses, twice at the same place, over a box that moves and comes back.
const PAUSES: &str = "
[frames]
range = '1-9'
[shot]
temporal = 'per-frame'
[camera]
look_at = [0.0, 0.5, 0.0]
key = [
    { frame = 1, position = [7.0, 3.0, 4.0] },
    { frame = 3, position = [7.0, 3.0, 4.0] },
    { frame = 4, position = [5.0, 2.6, 6.5] },
    { frame = 5, position = [5.0, 2.6, 6.5] },
    { frame = 6, position = [7.0, 3.0, 4.0] },
    { frame = 9, position = [7.0, 3.0, 4.0] },
]
";

/// Frames that are equal to an earlier one refer to it; all else is as if they were planned, in every split.
#[test]
fn equal_frames_are_planned_once() {
    let folder = tempfile::tempdir().unwrap();
    scene(folder.path(), None);
    let short = planned(folder.path(), PAUSES);
    let full = planned(folder.path(), &format!("{PAUSES}[quality]\nmeasure = 'full'"));
    assert_holds(&short, folder.path());
    assert_holds(&full, folder.path());
    let says: Vec<_> = of(&short, "sun")
        .iter()
        .map(|l| l.temporal.clone().unwrap())
        .map(|t| (t.same_as, t.drawn_at, t.reused_from))
        .collect();
    let first = |from| (Some(1), None, Some(from));
    let expected = [
        (None, Some(1), None),
        first(1),
        first(1),
        (None, Some(4), None),
        (Some(4), None, Some(4)),
        (Some(1), Some(6), None),
        first(6),
        first(6),
        first(6),
    ];
    assert_eq!(says, expected);
    // Nothing is left out of the answers, and nothing counted twice of what they took.
    let bare = |l: &LightPlan| LightPlan { temporal: None, cost: plan::Cost::default(), ..l.clone() };
    for (short, full) in of(&short, "sun").iter().zip(of(&full, "sun")) {
        assert_eq!(bare(short), bare(&full));
        let temporal = short.temporal.as_ref().unwrap();
        let cost = if temporal.same_as.is_some() { plan::Cost::default() } else { full.cost };
        assert_eq!(short.cost, cost);
    }
    assert_eq!(short.summary.flicker, full.summary.flicker);
    assert_eq!((short.summary.texels, short.summary.met), (full.summary.texels, full.summary.met));
    assert!(short.summary.texels_drawn * 2 < full.summary.texels_drawn);

    // In parts, and with finished work kept.
    let text = |plan: &Plan| plan::to_text(plan, plan::Format::Json).unwrap();
    let job = load(folder.path(), WALK, PAUSES);
    let kept = folder.path().join("work");
    for _ in 0..2 {
        let worked = watched(|watch| plan::make_in(&job, folder.path(), false, Some(&kept), watch)).unwrap();
        assert!(text(&worked) == text(&short));
    }
    let file = |name: &str| folder.path().join(name);
    let ranges = ["7-9", "1-2", "3-6"];
    let parts = |kind: &str| ranges.iter().map(|range| file(&format!("{kind}-{range}"))).collect::<Vec<_>>();
    for (range, to) in ranges.iter().zip(parts("sampled")) {
        watched(|watch| plan::sample(&job, Some(range), &to, watch)).unwrap();
    }
    let draft = file("draft");
    watched(|watch| plan::solve(&parts("sampled"), None, &draft, watch)).unwrap();
    for (range, to) in ranges.iter().zip(parts("certified")) {
        watched(|watch| plan::certify(&draft, Some(range), None, &to, watch)).unwrap();
    }
    let merged = watched(|watch| plan::merge(&parts("certified"), None, folder.path(), &file("again"), watch)).unwrap();
    let plan::Merged::Plan(merged) = merged else { panic!("no frame asks for another size") };
    assert!(text(&merged) == text(&short));

    // What is said of another frame is checked.
    let mut wrong = short.clone();
    wrong.frames[5].lights[0].temporal.as_mut().unwrap().same_as = Some(4);
    assert!(!verify(&wrong, folder.path()).passed);

    // Where something moves, frames are equal as long as it stands still.
    let moving = tempfile::tempdir().unwrap();
    scene(moving.path(), Some([0.5, 0.0, 0.5]));
    let frames = planned(moving.path(), PAUSES);
    assert_holds(&frames, moving.path());
    let same: Vec<_> = of(&frames, "sun").iter().map(|l| l.temporal.as_ref().unwrap().same_as).collect();
    assert_eq!(same, [None, None, None, None, None, None, None, Some(7), Some(7)], "it moves until frame 7");
}

#[test]
fn what_moves_in_a_map_has_it_drawn_again_under_the_same_matrix() {
    let folder = tempfile::tempdir().unwrap();
    scene(folder.path(), Some([0.5, 0.0, 0.5]));
    let shot = planned(folder.path(), "");
    assert_holds(&shot, folder.path());
    let frames = of(&shot, "sun");
    assert!(frames.iter().all(|f| f.maps[0].clip_from_world == frames[0].maps[0].clip_from_world));
    assert!(frames.iter().zip(1..).all(|(f, number)| f.temporal.as_ref().unwrap().drawn_at == Some(number)));
    assert_eq!(shot.summary.texels_drawn, shot.summary.texels);

    // The same thing moving where the map does not see it: drawn once.
    let far = tempfile::tempdir().unwrap();
    scene(far.path(), Some([400.0, 0.0, 0.0]));
    let shot = planned(far.path(), "");
    assert_holds(&shot, far.path());
    assert_eq!(shot.summary.texels_drawn * 6, shot.summary.texels);
}

#[test]
fn a_moving_light_keeps_its_matrix_in_its_own_frame() {
    let folder = tempfile::tempdir().unwrap();
    scene(folder.path(), None);
    let mut gltf = Gltf::new();
    let lamp = gltf.push(
        "nodes",
        json!({ "name": "lamp", "rotation": [-std::f64::consts::FRAC_1_SQRT_2, 0, 0, std::f64::consts::FRAC_1_SQRT_2],
                "extensions": { "KHR_lights_punctual": { "light": 0 } } }),
    );
    gltf.animate(lamp, "translation", "LINEAR", &[0.0, 0.25], &[0.0, 6.0, 0.0, 0.6, 6.5, -0.3]);
    gltf.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [
        { "name": "lamp", "type": "spot", "spot": { "outerConeAngle": 0.8 } }] } });
    fixture::write(folder.path(), "lamp.glb", &gltf.glb());
    let shot = planned(folder.path(), "scene = ['scene.glb', 'lamp.glb']\nlight = [{ name = 'lamp' }]");
    assert_holds(&shot, folder.path());
    let frames = of(&shot, "lamp");
    assert_eq!(frames[0].temporal.as_ref().unwrap().segment, Some([1, 6]), "{:?}", frames[0].reason);
    let matrix = |f: &LightPlan| -> DMat4 { matrix_from_rows(&f.maps[0].clip_from_world) };
    let place = |f: &LightPlan| DVec3::from(f.position.unwrap());
    let (first, from) = (matrix(&frames[0]), place(&frames[0]));
    for (frame, number) in frames.iter().zip(1..) {
        assert_eq!(
            frame.temporal.as_ref().unwrap().drawn_at,
            Some(number),
            "a light that moves is drawn in every frame"
        );
        for p in [DVec3::new(0.3, 0.0, 0.2), DVec3::new(-1.0, 1.5, 0.7)] {
            let there = matrix(frame) * (p + place(frame) - from).extend(1.0);
            let here = first * p.extend(1.0);
            assert!((there / there.w - here / here.w).length() < 1e-9, "{there} {here}");
        }
    }
    assert_eq!(shot.summary.changes, 0);
}

#[test]
fn every_mode_is_planned_verified_and_compared() {
    let folder = tempfile::tempdir().unwrap();
    scene(folder.path(), Some([0.5, 0.0, 0.5]));
    for overrides in [
        "[shot]\ntemporal = 'hysteresis'",
        "[shot]\ntemporal = 'hysteresis'\nhysteresis_border = 0.1",
        "[shot]\ntemporal = 'snapped'\n[map]\nshape = 'rectangle'",
        "[shot]\none_size = true\nchange_cost = 0.0\nminimise = 'sum'",
        "[shot]\nminimise = 'peak'\nchange_cost = 0.0",
        "[quality]\nmeasure = 'never'",
    ] {
        let plan = planned(folder.path(), overrides);
        assert!(plan.summary.met, "{overrides}: {:?}", plan.frames[0].lights[0].reason);
        if !overrides.contains("never") {
            assert_holds(&plan, folder.path());
        }
        let sizes: Vec<_> = of(&plan, "sun").iter().map(|l| (l.maps[0].width, l.maps[0].height)).collect();
        if overrides.contains("one_size") || overrides.contains("snapped") {
            assert!(sizes.iter().all(|s| *s == sizes[0]), "{overrides}: {sizes:?}");
        }
    }
    let job = load(folder.path(), WALK, "[map]\nshape = 'rectangle'\n[solver]\nmeasured_rounds = 0");
    let modes = [Temporal::PerFrame, Temporal::Hysteresis, Temporal::Snapped, Temporal::Shot];
    let rows = watched(|watch| compare_temporal(&job, &modes, Some(folder.path()), watch)).unwrap();
    let file = std::fs::File::open(folder.path().join("swimming.png")).unwrap();
    let picture = png::Decoder::new(std::io::BufReader::new(file)).read_info().unwrap();
    assert_eq!((picture.info().width, picture.info().height), (6 * 128 + 5 * 4, 4 * 72 + 3 * 4));
    let value: serde_json::Value = serde_json::from_str(&temporal_json(&rows).unwrap()).unwrap();
    for (row, mode) in value["temporal"].as_array().unwrap().iter().zip(["per-frame", "hysteresis", "snapped", "shot"])
    {
        assert_eq!(row["temporal"], mode);
        for key in ["texels_drawn", "peak", "sum", "changes", "flicker", "misclassified"] {
            assert!(row[key].is_u64(), "{mode}: {key} is {}", row[key]);
        }
    }
    assert!(rows[3].flicker < rows[0].flicker && rows[3].changes == 0, "{rows:#?}");
}

#[test]
fn snapped_maps_move_by_whole_texels() {
    let folder = tempfile::tempdir().unwrap();
    scene(folder.path(), None);
    let plan = planned(folder.path(), "[shot]\ntemporal = 'snapped'\n[map]\nshape = 'rectangle'");
    let frames = of(&plan, "sun");
    let texel = |f: &LightPlan| {
        let map = &f.maps[0];
        let clip = matrix_from_rows(&map.clip_from_world) * DVec3::new(0.3, 0.2, -0.4).extend(1.0);
        let uv = (clip.truncate() / clip.w).truncate() * 0.5 + 0.5;
        uv * glam::DVec2::new(f64::from(map.width), f64::from(map.height))
    };
    let mut moved = 0;
    for frame in &frames[1..] {
        let step = texel(frame) - texel(&frames[0]);
        assert!((step - step.round()).length() < 1e-6, "{step}");
        moved += i32::from(step.round() != glam::DVec2::ZERO);
    }
    assert!(moved > 0, "the walk moves the window");
}

#[test]
fn segments_follow_their_limits_and_methods_of_one_camera_stay_alone() {
    let folder = tempfile::tempdir().unwrap();
    scene(folder.path(), Some([0.5, 0.0, 0.5]));
    let free = planned(folder.path(), "[shot]\nchange_cost = 0.0\nminimise = 'sum'");
    let two = planned(folder.path(), "[shot]\nchange_cost = 0.0\nminimise = 'sum'\nmax_segments = 2");
    let held = planned(folder.path(), "[shot]\nchange_cost = 0.0\nminimise = 'sum'\nhold = 'shot'");
    assert!(free.summary.changes > 1, "texels alone are least frame by frame");
    assert!(two.summary.changes <= 1);
    assert_eq!(held.summary.changes, 0);
    // Cuts are chosen by predicted sizes; measured ones of maps this small scatter by more than the gain.
    let by_prediction =
        |shot: &str| planned(folder.path(), &format!("quality = {{ measure = 'never' }}\n[shot]\n{shot}"));
    let free = by_prediction("change_cost = 0.0\nminimise = 'sum'");
    let held = by_prediction("change_cost = 0.0\nminimise = 'sum'\nhold = 'shot'");
    assert!(free.summary.texels < held.summary.texels);
    let focused = planned(folder.path(), "[solver]\nmethod = 'focused'");
    let temporal = focused.frames[2].lights[0].temporal.clone().unwrap();
    assert_eq!(temporal.mode, Temporal::PerFrame);
    assert!(temporal.reason.unwrap().contains("by one camera"));
    assert_holds(&focused, folder.path());
}

#[test]
fn a_changed_plan_is_found_out() {
    let folder = tempfile::tempdir().unwrap();
    scene(folder.path(), None);
    let plan = planned(folder.path(), "");
    let broken = |change: &dyn Fn(&mut LightPlan), expected: &str| {
        let mut plan = plan.clone();
        change(&mut plan.frames[3].lights[0]);
        plan.summary = Summary::of(&plan.frames);
        let found = verify(&plan, folder.path());
        let light = found.lights.iter().find(|l| l.frame == 4).unwrap();
        assert_eq!(light.outcome, Outcome::Broken);
        assert!(light.reasons.iter().any(|r| r.contains(expected)), "{expected}: {:?}", light.reasons);
    };
    broken(&|l| l.flicker.as_mut().unwrap().still += 1, "flicker is");
    broken(&|l| l.temporal.as_mut().unwrap().reused_from = Some(2), "said to be reused from frame 2");
    broken(&|l| l.temporal.as_mut().unwrap().reused_from = None, "says neither");
    broken(&|l| l.temporal.as_mut().unwrap().decided_by = Some(77), "frame 77 is said to need the size");
    broken(&|l| l.maps[0].clip_from_world[0][3] += 1e-4, "not those drawn in frame 1");
}
