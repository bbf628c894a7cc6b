//! `[solver]`: how the matrix of a light is found.

use super::Method;
use crate::fit::Effort;
use crate::metric::Metric;
use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `[solver]`: how the matrix of a light is found.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct SolverParams {
    /// The method.
    pub method: Method,
    /// What `lixel` minimises; the other methods have their own.
    pub metric: Metric,
    /// Rounds of reweighting of the `displacement` and `saturating` metrics, 0 to 100.
    pub rounds: u32,
    /// Relative, in (0, 1]: the search stops when its simplex spans less than this in the objective, the rounds when one
    /// improves the objective by less.
    pub tolerance: f64,
    /// How far the search goes.
    pub effort: Effort,
    /// Rounds of choosing between maps by measured error, each among eight maps near the best ones so far, before the first
    /// of which the other metrics' and methods' answers are measured too. 0 = trust the metric. At most 1000.
    pub measured_rounds: u32,
    /// `partitioned`: most maps of a light (of each cube face, for a light among the geometry), 1 to 64.
    pub maps: u32,
    /// `auto`: most maps of a light (of each cube face, for a light among the geometry), 1 to 64. 1 = never several.
    pub max_maps: u32,
    /// `auto`: a step to the next method, or to one map more, has to save this share of the texels, in [0, 1). Each map is
    /// drawn and looked up besides, and the sizes themselves come in steps of a few percent, so that less is not worth a
    /// renderer's while. 0 = whatever saves anything.
    pub min_saving: f64,
    /// `adaptive`, `edges`: most tiles of a light (of each cube face), 1 to 1024.
    pub tiles: u32,
    /// `psm`: the camera slides back until the plane at infinity lies at this depth or deeper, in the post-perspective
    /// depth of its view, where 0 is near and 1 is far; at least 1. 1 = never.
    pub psm_infinity: f64,
    /// `tsm`: share of the trapezoid's depth, from its top, that is in focus, in (0, 1).
    pub tsm_depth: f64,
    /// `tsm`: share of the map that the focus gets, in (0, 1). Equal to `tsm_depth` = no warp.
    pub tsm_focus: f64,
    /// `plane-optimal`: the plane [a, b, c, d] of points with a x + b y + c z + d = 0, world space, metres. Absent = the
    /// plane that holds most shadow edge.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plane: Option<[f64; 4]>,
    /// `homography-area`: over what the areas are compared.
    pub area: AreaOver,
    /// `separating-plane`: the map beside the focused one.
    pub separating_map: PerspectiveMethod,
    /// `separating-plane`: 1 = both maps around the whole view; each further iteration fits each map to its own side of
    /// the plane, and but for the last one the plane to the maps. 1 to 100.
    pub separating_iterations: u32,
    /// `cascades`: number of depth ranges, 1 to 16. One that holds nothing to cover gets no map.
    pub cascade_count: u32,
    /// `cascades`: where the depth ranges end.
    pub cascade_split: CascadeSplit,
    /// `cascades`: part of the logarithmic split in `cascade_split = "blend"`, in [0, 1].
    pub cascade_blend: f64,
    /// `cascades`: the map of a range.
    pub cascade_fit: CascadeFit,
}

/// `solver.separating_map`: the map that shares a light with a focused one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum PerspectiveMethod {
    /// As the method `psm`.
    Psm,
    /// As the method `tsm`.
    Tsm,
    /// As the method `lispsm`.
    #[default]
    Lispsm,
}

/// `solver.cascade_split`: where cascades end, from the near end n of the view to its far end f.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum CascadeSplit {
    /// n + (f - n) i / m.
    Uniform,
    /// n (f / n)^(i / m).
    Log,
    /// Between the two, by `cascade_blend`.
    #[default]
    Blend,
    /// Logarithmic between the nearest and the farthest covered point, each map around the covered points of its range
    /// alone.
    Samples,
}

/// `solver.cascade_fit`: the map of a cascade.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum CascadeFit {
    /// The smallest rectangle around its part of the view.
    #[default]
    Plain,
    /// A square of a size that does not change as the camera turns, on a grid that does not move: texels stand still.
    Stable,
    /// As the method `lispsm` for its part of the view.
    Warped,
}

/// `solver.area`: over what `homography-area` compares areas.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum AreaOver {
    /// The samples of the shadow edges, over all homographies.
    #[default]
    Samples,
    /// A normal distribution fitted to them, over all homographies.
    Normal,
    /// The samples, over the planes whose normals lie between camera and light.
    Alpha,
}

impl SolverParams {
    /// The same for a scene whose zero stands at `origin`, world space.
    pub fn in_scene_space(&self, origin: DVec3) -> SolverParams {
        let plane = self.plane.map(|[a, b, c, d]| [a, b, c, d + DVec3::new(a, b, c).dot(origin)]);
        SolverParams { plane, ..self.clone() }
    }
}

impl Default for SolverParams {
    fn default() -> Self {
        Self {
            method: Method::default(),
            metric: Metric::default(),
            rounds: 6,
            tolerance: 0.001,
            effort: Effort::default(),
            measured_rounds: 16,
            maps: 4,
            max_maps: 4,
            min_saving: 0.15,
            tiles: 32,
            psm_infinity: 1.5,
            tsm_depth: 0.52,
            tsm_focus: 0.8,
            plane: None,
            area: AreaOver::default(),
            separating_map: PerspectiveMethod::default(),
            separating_iterations: 20,
            cascade_count: 4,
            cascade_split: CascadeSplit::default(),
            cascade_blend: 0.5,
            cascade_fit: CascadeFit::default(),
        }
    }
}
