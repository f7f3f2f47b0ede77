//! Pages with trees: round trips, damage, refusals.

use super::{Copies, TWO, sealed};
use crate::task::{TableMission, TaskTree, built_in};
use crate::tree::{Document, Extras};
use crate::{ANY_SKILL, AnyPage, AnyPageTree, KEY, Provision, Random};
use bumpalo::Bump;
use firmware::TaskLeaf;
use firmware::page::{Fault, HEADER, Page, PageError, PageTree, Refused, SECTION_HEAD, Size};
use iibt_core::team::RobotId;
use iibt_core::tree::{Millis, Node, OwnedTree, Row, Status, Times, TreeError, TreeRule};

const TREES: &str = include_str!("../../../tasks/bottle-and-plate.xml");

fn task(arena: &Bump) -> TableMission<'_> {
    let text = built_in("bottle-and-plate").expect("it is built in");
    let task = TableMission::parse(arena, "bottle-and-plate", text).expect("it is sound");
    let document = Document::parse("trees.xml", TREES, &Extras::default()).expect("it is XML");
    task.with_trees(&document).expect("the trees are sound")
}

fn page(task: &TableMission<'_>, robot: u8, generation: u32) -> Vec<u8> {
    Provision { generation, ..Provision::new(RobotId(robot), KEY) }.page_of_task(task).expect("it fits")
}

/// The byte at which the nodes of a page begin.
fn first_node(page: &[u8]) -> usize {
    let mut at = HEADER as usize;
    while page[at] != firmware::page::Section::TREE {
        at += SECTION_HEAD as usize + usize::from(u16::from_le_bytes([page[at + 2], page[at + 3]]));
    }
    at + SECTION_HEAD as usize + 8 + 1
}

fn nodes(tree: &TaskTree) -> Vec<Node<TaskLeaf<u8>>> {
    tree.by_ref().nodes().copied().collect()
}

fn read(page: &[u8], task: &TableMission<'_>) -> Result<Vec<Node<TaskLeaf<u8>>>, Refused> {
    let (mut read, mut tree) = (AnyPage::EMPTY, AnyPageTree::EMPTY);
    read.load_task_bytes(page, &mut tree.of(&task.tables, &ANY_SKILL))?;
    let tree = tree.by_ref().expect("it was read");
    Ok(tree.nodes().copied().collect())
}

#[test]
fn the_tree_of_each_robot_is_read_as_it_was_written() {
    let arena = Bump::new();
    let task = task(&arena);
    for robot in 0..2 {
        let bytes = page(&task, robot, 1);
        let written = nodes(&task.tree(robot.into()).expect("it has one"));
        assert_eq!(read(&bytes, &task), Ok(written.clone()));
        let (mut own, mut tree) = (AnyPage::EMPTY, PageTree::<(), 10>::EMPTY);
        own.load_task_bytes(&bytes, &mut tree.of(&task.tables, &[()]))
            .expect("an image of this size reads it");
        assert_eq!((own.robot(), own.team(), tree.memory().len()), (RobotId(robot), 2, written.len()));
        assert_eq!(tree.task(), Some(task.tables.mission()));
    }
    assert_ne!(task.tree(0).map(|tree| nodes(&tree)), task.tree(1).map(|tree| nodes(&tree)));
}

/// A random tree with every kind of node, in preorder.
fn grow(random: &mut Random, depth: u32, nodes: &mut Vec<Node<TaskLeaf<u8>>>) {
    let leaf = |random: &mut Random| {
        let number = random.below(2) as u8;
        [TaskLeaf::Aim(number), TaskLeaf::Fact(number), TaskLeaf::Own(random.bits() as u8)][random.below(3)]
    };
    let time = |random: &mut Random| {
        Millis::new([1 + random.below(1000) as u32, (1 << 23) - 1, Millis::MAX][random.below(3)])
    };
    let times =
        |random: &mut Random| Times::new([-1, 1 + random.below(100) as i32, Times::MAX][random.below(3)]);
    if depth == 0 {
        let leaf = leaf(random);
        nodes.push(match random.below(5) {
            0 => Node::Action(leaf),
            1 => Node::Inference(leaf),
            2 => Node::Condition(leaf),
            3 => Node::Sleep(time(random)),
            _ => Node::Action(leaf),
        });
        return;
    }
    let children = 3 + random.below(2) as u8;
    let otherwise = [Status::Running, Status::Success, Status::Failure, Status::Skipped][random.below(4)];
    let node = match random.below(27) {
        0 => Node::Sequence(children),
        1 => Node::Fallback(children),
        2 => Node::ReactiveSequence(children),
        3 => Node::ReactiveFallback(children),
        4 => Node::Inverter,
        5 => Node::SequenceWithMemory(children),
        6 => Node::AsyncSequence(children),
        7 => Node::AsyncFallback(children),
        8 => Node::Parallel { children, success_count: -1, failure_count: random.below(3) as i8 },
        9 => Node::ParallelAll { children, max_failures: -2 },
        10 => Node::IfThenElse(3),
        11 => Node::WhileDoElse(3),
        12 => Node::Switch(children, leaf(random)),
        13 => Node::PipelineSequence(children),
        14 => Node::RoundRobin(children),
        15 => Node::RecoveryNode(1),
        16 => Node::ForceSuccess,
        17 => Node::ForceFailure,
        18 => Node::KeepRunningUntilFailure,
        19 => Node::RetryUntilSuccessful(times(random)),
        20 => Node::Repeat(times(random)),
        21 => Node::Timeout(time(random)),
        22 => Node::Delay(time(random)),
        23 => Node::RunOnce { then_skip: random.below(2) == 0 },
        24 => Node::Precondition { condition: leaf(random), otherwise },
        25 => Node::RateController(time(random)),
        _ => Node::SubTree,
    };
    nodes.push(node);
    for _ in 0..node.children().unwrap_or(0) {
        let below = random.below(depth as usize) as u32;
        grow(random, below, nodes);
    }
}

