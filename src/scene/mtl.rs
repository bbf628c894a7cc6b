//! MTL: what of OBJ materials bears on shadows. `map_d` is a mask with a cutoff of one half; `d` (or `Tr` = 1 - d) below 1
//! without one follows the job's rule for blended materials. Everything else is skipped.
//!
//! A library or texture that cannot be found is noted, and its materials are opaque: OBJ files often come without.

use super::BlendRule;
use super::beside::{self, Reach};
use super::image::{self, Opacity};
use super::mask::{Mask, Wrap};
use super::model::Model;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

/// Alpha from which on a texel of `map_d` is there.
const CUTOFF: f64 = 0.5;

/// What casts of a material's triangles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Covering {
    /// Everything.
    Opaque,
    /// Nothing.
    Nothing,
    /// What the model's mask with this index leaves; texture coordinates = those of the file × `scale` + `offset`.
    Masked {
        /// Index.
        mask: u32,
        /// Per coordinate.
        scale: [f64; 2],
        /// Per coordinate.
        offset: [f64; 2],
    },
}

/// By material name.
pub(super) type Library = BTreeMap<String, Covering>;

/// The statements of one material.
#[derive(Clone, Debug, Default)]
struct Statements {
    name: String,
    dissolve: Option<f64>,
    map: Option<Map>,
}

/// A `map_d`.
#[derive(Clone, Debug, PartialEq)]
struct Map {
    file: String,
    scale: [f64; 2],
    offset: [f64; 2],
    clamp: bool,
}

/// Adds the materials of a library, whose text has been read, to `library`, their masks, textures and notes to the model.
pub(super) fn read(path: &Path, text: &str, rules: (BlendRule, Reach), library: &mut Library, model: &mut Model) {
    for material in parse(text) {
        let covering = cover(path, &material, rules, model);
        library.insert(material.name, covering);
    }
}

fn cover(path: &Path, material: &Statements, (blend, reach): (BlendRule, Reach), model: &mut Model) -> Covering {
    let factor = material.dissolve.unwrap_or(1.0);
    let Some(map) = &material.map else {
        return match blend {
            BlendRule::Ignore if factor < 1.0 => Covering::Nothing,
            BlendRule::Threshold(least) if factor < least => Covering::Nothing,
            _ => Covering::Opaque,
        };
    };
    let read = beside::path(path, &map.file.replace('\\', "/"), reach).map_err(str::to_owned).and_then(|file| {
        let bytes = beside::bytes(&file).map_err(|error| error.to_string())?;
        let image = image::decode(&bytes, Opacity::AlphaOrLuminance)?;
        Ok((file, image))
    });
    match read {
        Ok((file, image)) => {
            if !model.inputs.contains(&file) {
                model.inputs.push(file);
            }
            let wrap = if map.clamp { Wrap::Clamp } else { Wrap::Repeat };
            model.masks.push(Mask {
                image: Some(Arc::new(image)),
                wrap: [wrap; 2],
                linear: true,
                factor,
                cutoff: CUTOFF,
            });
            Covering::Masked { mask: (model.masks.len() - 1) as u32, scale: map.scale, offset: map.offset }
        }
        Err(problem) => {
            let Statements { name, .. } = material;
            model.notes.push(format!(
                "{}: material {name:?} taken as opaque: map_d {:?}: {problem}",
                path.display(),
                map.file
            ));
            Covering::Opaque
        }
    }
}

fn parse(text: &str) -> Vec<Statements> {
    let mut materials: Vec<Statements> = Vec::new();
    for line in text.lines() {
        let line = line.trim();
        let (key, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let rest = rest.trim();
        if key == "newmtl" {
            materials.push(Statements { name: rest.to_owned(), ..Statements::default() });
            continue;
        }
        let Some(material) = materials.last_mut() else { continue };
        let number = || rest.split_whitespace().next_back()?.parse::<f64>().ok().filter(|v| v.is_finite());
        match key {
            "d" => material.dissolve = number(),
            // Where both stand, d counts: exporters disagree about the sense of Tr.
            "Tr" if material.dissolve.is_none() => material.dissolve = number().map(|tr| 1.0 - tr),
            "map_d" => material.map = Some(map(rest)),
            _ => {}
        }
    }
    materials
}

/// The options and file of a `map_d`; a file name may hold blanks.
fn map(statement: &str) -> Map {
    let mut map = Map { file: String::new(), scale: [1.0; 2], offset: [0.0; 2], clamp: false };
    let mut rest = statement;
    while let Some((option, after)) = rest.split_once(char::is_whitespace).filter(|(word, _)| word.starts_with('-')) {
        rest = after.trim_start();
        let numbers = if matches!(option, "-o" | "-s" | "-t") { 3 } else { usize::from(option == "-mm") + 1 };
        let mut values = Vec::new();
        while values.len() < numbers {
            let Some((word, after)) = rest.split_once(char::is_whitespace) else { break };
            if numbers > 1 && word.parse::<f64>().is_err() {
                break;
            }
            values.push(word);
            rest = after.trim_start();
        }
        let pair = |old: [f64; 2]| -> [f64; 2] {
            std::array::from_fn(|k| values.get(k).and_then(|v: &&str| v.parse().ok()).unwrap_or(old[k]))
        };
        match option {
            "-s" => map.scale = pair(map.scale),
            "-o" => map.offset = pair(map.offset),
            "-clamp" => map.clamp = values == ["on"],
            _ => {}
        }
    }
    rest.clone_into(&mut map.file);
    map
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statements_are_found_among_others() {
        let text =
            "# x\nnewmtl a b\nKd 1 1 1\nd -halo 0.5\nTr 0.9\nnewmtl c\nTr 0.25\nmap_Kd k.png\nmap_d my leaf.png\n";
        let found = parse(text);
        assert_eq!((found[0].name.as_str(), found[0].dissolve, found[0].map.is_none()), ("a b", Some(0.5), true));
        assert_eq!((found[1].dissolve, found[1].map.as_ref().unwrap().file.as_str()), (Some(0.75), "my leaf.png"));
        let all = map("-s 2 3 1 -imfchan m -o 0.5 -clamp on -mm 0 1 -blendu off dir\\leaf 2.png");
        let want = Map { file: "dir\\leaf 2.png".into(), scale: [2.0, 3.0], offset: [0.5, 0.0], clamp: true };
        assert_eq!(all, want);
        assert_eq!(map("").file, "");
    }
}
