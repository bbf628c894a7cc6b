//! EXT_meshopt_compression and KHR_meshopt_compression: a stream of a buffer view → its bytes.
//!
//! Written from the bitstream and filter appendices of KHR_meshopt_compression (Khronos, 2025), which contain the older
//! extension's as version 0. Decoded views are bytes like any other; accessors do not know the difference.
//!
//! Memory: the formats themselves bound what a stream can hold (the sparsest, an attribute block of nothing but zeros, has
//! 1024 bytes a byte), so a count that the stream's length rules out is refused before anything is allocated.

mod attributes;
mod filters;
mod indices;

/// How the elements of a view are encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mode {
    /// Elements of any kind, as byte deltas.
    Attributes,
    /// Indices of a triangle list.
    Triangles,
    /// Other indices.
    Indices,
}

/// What was done to elements before they were encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Filter {
    /// Nothing.
    None,
    /// Unit vectors on an octahedron.
    Octahedral,
    /// Rotations without their largest component.
    Quaternion,
    /// Floats of a shorter mantissa.
    Exponential,
    /// Colours in YCoCg.
    Color,
}

/// What a view says of its stream.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layout {
    /// Encoding.
    pub mode: Mode,
    /// Undone after decoding.
    pub filter: Filter,
    /// Elements.
    pub count: usize,
    /// Bytes an element.
    pub stride: usize,
}

/// Why a stream cannot be decoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub(super) enum Flaw {
    /// A stride or filter the mode does not go with.
    #[error("a stride of {stride} bytes does not go with mode {mode:?} and filter {filter:?}")]
    Layout { mode: Mode, filter: Filter, stride: usize },
    /// Not a multiple of three.
    #[error("{0} indices make no whole triangles")]
    Triangles(usize),
    /// The first byte.
    #[error("the header {0:#04x} is of no known version")]
    Header(u8),
    /// Too short for what is declared.
    #[error("the stream ends before {0} elements are complete")]
    CutOff(usize),
    /// Longer than what is declared.
    #[error("{0} bytes of the stream are left over")]
    LeftOver(usize),
    /// A channel mode beyond 2, or with bits that it has no use for.
    #[error("channel mode {0:#04x} is unknown")]
    Channel(u8),
    /// An entry of a queue that was never written.
    #[error("triangle {0} refers to an edge or vertex before the first")]
    Unwritten(usize),
}

/// The bytes of a view, `count` times `stride`.
///
/// # Errors
/// Any [`Flaw`].
pub(super) fn decode(stream: &[u8], layout: Layout) -> Result<Vec<u8>, Flaw> {
    let Layout { mode, filter, count, stride } = layout;
    let fits = match (mode, filter) {
        (Mode::Attributes, Filter::None | Filter::Exponential) => stride % 4 == 0 && (4..=256).contains(&stride),
        (Mode::Attributes, Filter::Octahedral | Filter::Color) => stride == 4 || stride == 8,
        (Mode::Attributes, Filter::Quaternion) => stride == 8,
        (Mode::Triangles | Mode::Indices, Filter::None) => stride == 2 || stride == 4,
        (Mode::Triangles | Mode::Indices, _) => false,
    };
    if !fits {
        return Err(Flaw::Layout { mode, filter, stride });
    }
    match mode {
        Mode::Attributes => {
            let mut bytes = attributes::decode(stream, count, stride)?;
            filters::undo(filter, stride, &mut bytes);
            Ok(bytes)
        }
        Mode::Triangles => Ok(pack(&indices::triangles(stream, count)?, stride)),
        Mode::Indices => Ok(pack(&indices::sequence(stream, count)?, stride)),
    }
}

/// Indices as little-endian integers of 2 or 4 bytes; the former wrap around.
fn pack(indices: &[u32], stride: usize) -> Vec<u8> {
    indices.iter().flat_map(|index| index.to_le_bytes().into_iter().take(stride)).collect()
}

/// Bytes read one after the other.
struct Reader<'a> {
    rest: &'a [u8],
    /// For the message.
    count: usize,
}

impl<'a> Reader<'a> {
    fn take(&mut self, bytes: usize) -> Result<&'a [u8], Flaw> {
        let (taken, rest) = self.rest.split_at_checked(bytes).ok_or(Flaw::CutOff(self.count))?;
        self.rest = rest;
        Ok(taken)
    }

    fn byte(&mut self) -> Result<u8, Flaw> {
        Ok(self.take(1)?[0])
    }

    /// An unsigned LEB128 of at most five bytes; bits beyond 32 are dropped.
    fn varint(&mut self) -> Result<u32, Flaw> {
        let mut value = 0;
        for shift in (0..35).step_by(7) {
            let byte = self.byte()?;
            value |= u32::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                return Ok(value);
            }
        }
        Err(Flaw::CutOff(self.count))
    }

    fn end(&self) -> Result<(), Flaw> {
        if self.rest.is_empty() { Ok(()) } else { Err(Flaw::LeftOver(self.rest.len())) }
    }
}

#[cfg(test)]
mod tests;
