//! Wrong pixels against texels, from sizes that were measured.
//!
//! Measured counts fall with texels as powers of them, t^-1/2 where displacement alone counts (math note §5) and less where
//! shadows are thin, but not strictly: texels fall differently on thin things at every size. The curve is the lower convex
//! hull of the points (ln t, ln (n + 1)), cut where it stops falling. In logarithms rather than in numbers, because a power
//! law is a straight line there: between two measured sizes the curve is the power law through both, where a chord of the
//! numbers themselves would overstate it, and have one marginal gain over all of its length. A hull that is convex in
//! logarithms and falls is convex in numbers too, so that marginal gains fall strictly and are equal at the optimum. One is
//! added because maps without wrong pixels are points as well.

/// A size that was measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Texels of all maps together, above 0.
    pub texels: f64,
    /// Wrong pixels.
    pub wrong: f64,
}

/// A falling convex curve through the lowest of some points.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Ascending in texels, descending in wrong pixels; at least one.
    hull: Vec<Point>,
}

impl Curve {
    /// Through some points, in any order. `None` without a point of positive texels and finite numbers.
    pub fn new(points: &[Point]) -> Option<Curve> {
        let fit = |p: &&Point| p.texels > 0.0 && p.texels.is_finite() && p.wrong >= 0.0 && p.wrong.is_finite();
        let mut sorted: Vec<Point> = points.iter().filter(fit).copied().collect();
        sorted.sort_by(|a, b| a.texels.total_cmp(&b.texels).then(a.wrong.total_cmp(&b.wrong)));
        sorted.dedup_by(|b, a| a.texels == b.texels);
        let mut hull: Vec<Point> = Vec::with_capacity(sorted.len());
        for point in sorted {
            while let [.., a, b] = hull[..] {
                if slope(&a, &b) < slope(&b, &point) {
                    break;
                }
                hull.pop();
            }
            hull.push(point);
        }
        let falling = hull.windows(2).take_while(|w| w[1].wrong < w[0].wrong).count();
        hull.truncate(falling + 1);
        (!hull.is_empty()).then_some(Curve { hull })
    }

    /// The sizes that span it.
    pub fn hull(&self) -> &[Point] {
        &self.hull
    }

    /// Fewest texels measured.
    pub fn least(&self) -> f64 {
        self.hull[0].texels
    }

    /// Texels beyond which nothing measured has fewer wrong pixels.
    pub fn most(&self) -> f64 {
        self.hull[self.hull.len() - 1].texels
    }

    /// Wrong pixels at some texels; constant beyond the ends.
    pub fn wrong(&self, texels: f64) -> f64 {
        let t = texels.clamp(self.least(), self.most());
        match self.piece(t) {
            Some((a, b)) => ((a.wrong + 1.0) * (t / a.texels).powf(slope(&a, &b)) - 1.0).max(0.0),
            None => self.hull[0].wrong,
        }
    }

    /// Wrong pixels fewer per texel: of the last texel, infinite at the least size, and of the next, 0 at the most. They
    /// differ at the sizes that span the curve only.
    pub fn gains(&self, texels: f64) -> [f64; 2] {
        let gain = |(a, b): (&Point, &Point)| -slope(a, b) * (self.wrong(texels) + 1.0) / texels;
        let pieces = || self.hull.windows(2).map(|w| (&w[0], &w[1]));
        let last = if texels <= self.least() {
            f64::INFINITY
        } else {
            pieces().rfind(|(a, _)| a.texels < texels).map_or(0.0, gain)
        };
        let next = pieces().find(|(_, b)| texels < b.texels).map_or(0.0, gain);
        [if texels > self.most() { 0.0 } else { last }, next]
    }

