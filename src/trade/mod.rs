//! What time buys: settings of the planner timed side by side, and what their plans come to.
//!
//! An *operating point* is a set of job keys that cost time: a preset with none, one or a few of them changed
//! ([`points`]). Each point plans every frame and light by itself through the planner's own functions, alone on the
//! machine, several times; its time is the median. What it planned is then judged outside the clock, on the film's exact
//! answers: the wrong pixels at equal texels, the texels that its matrices need for epsilon, and whether the plan's word
//! that epsilon is met was true.
//!
//! The price of a point on a light is the larger of the texels that it planned and of those that its matrix needs: who
//! plans too much pays for it, and who plans too little has to add. *Excess* is that price over the thorough preset's, as
//! the geometric mean over lights.
//!
//! The *front* holds what no other point beats in time, excess and certainty: one that does not measure does not beat one
//! that does, for its price is known to the judge alone.
//!
//! [`plan_within`] is the other direction: from a time to the point that costs no more.

mod budget;
mod error;
mod files;
mod front;
mod model;
mod pick;
mod plot;
mod price;
mod run;
mod summary;
mod sweep;
mod table;
mod types;

pub use budget::{Budget, plan_within};
pub use error::TradeError;
pub use files::{SCHEMA, json};
pub use front::{Place, Rank, front, place};
pub use model::{Model, ModelPoint};
pub use plot::plot;
pub use run::{TradeParams, trade};
pub use sweep::{Point, points};
pub use table::table;
pub use types::{CaseResult, PointResult, PresetResult, Trade, TradeCase};
