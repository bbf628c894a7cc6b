//! The temporal modes side by side: the same shot planned by each of them.

use super::write_file;
use crate::job::{Job, LoadedJob};
use crate::picture::tiled;
use crate::plan::{LightPlan, Plan, PlanError, Reprojected, Watch, make, strip};
use crate::shot::Temporal;
use serde::Serialize;
use std::path::Path;
use std::time::Instant;

/// Most frames of a picture.
pub const STRIP_FRAMES: usize = 12;
/// Between the pictures of a strip, pixels.
const GAP: u32 = 4;

/// What one mode's plan of a shot came to.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TemporalRow {
    /// The mode.
    pub temporal: Temporal,
    /// Every light of every frame meets its bound.
    pub met: bool,
    /// Texels of the maps that are drawn.
    pub texels_drawn: u64,
    /// Texels of all maps of the frame that has most.
    pub peak: u64,
    /// Texels of all maps over all frames, drawn or reused.
    pub sum: u64,
    /// Changes of matrix or size.
    pub changes: u64,
    /// Pixels whose answer changes between frames although nothing moved there and the exact answer stays; absent when
    /// nothing was measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub flicker: Option<u64>,
    /// The same on surfaces that moved.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub flicker_moved: Option<u64>,
    /// `flicker` between each frame and the one before it.
    pub flicker_per_frame: Vec<u64>,
    /// Certainly wrong pixels of all lights and frames.
    pub misclassified: u64,
    /// What a renderer that blends answers over time shows wrongly, where the job's `lookup` has it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub misclassified_reprojected: Option<u64>,
    /// Flicker of what it shows.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub flicker_reprojected: Option<u64>,
    /// The same light by light.
    pub lights: Vec<TemporalLight>,
    /// Planning and measuring.
    pub seconds: f64,
}

/// One light under a mode.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TemporalLight {
    /// Its name.
    pub light: String,
    /// Every frame meets its bound.
    pub met: bool,
    /// Texels of its maps that are drawn.
    pub texels_drawn: u64,
    /// Texels of its maps over all frames.
    pub sum: u64,
    /// Flickering pixels on surfaces that did not move.
    pub flicker: u64,
    /// Certainly wrong pixels.
    pub misclassified: u64,
}

/// Plans the job once for each mode. With `pictures`, a folder, `swimming.png` there has a row for each mode and a column for
/// each frame, at most [`STRIP_FRAMES`]: the film with the shadows that the maps answer, flickering pixels marked.
///
/// # Errors
/// Those of [`make`], and [`PlanError::Write`]; a mode that the job's maps do not allow is refused before, by the job's
/// checks.
pub fn compare_temporal(
    job: &LoadedJob,
    modes: &[Temporal],
    pictures: Option<&Path>,
    watch: &Watch,
) -> Result<Vec<TemporalRow>, PlanError> {
    let mut strips = Vec::new();
    let mut row = |mode: &Temporal| {
        let start = Instant::now();
        let shot = crate::shot::TemporalParams { temporal: *mode, ..job.job.shot.clone() };
        let loaded = LoadedJob { job: Job { shot, ..job.job.clone() }, ..job.clone() };
        let plan = make(&loaded, Path::new(""), false, watch)?;
        let row = summarised(*mode, &plan, start.elapsed().as_secs_f64());
        if pictures.is_some() {
            strips.push(strip(&loaded, &plan, STRIP_FRAMES, watch)?);
        }
        Ok(row)
    };
    let rows = modes.iter().map(&mut row).collect::<Result<Vec<TemporalRow>, PlanError>>()?;
    if let Some(dir) = pictures {
        let path = dir.join("swimming.png");
        let failed = |source| PlanError::Write { dest: path.display().to_string(), source };
        write_file(&path, &tiled(&strips, GAP).to_png().map_err(failed)?)?;
    }
    Ok(rows)
}

