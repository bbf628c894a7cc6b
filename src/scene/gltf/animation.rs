//! Animations → clips of the model: the channels that drive a node, camera or light of the scene, as tracks.

use super::accessor::Source;
use super::document::{Animation, Channel, Sampler, entry};
use super::pointer::{self, Property};
use super::scene::Placed;
use crate::scene::SceneError;
use crate::scene::clip::{Clip, Target};
use crate::scene::model::{Local, Model, place};
use crate::scene::track::{Interpolation, Track, unit_quat};
use glam::DVec4;
use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;

/// Adds the animations of a file to the model, whose nodes, cameras and lights of the file stand as `placed` says.
/// Returns notes.
///
/// # Errors
/// [`SceneError::Malformed`] for keys that run backwards, wrong counts, values not finite, quaternions without length,
/// references to nothing.
pub(super) fn read(
    source: Source<'_>,
    file: &Arc<Path>,
    placed: &Placed,
    model: &mut Model,
) -> Result<Vec<String>, SceneError> {
    let mut notes = Vec::new();
    let mut not_followed = BTreeSet::new();
    for (index, animation) in source.document.animations.iter().enumerate() {
        let name = place("animation", index, animation.name.as_deref());
        let mut channels: Vec<(Target, Track)> = Vec::new();
        let mut driven = BTreeSet::new();
        for (k, channel) in animation.channels.iter().enumerate() {
            let at = format!("{name}, channel {k}");
            let Some(property) = property(source, &at, channel, &mut not_followed)? else { continue };
            for (targets, track) in tracks(source, &at, animation, channel, property, placed)? {
                for target in targets {
                    placed_by_trs(source, model, target)?;
                    if driven.insert(target) {
                        channels.push((target, track.clone()));
                    } else {
                        notes.push(format!("{at}: an earlier channel drives the same; ignored"));
                    }
                }
            }
        }
        model.clips.push(Clip { file: Arc::clone(file), name: animation.name.clone(), index, channels });
    }
    if !not_followed.is_empty() {
        let list: Vec<String> = not_followed.into_iter().collect();
        notes.push(format!("animated properties that are not followed: {}", list.join(", ")));
    }
    Ok(notes)
}

/// What a channel drives; `None` when nothing that bears on shadows. Pointers of that kind are added to `not_followed`.
fn property(
    source: Source<'_>,
    at: &str,
    channel: &Channel,
    not_followed: &mut BTreeSet<String>,
) -> Result<Option<Property>, SceneError> {
    if let Some(pointer) = &channel.target.extensions.pointer {
        let found = pointer::resolve(source, at, &pointer.pointer)?;
        if found.is_none() {
            not_followed.insert(pointer::pattern(&pointer.pointer));
        }
        return Ok(found);
    }
    // Without a node the channel is an extension's (section 3.11).
    let Some(node) = channel.target.node else { return Ok(None) };
    entry(source.path, at, "node", &source.document.nodes, node)?;
    Ok(Some(match channel.target.path.as_str() {
        "translation" => Property::Translation(node),
        "rotation" => Property::Rotation(node),
        "scale" => Property::Scale(node),
        "weights" => Property::NodeWeights(node),
        other => return Err(source.fail(at, format!("path {other:?} is unknown"))),
    }))
}

/// The tracks of a channel, each with the places in the model that it drives. Nothing is read where there are none.
fn tracks(
    source: Source<'_>,
    at: &str,
    animation: &Animation,
    channel: &Channel,
    property: Property,
    placed: &Placed,
) -> Result<Vec<(Vec<Target>, Track)>, SceneError> {
    let node = |node: usize, target: fn(usize) -> Target| placed.nodes[node].into_iter().map(target).collect();
    let targets: Vec<Vec<Target>> = match property {
        Property::Translation(index) => vec![node(index, Target::Translation)],
        Property::Rotation(index) => vec![node(index, Target::Rotation)],
        Property::Scale(index) => vec![node(index, Target::Scale)],
        Property::Visible(index) => vec![node(index, Target::Visible)],
        Property::NodeWeights(index) => by_target(source, source.document.nodes[index].mesh, &[index], placed),
        Property::MeshWeights(index) => by_target(source, Some(index), &without_weights(source, index), placed),
        Property::NodeWeight(index, k) => vec![weight(&[index], k, placed)],
        Property::MeshWeight(index, k) => vec![weight(&without_weights(source, index), k, placed)],
        Property::YFov(index) | Property::YMag(index) => vec![placed.cameras_of(index, Target::Lens)],
        Property::ZNear(index) => vec![placed.cameras_of(index, Target::Near)],
        Property::ZFar(index) => vec![placed.cameras_of(index, Target::Far)],
        Property::Range(index) => vec![placed.lights_of(index, Target::Range)],
        Property::OuterConeAngle(index) => vec![placed.lights_of(index, Target::Cone)],
    };
    if targets.iter().all(Vec::is_empty) {
        return Ok(Vec::new());
    }
    let sampler = entry(source.path, at, "sampler", &animation.samplers, channel.sampler)?;
    let mut keys = Keys::read(source, at, sampler)?;
    match property {
        Property::Visible(_) => keys.interpolation = Interpolation::Step,
        Property::Rotation(_) => keys.rotation = true,
        _ => {}
    }
    let values: Vec<DVec4> = match property {
        Property::Rotation(_) => source.read::<4>(sampler.output, "VEC4")?.into_iter().map(DVec4::from_array).collect(),
        Property::Translation(_) | Property::Scale(_) => {
            source.read::<3>(sampler.output, "VEC3")?.into_iter().map(|[x, y, z]| DVec4::new(x, y, z, 0.0)).collect()
        }
        _ => source.read::<1>(sampler.output, "SCALAR")?.into_iter().map(|[x]| DVec4::new(x, 0.0, 0.0, 0.0)).collect(),
    };
    let tracks = keys.split(source, &format!("{at}, accessor {}", sampler.output), values, targets.len())?;
    Ok(targets.into_iter().zip(tracks).collect())
}

