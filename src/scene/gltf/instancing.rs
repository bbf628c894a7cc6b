//! EXT_mesh_gpu_instancing: node-from-instance matrices of a node whose mesh is repeated.

use super::accessor::Source;
use super::document::Instancing;
use crate::scene::SceneError;
use crate::scene::track::unit_quat;
use glam::{DAffine3, DQuat, DVec3, DVec4};

/// One matrix an instance, from TRANSLATION, ROTATION and SCALE, each of which may be missing and of any component type.
/// Attributes of the application (`_ID`) only count: instances without any placement all coincide, and are one.
///
/// # Errors
/// [`SceneError::Malformed`] for attributes of different counts, values not finite, quaternions without length.
pub(super) fn read(source: Source<'_>, at: &str, instancing: &Instancing) -> Result<Vec<DAffine3>, SceneError> {
    let at = format!("{at}, EXT_mesh_gpu_instancing");
    let accessor = |name: &str| instancing.attributes.get(name).copied();
    let vec3s = |name: &str| accessor(name).map(|index| source.read::<3>(index, "VEC3")).transpose();
    let (translations, scales) = (vec3s("TRANSLATION")?, vec3s("SCALE")?);
    let rotations = accessor("ROTATION").map(|index| source.read::<4>(index, "VEC4")).transpose()?;
    let counts = [translations.as_ref().map(Vec::len), rotations.as_ref().map(Vec::len), scales.as_ref().map(Vec::len)];
    let Some(count) = counts.into_iter().flatten().max() else { return Ok(vec![DAffine3::IDENTITY]) };
    if counts.into_iter().flatten().any(|other| other != count) {
        let [translations, rotations, scales] = counts.map(|count| count.map_or("no".into(), |n| n.to_string()));
        let problem = format!("has {translations} translations, {rotations} rotations and {scales} scales");
        return Err(source.fail(&at, problem));
    }
    let of = |all: &Option<Vec<[f64; 3]>>, k: usize, rest| all.as_ref().map_or(rest, |all| DVec3::from_array(all[k]));
    let instance = |k: usize| {
        let rotation = match &rotations {
            None => DQuat::IDENTITY,
            Some(all) => unit_quat(DVec4::from_array(all[k])).ok_or_else(|| {
                source.fail(&at, format!("the rotation of instance {k} is a quaternion without length: {:?}", all[k]))
            })?,
        };
        let matrix = DAffine3::from_scale_rotation_translation(
            of(&scales, k, DVec3::ONE),
            rotation,
            of(&translations, k, DVec3::ZERO),
        );
        let finite = matrix.is_finite().then_some(matrix);
        finite.ok_or_else(|| source.fail(&at, format!("the transform of instance {k} is not finite")))
    };
    (0..count).map(instance).collect()
}
