//! A recorded log replayed: the engine ticks the tree with what its leaves returned, and must
//! change the nodes that the log has.

use super::instance::Instance;
use super::lower::{Lowered, Rules};
use super::recorded::{Before, RecordedTick};
use super::statuses::name;
use iibt_core::time::{Duration, Instant};
use iibt_core::tree::{
    Basic, Full, Halt, Kinds, Leaves, NodeChange, NodeMemory, Status, StatusChange, TreeRef,
};
use std::fmt::Write;

/// The most ticks between two that are recorded that are replayed.
const MOST_BETWEEN: u32 = 1_000_000;

/// The replay of a log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Replay {
    /// The tree at each tick, drawn with the statuses of its nodes.
    pub ticks: Vec<DrawnTick>,
    /// The changes, with what nodes were before.
    pub transitions: Vec<StatusChange>,
    /// What is missing, and where.
    pub gaps: Vec<String>,
    /// Why the log is not of this tree, and where; nothing is replayed from there on.
    pub fault: Option<String>,
}

/// A tree as it was in a tick.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DrawnTick {
    /// The tick, and the last of those after it that changed the same nodes.
    pub ticks: (u32, u32),
    /// The picture: a line with the ticks and the time, and one for each node.
    pub text: String,
}

impl Instance {
    /// Replays ticks of this tree, and checks that they follow from what its leaves returned.
    ///
    /// Nothing is checked after a gap, and of a tree with conditions before nodes, which have no
    /// number in a log.
    ///
    /// # Errors
    /// The reason why the engine does not have the tree.
    pub fn replay(&self, ticks: &[RecordedTick]) -> Result<Replay, super::Diagnostic> {
        let lowered = self.lower(Rules::Ours)?;
        let full = self.replay_in::<Full>(&lowered, ticks);
        if full.fault.is_none() || !lowered.rows.iter().all(iibt_core::tree::Node::is_basic) {
            return Ok(full);
        }
        // The basic set of nodes halts an action before another one starts; images tick that.
        let basic = self.replay_in::<Basic>(&lowered, ticks);
        let is_further = basic.fault.is_none() || basic.ticks.len() >= full.ticks.len();
        Ok(if is_further { basic } else { full })
    }

    fn replay_in<K: Kinds>(&self, lowered: &Lowered, ticks: &[RecordedTick]) -> Replay {
        let is_plain = lowered.rows.len() == self.nodes.len();
        let mut replay = Replay { ticks: Vec::new(), transitions: Vec::new(), gaps: Vec::new(), fault: None };
        let Ok(tree) = lowered.tree::<K>() else { return replay };
        let mut player = is_plain.then(|| LogPlayer::new(self, lowered, tree.by_ref()));
        let mut statuses = vec![None; self.nodes.len()];
        for (index, tick) in ticks.iter().enumerate() {
            match &tick.before {
                Before::Tick => {}
                Before::Start => {
                    player = is_plain.then(|| LogPlayer::new(self, lowered, tree.by_ref()));
                    statuses.fill(None);
                }
                Before::Gap(missing) => {
                    replay.gaps.push(format!("{}: {missing}", tick.place));
                    player = None;
                }
            }
            let next = ticks.get(index + 1).filter(|next| next.before == Before::Tick);
            if let Some(player) = &mut player
                && let Err(reason) = player.play(tick, next)
            {
                replay.fault = Some(format!("{}: tick {}: {reason}", tick.place, tick.tick));
                return replay;
            }
            replay.note(self, tick, next, &mut statuses);
        }
        replay
    }

    /// The tree with a status before each node.
    fn picture(&self, statuses: &[Option<Status>]) -> String {
        let lines = self.branches().into_iter().zip(statuses);
        lines
            .map(|(line, status)| format!("{:<7}  {line}\n", status.map_or("", |status| name(Some(status)))))
            .collect()
    }
}