fn tree_of(nodes: &[Node<TaskLeaf<u8>>]) -> Result<TaskTree, TreeError> {
    OwnedTree::try_new(nodes.iter().copied().map(Row::new).collect())
}

#[test]
fn trees_of_all_kinds_of_nodes_come_back_as_they_were() {
    let arena = Bump::new();
    let mut task = task(&arena);
    let mut random = Random::new(3);
    let (mut read_back, mut kinds) = (0, std::collections::BTreeSet::new());
    for _ in 0..3000 {
        let mut grown = vec![];
        grow(&mut random, 3, &mut grown);
        let Ok(tree) = tree_of(&grown) else { continue };
        task.trees = Some(vec![tree.clone(), tree]);
        match Provision::new(RobotId(1), KEY).page_of_task(&task) {
            Ok(bytes) => {
                assert_eq!(read(&bytes, &task), Ok(grown.clone()));
                kinds.extend(grown.iter().map(|node| firmware::page::node_bytes(node)[0]));
                read_back += 1;
            }
            Err(refused) => {
                let said = refused.to_string();
                let is_known =
                    ["can never be ticked", "room for 255", "visits"].iter().any(|why| said.contains(why));
                assert!(is_known, "{said}");
            }
        }
    }
    assert!(read_back > 1500, "{read_back}");
    // The two that are missing succeed or fail whatever comes before or after them.
    assert!(kinds.iter().copied().eq((0..33).filter(|kind| !(30..32).contains(kind))), "{kinds:?}");
}

#[test]
fn a_page_with_a_tree_that_is_damaged_or_cut_is_refused_and_the_other_copy_counts() {
    let arena = Bump::new();
    let task = task(&arena);
    let (old, new) = (page(&task, 0, 1), page(&task, 0, 2));
    let mut damaged: Vec<Vec<u8>> = (0..new.len()).map(|length| new[..length].to_vec()).collect();
    damaged.extend((0..8 * new.len()).map(|bit| {
        let mut other = new.clone();
        other[bit / 8] ^= 1 << (bit % 8);
        other
    }));
    for other in damaged {
        assert!(read(&other, &task).is_err());
        let (mut own, mut tree) = (AnyPage::EMPTY, AnyPageTree::EMPTY);
        let mut reader = tree.of(&task.tables, &ANY_SKILL);
        let origin = own.load_task(&mut Copies([other, old.clone()]), TWO, &mut reader);
        let origin = origin.expect("the old copy is whole");
        assert!(origin.generation == 1 && origin.other.is_some(), "{origin:?}");
    }
}

/// What is read of a page with one byte changed and a right checksum is another sound tree, or the
/// page is refused at a byte within it.
#[test]
fn a_page_with_any_byte_changed_and_a_right_checksum_is_refused_by_name_or_sound() {
    let arena = Bump::new();
    let task = task(&arena);
    let good = page(&task, 1, 1);
    let (mut refused, mut sound) = (0, 0);
    for at in 0..good.len() - 4 {
        for value in (0..=u8::MAX).filter(|&value| value != good[at]) {
            let mut other = good.clone();
            other[at] = value;
            match read(&sealed(other), &task) {
                Ok(nodes) => {
                    let tree = tree_of(&nodes).expect("it was linked");
                    assert_eq!(tree.by_ref().never_ticked(&mut vec![0; tree.len()]), None);
                    assert!(tree.by_ref().visits(&mut vec![(0, 0); tree.len()]) <= 255);
                    sound += 1;
                }
                Err(Refused::Content { error, .. } | Refused::Both { first: error, .. }) => {
                    assert!(error.at as usize <= good.len() || error.fault == Fault::Checksum, "{error}");
                    refused += 1;
                }
                Err(refused) => panic!("{refused}"),
            }
        }
    }
    assert!(refused > 10_000 && sound > 5_000, "{refused} {sound}");
}

