//! What a reader of a plan has to know, in words that travel with it.

use crate::measure::LookupParams;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How the numbers of a plan are meant, and how its maps are drawn and looked up.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
pub struct Conventions {
    /// Axes and units of the world.
    pub world: String,
    /// How `origin` enters.
    pub origin: String,
    /// How matrices are written and applied.
    pub matrices: String,
    /// The clip space of the matrices.
    pub clip: String,
    /// Where texel (0, 0) lies, and what a texel's value stands for.
    pub texels: String,
    /// Film coordinates.
    pub film: String,
    /// Signs of directions and rotations.
    pub directions: String,
    /// Which map of a light answers for a point.
    pub domains: String,
    /// Which points are outside a map, and what they are taken for.
    pub outside: String,
    /// How the receiver's depth is compared.
    pub depth: String,
    /// How a map is filtered.
    pub filter: String,
    /// What `near` and `far` are, and their unit.
    #[serde(default)]
    pub depth_range: String,
    /// What is added to a caster's depth when the map is drawn.
    pub bias: String,
    /// How many bits the stored depth has.
    pub depth_format: String,
    /// Which points a light does not light at all.
    pub unlit: String,
    /// What witnesses are for.
    pub witnesses: String,
}

impl Conventions {
    /// With what a renderer makes of the answers.
    pub fn of(lookup: &LookupParams) -> Conventions {
        let mut conventions = Conventions::default();
        if lookup.is_temporal() {
            conventions.filter += &format!(
                "; then, where `reprojected` is stated, temporal reprojection: cache = w * s + (1 - w) * cache of the frame \
                 before at the same surface point, w = (1 - dist)^{}, s = 1 in shadow, dist = distance from the texel's centre, \
                 maximum norm, 1 at its border; shadowed above 0.5",
                lookup.confidence_power
            );
        }
        conventions
    }
}

impl Default for Conventions {
    fn default() -> Self {
        let words = |text: &str| text.to_owned();
        Self {
            world: words("right-handed, metres, y up"),
            origin: words(
                "every position and every *_from_world matrix is relative to origin: subtract origin (f64) from a world point first",
            ),
            matrices: words("4 rows of 4, applied to column vectors: clip = M * (x, y, z, 1)"),
            clip: words("OpenGL: -w <= x, y, z <= w, y up; after the viewport u, v and depth are 0.5 + 0.5 * ndc"),
            texels: words(
                "texel (0, 0) is at the bottom left, u right, v up; a texel stores the nearest depth at its centre, top-left rule, both faces drawn",
            ),
            film: words("pixels, x right, y down from the top left corner, centres at half integers"),
            directions: words(
                "direction is the way light travels, unit; rotation is a quaternion x, y, z, w that takes light-camera axes (right, up, backward) to the world",
            ),
            domains: words(
                "maps are in order: the first whose domain holds the point answers; domain tests in f64, sums of products from left to right as written, each operation rounded, borders where the schema puts them",
            ),
            outside: words(
                "test w before dividing: w <= 0, or u or v outside [0, 1), is outside; a point outside, or in no domain, is job.map.outside",
            ),
            depth: words(
                "receiver depth is clamped to [0, 1]; the point is in shadow when the stored depth is less than it",
            ),
            depth_range: words(
                "near and far of a map are metres: of the nearest and the farthest thing that its depth range keeps, from the light along the map's axis, or of a directional light along its direction from the origin (may be negative); the matrix leaves a margin at both ends; near and far of light_camera are metres along its view axis to where clip depth is -1 and 1",
            ),
            filter: words("nearest texel: (floor(u * width), floor(v * height))"),
            bias: words(
                "stored = depth + constant + min(slope * max(|z_u|, |z_v|), clamp) in window depth, z_u and z_v the caster's depth slopes per texel; no clamp key means no clamp",
            ),
            depth_format: words("f32"),
            unlit: words(
                "points outside a spot's cone (cone_degrees from its axis) or beyond a light's range are unlit: no map is looked up",
            ),
            witnesses: words(
                "points with the uv and depth that clip_from_world gives them, and whether they are in shadow exactly: check an importer with them; points on surfaces of the frame, some lifted towards the light, and where few are seen others that the map holds",
            ),
        }
    }
}
