//! Fallbacks: a robot whose team is gone fails its leaf in time, so another branch of its tree
//! runs.

use super::*;
use firmware::hardware::{Drive, Localiser};
use firmware::{Robot, Settings};
use host_sim::{Testbed, settings};
use iibt_core::grid::Move;
use iibt_core::iibt::InferenceNode;
use iibt_core::navigation::{GridPercept, Intention};
use iibt_core::team::Peers;
use iibt_core::time::{Duration, Instant};
use iibt_core::tree;
use iibt_core::tree::{Full, Halt, Leaves, Memory, Tree};

/// The leaves of a robot that calls for help where it cannot go on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Skill {
    MoveToGoal,
    CallForHelp,
}

/// The leaf fails once it has waited for the timeout of its node, or at that of a decorator, which
/// counts from its beginning.
static TREE: Tree<Skill, 4, Full> = tree! {
    Fallback {
        Timeout(120) { Inference(Skill::MoveToGoal) },
        Action(Skill::CallForHelp),
    }
};

/// A navigating robot with a tree of its own.
struct Guarded<'m> {
    memory: Memory<4, Full>,
    mind: Mind<'m>,
    percept: GridPercept,
    message: Option<Intention<2, POLICIES>>,
    is_dead: bool,
}

struct Mind<'m> {
    navigation: Task<'m>,
    node: InferenceNode<Task<'m>>,
    /// How often it has called for help.
    calls: u32,
}

impl<'m> Guarded<'m> {
    fn new(mission: &'m Mission<'m, 2>, settings: &Settings, timeout: u32) -> Self {
        let navigation = Navigation::new(mission, settings.member(), settings.epoch());
        let navigation = navigation.expect("a sound mission");
        let node = InferenceNode::new(Duration(timeout));
        Self {
            memory: Memory::new(),
            mind: Mind { navigation, node, calls: 0 },
            percept: GridPercept::NONE,
            message: None,
            is_dead: false,
        }
    }
}

/// The leaves in a tick.
struct InTick<'t, 'm> {
    mind: &'t mut Mind<'m>,
    percept: &'t GridPercept,
    peers: Peers<'t, Intention<2, POLICIES>>,
}

impl Leaves<Skill> for InTick<'_, '_> {
    fn condition(&mut self, _: &Skill, _: Instant) -> bool {
        false
    }

    fn on_running(&mut self, skill: &Skill, now: Instant) -> Status {
        let Mind { navigation, node, calls } = &mut *self.mind;
        match skill {
            Skill::MoveToGoal => node.tick(navigation, self.percept, self.peers, now),
            Skill::CallForHelp => {
                *calls += 1;
                Status::Success
            }
        }
    }

    fn on_halted(&mut self, skill: &Skill, _: Instant) -> Halt {
        if *skill == Skill::MoveToGoal {
            self.mind.node.halt(&mut self.mind.navigation);
        }
        Halt::Done
    }
}

impl Robot<Parts> for Guarded<'_> {
    type Message = Intention<2, POLICIES>;

    fn mission(&self) -> u64 {
        self.mind.navigation.mission_id()
    }

    fn sense(&mut self, parts: &mut Parts, _: Instant) {
        self.is_dead = parts.is_dead;
        self.percept.reading = parts.locate();
        self.percept.moving = parts.is_moving();
    }

    fn tick(&mut self, peers: Peers<'_, Self::Message>, now: Instant) -> Status {
        if self.is_dead {
            self.message = None;
            return Status::Running;
        }
        let mut leaves = InTick { mind: &mut self.mind, percept: &self.percept, peers };
        let status = TREE.tick(&mut self.memory, &mut leaves, now).status;
        self.message = self.mind.navigation.intention(peers);
        status
    }

    fn act(&mut self, parts: &mut Parts) {
        if let Some(step) = self.mind.navigation.command().filter(|_| !self.is_dead) {
            parts.go(step);
        }
    }

    fn message(&self) -> Option<Self::Message> {
        self.message.clone()
    }
}

#[derive(Debug)]
struct Parts {
    /// What its localiser names, and where it stands as long as that works.
    cell: Cell,
    /// Whether the cell that its localiser names stays the same whatever it does.
    is_frozen: bool,
    command: Option<Move>,
    is_dead: bool,
}

impl Drive for Parts {
    fn go(&mut self, step: Move) {
        self.command = Some(step);
    }

    fn is_moving(&mut self) -> bool {
        self.command.is_some()
    }

    fn stop(&mut self) {
        self.command = None;
    }
}

impl Localiser for Parts {
    fn locate(&mut self) -> Option<Cell> {
        Some(self.cell)
    }
}

/// The ticks from a fault to the call for help of the second robot of two, whose node has this
/// timeout; and what it reports then. The fault strikes once it has moved.
fn called_after(fault: fn(&mut Testbed<Guarded<'_>, Parts>), timeout: u32) -> (u32, Report) {
    let mission = Mission::new(open_floor(), &[Cell(0), Cell(6)], &[Cell(45), Cell(46)]);
    let robot = |number: u8| {
        let settings = settings(RobotId(number), 2).expect("a team");
        let cell = mission.starts[usize::from(number)];
        (
            Guarded::new(&mission, &settings, timeout),
            Parts { cell, is_frozen: false, command: None, is_dead: false },
        )
    };
    let mut testbed = Testbed::new([0, 1].map(robot), Radio::default(), 1).expect("a team");
    let mut struck = None;
    while testbed.robots().all(|robot| robot.mind.calls == 0) {
        testbed.tick();
        assert!(testbed.ticks() < 400, "it never calls");
        for robot in 0..2 {
            let parts = testbed.parts_mut(robot);
            let step = parts.command.take().unwrap_or(Move::Wait);
            if !parts.is_frozen {
                parts.cell = mission.map.neighbour(parts.cell, step);
            }
        }
        if testbed.parts(1).cell != mission.starts[1] && struck.is_none() {
            fault(&mut testbed);
            struck = Some(testbed.ticks());
        }
    }
    let second = testbed.robots().nth(1).expect("two robots");
    assert_eq!(second.mind.calls, 1);
    (testbed.ticks() - struck.expect("it has moved"), second.mind.navigation.report())
}

/// The second robot follows its plan as far as that needs no report of the first, and waits.
#[test]
fn a_robot_whose_team_is_gone_calls_for_help_at_the_timeout_of_its_leaf() {
    let death = |testbed: &mut Testbed<Guarded<'_>, Parts>| testbed.parts_mut(0).is_dead = true;
    let (by_decorator, report) = called_after(death, 1_000);
    assert_eq!(report.waiting, Some(Waiting::Quorum(RobotId(0))));
    assert!((100..=120).contains(&by_decorator), "{by_decorator} ticks: the decorator has 120");
    let (by_node, report) = called_after(death, 30);
    assert!(report.waiting.is_some_and(|waiting| waiting.robot() == Some(RobotId(0))), "{report:?}");
    assert!((30..=80).contains(&by_node), "{by_node} ticks: the node has 30");
}

#[test]
fn a_robot_whose_localiser_freezes_calls_for_help_at_the_timeout_of_its_leaf() {
    let freeze = |testbed: &mut Testbed<Guarded<'_>, Parts>| testbed.parts_mut(1).is_frozen = true;
    let (ticks, report) = called_after(freeze, 30);
    assert_eq!((report.stage, report.cause), (Stage::Stuck, Some(Cause::NoProgress)));
    assert!((30..=80).contains(&ticks), "{ticks} ticks: the node has 30");
}
