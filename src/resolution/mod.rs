//! The smallest size that meets epsilon, by predicting and measuring.

mod certify;
mod fitted;
mod judge;
mod params;
mod polish;
mod search;
mod sizes;

pub use certify::{Certified, Trial, UNCERTAIN_SLACK, certify, predict_only};
pub use fitted::{FilmQuestion, FittedLight, fit_light, predict, shares};
pub use judge::{EDGE_ON_DEGREES, Judge, JudgedMap, Verdict, bias_of};
pub use params::{AspectRule, BiasParams, Bound, MapParams, Measure, QualityParams, SIZE_MAX};
pub use polish::polish;
pub use search::{Probe, smallest};
pub use sizes::SizeGrid;
