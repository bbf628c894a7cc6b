//! Methods by name, with settings of their own: `cascades:log:warped:4`.
//!
//! After a method's name come settings between colons: a value of one of the method's own keys of `[solver]`, which then
//! needs no key, as no two of them take the same words; or `key=value` for any key.

use crate::job::check_solver;
use crate::methods::{Method, SolverParams};
use serde::Deserialize;
use toml::{Table, Value};

/// A method to compare, with all its settings.
#[derive(Clone, Debug, PartialEq)]
pub struct Variant {
    /// As it was written.
    pub name: String,
    /// The settings.
    pub solver: SolverParams,
}

impl Variant {
    /// A method with the settings of a job.
    pub fn plain(method: Method, job: &SolverParams) -> Variant {
        Variant { name: method.name(), solver: SolverParams { method, ..job.clone() } }
    }

    /// `name`, or `name:setting:…`, over the settings of a job.
    ///
    /// # Errors
    /// What is wrong, and what may stand there.
    pub fn parse(text: &str, job: &SolverParams) -> Result<Variant, String> {
        let mut words = text.split(':');
        let name = words.next().unwrap_or_default();
        let method = super::all_methods()
            .into_iter()
            .find(|method| method.name() == name)
            .ok_or_else(|| format!("no method is named {name:?}; there are {}", names()))?;
        let mut settings = Table::new();
        for word in words {
            let (key, value) = match word.split_once('=') {
                Some((key, value)) => (key, value_of(value)),
                None => (own_key(method, word, &settings)?, value_of(word)),
            };
            if settings.insert(key.to_owned(), value).is_some() {
                return Err(format!("{key} is given twice"));
            }
        }
        if settings.contains_key("method") {
            return Err("the method stands before the first colon".to_owned());
        }
        let mut table = Table::try_from(job).map_err(|e| e.to_string())?;
        table.extend(settings);
        let read = SolverParams::deserialize(table).map_err(|e| e.message().to_owned())?;
        let solver = SolverParams { method, ..read };
        check_solver(&solver).map_err(|p| format!("{}: {}; {}", p.key, p.message, p.help))?;
        Ok(Variant { name: text.to_owned(), solver })
    }
}

/// The first of a method's own keys, not given yet, that takes a word.
fn own_key(method: Method, word: &str, given: &Table) -> Result<&'static str, String> {
    let keys = method.own_settings();
    let takes = |key: &str| {
        let alone = Table::from_iter([(key.to_owned(), value_of(word))]);
        !given.contains_key(key) && SolverParams::deserialize(alone).is_ok()
    };
    keys.iter().copied().find(|key| takes(key)).ok_or_else(|| match keys {
        [] => format!("{word:?}: {} has no settings of its own; give key=value", method.name()),
        _ => format!("{word:?} is no value of {} that is not given yet; give one, or key=value", keys.join(", ")),
    })
}

/// A number where it is one, else a word.
fn value_of(text: &str) -> Value {
    let integer = text.parse().map(Value::Integer);
    integer
        .or(text.parse().map(Value::Float))
        .unwrap_or_else(|_: std::num::ParseFloatError| Value::String(text.to_owned()))
}

fn names() -> String {
    super::all_methods().into_iter().map(Method::name).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::methods::{AreaOver, CascadeFit, CascadeSplit, PerspectiveMethod};

    fn solver(text: &str) -> SolverParams {
        Variant::parse(text, &SolverParams::default()).unwrap().solver
    }

    #[test]
    fn words_find_their_keys() {
        let cascades = solver("cascades:log:warped:8");
        assert_eq!((cascades.method, cascades.cascade_split), (Method::Cascades, CascadeSplit::Log));
        assert_eq!((cascades.cascade_fit, cascades.cascade_count), (CascadeFit::Warped, 8));
        assert_eq!(solver("cascades:4:stable:0.25").cascade_blend, 0.25);
        let separating = solver("separating-plane:psm:1");
        assert_eq!((separating.separating_map, separating.separating_iterations), (PerspectiveMethod::Psm, 1));
        assert_eq!(solver("homography-area:alpha").area, AreaOver::Alpha);
        let tsm = solver("tsm:0.7:0.6");
        assert_eq!((tsm.tsm_focus, tsm.tsm_depth), (0.7, 0.6));
        assert_eq!(solver("psm:1").psm_infinity, 1.0);
        assert_eq!(solver("lixel:l2:rounds=0").rounds, 0);
        let job = SolverParams { tsm_depth: 0.3, ..SolverParams::default() };
        assert_eq!(Variant::parse("tsm:0.7", &job).unwrap().solver.tsm_depth, 0.3, "the job's other settings stay");
        assert_eq!(Variant::parse("tsm", &job).unwrap(), Variant::plain(Method::Tsm, &job));
    }

    #[test]
    fn what_is_wrong_is_said() {
        for (text, part) in [
            ("magic", "there are lixel, normal"),
            ("cascades:fast", "cascade_split, cascade_fit"),
            ("cascades:log:uniform", "not given yet"),
            ("cascades:99", "1 to 16"),
            ("cascades:cascade_count=2:cascade_count=3", "given twice"),
            ("cascades:cascade_size=2", "cascade_size"),
            ("normal:1", "no settings of its own"),
            ("tsm:method=psm", "before the first colon"),
            ("", "there are"),
        ] {
            let said = Variant::parse(text, &SolverParams::default()).unwrap_err();
            assert!(said.contains(part), "{text}: {said}");
        }
    }
}
