//! Choosing among methods: `auto`, the cheapest thing that serves, and `best`, the best single map by measurement.
//!
//! Both measure as the certificate does. `auto` asks for texels at the job's bound, `best` for errors at equal texels.

mod auto;
mod best;
mod ladder;
mod one;

pub use auto::auto;
pub use best::{Contest, Entrant, SINGLE_MAP, Standing, best};
pub use ladder::{Ladder, Need, Rung, Stop, TriedRung, climb, rungs};
pub use one::{Planned, improved, planned};
