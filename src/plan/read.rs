//! Reading a plan, JSON or TOML.

use std::io;
use std::path::Path;

use serde::Deserialize;

use super::{Format, Plan, PlanError, SCHEMA};

/// Reads a plan file. The extension tells the format; without a known one the first character does.
///
/// # Errors
/// [`PlanError::Read`], [`PlanError::Parse`], [`PlanError::Schema`].
pub fn read(path: &Path) -> Result<Plan, PlanError> {
    let text = read_text(path).map_err(|source| PlanError::Read { path: path.to_owned(), source })?;
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    let format = match extension.as_str() {
        "json" => Format::Json,
        "toml" => Format::Toml,
        _ if text.trim_start().starts_with('{') => Format::Json,
        _ => Format::Toml,
    };
    parse(&text, format, path)
}

/// The text of a file or a pipe. A device has no end.
fn read_text(path: &Path) -> io::Result<String> {
    let kind = std::fs::metadata(path)?.file_type();
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt;
        if kind.is_char_device() || kind.is_block_device() {
            return Err(io::Error::other("it is a device, not a file"));
        }
    }
    if kind.is_dir() {
        return Err(io::Error::from(io::ErrorKind::IsADirectory));
    }
    std::fs::read_to_string(path)
}

/// Reads a plan's text; `path` is for messages.
///
/// # Errors
/// [`PlanError::Parse`], [`PlanError::Schema`].
pub fn parse(text: &str, format: Format, path: &Path) -> Result<Plan, PlanError> {
    // The version first: a plan of another version should not fail over a key.
    #[derive(Deserialize)]
    struct Version {
        schema: Option<String>,
    }
    match decode::<Version>(text, format, path)?.schema {
        Some(schema) if schema == SCHEMA => decode(text, format, path),
        Some(found) => Err(PlanError::Schema { path: path.to_owned(), found }),
        None => Err(PlanError::Parse {
            path: path.to_owned(),
            message: format!("it has no key `schema`; a plan begins with schema = \"{SCHEMA}\""),
        }),
    }
}

fn decode<T: for<'de> Deserialize<'de>>(text: &str, format: Format, path: &Path) -> Result<T, PlanError> {
    let failed = |message: String| PlanError::Parse { path: path.to_owned(), message: message.trim_end().to_owned() };
    match format {
        Format::Json => serde_json::from_str(text).map_err(|e| failed(e.to_string())),
        Format::Toml => toml::from_str(text).map_err(|e| failed(e.to_string())),
    }
}
