//! The two doors of an airlock, as docs/your-robot.md builds them: own task, own tree, own message.
#![no_std]

use firmware::Robot;
use firmware::hardware::Battery;
use iibt_core::iibt::table::{
    Accuracy, Aim, Announcement, Effect, Fact, HiddenFactor, Holds, Labels, Operator, Percept, Postcondition,
    Reads, Role, Sensor, TableTask, Tables, TablesError, Wish,
};
use iibt_core::iibt::{InferenceNode, Task as _};
use iibt_core::team::{Message, Peers, RobotId};
use iibt_core::time::{Duration, Instant};
use iibt_core::tree::{Halt, Leaves, Memory, Status, Tree};
use serde::{Deserialize, Serialize};

/// The parts that both doors share: a leaf that is open or shut, and a switch that is right nine
/// times in ten.
const DOOR: Role = Role {
    name: "door",
    factors: &[HiddenFactor { name: "leaf", states: &["open", "shut"], prior: &[0.5, 0.5] }],
    states: Labels { names: &["open", "shut"], factors: &[0], table: &[0, 1] },
    sensors: &[Sensor { name: "switch", reads: Reads::Factor(0), accuracy: Accuracy::Even(0.9) }],
    operators: &[],
    idle: 1,
    facts: &[],
    remedies: &[],
    aims: &[],
    outcome: None,
};

/// A drive that brings the leaf to `end` nine times in ten, unless it is there: fact 0.
const fn drive(end: u8, effects: &'static [Effect<'static>], requires: &'static [u8]) -> Operator<'static> {
    let brings = Postcondition::State(end, 0.9);
    Operator { name: "drive", requires, forbids: &[0], brings, effects, success: 0.9, habit: 0.0 }
}

/// The inner door shuts; the outer one opens once the inner one has announced that it is shut.
pub static AIRLOCK: Tables = Tables::new(&[
    Role {
        name: "inner",
        operators: &[drive(1, &[Effect::set(0, 1)], &[]), Operator::IDLE],
        facts: &[Fact { name: "shut", holds: Holds::Sure { factor: 0, states: &[1] } }],
        aims: &[aim(&[0.0, 1.0])],
        ..DOOR
    },
    Role {
        name: "outer",
        operators: &[drive(0, &[Effect::set(0, 0)], &[1]), Operator::IDLE],
        facts: &[
            Fact { name: "open", holds: Holds::Sure { factor: 0, states: &[0] } },
            Fact { name: "inner shut", holds: Holds::Announced { robot: 0, factor: 0, states: &[1] } },
        ],
        aims: &[aim(&[1.0, 0.0])],
        ..DOOR
    },
]);

const fn aim(preference: &'static [f32]) -> Aim<'static> {
    Aim { name: "end", done: &[0], preference, teammates: Wish::AsAnnounced, target: None }
}

/// A message between the doors: the announcement of its task, and the charge of its battery.
#[derive(Clone, Serialize, Deserialize)]
pub struct Said {
    /// The task's part.
    task: Announcement,
    /// In percent.
    charge: u8,
}

impl Message for Said {
    const SCHEMA: &'static str = "airlock: table announcement; charge u8";
    const MAX_BYTES: usize = Announcement::MAX_BYTES + 1;
}

impl AsRef<Announcement> for Said {
    fn as_ref(&self) -> &Announcement {
        &self.task
    }
}

/// The leaves of the tree.
#[derive(Clone, Copy)]
enum Leaf {
    BothCharged,
    Move,
}

static TREE: Tree<Leaf, 3> = iibt_core::tree! {
    ReactiveSequence { Condition(Leaf::BothCharged), Inference(Leaf::Move) }
};

type Task = TableTask<'static, { AIRLOCK.states() }, { AIRLOCK.robots() }, { AIRLOCK.policies() }, Said>;

/// A door.
pub struct Door {
    memory: Memory<3>,
    skills: Skills,
}

struct Skills {
    task: Task,
    node: InferenceNode<Task>,
    percept: Percept,
    charge: u8,
}

impl Door {
    /// The inner door, robot 0, or the outer one, robot 1.
    pub fn new(robot: RobotId) -> Result<Self, TablesError> {
        let (task, node) = (Task::new(&AIRLOCK, robot)?, InferenceNode::new(Duration(200)));
        let skills = Skills { task, node, percept: Percept::default(), charge: 0 };
        Ok(Self { memory: Memory::new(), skills })
    }
}

/// The hardware that a door needs besides a link, a clock and a battery.
pub trait DoorHardware {
    /// The reading of the switch: 0 for open, 1 for shut.
    fn switch(&mut self) -> u8;
    /// Whether the drive is still moving the leaf.
    fn is_moving(&mut self) -> bool;
    /// Starts the drive.
    fn start(&mut self);
}

impl<H: DoorHardware + Battery> Robot<H> for Door {
    type Message = Said;

    fn mission(&self) -> u64 {
        AIRLOCK.mission()
    }
    fn sense(&mut self, hardware: &mut H, now: Instant) {
        let percept = &mut self.skills.percept;
        (percept.at, percept.busy) = (now, hardware.is_moving());
        percept.readings[0] = Some(hardware.switch());
        self.skills.charge = hardware.charge();
    }
    fn tick(&mut self, peers: Peers<'_, Said>, now: Instant) -> Status {
        self.skills.task.observe(&self.skills.percept, peers);
        TREE.tick(&mut self.memory, &mut Ticking { skills: &mut self.skills, peers }, now).status
    }
    fn act(&mut self, hardware: &mut H) {
        if self.skills.task.command().is_some() {
            hardware.start();
        }
    }
    fn message(&self) -> Said {
        Said { task: self.skills.task.announcement(), charge: self.skills.charge }
    }
}

/// The skills in a tick, with what was heard.
struct Ticking<'t> {
    skills: &'t mut Skills,
    peers: Peers<'t, Said>,
}

impl Leaves<Leaf> for Ticking<'_> {
    fn condition(&mut self, _: &Leaf, _: Instant) -> bool {
        self.skills.charge > 20 && self.peers.fresh().all(|peer| peer.message().charge > 20)
    }
    fn on_running(&mut self, _: &Leaf, now: Instant) -> Status {
        let Skills { task, node, percept, .. } = &mut *self.skills;
        node.tick(task, percept, self.peers, now)
    }
    fn on_halted(&mut self, _: &Leaf, _: Instant) -> Halt {
        self.skills.node.halt(&mut self.skills.task);
        Halt::Done
    }
}
