//! A plan that is true holds, in both formats; a plan changed in any one place does not.

#![expect(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

mod watching;

use lixel::job;
use lixel::math::{Domain, matrix_from_rows};
use lixel::measure::{Drawn, Outside, Receivers, wrong};
use lixel::plan::{self, Format, Outcome, Plan, Status, Summary, Verification};
use lixel::raster::{Bias, draw};
use lixel::resolution::other_biases;
use lixel::visibility::{Bvh, RayOffset, Tracer, see};
use std::path::Path;
use std::sync::LazyLock;
use watching::watched;

/// The folder that plans are relative to: that of the scene.
fn folder() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/courtyard"))
}

/// Frames apart: what holds a shot together has tests of its own.
const BASE: &str = "shot.temporal = 'per-frame'\n[frames]\nrange = '30,80'\n[image]\nsize = [160, 90]\n[map]\nmax = 1024\nstep = 1.2\n[quality]\nepsilon = 0.03\n";

/// Two frames of the courtyard, small; the spot is out of the second.
fn plan_courtyard(overrides: &str) -> Plan {
    plan_with(&(BASE.to_owned() + overrides))
}

/// The courtyard with a layer over its job.
fn plan_with(layer: &str) -> Plan {
    let job = job::load(&folder().join("courtyard.toml"), &layer.parse().unwrap()).unwrap();
    watched(|watch| plan::make(&job, folder(), false, watch)).unwrap()
}

/// Planned once for all tests.
static MEASURED: LazyLock<Plan> = LazyLock::new(|| plan_courtyard(""));

fn verify(plan: &Plan) -> Verification {
    watched(|watch| plan::verify(plan, folder(), watch)).unwrap()
}

/// Everything wrong that was found, in one text.
fn faults(found: &Verification) -> String {
    let inputs = found.inputs.iter().filter_map(|i| i.reason.clone());
    let lights = found.lights.iter().filter(|l| l.outcome == Outcome::Broken).flat_map(|l| l.reasons.clone());
    inputs.chain(found.problems.clone()).chain(lights).collect::<Vec<_>>().join("\n")
}

/// A plan with one thing changed, the summary in accord with it; what is found has to name it.
fn broken_by(change: impl FnOnce(&mut Plan), expected: &str) {
    let mut plan = MEASURED.clone();
    change(&mut plan);
    plan.summary = Summary::of(&plan.frames);
    assert!(plan != *MEASURED, "{expected}: nothing was changed");
    let found = verify(&plan);
    assert!(!found.passed);
    assert!(faults(&found).contains(expected), "`{expected}` is not in\n{}", faults(&found));
}

#[test]
fn a_true_plan_holds_in_both_formats() {
    assert!(MEASURED.summary.met, "{:?}", MEASURED.summary);
    assert_eq!(MEASURED.frames[1].lights[1].status, Status::Unlit);
    assert!(MEASURED.frames[0].lights[2].maps.len() > 1, "the lamp needs several maps");
    for format in [Format::Json, Format::Toml] {
        let text = plan::to_text(&MEASURED, format).unwrap();
        let found = verify(&plan::parse(&text, format, Path::new("plan")).unwrap());
        assert!(found.passed, "{}", faults(&found));
        assert_eq!(found.lights.len(), 6);
        for light in &found.lights {
            assert_eq!(light.planned.unwrap_or(0), light.measured.unwrap());
            assert_eq!(light.witnesses_held, light.witnesses);
        }
        assert!(
            found.lights.iter().filter_map(|l| l.measured).sum::<u64>() > 100,
            "errors there are, only not too many"
        );
    }
}

#[test]
fn a_plan_that_was_not_measured_is_measured_and_judged_by_epsilon() {
    let plan = plan_courtyard("measure = 'never'\n");
    assert!(plan.frames[0].lights[0].error.as_ref().unwrap().measured.is_none());
    let found = verify(&plan);
    assert_eq!(faults(&found), "");
    for light in &found.lights {
        let limit = 0.03 * 160.0 * 90.0;
        let (measured, uncertain) = (light.measured.unwrap(), light.uncertain.unwrap());
        let meets = measured as f64 <= limit && (measured + uncertain) as f64 <= 1.15 * limit;
        assert_eq!(light.outcome == Outcome::Holds, meets, "{light:?}");
    }
    assert!(found.lights.iter().any(|l| l.measured > Some(0)));
    assert_eq!(found.passed, found.lights.iter().all(|l| l.outcome == Outcome::Holds));
}

