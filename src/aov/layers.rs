//! Layers by name, as renderers write them: a channel `Z`, channels `N.X N.Y N.Z`, a part `shadow_sun` with a channel `Y`.

use super::AovError;
use super::exr_file::{ExrChannel, ExrFile};

/// Last parts of the three channels of a vector.
const VECTORS: [[&str; 3]; 3] = [["x", "y", "z"], ["r", "g", "b"], ["red", "green", "blue"]];
/// Last parts of the channel of a scalar, the first one there is taken.
const SCALARS: [&str; 8] = ["y", "z", "v", "r", "x", "red", "luminance", "value"];

/// A layer of one of a frame's files.
#[derive(Clone, Debug)]
pub(super) struct Found {
    /// Number of the file.
    pub(super) file: usize,
    /// Its channels.
    pub(super) channels: Vec<[usize; 2]>,
    /// 16 bits.
    pub(super) half: bool,
}

/// A channel's layer and last part, both as a job names them.
fn split(channel: &ExrChannel) -> (String, String) {
    let full = match channel.part.as_str() {
        "" => channel.name.clone(),
        part if channel.name == part || channel.name.starts_with(&format!("{part}.")) => channel.name.clone(),
        part => format!("{part}.{}", channel.name),
    };
    match full.rsplit_once('.') {
        Some((layer, last)) => (layer.to_owned(), last.to_owned()),
        None => (String::new(), full),
    }
}

/// Finds a layer of `count` channels, 1 or 3, in a frame's files. Names are compared without regard to case where none is
/// the same to the letter.
///
/// # Errors
/// [`AovError::Layer`], with the layers that are there.
pub(super) fn find(files: &[ExrFile], key: &str, layer: &str, count: usize) -> Result<Found, AovError> {
    let exact = |name: &str| name == layer;
    let loose = |name: &str| name.eq_ignore_ascii_case(layer);
    let any: [&dyn Fn(&str) -> bool; 2] = [&exact, &loose];
    for is_it in any {
        for (file, exr) in files.iter().enumerate() {
            if let Some(channels) = of(exr, is_it, count) {
                let half = channels.iter().any(|c| c.half);
                return Ok(Found { file, channels: channels.iter().map(|c| c.place).collect(), half });
            }
        }
    }
    let there = files.iter().flat_map(|f| &f.channels).any(|c| {
        let (of, last) = split(c);
        loose(&of) || loose(&format!("{of}.{last}")) || (of.is_empty() && loose(&last))
    });
    let problem = match (there, count) {
        (false, _) => "no layer of this name".to_owned(),
        (true, 1) => "the layer has no channel for a single value (Y, Z, V, R or X)".to_owned(),
        (true, _) => "the layer has not the three channels of a vector (X Y Z or R G B)".to_owned(),
    };
    let files_named = files.iter().map(|f| f.path.clone()).collect();
    Err(AovError::Layer {
        files: files_named,
        key: key.to_owned(),
        layer: layer.to_owned(),
        problem,
        known: known(files),
    })
}

/// The channels of a layer in a file.
fn of<'a>(exr: &'a ExrFile, is_it: &dyn Fn(&str) -> bool, count: usize) -> Option<Vec<&'a ExrChannel>> {
    let named = |suffix: &str| {
        exr.channels.iter().find(|c| {
            let (layer, last) = split(c);
            is_it(&layer) && last.eq_ignore_ascii_case(suffix)
        })
    };
    if count == 1 {
        let whole = exr.channels.iter().find(|c| {
            let (layer, last) = split(c);
            let full = if layer.is_empty() { last } else { format!("{layer}.{last}") };
            is_it(&full) || is_it(&c.name)
        });
        return whole.or_else(|| SCALARS.into_iter().find_map(named)).map(|c| vec![c]);
    }
    VECTORS.into_iter().find_map(|suffixes| suffixes.into_iter().map(named).collect())
}

/// The layers of files with their channels: `Z`, `N.(X Y Z)`.
fn known(files: &[ExrFile]) -> Vec<String> {
    let mut layers: Vec<(String, Vec<String>)> = Vec::new();
    for channel in files.iter().flat_map(|f| &f.channels) {
        let (layer, last) = split(channel);
        match layers.iter_mut().find(|(name, _)| *name == layer) {
            Some((_, channels)) => channels.push(last),
            None => layers.push((layer, vec![last])),
        }
    }
    let written = |(layer, channels): (String, Vec<String>)| match (layer.as_str(), &channels[..]) {
        ("", _) => channels.join(", "),
        (_, [one]) => format!("{layer}.{one}"),
        _ => format!("{layer}.({})", channels.join(" ")),
    };
    layers.into_iter().map(written).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aov::HeaderCamera;
    use crate::scene::Film;

    fn file(channels: &[(&str, &str)]) -> ExrFile {
        let channels = channels.iter().enumerate().map(|(c, (part, name))| ExrChannel {
            place: [0, c],
            part: (*part).to_owned(),
            name: (*name).to_owned(),
            half: *name == "h",
        });
        ExrFile {
            path: "a.exr".into(),
            film: Film { width: 1, height: 1 },
            channels: channels.collect(),
            camera: HeaderCamera::default(),
        }
    }

    #[test]
    fn layers_are_found_under_the_names_that_renderers_give_them() {
        let files = [
            file(&[("", "R"), ("", "Z"), ("", "N.X"), ("", "N.Y"), ("", "N.Z"), ("", "RenderLayer.Depth.V")]),
            file(&[("shadow_sun", "Y"), ("", "P.b"), ("", "P.g"), ("", "P.r"), ("", "shadow_key.red")]),
        ];
        let channels = |layer, count| find(&files, "k", layer, count).map(|f| (f.file, f.channels)).ok();
        assert_eq!(channels("Z", 1), Some((0, vec![[0, 1]])));
        assert_eq!(channels("N", 3), Some((0, vec![[0, 2], [0, 3], [0, 4]])));
        assert_eq!(channels("n", 3), Some((0, vec![[0, 2], [0, 3], [0, 4]])));
        assert_eq!(channels("P", 3), Some((1, vec![[0, 3], [0, 2], [0, 1]])), "in the order r, g, b");
        assert_eq!(channels("RenderLayer.Depth", 1), Some((0, vec![[0, 5]])));
        assert_eq!(channels("shadow_sun", 1), Some((1, vec![[0, 0]])), "a part of its own");
        assert_eq!(channels("shadow_key", 1), Some((1, vec![[0, 4]])));
        assert_eq!(channels("P.g", 1), Some((1, vec![[0, 2]])), "a channel by its full name");
        let missing = find(&files, "light \"rim\": aov", "shadow_rim", 1).unwrap_err().to_string();
        assert!(missing.contains("no layer of this name") && missing.contains("N.(X Y Z)"), "{missing}");
        assert!(missing.contains("shadow_sun.Y") && missing.contains("light \"rim\": aov"), "{missing}");
        let flat = find(&files, "k", "shadow_key", 3).unwrap_err().to_string();
        assert!(flat.contains("three channels"), "{flat}");
    }
}
