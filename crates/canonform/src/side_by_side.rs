//! Several shapes at a time.

use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread::scope;

use rayon::ThreadPoolBuilder;

/// Works on items side by side, each on threads of its own: on one if there are at least as many items as threads. Results come in
/// the order of the items. After a failure no item is begun.
///
/// If all items shared the threads, one that waits within an item would take up another item, and sampling would measure in advance
/// for threads that are busy.
///
/// ```
/// let halves = canonform::side_by_side(vec![2, 4, 6], |n| Ok::<_, String>(n / 2))?;
/// assert_eq!(halves, [1, 2, 3]);
/// # Ok::<(), String>(())
/// ```
///
/// # Errors
/// Those of `work`, of the first item that failed.
pub fn side_by_side<T: Send, R: Send, E: Send>(
    items: Vec<T>,
    work: impl Fn(T) -> Result<R, E> + Sync,
) -> Result<Vec<R>, E> {
    let n_threads = rayon::current_num_threads();
    let n_workers = items.len().clamp(1, n_threads);
    let (queue, failed) = (Mutex::new(items.into_iter().enumerate()), AtomicBool::new(false));
    let next = || {
        let mut queue = queue.lock().unwrap_or_else(PoisonError::into_inner);
        if failed.load(Ordering::Relaxed) { None } else { queue.next() }
    };
    let run = || {
        let mut done = Vec::new();
        while let Some((place, item)) = next() {
            let result = work(item);
            failed.fetch_or(result.is_err(), Ordering::Relaxed);
            done.push((place, result));
        }
        done
    };
    let mut done = scope(|scope| {
        let on_own_threads = || match ThreadPoolBuilder::new().num_threads(n_threads / n_workers).build() {
            Ok(pool) => pool.install(run),
            Err(_) => run(),
        };
        let workers: Vec<_> = (0..n_workers).map(|_| scope.spawn(on_own_threads)).collect();
        let done =
            workers.into_iter().map(|worker| worker.join().unwrap_or_else(|panic| resume_unwind(panic)));
        done.flatten().collect::<Vec<_>>()
    });
    done.sort_by_key(|(place, _)| *place);
    done.into_iter().map(|(_, result)| result).collect()
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicUsize;

    use super::*;

    #[test]
    fn every_item_has_threads_of_its_own() {
        testkit::on_threads(4, || {
            for (n_items, expected) in [(0, 0), (1, 4), (2, 2), (3, 1), (9, 1)] {
                let threads = side_by_side(vec![(); n_items], |()| Ok::<_, ()>(rayon::current_num_threads()));
                assert_eq!(threads, Ok(vec![expected; n_items]));
            }
        });
    }

    #[test]
    fn a_failure_is_that_of_the_first_item_and_ends_the_work() {
        let begun = AtomicUsize::new(0);
        let fail_later = |n: usize| {
            begun.fetch_add(1, Ordering::Relaxed);
            if n < 3 { Ok(n) } else { Err(n) }
        };
        testkit::on_threads(1, || {
            assert_eq!(side_by_side((0..100).collect(), fail_later), Err(3));
        });
        assert_eq!(begun.into_inner(), 4);
    }
}
