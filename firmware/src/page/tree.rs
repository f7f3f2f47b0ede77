//! The behavior tree in the page of a robot with a table task.

use super::node::{NODE, node_of};
use super::sections::fits;
use super::source::Source;
use super::{Fault, Size};
use crate::TaskLeaf;
use heapless::Vec;
use iibt_core::iibt::table::Tables;
use iibt_core::team::RobotId;
use iibt_core::tree::{Full, Node, NodeMemory, OwnedTree, Row, TreeError, TreeRef, TreeRule};

/// The most nodes that one tick of a tree in a page may visit; each counts once for each visit.
pub const MAX_VISITS: u32 = 255;

/// A behavior tree of up to `T` nodes, at most 255, from the page of a robot: with aims and facts
/// of its tables, and skills `L` of its own.
///
/// [`Page::load_task`](super::Page::load_task) fills it. Keep it in a `static`: it takes 8 bytes a
/// node for leaves of up to a byte.
///
/// ```
/// use firmware::TaskLeaf;
/// use firmware::page::PageTree;
/// use iibt_core::iibt::table::{Aim, Fact, HiddenFactor, Operator, Reads, Role, Sensor, Tables};
///
/// # static TABLES: Tables = Tables::new(&[Role {
/// #     name: "valve",
/// #     sensors: &[Sensor::even("position", Reads::Factor(0), 0.9)],
/// #     operators: &[Operator::IDLE, Operator::bringing("close", 1, 0.8)],
/// #     facts: &[Fact::sure("closed", 0, &[1])],
/// #     aims: &[Aim::new("close", &[0], &[0.0, 1.0])],
/// #     ..Role::of(&[HiddenFactor::unknown("valve", &["open", "closed"])])
/// # }]);
/// #[derive(Clone, Copy)]
/// enum Skill { Finish, Whistle }
///
/// let mut tree = PageTree::<Skill, 32>::EMPTY;
/// // In a page, skill 0 is to finish, and skill 1 to whistle.
/// let reader = tree.of(&TABLES, &[Skill::Finish, Skill::Whistle]);
/// # drop(reader);
/// // page.load_task(&mut flash, SLOTS, &mut reader)?
/// assert!(tree.by_ref().is_none(), "nothing was read");
/// ```
#[derive(Clone, Debug)]
pub struct PageTree<L, const T: usize> {
    /// The hash of the tables that the tree is for.
    task: u64,
    tree: Option<Rows<L, T>>,
}

/// The memory of a tree of up to `T` nodes: 8 bytes each.
pub type TreeMemory<const T: usize> = Vec<NodeMemory<Full>, T>;

type Rows<L, const T: usize> = OwnedTree<TaskLeaf<L>, Vec<Row<TaskLeaf<L>>, T>, Full>;

/// A tree to fill, and what its leaves may name.
pub struct TreeReader<'r, L, const T: usize> {
    tree: &'r mut PageTree<L, T>,
    tables: Option<&'r Tables<'r>>,
    own: &'r [L],
}

impl<L, const T: usize> PageTree<L, T> {
    /// The tree that nothing was read into.
    pub const EMPTY: Self = Self { task: 0, tree: None };

    /// Borrows the tree. `None` where none was read.
    #[must_use]
    pub fn by_ref(&self) -> Option<TreeRef<'_, TaskLeaf<L>, Full>> {
        self.tree.as_ref().map(OwnedTree::by_ref)
    }

    /// Returns the hash of the tables that the tree is for, [`Tables::mission`]. `None` where none
    /// was read.
    #[must_use]
    pub fn task(&self) -> Option<u64> {
        self.tree.as_ref().map(|_| self.task)
    }

    /// Returns the memory of the tree, idle: an element for each node.
    #[must_use]
    pub fn memory(&self) -> TreeMemory<T> {
        let mut memory = Vec::new();
        for _ in 0..self.tree.as_ref().map_or(0, OwnedTree::len) {
            // There is room for every node of the tree.
            let _ = memory.push(NodeMemory::NEW);
        }
        memory
    }

    /// Returns the reader of a tree for a task. Skill n of the page is the n-th of `own`.
    pub const fn of<'r>(&'r mut self, tables: &'r Tables<'r>, own: &'r [L]) -> TreeReader<'r, L, T> {
        TreeReader { tree: self, tables: Some(tables), own }
    }

    /// Returns the reader of a tree for any task: whatever aims and facts it names.
    pub const fn of_any_task<'r>(&'r mut self, own: &'r [L]) -> TreeReader<'r, L, T> {
        TreeReader { tree: self, tables: None, own }
    }
}

