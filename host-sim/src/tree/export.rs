//! Export of a document as XML: compact form, with models, as Groot2 expects it.

use super::document::{Definition, Document};
use super::model::{Class, NodeModel, Port};
use super::xml::{Attribute, Element, escaped};
use std::fmt::Write;

impl Document {
    /// The trees of a document, those it includes among them, as one file.
    ///
    /// All nodes are written in the compact form, whichever they were read in; each kind of node
    /// that is not built in has its model, and so have the trees that declare ports. Comments are
    /// not kept.
    #[must_use]
    pub fn export(&self) -> String {
        let mut text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<root BTCPP_format=\"4\"".to_owned();
        if let Ok(main) = self.main_tree(None) {
            push_attribute(&mut text, "main_tree_to_execute", &main);
        }
        text.push_str(">\n");
        for (name, tree) in self.order.iter().filter_map(|name| Some((name, self.trees.get(name)?))) {
            push_tree(&mut text, name, tree);
        }
        self.push_models(&mut text);
        text.push_str("</root>\n");
        text
    }

    fn push_models(&self, text: &mut String) {
        let own: Vec<_> = self.models.values().filter(|model| !model.is_built_in).collect();
        if own.is_empty() && self.subtree_models.is_empty() {
            return;
        }
        text.push_str("  <TreeNodesModel>\n");
        own.into_iter().for_each(|model| push_model(text, model));
        for model in self.subtree_models.values() {
            push_entry(text, Class::SubTree, &model.id, &model.ports);
        }
        text.push_str("  </TreeNodesModel>\n");
    }
}

fn push_tree(text: &mut String, name: &str, tree: &Definition) {
    text.push_str("  <BehaviorTree");
    push_attribute(text, "ID", name);
    push_attributes(text, &tree.attributes);
    text.push_str(">\n");
    if let Some(root) = &tree.root {
        push_node(text, root, 2);
    }
    text.push_str("  </BehaviorTree>\n");
}

fn push_node(text: &mut String, node: &Element, depth: usize) {
    let indent = "  ".repeat(depth);
    let explicit = Class::with_tag(&node.tag).filter(|class| *class != Class::SubTree);
    let tag = explicit.and_then(|_| node.value("ID")).unwrap_or(&node.tag);
    text.push_str(&indent);
    text.push('<');
    text.push_str(tag);
    push_attributes(text, node.attributes.iter().filter(|given| explicit.is_none() || given.name != "ID"));
    if node.children.is_empty() {
        text.push_str("/>\n");
        return;
    }
    text.push_str(">\n");
    node.children.iter().for_each(|child| push_node(text, child, depth + 1));
    _ = writeln!(text, "{indent}</{tag}>");
}

fn push_model(text: &mut String, model: &NodeModel) {
    push_entry(text, model.class, &model.id, &model.ports);
}

pub(super) fn push_entry(text: &mut String, class: Class, id: &str, ports: &[Port]) {
    _ = write!(text, "    <{}", class.tag());
    push_attribute(text, "ID", id);
    if ports.is_empty() {
        text.push_str("/>\n");
        return;
    }
    text.push_str(">\n");
    ports.iter().for_each(|port| push_port(text, port));
    _ = writeln!(text, "    </{}>", class.tag());
}

fn push_port(text: &mut String, port: &Port) {
    let tag = port.direction.tag();
    _ = write!(text, "      <{tag}");
    push_attribute(text, "name", &port.name);
    if !port.kind.name().is_empty() {
        push_attribute(text, "type", port.kind.name());
    }
    if let Some(default) = &port.default {
        push_attribute(text, "default", default);
    }
    if port.description.is_empty() {
        text.push_str("/>\n");
    } else {
        _ = writeln!(text, ">{}</{tag}>", escaped(&port.description));
    }
}

fn push_attributes<'a>(text: &mut String, attributes: impl IntoIterator<Item = &'a Attribute>) {
    for attribute in attributes {
        push_attribute(text, &attribute.name, &attribute.value);
    }
}

pub(super) fn push_attribute(text: &mut String, name: &str, value: &str) {
    _ = write!(text, " {name}=\"{}\"", escaped(value));
}
