//! A parallel map.

use rayon::ThreadPoolBuilder;
use rayon::iter::{IndexedParallelIterator, IntoParallelIterator, ParallelIterator};
use std::num::NonZeroUsize;

/// Returns the results of `work` for every number below `count`, in order.
///
/// Uses one thread per core, or the given number.
pub(crate) fn parallel_map<T: Send>(
    count: usize,
    threads: Option<NonZeroUsize>,
    work: impl Fn(usize) -> T + Send + Sync,
) -> Vec<T> {
    let all = || (0..count).into_par_iter().with_max_len(1).map(work).collect();
    match threads {
        None => all(),
        Some(threads) => {
            let pool = ThreadPoolBuilder::new().num_threads(threads.get()).build();
            pool.expect("the operating system starts threads").install(all)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    #[test]
    fn every_number_is_worked_on_once_and_results_are_in_order() {
        for threads in [None, NonZeroUsize::new(1), NonZeroUsize::new(3), NonZeroUsize::new(20)] {
            let worked = AtomicUsize::new(0);
            let squares = parallel_map(10, threads, |number| {
                worked.fetch_add(1, Ordering::Relaxed);
                number * number
            });
            assert_eq!(squares, (0..10).map(|number| number * number).collect::<Vec<_>>());
            assert_eq!(worked.into_inner(), 10, "{threads:?}");
            assert!(parallel_map(0, threads, |number| number).is_empty());
        }
    }

    #[test]
    #[should_panic = "the fifth"]
    fn a_panic_is_passed_on() {
        parallel_map(10, None, |number| assert!(number != 5, "the fifth"));
    }
}
