//! Mode 0: elements of any kind. Blocks of at most 256 elements hold, byte position by byte position, the differences to
//! the element before, in groups of 16 of as few bits as they need; the element before the first stands at the end.

use super::{Flaw, Reader};

/// Elements of a group.
const GROUP: usize = 16;

/// Most elements of a block.
const BLOCK_MAX: usize = 256;

/// Bytes of a block at most, unless a group is larger.
const BLOCK_BYTES: usize = 8192;

/// Bits of a difference by the two header bits of its group: of version 0, and of control modes 0 and 1 of version 1.
const BITS: [[u32; 4]; 3] = [[0, 2, 4, 8], [0, 1, 2, 4], [1, 2, 4, 8]];

/// `count` elements of `stride` bytes, a multiple of 4 up to 256.
pub(super) fn decode(stream: &[u8], count: usize, stride: usize) -> Result<Vec<u8>, Flaw> {
    let (&header, body) = stream.split_first().ok_or(Flaw::CutOff(count))?;
    let (version_1, tail_min) = match header {
        0xa0 => (false, 32),
        0xa1 => (true, 24),
        other => return Err(Flaw::Header(other)),
    };
    let channels = stride / 4;
    let tail = stride + if version_1 { channels } else { 0 };
    let body_end = body.len().checked_sub(tail.max(tail_min)).ok_or(Flaw::CutOff(count))?;
    let (baseline, modes) = body[body.len() - tail..].split_at(stride);

    let block = ((BLOCK_BYTES / stride) & !(GROUP - 1)).min(BLOCK_MAX);
    // What every block takes at least: its control header, or the header bits of each byte position.
    let block_bytes_min = if version_1 { channels } else { stride };
    let least = count.div_ceil(block).checked_mul(block_bytes_min);
    let size = count.checked_mul(stride).filter(|_| least.is_some_and(|least| least <= body_end));
    let mut bytes = Vec::with_capacity(size.ok_or(Flaw::CutOff(count))?);

    let mut reader = Reader { rest: &body[..body_end], count };
    let mut previous = baseline.to_vec();
    let mut deltas = [[0_u8; BLOCK_MAX]; 4];
    while bytes.len() < count * stride {
        let begin = bytes.len();
        let elements = block.min(count - begin / stride);
        bytes.resize(begin + elements * stride, 0);
        let control = reader.take(if version_1 { channels } else { 0 })?;
        for channel in 0..channels {
            for (byte, deltas) in deltas.iter_mut().enumerate() {
                let bits = match control.get(channel).map(|modes| modes >> (2 * byte) & 3) {
                    None => BITS[0],
                    Some(0) => BITS[1],
                    Some(1) => BITS[2],
                    Some(2) => {
                        deltas.fill(0);
                        continue;
                    }
                    Some(_) => {
                        deltas[..elements].copy_from_slice(reader.take(elements)?);
                        continue;
                    }
                };
                read_groups(&mut reader, elements.div_ceil(GROUP), bits, deltas)?;
            }
            let mode = modes.get(channel).copied().unwrap_or(0);
            let (last, out) = (&mut previous[4 * channel..][..4], &mut bytes[begin + 4 * channel..]);
            add_up(mode, &deltas, elements, stride, last, out)?;
        }
    }
    reader.end()?;
    Ok(bytes)
}

/// The differences of one byte position of a block.
fn read_groups(reader: &mut Reader<'_>, groups: usize, bits: [u32; 4], out: &mut [u8; BLOCK_MAX]) -> Result<(), Flaw> {
    let headers = reader.take(groups.div_ceil(4))?;
    for (k, group) in out.as_chunks_mut::<GROUP>().0.iter_mut().take(groups).enumerate() {
        let bits = bits[usize::from(headers[k / 4] >> (2 * (k % 4)) & 3)];
        match bits {
            0 => group.fill(0),
            8 => group.copy_from_slice(reader.take(GROUP)?),
            _ => {
                let packed = reader.take(GROUP * bits as usize / 8)?;
                let per_byte = 8 / bits as usize;
                let sentinel = (1_u8 << bits) - 1;
                for (i, value) in group.iter_mut().enumerate() {
                    let place = (i % per_byte) as u32;
                    // Single bits run up from the lowest, pairs and nibbles down from the highest.
                    let shift = if bits == 1 { place } else { 8 - bits * (place + 1) };
                    *value = packed[i / per_byte] >> shift & sentinel;
                    if *value == sentinel {
                        *value = reader.byte()?;
                    }
                }
            }
        }
    }
    Ok(())
}

/// Four bytes of each element of a block from their differences; `last` are those of the element before.
fn add_up(
    mode: u8,
    deltas: &[[u8; BLOCK_MAX]; 4],
    elements: usize,
    stride: usize,
    last: &mut [u8],
    out: &mut [u8],
) -> Result<(), Flaw> {
    let mut word = [last[0], last[1], last[2], last[3]];
    for k in 0..elements {
        let delta = [deltas[0][k], deltas[1][k], deltas[2][k], deltas[3][k]];
        word = match mode {
            0 => std::array::from_fn(|i| word[i].wrapping_add((delta[i] >> 1) ^ (delta[i] & 1).wrapping_neg())),
            1 => {
                let half = |i: usize| {
                    let delta = u16::from_le_bytes([delta[i], delta[i + 1]]);
                    let delta = (delta >> 1) ^ (delta & 1).wrapping_neg();
                    u16::from_le_bytes([word[i], word[i + 1]]).wrapping_add(delta).to_le_bytes()
                };
                let ([a, b], [c, d]) = (half(0), half(2));
                [a, b, c, d]
            }
            _ if mode & 15 == 2 => {
                let turned = u32::from_le_bytes(delta).rotate_right(u32::from(mode >> 4));
                (u32::from_le_bytes(word) ^ turned).to_le_bytes()
            }
            _ => return Err(Flaw::Channel(mode)),
        };
        out[k * stride..][..4].copy_from_slice(&word);
    }
    last.copy_from_slice(&word);
    Ok(())
}
