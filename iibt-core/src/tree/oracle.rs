//! The rules of every node in their own, recursive form, and random trees that must agree with
//! them.

use super::{
    Basic, Full, Halt, Kinds, Leaves, MAX_DEPTH, Millis, Node, NodeMemory, Row, Status, Times, TreeRef,
};
use crate::time::Instant;
use Status::{Failure, Running, Skipped, Success};
use std::vec::Vec;

/// A node that keeps its children, its status and its counts in the way of BehaviorTree.CPP.
struct OracleNode {
    node: Node<u16>,
    children: Vec<OracleNode>,
    status: Option<Status>,
    place: usize,
    count: i64,
    skipped: usize,
    begun: u32,
    waited: bool,
    ended: Vec<(usize, Status)>,
    once: Option<Status>,
    /// Whether a pipeline ticks it, the only node that ticks a child again that has succeeded.
    piped: bool,
}

impl OracleNode {
    /// Takes the first node and its descendants off a table.
    fn read(table: &mut impl Iterator<Item = Node<u16>>) -> Self {
        let node = table.next().unwrap();
        let mut children: Vec<Self> = (0..node.children().unwrap_or(0)).map(|_| Self::read(table)).collect();
        children.iter_mut().for_each(|child| child.piped = matches!(node, Node::PipelineSequence(_)));
        Self {
            node,
            children,
            status: None,
            place: 0,
            count: 0,
            skipped: 0,
            begun: 0,
            waited: false,
            ended: Vec::new(),
            once: None,
            piped: false,
        }
    }

    fn is_running(&self) -> bool {
        self.status == Some(Running)
    }

    fn execute(&mut self, leaves: &mut Recorder) -> Status {
        leaves.visits += 1;
        let fresh = !self.is_running();
        if fresh {
            self.begun = leaves.now.0;
            self.skipped = 0;
        }
        let elapsed = leaves.now.0.wrapping_sub(self.begun);
        let status = match self.node {
            Node::Sequence(_) => self.in_order(Failure, false, leaves),
            Node::Fallback(_) => self.in_order(Success, false, leaves),
            Node::SequenceWithMemory(_) | Node::AsyncSequence(_) => self.in_order(Failure, true, leaves),
            Node::AsyncFallback(_) => self.in_order(Success, true, leaves),
            Node::ReactiveSequence(_) => self.reactive(Failure, leaves),
            Node::ReactiveFallback(_) => self.reactive(Success, leaves),
            Node::Parallel { success_count, failure_count, .. } => {
                self.parallel(success_count, failure_count, leaves)
            }
            Node::ParallelAll { max_failures, .. } => self.parallel_all(max_failures, leaves),
            Node::IfThenElse(_) => self.if_then_else(leaves),
            Node::WhileDoElse(_) => self.while_do_else(leaves),
            Node::Switch(_, leaf) => self.switch(leaf, leaves),
            Node::PipelineSequence(_) => self.pipeline(leaves),
            Node::RoundRobin(_) => self.round_robin(fresh, leaves),
            Node::RecoveryNode(retries) => self.recovery(fresh, retries, leaves),
            Node::Inverter => match self.only(leaves) {
                Success => Failure,
                Failure => Success,
                status => status,
            },
            Node::ForceSuccess => self.forced(Success, leaves),
            Node::ForceFailure => self.forced(Failure, leaves),
            Node::KeepRunningUntilFailure => match self.only(leaves) {
                Failure => Failure,
                _ => Running,
            },
            Node::RetryUntilSuccessful(times) => self.looped(fresh, Failure, times, leaves),
            Node::Repeat(times) => self.looped(fresh, Success, times, leaves),
            Node::Timeout(limit) => {
                if !fresh && limit.get() > 0 && elapsed >= limit.get() {
                    Failure
                } else {
                    self.only(leaves)
                }
            }
            Node::Delay(time) => {
                self.waited = self.waited && !fresh || elapsed >= time.get();
                if self.waited { self.only(leaves) } else { Running }
            }
            Node::RunOnce { then_skip } => match self.once {
                Some(status) => [status, Skipped][usize::from(then_skip)],
                None => {
                    let status = self.only(leaves);
                    self.once = Some(status).filter(|status| matches!(status, Success | Failure));
                    status
                }
            },
            Node::Precondition { condition, otherwise } => {
                if leaves.condition(&condition, leaves.now) {
                    self.only(leaves)
                } else {
                    self.halt_children(leaves);
                    otherwise
                }
            }
            Node::RateController(period) => self.rated(fresh, period, leaves),
            Node::SubTree => self.only(leaves),
            Node::AlwaysSuccess => Success,
            Node::AlwaysFailure => Failure,
            Node::Sleep(time) => [Running, Success][usize::from(elapsed >= time.get())],
            Node::Condition(leaf) => leaves.condition(&leaf, leaves.now).into(),
            Node::Action(leaf) | Node::Inference(leaf) if fresh => leaves.on_start(&leaf, leaves.now),
            Node::Action(leaf) | Node::Inference(leaf) => leaves.on_running(&leaf, leaves.now),
        };
        if status != Running {
            self.halt_children(leaves);
        }
        self.status = Some(status);
        status
    }

