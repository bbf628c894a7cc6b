//! The Pareto front of time, price and certainty.
//!
//! A point that measures knows whether its maps meet the bound; one that does not only expects it, and its price was found
//! by the judge, not by itself. So none that does not measure beats one that does: the front is two stairs, one of all
//! points and one of those that measure.

/// What a point is ranked by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rank {
    /// Seconds a frame and light.
    pub seconds: f64,
    /// Texels over the thorough preset's, above 0.
    pub price: f64,
    /// Its plans are measured.
    pub measures: bool,
}

/// How far a point lies from the front, each way as a part of its own coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Price over that of the cheapest point that takes no longer, less 1.
    pub excess: f64,
    /// That point.
    pub below: usize,
    /// Time over that of the fastest point that costs no more, less 1.
    pub slower: f64,
}

/// Indices of the points that none beats, fastest first. Of equal ones the first counts.
pub fn front(points: &[Rank]) -> Vec<usize> {
    let beats = |a: usize, b: usize| {
        let (p, q) = (&points[a], &points[b]);
        let no_worse = p.seconds <= q.seconds && p.price <= q.price && p.measures >= q.measures;
        no_worse && (p != q || a < b)
    };
    let all = 0..points.len();
    let mut kept: Vec<usize> = all.clone().filter(|b| !all.clone().any(|a| beats(a, *b))).collect();
    kept.sort_by(|a, b| points[*a].seconds.total_cmp(&points[*b].seconds).then(a.cmp(b)));
    kept
}

/// Where a point lies among those that measure if it does; `None` for an index that is not there.
pub fn place(points: &[Rank], index: usize) -> Option<Place> {
    let own = *points.get(index)?;
    let least = |key: fn(&Rank) -> f64, keep: fn(&Rank, &Rank) -> bool| {
        let rivals = (0..points.len()).filter(|i| points[*i].measures >= own.measures && keep(&points[*i], &own));
        rivals.min_by(|a, b| key(&points[*a]).total_cmp(&key(&points[*b])).then(a.cmp(b)))
    };
    let below = least(|p| p.price, |p, own| p.seconds <= own.seconds)?;
    let fastest = least(|p| p.seconds, |p, own| p.price <= own.price)?;
    let (price, seconds) = (points[below].price, points[fastest].seconds);
    Some(Place { excess: own.price / price - 1.0, below, slower: own.seconds / seconds - 1.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Predicted points, then measured ones.
    fn points() -> Vec<Rank> {
        let rank = |(seconds, price, measures)| Rank { seconds, price, measures };
        let predicted = [(1.0, 5.0, false), (2.0, 3.0, false), (2.0, 4.0, false), (3.0, 3.0, false), (0.5, 8.0, false)];
        let measured = [(4.0, 6.0, true), (5.0, 2.0, true), (6.0, 4.0, true)];
        predicted.into_iter().chain(measured).map(rank).collect()
    }

    #[test]
    fn the_front_holds_what_nothing_beats() {
        let points = points();
        assert_eq!(
            front(&points),
            [4, 0, 1, 5, 6],
            "a dear point that measures is not beaten by a cheap one that does not"
        );
        assert_eq!(front(&[]), [] as [usize; 0]);
        assert_eq!(front(&[points[0], points[0]]), [0]);
    }

    #[test]
    fn places_are_measured_from_points_no_slower_and_no_dearer() {
        let points = points();
        let at = |i| place(&points, i).unwrap();
        for on in front(&points) {
            assert_eq!((at(on).excess, at(on).slower, at(on).below), (0.0, 0.0, on));
        }
        assert_eq!(at(2), Place { excess: 4.0 / 3.0 - 1.0, below: 1, slower: 0.0 });
        assert_eq!(at(3), Place { excess: 0.0, below: 1, slower: 0.5 });
        assert_eq!(at(7), Place { excess: 1.0, below: 6, slower: 6.0 / 5.0 - 1.0 });
        assert_eq!(place(&points, 8), None);
    }
}
