//! Bytes of the buffers: GLB chunk, data URIs, files beside the scene.

use super::document::{Document, malformed};
use crate::scene::SceneError;
use std::path::{Component, Path, PathBuf};

/// Bytes of each buffer of a document; `None` for one without data (legal where an extension supplies it).
#[derive(Debug)]
pub(super) struct Buffers {
    /// By buffer index.
    pub bytes: Vec<Option<Vec<u8>>>,
}

/// Loads all buffers; files read are appended to `inputs`.
///
/// # Errors
/// [`SceneError::Read`] for a missing file, [`SceneError::Malformed`] for a bad URI, one that leaves the scene's folder,
/// or fewer bytes than declared.
pub(super) fn load(
    path: &Path,
    document: &Document,
    mut bin: Option<Vec<u8>>,
    inputs: &mut Vec<PathBuf>,
) -> Result<Buffers, SceneError> {
    let mut bytes = Vec::new();
    for (index, buffer) in document.buffers.iter().enumerate() {
        let place = format!("buffer {index}");
        let data = match &buffer.uri {
            None if index == 0 => bin.take(),
            None => None,
            Some(uri) if uri.get(..5).is_some_and(|scheme| scheme.eq_ignore_ascii_case("data:")) => {
                let decoded = data_url::DataUrl::process(uri).ok().and_then(|data| data.decode_to_vec().ok());
                let (data, _) = decoded.ok_or_else(|| malformed(path, &place, "a data URI that does not decode"))?;
                Some(data)
            }
            Some(uri) => {
                let file = path.parent().unwrap_or(Path::new("")).join(relative_path(uri).map_err(|problem| {
                    malformed(path, &place, format!("URI {uri:?} {problem}; put the file beside or below the scene"))
                })?);
                let data = std::fs::read(&file).map_err(|source| SceneError::Read { path: file.clone(), source })?;
                if !inputs.contains(&file) {
                    inputs.push(file);
                }
                Some(data)
            }
        };
        if let Some(data) = &data
            && (data.len() as u64) < buffer.byte_length
        {
            let problem = format!(
                "holds {} of the {} bytes it declares; the file is cut off, copy or export it again",
                data.len(),
                buffer.byte_length
            );
            return Err(malformed(path, place, problem));
        }
        bytes.push(data);
    }
    Ok(Buffers { bytes })
}

/// The path a relative URI names, percent-decoded. Only paths that stay within the scene's folder at every step pass:
/// scene files come from anywhere, and must not make the planner read (and hash) files of their choice.
fn relative_path(uri: &str) -> Result<PathBuf, &'static str> {
    let decoded = percent_encoding::percent_decode_str(uri).decode_utf8().map_err(|_| "is not UTF-8 when decoded")?;
    let scheme = decoded.split('/').next().is_some_and(|first| first.contains(':'));
    if scheme || decoded.contains('\\') {
        return Err("is not a relative path");
    }
    let path = PathBuf::from(decoded.as_ref());
    let mut depth = 0_i64;
    for component in path.components() {
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
    if depth == 0 { Err("names no file") } else { Ok(path) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uris_stay_in_the_folder() {
        assert_eq!(relative_path("a%20b/c%C3%A9.bin").unwrap(), Path::new("a b/cé.bin"));
        assert_eq!(relative_path("a/../b.bin").unwrap(), Path::new("a/../b.bin"));
        let refused = [
            "../b.bin",
            "a/../../b",
            "%2e%2e/b",
            "/etc/passwd",
            "file:///etc/passwd",
            "http://x/y",
            "..\\b",
            "C:/b",
            "",
            ".",
            "a/..",
            "%ff",
            "%2Fetc%2Fpasswd",
        ];
        for uri in refused {
            assert!(relative_path(uri).is_err(), "{uri}");
        }
    }
}
