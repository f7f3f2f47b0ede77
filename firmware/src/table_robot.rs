//! A ready-made robot for tasks that are written as tables.

use crate::Robot;
use crate::hardware::Equipment;
use core::marker::PhantomData;
use iibt_core::iibt::table::{
    Announcement, Command, MAX_FACTORS, MAX_SENSORS, Percept, TableTask, Tables, TablesError,
};
use iibt_core::iibt::{InferenceNode, Task};
use iibt_core::team::{Invalid, Message, Peers, RobotId};
use iibt_core::time::{Duration, Instant};
use iibt_core::tree::{Basic, Halt, Kinds, Leaves, Memory, NodeMemory, Status, Tree, TreeRef};

/// A leaf of a [`TableRobot`]'s tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TaskLeaf<L> {
    /// The aim with this number in the robot's role. As an inference node, it pursues the aim; as a
    /// condition, it holds when the aim is reached.
    Aim(usize),
    /// The fact with this number in the robot's role: a condition.
    Fact(u8),
    /// One of the robot's own [`Skills`].
    Own(L),
}

/// What a robot has beside its tables: leaves and a part of the message of its own.
///
/// Nothing is needed but what the tree and the teammates ask for; `()` has no leaf and adds nothing
/// to the message. The methods for leaves are those of [`Leaves`], whose contract they share.
#[doc(alias = "blackboard")]
pub trait Skills<H> {
    /// The names of the robot's own leaves.
    type Leaf;
    /// What the robot adds to its [`Announcement`].
    type Message: Message;

    /// Reads what the tables do not know of: a battery, a button.
    fn sense(&mut self, hardware: &mut H, now: Instant) {
        let _ = (hardware, now);
    }

    /// Returns what to add to the announcement.
    fn message(&self) -> Self::Message;

    /// Returns whether a condition holds now.
    fn condition(&mut self, leaf: &Self::Leaf, turn: &Turn<'_, Self::Message>) -> bool {
        let _ = (leaf, turn);
        false
    }

    /// Starts an action, by default as it continues.
    fn on_start(&mut self, leaf: &Self::Leaf, turn: &mut Turn<'_, Self::Message>) -> Status {
        self.on_running(leaf, turn)
    }

    /// Continues an action.
    fn on_running(&mut self, leaf: &Self::Leaf, turn: &mut Turn<'_, Self::Message>) -> Status {
        let _ = (leaf, turn);
        Status::Failure
    }

    /// Stops an action. An operator that it has begun in this tick is not carried out.
    fn on_halted(&mut self, leaf: &Self::Leaf, turn: &mut Turn<'_, Self::Message>) -> Halt {
        let _ = (leaf, turn);
        Halt::Done
    }

    /// Goes on stopping an action.
    fn on_halting(&mut self, leaf: &Self::Leaf, turn: &mut Turn<'_, Self::Message>) -> Halt {
        let _ = (leaf, turn);
        Halt::Done
    }

    /// Returns the child that a `Switch` ticks.
    fn case(&mut self, leaf: &Self::Leaf, turn: &Turn<'_, Self::Message>) -> usize {
        let _ = (leaf, turn);
        usize::MAX
    }

    /// Returns the time at which a running action wants its next tick.
    fn deadline(&mut self, leaf: &Self::Leaf, turn: &Turn<'_, Self::Message>) -> Option<Instant> {
        let _ = (leaf, turn);
        None
    }

    /// Drives what the tables do not know of: a lamp, a horn.
    fn act(&mut self, hardware: &mut H) {
        let _ = hardware;
    }
}

impl<H> Skills<H> for () {
    type Leaf = ();
    type Message = ();

    fn message(&self) {}
}