    fn only(&mut self, leaves: &mut Recorder) -> Status {
        self.children[0].execute(leaves)
    }

    fn forced(&mut self, to: Status, leaves: &mut Recorder) -> Status {
        match self.only(leaves) {
            Success | Failure => to,
            status => status,
        }
    }

    fn in_order(&mut self, decisive: Status, yields: bool, leaves: &mut Recorder) -> Status {
        while self.place < self.children.len() {
            let was_idle = !self.children[self.place].is_running();
            let status = self.children[self.place].execute(leaves);
            if status == Running {
                return Running;
            }
            if status == decisive {
                if !matches!(self.node, Node::SequenceWithMemory(_)) {
                    self.place = 0;
                }
                return status;
            }
            self.place += 1;
            self.skipped += usize::from(status == Skipped);
            if yields && status != Skipped && was_idle && self.place < self.children.len() {
                leaves.woken = true;
                return Running;
            }
        }
        self.place = 0;
        if self.skipped == self.children.len() { Skipped } else { opposite(decisive) }
    }

    fn reactive(&mut self, decisive: Status, leaves: &mut Recorder) -> Status {
        let mut all_skipped = true;
        for index in 0..self.children.len() {
            let status = self.children[index].execute(leaves);
            all_skipped &= status == Skipped;
            if status == Running {
                let others = self.children.iter_mut().enumerate().filter(|(other, _)| *other != index);
                others.for_each(|(_, child)| child.interrupt(leaves));
            }
            if status == Running || status == decisive {
                return status;
            }
        }
        if all_skipped { Skipped } else { opposite(decisive) }
    }

    fn number(&self, count: i8) -> usize {
        let all = self.children.len() as i32;
        if count < 0 { (all + i32::from(count) + 1).max(0) as usize } else { count as usize }
    }

    fn failures(&self) -> usize {
        self.ended.iter().filter(|(_, status)| *status == Failure).count()
    }

    fn parallel(&mut self, success_count: i8, failure_count: i8, leaves: &mut Recorder) -> Status {
        let (required, refused) = (self.number(success_count), self.number(failure_count));
        let mut skipped = 0;
        for index in 0..self.children.len() {
            if self.ended.iter().all(|(child, _)| *child != index) {
                match self.children[index].execute(leaves) {
                    Running => {}
                    Skipped => skipped += 1,
                    status => self.ended.push((index, status)),
                }
            }
            let failures = self.failures();
            let successes = self.ended.len() - failures;
            if successes >= required || success_count < 0 && successes + skipped >= required {
                return self.all_over(Success);
            }
            if self.children.len() - failures < required || failures == refused {
                return self.all_over(Failure);
            }
        }
        if skipped == self.children.len() { Skipped } else { Running }
    }

    fn parallel_all(&mut self, max_failures: i8, leaves: &mut Recorder) -> Status {
        let mut skipped = 0;
        for index in 0..self.children.len() {
            if self.ended.iter().any(|(child, _)| *child == index) {
                continue;
            }
            match self.children[index].execute(leaves) {
                Running => {}
                Skipped => skipped += 1,
                status => self.ended.push((index, status)),
            }
        }
        if skipped == self.children.len() {
            return Skipped;
        }
        if skipped + self.ended.len() < self.children.len() {
            return Running;
        }
        let failed = self.failures() >= self.number(max_failures);
        self.all_over(if failed { Failure } else { Success })
    }

    fn all_over(&mut self, status: Status) -> Status {
        self.ended.clear();
        status
    }

    fn if_then_else(&mut self, leaves: &mut Recorder) -> Status {
        if self.place == 0 {
            match self.children[0].execute(leaves) {
                Success => self.place = 1,
                Failure if self.children.len() == 3 => self.place = 2,
                status => return status,
            }
        }
        let status = self.children[self.place].execute(leaves);
        if status != Running {
            self.place = 0;
        }
        status
    }

