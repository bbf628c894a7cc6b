//! The smallest size that meets epsilon, by predicting and measuring.

mod bias;
mod certify;
mod choice;
mod fitted;
mod judge;
mod judged_map;
mod nearby;
mod params;
mod polish;
mod sampled;
mod search;
mod shares;
mod sizes;
mod spent;
mod unmeasured;

pub use bias::{default_bias, measured_bias};
pub use certify::{Certified, Trial, certify, check, choose, grid_of, predicted_at_quantile, refined, trial};
pub use choice::{
    Contest, Entrant, Ladder, Need, Planned, Rung, SINGLE_MAP, Standing, Stop, TriedRung, auto, best, climb, improved,
    planned, rungs,
};
pub use fitted::{
    FilmQuestion, FittedLight, bound_limit, fit_light, fit_texels, predict, predicted_bound, predicted_texels,
};
pub use judge::{Judge, OnFilm, other_biases};
pub use judged_map::JudgedMap;
use judged_map::undrawn;
pub use params::{AspectRule, BiasParams, Bound, MapParams, Measure, QualityParams, SIZE_MAX, SingleSided, TEXELS_MAX};
pub use polish::{Drawing, Turn, polish, polishes, size_on_grid};
pub use sampled::Sampled;
pub use search::{Probe, grown, smallest};
pub use shares::shares;
pub use sizes::{SizeGrid, texels};
pub use spent::Spent;
pub use unmeasured::{MapsOf, Unmeasured};