impl Replay {
    fn note(
        &mut self,
        instance: &Instance,
        tick: &RecordedTick,
        next: Option<&RecordedTick>,
        statuses: &mut [Option<Status>],
    ) {
        for change in &tick.changes {
            let Some(status) = statuses.get_mut(usize::from(change.node)) else { continue };
            let from = status.filter(|&status| status == Status::Running);
            self.transitions.push(StatusChange { time: tick.time, node: change.node, from, to: change.to });
            *status = change.to;
        }
        let last = next.map_or(tick.tick, |next| next.tick.saturating_sub(1).max(tick.tick));
        let mut text = match last == tick.tick {
            true => format!("tick {}", tick.tick),
            false => format!("ticks {} to {last}", tick.tick),
        };
        _ = writeln!(text, ", {} ms", tick.time.0);
        text += &instance.picture(statuses);
        self.ticks.push(DrawnTick { ticks: (tick.tick, last), text });
        // A node that has finished is idle from then on.
        statuses.iter_mut().for_each(|status| *status = status.filter(|&status| status == Status::Running));
    }
}

/// The engine, and leaves that return what is recorded.
struct LogPlayer<'l, K: Kinds> {
    tree: TreeRef<'l, u16, K>,
    memory: Vec<NodeMemory<K>>,
    leaves: RecordedLeaves<'l>,
}

impl<'l, K: Kinds> LogPlayer<'l, K> {
    fn new(instance: &'l Instance, lowered: &'l Lowered, tree: TreeRef<'l, u16, K>) -> Self {
        let running = vec![false; lowered.rows.len()];
        let leaves = RecordedLeaves { instance, lowered, running, changes: Vec::new(), next: 0, fault: None };
        Self { memory: vec![NodeMemory::NEW; lowered.rows.len()], tree, leaves }
    }

    /// Plays a tick, and those up to the next one that is recorded: they changed the same nodes.
    fn play(&mut self, tick: &RecordedTick, next: Option<&RecordedTick>) -> Result<(), String> {
        self.tick(&tick.changes, tick.time)?;
        let Some(next) = next else { return Ok(()) };
        let ticks = next.tick.saturating_sub(tick.tick);
        let between = next.time.since(tick.time).0;
        for passed in 1..ticks.min(MOST_BETWEEN) {
            let after = u64::from(between) * u64::from(passed) / u64::from(ticks);
            self.tick(&tick.changes, tick.time.after(Duration(after as u32)))?;
        }
        Ok(())
    }

    fn tick(&mut self, changes: &[NodeChange], now: Instant) -> Result<(), String> {
        self.leaves.changes = changes.to_vec();
        self.leaves.next = 0;
        loop {
            let before = self.leaves.next;
            if self.leaves.change().is_some_and(|change| change.node == 0 && change.to.is_none()) {
                self.tree.halt(&mut self.memory, &mut self.leaves, now);
            } else {
                self.tree.tick(&mut self.memory, &mut self.leaves, now);
            }
            let (fault, is_on) = (self.leaves.fault.take(), self.leaves.next > before);
            match (self.leaves.change(), fault) {
                // A tick may pass over the tree several times; if not, the change is one too many.
                (Some(change), _) if !is_on && before > 0 => {
                    let change = self.leaves.told(change.node, change.to);
                    let reason = "is recorded, which does not follow from what the leaves returned";
                    return Err(format!("{change} {reason}"));
                }
                (_, Some(fault)) => return Err(fault),
                (None, None) => return Ok(()),
                (Some(_), None) if is_on => {}
                (Some(change), None) => {
                    let change = self.leaves.told(change.node, change.to);
                    return Err(format!("{change} is recorded, and the tree changes nothing"));
                }
            }
        }
    }
}

/// Leaves that return what is recorded of them, and compare what the engine changes.
struct RecordedLeaves<'l> {
    instance: &'l Instance,
    lowered: &'l Lowered,
    /// For each row, whether it is running.
    running: Vec<bool>,
    changes: Vec<NodeChange>,
    /// The place of the next change that the engine must make.
    next: usize,
    /// The first difference.
    fault: Option<String>,
}

