//! The cheapest cut of a shot into segments, by dynamic programming over intervals: exact for the additive cost it is
//! given (Bellman 1961, "On the approximation of curves by line segments using dynamic programming").

/// Consecutive intervals, by the index after their last block.
pub type Ends = Vec<usize>;

/// The cut of `count` blocks into at most `most` intervals with the least sum of `cost(first, end)`, and that sum; an
/// infinite cost forbids an interval. `None` when every cut is forbidden, or for no block. Of equal cuts the one with
/// longer last intervals.
pub fn cheapest(count: usize, most: usize, cost: impl Fn(usize, usize) -> f64) -> Option<(f64, Ends)> {
    let most = most.min(count);
    if most == 0 {
        return None;
    }
    // best[j] is the least cost of blocks 0..j in at most `layer` intervals, from[layer][j] where the last one starts.
    let mut best = vec![f64::INFINITY; count + 1];
    best[0] = 0.0;
    let mut from: Vec<Vec<usize>> = Vec::with_capacity(most);
    for layer in 0..most {
        let mut next = best.clone();
        let mut starts: Vec<usize> = (0..=count).collect();
        for end in 1..=count {
            for (first, before) in best.iter().enumerate().take(end) {
                let value = before + cost(first, end);
                if value < next[end] {
                    (next[end], starts[end]) = (value, first);
                }
            }
        }
        let settled = layer > 0 && next == best;
        best = next;
        from.push(starts);
        if settled {
            break;
        }
    }
    if !best[count].is_finite() {
        return None;
    }
    let mut ends = Vec::new();
    let mut end = count;
    for starts in from.iter().rev() {
        // A layer that found nothing better leaves the cut to the one before it.
        if starts[end] != end {
            ends.push(end);
            end = starts[end];
        }
        if end == 0 {
            break;
        }
    }
    ends.reverse();
    Some((best[count], ends))
}

/// The cut with the least sum of the largest `size` of its intervals and of `cost` of all of them: for each size that an
/// interval may have, the cheapest cut into no larger ones.
pub fn lowest_peak(
    count: usize,
    most: usize,
    size: impl Fn(usize, usize) -> f64,
    cost: impl Fn(usize, usize) -> f64,
) -> Option<(f64, Ends)> {
    let intervals = (0..count).flat_map(|first| (first + 1..=count).map(move |end| (first, end)));
    let mut peaks: Vec<f64> = intervals.map(|(first, end)| size(first, end)).filter(|s| s.is_finite()).collect();
    peaks.sort_by(f64::total_cmp);
    peaks.dedup();
    let mut best: Option<(f64, Ends)> = None;
    for peak in peaks {
        if best.as_ref().is_some_and(|b| peak >= b.0) {
            break;
        }
        let within = |first, end| if size(first, end) <= peak { cost(first, end) } else { f64::INFINITY };
        if let Some((sum, ends)) = cheapest(count, most, within)
            && best.as_ref().is_none_or(|b| peak + sum < b.0)
        {
            best = Some((peak + sum, ends));
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every cut of `count` blocks into at most `most` intervals.
    fn all(count: usize, most: usize) -> Vec<Ends> {
        let cut = |bits: u32| -> Ends {
            let mut ends: Ends = (1..count).filter(|k| bits >> (k - 1) & 1 == 1).collect();
            ends.push(count);
            ends
        };
        (0..1u32 << (count - 1)).map(cut).filter(|ends| ends.len() <= most).collect()
    }

    fn intervals(ends: &Ends) -> Vec<(usize, usize)> {
        std::iter::once(0).chain(ends.iter().copied()).zip(ends.iter().copied()).collect()
    }

    /// Numbers without pattern, some forbidden.
    fn table(seed: u64, count: usize) -> impl Fn(usize, usize) -> f64 {
        move |first, end| {
            let mut x = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ (first * (count + 1) + end) as u64;
            for _ in 0..3 {
                x = (x ^ x >> 31).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            }
            let value = (x >> 40) as f64 / f64::from(1 << 24);
            if value > 0.9 { f64::INFINITY } else { (end - first) as f64 * 0.3 + value }
        }
    }

    #[test]
    fn as_cheap_as_the_best_of_all_cuts() {
        for seed in 0..200 {
            let count = 1 + seed as usize % 9;
            let cost = table(seed, count);
            for most in [1, 2, 3, count] {
                let sum = |ends: &Ends| intervals(ends).iter().map(|(a, b)| cost(*a, *b)).sum::<f64>();
                let exhaustive = all(count, most).iter().map(sum).fold(f64::INFINITY, f64::min);
                match cheapest(count, most, &cost) {
                    None => assert_eq!(exhaustive, f64::INFINITY),
                    Some((value, ends)) => {
                        assert!(ends.len() <= most && ends.last() == Some(&count));
                        assert!((sum(&ends) - value).abs() < 1e-12 && (value - exhaustive).abs() < 1e-12);
                    }
                }
            }
        }
    }

    #[test]
    fn the_lowest_peak_of_all_cuts() {
        for seed in 0..100 {
            let count = 1 + seed as usize % 8;
            let (size, cost) = (table(seed, count), table(seed + 1000, count));
            let value = |ends: &Ends| {
                let peak = intervals(ends).iter().map(|(a, b)| size(*a, *b)).fold(0.0, f64::max);
                peak + intervals(ends).iter().map(|(a, b)| cost(*a, *b)).sum::<f64>()
            };
            let exhaustive = all(count, count).iter().map(value).fold(f64::INFINITY, f64::min);
            match lowest_peak(count, count, &size, &cost) {
                None => assert_eq!(exhaustive, f64::INFINITY),
                Some((found, ends)) => assert!((found - exhaustive).abs() < 1e-12 && value(&ends) == found),
            }
        }
    }
}
