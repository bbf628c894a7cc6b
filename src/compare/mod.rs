//! Methods side by side: the same frames, lights, covered points and texels, judged by the same measured wrong pixels
//! (after Table 1 of Chong and Gortler, *Scene Optimized Shadow Mapping*, TR-07-07).
//!
//! For each light of a frame the shadow edges are sampled once and the film is classified exactly once. Every method gets
//! the same cover: what the planning grid found and every film pixel that a map has to hold, so that none loses for a
//! pixel it was not told of. Then each method solves for the same number of texels, its maps are drawn and every pixel
//! is looked up. With [`Question::Epsilon`] the texels are searched instead, for the same quality.
//!
//! [`compare_temporal`] sets the ways in which maps hang together over a shot side by side, each planned whole.
//!
//! Lights are independent of each other and shared out to threads; no number but the times depends on how.

mod budget;
mod chosen;
mod entry;
mod files;
mod glyphs;
mod hemisphere;
mod params;
mod picture;
mod run;
mod scatter;
mod statistics;
mod summary;
mod table;
mod temporal;
mod types;
mod variant;
mod workers;

pub(crate) use budget::sizes as sizes_of;
pub use files::{SCHEMA, csv, json, write_file};
pub use hemisphere::random_hemisphere;
pub use params::{BIAS_GRID, BiasChoice, CompareParams, Question, all_methods};
pub use run::compare;
pub use scatter::scatter;
pub(crate) use statistics::quantile;
pub use summary::{Correlation, MethodSummary, Ratio, Summary, Worst, summarise};
pub(crate) use table::grid;
pub use table::table;
pub use temporal::{STRIP_FRAMES, TemporalLight, TemporalRow, compare_temporal, temporal_json, temporal_table};
pub use types::{CaseLight, Comparison, Measured, MethodRows, PerLight, TexelsFor};
pub use variant::Variant;