    /// The texels at which the next one gains no more than `price`, wrong pixels per texel.
    pub fn texels_at(&self, price: f64) -> f64 {
        for w in self.hull.windows(2) {
            let (a, b, s) = (w[0], w[1], slope(&w[0], &w[1]));
            let [first, last] = [a, b].map(|p| -s * (p.wrong + 1.0) / p.texels);
            if price >= first {
                return a.texels;
            }
            if price > last {
                return (a.texels * (first / price).powf(1.0 / (1.0 - s))).min(b.texels);
            }
        }
        self.most()
    }

    /// The piece of the hull that holds some texels, clamped to it.
    fn piece(&self, texels: f64) -> Option<(Point, Point)> {
        let after = self.hull.partition_point(|p| p.texels < texels).max(1);
        Some((self.hull[after - 1], *self.hull.get(after)?))
    }
}

/// The exponent of the power law through two points, of wrong pixels plus one.
fn slope(a: &Point, b: &Point) -> f64 {
    ((b.wrong + 1.0) / (a.wrong + 1.0)).ln() / (b.texels / a.texels).ln()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noisy(exponent: f64) -> Vec<Point> {
        (8..22)
            .map(|k| {
                let texels = 2.0_f64.powi(k);
                let ripple = 1.0 + 0.2 * f64::from((k * 7) % 5) / 5.0;
                Point { texels, wrong: 1e5 * texels.powf(-exponent) * ripple }
            })
            .collect()
    }

    #[test]
    fn the_curve_lies_under_the_points_falls_and_is_convex() {
        let points = noisy(0.6);
        let curve = Curve::new(&points).unwrap();
        for p in &points {
            assert!(curve.wrong(p.texels) <= p.wrong * (1.0 + 1e-12), "{p:?}");
        }
        let at = |k: u32| curve.least() * (curve.most() / curve.least()).powf(f64::from(k) / 1000.0);
        for k in 1..1000 {
            assert!(curve.wrong(at(k + 1)) < curve.wrong(at(k)));
            let [last, next] = curve.gains(at(k));
            assert!(last >= next && next >= curve.gains(at(k + 1))[0], "{k}");
        }
        for p in curve.hull() {
            assert!((curve.wrong(p.texels) - p.wrong).abs() < 1e-9 * p.wrong);
        }
    }

    #[test]
    fn gains_are_derivatives_and_prices_lead_back() {
        let curve = Curve::new(&noisy(0.5)).unwrap();
        for texels in [300.0, 5_000.5, 77_777.0, 1.9e6] {
            let step = texels * 1e-6;
            let slope = (curve.wrong(texels - step) - curve.wrong(texels + step)) / (2.0 * step);
            let [last, next] = curve.gains(texels);
            assert!((last / slope - 1.0).abs() < 1e-4 && (next / slope - 1.0).abs() < 1e-4, "{texels}");
            assert!((curve.texels_at(slope) / texels - 1.0).abs() < 1e-4);
        }
        assert_eq!(curve.gains(curve.least())[0], f64::INFINITY);
        assert_eq!(curve.gains(curve.most())[1], 0.0);
        assert_eq!(curve.texels_at(0.0), curve.most());
        assert_eq!(curve.texels_at(1e9), curve.least());
    }

    #[test]
    fn flat_rising_and_empty_ones() {
        let point = |texels, wrong| Point { texels, wrong };
        let flat = Curve::new(&[point(100.0, 7.0), point(200.0, 7.0), point(400.0, 9.0)]).unwrap();
        assert_eq!((flat.least(), flat.most(), flat.wrong(300.0)), (100.0, 100.0, 7.0));
        assert_eq!(flat.gains(100.0)[1], 0.0);
        let zero = Curve::new(&[point(100.0, 7.0), point(200.0, 0.0), point(400.0, 0.0)]).unwrap();
        assert_eq!((zero.most(), zero.wrong(1e9)), (200.0, 0.0));
        assert!(Curve::new(&[]).is_none() && Curve::new(&[point(0.0, 1.0), point(1.0, f64::NAN)]).is_none());
    }
}
