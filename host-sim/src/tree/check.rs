//! Checks of a tree file: everything that BehaviorTree.CPP rejects when it loads the file, and what
//! it finds only when the tree runs.

use super::diagnostic::{Diagnostic, Remarks, Severity};
use super::document::Document;
use super::instance::{Instance, Node};
use super::model::Direction;
use super::parameter::Given;
use super::value::{Fit, pointer};
use std::collections::BTreeSet;

/// The remarks on a document whose main tree is `wanted`, else the one that the file names, in the
/// order of their places.
///
/// Trees that the main tree does not use are looked at as well; what BehaviorTree.CPP would not
/// notice because it never puts them together is a warning there.
#[must_use]
pub fn check(document: &Document, wanted: Option<&str>) -> Vec<Diagnostic> {
    let mut remarks = document.remarks.clone();
    let mut used = BTreeSet::new();
    match document.main_tree(wanted) {
        Ok(main) => {
            let instance = document.instantiate(&main, &mut remarks);
            examine(&instance, &mut remarks);
            if !remarks.has_errors() {
                remarks.extend(super::lower::remarks(&instance));
            }
            used.extend(instance.trees.into_iter().map(|tree| tree.id));
        }
        Err(error) if document.trees.is_empty() => _ = error,
        Err(error) => remarks.extend([error]),
    }
    for name in document
        .order
        .iter()
        .filter(|name| wanted.is_none() && !used.contains(*name))
        .cloned()
        .collect::<Vec<_>>()
    {
        if used.contains(&name) {
            continue;
        }
        let mut aside = Remarks::default();
        let instance = document.instantiate(&name, &mut aside);
        examine(&instance, &mut aside);
        used.extend(instance.trees.into_iter().map(|tree| tree.id));
        remarks.extend(aside.into_iter().map(|remark| Diagnostic { severity: Severity::Warning, ..remark }));
    }
    remarks.into_sorted()
}

impl Instance {
    /// The tree called `main` of a document, if nothing is wrong with it.
    ///
    /// # Errors
    /// What is wrong.
    pub fn of(document: &Document, main: &str) -> Result<Self, Vec<Diagnostic>> {
        let mut remarks = document.remarks.clone();
        let instance = document.instantiate(main, &mut remarks);
        examine(&instance, &mut remarks);
        if remarks.has_errors() { Err(remarks.into_sorted()) } else { Ok(instance) }
    }
}

/// Remarks on the parameters of a tree's nodes.
fn examine(instance: &Instance, remarks: &mut Remarks) {
    for node in &instance.nodes {
        if let Err(error) = parameters(instance, node, remarks) {
            remarks.extend([error]);
        }
    }
}

fn parameters(instance: &Instance, node: &Node, remarks: &mut Remarks) -> Result<(), Diagnostic> {
    match node.id() {
        "RetryUntilSuccessful" => count(instance, node, "num_attempts", remarks),
        "Repeat" => count(instance, node, "num_cycles", remarks),
        "RecoveryNode" => known(instance.int(node, "number_of_retries"), instance, node, "number_of_retries"),
        "Timeout" | "Sleep" => known(instance.millis(node, "msec"), instance, node, "msec"),
        "Delay" => known(instance.millis(node, "delay_msec"), instance, node, "delay_msec"),
        "RateController" => rate(instance, node),
        "RunOnce" => known(instance.truth(node, "then_skip"), instance, node, "then_skip"),
        "Parallel" => {
            threshold(instance, node, "success_count", "succeed", remarks)?;
            threshold(instance, node, "failure_count", "fail", remarks)
        }
        "ParallelAll" => threshold(instance, node, "max_failures", "fail", remarks),
        "Script" | "ScriptCondition" => instance.script(node, "code").map(|_| ()),
        "Precondition" => {
            instance.script(node, "if")?;
            match instance.given(node, "else") {
                Given::Text("IDLE", place) => Err(Diagnostic::error(
                    place,
                    "no node may return IDLE: SUCCESS, FAILURE, RUNNING or SKIPPED",
                )),
                _ => Ok(()),
            }
        }
        "SetBlackboard" | "UnsetBlackboard" | "SkipUnlessUpdated" | "WaitValueUpdate" | "WasEntryUpdated" => {
            let missing = node.model.ports.iter().find(|port| !node.ports.contains_key(&port.name));
            missing.map_or(Ok(()), |port| instance.text(node, &port.name).map(|_| ()))
        }
        id if id.starts_with("Switch") && node.model.is_built_in => {
            switch(node, remarks);
            Ok(())
        }
        super::model::SCRIPTED => statuses(instance, node),
        id if id.starts_with("Loop") && node.model.is_built_in => queue(instance, node),
        _ => {
            inputs(node, remarks);
            Ok(())
        }
    }
}