fn summarised(temporal: Temporal, plan: &Plan, seconds: f64) -> TemporalRow {
    let mut lights: Vec<TemporalLight> = Vec::new();
    for entry in plan.frames.iter().flat_map(|f| &f.lights) {
        let at = lights.iter().position(|l| l.light == entry.light).unwrap_or_else(|| {
            let (light, met) = (entry.light.clone(), true);
            lights.push(TemporalLight { light, met, texels_drawn: 0, sum: 0, flicker: 0, misclassified: 0 });
            lights.len() - 1
        });
        let light = &mut lights[at];
        let texels: u64 = entry.maps.iter().map(crate::plan::MapPlan::texels).sum();
        let reused = entry.temporal.as_ref().is_some_and(|t| t.reused_from.is_some());
        light.met &= entry.met();
        light.sum += texels;
        light.texels_drawn += if reused { 0 } else { texels };
        light.flicker += entry.flicker.map_or(0, |f| f.still);
        light.misclassified += entry.error.as_ref().and_then(|e| e.measured.as_ref()).map_or(0, |m| m.misclassified);
    }
    let summary = &plan.summary;
    let shown = |of: &dyn Fn(&Reprojected) -> u64| -> Option<u64> {
        let entries = || plan.frames.iter().flat_map(|f| &f.lights).filter_map(|l: &LightPlan| l.reprojected.as_ref());
        entries().next().map(|_| entries().map(of).sum())
    };
    TemporalRow {
        temporal,
        met: summary.met,
        texels_drawn: summary.texels_drawn,
        peak: summary.peak,
        sum: summary.texels,
        changes: summary.changes,
        flicker: summary.flicker,
        flicker_moved: summary.flicker_moved,
        flicker_per_frame: plan
            .frames
            .iter()
            .skip(1)
            .map(|f| f.lights.iter().filter_map(|l| l.flicker).map(|f| f.still).sum())
            .collect(),
        misclassified: lights.iter().map(|l| l.misclassified).sum(),
        misclassified_reprojected: shown(&|r| r.misclassified),
        flicker_reprojected: shown(&|r| r.flicker.map_or(0, |f| f.still)),
        lights,
        seconds,
    }
}

/// The name of a mode, as in a job.
fn word(mode: Temporal) -> String {
    match serde_json::to_value(mode) {
        Ok(serde_json::Value::String(name)) => name,
        other => format!("{other:?}"),
    }
}

/// The rows as a table, and below each mode its lights where there are several.
pub fn temporal_table(rows: &[TemporalRow]) -> String {
    let line = |cells: [&str; 9]| {
        let [mode, drawn, peak, sum, changes, flicker, moved, wrong, rest] = cells;
        format!("{mode:<22} {drawn:>13} {peak:>11} {sum:>13} {changes:>7} {flicker:>8} {moved:>7} {wrong:>8}  {rest}\n")
    };
    let count = |n: Option<u64>| n.map_or("-".to_owned(), |n| n.to_string());
    let mut text =
        line(["temporal", "texels drawn", "peak", "sum", "changes", "flicker", "moved", "wrong", "bound  seconds"]);
    let bound = |met: bool| if met { "met    " } else { "NOT MET" };
    for row in rows {
        text += &line([
            &word(row.temporal),
            &row.texels_drawn.to_string(),
            &row.peak.to_string(),
            &row.sum.to_string(),
            &row.changes.to_string(),
            &count(row.flicker),
            &count(row.flicker_moved),
            &row.misclassified.to_string(),
            &format!("{}  {:.1}", bound(row.met), row.seconds),
        ]);
        if let (Some(wrong), Some(flicker)) = (row.misclassified_reprojected, row.flicker_reprojected) {
            let (flicker, wrong) = (flicker.to_string(), wrong.to_string());
            text += &line(["  with reprojection", "", "", "", "", &flicker, "", &wrong, ""]);
        }
        for light in row.lights.iter().filter(|_| row.lights.len() > 1) {
            text += &line([
                &format!("  {}", light.light),
                &light.texels_drawn.to_string(),
                "",
                &light.sum.to_string(),
                "",
                &light.flicker.to_string(),
                "",
                &light.misclassified.to_string(),
                bound(light.met),
            ]);
        }
    }
    text
}

#[derive(Serialize)]
struct Document<'a> {
    schema: &'static str,
    lixel: &'static str,
    temporal: &'a [TemporalRow],
}

/// The rows as JSON.
///
/// # Errors
/// [`PlanError::Encode`].
pub fn temporal_json(rows: &[TemporalRow]) -> Result<String, PlanError> {
    let document = Document { schema: super::SCHEMA, lixel: env!("CARGO_PKG_VERSION"), temporal: rows };
    let text = serde_json::to_string_pretty(&document)
        .map_err(|e| PlanError::Encode { format: "JSON", message: e.to_string() })?;
    Ok(text + "\n")
}
