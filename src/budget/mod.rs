//! Budgets: texels shared out among maps so that the fewest pixels are wrong under limits.
//!
//! ```text
//! points    sizes and the wrong pixels that were measured at them → Curve: their lower convex hull in logarithms
//! allocate  curves, importances, limits → texels of each and the price of a texel, marginal gains equal
//! settle    texels → legal sizes within the limits
//! plot      curves → SVG
//! ```
//!
//! Knows no scene, light or map: curves, weights and limits are numbers.

mod allocate;
mod curve;
mod params;
mod plot;
mod settle;

pub use allocate::{Allocation, Item, Limit, TooSmall, allocate};
pub use curve::{Curve, Point};
pub use params::{BudgetParams, TEXEL_BYTES};
pub use plot::{Line, plot};
pub use settle::{settle, used};
