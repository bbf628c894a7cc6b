//! What a plan says of one light in one frame.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Choice, Flicker, LightBudget, LightTemporal, MapPlan, Reprojected};
use crate::fit::Termination;
use crate::job::Job;
use crate::scene::{Light, LightKind, LightKindName};

/// One light in one frame.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
pub struct LightPlan {
    /// Name of the light.
    pub light: String,
    /// Its kind.
    pub kind: LightKindName,
    /// The way light travels, unit (directional, spot).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub direction: Option<[f64; 3]>,
    /// Relative to the origin, metres (point, spot).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub position: Option<[f64; 3]>,
    /// Half angle of the outer cone, degrees (spot).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cone_degrees: Option<f64>,
    /// Metres; absent = unlimited.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub range: Option<f64>,
    /// What came of it.
    pub status: Status,
    /// Why the status is not `planned`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// The bound that was asked for, in the unit of the job's `quality.bound`; within a budget the share of the image that the
    /// maps came to.
    pub epsilon: f64,
    /// The maps, in the order of lookup; none when nothing has to be looked up.
    pub maps: Vec<MapPlan>,
    /// Predicted and measured error; absent when there is no map.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<LightError>,
    /// How the matrix was found; absent when nothing was solved.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub solver: Option<SolverReport>,
    /// How it hangs together with other frames; absent in a plan of one frame.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub temporal: Option<LightTemporal>,
    /// Changes of answer since the frame before that nothing accounts for; absent for the first frame and where nothing
    /// was measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub flicker: Option<Flicker>,
    /// What a renderer that blends answers over time makes of its maps, by which the bound is judged; only with maps, where
    /// the job's `lookup` has it. `error` and `flicker` are those of the maps alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reprojected: Option<Reprojected>,
    /// What texels gain in its maps; only with maps, within a budget.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub budget: Option<LightBudget>,
    /// Planned from a renderer's images, and what that leaves open; absent where there was geometry.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub images: Option<FromImages>,
    /// What planning this light took.
    pub cost: Cost,
}

/// What a plan from a renderer's images rests on.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
pub struct FromImages {
    /// What casts was not seen: what these two do not hold is missing from the map.
    pub casters: Casters,
    /// Where the near end of the depth range comes from.
    pub near: RangeEnd,
    /// Where the far end comes from.
    pub far: RangeEnd,
    /// How `met` is known.
    pub met: MetBy,
    /// The same in words.
    pub note: String,
}

/// What is known of the things that cast shadows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Casters {
    /// Only the shadows that they throw.
    Unseen,
}

/// Where an end of a depth range comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum RangeEnd {
    /// `[[light]] near` or `far`.
    Job,
    /// What is seen, and room towards the light.
    Receivers,
}

/// How `met` is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum MetBy {
    /// By the closed form: without geometry no map can be drawn.
    Prediction,
}

impl FromImages {
    /// Of a light of a job.
    pub fn of(light: &Light, job: &Job) -> FromImages {
        let own = job.light.iter().find(|l| l.name == light.name);
        let end = |given: Option<f64>| if given.is_some() { RangeEnd::Job } else { RangeEnd::Receivers };
        let (near, far) = (end(own.and_then(|l| l.near)), end(own.and_then(|l| l.far)));
        let room = match (near, light.position()) {
            (RangeEnd::Job, _) => "from the job's near",
            (RangeEnd::Receivers, None) => "in front of what is seen, by the extent of what is seen",
            (RangeEnd::Receivers, Some(_)) => "at 1/64 of the way from the light to the nearest thing seen",
        };
        let note = format!(
            "planned from images: casters were not seen, and what stands before the near end of the depth range is not in \
             the map; it begins {room}. Nothing could be drawn: sizes and met are predicted"
        );
        FromImages { casters: Casters::Unseen, near, far, met: MetBy::Prediction, note }
    }
}

impl LightPlan {
    /// The entry of a light with its placement and nothing planned.
    pub fn unplanned(light: &Light, epsilon: f64) -> LightPlan {
        let (kind, direction, cone, range) = match light.kind {
            LightKind::Directional { direction } => (LightKindName::Directional, Some(direction), None, None),
            LightKind::Point { range, .. } => (LightKindName::Point, None, None, range),
            LightKind::Spot { direction, cone_rad, range, .. } => {
                (LightKindName::Spot, Some(direction), Some(cone_rad.to_degrees()), range)
            }
        };
        LightPlan {
            light: light.name.clone(),
            kind,
            direction: direction.map(|d| d.to_array()),
            position: light.position().map(|p| p.to_array()),
            cone_degrees: cone,
            range,
            status: Status::Planned,
            reason: None,
            epsilon,
            maps: Vec::new(),
            error: None,
            solver: None,
            temporal: None,
            flicker: None,
            reprojected: None,
            budget: None,
            images: None,
            cost: Cost::default(),
        }
    }

    /// Whether the matrix, in the light's own frame, or the size is not that of an earlier frame's entry. False where either
    /// has no map.
    pub fn changes_from(&self, before: &LightPlan) -> bool {
        let segment = |l: &LightPlan| l.temporal.as_ref().and_then(|t| t.segment);
        let same_segment = segment(self).is_some() && segment(self) == segment(before);
        let same_map = |(a, b): (&MapPlan, &MapPlan)| {
            (a.clip_from_world, a.width, a.height) == (b.clip_from_world, b.width, b.height)
        };
        let same = self.maps.len() == before.maps.len() && self.maps.iter().zip(&before.maps).all(same_map);
        !(self.maps.is_empty() || before.maps.is_empty() || same_segment || same)
    }

