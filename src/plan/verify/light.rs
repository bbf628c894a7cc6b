//! One light of one frame: measured again, and compared with what the plan says of it.

use super::super::remeasure::{Remeasured, Seeing, remeasure};
use super::super::seen::seen_on_film;
use super::super::witnesses::lacking;
use super::super::{LightPlan, MapPlan, Measured, Status, Tried};
use super::{LightCheck, Outcome, claims, restated, units, witness};
use crate::job::Job;
use crate::math::first_holding;
use crate::measure::{Drawn, Outside, Receivers, Verdict, edge_distance, footprint};
use crate::resolution::Bound;
use crate::scene::{Light, VisibilitySource};
use crate::visibility::EDGE_ON_DEGREES;
use glam::DVec3;

/// Reasons listed in full; more are counted.
const LISTED: usize = 3;

/// Relative difference that is none of a bound's value: of footprints, finite differences which amplify roundings, and
/// another system's sine in the camera; of distances between pixels, far less.
const VALUE_ACCURACY: f64 = 1e-6;

/// Checks the entry of a light; what was measured, where its maps can be drawn.
pub(super) fn check(
    seeing: &Seeing,
    frame: i64,
    entry: &LightPlan,
    light: &Light,
    job: &Job,
) -> (LightCheck, Option<Remeasured>) {
    let of_pixels = seeing.view.film.pixels() as u64;
    let mut check = unchecked(frame, entry, of_pixels);
    check.reasons.extend(claims::of_a_light(entry, light));
    let got = entry.error.as_ref().filter(|_| entry.budget.is_some()).and_then(|e| e.measured.as_ref());
    match got.map(|m| m.misclassified as f64 / m.of_pixels as f64) {
        None if entry.epsilon != job.quality.epsilon() => {
            check.reasons.push(format!("epsilon is {}, {} in the job", entry.epsilon, job.quality.epsilon()));
        }
        Some(got) if entry.epsilon != got => {
            check.reasons.push(format!("epsilon is {}, {got} of the image is wrong", entry.epsilon));
        }
        _ => {}
    }
    let measured = match remeasure(seeing, light, &entry.maps, &job.map, None) {
        Ok(measured) => measured,
        Err(error) => {
            check.reasons.push(error.to_string());
            return (check, None);
        }
    };
    check.measured = Some(measured.verdict.certain.wrong());
    check.uncertain = Some(measured.verdict.uncertain);
    check.reasons.extend(status_faults(entry, &measured.receivers, job));
    check.reasons.extend(domain_fault(&measured.receivers, &measured.drawn, job));
    check.reasons.extend(count_faults(seeing, entry, &measured.verdict, of_pixels, job));
    check.reasons.extend(restated::faults(entry, light, &measured.receivers, &measured.drawn, job));
    if knew_pixels(job) && !entry.maps.is_empty() {
        let seen = seen_on_film(seeing.tracer, seeing.view, seeing.camera, &measured.receivers);
        check.reasons.extend(units::faults(entry, light, &seen));
    }
    let at_quantile = at_quantile(seeing, &measured, job);
    check.reasons.extend(at_quantile.and_then(|now| value_fault(entry, now, job)));
    witnesses(&mut check, entry, |point| Some(witness::is_shadowed(seeing, light, point)));
    settle(&mut check, entry, &measured.verdict, at_quantile, job);
    (check, Some(measured))
}

/// The check of an entry, with nothing checked.
pub(super) fn unchecked(frame: i64, entry: &LightPlan, of_pixels: u64) -> LightCheck {
    LightCheck {
        frame,
        light: entry.light.clone(),
        sizes: entry.maps.iter().map(|m| [m.width, m.height]).collect(),
        planned: entry.error.as_ref().and_then(|e| e.measured.as_ref()).map(|m| m.misclassified),
        measured: None,
        uncertain: None,
        flicker: None,
        of_pixels,
        epsilon: entry.epsilon,
        witnesses_held: 0,
        witnesses: entry.maps.iter().map(|m| m.witnesses.len() as u64).sum(),
        outcome: Outcome::Broken,
        reasons: Vec::new(),
    }
}

/// Checks the witnesses of an entry. `is_shadowed` is the exact answer at a point, where it is known.
pub(super) fn witnesses(check: &mut LightCheck, entry: &LightPlan, is_shadowed: impl Fn(DVec3) -> Option<bool>) {
    let of_map = |(k, map): (usize, &MapPlan)| {
        let faults = map.witnesses.iter().filter_map(|w| witness::fault(entry, k, w, &is_shadowed));
        faults.collect::<Vec<String>>()
    };
    let faults: Vec<String> = entry.maps.iter().enumerate().flat_map(of_map).collect();
    check.witnesses_held = check.witnesses - faults.len() as u64;
    check.reasons.extend(entry.maps.iter().enumerate().filter_map(set_fault));
    let more = faults.len().saturating_sub(LISTED);
    check.reasons.extend(faults.into_iter().take(LISTED));
    if more > 0 {
        check.reasons.push(format!("{more} more witnesses do not hold"));
    }
}

