//! (this room is being built)

mod params;

pub use params::{Effort, Method, Metric, SolverParams};
