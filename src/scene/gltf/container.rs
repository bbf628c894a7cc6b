//! `.glb` and `.gltf` → the JSON and the binary chunk (glTF 2.0, section 4, "GLB File Format Specification").

use super::document::malformed;
use crate::scene::SceneError;
use std::ops::Range;
use std::path::Path;

/// First bytes of a GLB.
pub(super) const GLB_MAGIC: &[u8; 4] = b"glTF";
const GLB_HEADER_BYTES: usize = 12;
const CHUNK_HEADER_BYTES: usize = 8;
const CHUNK_JSON: u32 = 0x4E4F_534A;
const CHUNK_BIN: u32 = 0x004E_4942;

/// Where things are in a file's bytes.
#[derive(Debug)]
pub(super) struct Container {
    /// The document.
    pub json: Range<usize>,
    /// The GLB's binary chunk.
    pub bin: Option<Range<usize>>,
}

/// Finds the chunks.
///
/// # Errors
/// [`SceneError::Malformed`] for a wrong version, or chunks that are cut off, missing or out of order.
pub(super) fn locate(path: &Path, bytes: &[u8]) -> Result<Container, SceneError> {
    if bytes.is_empty() {
        return Err(malformed(path, "glTF", "the file is empty; export or copy it again"));
    }
    if !bytes.starts_with(GLB_MAGIC) {
        return Ok(Container { json: 0..bytes.len(), bin: None });
    }
    let fail = |problem: String| malformed(path, "GLB container", format!("{problem}; export or copy the file again"));
    let word = |at: usize| {
        let word = bytes.get(at..at + 4).and_then(|b| <[u8; 4]>::try_from(b).ok());
        word.map(u32::from_le_bytes).ok_or_else(|| fail(format!("ends within a header, at byte {}", bytes.len())))
    };
    let version = word(4)?;
    if version != 2 {
        let problem = format!("version {version} is not 2; convert the file to glTF 2.0");
        return Err(malformed(path, "GLB container", problem));
    }
    let length = word(8)? as usize;
    if length > bytes.len() {
        return Err(fail(format!("has {} of its {length} bytes", bytes.len())));
    }
    let chunk = |at: usize, kind: u32| -> Result<Option<Range<usize>>, SceneError> {
        if at + CHUNK_HEADER_BYTES > length || word(at + 4)? != kind {
            return Ok(None);
        }
        let (begin, size) = (at + CHUNK_HEADER_BYTES, word(at)? as usize);
        if size > length - begin {
            return Err(fail(format!("the chunk at byte {at} holds {} of its {size} bytes", length - begin)));
        }
        Ok(Some(begin..begin + size))
    };
    let json = chunk(GLB_HEADER_BYTES, CHUNK_JSON)?.ok_or_else(|| fail("the first chunk is not JSON".into()))?;
    // Chunks are padded to four bytes; some writers leave the padding out of the length.
    let bin = chunk(json.end.next_multiple_of(4), CHUNK_BIN)?;
    Ok(Container { json, bin })
}
