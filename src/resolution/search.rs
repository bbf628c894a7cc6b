//! The smallest entry of a size grid that meets a bound, with few trials.
//!
//! Errors of a map fall with its size, but not strictly: texels fall differently on thin things at every size. So the
//! answer is defined by what was tried: the smallest entry tried such that it and every larger one tried meet, and whose
//! next smaller entry was tried and does not (or does not exist).

use std::collections::BTreeMap;

/// What a trial of one entry found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Probe {
    /// The bound holds.
    pub meets: bool,
    /// Error over epsilon; steers the search only.
    pub ratio: f64,
}

/// Exponent of error against map side that the search assumes until two trials tell better. Displacements scale with the
/// side to the power -1; saturation and thin things lower it.
const EXPONENT: f64 = 1.0;

/// Searches entries 0..`count` from a first guess. `step` is the ratio of neighbouring sides. `None` when the largest
/// entry was tried and is over. Errors of `probe` pass through.
pub fn smallest<E>(
    count: usize,
    guess: usize,
    step: f64,
    mut probe: impl FnMut(usize) -> Result<Probe, E>,
) -> Result<Option<usize>, E> {
    let mut tried: BTreeMap<usize, Probe> = BTreeMap::new();
    let mut next = guess.min(count.saturating_sub(1));
    loop {
        if let std::collections::btree_map::Entry::Vacant(entry) = tried.entry(next) {
            entry.insert(probe(next)?);
        }
        let over = tried.iter().rev().find(|(_, p)| !p.meets).map(|(i, p)| (*i, *p));
        let first = over.map_or(0, |(i, _)| i + 1);
        let met = tried.range(first..).next().map(|(i, p)| (*i, *p));
        next = match (over, met) {
            (_, Some((m, _))) if m == first => return Ok(Some(m)),
            (Some((o, _)), None) if o + 1 >= count => return Ok(None),
            (Some((o, p)), Some((m, q))) => between(o, p, m, q),
            (Some((o, p)), None) => (o + jump(p.ratio, step)).min(count - 1),
            (None, Some((m, q))) => m - jump(1.0 / q.ratio, step).min(m),
            (None, None) => return Ok(None),
        };
    }
}

/// The first entry that meets, from a guess upwards by the measured ratio; smaller ones are not tried. `None` when the largest
/// entry was tried and is over. Errors of `probe` pass through.
pub fn grown<E>(
    count: usize,
    guess: usize,
    step: f64,
    mut probe: impl FnMut(usize) -> Result<Probe, E>,
) -> Result<Option<usize>, E> {
    let last = count.saturating_sub(1);
    let mut next = guess.min(last);
    loop {
        let found = probe(next)?;
        if found.meets {
            return Ok(Some(next));
        }
        if next == last {
            return Ok(None);
        }
        next = (next + jump(found.ratio, step)).min(last);
    }
}

/// Entries to move so that an error over epsilon of `ratio` comes to 1.
fn jump(ratio: f64, step: f64) -> usize {
    let entries = ratio.clamp(1.0, 1e6).ln() / (EXPONENT * step.ln());
    (entries * 1.1).ceil().max(1.0) as usize
}

/// The entry between one that is over and a larger one that meets, where the line through their log errors is 1, kept
/// off the ends so that the bracket shrinks.
fn between(over: usize, p: Probe, met: usize, q: Probe) -> usize {
    let (a, b) = (p.ratio.max(1e-6).ln(), q.ratio.max(1e-6).ln());
    let t = if a > b { (a / (a - b)).clamp(0.1, 0.9) } else { 0.5 };
    let guess = over as f64 + t * (met - over) as f64;
    (guess.round() as usize).clamp(over + 1, met - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(count: usize, guess: usize, ratio: impl Fn(usize) -> f64) -> (Option<usize>, BTreeMap<usize, bool>) {
        let mut tried = BTreeMap::new();
        let found = smallest(count, guess, 1.02, |i| {
            let ratio = ratio(i);
            tried.insert(i, ratio <= 1.0);
            Ok::<_, ()>(Probe { meets: ratio <= 1.0, ratio })
        });
        (found.unwrap(), tried)
    }

    fn certify(found: Option<usize>, tried: &BTreeMap<usize, bool>, count: usize) {
        match found {
            Some(f) => {
                assert!(tried.range(f..).all(|(_, met)| *met));
                assert!(f == 0 || tried.get(&(f - 1)) == Some(&false));
            }
            None => assert_eq!(tried.get(&(count - 1)), Some(&false)),
        }
    }

    #[test]
    fn the_answer_is_certified_by_what_was_tried() {
        for guess in [0, 10, 150, 299] {
            for exact in [0.0, 3.0, 70.0, 250.0, 1000.0] {
                // A power law with a ripple: not monotone.
                let noisy = |i: usize| {
                    (1.02_f64).powf(0.9 * (exact - i as f64)) * (1.0 + 0.03 * ((i * 7919) % 13) as f64 / 13.0)
                };
                let (found, tried) = run(300, guess, noisy);
                certify(found, &tried, 300);
                assert!(tried.len() <= 20, "{} trials", tried.len());
            }
        }
    }

    #[test]
    fn growing_stops_at_the_first_that_meets_and_tries_none_below_the_guess() {
        for guess in [0, 50, 119, 120, 299] {
            let mut tried = Vec::new();
            let found = grown(300, guess, 1.02, |i| {
                tried.push(i);
                let ratio = 1.02_f64.powf(0.7 * (120.0 - i as f64));
                Ok::<_, ()>(Probe { meets: ratio <= 1.0, ratio })
            });
            assert_eq!(found.unwrap().as_ref(), tried.last());
            assert!(tried[0] == guess && tried.is_sorted() && tried.len() <= 8, "{tried:?}");
            assert_eq!(tried.last().copied(), Some(guess.max(*tried.last().unwrap())));
        }
        let over = |_| Ok::<_, ()>(Probe { meets: false, ratio: 3.0 });
        assert_eq!(grown(10, 4, 1.02, over), Ok(None));
    }

    #[test]
    fn one_entry() {
        assert_eq!(run(1, 5, |_| 0.5).0, Some(0));
        assert_eq!(run(1, 5, |_| 1.5).0, None);
    }
}
