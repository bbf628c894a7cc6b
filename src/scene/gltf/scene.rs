//! Which scene of a file is used, and where its things stand in the model.

use super::document::Document;
use crate::scene::clip::Target;
use crate::scene::names::{Names, name_plain};
use std::collections::BTreeMap;

/// Scenes of the files read so far.
#[derive(Debug, Default)]
pub(in crate::scene) struct ScenesMet {
    /// True once a file has the scene that the job names.
    pub found: bool,
    /// All of them, for messages.
    pub names: Vec<Names>,
}

impl ScenesMet {
    /// Index of the scene to use: the one that the job names, else the file's default, else its first. `None` for a file
    /// without scenes, or a default that does not exist.
    pub(super) fn choose(&mut self, document: &Document, wanted: Option<&str>) -> Option<usize> {
        let names = name_plain("scene", document.scenes.iter().map(|scene| scene.name.as_deref()));
        let named = wanted.and_then(|wanted| names.iter().position(|names| names.unique == wanted));
        self.found |= named.is_some();
        self.names.extend(names);
        named.or(document.scene).or(if document.scenes.is_empty() { None } else { Some(0) })
    }
}

/// Places in the model of the things of a file.
#[derive(Debug, Default)]
pub(super) struct Placed {
    /// By index in the file; `None` for nodes that the scene does not use.
    pub nodes: Vec<Option<usize>>,
    /// By index in the file: a camera stands once for each node that holds it.
    pub cameras: BTreeMap<usize, Vec<usize>>,
    /// Likewise.
    pub lights: BTreeMap<usize, Vec<usize>>,
}

impl Placed {
    /// A property of all places of a camera of the file.
    pub(super) fn cameras_of(&self, index: usize, property: fn(usize) -> Target) -> Vec<Target> {
        self.cameras.get(&index).into_iter().flatten().copied().map(property).collect()
    }

    /// A property of all places of a light of the file.
    pub(super) fn lights_of(&self, index: usize, property: fn(usize) -> Target) -> Vec<Target> {
        self.lights.get(&index).into_iter().flatten().copied().map(property).collect()
    }
}
