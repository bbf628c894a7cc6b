//! Bytes of the buffers: GLB chunk, data URIs, files beside the scene. Fallbacks for readers that cannot decompress are
//! not opened.

use super::document::{Document, malformed};
use super::draco;
use crate::scene::SceneError;
use crate::scene::beside::{self, Reach};
use std::borrow::Cow;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// Bytes of a document.
#[derive(Debug)]
pub(super) struct Buffers<'a> {
    /// By buffer index; `None` for one without data (legal where an extension supplies it).
    pub bytes: Vec<Option<Cow<'a, [u8]>>>,
    /// By index of the buffer view; filled when a compressed view is first asked for.
    pub decompressed: Vec<OnceLock<Vec<u8>>>,
    /// Elements of accessors that a Draco stream holds.
    pub draco: draco::Accessors,
}

/// How much of something a file may ask for that its bytes do not hold: so that a small file cannot take much memory, and
/// no file of production is refused.
#[derive(Clone, Copy, Debug)]
pub(super) struct Allowance {
    /// Whatever the file.
    pub free: u64,
    /// For each byte of its buffers.
    pub per_byte: u64,
}

impl Buffers<'_> {
    /// An allowance of this file.
    pub(super) fn allows(&self, Allowance { free, per_byte }: Allowance) -> u64 {
        let bytes: u64 = self.bytes.iter().flatten().map(|bytes| bytes.len() as u64).sum();
        free.saturating_add(bytes.saturating_mul(per_byte))
    }
}

/// Loads all buffers; files read are appended to `inputs`.
///
/// # Errors
/// [`SceneError::Read`] for a missing file, [`SceneError::Malformed`] for a bad URI, one that leaves the scene's folder,
/// or fewer bytes than declared.
pub(super) fn load<'a>(
    path: &Path,
    document: &Document,
    mut bin: Option<&'a [u8]>,
    reach: Reach,
    inputs: &mut Vec<PathBuf>,
) -> Result<Buffers<'a>, SceneError> {
    let mut bytes = Vec::new();
    for (index, buffer) in document.buffers.iter().enumerate() {
        let place = format!("buffer {index}");
        let data = match &buffer.uri {
            _ if buffer.is_fallback() => None,
            None if index == 0 => bin.take().map(Cow::Borrowed),
            None => None,
            Some(uri) => Some(Cow::Owned(read_uri(path, &place, uri, reach, inputs)?)),
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
    let decompressed = document.buffer_views.iter().map(|_| OnceLock::new()).collect();
    Ok(Buffers { bytes, decompressed, draco: draco::Accessors::new() })
}

/// The bytes that a URI stands for: data in itself, or a file beside the scene, which is appended to `inputs`.
///
/// # Errors
/// [`SceneError::Read`], [`SceneError::Malformed`]; `place` says who asks.
pub(super) fn read_uri(
    path: &Path,
    place: &str,
    uri: &str,
    reach: Reach,
    inputs: &mut Vec<PathBuf>,
) -> Result<Vec<u8>, SceneError> {
    if uri.get(..5).is_some_and(|scheme| scheme.eq_ignore_ascii_case("data:")) {
        let decoded = data_url::DataUrl::process(uri).ok().and_then(|data| data.decode_to_vec().ok());
        let (data, _) =
            decoded.ok_or_else(|| malformed(path, place, "a data URI that does not decode; export the file again"))?;
        return Ok(data);
    }
    let file = file_of(path, uri, reach).map_err(|problem| {
        let remedy = "put the file beside or below the scene, or say --allow-outside";
        malformed(path, place, format!("URI {uri:?} {problem}; {remedy}"))
    })?;
    let data = beside::bytes(&file).map_err(|source| SceneError::Read { path: file.clone(), source })?;
    if !inputs.contains(&file) {
        inputs.push(file);
    }
    Ok(data)
}

/// The file that a relative URI names, percent-decoded.
fn file_of(path: &Path, uri: &str, reach: Reach) -> Result<PathBuf, &'static str> {
    let decoded = percent_encoding::percent_decode_str(uri).decode_utf8().map_err(|_| "is not UTF-8 when decoded")?;
    beside::path(path, &decoded, reach)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uris_are_decoded_before_they_are_judged() {
        let from = |uri: &str| file_of(Path::new("set/a.gltf"), uri, Reach::Folder);
        assert_eq!(from("a%20b/c%C3%A9.bin").unwrap(), Path::new("set/a b/cé.bin"));
        for uri in ["%2e%2e/b", "%ff", "%2Fetc%2Fpasswd"] {
            assert!(from(uri).is_err(), "{uri}");
        }
    }
}
