//! One file a method, one signature: [`Inputs`] → regions, or the named reason why the method does not apply.
//!
//! A region is a homography of a light plane with the points that look it up. Row 3, sizes and bias come later.

mod adaptive;
mod along;
mod body;
mod cascades;
mod faces;
mod focused;
mod homography_area;
mod in_plane;
mod lispsm;
mod lixel;
mod normal;
mod on_plane;
mod params;
mod partitioned;
mod plane;
mod plane_fit;
mod plane_optimal;
mod psm;
mod region;
mod scene_optimal;
mod separating_plane;
mod split;
mod tsm;

pub use params::{AreaOver, CascadeFit, CascadeSplit, PerspectiveMethod, SolverParams};
pub use region::{Prediction, Region, Report};

use crate::fit::{Aspect, Shape, Step};
use crate::math::{Bounds, LightSpaceError};
use crate::samples::EdgePoint;
use crate::scene::{Camera, Film, Light};
use glam::{DVec2, DVec3, DVec4};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A method of choosing the light matrix.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Minimises the displacement of the shadow edges on the film over all allowed matrices.
    #[default]
    Lixel,
    /// The light's frustum over the whole scene, blind to the camera.
    Normal,
    /// The smallest rectangle around what both the camera and the light see.
    Focused,
    /// Scene-optimised shadow mapping, Algorithm 1 as published.
    SceneOptimal,
    /// Perspective shadow maps: the light in the camera's post-perspective space.
    Psm,
    /// Trapezoidal shadow maps: the trapezoid around the view, a share of its depth onto a share of the map.
    Tsm,
    /// Light space perspective shadow maps: a perspective along the view, balanced between its near and far end.
    Lispsm,
    /// Constant sampling of the film on one plane of the scene.
    PlaneOptimal,
    /// Film areas and map areas as equal as can be, over samples or a model of them.
    HomographyArea,
    /// A focused map and a perspective one, apart where the two sample alike: on one plane through the light.
    SeparatingPlane,
    /// Cascades: the view in ranges of depth, a map for each.
    Cascades,
    /// The faces of the view frustum, a map for each: side faces with a warp, end faces without.
    Faces,
    /// `lixel` with up to `solver.maps` maps: the cover split by planes where that lowers the error at equal texels most.
    Partitioned,
    /// Quadtree tiles of the light plane, finer where pixels are, with equal texels.
    Adaptive,
    /// Quadtree tiles of the light plane, finer where shadow edges are, with texels by what their edges cost.
    Edges,
    /// No map: exact visibility at every pixel, as an irregular z-buffer gives it. For comparison only.
    Irregular,
    /// The simplest of `focused`, `lixel` and `partitioned` with 2, 3, … up to `solver.max_maps` maps from which a further
    /// step would save less than `solver.min_saving` of the texels.
    Auto,
    /// Of `lixel` and the other methods with one map, the one with the fewest wrong pixels at equal texels, as measured.
    Best,
}

impl Method {
    /// As in a job.
    pub fn name(self) -> String {
        match serde_json::to_value(self) {
            Ok(serde_json::Value::String(name)) => name,
            other => format!("{other:?}"),
        }
    }

    /// The keys of `[solver]` that are this method's alone.
    pub fn own_settings(self) -> &'static [&'static str] {
        match self {
            Method::Lixel => &["metric", "effort"],
            Method::Psm => &["psm_infinity"],
            Method::Tsm => &["tsm_focus", "tsm_depth"],
            Method::HomographyArea => &["area"],
            Method::SeparatingPlane => &["separating_map", "separating_iterations"],
            Method::Cascades => &["cascade_split", "cascade_fit", "cascade_count", "cascade_blend"],
            Method::PlaneOptimal => &["plane"],
            Method::Partitioned => &["maps", "metric", "effort"],
            Method::Auto => &["max_maps", "min_saving", "metric", "effort"],
            Method::Best => &["metric", "effort"],
            Method::Adaptive | Method::Edges => &["tiles"],
            Method::Normal
            | Method::Focused
            | Method::SceneOptimal
            | Method::Lispsm
            | Method::Faces
            | Method::Irregular => &[],
        }
    }
}

/// What a method gets: one light in one frame.
#[derive(Clone, Copy)]
pub struct Inputs<'a> {
    /// Camera of the frame.
    pub camera: &'a Camera,
    /// Film it exposes.
    pub film: Film,
    /// The light.
    pub light: &'a Light,
    /// All geometry of the frame.
    pub bounds: Bounds,
    /// Shadow edges on the film.
    pub edges: &'a [EdgePoint],
    /// Scene points that the maps have to hold.
    pub covered: &'a [DVec3],
    /// The covered points are but the vertices of their hull as seen from the light: the maps hold all that lies between
    /// them.
    pub hull_only: bool,
    /// Half-spaces (n, d), inside where n·p + d ≥ 0, that cut the view frustum: what of it one map of several answers
    /// for. None for a whole light.
    pub clip: &'a [DVec4],
    /// Texels to spend, for metrics that do not scale with them.
    pub texels: f64,
    /// Width over height.
    pub aspect: Aspect,
    /// What the renderer can carry.
    pub shape: Shape,
    /// Settings of the search.
    pub solver: &'a SolverParams,
    /// Most edge samples kept per region.
    pub sample_cap: usize,
}

