//! Leaves that return what is written for them, and what a tree made of it.

use iibt_core::time::Instant;
use iibt_core::tree::{Halt, Kinds, Leaves, Log, Memory, Next, Status, StatusChange, Tick, Tree};
use std::collections::HashMap;

#[derive(Default)]
pub(super) struct Script {
    lines: HashMap<char, Vec<char>>,
    pub(super) trace: String,
    /// How many more times each leaf that was halted says that it has not stopped.
    pub(super) stopping: HashMap<char, u32>,
    pub(super) log: Option<Log<8>>,
}

impl Script {
    pub(super) fn new(lines: &str) -> Self {
        let parse = |line: &str| (line.chars().next().unwrap(), line.chars().skip(2).collect());
        Self { lines: lines.split_whitespace().map(parse).collect(), ..Self::default() }
    }

    fn next(&mut self, leaf: char) -> char {
        let line = self.lines.get_mut(&leaf).unwrap_or_else(|| panic!("no line for {leaf}"));
        let letter = if line.len() > 1 { line.remove(0) } else { line[0] };
        self.trace += &format!("{leaf}:{letter} ");
        letter
    }

    fn halting(&mut self, leaf: char) -> Halt {
        match self.stopping.get_mut(&leaf) {
            Some(left) if *left > 0 => {
                *left -= 1;
                Halt::Pending
            }
            _ => Halt::Done,
        }
    }
}

impl Leaves<char> for Script {
    fn condition(&mut self, leaf: &char, _: Instant) -> bool {
        self.next(*leaf) == 'S'
    }

    fn on_start(&mut self, leaf: &char, _: Instant) -> Status {
        match self.next(*leaf) {
            'R' => Status::Running,
            'S' => Status::Success,
            'F' => Status::Failure,
            _ => Status::Skipped,
        }
    }

    fn on_running(&mut self, leaf: &char, now: Instant) -> Status {
        self.on_start(leaf, now)
    }

    fn on_halted(&mut self, leaf: &char, _: Instant) -> Halt {
        self.trace += &format!("halt({leaf}) ");
        self.halting(*leaf)
    }

    fn on_halting(&mut self, leaf: &char, _: Instant) -> Halt {
        self.trace += &format!("halting({leaf}) ");
        self.halting(*leaf)
    }

    fn case(&mut self, leaf: &char, _: Instant) -> usize {
        let letter = self.next(*leaf);
        letter.to_digit(10).map_or(usize::MAX, |digit| digit as usize)
    }

    fn transition(&mut self, transition: StatusChange) {
        if let Some(log) = &mut self.log {
            log.push(transition);
        }
    }
}

pub(super) fn end(script: &mut Script, tick: Tick) -> String {
    let letter = match tick.status {
        Status::Running => "R",
        Status::Success => "S",
        Status::Failure => "F",
        Status::Skipped => "K",
    };
    let wake = if tick.next == Next::Now { "!" } else { "" };
    format!("{}=> {letter}{wake}", std::mem::take(&mut script.trace))
}

/// Ticks `tree` exactly once for each part of `expected`; `halt` there halts the tree instead.
#[track_caller]
pub(super) fn plays<const N: usize, K: Kinds>(tree: Tree<char, N, K>, lines: &str, expected: &[&str]) {
    let mut memory = Memory::<N, K>::new();
    let mut script = Script::new(lines);
    for (tick, expected) in (0_u32..).zip(expected) {
        let now = Instant(tick.wrapping_mul(10).wrapping_sub(15));
        if let Some(halted) = expected.strip_prefix("halt:") {
            tree.halt(&mut memory, &mut script, now);
            assert_eq!(std::mem::take(&mut script.trace).trim_end(), halted.trim(), "tick {tick}");
            assert!(memory.is_idle());
        } else {
            let result = tree.tick(&mut memory, &mut script, now);
            assert_eq!(end(&mut script, result), *expected, "tick {tick}");
        }
    }
}
