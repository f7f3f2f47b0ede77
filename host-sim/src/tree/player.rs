//! The leaves of a dry run, which play scripts of statuses and run the scripts of the file.

use super::blackboard::Blackboard;
use super::diagnostic::Diagnostic;
use super::instance::{Instance, Node};
use super::lower::{HookTask, Lowered};
use super::script::Script;
use super::statuses::{Statuses, letter};
use super::timers::Timers;
use iibt_core::time::Instant;
use iibt_core::tree::{Halt, Leaves, Status, StatusChange};

/// The player of all leaves, and its notes.
pub(super) struct Player<'i> {
    pub instance: &'i Instance,
    pub lowered: &'i Lowered,
    board: Blackboard<'i>,
    /// For each hook, its script of statuses and how often it was ticked.
    parts: Vec<(Statuses, usize)>,
    /// For each row, whether it is running.
    running: Vec<bool>,
    /// The calls of leaves since they were last taken.
    pub events: Vec<String>,
    pub transitions: Vec<StatusChange>,
    pub timers: Timers,
    /// The first script that could not be run.
    pub error: Option<Diagnostic>,
}

impl<'i> Player<'i> {
    pub(super) fn new(
        instance: &'i Instance,
        lowered: &'i Lowered,
        scripts: &[(String, Statuses)],
    ) -> Result<Self, Diagnostic> {
        let parts = lowered.hooks.iter().map(|hook| part(instance, hook.node, scripts));
        Ok(Self {
            instance,
            lowered,
            board: Blackboard::new(instance),
            parts: parts.map(|part| Ok((part?, 0))).collect::<Result<_, _>>()?,
            running: vec![false; lowered.rows.len()],
            events: Vec::new(),
            transitions: Vec::new(),
            timers: Timers::new(&lowered.rows),
            error: None,
        })
    }

    fn node(&self, hook: u16) -> Option<(&'i Node, usize)> {
        let index = self.lowered.hooks.get(usize::from(hook))?.node;
        Some((self.instance.nodes.get(index)?, index))
    }

    fn is_running(&self, node: usize) -> bool {
        let row = self.lowered.inner.get(node).copied().unwrap_or(usize::MAX);
        self.running.get(row).copied().unwrap_or(false)
    }

    fn perform(&mut self, hook: u16) -> Status {
        let lowered = self.lowered;
        let (Some((node, _)), Some(task)) = (self.node(hook), lowered.hooks.get(usize::from(hook))) else {
            return Status::Failure;
        };
        let instance = self.instance;
        let done = match &task.task {
            HookTask::Leaf => return self.play(hook, node),
            HookTask::Skip => return Status::Skipped,
            HookTask::Script(script) => script.run(&mut self.board.view(node)).map(|_| ()),
            HookTask::Set => self.board.copy(instance, node),
            HookTask::Unset => self.board.remove(instance, node),
            _ => Ok(()),
        };
        match done {
            Ok(()) => Status::Success,
            Err(reason) => self.fail(node, reason),
        }
    }

    fn play(&mut self, hook: u16, node: &Node) -> Status {
        let Some((statuses, ticks)) = self.parts.get_mut(usize::from(hook)) else { return Status::Failure };
        let status = statuses.at(*ticks);
        *ticks += 1;
        self.events.push(format!("{}:{}", node.name, letter(status)));
        status
    }

    fn fail(&mut self, node: &Node, reason: String) -> Status {
        let message = format!("'{}' cannot be run: {reason}", node.name);
        self.error.get_or_insert_with(|| Diagnostic::error(&node.place, message));
        Status::Failure
    }

    fn is_true(&mut self, node: &Node, script: &Script) -> bool {
        match script.run(&mut self.board.view(node)).and_then(|value| value.truth()) {
            Ok(holds) => holds,
            Err(reason) => {
                self.fail(node, reason);
                false
            }
        }
    }

    /// Runs the scripts that follow a change of a node's status.
    fn after(&mut self, index: usize, to: Option<Status>) {
        let instance = self.instance;
        let Some(node) = instance.nodes.get(index) else { return };
        let attributes: &[&str] = match to {
            None => &["_onHalted"],
            Some(Status::Success) => &["_onSuccess", "_post"],
            Some(Status::Failure) => &["_onFailure", "_post"],
            Some(Status::Running | Status::Skipped) => return,
        };
        for attribute in attributes {
            for guard in node.guards.iter().filter(|guard| guard.attribute == *attribute) {
                if let Err(reason) = guard.script.run(&mut self.board.view(node)) {
                    self.fail(node, reason);
                }
            }
        }
    }
}

impl Leaves<u16> for Player<'_> {
    fn condition(&mut self, hook: &u16, _: Instant) -> bool {
        let lowered = self.lowered;
        let (Some((node, index)), Some(task)) = (self.node(*hook), lowered.hooks.get(usize::from(*hook)))
        else {
            return false;
        };
        match &task.task {
            HookTask::Guard { script, passes_if, asks_while_running } => {
                (self.is_running(index) && !asks_while_running) || self.is_true(node, script) == *passes_if
            }
            HookTask::Condition(script) | HookTask::Precondition(script) => self.is_true(node, script),
            _ => self.play(*hook, node) == Status::Success,
        }
    }

    fn on_start(&mut self, hook: &u16, _: Instant) -> Status {
        self.perform(*hook)
    }

    fn on_running(&mut self, hook: &u16, _: Instant) -> Status {
        self.perform(*hook)
    }

    fn on_halted(&mut self, hook: &u16, _: Instant) -> Halt {
        let is_leaf = self
            .lowered
            .hooks
            .get(usize::from(*hook))
            .is_some_and(|hook| matches!(hook.task, HookTask::Leaf));
        if let Some((node, _)) = self.node(*hook).filter(|_| is_leaf) {
            self.events.push(format!("halt({})", node.name));
        }
        Halt::Done
    }

    fn case(&mut self, hook: &u16, _: Instant) -> usize {
        let instance = self.instance;
        self.node(*hook).map_or(usize::MAX, |(node, _)| self.board.case(instance, node))
    }

    fn transition(&mut self, transition: StatusChange) {
        self.timers.note(&transition);
        let row = usize::from(transition.node);
        if let Some(running) = self.running.get_mut(row) {
            *running = transition.to == Some(Status::Running);
        }
        let Some(&node) = self.lowered.nodes.get(row) else { return };
        if self.lowered.outer.get(node) == Some(&row) {
            self.transitions.push(StatusChange { node: node as u16, ..transition });
            self.after(node, transition.to);
        }
    }
}

/// The script of statuses of a leaf: by its name, by its kind, by its own port.
fn part(instance: &Instance, node: usize, scripts: &[(String, Statuses)]) -> Result<Statuses, Diagnostic> {
    let Some(node) = instance.nodes.get(node) else { return Ok(succeeds()) };
    let given =
        |name: &str| scripts.iter().rev().find(|(given, _)| given == name).map(|(_, part)| part.clone());
    if let Some(part) = given(&node.name).or_else(|| given(node.id())) {
        return Ok(part);
    }
    if !node.ports.contains_key("s") || node.id() != super::model::SCRIPTED {
        return Ok(succeeds());
    }
    let (text, place) = instance.text(node, "s")?;
    text.parse().map_err(|reason: String| Diagnostic::error(place, reason))
}

fn succeeds() -> Statuses {
    "S".parse().unwrap_or_else(|_| unreachable!("S is a status"))
}
