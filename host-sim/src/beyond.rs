//! What goes beyond the paper, measured: teams of unlike robots, and preferences learned from one mission to the next.
//!
//! Each is flown with the capability on and off in the same worlds, on the same seeds.

mod learned;
mod mixed;

pub use learned::{Learned, Served};
pub use mixed::{Mixed, Unlike};

use crate::campaign::Score;
use crate::flight::{Conditions, fly};
use crate::scenario::Scenario;
use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

/// Works out something for every number below `count`, on all cores; the results are in order.
fn for_all<T: Send>(count: usize, work: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let next = AtomicUsize::new(0);
    let share = || {
        let mine = std::iter::repeat_with(|| next.fetch_add(1, Ordering::Relaxed));
        mine.take_while(|&index| index < count).map(|index| (index, work(index))).collect::<Vec<_>>()
    };
    let cores = thread::available_parallelism().map_or(1, NonZeroUsize::get);
    let mut all: Vec<_> = thread::scope(|scope| {
        let workers: Vec<_> = (0..cores).map(|_| scope.spawn(share)).collect();
        let joined = workers.into_iter().map(|worker| worker.join());
        joined.flat_map(|share| share.unwrap_or_else(|panic| std::panic::resume_unwind(panic))).collect()
    });
    all.sort_by_key(|&(index, _)| index);
    all.into_iter().map(|(_, result)| result).collect()
}

/// What came of one flight.
fn score(scenario: &Scenario, seed: u64) -> Score {
    let conditions = Conditions { seed, ..Conditions::default() };
    let record = fly(scenario, conditions, &mut ()).expect("a sound scenario can be flown");
    Score::of(scenario, &record)
}
