//! How the texels of a light are split over its maps.

use super::judge::Judge;
use super::polish::Drawing;
use crate::measure::Receivers;
use crate::methods::Region;
use crate::raster::RasterError;
use std::borrow::Cow;

/// Least share of a map, relative to an even one: a map without edges still shows surfaces, and texels as wide as a room
/// lose what the bias hides.
const LEAST: f64 = 0.1;
/// Texels at which costs are compared where nothing else is known.
const NOMINAL_TEXELS: f64 = 512.0 * 512.0;

/// The split of a light's texels over its maps, summing to 1: the method's own, else the best one, in proportion to
/// c^(2/3), c the error at unit budget (math note §6).
pub fn shares(regions: &[Region]) -> Vec<f64> {
    let by_cost = |r: &Region| r.predict(NOMINAL_TEXELS).unsaturated.max(f64::MIN_POSITIVE).powf(2.0 / 3.0);
    if regions.iter().all(|r| r.share.is_some()) {
        return normalised(regions.iter().filter_map(|r| r.share).collect(), 0.0);
    }
    normalised(regions.iter().map(by_cost).collect(), LEAST)
}

/// Shares that sum to 1, none below `least` of an even one by more than the others' rise takes from it.
fn normalised(parts: Vec<f64>, least: f64) -> Vec<f64> {
    let sum: f64 = parts.iter().sum();
    let floor = least / parts.len() as f64;
    let floored: Vec<f64> = parts.iter().map(|p| (p / sum).max(floor)).collect();
    let total: f64 = floored.iter().sum();
    floored.iter().map(|p| p / total).collect()
}

/// Rounds of moving texels.
const ROUNDS: u32 = 3;
/// Each map is measured with so many times more and fewer texels.
const SPREAD: f64 = 1.5;
/// Largest change of a share in a round: the law is local.
const MOST: f64 = 2.0;

/// Moves texels between maps by what they are measured to change. Near a share s the wrong pixels of map k follow
/// n_k s^(-a_k); where texels are spent best, a_k n_k / s_k is the same for all. Keeps the split with the fewest wrong
/// pixels. `own` are the receivers of each map. Returns the number of maps measured.
pub(super) fn measured_shares(
    judge: &mut Judge,
    own: &[Cow<Receivers>],
    texels: f64,
    drawing: &Drawing,
    shares: &mut Vec<f64>,
) -> Result<u64, RasterError> {
    let maps = judge.maps.clone();
    let mut measured = 0;
    let mut wrong = |judge: &mut Judge, k: usize, share: f64| {
        measured += 1;
        let size = (drawing.size)(maps[k].region.aspect, texels * share);
        let found = judge.least_limit(&maps[k], size, drawing.bias, &own[k], f64::INFINITY)?;
        Ok::<f64, RasterError>(found.unwrap_or(f64::INFINITY))
    };
    let mut current = shares.clone();
    let mut best: Option<f64> = None;
    for round in 0..=ROUNDS {
        let here = (0..maps.len()).map(|k| wrong(judge, k, current[k])).collect::<Result<Vec<f64>, _>>()?;
        let sum = here.iter().sum();
        if best.is_some_and(|b| sum >= b) {
            break;
        }
        best = Some(sum);
        shares.clone_from(&current);
        if round == ROUNDS {
            break;
        }
        let mut next = Vec::with_capacity(maps.len());
        for (k, n) in here.iter().enumerate() {
            let fewer = wrong(judge, k, current[k] / SPREAD)?;
            let more = wrong(judge, k, current[k] * SPREAD)?;
            // One pixel more on both sides: maps without errors have a law too.
            let exponent = ((fewer + 1.0) / (more + 1.0)).ln() / (2.0 * SPREAD.ln());
            let pull = exponent.clamp(0.05, 2.0) * (*n + 1.0);
            next.push((pull, exponent.clamp(0.05, 2.0)));
        }
        current = balanced(&current, &next);
    }
    Ok(measured)
}

/// Shares with a_k n_k (s / s_k)^(-a_k) / s equal for all k, each changed by at most [`MOST`]: bisection over the common
/// value. `laws` are (a_k n_k, a_k) at the shares `at`.
fn balanced(at: &[f64], laws: &[(f64, f64)]) -> Vec<f64> {
    let with = |level: f64| -> Vec<f64> {
        let share = |(s, (pull, a)): (&f64, &(f64, f64))| {
            s * (pull / (s * level)).powf(1.0 / (a + 1.0)).clamp(1.0 / MOST, MOST)
        };
        at.iter().zip(laws).map(share).collect()
    };
    let (mut lo, mut hi) = (f64::MIN_POSITIVE.sqrt(), 1.0 / f64::MIN_POSITIVE.sqrt());
    for _ in 0..200 {
        let middle = (lo * hi).sqrt();
        if with(middle).iter().sum::<f64>() > 1.0 { lo = middle } else { hi = middle }
    }
    normalised(with(hi), 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn balanced_shares_minimise_the_sum_of_the_laws() {
        // c_k s^(-1/2): the minimum is s ~ c^(2/3).
        let costs = [1.0_f64, 2.0, 4.0];
        let at = [1.0_f64 / 3.0; 3];
        let laws = [0, 1, 2].map(|k: usize| (0.5 * costs[k] * at[k].powf(-0.5), 0.5));
        let found = balanced(&at, &laws);
        let parts = costs.map(|c| c.powf(2.0 / 3.0));
        let sum: f64 = parts.iter().sum();
        for (found, part) in found.iter().zip(parts) {
            assert!((found - part / sum).abs() < 1e-9, "{found} {}", part / sum);
        }
    }

    #[test]
    fn a_map_without_cost_keeps_a_share() {
        let shares = normalised(vec![1.0, 0.0], LEAST);
        assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-15 && shares[1] > 0.9 * 0.5 * LEAST);
    }
}
