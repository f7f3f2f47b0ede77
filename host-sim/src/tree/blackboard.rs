//! The entries that scripts read and write while a tree runs.

use super::instance::{Instance, Node};
use super::parameter::Given;
use super::scope::{Entry, Scopes, constant_type};
use super::script::{Scalar, Variables};
use super::value::{ValueType, integer, pointer, real};
use std::collections::BTreeMap;

/// The values of a tree's entries; those given to SubTrees exist from the start.
pub(super) struct Blackboard<'i> {
    scopes: &'i Scopes,
    values: BTreeMap<Entry, Scalar>,
}

/// The blackboard as the nodes of one tree see it.
pub(super) struct View<'b, 'i> {
    board: &'b mut Blackboard<'i>,
    scope: usize,
}

impl<'i> Blackboard<'i> {
    pub(super) fn new(instance: &'i Instance) -> Self {
        let values = instance.scopes.constants().map(|(entry, text)| (entry, constant(text))).collect();
        Self { scopes: &instance.scopes, values }
    }

    pub(super) fn view(&mut self, node: &Node) -> View<'_, 'i> {
        View { board: self, scope: node.scope }
    }

    /// The text of a port: a literal, or the value of the entry that it names.
    pub(super) fn text(&mut self, instance: &Instance, node: &Node, port: &str) -> Option<String> {
        match instance.given(node, port) {
            Given::Text(text, _) => Some(text.to_owned()),
            Given::Entry(key, _) => self.view(node).value(key).map(|value| value.text()),
            Given::Missing => None,
        }
    }

    /// Copies a value as `SetBlackboard` does.
    ///
    /// # Errors
    /// What is missing, or does not go together.
    pub(super) fn copy(&mut self, instance: &Instance, node: &Node) -> Result<(), String> {
        let key = self.text(instance, node, "output_key").ok_or("its port 'output_key' has no value")?;
        let source = node.ports.get("value").ok_or("its port 'value' has no value")?;
        let mut view = self.view(node);
        let value = match pointer(&source.text) {
            Some(from) => view.value(from).ok_or_else(|| format!("there is no entry '{from}'"))?,
            None => Scalar::Text(source.text.clone()),
        };
        let is_number = view.value(&key).is_some_and(|old| old.number().is_some());
        let value = match &value {
            Scalar::Text(text) if is_number => {
                Scalar::Real(real(text).ok_or_else(|| format!("'{text}' is no number"))?.0)
            }
            _ => value,
        };
        view.set(&key, value);
        Ok(())
    }

    pub(super) fn remove(&mut self, instance: &Instance, node: &Node) -> Result<(), String> {
        let key = self.text(instance, node, "key").ok_or("its port 'key' has no value")?;
        let entry = self.scopes.resolve(node.scope, &key);
        self.values.remove(&entry);
        Ok(())
    }

    /// The case of a switch that is taken; the number of cases for the default.
    pub(super) fn case(&mut self, instance: &Instance, node: &Node) -> usize {
        let cases = node.children.len().saturating_sub(1);
        let Some(variable) = self.text(instance, node, "variable") else { return cases };
        let is_case = |case: &usize| {
            let value = self.text(instance, node, &format!("case_{}", case + 1));
            value.is_some_and(|value| is_same(&variable, &value))
        };
        (0..cases).find(is_case).unwrap_or(cases)
    }
}

impl Variables for View<'_, '_> {
    fn value(&self, name: &str) -> Option<Scalar> {
        let entry = self.board.scopes.resolve(self.scope, name);
        self.board.values.get(&entry).cloned()
    }

    fn set(&mut self, name: &str, value: Scalar) {
        let entry = self.board.scopes.resolve(self.scope, name);
        self.board.values.insert(entry, value);
    }
}

/// Equal as text, as whole numbers or as real ones.
fn is_same(left: &str, right: &str) -> bool {
    let number = |text: &str| real(text).filter(|(_, length)| *length == text.len()).map(|(value, _)| value);
    let is_close = |a: f64, b: f64| (a - b).abs() <= f64::from(f32::EPSILON);
    left == right || number(left).zip(number(right)).is_some_and(|(left, right)| is_close(left, right))
}

fn constant(text: &str) -> Scalar {
    let number = match constant_type(text) {
        ValueType::Text => None,
        ValueType::Double => real(text).map(|(value, _)| Scalar::Real(value)),
        _ => integer(text).map(|(value, _)| Scalar::Integer(value)),
    };
    number.unwrap_or_else(|| Scalar::Text(text.to_owned()))
}