/// A reader of the section with a tree, of any size and with any skills. An image has the code of
/// one.
pub(super) trait ReadTree {
    /// The most nodes; 0 where the page has a mission in place of a tree.
    const ROOM: usize;

    /// Reads the section in the page of this robot.
    fn read(&mut self, source: &mut Source<'_>, robot: RobotId, team: u8);
}

/// No tree, but a mission.
pub(super) struct NoTree;

impl ReadTree for NoTree {
    const ROOM: usize = 0;

    fn read(&mut self, _: &mut Source<'_>, _: RobotId, _: u8) {}
}

impl<L: Copy, const T: usize> ReadTree for TreeReader<'_, L, T> {
    const ROOM: usize = T;

    fn read(&mut self, source: &mut Source<'_>, robot: RobotId, team: u8) {
        let begin = source.at();
        let task = u64::from(source.u32()) | u64::from(source.u32()) << 32;
        *self.tree = PageTree { task, tree: None };
        let is_own = |tables: &Tables| tables.mission() == task && tables.robots() == usize::from(team);
        if !self.tables.is_none_or(is_own) {
            source.refuse(begin, Fault::OtherTask);
        }
        let at = source.at();
        let count = source.u8();
        fits(source, at, Size::Nodes, count.into(), T);
        let (nodes, mut rows) = (source.at(), Vec::new());
        for _ in 0..count {
            let at = source.at();
            match self.node(source.u32().to_le_bytes(), robot) {
                // There is room for as many, or the page is refused.
                Ok(node) => drop(rows.push(Row::new(node))),
                Err(fault) => source.refuse(at, fault),
            }
        }
        match link(rows) {
            Ok(tree) => self.tree.tree = Some(tree),
            Err((row, fault)) => source.refuse(nodes.saturating_add(NODE * u32::from(row)), fault),
        }
    }
}

impl<L: Copy, const T: usize> TreeReader<'_, L, T> {
    fn node(&self, bytes: [u8; 4], robot: RobotId) -> Result<Node<TaskLeaf<L>>, Fault> {
        let node = node_of(bytes).ok_or(Fault::Node(bytes))?;
        node.try_map(|leaf| self.leaf(leaf, robot).ok_or(Fault::Leaf(leaf)))
    }

    /// The leaf of the robot that a page names.
    fn leaf(&self, leaf: TaskLeaf<u8>, robot: RobotId) -> Option<TaskLeaf<L>> {
        let role = self.tables.and_then(|tables| tables.role(robot.index()));
        match leaf {
            TaskLeaf::Aim(aim) => {
                role.is_none_or(|role| usize::from(aim) < role.aims.len()).then_some(TaskLeaf::Aim(aim))
            }
            TaskLeaf::Fact(fact) => {
                role.is_none_or(|role| usize::from(fact) < role.facts.len()).then_some(TaskLeaf::Fact(fact))
            }
            TaskLeaf::Own(number) => self.own.get(usize::from(number)).copied().map(TaskLeaf::Own),
        }
    }
}

/// The tree of these rows, or the row at which it is none, and why.
fn link<L, const T: usize>(rows: Vec<Row<TaskLeaf<L>>, T>) -> Result<Rows<L, T>, (u16, Fault)> {
    let at = |TreeError { node, rule }| (node, Fault::Tree(rule));
    let linked = Rows::try_new(rows).map_err(at)?;
    let tree = linked.by_ref();
    if let Some(node) = tree.never_ticked(&mut [0; T]) {
        return Err(at(TreeError { node, rule: TreeRule::NeverTicked }));
    }
    let visits = tree.visits(&mut [(0, 0); T]);
    if visits > MAX_VISITS {
        let (needed, room) = (u16::try_from(visits).unwrap_or(u16::MAX), MAX_VISITS as u16);
        return Err((0, Fault::TooLarge { size: Size::Visits, needed, room }));
    }
    Ok(linked)
}
