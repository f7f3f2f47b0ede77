//! The enum of a tree's leaves.

use crate::tree::instance::{Instance, Node};
use crate::tree::lower::{Hook, HookTask, Lowered};
use std::collections::BTreeMap;
use std::fmt::Write;

/// One variant for each thing that the program does for the tree; leaves that are alike share one.
pub(super) struct Variants {
    /// The variants in the order of the tree.
    pub list: Vec<Variant>,
    /// For each hook of the table, its variant.
    of_hook: Vec<usize>,
}

pub(super) struct Variant {
    pub name: String,
    pub documentation: String,
    /// The node of the tree that it was made for first.
    pub node: usize,
    /// Whether it is a leaf of the program's own, which has ports.
    pub has_ports: bool,
}

impl Variants {
    pub(super) fn of(instance: &Instance, lowered: &Lowered) -> Self {
        let mut variants = Self { list: Vec::new(), of_hook: Vec::new() };
        let mut known: BTreeMap<(String, usize), usize> = BTreeMap::new();
        for hook in &lowered.hooks {
            let Some(node) = instance.nodes.get(hook.node) else { continue };
            let documentation = documentation(node, hook);
            let shares_entries = !matches!(hook.task, HookTask::Leaf) || documentation.contains('{');
            let scope = if shares_entries { node.scope } else { 0 };
            let at = *known.entry((documentation.clone(), scope)).or_insert(variants.list.len());
            if at == variants.list.len() {
                let names = variants.list.iter().map(|variant| &variant.name);
                let name = free_name(&identifier(&wish(node, hook)), names);
                let has_ports = matches!(hook.task, HookTask::Leaf);
                variants.list.push(Variant { name, documentation, node: hook.node, has_ports });
            }
            variants.of_hook.push(at);
        }
        variants
    }

    pub(super) fn name(&self, hook: u16) -> &str {
        let variant = self.of_hook.get(usize::from(hook)).and_then(|&at| self.list.get(at));
        variant.map_or("", |variant| &variant.name)
    }

    /// The enum's source.
    pub(super) fn source(&self) -> String {
        let mut source = "/// The leaves of the tree, which the program provides.\n".to_owned();
        source.push_str("#[derive(Clone, Copy, Debug, PartialEq, Eq)]\npub enum Leaf {\n");
        for variant in &self.list {
            _ = writeln!(source, "    /// {}\n    {},", variant.documentation, variant.name);
        }
        source.push_str("}\n\n");
        source
    }
}

/// The documentation of a variant; leaves with the same documentation share one.
fn documentation(node: &Node, hook: &Hook) -> String {
    let port = |name: &str| code(node.ports.get(name).map_or("", |value| value.text.as_str()));
    match &hook.task {
        HookTask::Leaf => {
            let ports = node.ports.iter().map(|(name, value)| format!("{name} = {}", code(&value.text)));
            let ports = ports.collect::<Vec<_>>().join(", ");
            let of = if node.name == node.id() { String::new() } else { format!(" {}", code(&node.name)) };
            let class = if node.is_inference { "Inference node" } else { node.model.class.tag() };
            let ports = if ports.is_empty() { ports } else { format!(": {ports}") };
            format!("{class} {}{of}{ports}.", code(node.id()))
        }
        HookTask::Script(_) => format!("Action: runs the script {} and succeeds.", port("code")),
        HookTask::Condition(_) => format!("Condition: whether {}.", port("code")),
        HookTask::Set => {
            format!("Action: gives {} the value {} and succeeds.", port("output_key"), port("value"))
        }
        HookTask::Unset => format!("Action: removes the entry {} and succeeds.", port("key")),
        HookTask::Switch => {
            let cases = node.ports.iter().filter(|(name, _)| name.starts_with("case_"));
            let cases = cases.map(|(_, value)| code(&value.text)).collect::<Vec<_>>().join(", ");
            format!("Switch: which of {cases} {} is, counted from 0.", port("variable"))
        }
        HookTask::Precondition(_) => format!("Condition: whether {}.", port("if")),
        HookTask::Guard { passes_if, .. } => {
            let guards = node.guards.iter().filter(|guard| (guard.attribute == "_while") == *passes_if);
            let texts = guards.map(|guard| code(&guard.text)).collect::<Vec<_>>().join(", ");
            let word = if *passes_if { "whether" } else { "whether not" };
            format!("Condition before {}: {word} {texts}.", code(&node.name))
        }
        HookTask::Skip => "Action: is skipped.".into(),
    }
}

fn code(text: &str) -> String {
    format!("`{}`", text.replace('`', "'").replace(['\n', '\r'], " "))
}

/// The preferred name of a variant.
fn wish(node: &Node, hook: &Hook) -> String {
    match hook.task {
        HookTask::Guard { .. } => format!("Before {}", node.name),
        _ => node.name.clone(),
    }
}

/// The name wished for, with the first number from 2 that makes it differ from all known ones.
pub(super) fn free_name<'n>(wish: &str, known: impl Iterator<Item = &'n String> + Clone) -> String {
    let is_free = |name: &String| known.clone().all(|known| known != name);
    let numbered = (2_u32..).map(|number| format!("{wish}{number}"));
    std::iter::once(wish.to_owned()).chain(numbered).find(is_free).unwrap_or_default()
}

/// A name of a Rust type or variant.
pub(super) fn identifier(text: &str) -> String {
    let mut name = String::new();
    for word in text.split(|sign: char| !sign.is_ascii_alphanumeric()).filter(|word| !word.is_empty()) {
        let (first, rest) = word.split_at(1);
        name.push_str(&first.to_ascii_uppercase());
        name.push_str(rest);
    }
    if name.is_empty() || name.starts_with(|sign: char| sign.is_ascii_digit()) || name == "Self" {
        name.insert_str(0, "Leaf");
    }
    name
}

/// A name of a Rust function.
pub(super) fn function(text: &str) -> String {
    let mut name = String::new();
    for sign in text.chars() {
        if sign.is_ascii_uppercase() && !name.is_empty() && !name.ends_with('_') {
            name.push('_');
        }
        name.push(if sign.is_ascii_alphanumeric() { sign.to_ascii_lowercase() } else { '_' });
    }
    const KEYWORDS: &str = " as async await break const continue crate dyn else enum extern false fn for gen if impl in let \
        loop match mod move mut pub ref return self static struct super trait true try type unsafe use where while \
        abstract become box do final macro override priv typeof unsized virtual yield ";
    if KEYWORDS.contains(&format!(" {name} ")) { format!("{name}_") } else { name }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_become_identifiers() {
        for (text, name) in
            [("move to", "MoveTo"), ("IsArrived?", "IsArrived"), ("1st", "Leaf1st"), ("é", "Leaf")]
        {
            assert_eq!(identifier(text), name);
        }
        for (text, name) in [("goal", "goal"), ("maxSpeed", "max_speed"), ("type", "type_"), ("a-b", "a_b")] {
            assert_eq!(function(text), name);
        }
    }
}
