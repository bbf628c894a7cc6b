//! Animations: as read from files, which of them play, and what they then drive.
//!
//! A glTF file lists animations without saying which plays. Where the job names some, those play. Else all play that
//! move anything in the scene, in file order, from t = 0, except one that drives a property that an earlier one drives
//! already: a file of alternative actions (walk, run) plays its first, a file with an action per object plays them all.

use super::SceneError;
use super::model::{CameraTracks, LightTracks, Model, place};
use super::names::{did_you_mean, list, name_plain};
use super::track::Track;
use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;

const REMEDY: &str = "choose with --animation NAME or the key `animation`, a name or a list; [] plays none";

/// What a channel drives. Indices are those of the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Target {
    /// Of a node.
    Translation(usize),
    /// Of a node.
    Rotation(usize),
    /// Of a node.
    Scale(usize),
    /// Of a node: whether it and all below are seen.
    Visible(usize),
    /// Of a node: the weight of one morph target of its mesh.
    Weight(usize, usize),
    /// Of a camera: vertical field of view or half height.
    Lens(usize),
    /// Of a camera.
    Near(usize),
    /// Of a camera.
    Far(usize),
    /// Of a light.
    Range(usize),
    /// Of a light: half angle of the outer cone.
    Cone(usize),
}

/// One animation of a file.
#[derive(Debug)]
pub(super) struct Clip {
    /// The file that holds it.
    pub file: Arc<Path>,
    /// As in the file.
    pub name: Option<String>,
    /// Index in the file.
    pub index: usize,
    /// Those that move something in the scene.
    pub channels: Vec<(Target, Track)>,
}

/// What came of the choice.
#[derive(Debug, Default)]
pub(super) struct Played {
    /// Unique names, in the order of play.
    pub names: Vec<String>,
    /// Time of the last key, seconds; `None` without animation.
    pub last_key_s: Option<f64>,
}

/// Puts the channels of the chosen animations on the nodes, cameras and lights that they drive. Where two that are
/// named drive the same property, the one named first does; a note says so.
///
/// # Errors
/// [`SceneError::Animation`] for an unknown name.
pub(super) fn play(wanted: Option<&[String]>, model: &mut Model) -> Result<Played, SceneError> {
    let clips = std::mem::take(&mut model.clips);
    let names = name_plain("animation", clips.iter().map(|clip| clip.name.as_deref()));
    let chosen: Vec<usize> = match wanted {
        Some(wanted) => {
            let fail = |problem| SceneError::Animation { problem, known: list(&names), remedy: REMEDY };
            let index = |name: &String| names.iter().position(|known| known.unique == *name);
            let unknown = |name| fail(format!("no animation is named {name:?}{}", did_you_mean(&names, name)));
            wanted.iter().map(|name| index(name).ok_or_else(|| unknown(name))).collect::<Result<_, _>>()?
        }
        None => compatible(&clips),
    };
    let mut played = Played::default();
    let silent: Vec<_> =
        (0..clips.len()).filter(|k| !clips[*k].channels.is_empty() && !chosen.contains(k)).map(|k| &names[k]).collect();
    if !silent.is_empty() {
        let silent = list(silent);
        let playing = list(chosen.iter().map(|&k| &names[k]));
        model.notes.push(format!("animations that play: {playing}; that do not: {silent}; {REMEDY}"));
    }
    let mut clips: Vec<Option<Clip>> = clips.into_iter().map(Some).collect();
    let mut driven = BTreeSet::new();
    for index in chosen {
        // Taken already: the job names it twice.
        let Some(clip) = clips[index].take() else { continue };
        played.names.push(names[index].unique.clone());
        let mut clashes = 0;
        for (target, track) in clip.channels {
            if !driven.insert(target) {
                clashes += 1;
                continue;
            }
            let last = track.times_s.last().copied();
            played.last_key_s = played.last_key_s.into_iter().chain(last).reduce(f64::max);
            attach(target, track, model);
        }
        if clashes > 0 {
            let (file, clip) = (clip.file.display(), place("animation", clip.index, clip.name.as_deref()));
            model
                .notes
                .push(format!("{file}: {clip}: {clashes} properties are driven by an animation named before it"));
        }
    }
    Ok(played)
}

/// Animations that drive something, and nothing that an earlier one of them drives.
fn compatible(clips: &[Clip]) -> Vec<usize> {
    let mut driven = BTreeSet::new();
    let mut chosen = Vec::new();
    for (index, clip) in clips.iter().enumerate() {
        let targets = || clip.channels.iter().map(|(target, _)| *target);
        if !clip.channels.is_empty() && targets().all(|target| !driven.contains(&target)) {
            driven.extend(targets());
            chosen.push(index);
        }
    }
    chosen
}

fn attach(target: Target, track: Track, model: &mut Model) {
    let track = Some(track);
    match target {
        Target::Translation(node) => model.nodes[node].tracks.translation = track,
        Target::Rotation(node) => model.nodes[node].tracks.rotation = track,
        Target::Scale(node) => model.nodes[node].tracks.scale = track,
        Target::Visible(node) => model.nodes[node].tracks.visible = track,
        Target::Weight(node, k) => model.nodes[node].tracks.weights.extend(track.map(|track| (k, track))),
        Target::Lens(camera) => camera_tracks(model, camera).lens = track,
        Target::Near(camera) => camera_tracks(model, camera).near = track,
        Target::Far(camera) => camera_tracks(model, camera).far = track,
        Target::Range(light) => light_tracks(model, light).range = track,
        Target::Cone(light) => light_tracks(model, light).cone_rad = track,
    }
}

fn camera_tracks(model: &mut Model, camera: usize) -> &mut CameraTracks {
    &mut model.cameras[camera].tracks
}

fn light_tracks(model: &mut Model, light: usize) -> &mut LightTracks {
    &mut model.lights[light].tracks
}
