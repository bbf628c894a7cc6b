//! The courtyard: what stands where. World axes: x east, y up, z south; metres; the middle of the court is the origin.
//!
//! North: a terrace behind a broad stair, with an arcade, a wall and a hanging lantern (`lamp`). West: a wrought-iron
//! fence with a swinging gate; the low `sun` comes through it. East: a pierced wall whose bracket holds the `spot`.

mod arcade;
#[path = "../../authoring/mod.rs"]
mod authoring;
mod court;
mod fence;
mod shot;
mod terrace;
mod tree;
mod walls;

use authoring::document::Document;

/// Everything sits this much below y = 0, which is more than the deepest hollow of the uneven ground: nothing floats.
const FOOTING_M: f64 = 0.06;

/// Height of the terrace above the court.
const TERRACE_M: f64 = 1.05;

/// Indices of the materials.
struct Palette {
    paving: usize,
    stone: usize,
    plaster: usize,
    iron: usize,
    wood: usize,
    bark: usize,
    leaf: usize,
    water: usize,
}

/// The whole scene as the bytes of a `.glb` file. The same bytes on every run.
pub(crate) fn build() -> std::io::Result<Vec<u8>> {
    let mut doc = Document::default();
    let palette = Palette {
        paving: doc.material("paving", [0.50, 0.44, 0.37], 0.0, 0.95),
        stone: doc.material("stone", [0.68, 0.62, 0.52], 0.0, 0.85),
        plaster: doc.material("plaster", [0.74, 0.56, 0.41], 0.0, 0.95),
        iron: doc.material("iron", [0.06, 0.06, 0.065], 0.8, 0.5),
        wood: doc.material("wood", [0.33, 0.20, 0.11], 0.0, 0.75),
        bark: doc.material("bark", [0.22, 0.16, 0.11], 0.0, 0.95),
        leaf: doc.material("leaf", [0.16, 0.30, 0.07], 0.0, 0.7),
        water: doc.material("water", [0.05, 0.12, 0.13], 0.0, 0.1),
    };
    let roots = [
        terrace::build(&mut doc, &palette),
        arcade::build(&mut doc, &palette),
        walls::build(&mut doc, &palette),
        fence::build(&mut doc, &palette),
        court::build(&mut doc, &palette),
        tree::build(&mut doc, &palette),
        shot::sun(&mut doc),
        shot::camera(&mut doc),
    ];
    doc.into_glb("courtyard", &roots)
}
