//! A ready-made robot for tasks that are written as tables.

mod leaves;
mod skills;

pub use skills::{Finished, Skills, TaskLeaf, Turn};

use crate::hardware::Equipment;
use crate::{Robot, Settings};
use core::marker::PhantomData;
use iibt_core::iibt::InferenceNode;
use iibt_core::iibt::table::{MAX_SENSORS, Percept, TableMessage, TableTask, Tables, TablesError};
use iibt_core::team::{Invalid, Peers, RobotId};
use iibt_core::time::{Duration, Instant};
use iibt_core::tree::{Basic, Kinds, Memory, NodeMemory, Status, Tree, TreeRef};
use leaves::{Parts, Ticking};

/// A robot whose task is written as tables, with any tree and with [`Skills`] `K` of its own.
///
/// It reads the sensors and carries out the operators of its tables through [`Equipment`]. The
/// memory `M` is a [`Memory`] of the tree; `S`, `N` and `P` are the sizes of a [`TableTask`]. Its
/// inference nodes share one preference and timeout, so that one of them runs at a time.
///
/// ```
/// use core::num::NonZero;
/// use firmware::prelude::*;
/// use iibt_core::team::{Key, Member};
///
/// static VALVE: Tables = Tables::new(&[Role {
///     name: "valve",
///     sensors: &[Sensor::even("position", Reads::Factor(0), 0.9)],
///     operators: &[Operator::IDLE, Operator::bringing("close", 1, 0.8)],
///     facts: &[Fact::sure("closed", 0, &[1])],
///     aims: &[Aim::new("close", &[0], &[0.0, 1.0])],
///     ..Role::of(&[HiddenFactor::unknown("valve", &["open", "closed"])])
/// }]);
///
/// static TREE: Tree<TaskLeaf<()>, 3> = tree! {
///     Fallback { Condition(TaskLeaf::Fact(0)), Inference(TaskLeaf::Aim(0)) }
/// };
///
/// /// A valve that sticks at the first turn.
/// #[derive(Default)]
/// struct Bench {
///     turns: u32,
///     now: u32,
/// }
///
/// impl Equipment for Bench {
///     fn read(&mut self, _: usize) -> Option<u8> {
///         Some(u8::from(self.turns > 1))
///     }
///     fn is_busy(&mut self) -> bool {
///         false
///     }
///     fn begin(&mut self, command: Command) {
///         assert_eq!(command.operator, 1);
///         self.turns += 1;
///     }
/// }
/// # impl Link for Bench {
/// #     fn receive(&mut self) -> Option<u8> { None }
/// #     fn send(&mut self, _: &[u8]) -> bool { true }
/// # }
/// # impl Clock for Bench {
/// #     fn now(&mut self) -> Instant { self.now += 1; Instant(self.now) }
/// # }
/// // and a `Link` and a `Clock`
///
/// let member = Member::new(RobotId(0), 1)?;
/// let settings = Settings::new(member, Key::new(*b"sixteen bytes..."), 1, NonZero::<u16>::MIN);
/// type Robot = table_robot!(VALVE, Bench, (), 3);
/// let robot = Robot::new(&VALVE, &settings, &TREE, (), Duration(100))?;
/// let mut controller = Controller::new(robot, settings, Bench::default());
/// let ticks = (1..50).find(|_| controller.tick() == Status::Success);
/// assert!(ticks.is_some_and(|ticks| ticks < 20));
/// assert_eq!(controller.hardware().turns, 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias = "blackboard")]
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
    message: Option<TableMessage<K::Message>>,
    hardware: PhantomData<fn(&mut H)>,
}

