//! From a fault to a place in the job file: for faults that the parser reports, and for values that `check` refuses.

use std::ops::Range;
use std::path::Path;

use toml::de::{DeTable, DeValue};

use super::keys::{nearest, unknown_key_help};
use super::{JobError, Located, Problem};

/// The fault of a text that does not parse as a job.
pub(super) fn parse_error(path: &Path, text: &str, error: &toml::de::Error) -> JobError {
    let (message, help) = explain(error.message());
    located(path, text, error.span().unwrap_or(0..0), message, help)
}

/// The fault of a table, whose errors know keys but no places. toml writes the key behind the message only.
pub(super) fn table_problem(error: &toml::de::Error) -> Problem {
    let text = error.to_string();
    let key = text.rsplit_once("in `").and_then(|(_, key)| key.split('`').next()).unwrap_or_default();
    let (message, help) = explain(error.message());
    let help = help.unwrap_or_else(|| "correct the value".to_owned());
    Problem { key: key.to_owned(), message, help }
}

/// A refused value, shown where the file states it, or where its nearest enclosing table begins.
pub(super) fn problem(path: &Path, text: &str, problem: Problem) -> JobError {
    let span = span_of(text, &problem.key).unwrap_or(0..0);
    located(path, text, span, format!("{}: {}", problem.key, problem.message), Some(problem.help))
}

/// A fault at bytes of the file.
pub(super) fn located(path: &Path, text: &str, span: Range<usize>, message: String, help: Option<String>) -> JobError {
    let start = text.floor_char_boundary(span.start.min(text.len()));
    let end = text.ceil_char_boundary(span.end.clamp(start, text.len()));
    // A span over several lines (a whole table) is shown by its first line.
    let end = text[start..end].find('\n').map_or(end, |n| start + n);
    let before = &text[..start];
    let line_start = before.rfind('\n').map_or(0, |n| n + 1);
    JobError::InFile(Box::new(Located {
        path: path.to_owned(),
        text: text.to_owned(),
        span: start..end,
        line: before.matches('\n').count() + 1,
        column: text[line_start..start].chars().count() + 1,
        message,
        help,
    }))
}

/// The parser's message in the words of a job, and what to do. serde states names between backticks: the one found
/// first, then those known.
fn explain(message: &str) -> (String, Option<String>) {
    let names: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
    let Some((&found, known)) = names.split_first() else { return (plain_types(message), None) };
    if message.starts_with("unknown field") {
        return (format!("unknown key `{found}`"), Some(unknown_key_help(found, known)));
    }
    if message.starts_with("unknown variant") {
        let list: Vec<String> = known.iter().map(|k| format!("`{k}`")).collect();
        let help = match nearest(found, known.iter().copied()) {
            Some(near) => format!("did you mean `{near}`? The values are {}", list.join(", ")),
            None => format!("the values are {}", list.join(", ")),
        };
        return (format!("unknown value `{found}`"), Some(help));
    }
    if message.starts_with("missing field") {
        return (format!("the key `{found}` is missing"), Some(format!("add `{found} = …` to this table")));
    }
    (plain_types(message), None)
}

/// Type names of the implementation, in words.
fn plain_types(message: &str) -> String {
    let words = [
        ("expected u32", "expected a whole number of at least 0"),
        ("expected f64", "expected a number"),
        ("expected a boolean", "expected true or false"),
        ("expected path string", "expected a file name"),
        ("expected a sequence", "expected a list"),
        ("expected fewer elements in array", "expected fewer elements"),
    ];
    let mut text = message.to_owned();
    for (name, word) in words {
        if let Some(start) = text.strip_suffix(name) {
            text = format!("{start}{word}");
        }
    }
    if let Some((start, _)) = text.split_once("expected struct ") {
        text = format!("{start}expected a table");
    }
    text
}

/// Bytes of the value of a key such as `light[1].cone`, or of the innermost table on the way to it.
fn span_of(text: &str, key: &str) -> Option<Range<usize>> {
    let root = DeTable::parse(text).ok()?;
    let mut steps = key.split(['.', '[', ']']).filter(|s| !s.is_empty());
    let mut value = root.get_ref().get(steps.next()?)?;
    for step in steps {
        let inner = match value.get_ref() {
            DeValue::Array(list) => step.parse().ok().and_then(|i: usize| list.get(i)),
            DeValue::Table(table) => table.get(step),
            _ => None,
        };
        match inner {
            Some(inner) => value = inner,
            None => break,
        }
    }
    Some(value.span())
}
