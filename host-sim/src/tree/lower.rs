//! Lowering of a tree to the engine's table.

use super::diagnostic::{Diagnostic, Place, Severity};
use super::instance::{Guard, Instance, Node};
use super::parameter::Given;
use super::script::Script;
use iibt_core::tree::{
    Full, Kinds, Millis, Node as Row, OwnedTree, Row as LinkedRow, Status, Times, TreeError, TreeRule,
};

/// A tree as the engine's table.
#[derive(Clone, Debug)]
pub(super) struct Lowered {
    /// The table; a leaf or a question is named by its place in `hooks`.
    pub rows: Vec<Row<u16>>,
    /// For each row, the node of the tree that it belongs to.
    pub nodes: Vec<usize>,
    /// For each node of the tree, its outermost row: the conditions before it stand around it.
    pub outer: Vec<usize>,
    /// For each node of the tree, its own row.
    pub inner: Vec<usize>,
    /// The calls that the table leaves to the program.
    pub hooks: Vec<Hook>,
}

/// A call that the table leaves to the program.
#[derive(Clone, Debug)]
pub(super) struct Hook {
    /// The node of the tree.
    pub node: usize,
    pub task: HookTask,
}

#[derive(Clone, Debug)]
pub(super) enum HookTask {
    /// An action or condition of the program's own.
    Leaf,
    /// Run a script and succeed.
    Script(Script),
    /// Whether a script is true.
    Condition(Script),
    /// Copy a value to an entry of the blackboard.
    Set,
    /// Remove an entry of the blackboard.
    Unset,
    /// The case of a switch that is taken.
    Switch,
    /// Whether the child of a `Precondition` may run.
    Precondition(Script),
    /// Whether a script before a node has the value that lets the node be ticked.
    Guard { script: Script, passes_if: bool, asks_while_running: bool },
    /// Return SKIPPED.
    Skip,
}

/// The rules that the table follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Rules {
    Ours,
    BehaviorTreeCpp,
}

impl Instance {
    /// The table of this tree.
    ///
    /// # Errors
    /// The first node that the engine does not have, or whose parameters it cannot have.
    pub(super) fn lower(&self, rules: Rules) -> Result<Lowered, Diagnostic> {
        let count = self.nodes.len();
        let mut lowering = Lowering {
            instance: self,
            rules,
            lowered: Lowered {
                rows: Vec::with_capacity(count),
                nodes: Vec::with_capacity(count),
                outer: vec![0; count],
                inner: vec![0; count],
                hooks: Vec::new(),
            },
        };
        if count > 0 {
            lowering.node(0)?;
        }
        match lowering.lowered.tree::<Full>() {
            Ok(_) => Ok(lowering.lowered),
            Err(error) => {
                let place = self.place_of(&lowering.lowered, error.node);
                let reason =
                    if error.rule == TreeRule::TooDeep { " (conditions before nodes count)" } else { "" };
                Err(Diagnostic::error(&place, format!("{}{reason}", message(error.rule))))
            }
        }
    }

    /// Checks that every node can be ticked, whatever the leaves return.
    ///
    /// # Errors
    /// As [`lower`](Self::lower), and the first node that no tick can reach.
    pub(crate) fn check_reach(&self) -> Result<(), Diagnostic> {
        let lowered = self.lower(Rules::Ours)?;
        let never = lowered.never_ticked().map(|row| self.place_of(&lowered, row));
        never.map_or(Ok(()), |place| Err(Diagnostic::error(&place, "no tick can reach this node")))
    }

    fn place_of(&self, lowered: &Lowered, row: u16) -> Place {
        let node = lowered.nodes.get(usize::from(row)).and_then(|&node| self.nodes.get(node));
        node.or(self.nodes.first()).map_or_else(|| Place::start_of(&self.main), |node| node.place.clone())
    }
}

impl Lowered {
    /// The table, linked.
    pub(super) fn tree<K: Kinds>(&self) -> Result<OwnedTree<u16, Vec<LinkedRow<u16>>, K>, TreeError> {
        OwnedTree::try_new(self.rows.iter().copied().map(LinkedRow::new).collect())
    }

    /// The first row that no tick can reach.
    pub(super) fn never_ticked(&self) -> Option<u16> {
        self.tree::<Full>().ok()?.by_ref().never_ticked(&mut vec![0; self.rows.len()])
    }
}

/// The reasons why `run` and `codegen` refuse a tree that BehaviorTree.CPP loads, and the nodes
/// that no tick reaches.
pub(super) fn remarks(instance: &Instance) -> Vec<Diagnostic> {
    let lowered = match instance.lower(Rules::Ours) {
        Ok(lowered) => lowered,
        Err(error) => {
            let message = format!("run and codegen refuse this tree: {}", error.message);
            return vec![Diagnostic { severity: Severity::Warning, message, ..error }];
        }
    };
    let place = lowered.never_ticked().map(|row| instance.place_of(&lowered, row));
    place.map(|place| Diagnostic::warning(&place, "no tick can reach this node")).into_iter().collect()
}

