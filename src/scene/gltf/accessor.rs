//! Accessors → numbers (glTF 2.0, section 3.6.2): component types, normalisation, stride, sparse substitution.
//!
//! Bounds are checked before anything is allocated, so that the memory taken is proportional to the bytes of the file.

use super::buffers::{Allowance, Buffers};
use super::document::{Accessor, Document, entry, malformed};
use crate::scene::SceneError;
use crate::scene::beside::Reach;
use crate::scene::tasks;
use std::path::Path;

/// Most elements of an accessor without a buffer view. It is all zeros but for its sparse entries, and nothing but the
/// number in the JSON bounds its memory; so it may have some, and more in a file that has bytes: such accessors are
/// displacements of vertices whose positions take 6 bytes each, or less when compressed.
const ELEMENTS_WITHOUT_BYTES: Allowance = Allowance { free: 1 << 12, per_byte: 16 };

/// A document with its bytes.
#[derive(Clone, Copy)]
pub(super) struct Source<'a> {
    /// For messages.
    pub path: &'a Path,
    /// Parsed.
    pub document: &'a Document,
    /// Loaded.
    pub buffers: &'a Buffers<'a>,
    /// Which files the document may name.
    pub reach: Reach,
}

/// How one component is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn from_code(code: u64) -> Option<Self> {
        Some(match code {
            5120 => Component::I8,
            5121 => Component::U8,
            5122 => Component::I16,
            5123 => Component::U16,
            5125 => Component::U32,
            5126 => Component::F32,
            _ => return None,
        })
    }

    /// Size.
    pub(super) fn bytes(self) -> usize {
        match self {
            Component::I8 | Component::U8 => 1,
            Component::I16 | Component::U16 => 2,
            Component::U32 | Component::F32 => 4,
        }
    }

    /// The number at the start of `b`, which holds at least [`Component::bytes`]. Normalised integers by the formulas
    /// of section 3.6.2.2.
    #[inline(always)]
    fn decode(self, b: &[u8], normalized: bool) -> f64 {
        let (value, top) = match self {
            Component::I8 => (f64::from(b[0].cast_signed()), 127.0),
            Component::U8 => (f64::from(b[0]), 255.0),
            Component::I16 => (f64::from(i16::from_le_bytes([b[0], b[1]])), 32767.0),
            Component::U16 => (f64::from(u16::from_le_bytes([b[0], b[1]])), 65535.0),
            Component::U32 => (f64::from(u32::from_le_bytes([b[0], b[1], b[2], b[3]])), f64::from(u32::MAX)),
            Component::F32 => return f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]])),
        };
        if normalized { (value / top).max(-1.0) } else { value }
    }
}

impl<'a> Source<'a> {
    /// Elements of `N` components of an accessor whose type must be `kind` ("SCALAR", "VEC3", ...).
    ///
    /// # Errors
    /// [`SceneError::Malformed`] for another type and for anything that points outside the bytes there are.
    pub(super) fn read<const N: usize>(self, index: usize, kind: &str) -> Result<Vec<[f64; N]>, SceneError> {
        let place = format!("accessor {index}");
        let accessor = entry(self.path, &place, "accessor", &self.document.accessors, index)?;
        if accessor.kind != kind {
            return Err(self.fail(&place, format!("is of type {:?} where {kind:?} is needed", accessor.kind)));
        }
        if let Some(decoded) = self.buffers.draco.get(&index) {
            let element = decoded.component.bytes() * decoded.components;
            if decoded.components != N {
                let problem = format!("is {kind:?}, but its Draco stream holds {} components", decoded.components);
                return Err(self.fail(&place, problem));
            }
            let count = decoded.bytes.len() / element;
            let all = Strided { bytes: &decoded.bytes, element, stride: element, count };
            return Ok(decode_all(all, same, decoded.component, accessor.normalized));
        }
        let component = self.component(&place, accessor.component_type)?;
        let mut values = match accessor.buffer_view {
            Some(view) => {
                let bytes = self.view_bytes::<N>(&place, view, accessor.byte_offset, component, accessor.count)?;
                decode_all(bytes, same, component, accessor.normalized)
            }
            None if accessor.count > self.buffers.allows(ELEMENTS_WITHOUT_BYTES) => {
                let (count, most) = (accessor.count, self.buffers.allows(ELEMENTS_WITHOUT_BYTES));
                let problem = format!(
                    "counts {count} elements but has no bufferView, and the buffers of this file are too small for \
                     more than {most} of them"
                );
                return Err(self.fail(&place, problem));
            }
            None => vec![[0.0; N]; accessor.count as usize],
        };
        self.apply_sparse(&place, accessor, component, &mut values)?;
        Ok(values)
    }

