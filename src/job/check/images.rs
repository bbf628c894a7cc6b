//! `[aov]`, and what goes with `visibility.source = "aov"` only.

use super::{Problem, finite, problem};
use crate::job::Job;
use crate::scene::VisibilitySource;

pub(super) fn check(job: &Job) -> Result<(), Problem> {
    if job.visibility.source == VisibilitySource::Scene {
        return unused(job);
    }
    let Some(aov) = &job.aov else {
        let message = "the job is planned from images, and names none";
        return Err(problem("visibility.source", message, "add `[aov]` with `file = \"render.####.exr\"`"));
    };
    if aov.file.is_empty() {
        return Err(problem("aov.file", "no image is named", "add `file = \"render.####.exr\"`"));
    }
    for (i, file) in aov.file.iter().enumerate() {
        if !file.extension().is_some_and(|e| e.eq_ignore_ascii_case("exr")) {
            let message = format!("`{}` is not an OpenEXR file", file.display());
            return Err(problem(format!("aov.file[{i}]"), message, "name .exr files"));
        }
    }
    match (&aov.depth, &aov.position) {
        (Some(_), Some(_)) => {
            let message = "`depth` and `position` both say where surfaces are";
            return Err(problem("aov.position", message, "keep one of them"));
        }
        (None, None) => {
            let message = "nothing says where surfaces are";
            let help = "add `depth = { layer = \"Z\", kind = \"planar\" }` (or \"distance\"), or `position = { layer = \"P\" }`";
            return Err(problem("aov", message, help));
        }
        _ => {}
    }
    let layers = [
        ("aov.depth.layer", aov.depth.as_ref().map(|d| &d.layer)),
        ("aov.position.layer", aov.position.as_ref().map(|p| &p.layer)),
        ("aov.normal.layer", aov.normal.as_ref().map(|n| &n.layer)),
        ("aov.shadow.layer", Some(&aov.shadow.layer)),
    ];
    if let Some((key, _)) = layers.into_iter().find(|(_, layer)| layer.is_some_and(|l| l.is_empty())) {
        return Err(problem(key, "the name is empty", "name a layer of the images"));
    }
    let several = job.light.len() > 1 || job.light.is_empty();
    if several && !aov.shadow.layer.contains("{light}") && job.light.iter().any(|l| l.aov.is_none()) {
        let message = format!("`{}` would be the layer of every light", aov.shadow.layer);
        let help = "put `{light}` where the light's name goes, or give each [[light]] its `aov`";
        return Err(problem("aov.shadow.layer", message, help));
    }
    for (i, light) in job.light.iter().enumerate() {
        let at = |key: &str| format!("light[{i}].{key}");
        finite(&at("near"), light.near.as_slice())?;
        finite(&at("far"), light.far.as_slice())?;
        if light.aov.as_deref() == Some("") {
            return Err(problem(at("aov"), "the name is empty", "name a layer of the images"));
        }
        if let (Some(near), Some(far)) = (light.near, light.far)
            && far <= near
        {
            return Err(problem(
                at("far"),
                format!("far = {far} is not beyond near = {near}"),
                "raise far or lower near",
            ));
        }
        let directional = light.kind.is_none_or(|kind| kind == crate::scene::LightKindName::Directional);
        if !directional && light.near.is_some_and(|near| near <= 0.0) {
            return Err(problem(at("near"), "a light with a position sees nothing behind it", "give metres above 0"));
        }
    }
    if job.camera.frame_all {
        let message = "there is no geometry to frame";
        return Err(problem("camera.frame_all", message, "remove it: the images have a camera"));
    }
    let drawn = "without geometry no map can be drawn and counted";
    let uses = [
        (job.quality.measure.measures(), "quality.measure", "remove it: planned from images, sizes are predicted"),
        (job.budget.is_given(), "budget", "remove it: planned from images, a light's error has no measured curve"),
        (
            job.lookup.is_temporal(),
            "lookup.temporal",
            "remove it: what a renderer blends over time is measured on maps",
        ),
    ];
    if let Some((_, key, help)) = uses.into_iter().find(|(used, ..)| *used) {
        return Err(problem(key, drawn, help));
    }
    Ok(())
}

/// Keys that mean nothing where geometry is looked at.
fn unused(job: &Job) -> Result<(), Problem> {
    let help = "remove it, or set visibility.source = \"aov\"";
    if job.aov.is_some() {
        return Err(problem("aov", "the job is planned from its scene, not from images", help));
    }
    for (i, light) in job.light.iter().enumerate() {
        let given = [("aov", light.aov.is_some()), ("near", light.near.is_some()), ("far", light.far.is_some())];
        if let Some((key, _)) = given.into_iter().find(|(_, given)| *given) {
            let message = format!("`{key}` of the light `{}` is for planning from images", light.name);
            return Err(problem(format!("light[{i}].{key}"), message, help));
        }
    }
    Ok(())
}
