//! What timing the operating points found.

use serde::Serialize;

use super::{Point, Rank};
use crate::job::Preset;

/// Operating points side by side.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Trade {
    /// Pixels of the image.
    pub pixels: u64,
    /// The bound, in the unit of the job's `quality.bound`.
    pub epsilon: f64,
    /// Threads that each point had to itself; no two points ran at a time.
    pub threads: usize,
    /// Times each point was run; its time is the median.
    pub repeat: u32,
    /// Lights of frames, in order.
    pub cases: Vec<TradeCase>,
    /// In the order of the list.
    pub points: Vec<PointResult>,
    /// Names of the points that no other one beats in time, excess texels and being measured, fastest first.
    pub front: Vec<String>,
    /// Where the presets lie.
    pub presets: Vec<PresetResult>,
}

/// A light of a frame with a visible shadow.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TradeCase {
    /// Frame number.
    pub frame: i64,
    /// Name of the light.
    pub light: String,
    /// Pixels that face it.
    pub facing: u64,
    /// Texels of the thorough plan: of the smallest size that meets epsilon, else of the largest.
    pub thorough_texels: u64,
    /// Whether that plan meets epsilon. Lights on which it does not take no part in excess texels.
    pub thorough_met: bool,
}

/// An operating point: what it costs and what its plans come to.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PointResult {
    /// Name and settings.
    #[serde(flatten)]
    pub point: Point,
    /// Mean seconds a frame and light, each planned by itself; scene loaded, its tree built.
    pub seconds: f64,
    /// Certainly wrong pixels with the thorough plan's texels, all cases.
    pub misclassified: u64,
    /// More of them than the thorough preset's maps have at these texels, as a part.
    pub excess_misclassified: f64,
    /// Texels that the plans spend.
    pub texels_planned: u64,
    /// Texels that their matrices and biases need for epsilon, by search; of a light whose maps meet it at no size, the
    /// most that the job allows.
    pub texels_needed: u64,
    /// What the point spends or has to add more than the thorough preset, as a part: geometric mean over lights.
    pub excess_texels: f64,
    /// Lights whose maps meet epsilon at no size, although the thorough preset's do.
    pub never_met: u64,
    /// Lights of which the plan says that epsilon is met.
    pub said_met: u64,
    /// Of these, lights on which it is.
    pub truly_met: u64,
    /// Whether the plans measure; else they rest on the prediction.
    pub measures: bool,
    /// One for each case.
    pub cases: Vec<CaseResult>,
}

impl PointResult {
    /// What it is ranked by.
    pub fn rank(&self) -> Rank {
        Rank { seconds: self.seconds, price: 1.0 + self.excess_texels, measures: self.measures }
    }
}

/// One point on one light of a frame.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CaseResult {
    /// Median seconds, the frame's own setting up shared out among its lights.
    pub seconds: f64,
    /// Texels of all maps.
    pub planned: u64,
    /// Texels that the maps need for epsilon; absent when no size meets it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub needed: Option<u64>,
    /// The larger of the two, and no less than a map's least.
    pub price: u64,
    /// Certainly wrong pixels with the thorough plan's texels.
    pub misclassified: u64,
    /// What the plan says.
    pub said_met: bool,
    /// What its maps, drawn and looked up at every pixel, say.
    pub truly_met: bool,
}

/// Where a preset lies.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PresetResult {
    /// The preset.
    pub preset: Preset,
    /// Seconds a frame and light.
    pub seconds: f64,
    /// Over the thorough preset.
    pub excess_texels: f64,
    /// Texels more than the cheapest point that takes no longer, and measures if the preset does, as a part; 0 = on the
    /// front.
    pub excess_over_front: f64,
    /// Time more than the fastest such point that needs no more texels, as a part.
    pub time_over_front: f64,
    /// The point of the front that `excess_over_front` is measured from.
    pub front_point: String,
}
