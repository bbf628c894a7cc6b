//! Budgets: limits hold, gains are equal, the plan is verified; the curve between budget and epsilon.

#![expect(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

mod boxes;
#[path = "scene/fixture.rs"]
#[expect(dead_code, reason = "shared with the scene tests, which use more of it")]
mod fixture;
mod watching;

use boxes::Boxes;
use lixel::job;
use lixel::plan::{self, Plan, Status, Verification, budget_curves};
use std::path::Path;
use watching::watched;

/// A floor with posts.
fn scene(folder: &Path) {
    let around = (0..9_u8).map(f32::from).map(|f| [(f * 2.4).sin() * 4.0, (f * 1.7).cos() * 4.0]);
    Boxes::posts([12.0, 12.0], 0.5, around).write(folder);
}

const WALK: &str = "
scene = 'scene.glb'
[frames]
range = '1-4'
[image]
size = [160, 90]
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
[[light]]
name = 'lamp'
kind = 'spot'
position = [-3.0, 6.0, 2.0]
direction = [0.4, -1.0, -0.3]
cone = 40.0
[camera]
look_at = [0.0, 0.5, 0.0]
[[camera.key]]
frame = 1
position = [7.0, 3.0, 4.0]
[[camera.key]]
frame = 4
position = [6.0, 2.8, 5.5]
";

fn load(folder: &Path, overrides: &str) -> job::LoadedJob {
    std::fs::write(folder.join("job.toml"), WALK).unwrap();
    job::load(&folder.join("job.toml"), &overrides.parse().unwrap()).unwrap()
}

fn planned(folder: &Path, overrides: &str) -> Plan {
    watched(|watch| plan::make(&load(folder, overrides), folder, false, watch)).unwrap()
}

fn verify(plan: &Plan, folder: &Path) -> (Verification, Vec<String>) {
    let found = watched(|watch| plan::verify(plan, folder, watch)).unwrap();
    let reasons = found.lights.iter().flat_map(|l| l.reasons.clone()).chain(found.problems.clone()).collect();
    (found, reasons)
}

fn wrong_of(plan: &Plan, light: &str) -> u64 {
    let entries = plan.frames.iter().flat_map(|f| &f.lights).filter(|l| l.light == light);
    entries.filter_map(|l| l.error.as_ref()?.measured.as_ref()).map(|m| m.misclassified).sum()
}

#[test]
fn every_mode_keeps_its_limits_with_equal_gains_and_is_verified() {
    let folder = tempfile::tempdir().unwrap();
    scene(folder.path());
    for (overrides, drawn, resident) in [
        ("budget = { texels_total = 60000 }", 60_000, u64::MAX),
        ("budget = { texels_per_frame = 20000 }", u64::MAX, 20_000),
        ("budget = { bytes = 100000 }\nshot = { temporal = 'per-frame' }", u64::MAX, 25_000),
        (
            "budget = { texels_total = 80000, texels_per_frame = 30000 }\nshot = { temporal = 'per-frame' }",
            80_000,
            30_000,
        ),
        ("budget = { texels_total = 60000 }\nshot = { temporal = 'hysteresis' }", 60_000, u64::MAX),
    ] {
        let plan = planned(folder.path(), overrides);
        let (found, reasons) = verify(&plan, folder.path());
        assert!(found.passed, "{overrides}: {reasons:#?}");
        let budget = plan.budget.clone().unwrap();
        assert!(plan.summary.met && budget.held);
        assert!(budget.texels_drawn <= drawn && budget.texels_resident <= resident, "{overrides}: {budget:?}");
        assert!(budget.imbalance.is_some_and(|i| i < 1.05), "{overrides}: {budget:?}");
        assert_eq!(budget.misclassified, wrong_of(&plan, "sun") + wrong_of(&plan, "lamp"));
        let limits = [(budget.texels_drawn, drawn), (budget.texels_resident, resident)];
        assert!(limits.iter().any(|(spent, most)| *spent as f64 > 0.97 * *most as f64), "{overrides}: {budget:?}");
        for entry in plan.frames.iter().flat_map(|f| &f.lights) {
            let measured = entry.error.as_ref().unwrap().measured.as_ref().unwrap();
            assert_eq!(entry.epsilon, measured.misclassified as f64 / (160.0 * 90.0));
        }
    }
}

#[test]
fn importance_moves_texels_and_a_job_with_one_thread_has_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    scene(folder.path());
    let budget = "frames = { range = '1' }\nbudget = { texels_total = 20000 }";
    let even = planned(folder.path(), budget);
    let mut job = load(folder.path(), budget);
    job.job.light[1].importance = Some(20.0);
    let favoured = watched(|watch| plan::make(&job, folder.path(), false, watch)).unwrap();
    assert!(wrong_of(&favoured, "lamp") < wrong_of(&even, "lamp"));
    assert!(wrong_of(&favoured, "sun") > wrong_of(&even, "sun"));
    assert_eq!(favoured.frames[0].lights[1].budget.as_ref().unwrap().importance, 20.0);
    assert!(verify(&favoured, folder.path()).0.passed);
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let again = alone.install(|| planned(folder.path(), budget));
    let text = |plan: &Plan| plan::to_text(plan, plan::Format::Json).unwrap();
    assert_eq!(text(&even), text(&again));
    assert_eq!(plan::parse(&text(&even), plan::Format::Json, Path::new("a.json")).unwrap(), even);
}