/// A value that is given must be right; one from the blackboard is left to the run, and a literal
/// of another type was found when the port was read.
fn known<T>(
    value: Result<T, Diagnostic>,
    instance: &Instance,
    node: &Node,
    port: &str,
) -> Result<(), Diagnostic> {
    let literal = node.ports.get(port).filter(|value| pointer(&value.text).is_none());
    let kind = node.model.port(port).map(|port| &port.kind);
    let was_found = literal.zip(kind).is_some_and(|(value, kind)| kind.fit(&value.text) == Fit::None);
    match instance.given(node, port) {
        Given::Entry(..) => Ok(()),
        _ if was_found => Ok(()),
        _ => value.map(|_| ()),
    }
}

fn count(instance: &Instance, node: &Node, port: &str, remarks: &mut Remarks) -> Result<(), Diagnostic> {
    let value = instance.int(node, port);
    if let (Ok(value), Given::Text(_, place)) = (&value, instance.given(node, port))
        && *value < -1
    {
        remarks.warning(place, format!("{port} {value} means 0; -1 means for ever"));
    }
    known(value, instance, node, port)
}

fn threshold(
    instance: &Instance,
    node: &Node,
    port: &str,
    verb: &str,
    remarks: &mut Remarks,
) -> Result<(), Diagnostic> {
    let value = instance.int(node, port);
    let Given::Text(_, place) = instance.given(node, port) else { return known(value, instance, node, port) };
    let Ok(value) = value else { return known(value, instance, node, port) };
    let (value, children) = (i64::from(value), node.children.len() as i64);
    if value > children {
        let message = format!("{port} is {value}, but with {children} children the node could never {verb}");
        return Err(Diagnostic::error(place, message));
    }
    if value == 0 || value < -children {
        remarks
            .warning(place, format!("with {port} {value} the node does not wait for its children to {verb}"));
    }
    Ok(())
}

fn rate(instance: &Instance, node: &Node) -> Result<(), Diagnostic> {
    let hz = instance.real(node, "hz");
    if let (Ok(value), Given::Text(text, place)) = (&hz, instance.given(node, "hz"))
        && !(*value > 0.0 && *value <= 1000.0)
    {
        return Err(Diagnostic::error(place, format!("'{text}' is no rate from 0 to 1000 hz")));
    }
    known(hz, instance, node, "hz")
}

fn switch(node: &Node, remarks: &mut Remarks) {
    let missing =
        node.model.ports.iter().map(|port| &port.name).filter(|name| !node.ports.contains_key(*name));
    for name in missing {
        let consequence =
            if name == "variable" { "the default is always taken" } else { "that case is never taken" };
        remarks.warning(&node.place, format!("without a value for '{name}' {consequence}"));
    }
}

/// A queue that is written out has values of the loop's type, with semicolons between them.
fn queue(instance: &Instance, node: &Node) -> Result<(), Diagnostic> {
    let kind = node.model.port("value").map(|port| &port.kind);
    match instance.given(node, "queue") {
        Given::Text(text, place) => {
            let wrong = text.split(';').find(|part| kind.is_some_and(|kind| kind.fit(part) == Fit::None));
            wrong.map_or(Ok(()), |part| {
                let kind = kind.map_or("", |kind| kind.name());
                Err(Diagnostic::error(place, format!("'{part}' in the queue is no {kind}")))
            })
        }
        Given::Entry(..) => Ok(()),
        Given::Missing => instance.text(node, "queue").map(|_| ()),
    }
}

fn statuses(instance: &Instance, node: &Node) -> Result<(), Diagnostic> {
    match instance.given(node, "s") {
        Given::Text(text, place) if text.is_empty() || text.contains(|letter| !"SFRK".contains(letter)) => {
            Err(Diagnostic::error(place, format!("'{text}' is no script of statuses: letters S, F, R and K")))
        }
        _ => Ok(()),
    }
}

/// Inputs of the program's own nodes that are given no value: they fail when the node reads them.
fn inputs(node: &Node, remarks: &mut Remarks) {
    if node.model.is_built_in {
        return;
    }
    for port in &node.model.ports {
        if port.direction == Direction::Input && !node.ports.contains_key(&port.name) {
            remarks.warning(
                &node.place,
                format!("{} is given no value for its port '{}'", node.id(), port.name),
            );
        }
    }
}
