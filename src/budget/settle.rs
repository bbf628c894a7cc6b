//! From texels to legal sizes: rounded down, then the rest is spent where it gains most.

use super::{Allocation, Item, Limit};
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// What sizes take of each limit.
pub fn used(texels: &[f64], limits: &[Limit]) -> Vec<f64> {
    limits.iter().map(|l| l.charges.iter().map(|(i, charge)| texels[*i] * charge).sum()).collect()
}

/// A step of an item to its next size, by what it gains.
struct Step {
    item: usize,
    gain: f64,
}

impl Ord for Step {
    fn cmp(&self, other: &Self) -> Ordering {
        self.gain.total_cmp(&other.gain).then(other.item.cmp(&self.item))
    }
}

impl PartialOrd for Step {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Step {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Step {}

/// The place of each item on its ladder of legal texels, ascending and not empty, so that every limit holds that holds at
/// the first places.
pub fn settle(items: &[Item], ladders: &[Vec<f64>], limits: &[Limit], allocation: &Allocation) -> Vec<usize> {
    let below = |i: usize| ladders[i].partition_point(|t| *t <= allocation.texels[i]).saturating_sub(1);
    let mut places: Vec<usize> = (0..items.len()).map(below).collect();
    let mut texels: Vec<f64> = places.iter().zip(ladders).map(|(place, ladder)| ladder[*place]).collect();
    let mut left: Vec<f64> = used(&texels, limits).iter().zip(limits).map(|(used, l)| l.most - used).collect();
    let mut charged: Vec<Vec<(usize, f64)>> = vec![Vec::new(); items.len()];
    for (r, limit) in limits.iter().enumerate() {
        for (i, charge) in &limit.charges {
            charged[*i].push((r, *charge));
        }
    }
    // The dual's prices leave a limit over by rounding at most; first places may be above what was allocated.
    for r in 0..limits.len() {
        while left[r] < 0.0 {
            let loss = |i: usize| {
                let lower = ladders[i][places[i] - 1];
                items[i].weight * (items[i].curve.wrong(lower) - items[i].curve.wrong(texels[i])) / (texels[i] - lower)
            };
            let able = limits[r].charges.iter().map(|(i, _)| *i).filter(|i| places[*i] > 0);
            let Some(i) = able.min_by(|a, b| loss(*a).total_cmp(&loss(*b))) else { break };
            places[i] -= 1;
            let given = texels[i] - ladders[i][places[i]];
            texels[i] -= given;
            charged[i].iter().for_each(|(r, charge)| left[*r] += given * charge);
        }
    }
    let step = |i: usize, place: usize| -> Option<Step> {
        let (from, to) = (ladders[i][place], *ladders[i].get(place + 1)?);
        let curve = &items[i].curve;
        let gained = items[i].weight * (curve.wrong(from) - curve.wrong(to));
        let paid = allocation.prices[i] * (to - from);
        (gained > 0.0).then(|| Step { item: i, gain: if paid > 0.0 { gained / paid } else { f64::INFINITY } })
    };
    let mut heap: BinaryHeap<Step> = (0..items.len()).filter_map(|i| step(i, places[i])).collect();
    while let Some(Step { item: i, .. }) = heap.pop() {
        let more = ladders[i][places[i] + 1] - ladders[i][places[i]];
        // One that does not fit now never will: limits only fill.
        if charged[i].iter().all(|(r, charge)| more * charge <= left[*r]) {
            charged[i].iter().for_each(|(r, charge)| left[*r] -= more * charge);
            places[i] += 1;
            heap.extend(step(i, places[i]));
        }
    }
    places
}

#[cfg(test)]
mod tests {
    use super::super::{Curve, Point, allocate};
    use super::*;

    #[test]
    fn sizes_keep_the_limits_and_leave_less_than_a_step() {
        let item = |cost: f64| {
            let at = |k| Point { texels: 4.0_f64.powi(k), wrong: cost * 0.6_f64.powi(k) };
            Item { curve: Curve::new(&(2..10).map(at).collect::<Vec<_>>()).unwrap(), weight: 1.0 }
        };
        let items: Vec<Item> = [3e4, 1e4, 5e4, 2e4].map(item).into();
        let ladder = |step: f64| (0..).map(|k| (16.0 * step.powi(k)).floor()).take_while(|t| *t <= 262_144.0).collect();
        let ladders: Vec<Vec<f64>> = [1.02, 1.05, 1.1, 1.3].map(ladder).into();
        let limits = [
            Limit { most: 9_000.0, charges: vec![(0, 1.0), (1, 2.0), (2, 1.0)] },
            Limit { most: 5_000.0, charges: vec![(2, 1.0), (3, 1.0)] },
        ];
        let allocation = allocate(&items, &limits).unwrap();
        let places = settle(&items, &ladders, &limits, &allocation);
        let texels: Vec<f64> = places.iter().zip(&ladders).map(|(p, l)| l[*p]).collect();
        let spent = used(&texels, &limits);
        for (limit, spent) in limits.iter().zip(&spent) {
            assert!(*spent <= limit.most, "{spent} of {}", limit.most);
        }
        for i in 0..items.len() {
            let more = ladders[i][places[i] + 1] - texels[i];
            let fits = limits
                .iter()
                .zip(&spent)
                .all(|(l, spent)| l.charges.iter().find(|c| c.0 == i).is_none_or(|c| spent + more * c.1 <= l.most));
            assert!(!fits, "item {i} could be larger");
        }
        // Nothing fits: the first places.
        let none = [Limit { most: 10.0, charges: vec![(0, 1.0), (1, 1.0), (2, 1.0), (3, 1.0)] }];
        assert_eq!(settle(&items, &ladders, &none, &allocation), [0; 4]);
    }
}
