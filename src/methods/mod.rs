//! One file a method, one signature: [`Inputs`] → regions, or the named reason why the method does not apply.
//!
//! A region is a homography of a light plane with the points that look it up. Row 3, sizes and bias come later.

mod focused;
mod lixel;
mod normal;
mod params;
mod plane;
mod region;
mod scene_optimal;
mod split;

pub use params::SolverParams;
pub use region::{Domain, Prediction, Region, Report};

use crate::fit::{Aspect, Shape};
use crate::math::{Bounds, LightSpaceError};
use crate::samples::EdgePoint;
use crate::scene::{Camera, Film, Light};
use glam::DVec3;
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
    split::by_cube_faces(inputs, |region_inputs, axis| match method {
        Method::Lixel => lixel::solve(region_inputs, axis),
        Method::SceneOptimal => scene_optimal::solve(region_inputs, axis),
        Method::Normal => normal::solve(region_inputs, axis),
        Method::Focused => focused::solve(region_inputs, axis),
    })
}

/// Maps near a single region's own, for searches that measure; `step` is relative to the legal range of p4.
pub fn neighbours(inputs: &Inputs, region: &Region, step: f64) -> Vec<Region> {
    lixel::neighbours(inputs, region, step)
}
