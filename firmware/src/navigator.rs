//! The robot of a navigating team.

use crate::hardware::{Battery, Drive, Localiser, Scanner};
use crate::tree_trace::TreeTrace;
use crate::{Robot, Settings};
use iibt_core::iibt::InferenceNode;
use iibt_core::navigation::{GridPercept, Intention, Mission, MissionError, Navigation};
use iibt_core::team::{Invalid, Peers};
use iibt_core::time::{Duration, Instant};
use iibt_core::tree;
#[cfg(feature = "explain")]
use iibt_core::tree::TickEntry;
use iibt_core::tree::{Halt, Leaves, Memory, Status, StatusChange, Tree};

/// The leaves of the tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Skill {
    BatteryEnough,
    Recharge,
    MoveToGoal,
}

impl Skill {
    const fn name(self) -> &'static str {
        match self {
            Self::BatteryEnough => "BatteryEnough",
            Self::Recharge => "Recharge",
            Self::MoveToGoal => "MoveToGoal",
        }
    }
}

/// The number of nodes of the tree.
const NODES: usize = 5;

/// The tree of the paper's table 3: one inference node in the place of sixteen ordinary ones.
#[rustfmt::skip]
static TREE: Tree<Skill, NODES> = tree! {
    ReactiveSequence {
        Fallback {
            Condition(Skill::BatteryEnough),
            Action(Skill::Recharge),
        },
        Inference(Skill::MoveToGoal),
    }
};

/// A robot of a navigating team, for maps of up to `S` cells in `W` words, plans of less than `L`
/// steps, searches of up to `M` nodes and up to `K` joint policies.
///
/// `W` is [`words`](iibt_core::grid::words) of the map's width and height. Robots of a team have
/// the same `L`, `M` and `K`, whatever their `S`. On 64 cells, 33 steps, 64 nodes and 16 policies
/// serve eight robots.
#[derive(Clone, Debug)]
pub struct Navigator<'m, const S: usize, const W: usize, const L: usize, const M: usize, const K: usize> {
    memory: Memory<NODES>,
    trace: TreeTrace,
    blackboard: Blackboard<'m, S, W, L, M, K>,
    percept: GridPercept,
    message: Option<Intention<W, K>>,
    /// The ticks in which the message was that of the tick before, up to now.
    repeated: u8,
}

/// The repetitions of a message after which frames of teammates take turns with it. At 30 % loss,
/// 119 of 120 teammates have heard it by then.
const REPETITIONS: u8 = 3;

/// What the leaves share.
#[derive(Clone, Debug)]
struct Blackboard<'m, const S: usize, const W: usize, const L: usize, const M: usize, const K: usize> {
    navigation: Navigation<'m, S, W, L, M, K>,
    node: InferenceNode<Navigation<'m, S, W, L, M, K>>,
    charge: u8,
    thresholds: Thresholds,
}

/// The charges in percent at which a robot leaves its team and comes back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Thresholds {
    /// Below this it leaves the team to charge.
    pub low: u8,
    /// At this it comes back.
    pub charged: u8,
}

impl Thresholds {
    /// Leaves below 20 %, comes back at 90 %.
    pub const DEFAULT: Self = Self { low: 20, charged: 90 };
}

impl<'m, const S: usize, const W: usize, const L: usize, const M: usize, const K: usize>
    Navigator<'m, S, W, L, M, K>
{
    /// The timeout of the inference node in ticks: how long a precondition may stay unmet before
    /// the node fails.
    pub const TIMEOUT_TICKS: u32 = 100;

    /// Creates a robot at the start of its mission.
    ///
    /// # Errors
    /// As [`start`](Self::start).
    pub fn new(mission: &'m Mission<'m, W>, settings: &Settings) -> Result<Self, MissionError> {
        let mut new = Self::idle();
        new.start(mission, settings)?;
        Ok(new)
    }

    /// Creates a robot without a mission, which does and says nothing until its
    /// [`start`](Self::start): for a robot that is built in a `static`, see
    /// [`Controller::start`](crate::Controller::start).
    #[inline(always)] // built where it is to be, not on the stack
    #[must_use]
    pub const fn idle() -> Self {
        Self {
            memory: Memory::new(),
            trace: TreeTrace::new(),
            blackboard: Blackboard {
                navigation: Navigation::idle(),
                node: InferenceNode::new(Duration(0)),
                charge: 100,
                thresholds: Thresholds::DEFAULT,
            },
            percept: GridPercept::NONE,
            message: None,
            repeated: 0,
        }
    }

    /// Starts a robot that has no mission yet.
    ///
    /// # Errors
    /// [`MissionError`] when the mission does not fit the sizes, the robot is not in its team, or
    /// it has been started already; it is then as it was.
    pub fn start(&mut self, mission: &'m Mission<'m, W>, settings: &Settings) -> Result<(), MissionError> {
        self.blackboard.navigation.start(mission, settings.member(), settings.epoch())?;
        let timeout = settings.tick().0.saturating_mul(Self::TIMEOUT_TICKS);
        self.blackboard.node = InferenceNode::new(Duration(timeout));
        Ok(())
    }

    /// Sets the battery thresholds.
    pub const fn set_thresholds(&mut self, thresholds: Thresholds) {
        self.blackboard.thresholds = thresholds;
    }

    /// Returns the task of the inference node, with its last decision.
    #[must_use]
    pub const fn navigation(&self) -> &Navigation<'m, S, W, L, M, K> {
        &self.blackboard.navigation
    }

    /// Returns the task for instructions: way-points and preferences for goals.
    pub const fn navigation_mut(&mut self) -> &mut Navigation<'m, S, W, L, M, K> {
        &mut self.blackboard.navigation
    }

    /// Sets the most work units of a tick; see [`Navigation::set_budget`].
    #[must_use]
    pub fn with_budget(mut self, units: u32) -> Self {
        self.blackboard.navigation.set_budget(units);
        self
    }

    /// Returns which nodes of the tree the last tick has changed; `None` when they are those of the
    /// tick before. With the feature `explain` only.
    #[cfg(feature = "explain")]
    #[must_use]
    pub fn tree_entry(&self) -> Option<TickEntry<'_>> {
        self.trace.entry()
    }

    /// Returns the name of the running leaf.
    #[must_use]
    pub fn activity(&self) -> Option<&'static str> {
        TREE.running(&self.memory).map(|skill| skill.name())
    }
}

