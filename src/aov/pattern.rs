//! File names with a frame number in them: `render.####.exr`, `render.%04d.exr`.

use std::io;
use std::path::{Path, PathBuf};

/// The parts of a file name around its frame number.
struct Numbered<'a> {
    before: &'a str,
    /// Least number of digits.
    digits: usize,
    after: &'a str,
}

/// Finds the last `#…#` or `%0Nd` of a file's name.
fn numbered(name: &str) -> Option<Numbered<'_>> {
    if let Some(end) = name.rfind('#') {
        let start =
            name[..=end].rfind(|c| c != '#').map_or(0, |k| k + name[k..].chars().next().map_or(1, char::len_utf8));
        return Some(Numbered { before: &name[..start], digits: end + 1 - start, after: &name[end + 1..] });
    }
    let start = name.rfind('%')?;
    let (digits, after) = name[start + 1..].split_once('d')?;
    let count = if digits.is_empty() { 1 } else { digits.parse().ok()? };
    Some(Numbered { before: &name[..start], digits: count, after })
}

fn name_of(pattern: &Path) -> &str {
    pattern.file_name().and_then(|name| name.to_str()).unwrap_or_default()
}

/// Whether a file name has a place for the frame number.
pub fn has_frame_number(pattern: &Path) -> bool {
    numbered(name_of(pattern)).is_some()
}

/// The file of a frame; the pattern itself where it has no place for a number. Negative frames have a `-` before as many
/// digits.
pub fn frame_file(pattern: &Path, frame: i64) -> PathBuf {
    let Some(Numbered { before, digits, after }) = numbered(name_of(pattern)) else { return pattern.to_owned() };
    let sign = if frame < 0 { "-" } else { "" };
    let number = frame.unsigned_abs();
    pattern.with_file_name(format!("{before}{sign}{number:0digits$}{after}"))
}

/// The frames whose files are there, ascending.
///
/// # Errors
/// When the folder cannot be listed.
pub fn frames_there(pattern: &Path) -> io::Result<Vec<i64>> {
    let Some(Numbered { before, digits, after }) = numbered(name_of(pattern)) else { return Ok(Vec::new()) };
    let folder = pattern.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut frames = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let name = entry?.file_name();
        let number = name.to_str().and_then(|n| n.strip_prefix(before)?.strip_suffix(after));
        let Some(number) = number else { continue };
        let unsigned = number.strip_prefix('-').unwrap_or(number);
        if unsigned.len() >= digits
            && unsigned.bytes().all(|b| b.is_ascii_digit())
            && let Ok(frame) = number.parse::<i64>()
            && name_of(&frame_file(pattern, frame)) == name
        {
            frames.push(frame);
        }
    }
    frames.sort_unstable();
    frames.dedup();
    Ok(frames)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_go_where_the_pattern_says() {
        let cases = [
            ("a/render.####.exr", 12, "a/render.0012.exr"),
            ("a/render.####.exr", 12345, "a/render.12345.exr"),
            ("a.%03d.exr", 7, "a.007.exr"),
            ("a.%d.exr", 7, "a.7.exr"),
            ("v#1.##.exr", -3, "v#1.-03.exr"),
            ("####/still.exr", 3, "####/still.exr"),
            ("é#.exr", 3, "é3.exr"),
            ("100%.exr", 3, "100%.exr"),
        ];
        for (pattern, frame, file) in cases {
            assert_eq!(frame_file(Path::new(pattern), frame), Path::new(file));
        }
    }

    #[test]
    fn frames_are_found_in_the_folder() {
        let dir = tempfile::tempdir().unwrap();
        for name in ["r.0003.exr", "r.0001.exr", "r.-0002.exr", "r.12.exr", "r.00x1.exr", "s.0004.exr", "r.10000.exr"] {
            std::fs::write(dir.path().join(name), "").unwrap();
        }
        assert_eq!(frames_there(&dir.path().join("r.####.exr")).unwrap(), [-2, 1, 3, 10000]);
        assert!(frames_there(&dir.path().join("none/r.####.exr")).is_err());
    }
}
