//! Which point of a table a budget buys, with few timings.

/// A point and the seconds expected of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Picked {
    /// Place in the table.
    pub(super) index: usize,
    /// Seconds a frame and light.
    pub(super) seconds: f64,
}

/// The last point of a table, fastest first, that takes no longer than the budget; the first one where all take longer.
pub(super) fn by_table(seconds: &[f64], budget: f64) -> Picked {
    let index = seconds.iter().rposition(|s| *s <= budget).unwrap_or(0);
    Picked { index, seconds: seconds.get(index).copied().unwrap_or(0.0) }
}

/// The same where `time` measures a point, each at most once: the table says how points compare, the last timing by how much
/// all of them differ from it here. What is chosen was timed. `None` when there is nothing to time.
pub(super) fn by_timing<E>(
    seconds: &[f64],
    budget: f64,
    mut time: impl FnMut(usize) -> Result<Option<f64>, E>,
) -> Result<Option<Picked>, E> {
    let Some(first) = time(0)? else { return Ok(None) };
    let mut best = Picked { index: 0, seconds: first };
    let (mut scale, mut over) = (first / seconds[0], seconds.len());
    while best.seconds <= budget {
        let fits = |k: &usize| seconds[*k] * scale <= budget;
        let Some(next) = (best.index + 1..over).rev().find(fits) else { break };
        let Some(found) = time(next)? else { break };
        scale = found / seconds[next];
        if found <= budget {
            best = Picked { index: next, seconds: found };
        } else {
            over = next;
        }
    }
    Ok(Some(best))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TABLE: [f64; 6] = [0.01, 0.02, 0.05, 0.1, 0.5, 2.0];

    /// Times as in the table but for a factor each.
    fn run(budget: f64, factors: [f64; 6]) -> (usize, Vec<usize>) {
        let mut timed = Vec::new();
        let found = by_timing(&TABLE, budget, |k| {
            timed.push(k);
            Ok::<_, ()>(Some(TABLE[k] * factors[k]))
        });
        (found.unwrap().unwrap().index, timed)
    }

    #[test]
    fn a_table_alone_buys_the_last_point_within_the_budget() {
        assert_eq!(by_table(&TABLE, 0.11), Picked { index: 3, seconds: 0.1 });
        assert_eq!(by_table(&TABLE, 1e9).index, 5);
        assert_eq!(by_table(&TABLE, 1e-9).index, 0);
    }

    #[test]
    fn a_faster_machine_buys_more_and_nothing_is_timed_twice() {
        assert_eq!(run(0.11, [1.0; 6]), (3, vec![0, 3]));
        assert_eq!(run(0.11, [0.2; 6]), (4, vec![0, 4]));
        assert_eq!(run(0.11, [20.0; 6]), (0, vec![0]));
        // The points that measure are slower here than the first one promises.
        assert_eq!(run(0.11, [1.0, 1.0, 1.0, 3.0, 3.0, 3.0]), (2, vec![0, 3, 1, 2]));
        // And here faster.
        assert_eq!(run(0.11, [1.0, 1.0, 0.1, 0.1, 0.1, 0.1]), (4, vec![0, 3, 4]));
    }

    #[test]
    fn nothing_to_time_picks_nothing() {
        assert_eq!(by_timing(&TABLE, 1.0, |_| Ok::<_, ()>(None)), Ok(None));
        assert_eq!(by_timing(&TABLE, 1.0, |_| Err(3)), Err(3));
    }
}