    fn while_do_else(&mut self, leaves: &mut Recorder) -> Status {
        let (chosen, other) = match self.children[0].execute(leaves) {
            Success => (1, 2),
            Failure => (2, 1),
            status => return status,
        };
        if chosen >= self.children.len() {
            return Failure;
        }
        if let Some(other) = self.children.get_mut(other) {
            other.interrupt(leaves);
        }
        self.children[chosen].execute(leaves)
    }

    fn switch(&mut self, leaf: u16, leaves: &mut Recorder) -> Status {
        let chosen = leaves.case(&leaf, leaves.now).min(self.children.len() - 1);
        for (index, child) in self.children.iter_mut().enumerate() {
            if index != chosen {
                child.interrupt(leaves);
            }
        }
        self.children[chosen].execute(leaves)
    }

    fn pipeline(&mut self, leaves: &mut Recorder) -> Status {
        let mut skipped = 0;
        for index in 0..self.children.len() {
            match self.children[index].execute(leaves) {
                Running if index >= self.place => {
                    self.place = index;
                    return Running;
                }
                Failure => {
                    self.place = 0;
                    return Failure;
                }
                status => skipped += usize::from(status == Skipped),
            }
        }
        self.place = 0;
        if skipped == self.children.len() { Skipped } else { Success }
    }

    fn round_robin(&mut self, fresh: bool, leaves: &mut Recorder) -> Status {
        let all = self.children.len();
        if fresh {
            self.count = 0;
        }
        let mut skipped = 0;
        while self.count as usize + skipped < all {
            let status = self.children[self.place].execute(leaves);
            if status == Running {
                return Running;
            }
            self.place = (self.place + 1) % all;
            match status {
                Success => return Success,
                Failure => self.count += 1,
                _ => skipped += 1,
            }
        }
        self.place = 0;
        if skipped == all { Skipped } else { Failure }
    }

    fn recovery(&mut self, fresh: bool, retries: u8, leaves: &mut Recorder) -> Status {
        if fresh {
            (self.count, self.place) = (0, 0);
        }
        loop {
            let status = self.children[self.place].execute(leaves);
            match (self.place, status) {
                (_, Running) => return Running,
                (0, Failure) if self.count < i64::from(retries) => self.place = 1,
                (0, _) => return status,
                (_, Success) => {
                    self.count += 1;
                    self.place = 0;
                }
                _ => return Failure,
            }
        }
    }

    fn looped(&mut self, fresh: bool, again: Status, times: Times, leaves: &mut Recorder) -> Status {
        if fresh {
            self.count = 0;
        }
        let times = i64::from(times.get());
        while times < 0 || self.count < times {
            let was_idle = !self.children[0].is_running();
            let status = self.only(leaves);
            if status != again {
                return status;
            }
            self.count += 1;
            self.children[0].interrupt(leaves);
            if was_idle && (times < 0 || self.count < times) {
                leaves.woken = true;
                return Running;
            }
        }
        again
    }

    fn rated(&mut self, fresh: bool, period: Millis, leaves: &mut Recorder) -> Status {
        if fresh && !self.waited {
            (self.count, self.waited) = (i64::from(leaves.now.0), true);
        } else if !self.children[0].is_running()
            && leaves.now.0.wrapping_sub(self.count as u32) < period.get()
        {
            return Running;
        }
        let status = self.only(leaves);
        if status == Success {
            self.count = i64::from(leaves.now.0);
        }
        self.waited = status == Running || status == Success && self.piped;
        status
    }

    fn halt_children(&mut self, leaves: &mut Recorder) {
        for child in &mut self.children {
            child.interrupt(leaves);
        }
    }

    /// A parent's reset of a child: told to halt if it is running, and forgetful in any case.
    fn interrupt(&mut self, leaves: &mut Recorder) {
        if self.is_running() {
            if let Node::Action(leaf) | Node::Inference(leaf) = self.node {
                leaves.on_halted(&leaf, leaves.now);
            }
            self.halt_children(leaves);
            if !matches!(self.node, Node::SequenceWithMemory(_)) {
                self.place = 0;
            }
            self.ended.clear();
        }
        self.waited = false;
        self.status = None;
    }

    /// Whether each node is running, in preorder.
    fn running(&self) -> Vec<bool> {
        let below = self.children.iter().flat_map(Self::running);
        core::iter::once(self.is_running()).chain(below).collect()
    }
}