#[test]
fn a_budget_below_the_smallest_maps_is_not_met_and_says_so() {
    let folder = tempfile::tempdir().unwrap();
    scene(folder.path());
    let plan = planned(folder.path(), "budget = { texels_total = 300 }");
    assert!(!plan.summary.met && !plan.budget.as_ref().unwrap().held);
    let entry = &plan.frames[0].lights[0];
    assert_eq!(entry.status, Status::NotMet);
    let reason = entry.reason.as_ref().unwrap();
    assert!(reason.contains("budget.texels_total = 300") && reason.contains("map.min = 16"), "{reason}");
    let (found, reasons) = verify(&plan, folder.path());
    assert!(!found.passed && reasons.iter().all(|r| r.contains("not met, as the plan says")), "{reasons:#?}");
}

#[test]
fn verify_finds_forged_sizes_gains_and_sums() {
    let folder = tempfile::tempdir().unwrap();
    scene(folder.path());
    let plan = planned(folder.path(), "frames = { range = '1' }\nbudget = { texels_total = 20000 }");
    let forged = |change: &dyn Fn(&mut Plan), word: &str| {
        let mut plan = plan.clone();
        change(&mut plan);
        let (found, reasons) = verify(&plan, folder.path());
        assert!(!found.passed && reasons.iter().any(|r| r.contains(word)), "{word}: {reasons:#?}");
    };
    forged(&|p| p.frames[0].lights[0].budget.as_mut().unwrap().price *= 1.01, "from the sizes tried");
    let tripled = |p: &mut Plan| {
        let tried = &mut p.frames[0].lights[0].error.as_mut().unwrap().tried;
        tried.iter_mut().for_each(|t| t.misclassified *= 3);
    };
    forged(&tripled, "from the sizes tried");
    forged(&|p| p.frames[0].lights[0].budget = None, "no share of the budget");
    forged(&|p| p.budget.as_mut().unwrap().misclassified -= 1, "budget does not say");
    forged(&|p| p.frames[0].lights[0].epsilon *= 0.5, "of the image is wrong");
    let lowered = |p: &mut Plan| {
        p.job.job.budget.texels_total = Some(19_000);
        p.budget.as_mut().unwrap().held = false;
    };
    forged(&|p| p.job.job.budget.texels_total = Some(19_000), "budget does not say");
    forged(&lowered, "the limits of the budget are passed");
}

#[test]
fn the_curve_falls_and_half_the_texels_by_gains_is_better_than_halving_alike() {
    let folder = tempfile::tempdir().unwrap();
    scene(folder.path());
    // A light that matters more than its epsilon says: sizes by epsilon are far from equal gains, whatever a step of sizes does.
    let mut job = load(folder.path(), "");
    job.job.light[1].importance = Some(10.0);
    let curves = watched(|watch| budget_curves(&job, watch)).unwrap();
    assert_eq!((curves.frames, curves.lights.len()), (4, 2));
    for pair in curves.all.windows(2) {
        assert!(pair[1].texels_drawn > pair[0].texels_drawn && pair[1].misclassified < pair[0].misclassified);
        assert!(pair[1].gain <= pair[0].gain);
    }
    let named = |name: &str| curves.plans.iter().find(|p| p.name == name).unwrap();
    let (plan, alike, gains) = (named("by epsilon"), named("half, every map alike"), named("half, by gains"));
    assert!(alike.texels_drawn * 2 <= plan.texels_drawn && gains.texels_drawn <= alike.texels_drawn);
    assert!(gains.weighted < alike.weighted, "{gains:?} {alike:?}");
    assert!(curves.svg().contains("lamp"));
}

#[test]
fn a_budget_goes_with_measured_wrong_pixels_and_either_goal_drops_the_other() {
    let folder = tempfile::tempdir().unwrap();
    scene(folder.path());
    std::fs::write(folder.path().join("job.toml"), WALK).unwrap();
    let refused = |overrides: &str| {
        job::load(&folder.path().join("job.toml"), &overrides.parse().unwrap()).unwrap_err().to_string()
    };
    let with = |rest: &str| refused(&format!("budget = {{ bytes = 4000 }}\n{rest}"));
    assert!(with("quality = { measure = 'never' }").contains("measured errors"));
    assert!(with("quality = { bound = 'footprint', epsilon = 1.0 }").contains("wrong pixels fewest"));
    assert!(with("shot = { temporal = 'snapped' }\nmap = { shape = 'rectangle' }").contains("hang on their sizes"));
    assert!(with("shot = { one_size = true }").contains("one_size"));
    assert!(refused("budget = { bytes = 3 }").contains("budget.bytes"));
    let both = format!("{WALK}\n[budget]\ntexels_total = 5\n");
    std::fs::write(folder.path().join("job.toml"), both).unwrap();
    let of =
        |overrides: &str| job::load(&folder.path().join("job.toml"), &overrides.parse().unwrap()).unwrap().job.budget;
    assert_eq!(of("").texels_total, Some(5));
    assert!(!of("quality = { epsilon = 0.1 }").is_given());
    let replaced = of("budget = { bytes = 8 }");
    assert_eq!((replaced.texels_total, replaced.bytes), (None, Some(8)));
}