impl RecordedLeaves<'_> {
    fn change(&self) -> Option<NodeChange> {
        self.changes.get(self.next).copied()
    }

    /// A change in words: `3:Recharge to SUCCESS`.
    fn told(&self, node: u16, to: Option<Status>) -> String {
        let label = self.instance.nodes.get(usize::from(node)).map_or("", |node| &node.name);
        format!("{node}:{label} to {}", name(to))
    }

    fn differ(&mut self, reason: String) {
        self.fault.get_or_insert(reason);
    }

    /// What a leaf returned: its next change, or that it is still running.
    fn answer(&mut self, hook: u16) -> Status {
        let row = self.row(hook);
        // Halts of others may be reported before it.
        let mut rest = self.changes.get(self.next..).unwrap_or_default().iter();
        if let Some(NodeChange { node, to: Some(status) }) = rest.find(|change| change.to.is_some())
            && *node == row
        {
            return *status;
        }
        if !self.running.get(usize::from(row)).copied().unwrap_or(false) {
            let label = self.instance.nodes.get(usize::from(row)).map_or("", |node| &node.name);
            let recorded = self.change().map_or_else(
                || "nothing more is recorded".to_owned(),
                |change| format!("what is recorded is {}", self.told(change.node, change.to)),
            );
            self.differ(format!("{row}:{label} is ticked here, and {recorded}"));
        }
        Status::Running
    }

    fn row(&self, hook: u16) -> u16 {
        self.lowered.hooks.get(usize::from(hook)).map_or(u16::MAX, |hook| hook.node as u16)
    }

    /// Whether the child of a `Precondition` may run: unless it returns without it, or halts it.
    fn precondition(&self, row: u16, otherwise: Status) -> bool {
        let returns = NodeChange { node: row, to: Some(otherwise) };
        let halts = NodeChange { node: row + 1, to: None };
        self.change().is_none_or(|change| change != returns && change != halts)
    }

    /// Whether a leaf that is told to stop has stopped when the tick ends.
    fn stopped(&self, hook: u16) -> Halt {
        let halted = NodeChange { node: self.row(hook), to: None };
        let rest = self.changes.get(self.next..).unwrap_or_default();
        if rest.contains(&halted) { Halt::Done } else { Halt::Pending }
    }

    /// The nodes below a node, itself included.
    fn below(&self, node: usize) -> std::ops::Range<usize> {
        let level = |index: usize| self.instance.nodes.get(index).map_or(0, |node| node.level);
        let end = (node + 1..self.instance.nodes.len()).find(|&index| level(index) <= level(node));
        node..end.unwrap_or(self.instance.nodes.len())
    }
}

impl Leaves<u16> for RecordedLeaves<'_> {
    fn condition(&mut self, hook: &u16, _: Instant) -> bool {
        let row = self.row(*hook);
        if let Some(iibt_core::tree::Node::Precondition { otherwise, .. }) =
            self.lowered.rows.get(usize::from(row))
        {
            return self.precondition(row, *otherwise);
        }
        self.answer(*hook) == Status::Success
    }

    fn on_running(&mut self, hook: &u16, _: Instant) -> Status {
        self.answer(*hook)
    }

    fn on_halted(&mut self, hook: &u16, _: Instant) -> Halt {
        self.stopped(*hook)
    }

    fn on_halting(&mut self, hook: &u16, _: Instant) -> Halt {
        self.stopped(*hook)
    }

    /// The child that changes next, but for halts of the one that is left; else the one that runs.
    fn case(&mut self, hook: &u16, _: Instant) -> usize {
        let node = usize::from(self.row(*hook));
        let Some(node) = self.instance.nodes.get(node) else { return usize::MAX };
        let mut rest = self.changes.get(self.next..).unwrap_or_default().iter();
        let next = rest.find(|change| change.to.is_some()).map(|change| usize::from(change.node));
        let is_next = |&child: &usize| next.is_some_and(|next| self.below(child).contains(&next));
        let runs = |&child: &usize| self.running.get(child).copied().unwrap_or(false);
        let children = &node.children;
        children.iter().position(is_next).or_else(|| children.iter().position(runs)).unwrap_or(usize::MAX)
    }

    fn transition(&mut self, made: StatusChange) {
        if let Some(running) = self.running.get_mut(usize::from(made.node)) {
            *running = made.to == Some(Status::Running);
        }
        let expected = NodeChange { node: made.node, to: made.to };
        match self.change() {
            Some(recorded) if recorded == expected => self.next += 1,
            recorded => {
                let what = recorded.map_or("nothing more".into(), |change| self.told(change.node, change.to));
                let told = self.told(made.node, made.to);
                self.differ(format!("{told} follows from what the leaves returned, and {what} is recorded"));
            }
        }
    }
}
