//! Broken and unsupported files: what a user is told, to the letter. Each case is built in code; its message stands under
//! its name in `messages.txt`. `LIXEL_BLESS=1` writes that file again, and fails, so that a look at the difference follows.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

mod cases;
#[path = "../scene/fixture.rs"]
#[allow(dead_code, reason = "this test uses a part of the builder")]
mod fixture;

use std::collections::BTreeMap;
use std::path::Path;

/// Of all cases, by name.
const MESSAGES: &str = include_str!("messages.txt");

/// Messages by the name of their case: a line `# name`, the message below.
fn quoted() -> BTreeMap<String, String> {
    let parts = MESSAGES.split("\n# ").map(|part| part.trim_start_matches("# "));
    parts
        .filter_map(|part| part.split_once('\n'))
        .map(|(name, text)| (name.to_owned(), text.trim_end().to_owned()))
        .collect()
}

fn all() -> BTreeMap<String, String> {
    let found = cases::all().into_iter().map(|(name, build)| {
        let folder = tempfile::tempdir().unwrap();
        let error = build(folder.path()).load().err().map(|error| error.to_string());
        let text = error.unwrap_or_else(|| "no error when loaded".to_owned());
        let own = format!("{}{}", folder.path().display(), std::path::MAIN_SEPARATOR);
        (name.to_owned(), text.replace(&own, ""))
    });
    found.collect()
}

#[test]
fn messages_are_as_quoted() {
    let found = all();
    assert!(found.len() >= 30 && found.len() == cases::all().len(), "{} cases", found.len());
    let quoted = quoted();
    if std::env::var_os("LIXEL_BLESS").is_some() {
        let text: Vec<String> = found.iter().map(|(name, text)| format!("# {name}\n{text}\n")).collect();
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/broken/messages.txt");
        std::fs::write(path, text.join("\n")).unwrap();
        panic!("messages.txt is written; look at it, then run without LIXEL_BLESS");
    }
    for (name, text) in &found {
        assert_eq!(quoted.get(name), Some(text), "{name}");
    }
    assert_eq!(quoted.keys().collect::<Vec<_>>(), found.keys().collect::<Vec<_>>());
}

/// Words by which a message says what to do.
const REMEDIES: [&str; 13] = [
    "export",
    "check the",
    "convert",
    "add ",
    "put the",
    "choose",
    "give ",
    "split",
    "fix it",
    "copy",
    "name the ones",
    "remove",
    "needs a",
];

#[test]
fn every_message_names_the_file_or_key_and_a_remedy() {
    for (name, text) in all() {
        let places = ["scene.", "triangle.bin", "camera", "light", "image.size", "frames.range", "animation"];
        let place = places.iter().any(|place| text.contains(place));
        assert!(place, "{name}: {text}");
        assert!(REMEDIES.iter().any(|word| text.contains(word)), "{name}: {text}");
        assert!(text.len() < 600 && !text.contains('\n'), "{name}: {text}");
    }
}
