//! A tree as Rust source: a constant table for firmware.

mod leaves;
mod ports;

use super::diagnostic::Diagnostic;
use super::instance::Instance;
use super::lower::{Lowered, Rules};
use super::model::POST_CONDITIONS;
use iibt_core::tree::{Node as Row, Status};
use leaves::Variants;
use std::fmt::Write;

impl Instance {
    /// Rust source of this tree: an enum of its leaves, their ports, and the table, which the
    /// compiler checks again.
    ///
    /// # Errors
    /// The first node that firmware cannot have: one that the engine lacks, scripts that run after
    /// a node, and nodes that no tick can reach.
    pub fn codegen(&self) -> Result<String, Diagnostic> {
        let lowered = self.lower(Rules::Ours)?;
        self.fit_for_firmware(&lowered)?;
        let variants = Variants::of(self, &lowered);
        let is_basic = lowered.rows.iter().all(Row::is_basic);
        let mut source = header(self, &lowered, is_basic);
        source.push_str(&variants.source());
        source.push_str(&ports::source(self, &variants));
        self.push_table(&lowered, &variants, is_basic, &mut source);
        Ok(source)
    }

    fn fit_for_firmware(&self, lowered: &Lowered) -> Result<(), Diagnostic> {
        for node in &self.nodes {
            for guard in &node.guards {
                let is_question = node.model.class == super::model::Class::Condition;
                let reason = if POST_CONDITIONS.contains(&guard.attribute) {
                    "scripts that run after a node are not translated: let the leaf do it"
                } else if guard.attribute != "_while" && !is_question {
                    "is asked only before the node starts, and firmware asks at every tick: put <Precondition> around it"
                } else {
                    continue;
                };
                return Err(Diagnostic::error(&guard.place, format!("{}: {reason}", guard.attribute)));
            }
        }
        let never = lowered.never_ticked();
        match never.and_then(|row| lowered.nodes.get(usize::from(row))).and_then(|&node| self.nodes.get(node))
        {
            Some(node) => {
                Err(Diagnostic::error(&node.place, "no tick can reach this node: the compiler refuses it"))
            }
            None => Ok(()),
        }
    }

    fn push_table(&self, lowered: &Lowered, variants: &Variants, is_basic: bool, source: &mut String) {
        let set = if is_basic { "" } else { ", Full" };
        _ = writeln!(
            source,
            "/// The number of nodes in the table.\npub const NODES: usize = {};\n",
            lowered.rows.len()
        );
        _ = writeln!(source, "/// The tree `{}`.", self.main.replace('`', "'"));
        source.push_str("#[rustfmt::skip]\n");
        _ = writeln!(source, "pub static TREE: Tree<Leaf, NODES{set}> = Tree::new([");
        let mut open: Vec<u8> = Vec::new();
        for row in &lowered.rows {
            _ = writeln!(source, "    {}Node::{},", "    ".repeat(open.len()), expression(row, variants));
            if let Some(parent) = open.last_mut() {
                *parent -= 1;
            }
            open.extend(row.children());
            while open.last() == Some(&0) {
                open.pop();
            }
        }
        source.push_str("]);\n");
    }
}

fn header(instance: &Instance, lowered: &Lowered, is_basic: bool) -> String {
    let rows = &lowered.rows;
    let uses = |test: fn(&Row<u16>) -> bool| rows.iter().any(test);
    let used = [
        ("Full", !is_basic),
        (
            "Millis",
            uses(|row| {
                matches!(row, Row::Timeout(_) | Row::Delay(_) | Row::Sleep(_) | Row::RateController(_))
            }),
        ),
        ("Node", true),
        ("Status", uses(|row| matches!(row, Row::Precondition { .. }))),
        ("Times", uses(|row| matches!(row, Row::RetryUntilSuccessful(_) | Row::Repeat(_)))),
        ("Tree", true),
    ];
    let used: Vec<_> = used.into_iter().filter(|(_, is_used)| *is_used).map(|(name, _)| name).collect();
    let name = instance.main.replace('`', "'");
    format!(
        "//! The behavior tree `{name}`, written by `host-sim tree codegen`.\n\
         //! Change the tree's file, not this one.\n\n\
         use iibt_core::tree::{{{}}};\n\n",
        used.join(", ")
    )
}

/// A row as it is written after `Node::`.
fn expression(row: &Row<u16>, variants: &Variants) -> String {
    let leaf = |hook: &u16| format!("Leaf::{}", variants.name(*hook));
    match row {
        Row::Condition(hook) => format!("Condition({})", leaf(hook)),
        Row::Action(hook) => format!("Action({})", leaf(hook)),
        Row::Inference(hook) => format!("Inference({})", leaf(hook)),
        Row::Switch(children, hook) => format!("Switch({children}, {})", leaf(hook)),
        Row::Precondition { condition, otherwise } => {
            let otherwise = match otherwise {
                Status::Running => "Running",
                Status::Success => "Success",
                Status::Failure => "Failure",
                Status::Skipped => "Skipped",
            };
            format!("Precondition {{ condition: {}, otherwise: Status::{otherwise} }}", leaf(condition))
        }
        Row::Timeout(time) => format!("Timeout(Millis::new({}))", time.get()),
        Row::Delay(time) => format!("Delay(Millis::new({}))", time.get()),
        Row::Sleep(time) => format!("Sleep(Millis::new({}))", time.get()),
        Row::RateController(time) => format!("RateController(Millis::new({}))", time.get()),
        Row::RetryUntilSuccessful(times) => format!("RetryUntilSuccessful(Times::new({}))", times.get()),
        Row::Repeat(times) => format!("Repeat(Times::new({}))", times.get()),
        // The others hold numbers and truth values, which Rust prints as it reads them.
        other => format!("{other:?}"),
    }
}
