//! Pictures of a tree: indented text, and a graph for Graphviz.

use super::instance::{Instance, Node};
use super::model::Class;
use crate::text::counted;
use std::fmt::Write;

/// A node of a tree as it is drawn.
pub(crate) struct Line {
    pub(crate) level: usize,
    pub(crate) class: Class,
    pub(crate) infers: bool,
    pub(crate) kind: String,
    pub(crate) label: String,
}

impl Instance {
    /// The tree as indented text, one node a line, and below it how many nodes of which kind there
    /// are.
    #[must_use]
    pub fn outline(&self) -> String {
        let counts = self.counts();
        let mut text = format!(
            "{}: {}, {}\n",
            self.main,
            counted(counts.nodes(), "node"),
            counted(counts.depth(), "level")
        );
        self.branches().iter().for_each(|line| _ = writeln!(text, "{line}"));
        text.push('\n');
        let width = counts.kinds.keys().map(|kind| kind.chars().count()).max().unwrap_or(0);
        for (kind, count) in &counts.kinds {
            _ = writeln!(text, "{kind:<width$}  {count:>5}");
        }
        let classes = counts.classes.iter().map(|(class, count)| format!("{class} {count}"));
        _ = writeln!(text, "\nby class  {}", classes.collect::<Vec<_>>().join(", "));
        let levels = counts.levels.iter().map(ToString::to_string);
        _ = writeln!(text, "by level  {}", levels.collect::<Vec<_>>().join(" "));
        text
    }

    /// The tree as indented lines, one for each node, in their order.
    pub(super) fn branches(&self) -> Vec<String> {
        let mut lines = Vec::with_capacity(self.nodes.len());
        if let Some(root) = self.nodes.first() {
            self.branch(root, "", "", &mut lines);
        }
        lines
    }

    fn branch(&self, node: &Node, before: &str, below: &str, lines: &mut Vec<String>) {
        lines.push(format!("{before}{}", label(node)));
        let last = node.children.len().saturating_sub(1);
        for (place, child) in self.children_of(node).enumerate() {
            let (corner, bar) = if place == last { ("└─ ", "   ") } else { ("├─ ", "│  ") };
            self.branch(child, &format!("{below}{corner}"), &format!("{below}{bar}"), lines);
        }
    }

    /// The nodes in preorder, SubTrees left out: level, class, whether it infers, kind, and name
    /// with ports.
    pub(crate) fn lines(&self) -> impl Iterator<Item = Line> + '_ {
        let mut left_out = Vec::new();
        self.nodes.iter().filter_map(move |node| {
            left_out.retain(|&level| level < node.level);
            if node.model.class == Class::SubTree {
                left_out.push(node.level);
                return None;
            }
            Some(Line {
                level: node.level - left_out.len(),
                class: node.model.class,
                infers: node.is_inference,
                kind: node.id().to_owned(),
                label: label(node),
            })
        })
    }

    /// The tree in Graphviz's language.
    #[must_use]
    pub fn dot(&self) -> String {
        let mut text = format!("digraph {} {{\n", quoted(&self.main));
        text.push_str(
            "  node [fontname=\"sans-serif\", fontsize=11];\n  edge [arrowhead=none];\n  ordering=out;\n",
        );
        for (index, node) in self.nodes.iter().enumerate() {
            let shape = match node.model.class {
                Class::Control => "box",
                Class::Decorator => "hexagon",
                Class::Condition => "ellipse",
                Class::Action => "box, style=rounded",
                Class::SubTree => "folder",
            };
            _ = writeln!(text, "  n{} [label={}, shape={shape}];", index + 1, quoted(&label(node)));
            if let Some(parent) = node.parent {
                _ = writeln!(text, "  n{} -> n{};", parent + 1, index + 1);
            }
        }
        text.push_str("}\n");
        text
    }
}

/// A node in a line: its kind, its name if it has one of its own, its ports and scripts.
fn label(node: &Node) -> String {
    let id = node.subtree.as_deref().map_or_else(|| node.id().to_owned(), |tree| format!("SubTree {tree}"));
    let mut label = id;
    if node.name != node.id() && node.subtree.as_ref() != Some(&node.name) {
        _ = write!(label, " '{}'", node.name);
    }
    for (name, value) in &node.ports {
        let default = node.model.port(name).and_then(|port| port.default.as_ref());
        if default != Some(&value.text) {
            _ = write!(label, " {name}={}", value.text);
        }
    }
    for guard in &node.guards {
        _ = write!(label, " {}={}", guard.attribute, guard.text);
    }
    label.replace(['\n', '\r'], " ")
}

fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}