/// One tick as the robot's own leaves see it.
pub struct Turn<'k, X> {
    /// The time of the tick.
    pub now: Instant,
    /// The teammates and what they have announced.
    pub peers: Peers<'k, Announcement<X>>,
    /// What was sensed.
    pub percept: Percept,
    /// Whether the robot is sure of all its factors, and no operator is under way.
    pub is_settled: bool,
    sure: [Option<u8>; MAX_FACTORS],
    begun: Option<Command>,
}

impl<X> Turn<'_, X> {
    /// Returns the state that a hidden factor is in, where the robot is sure of it.
    #[must_use]
    pub fn sure(&self, factor: u8) -> Option<u8> {
        self.sure.get(usize::from(factor)).copied().flatten()
    }

    /// Begins an operator, towards a target if it has one.
    pub const fn begin(&mut self, operator: u8, target: Option<u8>) {
        self.begun = Some(Command { operator, target });
    }
}

/// A robot whose task is written as tables, with any tree and with [`Skills`] `K` of its own.
///
/// It reads the sensors and carries out the operators of its tables through [`Equipment`]. The
/// memory `M` is a [`Memory`] of the tree; `S`, `N` and `P` are the sizes of a [`TableTask`]. Its
/// inference nodes share one preference and timeout, so that one of them runs at a time.
pub struct TableRobot<
    't,
    H,
    K: Skills<H>,
    M,
    const S: usize,
    const N: usize,
    const P: usize,
    Set: Kinds = Basic,
> {
    tree: TreeRef<'t, TaskLeaf<K::Leaf>, Set>,
    memory: M,
    parts: Parts<K, TableTask<'t, S, N, P, K::Message>>,
    percept: Percept,
    hardware: PhantomData<fn(&mut H)>,
}

/// The type of a [`TableRobot`] with as much memory as its tables and its tree take: of the tables,
/// the hardware, the skills, the number of nodes, and the set of nodes unless that is
/// [`Basic`](iibt_core::tree::Basic).
#[macro_export]
macro_rules! table_robot {
    ($tables:expr, $hardware:ty, $skills:ty, $nodes:literal $(, $set:ty)?) => {
        $crate::TableRobot<
            'static, $hardware, $skills, $crate::prelude::Memory<$nodes $(, $set)?>,
            { $tables.states() }, { $tables.robots() }, { $tables.policies() } $(, $set)?
        >
    };
}

/// What the leaves work with.
struct Parts<K, T: Task> {
    skills: K,
    task: T,
    node: InferenceNode<T>,
}

impl<'t, H, K, const NODES: usize, const S: usize, const N: usize, const P: usize, Set>
    TableRobot<'t, H, K, Memory<NODES, Set>, S, N, P, Set>
where
    K: Skills<H>,
    Set: Kinds,
{
    /// Creates a robot of a team at the start of its task. Its inference nodes fail when a
    /// precondition stays unmet for `timeout`.
    ///
    /// # Errors
    /// [`TablesError`] when the tables have no role for the robot or need more room than `S`, `N`
    /// and `P` give, or when the tree has an aim or a fact that the role has not.
    pub fn new(
        tables: &'t Tables<'t>,
        robot: RobotId,
        tree: &'t Tree<TaskLeaf<K::Leaf>, NODES, Set>,
        skills: K,
        timeout: Duration,
    ) -> Result<Self, TablesError> {
        Self::with_memory(tables, robot, tree.by_ref(), Memory::new(), skills, timeout)
    }
}

