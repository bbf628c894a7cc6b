//! What a plan says of a budget: what was spent, and what texels gain in each light.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::super::budget::{Unit, resident, units};
use super::FramePlan;
use crate::budget::{BudgetParams, TEXEL_BYTES};
use crate::scene::LightParams;

/// What texels gain in the maps of a light, over all frames that share them. Gains and prices are wrong pixels, times
/// importance, a million texels; the curve is the one through all sizes in `error.tried`, these frames together.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
pub struct LightBudget {
    /// What one of the light's wrong pixels counts.
    pub importance: f64,
    /// What the last texels of the maps saved; absent at the smallest size, which no budget takes away.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gain_of_last: Option<f64>,
    /// What the next texels would save.
    pub gain_of_next: f64,
    /// What texels here have to save for not being better spent elsewhere: `gain_of_next` <= `price` <= `gain_of_last` is the
    /// optimum. The same for all maps that the same limits hold back; 0 where none does.
    pub price: f64,
}

impl LightBudget {
    /// By what factor the price is outside of the gains; 1 = at the optimum. `None` where nothing has a price.
    pub fn imbalance(&self) -> Option<f64> {
        let over = self.gain_of_last.map_or(0.0, |last| self.price / last);
        (self.price > 0.0).then(|| over.max(self.gain_of_next / self.price).max(1.0))
    }
}

/// What a budget came to.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
pub struct BudgetSummary {
    /// Every limit holds.
    pub held: bool,
    /// Texels of the maps that are drawn, over all frames; what `texels_total` limits.
    pub texels_drawn: u64,
    /// Texels resident in the frame that has most; what `texels_per_frame` limits.
    pub texels_resident: u64,
    /// The same in bytes; what `bytes` limits.
    pub bytes_resident: u64,
    /// Certainly wrong pixels of all lights and frames.
    pub misclassified: u64,
    /// The same times the importance of each light: what was made fewest.
    pub weighted: f64,
    /// The largest factor by which a price is outside of a light's gains: 1.03 = marginal gains are equal within 3 %.
    /// Absent where no limit is reached.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub imbalance: Option<f64>,
}

impl BudgetSummary {
    /// Counts what frames hold.
    pub fn of(frames: &[FramePlan], budget: &BudgetParams, lights: &[LightParams]) -> BudgetSummary {
        let units = units(frames, lights);
        let wrong = |unit: &Unit| -> u64 {
            let of_entry =
                |[k, l]: &[usize; 2]| frames[*k].lights[*l].error.as_ref()?.measured.as_ref().map(|m| m.misclassified);
            unit.entries.iter().filter_map(of_entry).sum()
        };
        let texels_drawn = units.iter().map(|u| u.texels(frames) * u.draws).sum();
        let of_frame = |held: Vec<usize>| held.iter().map(|u| units[*u].texels(frames)).sum();
        let texels_resident = resident(&units, frames.len()).into_iter().map(of_frame).max().unwrap_or(0);
        let all = frames.iter().flat_map(|f| &f.lights).filter_map(|l| l.budget.as_ref());
        BudgetSummary {
            held: budget.texels_total.is_none_or(|most| texels_drawn <= most)
                && budget.resident().is_none_or(|most| texels_resident <= most),
            texels_drawn,
            texels_resident,
            bytes_resident: texels_resident * TEXEL_BYTES,
            misclassified: units.iter().map(wrong).sum(),
            weighted: units.iter().map(|u| u.importance * wrong(u) as f64).sum(),
            imbalance: all.filter_map(LightBudget::imbalance).reduce(f64::max),
        }
    }
}
