//! Leaves that answer at random and note each call.

use super::super::{Halt, Leaves, Status};
use super::random::Lcg;
use crate::time::Instant;
use std::vec::Vec;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Call {
    Condition,
    Case,
    Start(Status),
    Resume(Status),
    Halt,
}

/// Leaves that answer at random and note each call.
#[derive(Clone)]
pub(super) struct Recorder {
    random: Lcg,
    /// Which of running, success, failure, skipped an action may return, how often each.
    answers: &'static [Status],
    pub(super) now: Instant,
    pub(super) calls: Vec<(u16, Call)>,
    pub(super) visits: u32,
    pub(super) woken: bool,
}

impl Recorder {
    pub(super) fn new(random: &Lcg, answers: &'static [Status]) -> Self {
        Self { random: random.clone(), answers, now: Instant(0), calls: Vec::new(), visits: 0, woken: false }
    }

    fn status(&mut self) -> Status {
        self.answers[self.random.below(self.answers.len())]
    }

    pub(super) fn begin(&mut self, now: Instant) {
        (self.now, self.visits, self.woken) = (now, 0, false);
        self.calls.clear();
    }
}

impl Leaves<u16> for Recorder {
    fn condition(&mut self, leaf: &u16, _: Instant) -> bool {
        self.calls.push((*leaf, Call::Condition));
        self.random.below(3) > 0
    }

    fn on_start(&mut self, leaf: &u16, _: Instant) -> Status {
        let status = self.status();
        self.calls.push((*leaf, Call::Start(status)));
        status
    }

    fn on_running(&mut self, leaf: &u16, _: Instant) -> Status {
        let status = self.status();
        self.calls.push((*leaf, Call::Resume(status)));
        status
    }

    fn on_halted(&mut self, leaf: &u16, _: Instant) -> Halt {
        self.calls.push((*leaf, Call::Halt));
        Halt::Done
    }

    fn case(&mut self, leaf: &u16, _: Instant) -> usize {
        self.calls.push((*leaf, Call::Case));
        self.random.below(8)
    }
}
