//! Plans for renderers that blend answers over time, on the courtyard.

#![expect(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

mod watching;

use lixel::job;
use lixel::plan::{self, LightPlan, Plan, PlanError, Verification};
use std::path::Path;
use watching::watched;

/// One light of the courtyard, 240 x 135, frame by frame, at most 3 % wrong.
fn planned(folder: &Path, overrides: &str) -> Result<Plan, PlanError> {
    let text = format!(
        "scene = '{}/examples/courtyard/courtyard.glb'\nframes = {{ range = '30-33' }}\nimage = {{ size = [240, 135] }}\n\
         light = [{{ name = 'lamp' }}]\nquality = {{ epsilon = 0.03 }}\nshot = {{ temporal = 'per-frame' }}",
        env!("CARGO_MANIFEST_DIR")
    );
    std::fs::write(folder.join("job.toml"), text).unwrap();
    let job = job::load(&folder.join("job.toml"), &overrides.parse().unwrap()).unwrap();
    watched(|watch| plan::make(&job, folder, false, watch))
}

fn verify(plan: &Plan, folder: &Path) -> Verification {
    watched(|watch| plan::verify(plan, folder, watch)).unwrap()
}

fn entries(plan: &Plan) -> Vec<LightPlan> {
    plan.frames.iter().flat_map(|f| f.lights.clone()).collect()
}

/// Under matrices that change, blending leaves fewer wrong pixels and less flicker of the same maps, so that smaller ones do.
#[test]
fn a_renderer_that_blends_over_time_is_planned_with_smaller_maps() {
    let folder = tempfile::tempdir().unwrap();
    let alone = planned(folder.path(), "").unwrap();
    let blended = planned(folder.path(), "lookup = { temporal = 'reprojection' }").unwrap();
    assert!(alone.summary.met && blended.summary.met);
    let (drawn, plain) = (blended.summary.texels_drawn, alone.summary.texels_drawn);
    assert!(drawn * 10 < plain * 8, "{drawn} of {plain}");
    let shown: Vec<_> = entries(&blended).into_iter().map(|l| l.reprojected.unwrap()).collect();
    assert!(shown.iter().all(|s| s.met && s.misclassified as f64 <= 0.03 * (240.0 * 135.0)));
    let flicker: u64 = shown.iter().filter_map(|s| s.flicker).map(|f| f.still).sum();
    assert!(flicker * 2 < alone.summary.flicker.unwrap(), "{flicker}, {:?}", alone.summary);
    assert!(shown[0].flicker.is_none() && blended.conventions.filter.contains("reprojection"));
    assert!(entries(&alone)[0].reprojected.is_none() && !alone.conventions.filter.contains("reprojection"));
    let found = verify(&blended, folder.path());
    assert!(found.passed, "{:?}", found.lights.iter().map(|l| l.reasons.clone()).collect::<Vec<_>>());

    let mut forged = blended.clone();
    forged.frames[2].lights[0].reprojected.as_mut().unwrap().misclassified -= 1;
    let found = verify(&forged, folder.path());
    assert!(found.lights.iter().any(|l| l.reasons.iter().any(|r| r.starts_with("reprojected is"))));
}

#[test]
fn frames_have_to_follow_each_other() {
    let folder = tempfile::tempdir().unwrap();
    let job = "lookup = { temporal = 'reprojection' }\nframes = { range = '30-34x2' }";
    let refused = planned(folder.path(), job).unwrap_err();
    assert!(refused.to_string().contains("frame 32 follows frame 30"), "{refused}");
}

/// Where neither camera nor maps move, every frame answers alike.
#[test]
fn blending_adds_nothing_to_what_stands_still() {
    let folder = tempfile::tempdir().unwrap();
    let still = "lookup = { temporal = 'reprojection' }\nshot = { temporal = 'shot' }\n\
                 animation = []\nframes = { range = '1-3' }";
    let plan = planned(folder.path(), still).unwrap();
    assert!(verify(&plan, folder.path()).passed);
    for entry in entries(&plan) {
        let (measured, shown) = (entry.error.unwrap().measured.unwrap(), entry.reprojected.unwrap());
        assert!(measured.misclassified > 100);
        assert_eq!((shown.misclassified, shown.uncertain), (measured.misclassified, measured.uncertain));
        assert!(shown.flicker.is_none_or(|f| f.still + f.moved == 0));
    }
}