/// For each morph target of a mesh, the places of its weight at nodes of the file.
fn by_target(source: Source<'_>, mesh: Option<usize>, nodes: &[usize], placed: &Placed) -> Vec<Vec<Target>> {
    let mesh = mesh.and_then(|mesh| source.document.meshes.get(mesh));
    let count = mesh.into_iter().flat_map(|mesh| &mesh.primitives).map(|primitive| primitive.targets.len()).max();
    (0..count.unwrap_or(0)).map(|k| weight(nodes, k, placed)).collect()
}

fn weight(nodes: &[usize], k: usize, placed: &Placed) -> Vec<Target> {
    nodes.iter().filter_map(|&node| placed.nodes[node]).map(|node| Target::Weight(node, k)).collect()
}

/// Nodes of the file that use a mesh and its weights.
fn without_weights(source: Source<'_>, mesh: usize) -> Vec<usize> {
    let nodes = source.document.nodes.iter().enumerate();
    nodes.filter(|(_, node)| node.mesh == Some(mesh) && node.weights.is_none()).map(|(index, _)| index).collect()
}

/// An animated transform must be written as TRS.
fn placed_by_trs(source: Source<'_>, model: &Model, target: Target) -> Result<(), SceneError> {
    match target {
        Target::Translation(node) | Target::Rotation(node) | Target::Scale(node)
            if matches!(model.nodes[node].local, Local::Matrix(_)) =>
        {
            Err(source.fail(&model.nodes[node].place(), "is animated but placed by a matrix instead of TRS"))
        }
        _ => Ok(()),
    }
}

/// The input of a sampler.
struct Keys {
    times_s: Vec<f64>,
    interpolation: Interpolation,
    rotation: bool,
}

impl Keys {
    fn read(source: Source<'_>, at: &str, sampler: &Sampler) -> Result<Self, SceneError> {
        let interpolation = match sampler.interpolation.as_deref() {
            None | Some("LINEAR") => Interpolation::Linear,
            Some("STEP") => Interpolation::Step,
            Some("CUBICSPLINE") => Interpolation::CubicSpline,
            Some(other) => return Err(source.fail(at, format!("interpolation {other:?} is unknown"))),
        };
        let times_s: Vec<f64> = source.read::<1>(sampler.input, "SCALAR")?.into_iter().map(|[t]| t).collect();
        let at = format!("{at}, accessor {}", sampler.input);
        if times_s.is_empty() || times_s.iter().any(|t| !t.is_finite()) {
            return Err(source.fail(&at, "key times are missing or not finite"));
        }
        if let Some(k) = times_s.windows(2).position(|w| w[1] < w[0]) {
            let problem =
                format!("key times run backwards: {} s, then {} s (key {})", times_s[k], times_s[k + 1], k + 1);
            return Err(source.fail(&at, problem));
        }
        Ok(Keys { times_s, interpolation, rotation: false })
    }

    /// One track for each of `width` values that a key holds side by side; a spline's key holds three such rows.
    fn split(
        self,
        source: Source<'_>,
        at: &str,
        mut values: Vec<DVec4>,
        width: usize,
    ) -> Result<Vec<Track>, SceneError> {
        let rows = if self.interpolation == Interpolation::CubicSpline { 3 } else { 1 };
        if values.len() != rows * width * self.times_s.len() {
            let (have, keys) = (values.len(), self.times_s.len());
            return Err(source.fail(at, format!("holds {have} values for {keys} keys of {}", rows * width)));
        }
        if let Some(k) = values.iter().position(|v| !v.is_finite()) {
            return Err(source.fail(at, format!("value {k} is not finite: {}", values[k])));
        }
        if self.rotation && rows == 1 {
            for (k, value) in values.iter_mut().enumerate() {
                let unit = unit_quat(*value);
                *value = unit.ok_or_else(|| source.fail(at, format!("quaternion {k} has no length")))?.into();
            }
        }
        let track = |column: usize| Track {
            times_s: self.times_s.clone(),
            values: values.iter().skip(column).step_by(width).copied().collect(),
            interpolation: self.interpolation,
            rotation: self.rotation,
        };
        Ok((0..width).map(track).collect())
    }
}