/// Why a method gives no map.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Inapplicable {
    /// Irregular z-buffers.
    #[error("exact visibility at every pixel has no map: \"irregular\" takes part in comparisons only")]
    NoMap,
    /// They are resolved before there is anything to solve.
    #[error("\"auto\" and \"best\" choose among other methods and have no matrix of their own")]
    Chooses,
    /// No point is covered.
    #[error("nothing to cover")]
    Empty,
    /// Points in front of and behind the light, or all around it.
    #[error("the covered points seen from the light do not fit one half-space")]
    NoHalfSpace,
    /// The search found no matrix with finite error.
    #[error("no legal matrix has a finite error: the light grazes every edge, or the cover has no extent")]
    NoFiniteFit,
    /// The camera and the light have no common volume.
    #[error("the camera's view, the light's reach and the scene have no common volume")]
    NoCommonVolume,
    /// A visible point at or behind the light.
    #[error("a covered point lies at the light, or behind the image plane that the method gives the light")]
    CoveredBehindLight,
    /// A warp was asked of a renderer that carries none.
    #[error("the method is a perspective warp, which map.shape forbids: allow \"projective\"")]
    ShapeForbidsWarp,
    /// The warp's vanishing line crosses what is to be covered.
    #[error("covered points lie on both sides of the warp's vanishing line (w = 0)")]
    StraddlesVanishingLine,
    /// LiSPSM: z1/z0 is not a positive number.
    #[error("no n_opt: the near end of the body, seen from the light, does not lie in front of the camera")]
    NoOptimalNear,
    /// TSM: the view axis passes through the light.
    #[error("no centre line: the camera looks along the light, the near and far ends of its view coincide in the map")]
    NoCentreLine,
    /// PSM: the light stands in the unit cube of the post-perspective space.
    #[error("in the camera's post-perspective space the light stands inside or too near to the view")]
    LightInView,
    /// Nothing to fit a plane or a distribution to.
    #[error(
        "no shadow edge that the light does not graze: the method has nothing to measure; give solver.plane to \"plane-optimal\""
    )]
    NoEdges,
    /// The given plane has no normal.
    #[error("solver.plane = [a, b, c, d] needs finite numbers and a normal (a, b, c) that is not zero")]
    NoPlane,
    /// The film sees the plane as a line.
    #[error("the camera lies on the plane, which it sees as a line")]
    CameraOnPlane,
    /// The light sees the plane as a line.
    #[error("the light lies on the plane, or shines along it")]
    LightOnPlane,
    /// Eq. 12: α (C - X) + (1 - α) (L - X) = 0.
    #[error("the normal between camera and light vanishes: they stand on opposite sides of the cover")]
    VanishingNormal,
    /// Cascades: no logarithm of the near end.
    #[error("a logarithmic split needs a view that begins in front of a perspective camera; take \"uniform\"")]
    NoLogarithmicSplit,
    /// Cascades: a snapped map of a lamp.
    #[error("stable cascades need parallel light: the texels of a lamp's map are of different sizes")]
    StableNeedsParallelLight,
    /// Faces: every face is seen from inside.
    #[error("the light stands inside the view, whose faces have no side towards it")]
    LightAmongFaces,
}

impl From<LightSpaceError> for Inapplicable {
    fn from(error: LightSpaceError) -> Self {
        match error {
            LightSpaceError::Empty => Inapplicable::Empty,
            LightSpaceError::NoHalfSpace => Inapplicable::NoHalfSpace,
        }
    }
}

/// The maps of one light in one frame. The first region whose domain holds a point answers; together they hold every
/// covered point.
pub fn solve(method: Method, inputs: &Inputs) -> Result<Vec<Region>, Inapplicable> {
    let regions = split::by_cube_faces(inputs, |given, axis| {
        let single = match method {
            Method::Irregular => return Err(Inapplicable::NoMap),
            Method::Auto | Method::Best => return Err(Inapplicable::Chooses),
            Method::Partitioned => return partitioned::solve(given, axis),
            Method::Adaptive => return adaptive::solve(given, axis, adaptive::Level::Footprint),
            Method::Edges => return adaptive::solve(given, axis, adaptive::Level::Edges),
            Method::SeparatingPlane => return separating_plane::solve(given, axis),
            Method::Cascades => return cascades::solve(given, axis),
            Method::Faces => return faces::solve(given, axis),
            Method::Lixel => lixel::solve,
            Method::SceneOptimal => scene_optimal::solve,
            Method::Normal => normal::solve,
            Method::Focused => focused::solve,
            Method::Psm => psm::solve,
            Method::Tsm => tsm::solve,
            Method::Lispsm => lispsm::solve,
            Method::PlaneOptimal => plane_optimal::solve,
            Method::HomographyArea => homography_area::solve,
        };
        single(given, axis).map(|region| vec![region])
    })?;
    if regions.is_empty() {
        return Err(Inapplicable::Empty);
    }
    if inputs.covered.iter().all(|p| held(&regions, *p)) { Ok(regions) } else { Err(Inapplicable::CoveredBehindLight) }
}

/// Whether the region that a point looks up holds it.
pub fn held(regions: &[Region], point: DVec3) -> bool {
    regions.iter().find(|r| r.domain.holds(point)).is_some_and(|r| r.contains(point))
}

/// The map a step away from a single region's own, for searches that measure. `None` where that is not legal.
pub fn near(inputs: &Inputs, region: &Region, step: &Step) -> Option<Region> {
    lixel::near(inputs, region, step)
}

/// The map with p4 a step away from a single region's own and the best affine part for it. `None` where that is not legal.
pub fn refitted(inputs: &Inputs, region: &Region, warp: DVec2) -> Option<Region> {
    lixel::refitted(inputs, region, warp)
}