impl<'m, H, const S: usize, const W: usize, const L: usize, const M: usize, const K: usize> Robot<H>
    for Navigator<'m, S, W, L, M, K>
where
    H: Drive + Localiser + Scanner + Battery,
{
    type Message = Intention<W, K>;

    fn mission(&self) -> u64 {
        self.blackboard.navigation.mission_id()
    }

    fn accepts(&self, intention: &Intention<W, K>) -> Result<(), Invalid> {
        self.blackboard.navigation.accepts(intention)
    }

    fn sense(&mut self, hardware: &mut H, _: Instant) {
        self.blackboard.charge = hardware.charge();
        self.percept.reading = hardware.locate();
        self.percept.moving = hardware.is_moving();
        self.percept.hazards.clear();
        while !self.percept.hazards.is_full() {
            let Some(hazard) = hardware.scan() else { break };
            // There is room: the list is not full.
            let _ = self.percept.hazards.push(hazard);
        }
        self.percept.readings.clear();
        while !self.percept.moving && !self.percept.readings.is_full() {
            let Some(reading) = hardware.recognise() else { break };
            // There is room: the list is not full.
            let _ = self.percept.readings.push(reading);
        }
        self.percept.sightings.clear();
        while !self.percept.sightings.is_full() {
            let Some(sighting) = hardware.sight() else { break };
            // There is room: the list is not full.
            let _ = self.percept.sightings.push(sighting);
        }
        self.percept.clear.clear();
        for cell in self.blackboard.navigation.watched().filter(|&cell| hardware.is_clear(cell)) {
            // Without room, a cell that is still clear is told at a later tick.
            let _ = self.percept.clear.push(cell);
        }
    }

    fn tick(&mut self, peers: Peers<'_, Intention<W, K>>, now: Instant) -> Status {
        let Self { memory, trace, blackboard, percept, .. } = self;
        let mut leaves = NavigatorLeaves { blackboard, percept, trace, peers };
        let status = TREE.tick(memory, &mut leaves, now).status;
        self.trace.end_tick(now);
        let message = self.blackboard.navigation.intention(peers);
        self.repeated = if message == self.message { self.repeated.saturating_add(1) } else { 0 };
        self.message = message;
        status
    }

    fn act(&mut self, hardware: &mut H) {
        if let Some(step) = self.blackboard.navigation.command() {
            hardware.go(step);
        }
    }

    fn message(&self) -> Option<Intention<W, K>> {
        self.message.clone()
    }

    fn repeats_itself(&self) -> bool {
        self.repeated >= REPETITIONS
    }
}

/// The leaves in a tick: the blackboard, with what was sensed and heard.
struct NavigatorLeaves<'t, 'm, const S: usize, const W: usize, const L: usize, const M: usize, const K: usize>
{
    blackboard: &'t mut Blackboard<'m, S, W, L, M, K>,
    percept: &'t GridPercept,
    trace: &'t mut TreeTrace,
    peers: Peers<'t, Intention<W, K>>,
}

impl<const S: usize, const W: usize, const L: usize, const M: usize, const K: usize>
    NavigatorLeaves<'_, '_, S, W, L, M, K>
{
    /// Drives to the charger with the team's consent, and stands there until the battery is
    /// charged.
    fn recharge(&mut self, now: Instant) -> Status {
        if self.blackboard.charge >= self.blackboard.thresholds.charged {
            self.blackboard.navigation.set_charging(false);
            return Status::Success;
        }
        self.blackboard.navigation.set_charging(true);
        match self.decide(now) {
            Status::Failure => Status::Failure,
            // It is not done before the battery is charged.
            _ => Status::Running,
        }
    }

    fn decide(&mut self, now: Instant) -> Status {
        let Blackboard { navigation, node, .. } = &mut *self.blackboard;
        node.tick(navigation, self.percept, self.peers, now)
    }
}

impl<const S: usize, const W: usize, const L: usize, const M: usize, const K: usize> Leaves<Skill>
    for NavigatorLeaves<'_, '_, S, W, L, M, K>
{
    fn condition(&mut self, leaf: &Skill, _: Instant) -> bool {
        *leaf == Skill::BatteryEnough && self.blackboard.charge >= self.blackboard.thresholds.low
    }

    fn on_running(&mut self, leaf: &Skill, now: Instant) -> Status {
        match leaf {
            Skill::MoveToGoal => self.decide(now),
            Skill::Recharge => self.recharge(now),
            Skill::BatteryEnough => Status::Failure,
        }
    }

    fn on_halted(&mut self, leaf: &Skill, _: Instant) -> Halt {
        match leaf {
            Skill::MoveToGoal => self.blackboard.node.halt(&mut self.blackboard.navigation),
            Skill::Recharge | Skill::BatteryEnough => {}
        }
        Halt::Done
    }

    fn transition(&mut self, change: StatusChange) {
        self.trace.record(change);
    }
}