struct Lowering<'i> {
    instance: &'i Instance,
    rules: Rules,
    lowered: Lowered,
}

impl<'i> Lowering<'i> {
    fn node(&mut self, index: usize) -> Result<(), Diagnostic> {
        let Some(node) = self.instance.nodes.get(index) else { return Ok(()) };
        if let Some(outer) = self.lowered.outer.get_mut(index) {
            *outer = self.lowered.rows.len();
        }
        let ends = self.guards(index, node);
        if let Some(inner) = self.lowered.inner.get_mut(index) {
            *inner = self.lowered.rows.len();
        }
        let row = self.row(index, node)?;
        self.push(index, row);
        for &child in &node.children {
            self.node(child)?;
        }
        for _ in 0..ends {
            let skip = self.hook(index, HookTask::Skip);
            self.push(index, Row::Action(skip));
        }
        Ok(())
    }

    fn push(&mut self, node: usize, row: Row<u16>) {
        self.lowered.rows.push(row);
        self.lowered.nodes.push(node);
    }

    fn hook(&mut self, node: usize, task: HookTask) -> u16 {
        self.lowered.hooks.push(Hook { node, task });
        (self.lowered.hooks.len() - 1) as u16
    }

    /// Puts the conditions before a node around it; says how many rows that skip must follow it.
    fn guards(&mut self, index: usize, node: &Node) -> usize {
        let mut ends = 0;
        for guard in &node.guards {
            let otherwise = match guard.attribute {
                "_failureIf" => Status::Failure,
                "_successIf" => Status::Success,
                "_skipIf" | "_while" => Status::Skipped,
                _ => continue,
            };
            let asks_while_running = guard.attribute == "_while";
            let condition = self.guard(index, guard, asks_while_running);
            if asks_while_running && self.rules == Rules::BehaviorTreeCpp {
                // There a Precondition does not ask again while its child runs.
                self.push(index, Row::WhileDoElse(3));
                self.push(index, Row::Condition(condition));
                ends += 1;
            } else {
                self.push(index, Row::Precondition { condition, otherwise });
            }
        }
        ends
    }

    fn guard(&mut self, index: usize, guard: &Guard, asks_while_running: bool) -> u16 {
        let (script, passes_if) = (guard.script.clone(), asks_while_running);
        self.hook(index, HookTask::Guard { script, passes_if, asks_while_running })
    }

    fn row(&mut self, index: usize, node: &'i Node) -> Result<Row<u16>, Diagnostic> {
        if node.subtree.is_some() {
            return Ok(Row::SubTree);
        }
        if !node.model.is_built_in {
            return self.own(index, node);
        }
        match node.id() {
            "Inverter" => Ok(Row::Inverter),
            "ForceSuccess" => Ok(Row::ForceSuccess),
            "ForceFailure" => Ok(Row::ForceFailure),
            "KeepRunningUntilFailure" => Ok(Row::KeepRunningUntilFailure),
            "AlwaysSuccess" => Ok(Row::AlwaysSuccess),
            "AlwaysFailure" => Ok(Row::AlwaysFailure),
            "RetryUntilSuccessful" => Ok(Row::RetryUntilSuccessful(self.times(node, "num_attempts")?)),
            "Repeat" => Ok(Row::Repeat(self.times(node, "num_cycles")?)),
            "Timeout" => Ok(Row::Timeout(self.millis(node, "msec")?)),
            "Delay" => Ok(Row::Delay(self.millis(node, "delay_msec")?)),
            "Sleep" => Ok(Row::Sleep(self.millis(node, "msec")?)),
            "RunOnce" => Ok(Row::RunOnce { then_skip: self.instance.truth(node, "then_skip")? }),
            "RateController" => Ok(Row::RateController(self.period(node)?)),
            "Precondition" => self.precondition(index, node),
            "Script" => {
                let script = self.instance.script(node, "code")?;
                Ok(Row::Action(self.hook(index, HookTask::Script(script))))
            }
            "ScriptCondition" => {
                let script = self.instance.script(node, "code")?;
                Ok(Row::Condition(self.hook(index, HookTask::Condition(script))))
            }
            "SetBlackboard" => Ok(Row::Action(self.hook(index, HookTask::Set))),
            "UnsetBlackboard" => Ok(Row::Action(self.hook(index, HookTask::Unset))),
            super::model::SCRIPTED => Ok(Row::Action(self.hook(index, HookTask::Leaf))),
            _ => self.composite(index, node),
        }
    }

    /// A node of the program's own: only leaves can be handed to it.
    fn own(&mut self, index: usize, node: &Node) -> Result<Row<u16>, Diagnostic> {
        use super::model::Class;
        match node.model.class {
            Class::Action if node.is_inference => Ok(Row::Inference(self.hook(index, HookTask::Leaf))),
            Class::Action => Ok(Row::Action(self.hook(index, HookTask::Leaf))),
            Class::Condition => Ok(Row::Condition(self.hook(index, HookTask::Leaf))),
            class => {
                let message = format!(
                    "'{}' is {} of your own, and the table has only built-in ones",
                    node.id(),
                    class.tag()
                );
                Err(Diagnostic::error(&node.place, message))
            }
        }
    }

