//! The operating points that are timed: the presets, each of their keys that cost time changed alone, and a few
//! combinations. The list is fixed, so that runs can be compared.

use serde::Serialize;
use toml::Table;

use crate::job::{Preset, lay_over};

/// Settings of a job that decide what planning costs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Point {
    /// The preset and what differs from it, as in `standard grid=256`.
    pub name: String,
    /// The preset that this is, where nothing differs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub preset: Option<Preset>,
    /// Keys of a job.
    pub settings: Table,
}

/// A key, its short name, and the values that it is given around each preset but for the preset's own.
struct Factor {
    name: &'static str,
    key: &'static str,
    values: &'static [&'static str],
}

/// What costs time. 16384 cells are the film's own resolution for any film; the method `scene-optimal` is the published
/// three iterations; `measure` is the search of the size: closed form, one check, certificate.
const FACTORS: [Factor; 9] = [
    Factor { name: "grid", key: "sampling.grid", values: &["64", "128", "256", "512", "16384"] },
    Factor { name: "refine", key: "sampling.refine", values: &["0", "2", "4", "6"] },
    Factor { name: "cap", key: "sampling.cap", values: &["512", "2048", "16384", "100000", "1000000"] },
    Factor { name: "effort", key: "solver.effort", values: &["\"local\"", "\"global\"", "\"exhaustive\""] },
    Factor { name: "method", key: "solver.method", values: &["\"scene-optimal\""] },
    Factor { name: "metric", key: "solver.metric", values: &["\"displacement\"", "\"l2\""] },
    Factor { name: "rounds", key: "solver.rounds", values: &["0", "2", "6", "12"] },
    Factor { name: "measured", key: "solver.measured_rounds", values: &["0", "2", "6", "16", "25", "50"] },
    Factor { name: "measure", key: "quality.measure", values: &["\"never\"", "\"check\"", "\"always\""] },
];

/// Combinations: what lies between the presets, and cheaper than the cheapest.
const COMBINED: [(Preset, &[(&str, &str)]); 12] = [
    (Preset::Draft, &[("grid", "64"), ("cap", "512"), ("rounds", "0")]),
    (Preset::Draft, &[("grid", "256"), ("rounds", "2")]),
    (Preset::Draft, &[("grid", "512"), ("cap", "16384"), ("effort", "\"global\"")]),
    (Preset::Draft, &[("measure", "\"check\""), ("measured", "1")]),
    (Preset::Draft, &[("measure", "\"check\""), ("measured", "2")]),
    (Preset::Draft, &[("measure", "\"always\""), ("measured", "2")]),
    (Preset::Standard, &[("cap", "2048"), ("effort", "\"local\""), ("rounds", "2")]),
    (Preset::Standard, &[("cap", "2048"), ("effort", "\"local\""), ("rounds", "2"), ("measured", "1")]),
    (Preset::Standard, &[("cap", "2048"), ("effort", "\"local\""), ("rounds", "2"), ("measured", "0")]),
    (Preset::Standard, &[("measured", "2"), ("measure", "\"check\"")]),
    (Preset::Standard, &[("cap", "2048"), ("effort", "\"local\""), ("measured", "6")]),
    (Preset::Thorough, &[("cap", "16384"), ("effort", "\"global\"")]),
];

/// The presets, in order of cost.
pub(super) const PRESETS: [Preset; 3] = [Preset::Draft, Preset::Standard, Preset::Thorough];

/// Every point, each once: the presets first.
pub fn points() -> Vec<Point> {
    let mut all: Vec<Point> = PRESETS.map(|preset| point(preset, &[])).into();
    for preset in PRESETS {
        for factor in &FACTORS {
            for value in factor.values {
                all.push(point(preset, &[(factor.name, value)]));
            }
        }
    }
    all.extend(COMBINED.map(|(preset, changes)| point(preset, changes)));
    let mut points: Vec<Point> = Vec::with_capacity(all.len());
    for point in all {
        if points.iter().all(|p| p.settings != point.settings) && !idle(&point) {
            points.push(point);
        }
    }
    points
}

/// The name of a preset, as in a job.
pub(super) fn name(preset: Preset) -> String {
    format!("{preset:?}").to_lowercase()
}

/// A preset with a few keys changed.
fn point(preset: Preset, changes: &[(&str, &str)]) -> Point {
    let mut settings = table(preset.text());
    let mut name = name(preset);
    for (factor, value) in changes {
        let key = FACTORS.iter().find(|f| f.name == *factor).map_or(*factor, |f| f.key);
        lay_over(&mut settings, &table(&format!("{key} = {value}")));
        name += &match (*factor, *value) {
            ("grid", "16384") => " grid=film".to_owned(),
            (factor, value) => format!(" {factor}={}", value.trim_matches('"')),
        };
    }
    Point { name, preset: changes.is_empty().then_some(preset), settings }
}

/// Whether what differs has no effect: measured rounds where nothing is measured.
fn idle(point: &Point) -> bool {
    let key = |table: &str, key: &str| point.settings.get(table).and_then(|t| t.get(key)).cloned();
    key("quality", "measure").is_some_and(|m| m.as_str() == Some("never")) && point.name.contains("measured=")
}

/// The texts are constants of this file and of `configs/`; a test reads them all.
fn table(text: &str) -> Table {
    text.parse().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::LoadedJob;
    use crate::job::{Job, check};
    use std::collections::BTreeSet;

    #[test]
    fn every_point_is_a_job_of_its_own_name() {
        let base = LoadedJob { job: Job::default(), file: None, dir: "".into() };
        let mut job = base.job.clone();
        job.scene = vec!["a.gltf".into()];
        check(&job).unwrap();
        let base = LoadedJob { job, ..base };
        let points = points();
        let names: BTreeSet<&str> = points.iter().map(|p| p.name.as_str()).collect();
        assert_eq!(names.len(), points.len());
        let mut jobs: Vec<Job> = Vec::new();
        for point in &points {
            let job = base.with(&point.settings).unwrap().job;
            assert!(!jobs.contains(&job), "{} repeats another", point.name);
            jobs.push(job);
        }
        for factor in &FACTORS {
            for value in factor.values {
                let text = format!("{} = {value}", factor.key);
                let wanted: Table = text.parse().unwrap();
                assert!(base.with(&wanted).is_ok(), "{text}");
            }
        }
    }

    #[test]
    fn presets_come_first_and_every_factor_is_swept_around_each() {
        let points = points();
        let presets: Vec<_> = points.iter().filter_map(|p| p.preset).collect();
        assert_eq!(presets, PRESETS);
        assert!(points[..3].iter().all(|p| p.preset.is_some()));
        for preset in ["draft", "standard", "thorough"] {
            for factor in FACTORS.iter().filter(|f| (preset, f.name) != ("draft", "measured")) {
                let around = format!("{preset} {}=", factor.name);
                assert!(points.iter().any(|p| p.name.starts_with(&around)), "{around}");
            }
        }
        assert!(points.iter().any(|p| p.name == "standard grid=64"));
    }
}
