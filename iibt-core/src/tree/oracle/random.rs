//! Random trees.

use super::super::{Millis, Node, Status, Times};
use Status::{Failure, Running, Skipped, Success};
use std::vec::Vec;

/// A linear congruential generator (Knuth's MMIX constants).
#[derive(Clone)]
pub(super) struct Lcg(pub(super) u64);

impl Lcg {
    pub(super) fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % bound
    }
}

/// Appends a random subtree of about `size` nodes to `table`; a leaf is named by its row.
pub(super) fn grow(table: &mut Vec<Node<u16>>, size: usize, full: bool, random: &mut Lcg) {
    let row = table.len() as u16;
    if size <= 1 {
        let kinds = if full { 8 } else { 4 };
        return table.push(match random.below(kinds) {
            0 => Node::Condition(row),
            3 => Node::Inference(row),
            5 => Node::AlwaysSuccess,
            6 => Node::AlwaysFailure,
            7 => Node::Sleep(Millis::new(random.below(4) as u32)),
            _ => Node::Action(row),
        });
    }
    if random.below(4) == 0 {
        let decorator = if full { decorator(row, random) } else { Node::Inverter };
        table.push(decorator);
        return grow(table, size - 1, full, random);
    }
    let children = 1 + random.below(4.min(size - 1));
    table.push(Node::AlwaysSuccess);
    for index in 0..children {
        grow(table, (size - 1) / children + usize::from(index < (size - 1) % children), full, random);
    }
    table[usize::from(row)] = composite(row, children as u8, full, random);
}

pub(super) fn composite(row: u16, children: u8, full: bool, random: &mut Lcg) -> Node<u16> {
    let count = |random: &mut Lcg| random.below(2 * usize::from(children) + 2) as i8 - children as i8 - 1;
    match random.below(if full { 14 } else { 4 }) {
        0 => Node::Sequence(children),
        1 => Node::Fallback(children),
        2 => Node::ReactiveSequence(children),
        4 => Node::SequenceWithMemory(children),
        5 => Node::AsyncSequence(children),
        6 => Node::AsyncFallback(children),
        7 => Node::Parallel { children, success_count: count(random), failure_count: count(random) },
        8 => Node::ParallelAll { children, max_failures: count(random) },
        9 => Node::PipelineSequence(children),
        10 => Node::RoundRobin(children),
        11 if children == 2 => Node::RecoveryNode(random.below(4) as u8),
        12 if children > 1 && children < 4 => Node::WhileDoElse(children),
        11 | 12 if children > 2 => Node::Switch(children, row),
        13 if children > 1 && children < 4 => Node::IfThenElse(children),
        _ => Node::ReactiveFallback(children),
    }
}

pub(super) fn decorator(row: u16, random: &mut Lcg) -> Node<u16> {
    let time = Millis::new(random.below(5) as u32);
    let times = Times::new(random.below(5) as i32 - 1);
    match random.below(13) {
        0 => Node::ForceSuccess,
        1 => Node::ForceFailure,
        2 => Node::KeepRunningUntilFailure,
        3 => Node::RetryUntilSuccessful(times),
        4 => Node::Repeat(times),
        5 => Node::Timeout(time),
        6 => Node::Delay(time),
        7 => Node::RunOnce { then_skip: random.below(2) == 0 },
        8 => {
            let otherwise = [Failure, Success, Skipped, Running][random.below(4)];
            Node::Precondition { condition: row, otherwise }
        }
        9 => Node::RateController(Millis::new(1 + random.below(4) as u32)),
        10 => Node::SubTree,
        _ => Node::Inverter,
    }
}
