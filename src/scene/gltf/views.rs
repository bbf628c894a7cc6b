//! The bytes of buffer views: as they stand in their buffer, or decompressed where EXT_meshopt_compression or
//! KHR_meshopt_compression says so. Each compressed view is decoded once, when it is first asked for.

use super::accessor::Source;
use super::buffers::Allowance;
use super::document::{MeshoptView, entry, malformed};
use super::meshopt::{self, Filter, Layout, Mode};
use crate::scene::SceneError;

/// Most bytes that the compressed parts of a file may declare to hold, all together, so that a small file cannot ask for
/// any amount of memory: 2 GiB is a scene of about 80 million triangles.
const MAX_DECODED_BYTES: u64 = 2 << 30;

/// The same by the bytes of the file. Both codecs spend a bit or two at least on a triangle of some 20 bytes; only what is
/// all the same packs tighter.
const DECODED_BYTES: Allowance = Allowance { free: 16 << 20, per_byte: 512 };

impl<'a> Source<'a> {
    /// The bytes of a buffer view.
    ///
    /// # Errors
    /// [`SceneError::Malformed`] for a view outside its buffer, a buffer without data, or a stream that does not decode.
    pub(super) fn view(self, index: usize) -> Result<&'a [u8], SceneError> {
        let place = format!("bufferView {index}");
        let view = entry(self.path, &place, "bufferView", &self.document.buffer_views, index)?;
        let Some(compressed) = view.meshopt() else {
            return self.stored(&place, view.buffer, view.byte_offset, view.byte_length);
        };
        let slot = self.buffers.decompressed.get(index);
        if let Some(bytes) = slot.and_then(|slot| slot.get()) {
            return Ok(bytes);
        }
        let bytes = self.decompress(&place, compressed)?;
        if bytes.len() as u64 != view.byte_length {
            let problem = format!("is {} bytes long, but its meshopt stream holds {}", view.byte_length, bytes.len());
            return Err(self.fail(&place, problem));
        }
        Ok(slot.map_or(&[], |slot| slot.get_or_init(|| bytes)))
    }

    /// A range of a buffer.
    fn stored(self, place: &str, buffer: usize, offset: u64, length: u64) -> Result<&'a [u8], SceneError> {
        let declared = entry(self.path, place, "buffer", &self.document.buffers, buffer)?;
        let Some(bytes) = self.buffers.bytes.get(buffer).and_then(Option::as_deref) else {
            let problem = "has neither a uri nor the file's binary chunk; export the file again with its buffers";
            return Err(malformed(self.path, format!("buffer {buffer}"), problem));
        };
        match offset.checked_add(length).filter(|&end| end <= declared.byte_length) {
            // Buffers hold at least what they declare.
            Some(end) => Ok(&bytes[offset as usize..end as usize]),
            None => {
                let problem =
                    format!("covers bytes {offset} + {length} of buffer {buffer}, which has {}", declared.byte_length);
                Err(self.fail(place, problem))
            }
        }
    }

    /// Most bytes that the compressed parts of this file may declare, all together.
    pub(super) fn most_decoded_bytes(self) -> u64 {
        self.buffers.allows(DECODED_BYTES).min(MAX_DECODED_BYTES)
    }

    fn decompress(self, place: &str, view: &MeshoptView) -> Result<Vec<u8>, SceneError> {
        let stream = self.stored(place, view.buffer, view.byte_offset, view.byte_length)?;
        let mode = match view.mode.as_str() {
            "ATTRIBUTES" => Mode::Attributes,
            "TRIANGLES" => Mode::Triangles,
            "INDICES" => Mode::Indices,
            other => return Err(self.fail(place, format!("meshopt mode {other:?} is unknown"))),
        };
        let filter = match view.filter.as_deref() {
            None | Some("NONE") => Filter::None,
            Some("OCTAHEDRAL") => Filter::Octahedral,
            Some("QUATERNION") => Filter::Quaternion,
            Some("EXPONENTIAL") => Filter::Exponential,
            Some("COLOR") => Filter::Color,
            Some(other) => return Err(self.fail(place, format!("meshopt filter {other:?} is unknown"))),
        };
        self.check_declared(place)?;
        // What the check admits fits a usize.
        let layout = Layout { mode, filter, count: view.count as usize, stride: view.byte_stride as usize };
        meshopt::decode(stream, layout)
            .map_err(|flaw| self.fail(place, format!("its meshopt stream is damaged: {flaw}")))
    }

    /// Refuses a file whose compressed views declare more than [`Source::most_decoded_bytes`] together.
    fn check_declared(self, place: &str) -> Result<(), SceneError> {
        let views = self.document.buffer_views.iter().filter_map(|view| view.meshopt());
        let declared = views.fold(0_u64, |sum, view| sum.saturating_add(view.count.saturating_mul(view.byte_stride)));
        let most = self.most_decoded_bytes();
        if declared <= most {
            return Ok(());
        }
        let problem = format!(
            "the compressed views of this file declare {declared} bytes, more than the {most} that are decompressed of \
             it; split the file or store it uncompressed"
        );
        Err(malformed(self.path, place, problem))
    }
}
