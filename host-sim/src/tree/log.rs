//! Logs of a tree for Groot2: files that end in `.btlog`.

use super::export::{push_attribute, push_entry};
use super::instance::{Instance, Node};
use super::model::{Class, NodeModel};
use super::recorded::MAGIC;
use iibt_core::time::Instant;
use iibt_core::tree::{Status, StatusChange};
use std::collections::BTreeMap;

/// The version of the format.
const PROTOCOL: u8 = 1;

impl Instance {
    /// A log of this tree for Groot2, from transitions whose times count milliseconds and whose
    /// nodes are named by their places in the tree, from zero: what a dry run records, or the
    /// records of a robot that ticks the table of [`codegen`](Self::codegen) where no conditions
    /// stand before nodes.
    ///
    /// The engine does not mention that a finished node is idle again; here it is, at the next time
    /// at which anything happens.
    #[must_use]
    pub fn btlog(&self, transitions: &[StatusChange]) -> Vec<u8> {
        let start = transitions.first().map_or(Instant(0), |first| first.time);
        let xml = self.log_xml();
        let mut log = MAGIC.to_vec();
        log.push(PROTOCOL);
        log.extend(i32::try_from(xml.len()).unwrap_or(i32::MAX).to_le_bytes());
        log.extend(xml.as_bytes());
        log.extend((i64::from(start.0) * 1000).to_le_bytes());
        let mut finished: Vec<u16> = Vec::new();
        let mut last = start;
        for transition in transitions {
            if transition.time != last {
                let idle = |node| StatusChange { time: transition.time, node, from: None, to: None };
                finished.drain(..).for_each(|node| log.extend(idle(node).btlog(start)));
                last = transition.time;
            }
            finished.retain(|node| *node != transition.node);
            if matches!(transition.to, Some(Status::Success | Status::Failure | Status::Skipped)) {
                finished.push(transition.node);
            }
            log.extend(transition.btlog(start));
        }
        log
    }

    /// The tree with its SubTrees expanded, with unique identifiers and the models of all its
    /// nodes.
    fn log_xml(&self) -> String {
        let mut xml = "<root BTCPP_format=\"4\">\n".to_owned();
        for tree in &self.trees {
            let Some(root) = self.nodes.get(tree.root) else { continue };
            xml.push_str("  <BehaviorTree");
            push_attribute(&mut xml, "ID", &tree.id);
            push_attribute(&mut xml, "_fullpath", &tree.path);
            xml.push_str(">\n");
            self.push_logged(&mut xml, root, tree.root, 2);
            xml.push_str("  </BehaviorTree>\n");
        }
        xml.push_str("  <TreeNodesModel>\n");
        let models: BTreeMap<&str, &NodeModel> =
            self.nodes.iter().map(|node| (node.id(), &*node.model)).collect();
        models.values().for_each(|model| push_entry(&mut xml, model.class, &model.id, &model.ports));
        xml.push_str("  </TreeNodesModel>\n</root>\n");
        xml
    }

    fn push_logged(&self, xml: &mut String, node: &Node, index: usize, depth: usize) {
        let indent = "  ".repeat(depth);
        xml.push_str(&format!("{indent}<{}", node.id()));
        match &node.subtree {
            Some(tree) => {
                push_attribute(xml, "ID", tree);
                let below = node.children.first();
                let placed = self.trees.iter().find(|placed| Some(&placed.root) == below);
                push_attribute(xml, "_fullpath", placed.map_or("", |placed| &placed.path));
            }
            None => push_attribute(xml, "name", &node.name),
        }
        push_attribute(xml, "_uid", &(index + 1).to_string());
        node.ports.iter().for_each(|(name, value)| push_attribute(xml, name, &value.text));
        node.guards.iter().for_each(|guard| push_attribute(xml, guard.attribute, &guard.text));
        let is_inner = node.model.class != Class::SubTree && !node.children.is_empty();
        xml.push_str(if is_inner { ">\n" } else { "/>\n" });
        if is_inner {
            for &child in &node.children {
                if let Some(node) = self.nodes.get(child) {
                    self.push_logged(xml, node, child, depth + 1);
                }
            }
            xml.push_str(&format!("{indent}</{}>\n", node.id()));
        }
    }
}