    /// Vertex indices of an accessor.
    ///
    /// # Errors
    /// As [`Source::read`], and for component types other than unsigned integers.
    pub(super) fn read_indices(self, index: usize) -> Result<Vec<u32>, SceneError> {
        let place = format!("accessor {index}");
        let accessor = entry(self.path, &place, "accessor", &self.document.accessors, index)?;
        self.index_component(&place, accessor.component_type)?;
        if accessor.normalized {
            return Err(self.fail(&place, "holds indices, which cannot be normalized"));
        }
        let plain = accessor.sparse.is_none() && accessor.kind == "SCALAR" && !self.buffers.draco.contains_key(&index);
        if let Some(view) = accessor.buffer_view.filter(|_| plain) {
            let component = self.component(&place, accessor.component_type)?;
            let bytes = self.view_bytes::<1>(&place, view, accessor.byte_offset, component, accessor.count)?;
            return Ok(decode_all::<1, _>(bytes, |[value]| value as u32, component, false));
        }
        // Exact: the values are unsigned integers of at most 32 bits.
        Ok(self.read::<1>(index, "SCALAR")?.into_iter().map(|[value]| value as u32).collect())
    }

    /// Joints of vertices, four each.
    ///
    /// # Errors
    /// As [`Source::read`], and for component types other than u8 and u16.
    pub(super) fn read_joints(self, index: usize) -> Result<Vec<[f64; 4]>, SceneError> {
        let place = format!("accessor {index}");
        let accessor = entry(self.path, &place, "accessor", &self.document.accessors, index)?;
        match self.component(&place, accessor.component_type)? {
            Component::U8 | Component::U16 if !accessor.normalized => self.read(index, "VEC4"),
            other => Err(self.fail(&place, format!("holds joints, which cannot be normalized or of type {other:?}"))),
        }
    }

    /// Replaces the elements that a sparse accessor lists.
    fn apply_sparse<const N: usize>(
        self,
        place: &str,
        accessor: &Accessor,
        component: Component,
        values: &mut [[f64; N]],
    ) -> Result<(), SceneError> {
        let Some(sparse) = &accessor.sparse else { return Ok(()) };
        let indices = &sparse.indices;
        let index_type = self.index_component(place, indices.component_type)?;
        let index_bytes =
            self.view_bytes::<1>(place, indices.buffer_view, indices.byte_offset, index_type, sparse.count)?;
        let value_bytes =
            self.view_bytes::<N>(place, sparse.values.buffer_view, sparse.values.byte_offset, component, sparse.count)?;
        let count = values.len();
        let targets = decode_all::<1, _>(index_bytes, same, index_type, false);
        let given = decode_all(value_bytes, same, component, accessor.normalized);
        for ([target], value) in targets.into_iter().zip(given) {
            let slot = values
                .get_mut(target as usize)
                .ok_or_else(|| self.fail(place, format!("sparse index {target} lies beyond its {count} elements")))?;
            *slot = value;
        }
        Ok(())
    }

