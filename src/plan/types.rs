//! The plan's own types. Their doc comments are the descriptions in the JSON Schema.

mod budget;
mod choice;
mod light;
mod map;
mod operating;
mod temporal;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Conventions, Input, SCHEMA};
use crate::job::Job;

pub use budget::{BudgetSummary, LightBudget};
pub use choice::{Alternative, Choice};
pub use light::{
    Casters, Cost, FromImages, LightError, LightPlan, Measured, MetBy, Predicted, RangeEnd, SolverReport, Status, Tried,
};
pub use map::{CubeFace, Domain, Frustum, LightCamera, LightProjection, MapBias, MapPlan, Witness};
pub use operating::{Operating, TimeModel};
pub use temporal::{Flicker, LightTemporal, Reprojected};

/// Four rows of four, applied to column vectors.
pub type Rows = [[f64; 4]; 4];

/// A shot's shadow maps: per frame and light, the matrices, the sizes, and what they were measured to give.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
pub struct Plan {
    /// The version of this format: `lixel.plan/1`.
    pub schema: String,
    /// The version of lixel that wrote it.
    pub lixel: String,
    /// How the numbers are meant and how the maps are looked up.
    pub conventions: Conventions,
    /// The job as resolved from all layers.
    pub job: PlannedJob,
    /// How the settings were chosen, where a time budget chose them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub operating: Option<Operating>,
    /// World position, metres, that all positions and matrices are relative to.
    pub origin: [f64; 3],
    /// The whole shot in a few numbers.
    pub summary: Summary,
    /// Where the time went; only with `--timings`, since it differs from run to run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub timings: Option<Timings>,
    /// What the job's budget came to; absent without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub budget: Option<BudgetSummary>,
    /// One entry a frame, in the order of the job's range.
    pub frames: Vec<FramePlan>,
}

impl Plan {
    /// A plan of this version with the summary of its frames.
    pub fn new(job: PlannedJob, origin: [f64; 3], frames: Vec<FramePlan>) -> Self {
        Self {
            schema: SCHEMA.to_owned(),
            lixel: env!("CARGO_PKG_VERSION").to_owned(),
            conventions: Conventions::of(&job.job.lookup),
            operating: None,
            origin,
            summary: Summary::of(&frames),
            timings: None,
            budget: job.budget_of(&frames),
            job,
            frames,
        }
    }
}

/// The job as resolved, and the files it was planned from.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
pub struct PlannedJob {
    /// All keys of a job file; scene paths are relative to the plan.
    #[serde(flatten)]
    pub job: Job,
    /// Every file that was read, with its content hash.
    pub inputs: Vec<Input>,
}

/// Wall times of a run, seconds.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
pub struct Timings {
    /// Reading the files and posing what never moves.
    pub load_s: f64,
    /// Sorting what never moves for rays.
    pub sort_s: f64,
    /// All of it, but for writing the plan.
    pub total_s: f64,
    /// `load_s` over `total_s`.
    pub load_share: f64,
}

impl PlannedJob {
    /// What the job's budget came to in some frames; `None` without one.
    pub fn budget_of(&self, frames: &[FramePlan]) -> Option<BudgetSummary> {
        let Job { budget, light, .. } = &self.job;
        budget.is_given().then(|| BudgetSummary::of(frames, budget, light))
    }
}

/// The whole shot in a few numbers.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
pub struct Summary {
    /// True when every light of every frame meets its epsilon.
    pub met: bool,
    /// Number of frames.
    pub frames: u64,
    /// Number of maps over all frames and lights.
    pub maps: u64,
    /// Texels of all maps over all frames and lights.
    pub texels: u64,
    /// Texels of the maps that are drawn, not reused from an earlier frame.
    #[serde(default)]
    pub texels_drawn: u64,
    /// Texels of all maps of the frame that has most.
    #[serde(default)]
    pub peak: u64,
    /// How often a light's matrix, in its own frame, or size changes from one frame to the next.
    #[serde(default)]
    pub changes: u64,
    /// Pixels whose answer changes between frames although nothing moved, over all frames and lights; absent when nothing
    /// was measured across frames.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub flicker: Option<u64>,
    /// The same on surfaces that moved.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub flicker_moved: Option<u64>,
    /// Width and height of the map with most texels; absent when there is no map.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub largest: Option<[u32; 2]>,
    /// The light and frame with most measured wrong pixels; absent when nothing was measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub worst: Option<Worst>,
}

