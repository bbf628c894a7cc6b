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
        assert_eq!(names(values::<Measure>()), ["always", "never"]);
        assert_eq!(names(values::<Format>()), ["json", "toml"]);
        assert_eq!(names(values::<Method>())[3], "scene-optimal");
    }

    #[test]
    fn sizes_are_two_numbers() {
        assert_eq!(size("1920x1080"), Ok([1920, 1080]));
        for bad in ["1920", "x", "1920x", "1.5x2", "-1x2", "1x2x3"] {
            assert!(size(bad).is_err(), "{bad}");
        }
    }
}
