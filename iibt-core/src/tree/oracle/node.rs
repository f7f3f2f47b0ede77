//! The rules of every node in their own, recursive form.

use super::super::{Leaves, Millis, Node, Status, Times};
use super::recorder::Recorder;
use Status::{Failure, Running, Skipped, Success};
use std::vec::Vec;

/// A node that keeps its children, its status and its counts in the way of BehaviorTree.CPP.
pub(super) struct OracleNode {
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
    pub(super) fn read(table: &mut impl Iterator<Item = Node<u16>>) -> Self {
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

    pub(super) fn execute(&mut self, leaves: &mut Recorder) -> Status {
        leaves.visits += 1;
        let fresh = !self.is_running();
        if fresh {
            self.begun = leaves.now.0;
            self.skipped = 0;
        }
        let status = self.tick(fresh, leaves);
        if status != Running {
            self.halt_children(leaves);
        }
        self.status = Some(status);
        status
    }

    /// The status of a composite or a leaf; decorators are apart.
    fn tick(&mut self, fresh: bool, leaves: &mut Recorder) -> Status {
        match self.node {
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
            Node::AlwaysSuccess => Success,
            Node::AlwaysFailure => Failure,
            Node::Sleep(time) => [Running, Success][usize::from(self.elapsed(leaves) >= time.get())],
            Node::Condition(leaf) => leaves.condition(&leaf, leaves.now).into(),
            Node::Action(leaf) | Node::Inference(leaf) if fresh => leaves.on_start(&leaf, leaves.now),
            Node::Action(leaf) | Node::Inference(leaf) => leaves.on_running(&leaf, leaves.now),
            _ => self.decorate(fresh, leaves),
        }
    }

    fn decorate(&mut self, fresh: bool, leaves: &mut Recorder) -> Status {
        match self.node {
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
            Node::Timeout(limit) => self.timed(fresh, limit, leaves),
            Node::Delay(time) => self.delayed(fresh, time, leaves),
            Node::RunOnce { then_skip } => self.once(then_skip, leaves),
            Node::Precondition { condition, otherwise } => self.guarded(condition, otherwise, leaves),
            Node::RateController(period) => self.rated(fresh, period, leaves),
            _ => self.only(leaves),
        }
    }

    fn elapsed(&self, leaves: &Recorder) -> u32 {
        leaves.now.0.wrapping_sub(self.begun)
    }

    fn timed(&mut self, fresh: bool, limit: Millis, leaves: &mut Recorder) -> Status {
        if !fresh && limit.get() > 0 && self.elapsed(leaves) >= limit.get() {
            return Failure;
        }
        self.only(leaves)
    }

    fn delayed(&mut self, fresh: bool, time: Millis, leaves: &mut Recorder) -> Status {
        self.waited = self.waited && !fresh || self.elapsed(leaves) >= time.get();
        if self.waited { self.only(leaves) } else { Running }
    }

    fn once(&mut self, then_skip: bool, leaves: &mut Recorder) -> Status {
        if let Some(status) = self.once {
            return if then_skip { Skipped } else { status };
        }
        let status = self.only(leaves);
        self.once = Some(status).filter(|status| matches!(status, Success | Failure));
        status
    }

    fn guarded(&mut self, condition: u16, otherwise: Status, leaves: &mut Recorder) -> Status {
        if leaves.condition(&condition, leaves.now) {
            return self.only(leaves);
        }
        self.halt_children(leaves);
        otherwise
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
    pub(super) fn interrupt(&mut self, leaves: &mut Recorder) {
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
    pub(super) fn running(&self) -> Vec<bool> {
        let below = self.children.iter().flat_map(Self::running);
        core::iter::once(self.is_running()).chain(below).collect()
    }
}

fn opposite(status: Status) -> Status {
    if status == Success { Failure } else { Success }
}
