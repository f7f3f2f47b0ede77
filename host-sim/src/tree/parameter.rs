//! Parameters of built-in nodes, as far as they are known before the tree runs.

use super::diagnostic::{Diagnostic, Place};
use super::instance::{Instance, Node};
use super::script::Script;
use super::value::{integer, pointer, real, truth};

/// A port's value before the tree runs.
#[derive(Clone, Copy, Debug)]
pub(super) enum Given<'i> {
    /// No value.
    Missing,
    /// A constant.
    Text(&'i str, &'i Place),
    /// An entry of the blackboard, known only when the tree runs.
    Entry(&'i str, &'i Place),
}

impl Instance {
    pub(super) fn given<'i>(&'i self, node: &'i Node, port: &'i str) -> Given<'i> {
        let Some(value) = node.ports.get(port) else { return Given::Missing };
        let key = match value.text.as_str() {
            "{=}" | "=" => port,
            text => match pointer(text) {
                Some(key) => key,
                None => return Given::Text(text, &value.place),
            },
        };
        match self.scopes.constant(node.scope, key) {
            Some(text) => Given::Text(text, &value.place),
            None => Given::Entry(key, &value.place),
        }
    }

    /// The text of a port that must be known before the tree runs.
    pub(super) fn text<'i>(
        &'i self,
        node: &'i Node,
        port: &'i str,
    ) -> Result<(&'i str, &'i Place), Diagnostic> {
        match self.given(node, port) {
            Given::Text(text, place) => Ok((text, place)),
            Given::Missing => Err(Diagnostic::error(
                &node.place,
                format!("{} needs a value for its port '{port}'", node.id()),
            )),
            Given::Entry(key, place) => {
                let reason = "is known only when the tree runs, and a table in flash needs a constant";
                Err(Diagnostic::error(place, format!("the entry '{key}' for port '{port}' {reason}")))
            }
        }
    }

    fn parsed<'i, T>(
        &'i self,
        node: &'i Node,
        port: &'i str,
        kind: &str,
        parse: impl Fn(&str) -> Option<T>,
    ) -> Result<T, Diagnostic> {
        let (text, place) = self.text(node, port)?;
        parse(text)
            .ok_or_else(|| Diagnostic::error(place, format!("'{text}' for port '{port}' is no {kind}")))
    }

    pub(super) fn int(&self, node: &Node, port: &str) -> Result<i32, Diagnostic> {
        let parse = |text: &str| integer(text).and_then(|(value, _)| i32::try_from(value).ok());
        self.parsed(node, port, "whole number", parse)
    }

    pub(super) fn millis(&self, node: &Node, port: &str) -> Result<u32, Diagnostic> {
        let parse = |text: &str| integer(text).and_then(|(value, _)| u32::try_from(value).ok());
        self.parsed(node, port, "number of milliseconds", parse)
    }

    pub(super) fn real(&self, node: &Node, port: &str) -> Result<f64, Diagnostic> {
        self.parsed(node, port, "number", |text| real(text).map(|(value, _)| value))
    }

    pub(super) fn truth(&self, node: &Node, port: &str) -> Result<bool, Diagnostic> {
        self.parsed(node, port, "truth value", truth)
    }

    pub(super) fn script(&self, node: &Node, port: &str) -> Result<Script, Diagnostic> {
        let (text, place) = self.text(node, port)?;
        Script::read(text)
            .map_err(|reason| Diagnostic::error(place, format!("in the script of '{port}': {reason}")))
    }
}
