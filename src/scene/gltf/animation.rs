//! Animations → tracks on nodes. All animations of a file play at once, from t = 0; where two drive the same property
//! of a node, the first wins and a note says so.

use super::accessor::Source;
use super::document::{Animation, Channel, entry};
use crate::scene::SceneError;
use crate::scene::model::{Local, Node, place};
use crate::scene::track::{Interpolation, Track, unit_quat};
use glam::DVec4;

/// A channel after reading: what it drives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Path {
    Translation,
    Rotation,
    Scale,
}

/// Puts the channels of all animations on their nodes. `model_node` maps a node's index in the file to its place in
/// `nodes`, `None` for nodes outside the active scene. Returns the last key's time in seconds and notes.
///
/// # Errors
/// [`SceneError::Malformed`] for keys that run backwards, wrong counts, values not finite, quaternions without length.
pub(super) fn attach(
    source: Source<'_>,
    nodes: &mut [Node],
    model_node: &[Option<usize>],
) -> Result<(Option<f64>, Vec<String>), SceneError> {
    let mut last_key_s: Option<f64> = None;
    let mut notes = Vec::new();
    for (index, animation) in source.document.animations.iter().enumerate() {
        let name = place("animation", index, animation.name.as_deref());
        for (k, channel) in animation.channels.iter().enumerate() {
            let at = format!("{name}, channel {k}");
            let path = match channel.target.path.as_str() {
                "translation" => Path::Translation,
                "rotation" => Path::Rotation,
                "scale" => Path::Scale,
                // Meshes with morph targets and pointers that matter have been refused before.
                "weights" | "pointer" => continue,
                other => return Err(source.fail(&at, format!("path {other:?} is unknown"))),
            };
            let Some(target) = channel.target.node else { continue };
            entry(source.path, &at, "node", &source.document.nodes, target)?;
            let Some(node) = model_node.get(target).copied().flatten().and_then(|node| nodes.get_mut(node)) else {
                continue;
            };
            if matches!(node.local, Local::Matrix(_)) {
                return Err(source.fail(&node.place(), "is animated but placed by a matrix instead of TRS"));
            }
            let slot = match path {
                Path::Translation => &mut node.tracks.translation,
                Path::Rotation => &mut node.tracks.rotation,
                Path::Scale => &mut node.tracks.scale,
            };
            if slot.is_some() {
                let node = node.place();
                notes.push(format!("{at}: {node} already has an animated {}; ignored", channel.target.path));
                continue;
            }
            let track = read_track(source, &at, animation, channel, path)?;
            last_key_s = super::latest(last_key_s, track.times_s.last().copied());
            *slot = Some(track);
        }
    }
    Ok((last_key_s, notes))
}

fn read_track(
    source: Source<'_>,
    at: &str,
    animation: &Animation,
    channel: &Channel,
    path: Path,
) -> Result<Track, SceneError> {
    let sampler = entry(source.path, at, "sampler", &animation.samplers, channel.sampler)?;
    let interpolation = match sampler.interpolation.as_deref() {
        None | Some("LINEAR") => Interpolation::Linear,
        Some("STEP") => Interpolation::Step,
        Some("CUBICSPLINE") => Interpolation::CubicSpline,
        Some(other) => return Err(source.fail(at, format!("interpolation {other:?} is unknown"))),
    };
    let times_s: Vec<f64> = source.read::<1>(sampler.input, "SCALAR")?.into_iter().map(|[t]| t).collect();
    let key_place = format!("{at}, accessor {}", sampler.input);
    if times_s.is_empty() || times_s.iter().any(|t| !t.is_finite()) {
        return Err(source.fail(&key_place, "key times are missing or not finite"));
    }
    if let Some(k) = times_s.windows(2).position(|w| w[1] < w[0]) {
        let problem = format!("key times run backwards: {} s, then {} s (key {})", times_s[k], times_s[k + 1], k + 1);
        return Err(source.fail(&key_place, problem));
    }
    let rotation = path == Path::Rotation;
    let mut values: Vec<DVec4> = if rotation {
        source.read::<4>(sampler.output, "VEC4")?.into_iter().map(DVec4::from_array).collect()
    } else {
        source.read::<3>(sampler.output, "VEC3")?.into_iter().map(|[x, y, z]| DVec4::new(x, y, z, 0.0)).collect()
    };
    let value_place = format!("{at}, accessor {}", sampler.output);
    let per_key = if interpolation == Interpolation::CubicSpline { 3 } else { 1 };
    if values.len() != per_key * times_s.len() {
        let problem = format!("holds {} values for {} keys of {per_key}", values.len(), times_s.len());
        return Err(source.fail(&value_place, problem));
    }
    if let Some(k) = values.iter().position(|v| !v.is_finite()) {
        return Err(source.fail(&value_place, format!("value {k} is not finite: {}", values[k])));
    }
    if rotation && interpolation != Interpolation::CubicSpline {
        for (k, value) in values.iter_mut().enumerate() {
            let unit = unit_quat(*value);
            *value = unit.ok_or_else(|| source.fail(&value_place, format!("quaternion {k} has no length")))?.into();
        }
    }
    Ok(Track { times_s, values, interpolation, rotation })
}
