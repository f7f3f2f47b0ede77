//! Work shared out among threads.

use std::num::NonZeroUsize;
use std::panic;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread::{self, ScopedJoinHandle};

/// What `work` makes of every number below `count`, in order. With as many threads as there are cores, if their number is left
/// open; whoever is free takes the next number.
pub(crate) fn share_out<T: Send>(
    count: usize,
    threads: Option<NonZeroUsize>,
    work: impl Fn(usize) -> T + Sync,
) -> Vec<T> {
    let cores = || thread::available_parallelism().unwrap_or(NonZeroUsize::MIN);
    let threads = threads.unwrap_or_else(cores).get().min(count);
    let next = AtomicUsize::new(0);
    let share = || {
        let mine = std::iter::repeat_with(|| next.fetch_add(1, Ordering::Relaxed));
        mine.take_while(|&number| number < count).map(|number| (number, work(number))).collect::<Vec<_>>()
    };
    let finish = |worker: ScopedJoinHandle<'_, _>| match worker.join() {
        Ok(share) => share,
        Err(cause) => panic::resume_unwind(cause),
    };
    let mut all = thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(share)).collect();
        workers.into_iter().flat_map(finish).collect::<Vec<_>>()
    });
    all.sort_by_key(|&(number, _)| number);
    all.into_iter().map(|(_, result)| result).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_is_worked_on_once_and_results_are_in_order() {
        for threads in [None, NonZeroUsize::new(1), NonZeroUsize::new(3), NonZeroUsize::new(20)] {
            let worked = AtomicUsize::new(0);
            let squares = share_out(10, threads, |number| {
                worked.fetch_add(1, Ordering::Relaxed);
                number * number
            });
            assert_eq!(squares, (0..10).map(|number| number * number).collect::<Vec<_>>());
            assert_eq!(worked.into_inner(), 10, "{threads:?}");
            assert!(share_out(0, threads, |number| number).is_empty());
        }
    }

    #[test]
    #[should_panic = "the fifth"]
    fn a_panic_is_passed_on() {
        share_out(10, None, |number| assert!(number != 5, "the fifth"));
    }
}
