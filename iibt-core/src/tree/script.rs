//! Leaves that play a script, for tests: statuses in, a trace out.

use super::{Basic, Full, Halt, Kinds, Leaves, Memory, Node, Status, Tree};
use crate::time::Instant;
use std::collections::HashMap;
use std::format;
use std::string::String;
use std::vec::Vec;

/// Each leaf, named by a letter, returns the next status of its line and repeats the last.
pub(super) struct Script {
    lines: HashMap<char, Vec<Status>>,
    trace: Vec<String>,
}

impl Script {
    /// Reads lines such as `g=SF a=RRS`: S success, F failure, R running, K skipped, one letter a
    /// tick of the leaf.
    pub(super) fn new(lines: &str) -> Self {
        let parse = |line: &str| {
            let (name, letters) = line.split_once('=').unwrap();
            (name.parse().unwrap(), letters.chars().rev().map(status).collect())
        };
        Self { lines: lines.split_whitespace().map(parse).collect(), trace: Vec::new() }
    }

    /// The calls of leaves since the last trace, with `end` appended.
    pub(super) fn trace(&mut self, end: &str) -> String {
        let mut trace = core::mem::take(&mut self.trace);
        trace.push(end.into());
        trace.join(" ")
    }

    fn next(&mut self, leaf: char) -> Status {
        let line = self.lines.get_mut(&leaf).unwrap();
        let status = if line.len() > 1 { line.pop().unwrap() } else { line[0] };
        self.trace.push(format!("{leaf}:{}", letter(status)));
        status
    }
}

impl Leaves<char> for Script {
    fn condition(&mut self, leaf: &char, _: Instant) -> bool {
        self.next(*leaf) == Status::Success
    }

    fn on_start(&mut self, leaf: &char, _: Instant) -> Status {
        self.next(*leaf)
    }

    fn on_running(&mut self, leaf: &char, _: Instant) -> Status {
        self.next(*leaf)
    }

    fn on_halted(&mut self, leaf: &char, _: Instant) -> Halt {
        self.trace.push(format!("halt({leaf})"));
        Halt::Done
    }
}

/// Ticks `tree` once for each line of `expected` and compares the traces. When a tick has ended the
/// tree, its memory must be idle. A basic tree must do the same in the full set.
#[track_caller]
pub(super) fn play<const N: usize>(tree: Tree<char, N>, lines: &str, expected: &[&str]) {
    let nodes: Vec<Node<char>> = tree.nodes().copied().collect();
    play_as::<N, Basic>(tree, lines, expected);
    play_as::<N, Full>(Tree::new(nodes.try_into().unwrap()), lines, expected);
}

/// As [`play`], for a tree of the set `K`.
#[track_caller]
pub(super) fn play_as<const N: usize, K: Kinds>(tree: Tree<char, N, K>, lines: &str, expected: &[&str]) {
    let mut memory = Memory::new();
    let mut script = Script::new(lines);
    for (tick, expected) in (0..).zip(expected) {
        let status = tree.tick(&mut memory, &mut script, Instant(tick)).status;
        assert_eq!(script.trace(&format!("=> {status:?}")), *expected, "tick {tick}");
        assert_eq!(memory.is_idle(), status != Status::Running, "tick {tick}");
    }
}

fn status(letter: char) -> Status {
    match letter {
        'R' => Status::Running,
        'S' => Status::Success,
        'F' => Status::Failure,
        'K' => Status::Skipped,
        other => panic!("no status: {other}"),
    }
}

fn letter(status: Status) -> char {
    match status {
        Status::Running => 'R',
        Status::Success => 'S',
        Status::Failure => 'F',
        Status::Skipped => 'K',
    }
}