    fn composite(&mut self, index: usize, node: &'i Node) -> Result<Row<u16>, Diagnostic> {
        let Ok(children) = u8::try_from(node.children.len()) else {
            let message = format!("{} has more than 255 children, which the table cannot count", node.id());
            return Err(Diagnostic::error(&node.place, message));
        };
        Ok(match node.id() {
            "Sequence" => Row::Sequence(children),
            "AsyncSequence" => Row::AsyncSequence(children),
            "SequenceWithMemory" => Row::SequenceWithMemory(children),
            "ReactiveSequence" => Row::ReactiveSequence(children),
            "Fallback" => Row::Fallback(children),
            "AsyncFallback" => Row::AsyncFallback(children),
            "ReactiveFallback" => Row::ReactiveFallback(children),
            "IfThenElse" => Row::IfThenElse(children),
            "WhileDoElse" => Row::WhileDoElse(children),
            "PipelineSequence" => Row::PipelineSequence(children),
            "RoundRobin" => Row::RoundRobin(children),
            "Parallel" => Row::Parallel {
                children,
                success_count: self.threshold(node, "success_count")?,
                failure_count: self.threshold(node, "failure_count")?,
            },
            "ParallelAll" => {
                Row::ParallelAll { children, max_failures: self.threshold(node, "max_failures")? }
            }
            "RecoveryNode" => {
                let retries = self.instance.int(node, "number_of_retries")?;
                Row::RecoveryNode(u8::try_from(retries).map_err(|_| {
                    Diagnostic::error(
                        &node.place,
                        format!("number_of_retries {retries} is not from 0 to 255"),
                    )
                })?)
            }
            id if id.starts_with("Switch") => Row::Switch(children, self.hook(index, HookTask::Switch)),
            id => return Err(Diagnostic::error(&node.place, format!("the engine has no {id}"))),
        })
    }

    fn precondition(&mut self, index: usize, node: &'i Node) -> Result<Row<u16>, Diagnostic> {
        let script = self.instance.script(node, "if")?;
        let (text, place) = self.instance.text(node, "else")?;
        let otherwise = match text {
            "SUCCESS" => Status::Success,
            "FAILURE" => Status::Failure,
            "RUNNING" => Status::Running,
            "SKIPPED" => Status::Skipped,
            _ => {
                return Err(Diagnostic::error(
                    place,
                    format!("'{text}' is no status that a node may return"),
                ));
            }
        };
        Ok(Row::Precondition { condition: self.hook(index, HookTask::Precondition(script)), otherwise })
    }

    fn times(&self, node: &Node, port: &str) -> Result<Times, Diagnostic> {
        let value = self.instance.int(node, port)?;
        Ok(Times::new(if value < -1 { 0 } else { value }))
    }

    fn millis(&self, node: &Node, port: &str) -> Result<Millis, Diagnostic> {
        let value = self.instance.millis(node, port)?;
        if value <= Millis::MAX {
            return Ok(Millis::new(value));
        }
        let place = match self.instance.given(node, port) {
            Given::Text(_, place) | Given::Entry(_, place) => place,
            Given::Missing => &node.place,
        };
        Err(Diagnostic::error(
            place,
            format!("{value} ms is more than the clock can measure, {} ms", Millis::MAX),
        ))
    }

    fn period(&self, node: &Node) -> Result<Millis, Diagnostic> {
        let hz = self.instance.real(node, "hz")?;
        let period = (1000.0 / hz).round();
        if (1.0..=f64::from(Millis::MAX)).contains(&period) {
            return Ok(Millis::new(period as u32));
        }
        Err(Diagnostic::error(&node.place, format!("{hz} hz is no period in whole milliseconds")))
    }

    /// A threshold; one below all children counts as none, as in BehaviorTree.CPP.
    fn threshold(&self, node: &Node, port: &str) -> Result<i8, Diagnostic> {
        let value = self.instance.int(node, port)?;
        let least = -(i32::try_from(node.children.len()).unwrap_or(i32::MAX).min(126)) - 1;
        i8::try_from(value.max(least)).map_err(|_| {
            Diagnostic::error(
                &node.place,
                format!("{port} {value} is more than the 127 children that can be counted"),
            )
        })
    }
}

fn message(rule: TreeRule) -> &'static str {
    match rule {
        TreeRule::TooLarge => "the table has more than 32768 rows, conditions before nodes included",
        TreeRule::TooDeep => "the tree has more than 256 levels",
        TreeRule::TooManyChildren => "a parallel node has at most 127 children",
        TreeRule::Arity => "the node has a number of children that its kind cannot have",
        TreeRule::SuccessCount | TreeRule::FailureCount => "the node has fewer children than its threshold",
        TreeRule::Duration => "the duration is longer than the clock can measure, or zero",
        TreeRule::Times => "the number of times is less than -1",
        _ => "the engine's table refuses this node",
    }
}