/// Where a shot is worst.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
pub struct Worst {
    /// Frame number.
    pub frame: i64,
    /// Name of the light.
    pub light: String,
    /// Wrong pixels.
    pub misclassified: u64,
    /// Pixels of the image.
    pub of_pixels: u64,
}

impl Summary {
    /// Counts what frames hold. Of equally bad lights the first is the worst, of equally large maps the first.
    pub fn of(frames: &[FramePlan]) -> Self {
        let lights = || frames.iter().flat_map(|f| f.lights.iter().map(move |l| (f.frame, l)));
        let maps = || lights().flat_map(|(_, l)| &l.maps);
        let mut largest: Option<&MapPlan> = None;
        for map in maps() {
            if largest.is_none_or(|l| map.texels() > l.texels()) {
                largest = Some(map);
            }
        }
        let mut worst: Option<Worst> = None;
        for (frame, light) in lights() {
            let Some(measured) = light.error.as_ref().and_then(|e| e.measured.as_ref()) else { continue };
            if worst.as_ref().is_none_or(|w| measured.misclassified > w.misclassified) {
                worst = Some(Worst {
                    frame,
                    light: light.light.clone(),
                    misclassified: measured.misclassified,
                    of_pixels: measured.of_pixels,
                });
            }
        }
        let drawn = |l: &LightPlan| l.temporal.as_ref().is_none_or(|t| t.reused_from.is_none());
        let texels_of = |f: &FramePlan| f.lights.iter().flat_map(|l| &l.maps).map(MapPlan::texels).sum::<u64>();
        let flicker = || lights().filter_map(|(_, l)| l.flicker);
        let measured = flicker().next().is_some();
        let changes = frames.windows(2).map(|pair| {
            let before = |name: &str| pair[0].lights.iter().find(|l| l.light == name);
            pair[1].lights.iter().filter(|l| before(&l.light).is_some_and(|b| l.changes_from(b))).count() as u64
        });
        Self {
            texels_drawn: lights().filter(|(_, l)| drawn(l)).flat_map(|(_, l)| &l.maps).map(MapPlan::texels).sum(),
            peak: frames.iter().map(texels_of).max().unwrap_or(0),
            changes: changes.sum(),
            flicker: measured.then(|| flicker().map(|f| f.still).sum()),
            flicker_moved: measured.then(|| flicker().map(|f| f.moved).sum()),
            met: lights().all(|(_, l)| l.met()),
            frames: frames.len() as u64,
            maps: maps().count() as u64,
            texels: maps().map(MapPlan::texels).sum(),
            largest: largest.map(|m| [m.width, m.height]),
            worst,
        }
    }
}

/// One frame of the shot.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
pub struct FramePlan {
    /// Frame number, as in the job's range.
    pub frame: i64,
    /// Seconds from the start of the animation; frame 1 is at 0.
    pub time_s: f64,
    /// The camera of the frame.
    pub camera: PlanCamera,
    /// One entry a light, in the order of the job or the scene's files.
    pub lights: Vec<LightPlan>,
}

/// The camera that a frame was planned for.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
pub struct PlanCamera {
    /// Name in the file or job.
    pub name: String,
    /// Clip space of the camera from the world.
    pub clip_from_world: Rows,
    /// Centre of projection, relative to the origin, metres; of an orthographic camera, which has none, where it stands.
    pub position: [f64; 3],
    /// Film width, pixels.
    pub width: u32,
    /// Film height, pixels.
    pub height: u32,
}
