//! The ports of a tree's leaves: constants, and names for the entries that the program keeps.

use super::leaves::{Variants, free_name, function, identifier};
use crate::tree::instance::{Instance, Node};
use crate::tree::parameter::Given;
use crate::tree::scope::Entry;
use crate::tree::value::{ValueType, integer, real, truth};
use std::collections::BTreeMap;
use std::fmt::Write;

/// The value of a leaf's port: its type, and a constant or an entry.
struct Use<'i> {
    variant: &'i str,
    kind: ValueType,
    value: PortExpression<'i>,
}

enum PortExpression<'i> {
    Constant(&'i str),
    Entry(usize),
}

/// A function for each port, and an enum of the entries if there are any.
pub(super) fn source(instance: &Instance, variants: &Variants) -> String {
    let mut entries: Vec<(Entry, String)> = Vec::new();
    let mut ports: BTreeMap<String, Vec<Use<'_>>> = BTreeMap::new();
    for variant in variants.list.iter().filter(|variant| variant.has_ports) {
        let Some(node) = instance.nodes.get(variant.node) else { continue };
        for name in node.ports.keys() {
            let Some(value) = value(instance, node, name, &mut entries) else { continue };
            let kind = node.model.port(name).map_or(ValueType::Any, |port| port.kind.clone());
            let used = Use { variant: &variant.name, kind, value };
            ports.entry(function(name)).or_default().push(used);
        }
    }
    let mut source = entries_source(&entries);
    if !ports.is_empty() {
        source.push_str("impl Leaf {\n");
        let functions: Vec<_> = ports.iter().map(|(name, uses)| port_source(name, uses, &entries)).collect();
        source.push_str(&functions.join("\n"));
        source.push_str("}\n\n");
    }
    source
}

fn value<'i>(
    instance: &'i Instance,
    node: &'i Node,
    port: &'i str,
    entries: &mut Vec<(Entry, String)>,
) -> Option<PortExpression<'i>> {
    match instance.given(node, port) {
        Given::Missing => None,
        Given::Text(text, _) => Some(PortExpression::Constant(text)),
        Given::Entry(key, _) => {
            let entry = instance.scopes.resolve(node.scope, key);
            let at = entries.iter().position(|(known, _)| *known == entry).unwrap_or_else(|| {
                let name = free_name(&identifier(&entry.1), entries.iter().map(|(_, name)| name));
                entries.push((entry, name));
                entries.len() - 1
            });
            Some(PortExpression::Entry(at))
        }
    }
}

fn entries_source(entries: &[(Entry, String)]) -> String {
    if entries.is_empty() {
        return String::new();
    }
    let mut source = "/// The values that leaves share; the program keeps them.\n".to_owned();
    source.push_str("#[derive(Clone, Copy, Debug, PartialEq, Eq)]\npub enum Entry {\n");
    for (entry, name) in entries {
        _ = writeln!(source, "    /// `{}`\n    {name},", entry.1.replace('`', "'"));
    }
    source.push_str("}\n\n");
    source.push_str("/// The source of a port's value.\n#[derive(Clone, Copy, Debug, PartialEq)]\n");
    source.push_str(
        "pub enum Port<T> {\n    /// A constant.\n    Constant(T),\n    /// An entry of the blackboard.\n    Entry(Entry),\n}\n\n",
    );
    source
}

/// A function that tells the port's value for each leaf that has it.
fn port_source(name: &str, uses: &[Use<'_>], entries: &[(Entry, String)]) -> String {
    let kind = uses.first().map_or(ValueType::Any, |first| first.kind.clone());
    let kind = if uses.iter().all(|used| used.kind == kind) { kind } else { ValueType::Any };
    let rust = rust_type(&kind);
    let has_constants = uses.iter().any(|used| matches!(used.value, PortExpression::Constant(_)));
    let has_entries = uses.iter().any(|used| matches!(used.value, PortExpression::Entry(_)));
    let returned = match (has_constants, has_entries) {
        (true, true) => format!("Port<{rust}>"),
        (true, false) => rust.to_owned(),
        _ => "Entry".to_owned(),
    };
    let mut source = format!("    /// The port `{name}` of the leaves that have one.\n    #[must_use]\n");
    _ = writeln!(source, "    pub const fn {name}(self) -> Option<{returned}> {{\n        match self {{");
    for used in uses {
        let value = match (&used.value, has_constants, has_entries) {
            (PortExpression::Constant(text), _, false) => literal(&kind, text),
            (PortExpression::Constant(text), ..) => format!("Port::Constant({})", literal(&kind, text)),
            (PortExpression::Entry(at), true, _) => format!("Port::Entry({})", entry(*at, entries)),
            (PortExpression::Entry(at), ..) => entry(*at, entries),
        };
        _ = writeln!(source, "            Self::{} => Some({value}),", used.variant);
    }
    source.push_str("            #[allow(unreachable_patterns)]\n            _ => None,\n        }\n    }\n");
    source
}

fn entry(at: usize, entries: &[(Entry, String)]) -> String {
    entries.get(at).map_or_else(String::new, |(_, name)| format!("Entry::{name}"))
}

fn rust_type(kind: &ValueType) -> &'static str {
    match kind {
        ValueType::Int => "i32",
        ValueType::Unsigned => "u32",
        ValueType::Double => "f32",
        ValueType::Bool => "bool",
        _ => "&'static str",
    }
}

/// A literal of the type that `rust_type` names.
fn literal(kind: &ValueType, text: &str) -> String {
    let parsed = match kind {
        ValueType::Int | ValueType::Unsigned => integer(text).map(|(value, _)| value.to_string()),
        ValueType::Double => real(text).map(|(value, _)| number(value as f32)),
        ValueType::Bool => truth(text).map(|value| value.to_string()),
        _ => None,
    };
    parsed.unwrap_or_else(|| format!("{text:?}"))
}

fn number(value: f32) -> String {
    if value.is_nan() {
        "f32::NAN".into()
    } else if value.is_infinite() {
        if value > 0.0 { "f32::INFINITY".into() } else { "f32::NEG_INFINITY".into() }
    } else {
        format!("{value:?}")
    }
}