fn opposite(status: Status) -> Status {
    if status == Success { Failure } else { Success }
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Call {
    Condition,
    Case,
    Start(Status),
    Resume(Status),
    Halt,
}

/// Leaves that answer at random and note each call.
#[derive(Clone)]
struct Recorder {
    random: Lcg,
    /// Which of running, success, failure, skipped an action may return, how often each.
    answers: &'static [Status],
    now: Instant,
    calls: Vec<(u16, Call)>,
    visits: u32,
    woken: bool,
}

impl Recorder {
    fn new(random: &Lcg, answers: &'static [Status]) -> Self {
        Self { random: random.clone(), answers, now: Instant(0), calls: Vec::new(), visits: 0, woken: false }
    }

    fn status(&mut self) -> Status {
        self.answers[self.random.below(self.answers.len())]
    }

    fn begin(&mut self, now: Instant) {
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

/// A linear congruential generator (Knuth's MMIX constants).
#[derive(Clone)]
struct Lcg(u64);

impl Lcg {
    fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % bound
    }
}

/// Appends a random subtree of about `size` nodes to `table`; a leaf is named by its row.
fn grow(table: &mut Vec<Node<u16>>, size: usize, full: bool, random: &mut Lcg) {
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

fn composite(row: u16, children: u8, full: bool, random: &mut Lcg) -> Node<u16> {
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

fn decorator(row: u16, random: &mut Lcg) -> Node<u16> {
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

fn rows(table: &[Node<u16>]) -> Vec<Row<u16>> {
    table.iter().map(|&node| Row::new(node)).collect()
}

/// Ticks random trees, now and then halting them, and compares every call with the model's.
fn agrees<K: Kinds>(size: usize, trees: usize, answers: &'static [Status], seed: u64) {
    let mut random = Lcg(seed);
    for _ in 0..trees {
        let mut table = Vec::new();
        grow(&mut table, size, K::FULL, &mut random);
        let mut rows = rows(&table);
        let tree = TreeRef::<u16, K>::try_new(&mut rows).unwrap();
        let most = tree.visits(&mut std::vec![(0, 0); table.len()]);
        let mut model = OracleNode::read(&mut table.iter().copied());
        let mut memory = std::vec![NodeMemory::<K>::NEW; table.len()];
        let (mut ours, mut theirs) = (Recorder::new(&random, answers), Recorder::new(&random, answers));
        let mut now = Instant(u32::MAX - 20);
        for tick in 0..60 {
            now = Instant(now.0.wrapping_add(random.below(3) as u32));
            ours.begin(now);
            theirs.begin(now);
            let name = std::format!("{table:?} tick {tick}");
            if random.below(12) == 0 {
                assert_eq!(tree.halt(&mut memory, &mut ours, now), Halt::Done);
                model.interrupt(&mut theirs);
            } else {
                let result = tree.tick(&mut memory, &mut ours, now);
                assert_eq!(result.status, model.execute(&mut theirs), "{name} {:?}", ours.calls);
                assert!(theirs.visits <= most, "{} visits of {most}: {name}", theirs.visits);
                assert!(result.next != super::Next::Now || result.status == Running, "{name}");
                if theirs.woken && result.status == Running {
                    assert_eq!(result.next, super::Next::Now, "{name}");
                }
                if result.status != Running {
                    model.interrupt(&mut theirs);
                }
            }
            assert_eq!(ours.calls, theirs.calls, "{name}");
            let running: Vec<bool> = memory.iter().map(NodeMemory::is_running).collect();
            assert_eq!(running, model.running(), "{name}");
        }
    }
}

const NEVER_SKIPPED: &[Status] = &[Running, Success, Failure];
const ANY: &[Status] = &[Running, Running, Success, Success, Failure, Failure, Skipped];

#[test]
fn random_basic_trees_follow_their_rules() {
    for size in [1, 2, 3, 5, 8, 13, 21, 55] {
        agrees::<Basic>(size, 200, NEVER_SKIPPED, size as u64);
    }
}

#[test]
fn random_trees_of_every_kind_follow_their_rules() {
    for size in [1, 2, 3, 4, 5, 6, 8, 13, 21, 55] {
        agrees::<Full>(size, 2000, ANY, size as u64);
    }
}

#[test]
fn every_start_has_one_end() {
    let mut random = Lcg(7);
    for _ in 0..500 {
        let mut table = Vec::new();
        grow(&mut table, 34, true, &mut random);
        let mut rows = rows(&table);
        let tree = TreeRef::<u16, Full>::try_new(&mut rows).unwrap();
        let mut memory = std::vec![NodeMemory::NEW; table.len()];
        let mut leaves = Recorder::new(&random, ANY);
        let mut running = std::vec![false; table.len()];
        for tick in 0..40 {
            match tick {
                39 => _ = tree.halt(&mut memory, &mut leaves, Instant(tick)),
                _ => _ = tree.tick(&mut memory, &mut leaves, Instant(tick)),
            }
            for (leaf, call) in leaves.calls.drain(..) {
                let leaf = usize::from(leaf);
                if matches!(call, Call::Condition | Call::Case) {
                    continue;
                }
                assert_eq!(running[leaf], matches!(call, Call::Resume(_) | Call::Halt), "leaf {leaf}");
                running[leaf] = matches!(call, Call::Start(Running) | Call::Resume(Running));
            }
        }
        assert!(running.iter().all(|running| !running));
        assert!(memory.iter().all(NodeMemory::is_idle));
    }
}

#[test]
fn the_memory_of_another_tree_neither_panics_nor_loops() {
    let mut random = Lcg(11);
    for _ in 0..500 {
        let mut tables = [Vec::new(), Vec::new()];
        for table in &mut tables {
            grow(table, 21, true, &mut random);
        }
        let mut all = tables.each_ref().map(|table| rows(table));
        let [one, other] = all.each_mut().map(|rows| TreeRef::<u16, Full>::try_new(rows).unwrap());
        let mut memory = std::vec![NodeMemory::NEW; 21];
        let mut leaves = Recorder::new(&random, ANY);
        for tick in 0..20 {
            one.tick(&mut memory, &mut leaves, Instant(tick));
            other.tick(&mut memory, &mut leaves, Instant(tick));
        }
        other.halt(&mut memory, &mut leaves, Instant(20));
        assert!(memory.iter().all(|cell| !cell.is_running()));
    }
}

#[test]
fn random_tables_are_trees_or_errors_and_trees_can_be_ticked() {
    let mut random = Lcg(13);
    let mut trees = 0;
    for _ in 0..60_000 {
        let size = 1 + random.below(6);
        let table: Vec<Node<u16>> = (0..size as u16)
            .map(|row| match random.below(4) {
                0 => composite(row, random.below(5) as u8, true, &mut random),
                1 => decorator(row, &mut random),
                _ => Node::Action(row),
            })
            .collect();
        let mut rows = rows(&table);
        match TreeRef::<u16, Full>::try_new(&mut rows) {
            Ok(tree) => {
                trees += 1;
                let mut leaves = Recorder::new(&random, ANY);
                let mut memory = std::vec![NodeMemory::NEW; size];
                for tick in 0..4 {
                    tree.tick_until_idle(&mut memory, &mut leaves, Instant(tick), 8);
                }
            }
            Err(error) => assert!(usize::from(error.node) < table.len()),
        }
    }
    assert!(trees > 1000, "only {trees} trees");
}

/// What the check says can never be ticked is never ticked, and the trees of which it says nothing
/// are.
#[test]
fn nodes_that_are_said_to_be_unreachable_are() {
    let mut random = Lcg(17);
    let mut dead = 0;
    for _ in 0..3000 {
        let mut table = Vec::new();
        grow(&mut table, 9, true, &mut random);
        let mut rows = rows(&table);
        let tree = TreeRef::<u16, Full>::try_new(&mut rows).unwrap();
        let Some(never) = tree.never_ticked(&mut [0; 32]) else { continue };
        dead += 1;
        let mut memory = std::vec![NodeMemory::NEW; table.len()];
        let mut leaves = Recorder::new(&random, ANY);
        for tick in 0..100 {
            tree.tick(&mut memory, &mut leaves, Instant(tick));
        }
        assert!(leaves.calls.iter().all(|(leaf, _)| *leaf != never), "{table:?}: {never}");
    }
    assert!(dead > 100, "only {dead} trees");
}

#[test]
fn the_deepest_tree_is_ticked_to_its_leaf() {
    let mut table = [Node::Repeat(Times::FOREVER); MAX_DEPTH];
    table[MAX_DEPTH - 1] = Node::Action(0);
    let mut rows = rows(&table);
    let tree = TreeRef::<u16, Full>::try_new(&mut rows).unwrap();
    let mut leaves = Recorder::new(&Lcg(0), &[Success]);
    let result = tree.tick_until_idle(&mut [NodeMemory::NEW; MAX_DEPTH], &mut leaves, Instant(0), 10);
    assert_eq!((result.status, leaves.calls.len()), (Running, 10));
}
