//! Ratios, quantiles, intervals, correlation.

use crate::math::Prng;

/// Resamples of the bootstrap: the ends of a 95 % interval then rest on 50 of them each.
const RESAMPLES: usize = 2000;
/// Seed of the bootstrap.
const SEED: u64 = 1;

/// Sum of the first over the sum of the second; `None` when that is zero.
pub(super) fn ratio_of_sums(pairs: &[(f64, f64)]) -> Option<f64> {
    let (a, b) = pairs.iter().fold((0.0, 0.0), |(a, b), p| (a + p.0, b + p.1));
    (b > 0.0).then(|| a / b)
}

/// 95 % interval of the ratio of sums over resampled pairs: percentile bootstrap (Efron 1979).
pub(super) fn interval(pairs: &[(f64, f64)]) -> Option<[f64; 2]> {
    let mut ratios = Vec::with_capacity(RESAMPLES);
    for k in 0..RESAMPLES {
        let mut stream = Prng::new(SEED, k as u64);
        let (mut a, mut b) = (0.0, 0.0);
        for _ in 0..pairs.len() {
            let p = pairs[stream.below(pairs.len())];
            (a, b) = (a + p.0, b + p.1);
        }
        if b > 0.0 {
            ratios.push(a / b);
        }
    }
    Some([quantile(&mut ratios.clone(), 0.025)?, quantile(&mut ratios, 0.975)?])
}

/// The quantile between order statistics, linear; `None` of nothing.
pub(crate) fn quantile(values: &mut [f64], at: f64) -> Option<f64> {
    values.sort_unstable_by(f64::total_cmp);
    let place = at * values.len().checked_sub(1)? as f64;
    let (low, part) = (place.floor() as usize, place.fract());
    let high = (low + 1).min(values.len() - 1);
    // Not a weighted sum: infinite neighbours of a zero weight would make NaN.
    Some(if part == 0.0 { values[low] } else { values[low] * (1.0 - part) + values[high] * part })
}

/// Slope of y against x through the origin, least squares.
pub(super) fn slope(pairs: &[(f64, f64)]) -> Option<f64> {
    let (xy, xx) = pairs.iter().fold((0.0, 0.0), |(xy, xx), (x, y)| (xy + x * y, xx + x * x));
    (xx > 0.0).then(|| xy / xx)
}

/// Pearson's correlation; `None` with fewer than three pairs or without spread.
pub(super) fn pearson(pairs: &[(f64, f64)]) -> Option<f64> {
    if pairs.len() < 3 {
        return None;
    }
    let n = pairs.len() as f64;
    let (mx, my) = pairs.iter().fold((0.0, 0.0), |(x, y), p| (x + p.0 / n, y + p.1 / n));
    let (xx, xy, yy) = pairs.iter().fold((0.0, 0.0, 0.0), |(xx, xy, yy), (x, y)| {
        let (dx, dy) = (x - mx, y - my);
        (xx + dx * dx, xy + dx * dy, yy + dy * dy)
    });
    (xx > 0.0 && yy > 0.0).then(|| xy / (xx * yy).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_lie_between_neighbours() {
        assert_eq!(quantile(&mut [3.0, 1.0, 2.0], 0.5), Some(2.0));
        assert_eq!(quantile(&mut [1.0, 2.0], 0.25), Some(1.25));
        assert_eq!(quantile(&mut [], 0.5), None);
        assert_eq!(quantile(&mut [5.0], 0.975), Some(5.0));
    }

    #[test]
    fn exact_lines_have_their_slope_and_full_correlation() {
        let line: Vec<(f64, f64)> = (1..20).map(|i| (f64::from(i), 1.5 * f64::from(i))).collect();
        assert!((slope(&line).unwrap() - 1.5).abs() < 1e-12);
        assert!((pearson(&line).unwrap() - 1.0).abs() < 1e-12);
        assert_eq!(pearson(&[(1.0, 1.0), (1.0, 2.0), (1.0, 3.0)]), None);
        assert_eq!(slope(&[(0.0, 1.0)]), None);
    }

    #[test]
    fn the_interval_holds_the_ratio_and_shrinks_with_the_root_of_the_rows() {
        let pairs = |n: u64| -> Vec<(f64, f64)> {
            let mut stream = Prng::new(3, n);
            (0..n).map(|_| (0.5 + stream.unit(), 1.0 + stream.unit())).collect()
        };
        let width = |n: u64| {
            let pairs = pairs(n);
            let [low, high] = interval(&pairs).unwrap();
            let ratio = ratio_of_sums(&pairs).unwrap();
            assert!(low < ratio && ratio < high);
            high - low
        };
        let shrunk = width(100) / width(1600);
        assert!((2.5..6.5).contains(&shrunk), "{shrunk}");
        assert_eq!(interval(&[]), None);
    }
}
