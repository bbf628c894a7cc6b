//! The keys that a job has, from its schema, and the one that a user may have meant.

use std::sync::LazyLock;

use serde_json::Value;

use super::Job;

/// A table of a job and its keys.
struct JobTable {
    /// As written in TOML: `[quality]`, `[[light]]`; empty for the top of the file.
    header: String,
    keys: Vec<String>,
}

static TABLES: LazyLock<Vec<JobTable>> = LazyLock::new(|| {
    let schema = schemars::schema_for!(Job).to_value();
    let mut tables = Vec::new();
    collect(&schema, &schema, "", false, &mut tables);
    tables
});

/// Adds the table that a schema node describes, then the tables inside it.
fn collect(root: &Value, node: &Value, path: &str, list: bool, tables: &mut Vec<JobTable>) {
    let node = match node["$ref"].as_str() {
        Some(reference) => root.pointer(reference.trim_start_matches('#')).unwrap_or(&Value::Null),
        None => node,
    };
    if node["type"] == "array" {
        return collect(root, &node["items"], path, true, tables);
    }
    let Some(properties) = node["properties"].as_object() else { return };
    let header = match (path, list) {
        ("", _) => String::new(),
        (_, false) => format!("[{path}]"),
        (_, true) => format!("[[{path}]]"),
    };
    tables.push(JobTable { header, keys: properties.keys().cloned().collect() });
    for (key, value) in properties {
        let inner = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
        collect(root, value, &inner, false, tables);
    }
}

/// What to tell a user who wrote a key that its table, which knows `here`, does not have.
pub(super) fn unknown_key_help(key: &str, here: &[&str]) -> String {
    let elsewhere = |test: &dyn Fn(&str) -> bool| {
        TABLES.iter().find_map(|t| t.keys.iter().find(|k| test(k)).map(|k| (t.header.as_str(), k.as_str())))
    };
    let place = |header: &str| if header.is_empty() { "the top of the job".to_owned() } else { header.to_owned() };
    if let Some((header, _)) = elsewhere(&|k| k == key) {
        return format!("`{key}` belongs in {}", place(header));
    }
    if let Some(near) = nearest(key, here.iter().copied()) {
        return format!("did you mean `{near}`?");
    }
    if let Some(near) = nearest(key, TABLES.iter().flat_map(|t| t.keys.iter().map(String::as_str)))
        && let Some((header, _)) = elsewhere(&|k| k == near)
    {
        return format!("did you mean `{near}` in {}?", place(header));
    }
    let list: Vec<String> = here.iter().map(|k| format!("`{k}`")).collect();
    format!("the keys here are {}", list.join(", "))
}

/// The known word nearest to one that is not known, if any is near: at most a third of its letters differ.
pub(super) fn nearest<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let lower = word.to_lowercase();
    known
        .into_iter()
        .map(|k| (strsim::damerau_levenshtein(&lower, k), k))
        .filter(|&(distance, k)| distance <= k.chars().count().max(lower.chars().count()).div_ceil(3))
        .min()
        .map(|(_, k)| k)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_follow_the_schema() {
        let headers: Vec<&str> = TABLES.iter().map(|t| t.header.as_str()).collect();
        for header in ["", "[camera]", "[[camera.key]]", "[[light]]", "[map]", "[map.bias]", "[solver]"] {
            assert!(headers.contains(&header), "{header} is not among {headers:?}");
        }
    }

    #[test]
    fn help_knows_where_a_key_belongs() {
        assert_eq!(unknown_key_help("fov", &["size"]), "`fov` belongs in [camera]");
        assert_eq!(unknown_key_help("siez", &["size"]), "did you mean `size`?");
        assert_eq!(unknown_key_help("epsilom", &["size"]), "did you mean `epsilon` in [quality]?");
        assert_eq!(unknown_key_help("wombat", &["size", "x"]), "the keys here are `size`, `x`");
    }
}
