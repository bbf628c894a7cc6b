//! Files that a scene file names: only those beside or below it are opened. Scene files come from anywhere, and must not
//! make the planner read (and hash) files of their choice.

use std::path::{Component, Path, PathBuf};

/// The path of a file as named in another one, with `/` between its parts; every step stays within that one's folder.
///
/// # Errors
/// What is wrong with the name.
pub(super) fn path(named_in: &Path, name: &str) -> Result<PathBuf, &'static str> {
    let scheme = name.split('/').next().is_some_and(|first| first.contains(':'));
    if scheme || name.contains('\\') {
        return Err("is not a relative path");
    }
    let relative = PathBuf::from(name);
    let mut depth = 0_i64;
    for component in relative.components() {
        depth += match component {
            Component::Normal(_) => 1,
            Component::CurDir => 0,
            Component::ParentDir => -1,
            Component::RootDir | Component::Prefix(_) => return Err("is not a relative path"),
        };
        if depth < 0 {
            return Err("leaves the scene's folder");
        }
    }
    if depth == 0 { Err("names no file") } else { Ok(named_in.parent().unwrap_or(Path::new("")).join(relative)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_stay_in_the_folder() {
        let from = |name: &str| path(Path::new("set/a.gltf"), name);
        assert_eq!(from("a b/cé.bin").unwrap(), Path::new("set/a b/cé.bin"));
        assert_eq!(from("a/../b.bin").unwrap(), Path::new("set/a/../b.bin"));
        let refused = [
            "../b.bin",
            "a/../../b",
            "/etc/passwd",
            "file:///etc/passwd",
            "http://x/y",
            "..\\b",
            "C:/b",
            "",
            ".",
            "a/..",
        ];
        for name in refused {
            assert!(from(name).is_err(), "{name}");
        }
    }
}
