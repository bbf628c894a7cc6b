//! Files that a scene file names: only those beside or below it are opened, unless the user says otherwise. Scene files
//! come from anywhere, and must not make the planner read (and hash) files of their choice. And the bytes of files: of
//! regular ones, as a device has no end.

use std::io;
use std::path::{Component, Path, PathBuf};

/// Which files a scene file may name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Reach {
    /// Those in its own folder and below.
    Folder,
    /// Any.
    Anywhere,
}

/// The bytes of a file.
///
/// # Errors
/// The system's, and one for what is no file: a folder, a device, a pipe.
pub(super) fn bytes(path: &Path) -> io::Result<Vec<u8>> {
    let kind = std::fs::metadata(path)?.file_type();
    if kind.is_dir() {
        return Err(io::Error::from(io::ErrorKind::IsADirectory));
    }
    if !kind.is_file() {
        return Err(io::Error::other("it is a device or a pipe, not a file"));
    }
    std::fs::read(path)
}

/// The path of a file as named in another one, with `/` between its parts; every step stays within that one's folder,
/// unless it may reach anywhere.
///
/// # Errors
/// What is wrong with the name.
pub(super) fn path(named_in: &Path, name: &str, reach: Reach) -> Result<PathBuf, &'static str> {
    let scheme = name.split('/').next().is_some_and(|first| first.contains(':'));
    if scheme || name.contains('\\') {
        return Err("is not a relative path");
    }
    let relative = PathBuf::from(name);
    let folder = named_in.parent().unwrap_or(Path::new(""));
    if reach == Reach::Anywhere {
        // An absolute path replaces the folder.
        return if relative.file_name().is_none() { Err("names no file") } else { Ok(folder.join(relative)) };
    }
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
    if depth == 0 { Err("names no file") } else { Ok(folder.join(relative)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_stay_in_the_folder() {
        let from = |name: &str| path(Path::new("set/a.gltf"), name, Reach::Folder);
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
        let any = |name: &str| path(Path::new("set/a.gltf"), name, Reach::Anywhere);
        assert_eq!(any("../b.bin").unwrap(), Path::new("set/../b.bin"));
        assert_eq!(any("/tmp/b.bin").unwrap(), Path::new("/tmp/b.bin"));
        for name in ["http://x/y", "file:///etc/passwd", "", ".", ".."] {
            assert!(any(name).is_err(), "{name}");
        }
    }

    #[test]
    fn only_files_are_read() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(bytes(folder.path()).unwrap_err().kind(), io::ErrorKind::IsADirectory);
        assert_eq!(bytes(&folder.path().join("none")).unwrap_err().kind(), io::ErrorKind::NotFound);
        #[cfg(unix)]
        assert!(bytes(Path::new("/dev/zero")).unwrap_err().to_string().contains("device"));
        std::fs::write(folder.path().join("a"), "b").unwrap();
        assert_eq!(bytes(&folder.path().join("a")).unwrap(), b"b");
    }
}
