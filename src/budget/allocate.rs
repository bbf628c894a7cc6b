//! The fewest wrong pixels under limits on texels.
//!
//! Minimise Σ weight_i wrong_i(t_i) over texels t_i with Σ_i charge_ri t_i ≤ most_r for each limit r. The curves are convex,
//! so the optimum is where a price λ_r ≥ 0 for each limit has every item at the size whose next texel gains
//! p_i = Σ_r λ_r charge_ri, and λ_r is 0 where the limit is not reached: marginal gains over prices are equal. The prices are
//! the maximum of the concave dual, found by ascent in one of them at a time, each step a bisection that makes its limit
//! exact. With one limit, or limits that no two share items of, one sweep is the answer.

use super::Curve;

/// What texels are given to.
#[derive(Clone, Debug)]
pub struct Item {
    /// Its measured curve.
    pub curve: Curve,
    /// What one of its wrong pixels counts, at least 0.
    pub weight: f64,
}

/// A limit on a weighted sum of texels.
#[derive(Clone, Debug, PartialEq)]
pub struct Limit {
    /// The most.
    pub most: f64,
    /// Items, by number, with what each of their texels counts, above 0.
    pub charges: Vec<(usize, f64)>,
}

/// Where marginal gains are equal.
#[derive(Clone, Debug, PartialEq)]
pub struct Allocation {
    /// Texels of each item.
    pub texels: Vec<f64>,
    /// What a texel of each item has to gain: weighted wrong pixels. 0 where no limit is reached.
    pub prices: Vec<f64>,
}

/// The items at their least pass a limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TooSmall {
    /// The limit, by number.
    pub limit: usize,
    /// What the items take at their least.
    pub least: f64,
}

/// Sweeps over the limits at most; several limits that share items converge linearly.
const SWEEPS: u32 = 300;
/// Relative change of a price that is none.
const STILL: f64 = 1e-10;
/// Halvings of a bracket of prices: of 60 binary orders to f64's accuracy.
const HALVINGS: u32 = 120;

/// Shares texels out.
///
/// # Errors
/// [`TooSmall`]: no sizes keep a limit.
pub fn allocate(items: &[Item], limits: &[Limit]) -> Result<Allocation, TooSmall> {
    for (limit, l) in limits.iter().enumerate() {
        let least = l.charges.iter().map(|(i, charge)| items[*i].curve.least() * charge).sum();
        if least > l.most {
            return Err(TooSmall { limit, least });
        }
    }
    let mut prices = vec![0.0; items.len()];
    let mut of_limits = vec![0.0; limits.len()];
    for _ in 0..SWEEPS {
        let mut moved = false;
        for (limit, old) in limits.iter().zip(&mut of_limits) {
            let new = price(items, limit, &prices, *old);
            moved |= (new - *old).abs() > STILL * new.max(*old);
            for (i, charge) in &limit.charges {
                prices[*i] = f64::max(prices[*i] + (new - *old) * charge, 0.0);
            }
            *old = new;
        }
        if !moved {
            break;
        }
    }
    let texels = items.iter().zip(&prices).map(|(item, price)| item.texels_at(*price)).collect();
    Ok(Allocation { texels, prices })
}

impl Item {
    /// The size whose next texel gains no more than `price`, weighted.
    fn texels_at(&self, price: f64) -> f64 {
        if self.weight > 0.0 { self.curve.texels_at(price / self.weight) } else { self.curve.least() }
    }
}