/// A map has witnesses enough, and not coplanar, or says why not.
fn set_fault((k, map): (usize, &MapPlan)) -> Option<String> {
    match (lacking(&map.witnesses), &map.witnesses_reason) {
        (Some(lack), None) => Some(format!("map {k} has {lack}, and does not say why")),
        (None, Some(_)) => {
            Some(format!("map {k} gives a reason why its witnesses lack something, and they lack nothing"))
        }
        _ => None,
    }
}

/// Whether a plan was made knowing every pixel, by rays or from images; otherwise it was made on the planning grid, and the
/// bound alone judges it.
pub(super) fn knew_pixels(job: &Job) -> bool {
    job.quality.measure.measures() || job.visibility.source == VisibilitySource::Aov
}

/// Whether the status is one that film-resolution visibility allows, and goes with the maps and flags beside it.
pub(super) fn status_faults(entry: &LightPlan, receivers: &Receivers, job: &Job) -> Vec<String> {
    let mut faults = Vec::new();
    let needed = receivers.needing(job.map.outside);
    let has_maps = matches!(entry.status, Status::Planned | Status::NotMet);
    if has_maps == entry.maps.is_empty() || has_maps != entry.error.is_some() {
        faults.push(format!("status {:?} does not go with {} maps", entry.status, entry.maps.len()));
    }
    if knew_pixels(job) {
        let found = match (receivers.is_empty(), needed) {
            (true, _) => Some(Status::Unlit),
            (false, 0) => Some(Status::NoVisibleShadow),
            _ => None,
        };
        let says = matches!(entry.status, Status::Unlit | Status::NoVisibleShadow).then_some(entry.status);
        if found != says {
            faults.push(format!(
                "status is {:?}, but {} pixels face the light and a map is needed for {needed} of them",
                entry.status,
                receivers.len()
            ));
        }
    }
    if let Some(error) = &entry.error
        && error.met != (entry.status == Status::Planned)
    {
        faults.push(format!("error.met is {}, but the status is {:?}", error.met, entry.status));
    }
    faults
}

/// Together the domains hold every pixel whose answer is not that of `outside`, where the plan was made knowing the pixels.
pub(super) fn domain_fault(receivers: &Receivers, drawn: &[Drawn], job: &Job) -> Option<String> {
    if drawn.is_empty() || !knew_pixels(job) {
        return None;
    }
    let needs = job.map.outside == Outside::Lit;
    let in_none = |point: DVec3| first_holding(drawn.iter().map(|d| &d.domain), point).is_none();
    let left_out = receivers.positions_where(needs).into_iter().filter(|p| in_none(*p)).count();
    (left_out > 0).then(|| format!("{left_out} pixels that need a map lie in no domain"))
}

/// Compares every measured number of the plan, and the certificate of the chosen size with the sizes tried.
fn count_faults(seeing: &Seeing, entry: &LightPlan, now: &Verdict, of_pixels: u64, job: &Job) -> Vec<String> {
    let mut faults = Vec::new();
    let Some(error) = &entry.error else { return faults };
    let Some(plan) = &error.measured else {
        if job.quality.measure.measures() {
            faults.push("error.measured is missing, and the job measures".to_owned());
        }
        return faults;
    };
    let counts = [
        ("misclassified", plan.misclassified, now.certain.wrong()),
        ("false_lit", plan.false_lit, now.certain.false_lit),
        ("false_shadow", plan.false_shadow, now.certain.false_shadow),
        ("uncertain", plan.uncertain, now.uncertain),
        ("of_pixels", plan.of_pixels, of_pixels),
        ("edge + self_shadow", plan.edge.saturating_add(plan.self_shadow), now.certain.wrong() + now.uncertain),
    ];
    for (key, planned, found) in counts {
        if planned != found {
            faults.push(format!("{key} is {planned} in the plan, {found} measured again"));
        }
    }
    let settings = [
        ("ray_offset_m", plan.ray_offset_m, seeing.offset.metres),
        ("larger_ray_offset_m", plan.larger_ray_offset_m, seeing.offset.uncertain().metres),
        ("edge_on_degrees", plan.edge_on_degrees, EDGE_ON_DEGREES),
    ];
    for (key, planned, found) in settings {
        if planned != found {
            faults.push(format!("{key} is {planned} in the plan, {found} here"));
        }
    }
    faults.extend(certificate_fault(entry, plan, error.met, of_pixels, job));
    faults
}

