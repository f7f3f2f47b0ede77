//! Tables 3, 6 and 7 and figure 5: how large the trees are, counted from the trees themselves.

use super::Run;
use super::figure::{Figure, Panel, TreeNode, TreeNodeKind, TreePicture};
use super::report::{Item, Section};
use crate::tree::{Class, Instance, Line, library};

/// A tree of the paper and the numbers that the paper prints for it.
struct Counted {
    /// What it is in the paper.
    what: &'static str,
    /// Our tree.
    tree: &'static str,
    /// The paper's sequences, fallbacks, conditions, actions, nodes and levels.
    paper: [usize; 6],
    /// Where our count is not the paper's: why.
    reasons: &'static [(usize, &'static str)],
}

const COLUMNS: [&str; 6] = ["sequences", "fallbacks", "conditions", "actions", "nodes", "levels"];
const NODES: usize = 4;
const LEVELS: usize = 5;

const LEVEL_CONVENTION: &str =
    "a fallback within a sequence has leaves on the third level; the paper counts like this in table 6";

/// The trees of table 3, then of tables 6 and 7.
const TREES: [Counted; 2] = [
    Counted {
        what: "table 3, conventional",
        tree: "figure-8-classical",
        paper: [5, 4, 7, 5, 21, 8],
        reasons: &[],
    },
    Counted {
        what: "table 3, inference",
        tree: "figure-8-inference",
        paper: [1, 1, 1, 2, 5, 2],
        reasons: &[(LEVELS, LEVEL_CONVENTION)],
    },
];

/// Pairs that are drawn side by side.
const PAIRS: [(&str, &str, &str); 2] = [
    ("Figure 5", "figure-5-classical", "figure-5-inference"),
    ("Figure 8 and table 3", "figure-8-classical", "figure-8-inference"),
];

/// What the tables come to.
pub(super) fn count(_: &Run<'_>) -> Section {
    let mut section = Section::new("tables", "Tables 3, 6 and 7: how large the trees are");
    section.say("Counted from the trees that fly the missions, by code; a level more for every parent, the root being the first.");
    section.items = TREES.iter().flat_map(Counted::items).collect();
    section.figures = PAIRS.iter().map(pair).collect();
    section
}

impl Counted {
    fn items(&self) -> Vec<Item> {
        let ours = counts(&picture(self.tree));
        let item = |column: usize| {
            let what = format!("{}: {}", self.what, COLUMNS[column]);
            let reason = self.reasons.iter().find(|(at, _)| *at == column);
            match reason {
                Some((_, reason)) => Item::differs(what, self.paper[column], ours[column], *reason),
                None => Item::same(what, self.paper[column], ours[column]),
            }
        };
        (0..COLUMNS.len()).map(item).collect()
    }
}

/// The columns of the tables, counted.
fn counts(tree: &[TreeNode]) -> [usize; 6] {
    let of = |kinds: &[TreeNodeKind]| tree.iter().filter(|node| kinds.contains(&node.kind)).count();
    [
        of(&[TreeNodeKind::Sequence]),
        of(&[TreeNodeKind::Fallback]),
        of(&[TreeNodeKind::Condition]),
        of(&[TreeNodeKind::Action, TreeNodeKind::Inference]),
        tree.len(),
        tree.iter().map(|node| node.level).max().unwrap_or(0),
    ]
}

/// A built-in tree, its SubTrees put in.
fn picture(name: &str) -> Vec<TreeNode> {
    let document = library::find(name).expect("it is built in").expect("it parses");
    let main = document.main_tree(None).expect("it names its main tree");
    let instance = Instance::of(&document, &main).expect("it is sound");
    instance.lines().map(|line| TreeNode { level: line.level, kind: kind(&line), name: line.label }).collect()
}

fn kind(line: &Line) -> TreeNodeKind {
    match line.class {
        Class::Condition => TreeNodeKind::Condition,
        Class::Action if line.infers => TreeNodeKind::Inference,
        Class::Action => TreeNodeKind::Action,
        _ if line.kind.ends_with("Sequence") => TreeNodeKind::Sequence,
        _ if line.kind.ends_with("Fallback") => TreeNodeKind::Fallback,
        _ => TreeNodeKind::Control,
    }
}

fn pair((title, first, second): &(&str, &str, &str)) -> Figure {
    let panels = [(first, "conventional"), (second, "with inference nodes")].map(|(tree, kind)| {
        let nodes = picture(tree);
        let counts = counts(&nodes);
        let title = format!("{kind}: {} nodes, {} levels", counts[NODES], counts[LEVELS]);
        Panel::Tree(TreePicture { title, nodes })
    });
    Figure::new(
        format!("{title}. → sequence, ? fallback, oval condition, box action, blue inference node."),
        panels,
    )
}
