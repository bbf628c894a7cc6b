//! The smallest size that meets epsilon, by predicting and measuring.

mod bias;
mod certify;
mod fitted;
mod judge;
mod params;
mod polish;
mod search;
mod shares;
mod sizes;

pub use bias::default_bias;
pub use certify::{Certified, Trial, certify, predict_only};
pub use fitted::{FilmQuestion, FittedLight, fit_light, predict};
pub use judge::{Judge, JudgedMap};
pub use params::{AspectRule, BiasParams, Bound, MapParams, Measure, QualityParams, SIZE_MAX, SingleSided};
pub use polish::polish;
pub use search::{Probe, smallest};
pub use shares::shares;
pub use sizes::SizeGrid;
