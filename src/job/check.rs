//! The values a job may have. Types are serde's business; ranges and combinations are checked here.

mod camera;
mod images;
mod settings;

use std::collections::BTreeSet;

use super::{Job, is_scene_file};
use crate::methods::SolverParams;
use crate::resolution::SIZE_MAX;
use crate::scene::{FILM_PIXELS_MAX, LightKindName, LightParams, VisibilitySource};

/// A value that a job may not have.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// Where: `quality.epsilon`, `light[1].cone`.
    pub key: String,
    /// What is wrong, with the value.
    pub message: String,
    /// What to do about it.
    pub help: String,
}

fn problem(key: impl Into<String>, message: impl Into<String>, help: impl Into<String>) -> Problem {
    Problem { key: key.into(), message: message.into(), help: help.into() }
}

/// An inclusive or half-open interval in words, and whether the value lies in it. NaN lies in none.
fn require(ok: bool, key: &str, value: impl std::fmt::Display, allowed: &str) -> Result<(), Problem> {
    if ok { Ok(()) } else { Err(problem(key, format!("{value} is out of range"), format!("allowed is {allowed}"))) }
}

fn finite(key: &str, values: &[f64]) -> Result<(), Problem> {
    match values.iter().find(|v| !v.is_finite()) {
        Some(bad) => Err(problem(key, format!("{bad} is not a finite number"), "give a finite number")),
        None => Ok(()),
    }
}

/// A direction or quaternion: finite and not zero.
fn nonzero(key: &str, values: &[f64]) -> Result<(), Problem> {
    finite(key, values)?;
    if values.iter().all(|&v| v == 0.0) {
        return Err(problem(key, "all components are zero", "give at least one that is not"));
    }
    Ok(())
}

/// Checks every value of a job.
///
/// # Errors
/// The first problem, in the order of the job's tables.
pub fn check(job: &Job) -> Result<(), Problem> {
    scene(job)?;
    images::check(job)?;
    if let Some(fps) = job.frames.fps {
        require(fps > 0.0 && fps.is_finite(), "frames.fps", fps, "a finite number above 0")?;
    }
    if let Some([width, height]) = job.image.size {
        for side in [width, height] {
            require((1..=SIZE_MAX).contains(&side), "image.size", side, &format!("1 to {SIZE_MAX} pixels"))?;
        }
        let pixels = u64::from(width) * u64::from(height);
        let limit = format!("at most {FILM_PIXELS_MAX} pixels in all; render in tiles");
        require(pixels <= FILM_PIXELS_MAX, "image.size", format!("{width} x {height}"), &limit)?;
    }
    camera::check(&job.camera)?;
    let mut names = BTreeSet::new();
    for (i, params) in job.light.iter().enumerate() {
        light(&format!("light[{i}]"), params)?;
        if !names.insert(params.name.as_str()) {
            let message = format!("`{}` is the name of an earlier light", params.name);
            return Err(problem(format!("light[{i}].name"), message, "give every light a name of its own"));
        }
    }
    settings::quality(&job.quality)?;
    settings::map(&job.map)?;
    settings::texels(&job.map, &job.solver)?;
    settings::sampling(&job.sampling)?;
    settings::solver(&job.solver)?;
    settings::shot(&job.shot, &job.map)?;
    settings::choosing(job)?;
    settings::lookup(job)?;
    settings::budget(job)
}

/// Checks `[solver]` alone.
///
/// # Errors
/// The first problem, in the order of the keys.
pub fn check_solver(solver: &SolverParams) -> Result<(), Problem> {
    settings::solver(solver)
}

fn scene(job: &Job) -> Result<(), Problem> {
    if job.scene.is_empty() && job.visibility.source == VisibilitySource::Scene {
        return Err(problem("scene", "no scene file is named", "add `scene = \"file.gltf\"` at the top of the job"));
    }
    for (i, file) in job.scene.iter().enumerate() {
        if !is_scene_file(file.path()) {
            let message = format!("`{}` is not a scene file", file.path().display());
            return Err(problem(format!("scene[{i}]"), message, "name a .gltf, .glb or .obj file"));
        }
        for row in file.transform.iter().flatten() {
            finite(&format!("scene[{i}].transform"), row)?;
        }
        if file.transform.is_some_and(|rows| rows[3] != [0.0, 0.0, 0.0, 1.0]) {
            let message = "the last row is not 0 0 0 1";
            let help = "give 4 rows of 4 for column vectors: translations go into the last column";
            return Err(problem(format!("scene[{i}].transform"), message, help));
        }
    }
    Ok(())
}

fn light(key: &str, params: &LightParams) -> Result<(), Problem> {
    let name = &params.name;
    if name.is_empty() {
        return Err(problem(format!("{key}.name"), "the name is empty", "give the light a name"));
    }
    use LightKindName::{Directional, Point, Spot};
    // Which keys each kind needs, and which it may have; a light without a kind is a reference by name.
    let placement = [
        ("direction", params.direction.is_some(), [Some(Directional), Some(Spot)]),
        ("position", params.position.is_some(), [Some(Point), Some(Spot)]),
        ("cone", params.cone.is_some(), [Some(Spot), None]),
    ];
    for (part, given, kinds) in placement {
        let at = format!("{key}.{part}");
        match params.kind {
            None if given => {
                let message = format!("the light `{name}` has a {part} but no kind");
                return Err(problem(
                    at,
                    message,
                    "add `kind`, or leave only the name to take the light from the scene's files",
                ));
            }
            Some(kind) if given && !kinds.contains(&Some(kind)) => {
                return Err(problem(at, format!("the {} light `{name}` has no {part}", word(kind)), "remove this key"));
            }
            Some(kind) if !given && kinds.contains(&Some(kind)) => {
                let message = format!("the {} light `{name}` needs a {part}", word(kind));
                return Err(problem(at, message, format!("add `{part} = …`")));
            }
            _ => {}
        }
    }
    if let Some(range) = params.range {
        let at = format!("{key}.range");
        if !matches!(params.kind, Some(Point | Spot)) {
            return Err(problem(
                at,
                format!("only point and spot lights have a range, `{name}` is neither"),
                "remove it",
            ));
        }
        require(range > 0.0 && range.is_finite(), &at, range, "a finite number of metres above 0")?;
    }
    if let Some(direction) = params.direction {
        nonzero(&format!("{key}.direction"), &direction)?;
    }
    if let Some(position) = params.position {
        finite(&format!("{key}.position"), &position)?;
    }
    if let Some(importance) = params.importance {
        let allowed = "a finite number of at least 0";
        require(importance >= 0.0 && importance.is_finite(), &format!("{key}.importance"), importance, allowed)?;
    }
    if let Some(cone) = params.cone {
        require(cone > 0.0 && cone <= 90.0, &format!("{key}.cone"), cone, "above 0 and at most 90 degrees")?;
    }
    Ok(())
}

fn word(kind: LightKindName) -> &'static str {
    match kind {
        LightKindName::Directional => "directional",
        LightKindName::Point => "point",
        LightKindName::Spot => "spot",
    }
}
