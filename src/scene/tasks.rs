//! Work on long lists, shared out to all threads. Short ones, of which there may be a million, stay on their thread. Results
//! stand in the order of the list, so they do not depend on the number of threads.

use rayon::prelude::*;
use std::ops::Range;

/// Items of one task, at least: some tens of microseconds of work, more than it takes to hand a task over.
const ITEMS_A_TASK: usize = 8192;

/// What `work` makes of the numbers below `count`, run by run.
pub(super) fn runs<T: Send>(count: usize, work: impl Fn(Range<usize>) -> T + Sync) -> Vec<T> {
    let run = |task: usize| work(task * ITEMS_A_TASK..((task + 1) * ITEMS_A_TASK).min(count));
    let tasks = 0..count.div_ceil(ITEMS_A_TASK);
    if tasks.len() < 2 { tasks.map(run).collect() } else { tasks.into_par_iter().map(run).collect() }
}

/// Appends what `make` makes of the numbers below `count`.
pub(super) fn extend<T: Send>(list: &mut Vec<T>, count: usize, make: impl Fn(usize) -> T + Sync + Send) {
    if count < 2 * ITEMS_A_TASK {
        list.extend((0..count).map(make));
    } else {
        list.par_extend((0..count).into_par_iter().with_min_len(ITEMS_A_TASK).map(make));
    }
}

/// Lets `work` fill a list run by run, each given with the number of its first item.
pub(super) fn fill<T: Send>(list: &mut [T], work: impl Fn(usize, &mut [T]) + Sync) {
    if list.len() < 2 * ITEMS_A_TASK {
        work(0, list);
    } else {
        list.par_chunks_mut(ITEMS_A_TASK).enumerate().for_each(|(task, run)| work(task * ITEMS_A_TASK, run));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_and_long_lists_are_whole_and_in_order() {
        for count in [0, 1, ITEMS_A_TASK, ITEMS_A_TASK + 1, 5 * ITEMS_A_TASK - 1] {
            let expected: Vec<usize> = (0..count).collect();
            assert_eq!(runs(count, |run| run.collect::<Vec<_>>()).concat(), expected);
            let mut list = vec![7];
            extend(&mut list, count, |k| k);
            assert_eq!(list[0], 7);
            assert_eq!(list[1..], expected);
            let mut list = vec![0; count];
            fill(&mut list, |first, run| run.iter_mut().zip(first..).for_each(|(item, k)| *item = k));
            assert_eq!(list, expected);
        }
    }
}