#[test]
fn lookups_by_rays_find_what_drawn_maps_answer_wrongly() {
    // As many positions as the film has pixels: the sample is all of them.
    for outside in ["lit", "shadowed"] {
        let base = BASE.replace("step = 1.2", &format!("step = 1.2\noutside = '{outside}'"));
        let plan = plan_with(&(base + "measure = 'never'\n"));
        let found = verify(&plan);
        let lights = plan.frames.iter().flat_map(|f| &f.lights).zip(&found.lights);
        let mut compared = 0;
        for (planned, drawn) in lights {
            let predicted = planned.error.as_ref().and_then(|e| e.predicted.as_ref());
            let Some(by_rays) = predicted.and_then(|p| p.sampled) else { continue };
            let (by_rays, drawn) =
                (by_rays.iter().sum::<f64>(), (drawn.measured.unwrap() + drawn.uncertain.unwrap()) as f64);
            // Rays beside edges may turn by rounding.
            assert!((by_rays - drawn).abs() <= 0.01 * drawn + 2.0, "{}: {by_rays} {drawn}", planned.light);
            compared += u64::from(drawn > 50.0);
            assert!(planned.met() && drawn <= 1.15 * 0.03 * 160.0 * 90.0, "{}: {drawn}", planned.light);
        }
        assert!(compared >= 3, "{compared} lights with errors to compare");
    }
}

#[test]
fn what_bias_is_blamed_for_by_rays_is_what_drawn_maps_blame_it_for() {
    let job = job::load(&folder().join("courtyard.toml"), &BASE.parse().unwrap()).unwrap();
    let shot = job.shot().unwrap();
    let still = Bvh::still(&shot.scene);
    let mut blamed = 0;
    for planned in &MEASURED.frames {
        let frame = shot.scene.frame(planned.time_s).unwrap();
        let moving = Bvh::moving(&shot.scene, &frame);
        let tracer = Tracer::new(shot.scene.geometry(&frame), &still, moving.as_ref());
        let view = see(&tracer, &frame.camera, shot.film);
        for (light, of_frame) in planned.lights.iter().zip(&frame.lights) {
            let ([map], Some(error)) = (light.maps.as_slice(), light.error.as_ref()) else { continue };
            let offset = RayOffset::for_scene(&tracer);
            let receivers = Receivers::classify(&tracer, &view, &frame.camera, of_frame, offset);
            let clip_from_scene = matrix_from_rows(&map.clip_from_world);
            let wrong_under = |bias: Bias| {
                let map = draw(tracer.geometry(), &clip_from_scene, map.width, map.height, bias).unwrap();
                wrong(&receivers, &[Drawn { domain: Domain::All, clip_from_scene, map }], Outside::Lit)
            };
            let clamp = map.bias.clamp.unwrap_or(f64::INFINITY);
            let bias = Bias { constant: map.bias.constant, slope: map.bias.slope, clamp };
            let others = other_biases(bias).map(wrong_under);
            let all = wrong_under(bias);
            let drawn = all.iter().filter(|i| others.iter().any(|o| o.binary_search(i).is_err())).count() as u64;
            let measured = error.measured.as_ref().unwrap();
            assert_eq!(all.len() as u64, measured.edge + measured.self_shadow, "{}", light.light);
            let by_rays = measured.self_shadow;
            // Rays beside edges may turn by rounding.
            assert!(by_rays.abs_diff(drawn) <= 2 + drawn / 50, "{}: {by_rays} by rays, {drawn} drawn", light.light);
            blamed += drawn;
        }
    }
    assert!(blamed > 20, "{blamed} pixels to blame bias for");
}

#[test]
fn a_check_draws_once_what_lookups_settled_on() {
    let drawn = |plan: &Plan| plan.frames.iter().flat_map(|f| &f.lights).map(|l| l.cost.texels_drawn).sum::<u64>();
    let quick = "[solver]\nmeasured_rounds = 0\n";
    let check = plan_courtyard(&format!("measure = 'check'\n{quick}"));
    let found = verify(&check);
    assert!(found.passed, "{}", faults(&found));
    let mut once = 0;
    for light in check.frames.iter().flat_map(|f| &f.lights).filter(|l| !l.maps.is_empty()) {
        let error = light.error.as_ref().unwrap();
        let (measured, sampled) =
            (error.measured.as_ref().unwrap(), error.predicted.as_ref().unwrap().sampled.unwrap());
        let (measured, sampled) = ((measured.misclassified + measured.uncertain) as f64, sampled.iter().sum::<f64>());
        assert!((measured - sampled).abs() <= 0.01 * measured + 2.0, "{}: {measured} {sampled}", light.light);
        once += usize::from(error.tried.len() == 1);
    }
    assert!(once >= 3, "{once} lights took one trial");
    let always = plan_courtyard(quick);
    assert!(2 * drawn(&check) < drawn(&always), "{} of {} texels drawn", drawn(&check), drawn(&always));
}