impl<'t, H, K, M, const S: usize, const N: usize, const P: usize, Set> TableRobot<'t, H, K, M, S, N, P, Set>
where
    K: Skills<H>,
    M: AsMut<[NodeMemory<Set>]> + AsRef<[NodeMemory<Set>]>,
    Set: Kinds,
{
    /// As [`new`](Self::new), with a tree whose size is known only at run time.
    ///
    /// # Errors
    /// As [`new`](Self::new), and when the memory has not an element for each node.
    pub fn with_memory(
        tables: &'t Tables<'t>,
        robot: RobotId,
        tree: TreeRef<'t, TaskLeaf<K::Leaf>, Set>,
        memory: M,
        skills: K,
        timeout: Duration,
    ) -> Result<Self, TablesError> {
        let (task, node) = (TableTask::new(tables, robot)?, InferenceNode::new(timeout));
        check(&tree, tables, robot)?;
        if memory.as_ref().len() != tree.nodes().len() {
            let reason = "its memory has not an element for each node";
            return Err(TablesError { role: None, table: "tree", row: None, reason });
        }
        let parts = Parts { skills, task, node };
        Ok(Self { tree, memory, parts, percept: Percept::default(), hardware: PhantomData })
    }

    /// Returns the task, with its belief and its last decision.
    pub const fn task(&self) -> &TableTask<'t, S, N, P, K::Message> {
        &self.parts.task
    }

    /// Returns the inference node, with what it has raised.
    pub const fn node(&self) -> &InferenceNode<TableTask<'t, S, N, P, K::Message>> {
        &self.parts.node
    }

    /// Returns the robot's own skills.
    pub const fn skills(&self) -> &K {
        &self.parts.skills
    }

    /// Returns the leaf that is running.
    pub fn running(&self) -> Option<&'t TaskLeaf<K::Leaf>> {
        self.tree.running(self.memory.as_ref())
    }
}

/// Whether a robot's role has the aims and facts that its tree names.
fn check<L, Set: Kinds>(
    tree: &TreeRef<'_, TaskLeaf<L>, Set>,
    tables: &Tables<'_>,
    robot: RobotId,
) -> Result<(), TablesError> {
    let (aims, facts) = tables.role(robot.index()).map_or((0, 0), |role| (role.aims.len(), role.facts.len()));
    for node in tree.nodes() {
        let (table, row, rows) = match node.leaf() {
            Some(TaskLeaf::Aim(aim)) => ("aims", *aim, aims),
            Some(TaskLeaf::Fact(fact)) => ("facts", usize::from(*fact), facts),
            Some(TaskLeaf::Own(_)) | None => continue,
        };
        if row >= rows {
            let reason = "the tree names one that there is not";
            return Err(TablesError { role: Some(robot.0), table, row: Some(row as u16), reason });
        }
    }
    Ok(())
}

impl<H, K, M, const S: usize, const N: usize, const P: usize, Set> Robot<H>
    for TableRobot<'_, H, K, M, S, N, P, Set>
where
    H: Equipment,
    K: Skills<H>,
    M: AsMut<[NodeMemory<Set>]>,
    Set: Kinds,
{
    type Message = Announcement<K::Message>;

    fn mission(&self) -> u64 {
        self.parts.task.mission()
    }

    fn accepts(&self, said: &Self::Message) -> Result<(), Invalid> {
        self.parts.task.accepts(said)
    }

    fn sense(&mut self, hardware: &mut H, now: Instant) {
        let mut readings = [None; MAX_SENSORS];
        for (sensor, reading) in readings.iter_mut().enumerate().take(self.parts.task.role().sensors.len()) {
            *reading = hardware.read(sensor);
        }
        self.percept = Percept { at: now, readings, busy: hardware.is_busy() };
        self.parts.skills.sense(hardware, now);
    }

    fn tick(&mut self, peers: Peers<'_, Self::Message>, now: Instant) -> Status {
        let Self { tree, memory, parts, percept, .. } = self;
        let task = &mut parts.task;
        task.observe(percept, peers);
        let turn = Turn {
            now,
            peers,
            percept: *percept,
            is_settled: task.is_settled(),
            sure: core::array::from_fn(|factor| task.sure(factor).map(|state| state as u8)),
            begun: None,
        };
        tree.tick(memory.as_mut(), &mut Ticking { parts, turn, hardware: PhantomData }, now).status
    }

    fn act(&mut self, hardware: &mut H) {
        if let Some(command) = self.parts.task.command() {
            hardware.begin(command);
        }
        self.parts.skills.act(hardware);
    }

    fn message(&self) -> Self::Message {
        self.parts.task.announcement().with(self.parts.skills.message())
    }
}

