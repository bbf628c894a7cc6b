//! Writing a plan: first everything is checked to be finite, then the file appears whole or not at all.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use toml::Value;

use super::json::RowFormatter;
use super::{Plan, PlanError};

/// Where a plan goes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Dest {
    /// A file, replaced at once when all of the plan is on disk.
    File(PathBuf),
    /// Standard output.
    Stdout,
}

/// How a plan is written; both carry the same content.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Format {
    /// JSON, matrices one row a line.
    #[default]
    Json,
    /// TOML.
    Toml,
}

/// The plan as text.
///
/// # Errors
/// [`PlanError::NonFinite`] when any number is NaN or infinite, [`PlanError::Encode`].
pub fn to_text(plan: &Plan, format: Format) -> Result<String, PlanError> {
    check_finite(plan)?;
    match format {
        Format::Json => {
            let failed = |message: String| PlanError::Encode { format: "JSON", message };
            let mut bytes = Vec::new();
            plan.serialize(&mut serde_json::Serializer::with_formatter(&mut bytes, RowFormatter::default()))
                .map_err(|e| failed(e.to_string()))?;
            bytes.push(b'\n');
            String::from_utf8(bytes).map_err(|e| failed(e.to_string()))
        }
        Format::Toml => toml::to_string(plan).map_err(|e| PlanError::Encode { format: "TOML", message: e.to_string() }),
    }
}

/// Writes a plan.
///
/// # Errors
/// As [`to_text`], and [`PlanError::Write`]; the old file, if any, is then still there.
pub fn write(plan: &Plan, dest: &Dest, format: Format) -> Result<(), PlanError> {
    let text = to_text(plan, format)?;
    match dest {
        Dest::File(path) => write_atomically(path, text.as_bytes())
            .map_err(|source| PlanError::Write { dest: path.display().to_string(), source }),
        Dest::Stdout => {
            let mut out = io::stdout().lock();
            out.write_all(text.as_bytes())
                .and_then(|()| out.flush())
                .map_err(|source| PlanError::Write { dest: "standard output".to_owned(), source })
        }
    }
}

impl Dest {
    /// The folder that a plan's paths are relative to: the working folder for standard output.
    pub fn dir(&self) -> &Path {
        match self {
            Dest::File(path) => path.parent().unwrap_or(Path::new("")),
            Dest::Stdout => Path::new(""),
        }
    }

    /// Finds out before the work whether the plan could be written after it.
    ///
    /// # Errors
    /// [`PlanError::Write`].
    pub fn check(&self) -> Result<(), PlanError> {
        let Dest::File(path) = self else { return Ok(()) };
        let probe = || match target(path)? {
            Target::Replace { dir, .. } => tempfile::tempfile_in(dir).map(drop),
            Target::Direct => File::options().write(true).open(path).map(drop),
        };
        probe().map_err(|source| PlanError::Write { dest: path.display().to_string(), source })
    }
}

/// How a path is written.
enum Target {
    /// By renaming a new file in `dir` over `file`.
    Replace { file: PathBuf, dir: PathBuf },
    /// By writing to what is there: a device or a pipe, which renaming would replace.
    Direct,
}

fn target(path: &Path) -> io::Result<Target> {
    let file = match fs::metadata(path) {
        Ok(there) if there.is_dir() => return Err(io::Error::from(io::ErrorKind::IsADirectory)),
        Ok(there) if !there.is_file() => return Ok(Target::Direct),
        // Through a link the file it leads to is replaced, not the link.
        Ok(_) => path.canonicalize()?,
        Err(_) => path.to_owned(),
    };
    let dir = match file.parent() {
        Some(dir) if !dir.as_os_str().is_empty() => dir.to_owned(),
        _ => PathBuf::from("."),
    };
    Ok(Target::Replace { file, dir })
}

/// A temporary file beside the destination, synced, then renamed over it.
pub(crate) fn write_atomically(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let (file, dir) = match target(path)? {
        Target::Replace { file, dir } => (file, dir),
        Target::Direct => return File::options().write(true).open(path)?.write_all(bytes),
    };
    let mut builder = tempfile::Builder::new();
    builder.prefix(".lixel-").suffix(".tmp");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // What any new file asks for; the system takes the umask away from it.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let mut temporary = builder.tempfile_in(dir)?;
    temporary.write_all(bytes)?;
    temporary.as_file().sync_all()?;
    temporary.persist(file).map_err(|e| e.error)?;
    Ok(())
}

/// JSON turns NaN into null without a word, so every number is looked at before. Frame by frame, as a whole shot may be
/// large; TOML values, because they keep what is not finite.
fn check_finite(plan: &Plan) -> Result<(), PlanError> {
    check_part("job", &plan.job)?;
    check_part("origin", &plan.origin)?;
    for (i, frame) in plan.frames.iter().enumerate() {
        check_part(&format!("frames[{i}]"), frame)?;
    }
    Ok(())
}

pub(super) fn check_part(key: &str, part: &impl Serialize) -> Result<(), PlanError> {
    let value =
        Value::try_from(part).map_err(|e| PlanError::Encode { format: "TOML", message: format!("{key}: {e}") })?;
    walk(key, &value)
}

fn walk(key: &str, value: &Value) -> Result<(), PlanError> {
    match value {
        Value::Float(value) if !value.is_finite() => Err(PlanError::NonFinite { key: key.to_owned(), value: *value }),
        Value::Array(list) => list.iter().enumerate().try_for_each(|(i, v)| walk(&format!("{key}[{i}]"), v)),
        Value::Table(table) => table.iter().try_for_each(|(k, v)| walk(&format!("{key}.{k}"), v)),
        _ => Ok(()),
    }
}
