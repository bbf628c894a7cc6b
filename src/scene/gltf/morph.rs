//! Morph targets (glTF 2.0, section 3.7.2.2): what each adds to the positions. Normals and tangents move no vertex.

use super::accessor::Source;
use super::document::Primitive;
use crate::scene::SceneError;
use crate::scene::model::Mesh;
use glam::DVec3;

/// Appends the deltas of the vertices that the mesh took over from a primitive, by index there. Deltas of zero are left
/// out: most targets move a small part of their mesh.
///
/// # Errors
/// [`SceneError::Malformed`] for too few deltas, or one that is not finite.
pub(super) fn append_targets(
    source: Source<'_>,
    at: &str,
    primitive: &Primitive,
    taken: &[u32],
    mesh: &mut Mesh,
) -> Result<(), SceneError> {
    let begun = mesh.vertices.len() - taken.len();
    if mesh.targets.len() < primitive.targets.len() {
        mesh.targets.resize_with(primitive.targets.len(), Vec::new);
    }
    for (target, attributes) in mesh.targets.iter_mut().zip(&primitive.targets) {
        let Some(accessor) = attributes.position else { continue };
        let deltas = source.read::<3>(accessor, "VEC3")?;
        for (offset, &vertex) in taken.iter().enumerate() {
            let at = || format!("{at}, morph target accessor {accessor}");
            let delta = deltas.get(vertex as usize).copied().map(DVec3::from_array).ok_or_else(|| {
                source.fail(&at(), format!("holds {} deltas, none for vertex {vertex}", deltas.len()))
            })?;
            if !delta.is_finite() {
                return Err(source.fail(&at(), format!("the delta of vertex {vertex} is not finite: {delta}")));
            }
            if delta != DVec3::ZERO {
                // Fits: the mesh counts its vertices in u32.
                target.push(((begun + offset) as u32, delta));
            }
        }
    }
    Ok(())
}
