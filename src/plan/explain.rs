//! Why each light got what it got, in one sentence each, from what the plan says and nothing else.

use super::{LightPlan, MapBias, MapPlan, Measured, Plan, Status, Tried};
use crate::job::Job;
use crate::resolution::{Bound, Measure};

/// One line a light and frame.
pub fn explain(plan: &Plan) -> String {
    let mut text = String::new();
    for frame in &plan.frames {
        for light in &frame.lights {
            text += &format!("frame {}, {}: {}.\n", frame.frame, light.light, sentence(light, &plan.job.job));
        }
    }
    text
}

fn sentence(light: &LightPlan, job: &Job) -> String {
    let reason = light.reason.as_deref().unwrap_or("no reason given");
    match light.status {
        Status::Unlit => format!("unlit, it gets no map: {reason}"),
        Status::NoVisibleShadow => format!("no visible shadow, it gets no map: {reason}"),
        Status::Inapplicable => format!("inapplicable, it gets no map: {reason}"),
        Status::Planned => with_maps(light, job),
        Status::NotMet => format!("{}; {reason}", with_maps(light, job)),
    }
}

/// Status, method and why it is this one, size, the next smaller size, the bias.
fn with_maps(light: &LightPlan, job: &Job) -> String {
    let status = if light.status == Status::Planned { "planned" } else { "not met" };
    let parts = [choice(light), Some(outcome(light, job)), smaller(light, job), bias(light), across(light)];
    let parts: Vec<String> = parts.into_iter().flatten().collect();
    format!("{status}, {}: {}", maps(light), parts.join("; "))
}

/// The maps, by the method that chose them.
fn maps(light: &LightPlan) -> String {
    let Some(first) = light.maps.first() else { return "without a map".to_owned() };
    let whose = if choice(light).is_some() { "" } else { "the job's method " };
    let method = first.method.name();
    let size = format!("{}x{}", first.width, first.height);
    match light.maps.len() {
        1 => format!("one map of {size} by {whose}`{method}`"),
        n => {
            let texels: u64 = light.maps.iter().map(MapPlan::texels).sum();
            format!("{n} maps by {whose}`{method}`, the first {size}, {texels} texels in all")
        }
    }
}

/// Why it is this method, where it was chosen among several.
fn choice(light: &LightPlan) -> Option<String> {
    Some(light.solver.as_ref()?.choice.as_ref()?.reason.clone())
}

/// The error of the chosen size and the bound it was chosen for.
fn outcome(light: &LightPlan, job: &Job) -> String {
    let Some(error) = &light.error else { return "without an error".to_owned() };
    let relation = if error.met { "within" } else { "over" };
    let epsilon = light.epsilon;
    match (&error.measured, job.quality.bound) {
        (Some(m), Bound::Misclassified) => format!(
            "measured {relation} epsilon {epsilon} with {} certain and {} uncertain wrong pixels where {} certain ones are \
             allowed",
            m.misclassified,
            m.uncertain,
            (epsilon * m.of_pixels as f64).floor()
        ),
        (Some(m), bound) => {
            let value = if bound == Bound::Displacement { m.displacement } else { m.footprint };
            format!("measured {relation} epsilon with {} of {epsilon} pixels", pixels(value))
        }
        (None, Bound::Misclassified) => {
            let p = error.predicted.as_ref();
            let (by, wrong) = match p.and_then(|p| p.sampled) {
                Some([certain, _]) => (" by a sample of lookups", certain),
                None => ("", p.map_or(0.0, |p| p.misclassified)),
            };
            format!("predicted {relation} epsilon {epsilon}{by} with {wrong:.0} wrong pixels, nothing measured")
        }
        (None, bound) => {
            let p = error.predicted.as_ref();
            let value = p.and_then(|p| if bound == Bound::Displacement { p.displacement } else { p.footprint });
            format!("predicted {relation} epsilon with {} of {epsilon} pixels, nothing measured", pixels(value))
        }
    }
}

/// The next smaller size tried, and why it is not the map's.
fn smaller(light: &LightPlan, job: &Job) -> Option<String> {
    let (error, first) = (light.error.as_ref()?, light.maps.first()?);
    error.measured.as_ref()?;
    let texels = |t: &Tried| u64::from(t.width) * u64::from(t.height);
    let below = error.tried.iter().filter(|t| texels(t) < first.texels()).max_by_key(|t| texels(t));
    if let Some(t) = below {
        let found = match job.quality.bound {
            Bound::Misclassified => format!("{} certain and {} uncertain", t.misclassified, t.uncertain),
            Bound::Displacement => format!("{} pixels", pixels(t.displacement)),
            Bound::Footprint => format!("{} pixels", pixels(t.footprint)),
        };
        let over = if error.met { " and was over" } else { " and was over, too" };
        return Some(format!("the next smaller size tried, {}x{}, had {found}{over}", t.width, t.height));
    }
    if !error.met {
        return None;
    }
    let segment = light.temporal.as_ref().and_then(|t| Some((t.segment?, t.decided_by?)));
    Some(match segment {
        Some((_, frame)) => format!("the size that frame {frame} needs"),
        None if job.quality.measure == Measure::Check => {
            "the size expected met, so no smaller one was tried (quality.measure = \"check\")".to_owned()
        }
        None => "the smallest size allowed".to_owned(),
    })
}

/// What the bias is and what it is to blame for.
fn bias(light: &LightPlan) -> Option<String> {
    let MapBias { slope, clamp, .. } = light.maps.first()?.bias;
    let clamp = clamp.map(|c| format!(" clamped at {c}")).unwrap_or_default();
    let measured: Option<&Measured> = light.error.as_ref().and_then(|e| e.measured.as_ref());
    let blame = measured.map(|m| match m.self_shadow {
        0 => " is to blame for none of the wrong pixels".to_owned(),
        n => format!(" is to blame for {n} of the wrong pixels and misplaced edges for {}", m.edge),
    });
    let sampled = light.error.as_ref().and_then(|e| e.predicted.as_ref()).is_some_and(|p| p.sampled.is_some());
    let from = if sampled { ", the best by lookups" } else { ", the default" };
    let blame = blame.unwrap_or_else(|| from.to_owned());
    Some(format!("a depth bias of slope {slope}{clamp}{blame}"))
}

/// How it hangs together with other frames.
fn across(light: &LightPlan) -> Option<String> {
    let temporal = light.temporal.as_ref()?;
    let segment = temporal.segment.map(|[a, b]| format!("one matrix for frames {a} to {b}"));
    let reused = temporal.reused_from.map(|frame| format!("drawn in frame {frame} and used again"));
    let same = temporal.same_as.map(|frame| format!("equal to frame {frame}, nothing was computed"));
    let parts: Vec<String> = segment.into_iter().chain(same).chain(reused).collect();
    (!parts.is_empty()).then(|| parts.join(", "))
}

/// Film pixels of a bound; absent = without end.
fn pixels(value: Option<f64>) -> String {
    value.map_or("no finite number".to_owned(), |v| format!("{v:.3}"))
}
