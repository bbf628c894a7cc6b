//! A trade as JSON.

use super::Trade;
use crate::plan::PlanError;
use serde::Serialize;

/// The version of the JSON. Keys may be added under the same name.
pub const SCHEMA: &str = "lixel.trade/1";

#[derive(Serialize)]
struct Document<'a> {
    schema: &'static str,
    lixel: &'static str,
    #[serde(flatten)]
    trade: &'a Trade,
}

/// All points, the front and the places of the presets. Every number in it is finite.
///
/// # Errors
/// [`PlanError::Encode`].
pub fn json(trade: &Trade) -> Result<String, PlanError> {
    let document = Document { schema: SCHEMA, lixel: env!("CARGO_PKG_VERSION"), trade };
    let text = serde_json::to_string_pretty(&document)
        .map_err(|e| PlanError::Encode { format: "JSON", message: e.to_string() })?;
    Ok(text + "\n")
}
