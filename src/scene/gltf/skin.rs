//! Skins, and the joints that each vertex of a primitive follows (glTF 2.0, section 3.7.3). Of a skin its joints and
//! inverse bind matrices are read; `skeleton` is a hint that decides nothing.

use super::accessor::Source;
use super::document::{Primitive, Skin as GltfSkin, entry};
use crate::scene::SceneError;
use crate::scene::model::{Influences, Mesh, Skin, place};
use glam::{DAffine3, DMat4};

/// Most that the last row of an inverse bind matrix may differ from 0 0 0 1, which it must be: writers that invert in
/// f32 leave some units in the last place behind. The row is then taken as it must be.
const LAST_ROW_SLACK: f64 = 1e-4;

/// A skin, given the place of each node of the file in the model.
///
/// # Errors
/// [`SceneError::Malformed`] for joints outside the scene, missing matrices, or ones that are not affine.
pub(super) fn read(
    source: Source<'_>,
    index: usize,
    skin: &GltfSkin,
    model_node: &[Option<usize>],
) -> Result<Skin, SceneError> {
    let at = place("skin", index, skin.name.as_deref());
    let joint = |&joint: &usize| {
        let node = entry(source.path, &at, "node", &source.document.nodes, joint)?;
        model_node[joint].ok_or_else(|| {
            let joint = place("node", joint, node.name.as_deref());
            source.fail(&at, format!("its joint, {joint}, is not in the scene that is used"))
        })
    };
    let joints: Vec<usize> = skin.joints.iter().map(joint).collect::<Result<_, _>>()?;
    if joints.is_empty() {
        return Err(source.fail(&at, "has no joints"));
    }
    let Some(accessor) = skin.inverse_bind_matrices else {
        return Ok(Skin { inverse_bind: vec![DAffine3::IDENTITY; joints.len()], joints });
    };
    let matrices = source.read::<16>(accessor, "MAT4")?;
    let at = format!("{at}, accessor {accessor}");
    if matrices.len() < joints.len() {
        let problem = format!("holds {} inverse bind matrices for {} joints", matrices.len(), joints.len());
        return Err(source.fail(&at, problem));
    }
    let affine = |(k, columns): (usize, &[f64; 16])| {
        let matrix = DMat4::from_cols_array(columns);
        let last_row = (matrix.row(3) - glam::DVec4::W).abs().max_element();
        if matrix.is_finite() && last_row <= LAST_ROW_SLACK {
            return Ok(DAffine3::from_mat4(matrix));
        }
        let problem = format!("inverse bind matrix {k} is not finite and affine: its last row is {}", matrix.row(3));
        Err(source.fail(&at, problem))
    };
    let inverse_bind = matrices.iter().take(joints.len()).enumerate().map(affine).collect::<Result<_, _>>()?;
    Ok(Skin { joints, inverse_bind })
}

/// Appends the influences of the vertices that the mesh took over from a primitive, by index there; returns how many of
/// them have joints but no weight. Those follow their first joint, as other readers have it. Weights are made to sum to
/// 1: quantised ones do not. Negative ones, which are not allowed, count as none.
///
/// # Errors
/// [`SceneError::Malformed`] for sets without a partner, too few elements, weights that are not finite.
pub(super) fn append_influences(
    source: Source<'_>,
    at: &str,
    primitive: &Primitive,
    taken: &[u32],
    mesh: &mut Mesh,
) -> Result<usize, SceneError> {
    let begun = mesh.vertices.len() - taken.len();
    let sets = read_sets(source, at, primitive)?;
    if sets.is_empty() && mesh.influences.is_none() {
        return Ok(0);
    }
    let influences = mesh.influences.get_or_insert_with(Influences::default);
    // Primitives before this one had no joints.
    influences.ends.resize(begun, influences.entries.len());
    let mut weightless = 0;
    for &vertex in taken {
        let first = influences.entries.len();
        let mut sum = 0.0;
        for set in &sets {
            let [joints, weights] = set.of(source, at, vertex)?;
            for (joint, weight) in joints.into_iter().zip(weights).filter(|(_, weight)| *weight > 0.0) {
                // Exact: component types of joints are unsigned integers of at most 16 bits.
                influences.entries.push((joint as u16, weight));
                sum += weight;
            }
        }
        influences.entries[first..].iter_mut().for_each(|(_, weight)| *weight /= sum);
        if influences.entries.len() == first
            && let Some(set) = sets.first()
        {
            weightless += 1;
            influences.entries.push((set.joints[vertex as usize][0] as u16, 1.0));
        }
        influences.ends.push(influences.entries.len());
    }
    Ok(weightless)
}

/// `JOINTS_n` and `WEIGHTS_n`.
struct Set {
    joints: Vec<[f64; 4]>,
    weights: Vec<[f64; 4]>,
    /// Index of the accessor of the weights.
    accessor: usize,
}

impl Set {
    fn of(&self, source: Source<'_>, at: &str, vertex: u32) -> Result<[[f64; 4]; 2], SceneError> {
        let (joints, weights) = (self.joints.get(vertex as usize), self.weights.get(vertex as usize));
        let Some((joints, weights)) = joints.copied().zip(weights.copied()) else {
            let (joints, weights) = (self.joints.len(), self.weights.len());
            let problem =
                format!("has joints for {joints} vertices and weights for {weights}, none for vertex {vertex}");
            return Err(source.fail(at, problem));
        };
        if let Some(bad) = weights.iter().find(|weight| !weight.is_finite()) {
            let problem = format!("the joint weight of vertex {vertex} is not finite: {bad}");
            return Err(source.fail(&format!("{at}, accessor {}", self.accessor), problem));
        }
        Ok([joints, weights])
    }
}

fn read_sets(source: Source<'_>, at: &str, primitive: &Primitive) -> Result<Vec<Set>, SceneError> {
    let attributes = &primitive.attributes.others;
    let mut sets = Vec::new();
    for n in 0.. {
        let [joints, weights] = ["JOINTS", "WEIGHTS"].map(|name| attributes.get(&format!("{name}_{n}")));
        match (joints, weights) {
            (None, None) => break,
            (Some(&joints), Some(&weights)) => sets.push(Set {
                joints: source.read_joints(joints)?,
                weights: source.read::<4>(weights, "VEC4")?,
                accessor: weights,
            }),
            _ => return Err(source.fail(at, format!("has only one of JOINTS_{n} and WEIGHTS_{n}"))),
        }
    }
    Ok(sets)
}

/// The first vertex that follows a joint which a skin does not have, with that joint.
pub(super) fn joint_beyond(mesh: &Mesh, skin: &Skin) -> Option<(usize, u16)> {
    let influences = mesh.influences.as_ref()?;
    let beyond = |vertex| {
        let joint = influences.of(vertex).iter().find(|(joint, _)| usize::from(*joint) >= skin.joints.len());
        joint.map(|&(joint, _)| (vertex, joint))
    };
    (0..mesh.vertices.len()).find_map(beyond)
}