    /// True when epsilon holds: with its maps, or because none is needed.
    pub fn met(&self) -> bool {
        match self.status {
            Status::Planned => self.error.as_ref().is_none_or(|e| e.met),
            Status::NoVisibleShadow | Status::Unlit => true,
            Status::NotMet | Status::Inapplicable => false,
        }
    }
}

/// What came of a light in a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    /// Its maps meet epsilon.
    Planned,
    /// It lights what is seen and no shadow of it is seen; no map is needed.
    NoVisibleShadow,
    /// It lights nothing that is seen; no map is needed.
    Unlit,
    /// The best maps within the job's limits, over epsilon; or the smallest ones, over its budget.
    NotMet,
    /// The method has no answer for this light and camera; `reason` names why.
    Inapplicable,
}

/// Error of a light's maps.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
pub struct LightError {
    /// What was predicted at the chosen size; absent where measured sizes alone decide: within a budget, and with
    /// reprojection.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub predicted: Option<Predicted>,
    /// What was measured at the chosen size; absent with `measure = "never"`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub measured: Option<Measured>,
    /// Every size that was measured, in the order of trial; ascending where there is no prediction.
    pub tried: Vec<Tried>,
    /// True when the bound holds: measured where it was, else predicted.
    pub met: bool,
}

/// The closed form's error at the chosen size.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
pub struct Predicted {
    /// Expected wrong pixels with a certain exact answer, saturating where displacements are wider than the shadows.
    pub misclassified: f64,
    /// Expected further ones, on surfaces edge-on to the light, whose exact answer is uncertain.
    pub uncertain: f64,
    /// The certain ones without saturation.
    pub unsaturated: f64,
    /// Wrong pixels with a certain and with an uncertain exact answer, bias and lost shadows included: estimated from a sample
    /// of the visible points, looked up by rays, where nothing is measured or only one size checked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sampled: Option<[f64; 2]>,
    /// Pixels between drawn and exact edge, at the quantile, where that is the bound.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub displacement: Option<f64>,
    /// Texel footprint in pixels, at the quantile, where that is the bound.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub footprint: Option<f64>,
}

/// Every pixel of the film looked up as a renderer would, against exact visibility.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
pub struct Measured {
    /// Pixels with the wrong answer whose exact answer is certain.
    pub misclassified: u64,
    /// Pixels of the image.
    pub of_pixels: u64,
    /// Wrong pixels that are in shadow exactly and looked up lit.
    pub false_lit: u64,
    /// Wrong pixels that are lit exactly and looked up in shadow.
    pub false_shadow: u64,
    /// Further pixels that differ, but whose exact answer changes under the larger ray offset or lies within
    /// `edge_on_degrees`. Met means certain ≤ epsilon and certain + uncertain ≤ 1.15 epsilon.
    pub uncertain: u64,
    /// Wrong pixels at shadow edges.
    pub edge: u64,
    /// Wrong pixels where a lit surface shadows itself in the map.
    pub self_shadow: u64,
    /// Offset of the exact shadow rays from the surface, metres.
    pub ray_offset_m: f64,
    /// The larger offset that tells uncertain pixels, metres.
    pub larger_ray_offset_m: f64,
    /// Surfaces within this angle of edge-on to the light are uncertain, degrees.
    pub edge_on_degrees: f64,
    /// Pixels between drawn and exact edge, at the quantile, where that is the bound.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub displacement: Option<f64>,
    /// Texel footprint in pixels, at the quantile, where that is the bound.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub footprint: Option<f64>,
}

/// One size that was measured. Several maps of a light scale together; the size is the first map's.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
pub struct Tried {
    /// Texels.
    pub width: u32,
    /// Texels.
    pub height: u32,
    /// Texels of all maps of the light together; stated where the prediction is not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub texels: Option<u64>,
    /// Wrong pixels at this size.
    pub misclassified: u64,
    /// Further wrong pixels whose exact answer is uncertain.
    pub uncertain: u64,
    /// Pixels between drawn and exact edge, at the quantile, where that is the bound.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub displacement: Option<f64>,
    /// Texel footprint in pixels, at the quantile, where that is the bound.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub footprint: Option<f64>,
}

/// How the matrix was found.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
pub struct SolverReport {
    /// The relative tolerance that was asked for.
    pub tolerance: f64,
    /// Relative spread of the objective over the last simplex: how far the search was from standing still.
    pub spread: f64,
    /// Relative distance above a dense search of the same problem, where one was made (effort `exhaustive`).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gap: Option<f64>,
    /// Evaluations of the objective.
    pub evaluations: u64,
    /// Rounds of reweighting.
    pub rounds: u64,
    /// Edge samples left out because the light grazes their surface.
    pub grazing: u64,
    /// Film pixels that lay outside the first fit and joined the cover.
    pub joined: u64,
    /// How the method was chosen; only of `auto` and `best`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub choice: Option<Choice>,
    /// Why the search stopped.
    pub termination: Termination,
}

/// What planning a light took.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize, JsonSchema)]
pub struct Cost {
    /// Boundary samples the solver saw.
    pub samples: u64,
    /// Rays cast, primary rays of the frame shared out among its lights.
    pub rays: u64,
    /// Texels of all maps drawn while measuring.
    pub texels_drawn: u64,
    /// Triangles drawn while measuring, summed over maps.
    pub triangles_drawn: u64,
    /// Evaluations of the objective, over all fits.
    pub solver_evaluations: u64,
    /// Wall time; only with `--timings`, since it differs from run to run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub milliseconds: Option<f64>,
}