/// The refusal of R2's page in which the node in a row is written otherwise.
fn refusal(task: &TableMission<'_>, row: usize, bytes: [u8; 4]) -> (usize, Fault) {
    let mut page = page(task, 1, 1);
    let first = first_node(&page);
    page[first + 4 * row..][..4].copy_from_slice(&bytes);
    let (mut own, mut tree) = (AnyPage::EMPTY, PageTree::<(), 12>::EMPTY);
    let refused = own.load_task_bytes(&sealed(page), &mut tree.of(&task.tables, &[()]));
    let Err(Refused::Content { error: PageError { at, fault }, .. }) = refused else { panic!("{refused:?}") };
    (at as usize - first, fault)
}

#[test]
fn what_is_wrong_with_a_tree_is_named_with_its_byte_and_value() {
    let arena = Bump::new();
    let task = task(&arena);
    let refusal = |row, bytes| refusal(&task, row, bytes);
    // Row 4 pursues aim 0, row 1 has skill 0, row 6 holds fact 2.
    assert_eq!(refusal(4, [0, 0, 2, 0]), (16, Fault::Leaf(TaskLeaf::Aim(2))));
    assert_eq!(refusal(6, [2, 1, 10, 0]), (24, Fault::Leaf(TaskLeaf::Fact(10))));
    assert_eq!(refusal(1, [2, 2, 1, 0]), (4, Fault::Leaf(TaskLeaf::Own(1))));
    assert_eq!(refusal(4, [33, 0, 0, 0]), (16, Fault::Node([33, 0, 0, 0])));
    assert_eq!(refusal(4, [0, 3, 0, 0]), (16, Fault::Node([0, 3, 0, 0])));
    assert_eq!(refusal(4, [0, 0, 0, 1]), (16, Fault::Node([0, 0, 0, 1])), "a byte that means nothing");
    assert_eq!(refusal(3, [26, 2, 0, 0]), (12, Fault::Node([26, 2, 0, 0])), "no truth value");
    assert_eq!(refusal(7, [25, 1, 0, 0x80]), (28, Fault::Node([25, 1, 0, 0x80])), "a second is 1000 ms");
    assert_eq!(refusal(0, [3, 0, 0, 0]), (0, Fault::Tree(TreeRule::NoChildren)));
    assert_eq!(refusal(0, [3, 3, 0, 0]), (0, Fault::Tree(TreeRule::MissingChildren)));
    assert_eq!(refusal(2, [3, 2, 0, 0]), (36, Fault::Tree(TreeRule::Unreachable)));
    assert_eq!(refusal(7, [25, 255, 255, 255]), (28, Fault::Node([25, 255, 255, 255])), "97 days");
    assert_eq!(refusal(7, [28, 0, 0, 0]), (28, Fault::Tree(TreeRule::Duration)));
    assert_eq!(refusal(3, [22, 0xfe, 0xff, 0xff]), (12, Fault::Tree(TreeRule::Times)));
    assert_eq!(refusal(1, [30, 0, 0, 0]), (8, Fault::Tree(TreeRule::NeverTicked)));
    let visits = Fault::TooLarge { size: Size::Visits, needed: 1146, room: 255 };
    // A recovery of two children, of which the second has all that follows.
    assert_eq!(refusal(0, [18, 127, 0, 0]), (0, visits));
    let said = Fault::Leaf(TaskLeaf::Fact(10)).to_string() + "; " + &Fault::Node([33, 0, 0, 0]).to_string();
    assert_eq!(said, "the robot has no fact 10; no node of a tree is written [21, 00, 00, 00]");
}

#[test]
fn a_tree_for_other_tables_or_a_larger_image_is_refused() {
    let arena = Bump::new();
    let (task, valves) = (task(&arena), built_in("valves").expect("it is built in"));
    let valves = TableMission::parse(&arena, "valves", valves).expect("it is sound");
    let bytes = page(&task, 0, 1);
    let fault = |refused: Result<_, Refused>| match refused {
        Err(Refused::Content { error, .. }) => error.fault,
        other => panic!("{other:?}"),
    };
    assert_eq!(fault(read(&bytes, &valves).map(|_| ())), Fault::OtherTask);
    let (mut own, mut small) = (AnyPage::EMPTY, PageTree::<(), 8>::EMPTY);
    let refused = own.load_task_bytes(&bytes, &mut small.of(&task.tables, &[()]));
    assert_eq!(fault(refused.map(|_| ())), Fault::TooLarge { size: Size::Nodes, needed: 9, room: 8 });
}

#[test]
fn robots_of_one_kind_refuse_the_pages_of_the_other() {
    let arena = Bump::new();
    let task = task(&arena);
    let fault = |refused: Result<_, Refused>| match refused {
        Err(Refused::Content { error, .. }) => error.fault,
        other => panic!("{other:?}"),
    };
    let refused = Page::<64, 2, 8>::EMPTY.clone().load_bytes(&page(&task, 0, 1)).map(|_| ());
    assert!(matches!(fault(refused), Fault::TooLarge { size: Size::Nodes, room: 0, .. }));
    assert_eq!(fault(read(&super::page(1), &task).map(|_| ())), Fault::Unknown(3));
}
