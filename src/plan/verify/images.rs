//! A plan from a renderer's images, held against the images: nothing is drawn, since nobody knows what to draw.
//!
//! What can be wrong all the same: a shadowed pixel that lies in no map, one that looks a map up outside its depth range, a
//! status that the images do not bear out, witnesses. A footprint takes no casters: under that bound it is measured, and
//! the measured value is what counts.

use super::super::images::receivers;
use super::super::seen::seen_by;
use super::super::{LightPlan, Plan, PlanError, Stage, Watch, domain};
use super::light::{domain_fault, status_faults, unchecked, witnesses};
use super::{LightCheck, Outcome, Verification, claims, restated, units};
use crate::aov::{Images, ImagesFrame};
use crate::job::Job;
use crate::math::{first_holding, matrix_from_rows};
use crate::measure::{Drawn, Outside, Receivers, footprint};
use crate::raster::DepthMap;
use crate::resolution::Bound;
use crate::scene::{Light, Shot};
use glam::DVec3;

/// Checks the lights of all frames.
pub(super) fn look(
    plan: &Plan,
    shot: &Shot,
    images: &Images,
    found: &mut Verification,
    watch: &Watch,
) -> Result<(), PlanError> {
    let total = plan.frames.iter().map(|f| f.lights.len() as u64).sum();
    for planned in &plan.frames {
        let Some(time) = shot.frames.iter().find(|time| time.frame == planned.frame) else { continue };
        let frame = shot.scene.frame(time.time_s)?;
        found.problems.extend(claims::of_a_frame(planned, &frame, shot.film));
        let seen = images.frame(time.frame, &frame.camera, &frame.lights)?;
        for entry in &planned.lights {
            watch.step(Stage::Lights, found.lights.len() as u64, total)?;
            let Some(light) = frame.lights.iter().find(|l| l.name == entry.light) else { continue };
            found.lights.push(check(&seen, planned.frame, entry, light, &plan.job.job));
        }
    }
    watch.step(Stage::Lights, total, total)
}

fn check(seen: &ImagesFrame, frame: i64, entry: &LightPlan, light: &Light, job: &Job) -> LightCheck {
    let film = seen.film.film;
    let mut check = unchecked(frame, entry, film.pixels() as u64);
    check.reasons.extend(claims::of_a_light(entry, light));
    if entry.epsilon != job.quality.epsilon() {
        check.reasons.push(format!("epsilon is {}, {} in the job", entry.epsilon, job.quality.epsilon()));
    }
    if entry.error.as_ref().is_some_and(|error| error.measured.is_some()) || entry.images.is_none() {
        check.reasons.push("the job is planned from images, and the entry does not say so".to_owned());
    }
    if entry.temporal.as_ref().is_some_and(|t| t.reused_from.is_some()) {
        check.reasons.push("its maps are said to be reused, and nobody knows what moved in them".to_owned());
    }
    let receivers = receivers(seen, light);
    let maps: Vec<Drawn> = entry.maps.iter().map(undrawn).collect();
    check.reasons.extend(status_faults(entry, &receivers, job));
    check.reasons.extend(domain_fault(&receivers, &maps, job));
    check.reasons.extend(cover_fault(&receivers, &maps, job));
    check.reasons.extend(restated::faults(entry, light, &receivers, &maps, job));
    let seen_points = seen_by(&receivers, |pixel| seen.film.surface(pixel));
    check.reasons.extend(units::faults(entry, light, &seen_points));
    witnesses(&mut check, entry, |point| shadowed_at(seen, &receivers, light, point));
    let value = (job.quality.bound == Bound::Footprint && !maps.is_empty()).then(|| {
        let surface = |pixel: usize| seen.film.surface(pixel);
        footprint(surface, film, &seen.film.camera, &receivers, &maps, job.quality.quantile)
    });
    let holds = match value {
        Some(value) => value <= check.epsilon,
        None => entry.met(),
    };
    check.outcome = match (check.reasons.is_empty(), holds) {
        (false, _) => Outcome::Broken,
        (true, true) => Outcome::Holds,
        (true, false) => Outcome::NotMet,
    };
    if check.outcome == Outcome::NotMet {
        check.reasons.push(match (value, &entry.reason) {
            (Some(value), _) => format!("the footprint is {value:.3} pixels, {} are allowed", check.epsilon),
            (None, reason) => format!("not met, as the plan says: {}", reason.as_deref().unwrap_or("by prediction")),
        });
    }
    check
}

/// A map of a plan as far as it is known without geometry: no depth in it.
fn undrawn(map: &super::super::MapPlan) -> Drawn {
    Drawn {
        domain: domain::read(&map.domain),
        clip_from_scene: matrix_from_rows(&map.clip_from_world),
        map: DepthMap { width: map.width, height: map.height, depth: Vec::new() },
    }
}

/// Every pixel whose answer is not that of `outside` lies in its map.
fn cover_fault(receivers: &Receivers, maps: &[Drawn], job: &Job) -> Option<String> {
    if maps.is_empty() {
        return None;
    }
    let in_map = |point: DVec3| {
        let Some(k) = first_holding(maps.iter().map(|m| &m.domain), point) else { return true };
        let clip = maps[k].clip_from_scene * point.extend(1.0);
        let inside = |c: f64| c >= -clip.w && c < clip.w;
        clip.w > 0.0 && inside(clip.x) && inside(clip.y)
    };
    let needing = receivers.positions_where(job.map.outside == Outside::Lit);
    let left_out = needing.into_iter().filter(|p| !in_map(*p)).count();
    (left_out > 0).then(|| format!("{left_out} pixels that need a map lie outside it"))
}

/// The answer of the pixel whose point this is. Other points lie between a lit one and the light: nothing is known of them
/// here.
fn shadowed_at(seen: &ImagesFrame, receivers: &Receivers, light: &Light, point: DVec3) -> Option<bool> {
    let film = seen.film.film;
    let (x, y, _) = seen.film.camera.project(film, point)?;
    let inside = x >= 0.0 && y >= 0.0 && x < f64::from(film.width) && y < f64::from(film.height);
    let pixel = inside.then(|| y as u32 * film.width + x as u32)?;
    let at = receivers.pixels.binary_search(&pixel).ok()?;
    (light.reaches(point) && receivers.positions[at] == point).then(|| receivers.shadowed[at])
}
