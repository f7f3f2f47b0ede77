//! Ticking a tree whose leaves play scripts.

use super::diagnostic::Diagnostic;
use super::instance::{Instance, Node};
use super::lower::{HookTask, Lowered, Rules};
use super::player::Player;
use super::statuses::{Statuses, name};
use iibt_core::time::Instant;
use iibt_core::tree::{Compat, Full, Kinds, Next, NodeMemory, Status, StatusChange, TreeRef};
use std::fmt::Write;

/// The most passes over a tree in one tick; BehaviorTree.CPP has no bound.
const MAX_PASSES: u16 = 10_000;

/// The number of passes over the tree in a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Mode {
    /// One pass, as with `tickExactlyOnce`.
    ExactlyOnce,
    /// Passes while nodes ask for another, as with `tickOnce`.
    Once,
}

/// The settings of a dry run: ticks, time and the leaves' scripts.
#[derive(Clone, Copy, Debug)]
pub struct DryRun<'r> {
    /// The number of ticks.
    pub ticks: u32,
    /// The number of passes over the tree in a tick.
    pub mode: Mode,
    /// Milliseconds from one tick to the next.
    pub tick_ms: u32,
    /// The scripts of leaves, by name.
    pub leaves: &'r [(String, Statuses)],
    /// The tick after which the tree is halted.
    pub halt_after: Option<u32>,
    /// Whether to follow BehaviorTree.CPP where the engine differs on purpose.
    pub compat: bool,
}

/// The record of a dry run.
#[derive(Clone, Debug)]
pub struct DryRecord {
    /// A line for each tick and halt.
    pub text: String,
    /// The status of the root in each tick, and the milliseconds at which it was ticked.
    pub ticks: Vec<(u32, Status)>,
    /// The changes of the nodes' statuses; a node is named by its place in the tree, from zero.
    pub transitions: Vec<StatusChange>,
    /// The reason why it ended early.
    pub error: Option<Diagnostic>,
}

impl DryRun<'_> {
    /// Runs a tree with scripted leaves.
    ///
    /// # Errors
    /// When the engine does not have one of its nodes, or a script is for a leaf that is not there.
    pub fn run(&self, instance: &Instance) -> Result<DryRecord, Diagnostic> {
        let rules = if self.compat { Rules::BehaviorTreeCpp } else { Rules::Ours };
        let lowered = instance.lower(rules)?;
        self.find_leaves(instance, &lowered)?;
        let player = Player::new(instance, &lowered, self.leaves)?;
        Ok(match rules {
            Rules::Ours => self.play::<Full>(&lowered, player),
            Rules::BehaviorTreeCpp => self.play::<Compat>(&lowered, player),
        })
    }

    fn find_leaves(&self, instance: &Instance, lowered: &Lowered) -> Result<(), Diagnostic> {
        let leaves = || {
            let hooks = lowered.hooks.iter().filter(|hook| matches!(hook.task, HookTask::Leaf));
            hooks.filter_map(|hook| instance.nodes.get(hook.node))
        };
        let is_called = |leaf: &Node, name: &str| leaf.name == name || leaf.id() == name;
        for (name, _) in self.leaves {
            if !leaves().any(|leaf| is_called(leaf, name)) {
                let mut names: Vec<_> = leaves().map(|leaf| leaf.name.as_str()).collect();
                names.sort_unstable();
                names.dedup();
                let place = instance.nodes.first().map(|node| &node.place);
                let message =
                    format!("no leaf of '{}' is called '{name}', only {}", instance.main, names.join(", "));
                return place.map_or(Ok(()), |place| Err(Diagnostic::error(place, message)));
            }
        }
        Ok(())
    }

    fn play<K: Kinds>(&self, lowered: &Lowered, mut player: Player<'_>) -> DryRecord {
        let mut record =
            DryRecord { text: String::new(), ticks: Vec::new(), transitions: Vec::new(), error: None };
        let Ok(tree) = lowered.tree::<K>() else { return record };
        let mut memory = vec![NodeMemory::NEW; tree.len()];
        for tick in 1..=self.ticks {
            let time = (tick - 1).wrapping_mul(self.tick_ms);
            let now = Instant(time);
            player.timers.advance(now);
            let status = match self.mode {
                Mode::ExactlyOnce => tree.tick(&mut memory, &mut player, now).status,
                Mode::Once => tick_once(&tree.by_ref(), &mut memory, &mut player, now),
            };
            record.line(&format!("tick {tick}"), &mut player.events, Some(status));
            record.ticks.push((time, status));
            record.error = player.error.take();
            if record.error.is_some() {
                break;
            }
            if self.halt_after == Some(tick) {
                tree.halt(&mut memory, &mut player, now);
                record.line("haltTree", &mut player.events, None);
            }
        }
        record.transitions = player.transitions;
        record
    }
}

/// Ticks a tree while it runs and a node, or a timer that went off, asks for another pass.
fn tick_once<K: Kinds>(
    tree: &TreeRef<'_, u16, K>,
    memory: &mut [NodeMemory<K>],
    player: &mut Player<'_>,
    now: Instant,
) -> Status {
    let mut tick = tree.tick(memory, player, now);
    for _ in 1..MAX_PASSES {
        if tick.status != Status::Running || !(player.timers.take() || tick.next == Next::Now) {
            break;
        }
        tick = tree.tick(memory, player, now);
    }
    tick.status
}

impl DryRecord {
    fn line(&mut self, what: &str, events: &mut Vec<String>, status: Option<Status>) {
        _ = write!(self.text, "{what}:");
        for event in events.drain(..) {
            _ = write!(self.text, " {event}");
        }
        match status {
            Some(status) => _ = writeln!(self.text, " => {}", name(Some(status))),
            None => self.text.push('\n'),
        }
    }
}