/// The least price of a limit at which it holds, those of the others standing.
fn price(items: &[Item], limit: &Limit, prices: &[f64], old: f64) -> f64 {
    let others = |i: usize, charge: f64| (prices[i] - old * charge).max(0.0);
    let holds = |price: f64| {
        let used: f64 = limit.charges.iter().map(|(i, c)| c * items[*i].texels_at(others(*i, *c) + price * c)).sum();
        used <= limit.most
    };
    if holds(0.0) {
        return 0.0;
    }
    let first_gain = |(i, c): &(usize, f64)| items[*i].weight * items[*i].curve.gains(items[*i].curve.least())[1] / c;
    let mut high = limit.charges.iter().map(first_gain).fold(f64::MIN_POSITIVE, f64::max) * 2.0;
    let mut low = high * 2.0_f64.powi(-60);
    if holds(low) {
        return low;
    }
    for _ in 0..HALVINGS {
        let middle = (low * high).sqrt();
        if holds(middle) { high = middle } else { low = middle }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::super::Point;
    use super::*;

    /// n + 1 = cost t^-1/2, measured at powers of 2.
    fn item(cost: f64, weight: f64) -> Item {
        let point = |k| {
            let texels = 2.0_f64.powi(k);
            Point { texels, wrong: cost * texels.powf(-0.5) - 1.0 }
        };
        Item { curve: Curve::new(&(4..20).map(point).collect::<Vec<_>>()).unwrap(), weight }
    }

    fn of_all(count: usize, most: f64) -> Limit {
        Limit { most, charges: (0..count).map(|i| (i, 1.0)).collect() }
    }

    #[test]
    fn power_laws_share_texels_by_the_two_thirds_power_of_their_costs() {
        let items = [item(4e4, 1.0), item(4e4, 3.0), item(8e4, 1.0)];
        let found = allocate(&items, &[of_all(3, 90_000.0)]).unwrap();
        let parts = [4e4_f64, 12e4, 8e4].map(|c| c.powf(2.0 / 3.0));
        for (texels, part) in found.texels.iter().zip(parts) {
            let expected = 90_000.0 * part / parts.iter().sum::<f64>();
            assert!((texels / expected - 1.0).abs() < 1e-6, "{texels} {expected}");
        }
        assert!((found.texels.iter().sum::<f64>() - 90_000.0).abs() < 1e-3);
        for ((item, texels), price) in items.iter().zip(&found.texels).zip(&found.prices) {
            assert!((item.curve.gains(*texels)[1] * item.weight / price - 1.0).abs() < 1e-6);
        }
    }

    /// Two maps one after the other, and one beside both: what holds it back is both of them.
    #[test]
    fn limits_that_share_items_have_prices_that_add() {
        let items = [item(4e4, 1.0), item(4e4, 1.0), item(4e4, 1.0)];
        let limits = [[0, 2], [1, 2]].map(|of| Limit { most: 20_000.0, charges: of.map(|i| (i, 1.0)).into() });
        let found = allocate(&items, &limits).unwrap();
        assert!((found.prices[2] / (found.prices[0] + found.prices[1]) - 1.0).abs() < 1e-6, "{found:?}");
        let by_hand = 20_000.0 / (1.0 + 2.0_f64.powf(-2.0 / 3.0));
        assert!(
            (found.texels[0] / by_hand - 1.0).abs() < 1e-6 && found.texels[2] < 0.64 * found.texels[0],
            "{found:?}"
        );
        for limit in &limits {
            assert!(limit.charges.iter().map(|(i, c)| found.texels[*i] * c).sum::<f64>() <= limit.most * (1.0 + 1e-9));
        }
    }

    #[test]
    fn a_total_over_frames_and_a_limit_on_each() {
        let items = [item(9e4, 1.0), item(9e4, 1.0), item(1e4, 1.0)];
        let each = (0..3).map(|i| Limit { most: 20_000.0, charges: vec![(i, 1.0)] });
        let limits: Vec<Limit> = each.chain([of_all(3, 30_000.0)]).collect();
        let found = allocate(&items, &limits).unwrap();
        assert!((found.texels.iter().sum::<f64>() - 30_000.0).abs() < 1.0, "{found:?}");
        assert!(found.texels.iter().all(|t| *t <= 20_000.0 * (1.0 + 1e-9)));
        assert!((found.texels[0] - found.texels[1]).abs() < 1.0 && found.texels[2] < found.texels[0]);
    }

    #[test]
    fn what_no_limit_holds_back_is_at_its_most_and_what_cannot_fit_is_named() {
        let items = [item(4e4, 1.0), item(4e4, 0.0)];
        let free = allocate(&items, &[of_all(2, 1e12)]).unwrap();
        assert_eq!(free.prices, [0.0; 2]);
        assert_eq!(free.texels, [items[0].curve.most(), items[1].curve.least()]);
        let refused = allocate(&items, &[of_all(2, 31.0)]).unwrap_err();
        assert_eq!(refused, TooSmall { limit: 0, least: 32.0 });
        let exact = allocate(&items, &[of_all(2, 32.0)]).unwrap();
        assert!(exact.texels.iter().all(|t| (t / 16.0 - 1.0).abs() < 1e-12), "{exact:?}");
    }
}
