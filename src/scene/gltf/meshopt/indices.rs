//! Modes 1 and 2: indices. Mode 1 encodes most triangles of a list in one byte, as an edge and a vertex met shortly
//! before; mode 2 encodes each index as a difference to one of two predecessors.

use super::{Flaw, Reader};

/// The last entries of a sequence of unknown length.
struct Recent<T> {
    entries: [T; 16],
    pushed: usize,
}

impl<T: Copy + Default> Recent<T> {
    fn new() -> Self {
        Recent { entries: [T::default(); 16], pushed: 0 }
    }

    fn push(&mut self, entry: T) {
        self.entries[self.pushed % 16] = entry;
        self.pushed += 1;
    }

    /// The entry pushed last for 0, the one before for 1, up to 15; `None` where none was pushed.
    fn get(&self, back: usize) -> Option<T> {
        (back < self.pushed).then(|| self.entries[(self.pushed - 1 - back) % 16])
    }
}

/// What a triangle's code refers to.
struct State<'a> {
    edges: Recent<[u32; 2]>,
    vertices: Recent<u32>,
    /// The index that was never used before.
    next: u32,
    /// The index that was last spelled out.
    last: u32,
    data: Reader<'a>,
}

impl State<'_> {
    fn fresh(&mut self) -> u32 {
        let fresh = self.next;
        self.next = fresh.wrapping_add(1);
        self.vertices.push(fresh);
        fresh
    }

    fn spelled_out(&mut self) -> Result<u32, Flaw> {
        self.last = self.last.wrapping_add(zigzag(self.data.varint()?));
        self.vertices.push(self.last);
        Ok(self.last)
    }

    /// A vertex that the queue does not hold: 15 = spelled out, else fresh.
    fn new_vertex(&mut self, code: u8) -> Result<u32, Flaw> {
        if code == 15 { self.spelled_out() } else { Ok(self.fresh()) }
    }

    /// A triangle on an edge met before, by the high half of its code.
    fn on_edge(&mut self, code: u8) -> Result<Option<[u32; 3]>, Flaw> {
        let Some([a, b]) = self.edges.get(usize::from(code >> 4)) else { return Ok(None) };
        let c = match code & 15 {
            0 => Some(self.fresh()),
            near @ (13 | 14) => {
                self.last = if near == 13 { self.last.wrapping_sub(1) } else { self.last.wrapping_add(1) };
                self.vertices.push(self.last);
                Some(self.last)
            }
            15 => Some(self.spelled_out()?),
            back => self.vertices.get(usize::from(back)),
        };
        let Some(c) = c else { return Ok(None) };
        self.edges.push([c, b]);
        self.edges.push([a, c]);
        Ok(Some([a, b, c]))
    }

    /// A triangle on its own: `first` is the code of its first vertex, `others` has those of the second and third.
    fn apart(&mut self, first: u8, others: u8) -> Result<Option<[u32; 3]>, Flaw> {
        // References count back from before this triangle, whose own vertices join the queue: so they are resolved first.
        let [b, c] = [others >> 4, others & 15];
        let known =
            [b, c].map(|code| if matches!(code, 1..15) { self.vertices.get(usize::from(code) - 1) } else { None });
        if known.iter().zip([b, c]).any(|(vertex, code)| vertex.is_none() && matches!(code, 1..15)) {
            return Ok(None);
        }
        let a = self.new_vertex(first)?;
        let b = known[0].map_or_else(|| self.new_vertex(b), Ok)?;
        let c = known[1].map_or_else(|| self.new_vertex(c), Ok)?;
        for edge in [[b, a], [c, b], [a, c]] {
            self.edges.push(edge);
        }
        Ok(Some([a, b, c]))
    }
}

/// Mode 1: `count` indices of a triangle list.
pub(super) fn triangles(stream: &[u8], count: usize) -> Result<Vec<u32>, Flaw> {
    /// Codes of triangles apart that need no byte of their own.
    const TABLE: usize = 16;
    if !count.is_multiple_of(3) {
        return Err(Flaw::Triangles(count));
    }
    let mut reader = Reader { rest: stream, count };
    match reader.byte()? {
        0xe1 => {}
        other => return Err(Flaw::Header(other)),
    }
    let codes = reader.take(count / 3)?;
    let data = reader.take(reader.rest.len().checked_sub(TABLE).ok_or(Flaw::CutOff(count))?)?;
    let table = reader.rest;
    let mut state =
        State { edges: Recent::new(), vertices: Recent::new(), next: 0, last: 0, data: Reader { rest: data, count } };
    let mut indices = Vec::with_capacity(count);
    for (k, &code) in codes.iter().enumerate() {
        let triangle = match code {
            0..0xf0 => state.on_edge(code)?,
            0xf0..0xfe => state.apart(0, table[usize::from(code & 15)])?,
            0xfe | 0xff => {
                let others = state.data.byte()?;
                if others == 0 {
                    state.next = 0;
                }
                state.apart(if code == 0xfe { 0 } else { 15 }, others)?
            }
        };
        indices.extend(triangle.ok_or(Flaw::Unwritten(k))?);
    }
    state.data.end()?;
    Ok(indices)
}

/// Mode 2: `count` indices of any kind.
pub(super) fn sequence(stream: &[u8], count: usize) -> Result<Vec<u32>, Flaw> {
    /// Padding at the end.
    const TAIL: usize = 4;
    let mut reader = Reader { rest: stream, count };
    match reader.byte()? {
        0xd1 => {}
        other => return Err(Flaw::Header(other)),
    }
    let data = reader.take(reader.rest.len().checked_sub(TAIL).ok_or(Flaw::CutOff(count))?)?;
    if data.len() < count {
        return Err(Flaw::CutOff(count));
    }
    let mut data = Reader { rest: data, count };
    let mut last = [0_u32; 2];
    let mut indices = Vec::with_capacity(count);
    for _ in 0..count {
        let code = data.varint()?;
        let last = &mut last[(code & 1) as usize];
        *last = last.wrapping_add(zigzag(code >> 1));
        indices.push(*last);
    }
    data.end()?;
    Ok(indices)
}

/// 0, -1, 1, -2, 2, ... as wrapping differences.
fn zigzag(code: u32) -> u32 {
    (code >> 1) ^ (code & 1).wrapping_neg()
}
