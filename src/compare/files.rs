//! A comparison as JSON and CSV.

use super::{Comparison, Measured, Summary};
use crate::plan::{PlanError, write_atomically};
use serde::Serialize;
use std::path::Path;

/// The version of the JSON. Keys may be added under the same name.
pub const SCHEMA: &str = "lixel.compare/1";

#[derive(Serialize)]
struct Document<'a> {
    schema: &'static str,
    lixel: &'static str,
    #[serde(flatten)]
    comparison: &'a Comparison,
    summary: &'a Summary,
}

/// All rows and their figures. Every number in it is finite.
///
/// # Errors
/// [`PlanError::Encode`].
pub fn json(comparison: &Comparison, summary: &Summary) -> Result<String, PlanError> {
    let document = Document { schema: SCHEMA, lixel: env!("CARGO_PKG_VERSION"), comparison, summary };
    let text = serde_json::to_string_pretty(&document)
        .map_err(|e| PlanError::Encode { format: "JSON", message: e.to_string() })?;
    Ok(text + "\n")
}

const HEAD: &str = "frame,light,method,reason,misclassified,false_lit,false_shadow,edge,self_shadow,uncertain,predicted,\
                    predicted_unsaturated,texels,maps,samples,bias_constant,bias_slope,bias_clamp,met,solve_seconds,seconds\n";

/// One row a light and method, with a head (RFC 4180, lines end with LF).
pub fn csv(comparison: &Comparison) -> String {
    let mut text = HEAD.to_owned();
    for light in 0..comparison.lights.len() {
        for method in &comparison.methods {
            let row = &method.per_light[light];
            let reason = row.reason.clone().unwrap_or_default();
            let measured = row.measured.as_ref().map_or([const { String::new() }; 15], fields);
            let first = [row.frame.to_string(), quoted(&row.light), method.method.clone(), quoted(&reason)];
            let last = [format!("{:.6}", row.solve_seconds), format!("{:.6}", row.seconds)];
            let cells: Vec<String> = first.into_iter().chain(measured).chain(last).collect();
            text += &cells.join(",");
            text.push('\n');
        }
    }
    text
}

fn fields(m: &Measured) -> [String; 15] {
    let option = |value: Option<f64>| value.map(|v| v.to_string()).unwrap_or_default();
    let maps: Vec<String> = m.maps.iter().map(|[w, h]| format!("{w}x{h}")).collect();
    [
        m.misclassified.to_string(),
        m.false_lit.to_string(),
        m.false_shadow.to_string(),
        m.edge.to_string(),
        m.self_shadow.to_string(),
        m.uncertain.to_string(),
        option(m.predicted),
        option(m.predicted_unsaturated),
        m.texels.to_string(),
        maps.join("+"),
        m.samples.map(|s| s.to_string()).unwrap_or_default(),
        m.bias_constant.to_string(),
        m.bias_slope.to_string(),
        option(m.bias_clamp),
        m.needed.map(|n| n.met.to_string()).unwrap_or_default(),
    ]
}

/// A cell with quotes around it where it needs them.
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}

/// Writes a file whole or not at all.
///
/// # Errors
/// [`PlanError::Write`].
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), PlanError> {
    write_atomically(path, bytes).map_err(|source| PlanError::Write { dest: path.display().to_string(), source })
}