/// The chosen size stands among those tried with the same counts; and of one map, when it meets, all larger ones tried
/// meet and the next smaller one tried does not.
fn certificate_fault(entry: &LightPlan, plan: &Measured, met: bool, of_pixels: u64, job: &Job) -> Option<String> {
    let first = entry.maps.first()?;
    let tried = &entry.error.as_ref()?.tried;
    let is_chosen = |t: &Tried| {
        [t.width, t.height] == [first.width, first.height]
            && [t.misclassified, t.uncertain] == [plan.misclassified, plan.uncertain]
    };
    if !tried.iter().any(is_chosen) {
        return Some(format!("{}x{} with these counts is not among the sizes tried", first.width, first.height));
    }
    // Within a budget no size is the smallest; and with reprojection these counts do not judge.
    let otherwise = entry.budget.is_some() || entry.reprojected.is_some();
    if entry.maps.len() > 1 || !met || job.quality.bound != Bound::Misclassified || otherwise {
        return None;
    }
    let limit = job.quality.epsilon() * of_pixels as f64;
    let meets = |t: &Tried| {
        let certain = crate::measure::Counts { false_lit: t.misclassified, ..Default::default() };
        Verdict { certain, uncertain: t.uncertain }.meets(limit)
    };
    let texels = |t: &Tried| u64::from(t.width) * u64::from(t.height);
    if let Some(over) = tried.iter().find(|t| texels(t) > first.texels() && !meets(t)) {
        return Some(format!("{}x{} was tried, is larger than the map, and is over", over.width, over.height));
    }
    // Of a segment one frame needs the size; the others may meet smaller ones.
    if entry.temporal.as_ref().is_some_and(|t| t.decided_by.is_some() && t.drawn_at.or(t.reused_from).is_some()) {
        return None;
    }
    let next = tried.iter().filter(|t| texels(t) < first.texels()).max_by_key(|t| texels(t));
    next.filter(|t| meets(t)).map(|t| format!("{}x{} was tried, is smaller than the map, and meets", t.width, t.height))
}

/// The value of a bound at the quantile, pixels, from the maps as drawn; `None` for a bound that counts pixels.
fn at_quantile(seeing: &Seeing, measured: &Remeasured, job: &Job) -> Option<f64> {
    let Remeasured { receivers, drawn, wrong, .. } = measured;
    let Seeing { tracer, camera, view, .. } = *seeing;
    match job.quality.bound {
        Bound::Misclassified => None,
        Bound::Displacement => Some(edge_distance(receivers, wrong, view.film, job.quality.quantile)),
        Bound::Footprint => {
            let surface = |pixel: usize| view.surface(tracer, camera, pixel);
            Some(footprint(surface, view.film, camera, receivers, drawn, job.quality.quantile))
        }
    }
}

/// Compares the value of a bound with the plan's. A value that is not finite has no number in a plan.
fn value_fault(entry: &LightPlan, now: f64, job: &Job) -> Option<String> {
    let plan = entry.error.as_ref()?.measured.as_ref()?;
    let (key, planned) = match job.quality.bound {
        Bound::Misclassified => return None,
        Bound::Displacement => ("displacement", plan.displacement),
        Bound::Footprint => ("footprint", plan.footprint),
    };
    let planned = planned.unwrap_or(f64::INFINITY);
    let same = planned == now || (planned - now).abs() <= VALUE_ACCURACY * now;
    (!same || planned.is_infinite() != now.is_infinite())
        .then(|| format!("{key} is {planned} pixels in the plan, {now} measured again"))
}

/// The outcome, from the faults found and the bound, whose value now is `at_quantile` where it counts no pixels.
fn settle(check: &mut LightCheck, entry: &LightPlan, now: &Verdict, at_quantile: Option<f64>, job: &Job) {
    let measured = entry.error.as_ref().and_then(|e| e.measured.as_ref());
    let no_map_needed = matches!(entry.status, Status::Unlit | Status::NoVisibleShadow);
    let holds = match at_quantile {
        // Within a budget its limits are the bound; they are checked for the plan as a whole.
        None if entry.budget.is_some() => entry.met(),
        // Judged by what reprojection leaves; that is checked across frames.
        None if entry.reprojected.is_some() && job.lookup.is_temporal() => entry.met(),
        None => entry.status != Status::Inapplicable && now.meets(check.epsilon * check.of_pixels as f64),
        Some(_) if no_map_needed => now.certain.wrong() == 0,
        Some(value) => entry.status != Status::Inapplicable && value <= check.epsilon,
    };
    if measured.is_some() && entry.met() != holds {
        let word = |met: bool| if met { "met" } else { "not met" };
        check.reasons.push(format!("the bound is {} in the plan, {} here", word(entry.met()), word(holds)));
    }
    check.outcome = match (check.reasons.is_empty(), holds) {
        (false, _) => Outcome::Broken,
        (true, true) => Outcome::Holds,
        (true, false) => Outcome::NotMet,
    };
    if check.outcome == Outcome::NotMet {
        let limit = match at_quantile {
            None => format!("{} of {} pixels are allowed", check.epsilon * check.of_pixels as f64, check.of_pixels),
            Some(_) => format!("{} pixels are allowed", check.epsilon),
        };
        check.reasons.push(match &entry.reason {
            Some(reason) => format!("not met, as the plan says: {reason}"),
            None => match at_quantile {
                Some(value) => format!("the bound does not hold: it is at {value:.3} pixels, {limit}"),
                None => format!(
                    "the bound does not hold: {} and {} uncertain are wrong, {limit}",
                    now.certain.wrong(),
                    now.uncertain
                ),
            },
        });
    }
}