#[test]
fn a_bound_that_the_plan_says_is_not_met_is_told_apart_from_a_broken_plan() {
    let found = verify(&plan_courtyard("[map.bias]\nconstant = 0.0\nslope = 0.0\n"));
    assert_eq!(faults(&found), "");
    let sun = &found.lights[0];
    assert_eq!(sun.outcome, Outcome::NotMet, "without bias a lit floor shadows itself: {sun:?}");
    assert!(!found.passed && sun.reasons[0].starts_with("not met, as the plan says: "), "{:?}", sun.reasons);
}

#[test]
fn plans_of_several_maps_hold() {
    for method in ["partitioned", "adaptive", "edges"] {
        let plan =
            plan_courtyard(&format!("[solver]\nmethod = '{method}'\ntiles = 6\nmaps = 3\nmeasured_rounds = 1\n"));
        let found = verify(&plan);
        assert_eq!(faults(&found), "", "{method}");
        let sun = &plan.frames[0].lights[0];
        assert!(sun.maps.len() > 1, "{method}: {} maps", sun.maps.len());
        assert!(sun.maps.iter().all(|m| m.domain != plan::Domain::All), "{method}");
        // What is left of a light's maps does not answer for what they all covered.
        let mut fewer = plan.clone();
        fewer.frames[0].lights[0].maps.pop();
        fewer.summary = Summary::of(&fewer.frames);
        assert!(faults(&verify(&fewer)).contains(" pixels that need a map lie in no domain"), "{method}");
    }
}

#[test]
fn changed_maps_are_found() {
    broken_by(|p| p.frames[0].lights[0].maps[0].clip_from_world[0][3] += 0.5, "misclassified is ");
    broken_by(|p| p.frames[0].lights[0].maps[0].clip_from_world[0][0] *= 1.0 + 1e-12, "the matrix gives");
    broken_by(|p| p.frames[0].lights[0].maps[0].width -= 1, "misclassified is ");
    broken_by(|p| p.frames[0].lights[0].maps[0].height = 1 << 20, "cannot be drawn");
    broken_by(|p| p.frames[0].lights[0].maps[0].bias.slope = 0.0, "misclassified is ");
    broken_by(|p| p.frames[0].lights[2].maps.swap(0, 1), "sizes tried");
    broken_by(|p| p.frames[0].lights[2].maps[0].domain = plan::Domain::All, "misclassified is ");
    broken_by(|p| p.frames[0].lights[2].maps.truncate(1), "misclassified is ");
    broken_by(|p| p.frames[0].lights[2].maps.truncate(1), " pixels that need a map lie in no domain");
    let to_the_left = plan::Domain::HalfSpace { plane: [-1.0, 0.0, 0.0, 0.0] };
    broken_by(|p| p.frames[0].lights[2].maps[0].domain = to_the_left, "lies in no domain");
    let nothing = plan::Domain::Intersection { of: Vec::new() };
    broken_by(|p| p.frames[0].lights[2].maps[0].domain = nothing, "lies in the domain of map 0");
}

#[test]
fn changed_claims_are_found() {
    let measured = |p: &mut Plan, change: fn(&mut plan::Measured)| {
        change(p.frames[0].lights[0].error.as_mut().unwrap().measured.as_mut().unwrap());
    };
    broken_by(|p| measured(p, |m| m.misclassified -= 1), "misclassified is ");
    broken_by(|p| measured(p, |m| m.false_lit += 1), "false_lit is ");
    broken_by(|p| measured(p, |m| m.uncertain += 1), "uncertain is ");
    broken_by(|p| measured(p, |m| m.self_shadow += 1), "edge + self_shadow is ");
    broken_by(|p| measured(p, |m| m.ray_offset_m *= 2.0), "ray_offset_m is ");
    broken_by(|p| p.frames[0].lights[0].error.as_mut().unwrap().met = false, "error.met is false");
    broken_by(|p| p.frames[0].lights[0].error.as_mut().unwrap().tried.clear(), "is not among the sizes tried");
    broken_by(|p| p.frames[0].lights[0].epsilon = 0.5, "epsilon is 0.5, 0.03 in the job");
    broken_by(
        |p| {
            let sun = &mut p.frames[0].lights[0];
            (sun.status, sun.error) = (Status::NoVisibleShadow, None);
            sun.maps.clear();
        },
        "status is NoVisibleShadow, but ",
    );
    broken_by(|p| p.frames[1].lights[1].status = Status::NoVisibleShadow, "but 0 pixels face the light");
}