/// The leaves in a tick.
struct Ticking<'r, 't, 'k, H, K: Skills<H>, const S: usize, const N: usize, const P: usize> {
    parts: &'r mut Parts<K, TableTask<'t, S, N, P, K::Message>>,
    turn: Turn<'k, K::Message>,
    hardware: PhantomData<fn(&mut H)>,
}

impl<'k, H, K: Skills<H>, const S: usize, const N: usize, const P: usize> Ticking<'_, '_, 'k, H, K, S, N, P> {
    fn pursue(&mut self, aim: usize) -> Status {
        let (Parts { task, node, .. }, Turn { percept, peers, now, .. }) = (&mut *self.parts, &self.turn);
        if task.pursue(aim) { node.tick(task, percept, *peers, *now) } else { Status::Failure }
    }

    /// Calls a skill, and takes up the operator that it begins.
    fn call<T>(&mut self, skill: impl FnOnce(&mut K, &mut Turn<'k, K::Message>) -> T) -> T {
        let result = skill(&mut self.parts.skills, &mut self.turn);
        if let Some(command) = self.turn.begun.take() {
            self.parts.task.begin(command);
        }
        result
    }
}

impl<H, K: Skills<H>, const S: usize, const N: usize, const P: usize> Leaves<TaskLeaf<K::Leaf>>
    for Ticking<'_, '_, '_, H, K, S, N, P>
{
    fn condition(&mut self, leaf: &TaskLeaf<K::Leaf>, _: Instant) -> bool {
        match leaf {
            TaskLeaf::Aim(aim) => self.parts.task.pursue(*aim) && self.parts.task.is_done(),
            TaskLeaf::Fact(fact) => self.parts.task.logic(None).is(*fact),
            TaskLeaf::Own(own) => self.parts.skills.condition(own, &self.turn),
        }
    }

    fn on_start(&mut self, leaf: &TaskLeaf<K::Leaf>, now: Instant) -> Status {
        match leaf {
            TaskLeaf::Own(own) => self.call(|skills, turn| skills.on_start(own, turn)),
            _ => self.on_running(leaf, now),
        }
    }

    fn on_running(&mut self, leaf: &TaskLeaf<K::Leaf>, now: Instant) -> Status {
        match leaf {
            TaskLeaf::Aim(aim) => self.pursue(*aim),
            TaskLeaf::Fact(_) => Status::from(self.condition(leaf, now)),
            TaskLeaf::Own(own) => self.call(|skills, turn| skills.on_running(own, turn)),
        }
    }

    fn on_halted(&mut self, leaf: &TaskLeaf<K::Leaf>, _: Instant) -> Halt {
        match leaf {
            TaskLeaf::Own(own) => {
                self.parts.task.wait();
                self.call(|skills, turn| skills.on_halted(own, turn))
            }
            _ => {
                self.parts.node.halt(&mut self.parts.task);
                Halt::Done
            }
        }
    }

    fn on_halting(&mut self, leaf: &TaskLeaf<K::Leaf>, _: Instant) -> Halt {
        match leaf {
            TaskLeaf::Own(own) => self.call(|skills, turn| skills.on_halting(own, turn)),
            _ => Halt::Done,
        }
    }

    fn case(&mut self, leaf: &TaskLeaf<K::Leaf>, _: Instant) -> usize {
        match leaf {
            TaskLeaf::Own(own) => self.parts.skills.case(own, &self.turn),
            _ => usize::MAX,
        }
    }

    fn deadline(&mut self, leaf: &TaskLeaf<K::Leaf>, _: Instant) -> Option<Instant> {
        match leaf {
            TaskLeaf::Own(own) => self.parts.skills.deadline(own, &self.turn),
            _ => None,
        }
    }
}
