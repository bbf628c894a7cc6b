//! The values a flag takes, from the job's own types: names and help are those of the JSON Schema.

use clap::builder::{PossibleValue, PossibleValuesParser};
use schemars::JsonSchema;

/// The variants of an enum as values of a flag.
pub(super) fn values<T: JsonSchema>() -> PossibleValuesParser {
    let schema = schemars::schema_for!(T).to_value();
    let variants = schema["oneOf"].as_array().cloned().unwrap_or_default();
    PossibleValuesParser::new(variants.iter().filter_map(|variant| {
        let text = |key: &str| variant[key].as_str().map(|s| leak(&s.replace('\n', " ")));
        let help = text("description").unwrap_or_default();
        Some(PossibleValue::new(text("const")?).help(help.trim_end_matches('.')))
    }))
}

/// clap keeps `'static` names; these few are made once a run.
fn leak(text: &str) -> &'static str {
    Box::leak(text.to_owned().into_boxed_str())
}

/// `WxH`, pixels.
pub(super) fn size(text: &str) -> Result<[u32; 2], String> {
    let parsed = text.split_once(['x', 'X']).and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
    parsed.ok_or_else(|| "give width and height in pixels, as in 1920x1080".to_owned())
}

/// Most lights of a run.
const LIGHTS_MAX: usize = 10_000;

/// Lights `start` to `end` - 1 of a seed.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Hemisphere {
    pub(super) lights: std::ops::Range<u32>,
    pub(super) seed: u64,
}

/// `random-hemisphere:N:SEED` or `random-hemisphere:A-B:SEED`.
pub(super) fn hemisphere(text: &str) -> Result<Hemisphere, String> {
    let range = |numbers: &str| match numbers.split_once('-') {
        Some((first, last)) => Some(first.parse().ok()?..last.parse::<u32>().ok()?.checked_add(1)?),
        None => Some(0..numbers.parse().ok()?),
    };
    let parsed = text
        .strip_prefix("random-hemisphere:")
        .and_then(|rest| rest.split_once(':'))
        .and_then(|(numbers, seed)| Some(Hemisphere { lights: range(numbers)?, seed: seed.parse().ok()? }));
    let found = parsed.ok_or("give the number of lights and a seed, as in random-hemisphere:500:1")?;
    match found.lights.len() {
        0 => Err("there is no light in this range: give at least one".to_owned()),
        count if count > LIGHTS_MAX => Err(format!("{count} lights are too many: give at most {LIGHTS_MAX}")),
        _ => Ok(found),
    }
}

/// A time with its unit, as in `50ms`, seconds.
pub(super) fn seconds(text: &str) -> Result<f64, String> {
    let units = [("us", 1e-6), ("ms", 1e-3), ("min", 60.0), ("s", 1.0)];
    let parsed = units.iter().find_map(|(unit, factor)| {
        let number: f64 = text.strip_suffix(unit)?.trim().parse().ok()?;
        Some(number * factor)
    });
    match parsed {
        Some(time) if time > 0.0 && time.is_finite() => Ok(time),
        Some(_) => Err("a time has to be above 0, and finite".to_owned()),
        None => Err("give a number and us, ms, s or min, as in 50ms".to_owned()),
    }
}

/// Limits of `[budget]`: `N`, or `KEY=N` with commas between.
pub(super) fn budget(text: &str) -> Result<toml::Table, String> {
    let mut table = toml::Table::new();
    for part in text.split(',') {
        let (key, number) = part.split_once('=').unwrap_or(("texels_total", part));
        if !["texels_total", "texels_per_frame", "bytes"].contains(&key) {
            return Err(format!("`{key}` is none of texels_total, texels_per_frame and bytes"));
        }
        let number =
            count(number).ok_or_else(|| format!("`{number}` is no number of texels, as in 4000000, 4M or 4Mi"))?;
        if table.insert(key.to_owned(), toml::Value::Integer(number)).is_some() {
            return Err(format!("`{key}` is given twice"));
        }
    }
    Ok(table)
}

/// A whole number with a factor for its ending.
fn count(text: &str) -> Option<i64> {
    let digits = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let factor = match &text[digits.len()..] {
        "" => 1,
        "k" => 1000,
        "M" => 1_000_000,
        "G" => 1_000_000_000,
        "Ki" => 1 << 10,
        "Mi" => 1 << 20,
        "Gi" => 1 << 30,
        _ => return None,
    };
    digits.parse::<i64>().ok().filter(|n| *n >= 0)?.checked_mul(factor)
}

/// A TOML value of an unsigned number.
pub(super) fn integer(number: u32) -> toml::Value {
    toml::Value::Integer(number.into())
}

#[cfg(test)]
mod tests {
    use clap::builder::TypedValueParser;
    use lixel::job::Preset;
    use lixel::methods::Method;
    use lixel::plan::Format;
    use lixel::resolution::{Bound, Measure};

    use super::*;

    fn names(parser: PossibleValuesParser) -> Vec<String> {
        parser.possible_values().unwrap().map(|v| v.get_name().to_owned()).collect()
    }

    #[test]
    fn flags_take_the_names_of_the_job() {
        assert_eq!(names(values::<Preset>()), ["draft", "standard", "thorough"]);
        assert_eq!(names(values::<Bound>()), ["misclassified", "displacement", "footprint"]);
        assert_eq!(names(values::<Measure>()), ["always", "full", "check", "never"]);
        assert_eq!(names(values::<Format>()), ["json", "toml"]);
        assert_eq!(names(values::<Method>())[3], "scene-optimal");
    }

    #[test]
    fn hemispheres_are_a_count_or_a_range_and_a_seed() {
        let parsed = |text: &str| hemisphere(text).ok();
        assert_eq!(parsed("random-hemisphere:500:7"), Some(Hemisphere { lights: 0..500, seed: 7 }));
        assert_eq!(parsed("random-hemisphere:200-299:7"), Some(Hemisphere { lights: 200..300, seed: 7 }));
        for bad in ["", "random-hemisphere:", "random-hemisphere:0:1", "random-hemisphere:9-3:1", "random-hemisphere:5"]
        {
            assert!(hemisphere(bad).is_err(), "{bad}");
        }
        assert!(hemisphere("random-hemisphere:10001:1").is_err());
        assert!(hemisphere("random-hemisphere:0-4294967295:1").is_err());
    }

    #[test]
    fn times_have_a_unit() {
        assert_eq!(seconds("50ms"), Ok(0.05));
        assert_eq!(seconds("1.5 s"), Ok(1.5));
        assert_eq!(seconds("2min"), Ok(120.0));
        for bad in ["50", "ms", "", "-1s", "0ms", "nans", "infs", "1h"] {
            assert!(seconds(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn budgets_are_a_number_or_keys() {
        let parsed = |text: &str| budget(text).map(|t| t.to_string().replace('\n', " "));
        assert_eq!(parsed("4M").as_deref(), Ok("texels_total = 4000000 "));
        assert_eq!(parsed("bytes=3Mi,texels_total=70").as_deref(), Ok("bytes = 3145728 texels_total = 70 "));
        for bad in ["", "-4", "4x", "texels=4", "4,5", "bytes=", "9223372036854775807k", "1.5M"] {
            assert!(budget(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn sizes_are_two_numbers() {
        assert_eq!(size("1920x1080"), Ok([1920, 1080]));
        for bad in ["1920", "x", "1920x", "1.5x2", "-1x2", "1x2x3"] {
            assert!(size(bad).is_err(), "{bad}");
        }
    }
}
