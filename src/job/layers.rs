//! Presets, and how one layer of a job is laid over another.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use toml::{Table, Value};

use crate::resolution::Bound;

/// Settings that trade time for accuracy: the files in `configs/`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Preset {
    /// Seconds matter: a coarse look and a prediction, nothing measured.
    Draft,
    /// Every size measured; the search stops within a thousandth of its optimum.
    #[default]
    Standard,
    /// Finer samples, a search that states its gap, four times the rounds of choosing by measurement.
    Thorough,
}

impl Preset {
    /// The TOML text of the preset: a job without a scene.
    pub fn text(self) -> &'static str {
        match self {
            Preset::Draft => include_str!("../../configs/draft.toml"),
            Preset::Standard => include_str!("../../configs/standard.toml"),
            Preset::Thorough => include_str!("../../configs/thorough.toml"),
        }
    }
}

/// Lays `upper` over `lower`. Tables merge key by key, everything else is replaced. Some exceptions keep meanings whole:
/// * `camera` is replaced as one: its keys are alternatives, and a name laid over a pose must not keep the pose;
/// * an `upper` that changes `quality.bound` drops a `lower` epsilon, which has the other bound's unit;
/// * `budget` is replaced as one, and an `upper` epsilon without a budget drops it: a plan has either for its goal.
pub(crate) fn lay_over(lower: &mut Table, upper: &Table) {
    let bound = |job: &Table| job.get("quality").and_then(|q| q.get("bound")).cloned();
    let default_bound = || Value::try_from(Bound::default()).ok();
    if bound(upper).is_some_and(|b| Some(b) != bound(lower).or_else(default_bound))
        && let Some(Value::Table(quality)) = lower.get_mut("quality")
    {
        quality.remove("epsilon");
    }
    let epsilon = upper.get("quality").is_some_and(|q| q.get("epsilon").is_some());
    for (key, replaced) in [("camera", false), ("budget", epsilon)] {
        if replaced || upper.contains_key(key) {
            lower.remove(key);
        }
    }
    merge(lower, upper);
}

fn merge(lower: &mut Table, upper: &Table) {
    for (key, value) in upper {
        match (lower.get_mut(key), value) {
            (Some(Value::Table(below)), Value::Table(above)) => merge(below, above),
            _ => {
                lower.insert(key.clone(), value.clone());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::{Job, check};

    fn laid(lower: &str, upper: &str) -> Table {
        let mut table = lower.parse().unwrap();
        lay_over(&mut table, &upper.parse().unwrap());
        table
    }

    #[test]
    fn the_upper_layer_wins_key_by_key() {
        let table = laid("[map]\nmin = 8\nmax = 64\n[solver]\np = 1.0", "[map]\nmax = 128");
        assert_eq!(table, "[map]\nmin = 8\nmax = 128\n[solver]\np = 1.0".parse().unwrap());
    }

    #[test]
    fn a_camera_replaces_a_camera() {
        let table = laid("[camera]\nframe_all = true\nfov = 30.0", "[camera]\nname = \"A\"");
        assert_eq!(table, "[camera]\nname = \"A\"".parse().unwrap());
    }

    #[test]
    fn another_bound_drops_the_epsilon_below_it() {
        let shares = "[quality]\nepsilon = 0.002";
        assert_eq!(
            laid(shares, "[quality]\nbound = \"footprint\""),
            "[quality]\nbound = \"footprint\"".parse().unwrap()
        );
        let same = laid(shares, "[quality]\nbound = \"misclassified\"");
        assert_eq!(same["quality"]["epsilon"].as_float(), Some(0.002), "the same bound keeps it");
    }

    #[test]
    fn presets_are_valid_and_standard_is_the_default() {
        for preset in [Preset::Draft, Preset::Standard, Preset::Thorough] {
            let mut job: Job = toml::from_str(preset.text()).unwrap();
            job.scene = vec!["a.gltf".into()];
            check(&job).unwrap();
        }
        let standard: Job = toml::from_str(Preset::Standard.text()).unwrap();
        assert_eq!(standard, Job::default());
    }
}
