//! Cases of which no more is asked than an answer: a plan that keeps its promises, or a status with its reason.

use super::setup::Setup;
use super::table::Row;
use super::trial::{Trial, plan};
use lixel::job::Job;
use lixel::plan::{LightPlan, Status};

/// The columns of [`row`].
pub(crate) const COLUMNS: &[&str] =
    &["case", "status", "maps", "largest", "wrong", "uncertain", "f32 texels", "reason"];

/// What a case may come to besides an answer.
pub(crate) type Expect = fn(&LightPlan) -> Result<(), String>;

/// Any answer will do.
pub(crate) const ANY: Expect = |_| Ok(());

/// A map that meets the bound.
pub(crate) const PLANNED: Expect = |light| status(light, &[Status::Planned]);

/// No map is needed.
pub(crate) const NO_MAP: Expect = |light| status(light, &[Status::NoVisibleShadow, Status::Unlit]);

/// Several maps, over the bound or not.
pub(crate) const SEVERAL: Expect = |light| {
    status(light, &[Status::Planned, Status::NotMet])?;
    if light.maps.len() > 1 { Ok(()) } else { Err(format!("{} map", light.maps.len())) }
};

fn status(light: &LightPlan, allowed: &[Status]) -> Result<(), String> {
    if allowed.contains(&light.status) {
        Ok(())
    } else {
        Err(format!("{:?}: {}", light.status, light.reason.as_deref().unwrap_or("no reason")))
    }
}

/// Plans a case and writes down what came of its first light.
pub(crate) fn row(name: impl Into<String>, setup: &Setup, expect: Expect) -> Row {
    tuned(name, setup, |_| {}, expect)
}

/// The same with other settings.
pub(crate) fn tuned(name: impl Into<String>, setup: &Setup, tune: impl Fn(&mut Job), expect: Expect) -> Row {
    Row::of(name, plan(setup, tune).and_then(|trial| figures(&trial, expect)))
}

fn figures(trial: &Trial, expect: Expect) -> Result<(Vec<String>, Vec<String>), String> {
    let light = trial.first()?;
    let measured = light.error.as_ref().and_then(|e| e.measured.as_ref());
    let largest = light.maps.iter().max_by_key(|m| m.texels());
    let shift = light.maps.iter().map(|m| m.f32_roundtrip_texels).fold(0.0, f64::max);
    let count = |of: Option<u64>| of.map_or("-".to_owned(), |n| n.to_string());
    let cells = vec![
        format!("{:?}", light.status),
        light.maps.len().to_string(),
        largest.map_or("-".to_owned(), |m| format!("{}x{}", m.width, m.height)),
        count(measured.map(|m| m.misclassified)),
        count(measured.map(|m| m.uncertain)),
        if light.maps.is_empty() { "-".to_owned() } else { super::table::short(shift) },
        light.reason.clone().unwrap_or_default(),
    ];
    Ok((cells, expect(light).err().into_iter().collect()))
}