/// The type of a [`TableRobot`] with as much memory as its tables and its tree take: of the tables,
/// the hardware, the skills, the number of nodes, and the set of nodes unless that is
/// [`Basic`](iibt_core::tree::Basic); with `page` before the number, of a tree of at most so many
/// nodes from a [`PageTree`](crate::page::PageTree).
#[macro_export]
macro_rules! table_robot {
    ($tables:expr, $hardware:ty, $skills:ty, page $nodes:expr) => {
        $crate::TableRobot<
            'static, $hardware, $skills, $crate::page::TreeMemory<{ $nodes }>,
            { $tables.states() }, { $tables.robots() }, { $tables.policies() }, $crate::prelude::Full
        >
    };
    ($tables:expr, $hardware:ty, $skills:ty, $nodes:literal $(, $set:ty)?) => {
        $crate::TableRobot<
            'static, $hardware, $skills, $crate::prelude::Memory<$nodes $(, $set)?>,
            { $tables.states() }, { $tables.robots() }, { $tables.policies() } $(, $set)?
        >
    };
}

impl<'t, H, K, const NODES: usize, const S: usize, const N: usize, const P: usize, Set>
    TableRobot<'t, H, K, Memory<NODES, Set>, S, N, P, Set>
where
    K: Skills<H>,
    Set: Kinds,
{
    /// Creates a robot of a team at the start of its task. Its inference nodes fail when a
    /// precondition stays unmet, or a teammate unconnected, for `timeout`.
    ///
    /// # Errors
    /// [`TablesError`] when the tables have no role for each robot of the team or need more room
    /// than `S`, `N` and `P` give, or when the tree has an aim or a fact that the role has not.
    pub fn new(
        tables: &'t Tables<'t>,
        settings: &Settings,
        tree: &'t Tree<TaskLeaf<K::Leaf>, NODES, Set>,
        skills: K,
        timeout: Duration,
    ) -> Result<Self, TablesError> {
        Self::with_memory(tables, settings, tree.by_ref(), Memory::new(), skills, timeout)
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
        settings: &Settings,
        tree: TreeRef<'t, TaskLeaf<K::Leaf>, Set>,
        memory: M,
        skills: K,
        timeout: Duration,
    ) -> Result<Self, TablesError> {
        let (member, of_team) =
            (settings.member(), |table, reason| TablesError { role: None, table, row: None, reason });
        if member.team() != tables.robots() {
            return Err(of_team("roles", "there is not one for each robot of the team"));
        }
        check(&tree, tables, member.robot())?;
        if memory.as_ref().len() != tree.nodes().len() {
            return Err(of_team("tree", "its memory has not an element for each node"));
        }
        let task = TableTask::new(tables, member.robot(), settings.epoch())?;
        let parts = Parts { skills, task, node: InferenceNode::new(timeout) };
        Ok(Self { tree, memory, parts, percept: Percept::default(), message: None, hardware: PhantomData })
    }

    /// Sets the most work units of a tick; see [`TableTask::set_budget`].
    #[must_use]
    pub fn with_budget(mut self, units: u32) -> Self {
        self.parts.task.set_budget(units);
        self
    }

    /// Returns the task, with its belief and its last decision.
    pub const fn task(&self) -> &TableTask<'t, S, N, P, K::Message> {
        &self.parts.task
    }

    /// Returns the inference node, with what it has raised.
    pub const fn node(&self) -> &InferenceNode<TableTask<'t, S, N, P, K::Message>> {
        &self.parts.node
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
            Some(TaskLeaf::Aim(aim)) => ("aims", usize::from(*aim), aims),
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
    type Message = TableMessage<K::Message>;

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
        let status = tree.tick(memory.as_mut(), &mut Ticking::new(parts, percept, peers, now), now).status;
        self.message = Some(parts.task.announce(peers).with(parts.skills.message()));
        status
    }

    fn act(&mut self, hardware: &mut H) {
        if let Some(command) = self.parts.task.command() {
            hardware.begin(command);
        }
        self.parts.skills.act(hardware);
    }

    fn message(&self) -> Option<Self::Message> {
        self.message.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::num::NonZero;
    use iibt_core::iibt::table::{Aim, Command, Fact, HiddenFactor, Operator, Reads, Role, Sensor};
    use iibt_core::team::{Key, Limits, Member, Message, Roster};
    use iibt_core::tree;
    use iibt_core::tree::{Full, Halt};
    use serde::{Deserialize, Serialize};
    use std::string::ToString;
    use std::vec;
    use std::vec::Vec;

    const TURN: u8 = 1;

    static VALVE: Tables = Tables::new(&[Role {
        name: "valve",
        sensors: &[Sensor::even("position", Reads::Factor(0), 0.999)],
        operators: &[Operator::IDLE, Operator::bringing("turn", 1, 0.8)],
        facts: &[Fact::sure("closed", 0, &[1])],
        aims: &[Aim::new("close", &[0], &[0.0, 1.0])],
        ..Role::of(&[HiddenFactor::unknown("valve", &["open", "closed"])])
    }]);

    /// The leaves are what the skills are told to return.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    enum Leaf {
        Turn,
        Choose,
        Return(Status),
    }

    #[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
    struct Choice(usize);

    impl Message for Choice {
        const SCHEMA: &'static str = "choice usize";
        const MAX_BYTES: usize = 5;
    }

    /// Which child is chosen, and what was asked.
    struct Asked(usize, Vec<&'static str>);

    impl Skills<Valve> for Asked {
        type Leaf = Leaf;
        type Message = Choice;

        fn sense(&mut self, _: &mut Valve, _: Instant) {
            self.1.push("sense");
        }
        fn message(&self) -> Choice {
            Choice(self.0)
        }
        fn on_running(&mut self, leaf: &Leaf, turn: &mut Turn<'_, Choice>) -> Status {
            self.1.push("run");
            match *leaf {
                Leaf::Turn if turn.is_settled && turn.sure(0) == Some(0) => turn.begin(TURN, None),
                Leaf::Return(status) => return status,
                _ => {}
            }
            Status::Running
        }
        fn on_halted(&mut self, _: &Leaf, _: &mut Turn<'_, Choice>) -> Halt {
            self.1.push("halt");
            Halt::Pending
        }
        fn on_halting(&mut self, _: &Leaf, _: &mut Turn<'_, Choice>) -> Halt {
            self.1.push("still");
            Halt::Done
        }
        fn case(&mut self, _: &Leaf, _: &Turn<'_, Choice>) -> usize {
            self.0
        }
        fn act(&mut self, _: &mut Valve) {
            self.1.push("act");
        }
    }

    /// What it reads, and the operators that it began.
    #[derive(Default)]
    struct Valve(u8, Vec<u8>);

    impl Equipment for Valve {
        fn read(&mut self, sensor: usize) -> Option<u8> {
            assert_eq!(sensor, 0, "the tables have one sensor");
            Some(self.0)
        }
        fn is_busy(&mut self) -> bool {
            false
        }
        fn begin(&mut self, command: Command) {
            self.1.push(command.operator);
        }
    }

    type OneValve<const NODES: usize> = TableRobot<'static, Valve, Asked, Memory<NODES, Full>, 2, 1, 2, Full>;

    fn settings(team: usize) -> Settings {
        let member = Member::new(RobotId(0), team).expect("it is in its team");
        Settings::new(member, Key::new([7; 16]), 1, NonZero::<u16>::MIN)
    }

    fn robot<const NODES: usize>(
        tree: &'static Tree<TaskLeaf<Leaf>, NODES, Full>,
    ) -> Result<OneValve<NODES>, TablesError> {
        TableRobot::new(&VALVE, &settings(1), tree, Asked(0, vec![]), Duration(100))
    }

    /// Ticks a robot that is alone, as the controller does.
    fn tick<const NODES: usize>(robot: &mut OneValve<NODES>, valve: &mut Valve, now: u32) -> Status {
        let (member, limits) = (Member::new(RobotId(0), 1), Limits::for_beacons(Duration(1)));
        let alone = Roster::new(member.expect("a team of one"), limits.expect("a tick is short"));
        robot.sense(valve, Instant(now));
        let status = robot.tick(alone.at(Instant(now)), Instant(now));
        robot.act(valve);
        status
    }

    #[test]
    fn a_tree_that_does_not_fit_its_tables_is_refused() {
        static AIM: Tree<TaskLeaf<Leaf>, 1, Full> = tree! { Inference(TaskLeaf::Aim(1)) };
        static FACT: Tree<TaskLeaf<Leaf>, 2, Full> =
            tree! { Precondition(TaskLeaf::Fact(7), Status::Skipped) { Action(TaskLeaf::Own(Leaf::Turn)) } };
        let error = robot(&AIM).err().map(|error| error.to_string());
        assert_eq!(error.as_deref(), Some("roles[0].aims[1]: the tree names one that there is not"));
        let error = robot(&FACT).err().map(|error| error.to_string());
        assert_eq!(error.as_deref(), Some("roles[0].facts[7]: the tree names one that there is not"));

        static SOUND: Tree<TaskLeaf<()>, 1> = tree! { Inference(TaskLeaf::Aim(0)) };
        let of = |nodes| {
            let memory = vec![NodeMemory::NEW; nodes];
            let (alone, timeout) = (settings(1), Duration(100));
            let robot: Result<TableRobot<'_, Valve, (), _, 2, 1, 2>, _> =
                TableRobot::with_memory(&VALVE, &alone, SOUND.by_ref(), memory, (), timeout);
            robot.err().map(|error| error.to_string())
        };
        assert_eq!(of(2).as_deref(), Some("tree: its memory has not an element for each node"));
        assert_eq!(of(1), None);
    }

    #[test]
    fn own_leaves_live_as_those_of_any_tree() {
        static TREE: Tree<TaskLeaf<Leaf>, 4, Full> = tree! {
            Switch(TaskLeaf::Own(Leaf::Choose)) {
                Action(TaskLeaf::Own(Leaf::Turn)),
                Action(TaskLeaf::Own(Leaf::Return(Status::Success))),
                AlwaysFailure(),
            }
        };
        let (mut robot, mut valve) = (robot(&TREE).expect("it fits"), Valve::default());
        let mut asked = |robot: &mut OneValve<4>, case, now| {
            robot.parts.skills.0 = case;
            let status = tick(robot, &mut valve, now);
            (status, core::mem::take(&mut robot.parts.skills.1), valve.1.len())
        };
        assert_eq!(asked(&mut robot, 0, 0), (Status::Running, vec!["sense", "run", "act"], 1));
        assert_eq!(robot.running(), Some(&TaskLeaf::Own(Leaf::Turn)));
        assert_eq!(robot.message().unwrap().own, Choice(0));
        assert_eq!(asked(&mut robot, 1, 1), (Status::Running, vec!["sense", "halt", "act"], 1));
        let (status, calls, _) = asked(&mut robot, 1, 2);
        assert_eq!((status, calls), (Status::Success, vec!["sense", "still", "run", "act"]));
    }

    #[test]
    fn an_operator_that_is_halted_in_its_tick_is_not_carried_out() {
        static TREE: Tree<TaskLeaf<Leaf>, 3, Full> = tree! {
            Parallel(2, 1) {
                Action(TaskLeaf::Own(Leaf::Turn)), Action(TaskLeaf::Own(Leaf::Return(Status::Failure)))
            }
        };
        let (mut robot, mut valve) = (robot(&TREE).expect("it fits"), Valve::default());
        tick(&mut robot, &mut valve, 0);
        assert_eq!(valve.1, [0; 0]);
        assert!(robot.parts.skills.1.contains(&"halt"), "{:?}", robot.parts.skills.1);
    }

    #[test]
    fn an_aim_is_a_condition_and_an_inference_node() {
        static TREE: Tree<TaskLeaf<Leaf>, 4, Full> = tree! {
            Fallback { Condition(TaskLeaf::Aim(0)), ForceFailure { Inference(TaskLeaf::Aim(0)) } }
        };
        let (mut robot, mut valve) = (robot(&TREE).expect("it fits"), Valve::default());
        assert_eq!(tick(&mut robot, &mut valve, 0), Status::Running);
        assert_eq!((robot.running(), &valve.1), (Some(&TaskLeaf::Aim(0)), &vec![TURN]));
        valve.0 = 1;
        assert_eq!(tick(&mut robot, &mut valve, 1), Status::Failure, "of the node, which has succeeded");
        assert_eq!(tick(&mut robot, &mut valve, 2), Status::Success, "by the condition");
        assert_eq!(valve.1.len(), 1);
    }
}