#[test]
fn changed_values_of_the_bound_are_found() {
    for (bound, epsilon) in [("displacement", 20.0), ("footprint", 20.0)] {
        let base =
            "shot.temporal = 'per-frame'\n[frames]\nrange = '30'\n[image]\nsize = [160, 90]\n[map]\nmax = 1024\n";
        let own = format!("{base}[quality]\nbound = '{bound}'\nepsilon = {epsilon}\n");
        let job = job::load(&folder().join("courtyard.toml"), &own.parse().unwrap()).unwrap();
        let plan = watched(|watch| plan::make(&job, folder(), false, watch)).unwrap();
        let true_one = verify(&plan);
        assert_eq!(faults(&true_one), "", "{bound}");
        assert_eq!(true_one.passed, plan.summary.met, "{bound}");
        let mut better = plan.clone();
        let measured = better.frames[0].lights[0].error.as_mut().unwrap().measured.as_mut().unwrap();
        for value in [&mut measured.displacement, &mut measured.footprint].into_iter().flatten() {
            *value = *value * 0.999 + 1e-3;
        }
        assert!(better != plan);
        let found = faults(&verify(&better));
        assert!(found.contains(&format!("{bound} is ")), "{bound}: {found}");
    }
}

#[test]
fn what_repeats_the_matrix_is_found_changed() {
    let depth = |p: &mut Plan, light: usize| {
        let row = &mut p.frames[0].lights[light].maps[0].clip_from_world[2];
        *row = row.map(|v| v * 3.0);
    };
    broken_by(|p| depth(p, 0), " look map 0 up lie out of its clip depth");
    for light in [0, 2] {
        let range = |p: &mut Plan, change: fn(&mut plan::MapPlan)| change(&mut p.frames[0].lights[light].maps[0]);
        let of_range = " m away, near and far are ";
        broken_by(|p| range(p, |m| m.near += 0.9 * (m.far - m.near)), of_range);
        broken_by(|p| range(p, |m| m.far -= 0.9 * (m.far - m.near)), of_range);
    }
    // Point and spot lights always have one.
    let camera = |p: &mut Plan, change: fn(&mut plan::LightCamera)| {
        change(p.frames[0].lights[2].maps[0].light_camera.as_mut().unwrap());
    };
    let of_camera = "light_camera of map 0 is not the camera of its matrix";
    broken_by(|p| camera(p, |c| c.skew += 1e-6), of_camera);
    broken_by(|p| camera(p, |c| c.position[1] += 1e-5), of_camera);
    broken_by(|p| camera(p, |c| c.frustum.right *= 1.0 + 1e-6), of_camera);
    broken_by(|p| camera(p, |c| c.frustum.far *= 1.0 + 1e-3), of_camera);
    broken_by(|p| p.frames[0].lights[2].maps[0].light_camera = None, "either a light_camera or a light_camera_reason");
}

#[test]
fn what_restates_bias_and_rounding_is_found_changed() {
    for (light, map) in [(0, 0), (2, 0), (2, 1)] {
        let of = |p: &mut Plan| p.frames[0].lights[light].maps[map].clone();
        let was = of(&mut MEASURED.clone());
        assert!(was.bias.texels > 0.0 && was.bias.world > 0.0 && was.f32_roundtrip_texels > 0.0);
        let change = |change: fn(&mut plan::MapPlan), key: &str| {
            broken_by(|p| change(&mut p.frames[0].lights[light].maps[map]), &format!("{key} of map {map} is "));
        };
        change(|m| m.bias.texels *= 1.0 + 1e-5, "bias.texels");
        change(|m| m.bias.world *= 1.0 - 1e-5, "bias.world");
        change(|m| m.f32_roundtrip_texels *= 1.01, "f32_roundtrip_texels");
        change(|m| m.f32_roundtrip_texels = 0.0, "f32_roundtrip_texels");
    }
}

/// Counting to the end finds no other answer, and draws no other map, than ending where a candidate cannot win.
#[test]
fn a_shortened_measurement_answers_as_the_full_one() {
    let full = plan_with(&BASE.replace("[quality]", "[quality]\nmeasure = 'full'"));
    assert!(full.job.job.quality.measure != MEASURED.job.job.quality.measure);
    assert_eq!(full.frames, MEASURED.frames);
}

