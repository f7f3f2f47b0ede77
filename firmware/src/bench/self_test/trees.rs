//! A tree with nodes of most kinds, under leaves that answer at random.

use super::{Area, Bits, Vector};
use crate::bench::random_model::Chance;
use iibt_core::time::Instant;
use iibt_core::tree::{Full, Halt, Leaves, Memory, Next, Status, Tree};

/// The runs of the tree.
const RUNS: u32 = 32;

/// The ticks of a run.
const TICKS: u32 = 64;

static TREE: Tree<u8, 23, Full> = iibt_core::tree! {
    ReactiveFallback {
        Sequence { Condition(0), RetryUntilSuccessful(3) { Action(1) }, Timeout(40) { Action(2) } },
        ReactiveSequence {
            Inverter { Condition(3) },
            Parallel(2, 2) { Action(4), Repeat(2) { Action(5) }, Delay(15) { Action(6) } },
        },
        SequenceWithMemory { Action(7), Sleep(25), Fallback { Action(8), RunOnce(true) { Action(9) } } },
    }
};

pub(super) fn run(tell: &mut dyn FnMut(Vector)) {
    for number in 0..RUNS {
        let (mut memory, mut time) = (Memory::new(), Instant(u32::MAX - 200));
        let mut leaves = Random { chance: Chance::new(u64::from(number)), bits: Bits::NONE };
        for _ in 0..TICKS {
            let tick = TREE.tick(&mut memory, &mut leaves, time);
            let next = match tick.next {
                Next::Now => [0, 0],
                Next::At(instant) => [1, instant.0],
                Next::Event => [2, 0],
            };
            leaves.bits.add(tick.status as u32);
            next.into_iter().for_each(|word| leaves.bits.add(word));
            time = Instant(time.0.wrapping_add(leaves.chance.below(12)));
        }
        tell(leaves.bits.of(Area::Trees, number));
    }
}

struct Random {
    chance: Chance,
    bits: Bits,
}

impl Random {
    /// Notes a call of a leaf and answers it, with a number below `answers`.
    fn answer(&mut self, call: u8, leaf: u8, answers: u32) -> u32 {
        let answer = self.chance.below(answers);
        self.bits.add_bytes(&[call, leaf, answer as u8]);
        answer
    }
}

impl Leaves<u8> for Random {
    fn condition(&mut self, leaf: &u8, _: Instant) -> bool {
        self.answer(0, *leaf, 4) == 0
    }

    fn on_start(&mut self, leaf: &u8, now: Instant) -> Status {
        self.bits.add(1);
        self.on_running(leaf, now)
    }

    fn on_running(&mut self, leaf: &u8, _: Instant) -> Status {
        match self.answer(2, *leaf, 6) {
            0 => Status::Success,
            1 => Status::Failure,
            2 => Status::Skipped,
            _ => Status::Running,
        }
    }

    fn on_halted(&mut self, leaf: &u8, _: Instant) -> Halt {
        if self.answer(3, *leaf, 3) == 0 { Halt::Pending } else { Halt::Done }
    }

    fn on_halting(&mut self, leaf: &u8, _: Instant) -> Halt {
        if self.answer(4, *leaf, 2) == 0 { Halt::Pending } else { Halt::Done }
    }
}
