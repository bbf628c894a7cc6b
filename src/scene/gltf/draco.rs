//! KHR_draco_mesh_compression: the streams of primitives → the elements of their accessors. The accessors that a primitive
//! names for compressed attributes, and for its indices, read from here as if a buffer view held them.
//!
//! Streams are decoded by `draco-core`, in parallel. Each may hold the faces and, within [`SLACK_BYTES`], the attributes
//! that the accessors declare; what all of them declare is bounded by [`MAX_DECODED_BYTES`].

use super::accessor::{Component, Source};
use super::document::{Draco, Primitive, entry, malformed};
use crate::scene::SceneError;
use crate::scene::model::place;
use draco_core::{DataType, DecodeLimits, DecoderBuffer, Mesh, MeshDecoder, PointAttribute, PointIndex};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// By accessor index.
pub(super) type Accessors = BTreeMap<usize, Elements>;

/// Bytes that a stream may hold beyond what the accessors declare: attributes that the file does not use.
const SLACK_BYTES: u64 = 64 << 20;

/// Bytes of an element of an accessor at most: four f32.
const ELEMENT_BYTES: u64 = 16;

/// The elements of one accessor.
#[derive(Debug, PartialEq)]
pub(super) struct Elements {
    /// As stored here.
    pub component: Component,
    /// In an element.
    pub components: usize,
    /// Little endian, without gaps.
    pub bytes: Vec<u8>,
}

/// A compressed primitive of the scene.
struct Task<'a> {
    /// For messages.
    at: String,
    primitive: &'a Primitive,
    draco: &'a Draco,
    /// Accessor of the indices.
    indices: usize,
}

/// Decodes the compressed primitives of meshes, given by index.
///
/// # Errors
/// [`SceneError::Malformed`] naming mesh and primitive.
pub(super) fn decode(source: Source<'_>, meshes: impl Iterator<Item = usize>) -> Result<Accessors, SceneError> {
    let mut tasks = Vec::new();
    let mut declared = 0_u64;
    for (index, mesh) in meshes.filter_map(|index| Some((index, source.document.meshes.get(index)?))) {
        for (k, primitive) in mesh.primitives.iter().enumerate() {
            let Some(draco) = &primitive.extensions.draco else { continue };
            let at = format!("{}, primitive {k}", place("mesh", index, mesh.name.as_deref()));
            if primitive.mode.is_some_and(|mode| mode != 4) {
                return Err(source.fail(&at, "is Draco-compressed, but no triangle list"));
            }
            let indices = primitive.indices;
            let indices = indices.ok_or_else(|| source.fail(&at, "is Draco-compressed, but has no indices"))?;
            let task = Task { at, primitive, draco, indices };
            declared = declared.saturating_add(task.declared_bytes(source)?);
            tasks.push(task);
        }
    }
    let most = source.most_decoded_bytes();
    if declared > most {
        let problem = format!(
            "the Draco-compressed meshes of this file declare {declared} bytes, more than the {most} that are \
             decompressed of it; split the file or store it uncompressed"
        );
        return Err(malformed(source.path, "accessors", problem));
    }
    let decoded: Vec<_> = tasks.par_iter().map(|task| task.decode(source)).collect::<Result<_, _>>()?;
    let mut accessors = Accessors::new();
    for (task, found) in tasks.iter().zip(decoded) {
        for (accessor, elements) in found {
            if accessors.get(&accessor).is_some_and(|known| *known != elements) {
                return Err(source.fail(&task.at, format!("shares accessor {accessor} with another Draco stream")));
            }
            accessors.insert(accessor, elements);
        }
    }
    Ok(accessors)
}

impl Task<'_> {
    /// Elements of the accessor of the indices.
    fn index_count(&self, source: Source<'_>) -> Result<u64, SceneError> {
        Ok(entry(source.path, &self.at, "accessor", &source.document.accessors, self.indices)?.count)
    }

    /// Upper bound of what the accessors say the stream holds.
    fn declared_bytes(&self, source: Source<'_>) -> Result<u64, SceneError> {
        let mut elements = self.index_count(source)?;
        for name in self.draco.attributes.keys() {
            let accessor = self.accessor(source, name)?;
            let accessor = entry(source.path, &self.at, "accessor", &source.document.accessors, accessor)?;
            elements = elements.saturating_add(accessor.count);
        }
        Ok(elements.saturating_mul(ELEMENT_BYTES))
    }

    /// The accessor of a compressed attribute.
    fn accessor(&self, source: Source<'_>, name: &str) -> Result<usize, SceneError> {
        let accessor = self.primitive.attributes.accessor(name);
        accessor.ok_or_else(|| source.fail(&self.at, format!("{name} is in its Draco stream, but not in attributes")))
    }

    fn decode(&self, source: Source<'_>) -> Result<Vec<(usize, Elements)>, SceneError> {
        let stream = source.view(self.draco.buffer_view)?;
        let limits = DecodeLimits::default()
            .with_max_faces(self.index_count(source)? / 3)
            .with_max_decoded_bytes(self.declared_bytes(source)?.saturating_add(SLACK_BYTES));
        let mut mesh = Mesh::new();
        MeshDecoder::new()
            .decode(&mut DecoderBuffer::new(stream).with_limits(limits), &mut mesh)
            .map_err(|error| source.fail(&self.at, format!("its Draco stream does not decode: {error}")))?;
        let indices = mesh.faces().iter().flatten().flat_map(|point| point.0.to_le_bytes()).collect();
        let mut found = vec![(self.indices, Elements { component: Component::U32, components: 1, bytes: indices })];
        for (name, &id) in &self.draco.attributes {
            let elements = mesh.attribute_by_unique_id(id).and_then(|attribute| gather(attribute, mesh.num_points()));
            let elements = elements.ok_or_else(|| {
                source.fail(&self.at, format!("its Draco stream has no usable attribute {id} for {name}"))
            })?;
            found.push((self.accessor(source, name)?, elements));
        }
        Ok(found)
    }
}

/// The elements of an attribute, one a point; `None` for a type that glTF does not have and for values out of bounds.
fn gather(attribute: &PointAttribute, points: usize) -> Option<Elements> {
    let component = match attribute.data_type() {
        DataType::Int8 => Component::I8,
        DataType::Uint8 => Component::U8,
        DataType::Int16 => Component::I16,
        DataType::Uint16 => Component::U16,
        DataType::Uint32 => Component::U32,
        DataType::Float32 => Component::F32,
        _ => return None,
    };
    let components = usize::from(attribute.num_components());
    let element = component.bytes() * components;
    let stride = usize::try_from(attribute.byte_stride()).ok()?;
    let values = attribute.buffer().data();
    let mut bytes = Vec::with_capacity(points.checked_mul(element).filter(|_| element > 0)?);
    for point in 0..u32::try_from(points).ok()? {
        let begin = (attribute.mapped_index(PointIndex(point)).0 as usize).checked_mul(stride)?;
        bytes.extend_from_slice(values.get(begin..begin.checked_add(element)?)?);
    }
    Some(Elements { component, components, bytes })
}
