//! A tree, from the root down, a node a line.

use super::svg::{Anchor, Svg, width_of};
use crate::reproduce::figure::{TreeNode, TreeNodeKind, TreePicture};
use maud::Markup;

const LINE: f64 = 24.0;
const INDENT: f64 = 22.0;

pub(super) fn draw(tree: &TreePicture) -> Markup {
    let right = |node: &TreeNode| INDENT * node.level as f64 + width_of(&node.name) + 40.0;
    let width = tree.nodes.iter().map(right).fold(160.0, f64::max);
    let mut svg = Svg::new(width, LINE * tree.nodes.len() as f64 + 6.0);
    for (row, node) in tree.nodes.iter().enumerate() {
        if let Some(parent) = tree.nodes[..row].iter().rposition(|above| above.level + 1 == node.level) {
            let x = left(&tree.nodes[parent]) + 9.0;
            svg.line("branch", (x, middle(parent) + 9.0), (x, middle(row)));
            svg.line("branch", (x, middle(row)), (left(node), middle(row)));
        }
    }
    for (row, node) in tree.nodes.iter().enumerate() {
        mark(node, (left(node), middle(row)), &mut svg);
    }
    svg.finish(&tree.title)
}

fn left(node: &TreeNode) -> f64 {
    INDENT * (node.level.max(1) - 1) as f64 + 2.0
}

fn middle(row: usize) -> f64 {
    LINE * row as f64 + LINE / 2.0 + 3.0
}

/// A node in the field's signs: an arrow, a question mark, an oval, a box.
fn mark(node: &TreeNode, (x, y): (f64, f64), svg: &mut Svg) {
    let wide = width_of(&node.name) + 16.0;
    let sign = match node.kind {
        TreeNodeKind::Sequence => "→",
        TreeNodeKind::Fallback => "?",
        TreeNodeKind::Control => "◇",
        TreeNodeKind::Condition | TreeNodeKind::Action | TreeNodeKind::Inference => "",
    };
    if sign.is_empty() {
        let (class, round) = match node.kind {
            TreeNodeKind::Condition => ("node condition", 9.0),
            TreeNodeKind::Inference => ("node inference", 2.0),
            _ => ("node action", 2.0),
        };
        svg.rectangle(class, (x, y - 9.0), (wide, 18.0), round);
        svg.text("label", (x + 8.0, y + 4.0), Anchor::Start, &node.name);
    } else {
        svg.rectangle("node control", (x, y - 9.0), (18.0, 18.0), 2.0);
        svg.text("label", (x + 9.0, y + 4.0), Anchor::Middle, sign);
        svg.text("name", (x + 24.0, y + 4.0), Anchor::Start, &node.name);
    }
}
