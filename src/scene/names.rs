//! Names of cameras, lights and animations: how a job refers to them, and how they are listed.

use super::model::Node;
use std::collections::{BTreeMap, BTreeSet};

/// The names of one camera, light or animation of a file.
#[derive(Clone, Debug)]
pub(super) struct Names {
    /// Unique among its kind: its own name where no other has it, else its node's name, else the kind with a number;
    /// repeated ones are numbered.
    pub unique: String,
    /// The other names it goes by.
    pub also: Vec<String>,
}

/// Names of all things of a kind, given the nodes that hold them and their own names.
pub(super) fn name_all<'a>(kind: &str, things: impl Iterator<Item = (&'a Node, Option<&'a str>)>) -> Vec<Names> {
    unique(kind, things.map(|(node, own)| [own, node.name.as_deref()]))
}

/// Names of all things of a kind that no node holds, given their own names.
pub(super) fn name_plain<'a>(kind: &str, things: impl Iterator<Item = Option<&'a str>>) -> Vec<Names> {
    unique(kind, things.map(|own| [own, None]))
}

fn unique<'a>(kind: &str, things: impl Iterator<Item = [Option<&'a str>; 2]>) -> Vec<Names> {
    let things: Vec<_> = things.map(|names| names.map(|name| name.filter(|name| !name.is_empty()))).collect();
    let mut uses = BTreeMap::new();
    for [own, _] in &things {
        *uses.entry(*own).or_insert(0) += 1;
    }
    let mut taken = BTreeSet::new();
    let mut all = Vec::with_capacity(things.len());
    for (index, &[own, node]) in things.iter().enumerate() {
        let own_if_unique = own.filter(|_| uses[&own] == 1);
        let wish = own_if_unique.or(node).or(own).map_or_else(|| format!("{kind}-{index}"), str::to_owned);
        let mut unique = wish.clone();
        let mut number = 2;
        while !taken.insert(unique.clone()) {
            unique = format!("{wish}-{number}");
            number += 1;
        }
        all.push(Names { unique, also: [own, node].into_iter().flatten().map(str::to_owned).collect() });
    }
    all
}

/// What a name stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Found {
    /// The only one, by its index.
    One(usize),
    /// Nothing.
    None,
    /// More than one.
    Several,
}

/// The thing that goes by a name: unique names first, then the others.
pub(super) fn find(all: &[Names], wanted: &str) -> Found {
    if let Some(index) = all.iter().position(|names| names.unique == wanted) {
        return Found::One(index);
    }
    let mut matches = (0..all.len()).filter(|&index| all[index].also.iter().any(|name| name == wanted));
    match (matches.next(), matches.next()) {
        (Some(index), None) => Found::One(index),
        (None, _) => Found::None,
        _ => Found::Several,
    }
}

/// For messages: `"sun", "lamp"`, or `none`.
pub(super) fn list<'a>(all: impl IntoIterator<Item = &'a Names>) -> String {
    let quoted: Vec<String> = all.into_iter().map(|names| format!("{:?}", names.unique)).collect();
    if quoted.is_empty() { "none".into() } else { quoted.join(", ") }
}

/// For messages: the nearest known name to one that was not found.
pub(super) fn did_you_mean(all: &[Names], wanted: &str) -> String {
    let names = all.iter().flat_map(|names| std::iter::once(&names.unique).chain(&names.also));
    let nearest = names.map(|name| (strsim::damerau_levenshtein(name, wanted), name)).min();
    match nearest {
        Some((distance, name)) if distance <= wanted.chars().count() / 2 => format!(" (did you mean {name:?}?)"),
        _ => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::model::{Local, Tracks};
    use glam::DAffine3;
    use std::path::Path;
    use std::sync::Arc;

    fn node(name: Option<&str>) -> Node {
        Node {
            file: Arc::from(Path::new("a.gltf")),
            name: name.map(str::to_owned),
            index: 0,
            parent: None,
            local: Local::Matrix(DAffine3::IDENTITY),
            hidden: false,
            weights: None,
            tracks: Tracks::default(),
        }
    }

    #[test]
    fn names_are_unique_and_found() {
        let nodes = [node(Some("lamp")), node(Some("lamp")), node(None), node(None), node(Some("lamp-2"))];
        let own = [Some("A"), Some("B"), Some("bulb"), None, Some("B")];
        let all = name_all("light", nodes.iter().zip(own));
        let unique: Vec<&str> = all.iter().map(|names| names.unique.as_str()).collect();
        assert_eq!(unique, ["A", "lamp", "bulb", "light-3", "lamp-2"]);
        assert_eq!(find(&all, "lamp"), Found::One(1));
        assert_eq!(find(&all, "A"), Found::One(0));
        assert_eq!(find(&all, "B"), Found::Several);
        assert_eq!(find(&all, "x"), Found::None);
        let twins =
            name_all("camera", [node(None), node(None), node(Some(""))].iter().zip([Some("B"), Some("B"), None]));
        assert_eq!(twins.iter().map(|names| names.unique.as_str()).collect::<Vec<_>>(), ["B", "B-2", "camera-2"]);
        assert_eq!(did_you_mean(&all, "blub"), " (did you mean \"bulb\"?)");
        assert_eq!(did_you_mean(&all, "xyzzy"), "");
    }
}