    /// The bytes of `count` elements of `N` components, with their stride.
    fn view_bytes<const N: usize>(
        self,
        place: &str,
        view: usize,
        offset: u64,
        component: Component,
        count: u64,
    ) -> Result<Strided<'a>, SceneError> {
        let index = view;
        let view = entry(self.path, place, "bufferView", &self.document.buffer_views, index)?;
        let bytes = self.view(index)?;
        let element = (component.bytes() * N) as u64;
        let stride = view.byte_stride.unwrap_or(element);
        if stride < element {
            let problem = format!("byteStride {stride} is less than the {element} bytes of an element of {place}");
            return Err(self.fail(&format!("bufferView {index}"), problem));
        }
        // Bytes needed: all strides but the last, and the last element.
        let needed = match count {
            0 => Some(0),
            _ => (count - 1).checked_mul(stride).and_then(|n| n.checked_add(element)),
        };
        match needed.and_then(|n| offset.checked_add(n)) {
            Some(end) if end <= bytes.len() as u64 => {
                let bytes = &bytes[offset as usize..end as usize];
                let (element, stride) = (element as usize, stride as usize);
                Ok(Strided { bytes, element, stride, count: count as usize })
            }
            _ => {
                let problem = format!(
                    "{count} elements of {element} bytes, {stride} apart, from byte {offset}, do not fit the {} bytes of \
                     bufferView {index}",
                    bytes.len()
                );
                Err(self.fail(place, problem))
            }
        }
    }

    fn component(self, place: &str, code: u64) -> Result<Component, SceneError> {
        Component::from_code(code).ok_or_else(|| self.fail(place, format!("componentType {code} is unknown")))
    }

    fn index_component(self, place: &str, code: u64) -> Result<Component, SceneError> {
        match self.component(place, code)? {
            component @ (Component::U8 | Component::U16 | Component::U32) => Ok(component),
            other => Err(self.fail(place, format!("indices of type {other:?} are not unsigned integers"))),
        }
    }

    /// A [`SceneError::Malformed`] of this file.
    pub(super) fn fail(self, place: &str, problem: impl Into<String>) -> SceneError {
        malformed(self.path, place, format!("{}; export the file again", problem.into()))
    }
}

/// Elements at even distances.
struct Strided<'a> {
    bytes: &'a [u8],
    element: usize,
    stride: usize,
    count: usize,
}

/// All elements, in the form wanted; their bytes have been bounds checked.
fn decode_all<const N: usize, T: Clone + Send>(
    from: Strided<'_>,
    wanted: impl Fn([f64; N]) -> T + Sync,
    component: Component,
    normalized: bool,
) -> Vec<T> {
    let mut all = vec![wanted([0.0; N]); from.count];
    // Loops of their own: what is stored is not asked for every number.
    tasks::fill(&mut all, |first, run| match component {
        Component::I8 => decode_run(&from, first, run, &wanted, |b: &[u8; 1]| Component::I8.decode(b, normalized)),
        Component::U8 => decode_run(&from, first, run, &wanted, |b: &[u8; 1]| Component::U8.decode(b, normalized)),
        Component::I16 => decode_run(&from, first, run, &wanted, |b: &[u8; 2]| Component::I16.decode(b, normalized)),
        Component::U16 => decode_run(&from, first, run, &wanted, |b: &[u8; 2]| Component::U16.decode(b, normalized)),
        Component::U32 => decode_run(&from, first, run, &wanted, |b: &[u8; 4]| Component::U32.decode(b, normalized)),
        Component::F32 => decode_run(&from, first, run, &wanted, |b: &[u8; 4]| Component::F32.decode(b, normalized)),
    });
    all
}

/// The elements from `first` on, whose components take `BYTES` bytes.
fn decode_run<const N: usize, const BYTES: usize, T>(
    from: &Strided<'_>,
    first: usize,
    run: &mut [T],
    wanted: impl Fn([f64; N]) -> T,
    decode: impl Fn(&[u8; BYTES]) -> f64,
) {
    for (slot, k) in run.iter_mut().zip(first..) {
        let element = &from.bytes[k * from.stride..k * from.stride + from.element];
        let components = element.as_chunks::<BYTES>().0;
        *slot = wanted(std::array::from_fn(|c| decode(&components[c])));
    }
}

/// Elements as they are.
fn same<const N: usize>(element: [f64; N]) -> [f64; N] {
    element
}
