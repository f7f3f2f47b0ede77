//! Tables 3, 6 and 7 and figure 5: how large the trees are, counted from the trees themselves.

use super::Reproduction;
use super::figure::{Figure, Panel, TreeNode, TreeNodeKind, TreePicture};
use super::report::{Item, Section};
use crate::library::built_in;
use crate::manipulation::{Detail, Disturbances, RunTerms, Trees, run as carry_out};
use crate::tree::{Class, Line, library as trees};
use crate::{Conditions, Pilot, Scenario, Trigger, fly};

/// A tree of the paper and the numbers that the paper prints for it.
struct Counted {
    /// Its name in the paper.
    what: &'static str,
    /// Our tree.
    tree: &'static str,
    /// The paper's sequences, fallbacks, conditions, actions, nodes and levels.
    paper: [usize; 6],
    /// The reason, where our count differs from the paper's.
    reasons: &'static [(usize, &'static str)],
}

const COLUMNS: [&str; 6] = ["sequences", "fallbacks", "conditions", "actions", "nodes", "levels"];
const NODES: usize = 4;
const LEVELS: usize = 5;

const LEVEL_CONVENTION: &str =
    "a fallback within a sequence has leaves on the third level; the paper counts like this in table 6";

const NOT_IN_THE_FIGURE: &str =
    "figures 14 and 15 as the paper draws them have fewer nodes than its table says";

/// The trees of tables 3, 6 and 7.
const TREES: [Counted; 7] = [
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
    Counted {
        what: "table 6, conventional, a tree with its counts that flies",
        tree: "table-6-conventional",
        paper: [4, 9, 9, 11, 33, 7],
        reasons: &[],
    },
    Counted {
        what: "table 6, conventional, as drawn",
        tree: "figure-14-left-classical",
        paper: [4, 9, 9, 11, 33, 7],
        reasons: &[
            (0, NOT_IN_THE_FIGURE),
            (1, NOT_IN_THE_FIGURE),
            (2, NOT_IN_THE_FIGURE),
            (3, NOT_IN_THE_FIGURE),
            (NODES, NOT_IN_THE_FIGURE),
            (LEVELS, NOT_IN_THE_FIGURE),
        ],
    },
    Counted { what: "table 6, inference", tree: "figure-14-left", paper: [1, 1, 1, 3, 6, 3], reasons: &[] },
    Counted {
        what: "table 7, conventional",
        tree: "figure-14-right-classical",
        paper: [2, 2, 3, 3, 10, 5],
        reasons: &[],
    },
    Counted { what: "table 7, inference", tree: "figure-14-right", paper: [1, 0, 0, 2, 3, 2], reasons: &[] },
];

/// The pairs that are drawn side by side.
const PAIRS: [(&str, [(&str, &str); 2]); 5] = [
    ("Figure 5", [("conventional", "figure-5-classical"), ("inference", "figure-5-inference")]),
    ("Figure 8 and table 3", [("conventional", "figure-8-classical"), ("inference", "figure-8-inference")]),
    (
        "Robot 1, table 6, as drawn",
        [("conventional", "figure-14-left-classical"), ("inference", "figure-14-left")],
    ),
    (
        "Robot 2, table 7, as drawn",
        [("conventional", "figure-14-right-classical"), ("inference", "figure-14-right")],
    ),
    (
        "Robot 1 in conventional trees that bring the bottle to the plate",
        [("table 6's counts", "table-6-conventional"), ("as one would write it", "bottle-conventional")],
    ),
];

/// Computes the section.
pub(super) fn count(_: &Reproduction<'_>) -> Section {
    let mut section = Section::new("tables", "Tables 3, 6 and 7: how large the trees are");
    section.say("Counted from the trees that fly the missions, by code; a level more for every parent, the root being the first.");
    section.say(
        "The trees of figure 5 and table 3 fly the missions of sections 5 and 6.1, those of tables 6 and 7 the mission of section \
         6.2. As drawn, the conventional trees of figures 14 to 16 bring nothing together: robot 1 waits for robot 2 at goal B, \
         robot 2 for robot 1 at goal A. Others that do the mission stand beside them.",
    );
    section.items = TREES.iter().flat_map(Counted::items).collect();
    section.items.extend(missions());
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

/// Whether the trees do their missions.
fn missions() -> Vec<Item> {
    let flown = |(scenario, pilot): (Scenario, Pilot)| {
        let mission = &scenario.name;
        let record = fly(&scenario, Conditions { tree: pilot, ..Conditions::default() }, &mut ())
            .expect("it can be flown");
        let done = record.outcome.is_success();
        Item::claim(
            format!("{mission}, flown with the tree {}", pilot.name()),
            "accomplished",
            format!("{:?} at tick {}", record.outcome, record.last_arrival()),
            done,
        )
    };
    let handled = |trees: Trees| {
        let terms = RunTerms { trees, disturbances: Disturbances::NONE, ..RunTerms::new(0) };
        let run = carry_out(&terms, Detail::Outcome).expect("the built-in trees run");
        let what = format!("section 6.2, with the trees {}", trees.name());
        let ours = if run.success { format!("yes, after {} ticks", run.ticks) } else { "no".to_owned() };
        if trees == Trees::AsDrawn {
            return Item::measured(format!("{what}: the bottle on the plate"), ours)
                .because("each robot waits for the other");
        }
        Item::claim(format!("{what}: the bottle on the plate"), "yes", ours, run.success)
    };
    let two_goals = || built_in("two-goals");
    let flights = [
        (two_goals(), Pilot::Inference),
        (two_goals(), Pilot::Figure5),
        (shift_by_the_clock(), Pilot::Inference),
        (shift_by_the_clock(), Pilot::Conventional),
    ];
    flights.into_iter().map(flown).chain(Trees::ALL.into_iter().map(handled)).collect()
}

/// The mission of section 6.1 with events at fixed ticks, for pilots that make no joint plans: two
/// obstacles, two way-points, two low batteries.
fn shift_by_the_clock() -> Scenario {
    let mut scenario = Scenario { name: "shift by the clock".to_owned(), ..built_in("shift") };
    for (event, tick) in scenario.events.iter_mut().zip([2, 4, 5, 5, 9, 20]) {
        event.when = Trigger::Tick(tick);
    }
    scenario
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
    let instance = trees::instance(name).expect("it is built in").expect("it is sound");
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

fn pair((title, trees): &(&str, [(&str, &str); 2])) -> Figure {
    let panels = trees.map(|(kind, tree)| {
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