/// However few pixels look a map up, an importer can be checked with it.
#[test]
fn maps_that_few_pixels_look_up_have_witnesses_too() {
    let several = "light = [{ name = 'lamp' }]\n[frames]\nrange = '80'\n[image]\nsize = [48, 27]\n[quality]\nepsilon = 0.2\n[map]\nmax = 256\n";
    let mut maps = 0;
    for method in ["cascades", "partitioned", "faces", "adaptive"] {
        let plan = plan_with(&format!("{several}[solver]\nmethod = '{method}'\n"));
        for map in plan.frames.iter().flat_map(|f| &f.lights).flat_map(|l| &l.maps) {
            maps += 1;
            assert!(map.witnesses_reason.is_none() && map.witnesses.len() >= 6, "{method}: {map:?}");
        }
        let found = verify(&plan);
        assert!(found.lights.iter().all(|l| l.outcome != Outcome::Broken), "{method}: {}", faults(&found));
    }
    assert!(maps > 8, "{maps} maps");
}

#[test]
fn changed_witnesses_are_found() {
    broken_by(|p| p.frames[0].lights[0].maps[0].witnesses[0].uv[0] += 1e-9, "the matrix gives");
    broken_by(|p| p.frames[0].lights[0].maps[0].witnesses[0].depth += 1e-9, "the matrix gives");
    broken_by(
        |p| p.frames[0].lights[2].maps[1].witnesses.truncate(5),
        "map 1 has 5 witnesses of 6, and does not say why",
    );
    let flat = |p: &mut Plan| {
        let witnesses = &mut p.frames[0].lights[0].maps[0].witnesses;
        let (first, depth) = (witnesses[0].clone(), witnesses[0].depth);
        witnesses.iter_mut().for_each(|w| w.depth = depth);
        witnesses.extend(std::iter::repeat_n(first, 6));
    };
    broken_by(flat, "witnesses, all in one plane");
    broken_by(|p| p.frames[0].lights[0].maps[0].witnesses_reason = Some("none".into()), "they lack nothing");
    for (light, map, witness) in [(0, 0, 0), (0, 0, 9), (2, 0, 0), (2, 1, 1)] {
        let flip = |p: &mut Plan| {
            let witness = &mut p.frames[0].lights[light].maps[map].witnesses[witness];
            witness.shadowed = !witness.shadowed;
        };
        broken_by(flip, " exactly");
    }
}

#[test]
fn changed_frames_and_inputs_are_found() {
    broken_by(|p| p.frames[0].camera.clip_from_world[1][3] += 1e-6, "not the matrix of the scene's camera");
    broken_by(|p| p.frames[0].camera.width = 161, "the film is 161x90 in the plan, 160x90 in the job");
    broken_by(|p| p.frames[0].lights[0].direction = Some([0.0, -1.0, 0.0]), "are not those of the scene's light");
    broken_by(|p| p.frames.truncate(1), "the plan has frames [30], its job asks for [30, 80]");
    broken_by(|p| p.frames[1].lights.truncate(1), "the plan has lights [\"sun\"], ");
    broken_by(|p| p.origin = [1.0, 0.0, 0.0], "origin is [1.0, 0.0, 0.0] in the plan");
    broken_by(|p| p.job.inputs[0].sha256 = "00".repeat(32), "not what the plan was made from");
    broken_by(|p| p.job.inputs.clear(), "the plan has no hash of it");
    broken_by(|p| p.job.job.quality.epsilon = Some(2.0), "job.quality.epsilon: ");

    let mut plan = MEASURED.clone();
    plan.summary.texels -= 1;
    assert!(faults(&verify(&plan)).contains("summary"));
}

/// Methods that give a light several maps: their domains go to the file and back, and the counts hold.
#[test]
fn domains_survive_the_file() {
    for (method, kind) in [("separating-plane", "half-space"), ("cascades", "view-depth"), ("faces", "intersection")] {
        let plan = plan_courtyard(&format!("[solver]\nmethod = '{method}'\n"));
        let text = plan::to_text(&plan, Format::Toml).unwrap();
        assert!(text.contains(&format!("kind = \"{kind}\"")), "{method}: no {kind} in\n{text}");
        let found = verify(&plan::parse(&text, Format::Toml, Path::new("plan")).unwrap());
        assert_eq!(faults(&found), "", "{method}");
    }
}
