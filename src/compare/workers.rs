//! Independent pieces of work on several threads, each with threads of its own for what is parallel inside.
//!
//! Nested in one pool, a thread that waits for an inner loop would take up another light meanwhile: its memory would
//! pile up and its time be booked to the first.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// `work(i)` for i below `count`, in order of i. The first error in that order among those met ends the work soon.
pub(super) fn each<T: Send, E: Send>(count: usize, work: impl Fn(usize) -> Result<T, E> + Sync) -> Result<Vec<T>, E> {
    let threads = rayon::current_num_threads().max(1);
    let workers = threads.min(count.max(1));
    let (next, failed) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let found = Mutex::new(Vec::with_capacity(count));
    let run = || {
        while failed.load(Ordering::Relaxed) == 0 {
            let i = next.fetch_add(1, Ordering::Relaxed);
            if i >= count {
                break;
            }
            let result = work(i);
            failed.fetch_add(usize::from(result.is_err()), Ordering::Relaxed);
            found.lock().unwrap_or_else(std::sync::PoisonError::into_inner).push((i, result));
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..workers {
            scope.spawn(|| match rayon::ThreadPoolBuilder::new().num_threads(threads / workers).build() {
                Ok(pool) => pool.install(run),
                // Without a pool of its own the work shares the common one: slower, with the same results.
                Err(_) => run(),
            });
        }
    });
    let mut found = found.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    found.sort_by_key(|(i, _)| *i);
    found.into_iter().map(|(_, result)| result).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_come_in_order_and_errors_end_the_work() {
        let squares: Result<Vec<usize>, ()> = each(100, |i| Ok(i * i));
        assert_eq!(squares, Ok((0..100).map(|i| i * i).collect()));
        assert_eq!(each(0, |_| Ok::<_, ()>(1)), Ok(vec![]));
        let failed: Result<Vec<usize>, usize> = each(100, |i| if i == 30 { Err(i) } else { Ok(i) });
        assert_eq!(failed, Err(30));
    }
}
