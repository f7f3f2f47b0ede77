//! One robot of a navigating team, tick by tick.

mod course;
mod decision;
mod doubt;
mod errands;
mod outlook;
mod perception;

use super::errands::Waypoints;
use super::fact::Fact;
use super::handover::Handover;
use super::obstacles::Obstacles;
use super::policies::{OnMap, Policies, TeamPlan};
use super::progress::{Passage, Progress};
use super::readings::{AnnouncedReadings, Readings};
use super::strangers::{Sighting, Strangers};
use super::unknown::{self, MAX_UNKNOWNS, MAX_WORLDS, Reading};
use super::{
    Announced, Cause, Intention, Localisation, MAX_GOALS, MAX_OBSTACLES, Mission, MissionError, Purpose,
};
use crate::grid::{Cell, CellSet, Move};
use crate::inference::WeighedPolicies;
use crate::team::rounds::{Digest, Rounds, Waiting};
use crate::team::{Fnv1a, Invalid, Member, RobotId};
use heapless::Vec;
use outlook::OwnOutlook;

/// The most obstacles that a robot takes in at a tick.
pub const MAX_HAZARDS: usize = 4;

/// The most readings of unknowns that a robot takes in at a tick.
pub const MAX_READINGS: usize = 4;

/// What a navigating robot senses in a tick.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct GridPercept {
    /// A reading of the robot's own cell, which may be missing or wrong.
    pub reading: Option<Cell>,
    /// Cells in view that no robot can enter.
    pub hazards: Vec<Cell, MAX_HAZARDS>,
    /// Cells in view that are free, of those that were reported as blocked before.
    pub clear: Vec<Cell, MAX_OBSTACLES>,
    /// What was read of the unknowns of the mission from where the robot stands.
    pub readings: Vec<Reading, MAX_READINGS>,
    /// Where strangers are seen now, at most one for each [unknown](super::Effect::Takes).
    pub sightings: Vec<Sighting, MAX_UNKNOWNS>,
    /// Whether the last move is still going on; no reading is used then.
    pub moving: bool,
}

impl GridPercept {
    /// Nothing sensed.
    pub const NONE: Self = Self {
        reading: None,
        hazards: Vec::new(),
        clear: Vec::new(),
        readings: Vec::new(),
        sightings: Vec::new(),
        moving: false,
    };
}

/// The task of a robot in a navigating team: to reach goals with its teammates, by one joint plan.
///
/// For maps of up to `S` cells in `W` words, plans of less than `L` steps, searches of up to `M`
/// nodes and up to `K` joint policies. Robots of a team have the same `L`, `M` and `K`: what they
/// plan depends on them, and others reject their frames. The team has at most
/// [`MAX_TEAM`](crate::team::MAX_TEAM) robots.
///
/// With `L` = 0 a robot has no planner: it and its teammates choose among the
/// [paths given by hand](Mission::paths), and what is left of them from where they stand. Where
/// these have no conflict-free combination to goals, all stand. The planner, a third of the code of
/// an image, is then not linked.
#[doc(alias = "multi-agent path finding")]
#[doc(alias = "multi-robot navigation")]
#[derive(Clone, Debug)]
pub struct Navigation<'m, const S: usize, const W: usize, const L: usize, const M: usize, const K: usize> {
    mission: &'m Mission<'m, W>,
    member: Member,
    epoch: u32,
    /// The work units of a tick.
    budget: u32,
    /// Those that are left of this tick.
    left: u32,
    localisation: Localisation<S>,
    obstacles: Obstacles,
    readings: Readings,
    strangers: Strangers,
    watched: CellSet<W>,
    /// Where something is in view now, or a stranger may come to in this tick.
    seen: CellSet<W>,
    /// What of it may be teammates.
    mates_in_view: CellSet<W>,
    waypoints: Waypoints,
    handover: Handover<S, W>,
    charges: bool,
    goal_values: [f32; MAX_GOALS],
    /// `None` until the robot first knows where it stands: it has nothing true to say before.
    rounds: Option<Rounds<Fact<W>, K>>,
    policies: Policies<S, W, L, M, K>,
    /// What the policies are being made from.
    listing: Option<Digest>,
    weighed: WeighedPolicies<K>,
    /// What the robot makes of the plan by what it has read since.
    outlook: OwnOutlook,
    moving: bool,
    /// Whether another robot with the number of this one has been heard: it stands then.
    has_twin: bool,
    /// The move that the robot makes, from the command until it knows where that has led.
    under_way: Option<Passage>,
    progress: Progress,
    /// Whether the next move of the plan could lead to where a teammate may be, from where a robot
    /// in doubt may be.
    is_held: bool,
    /// The move to try in its place.
    trial: Option<Passage>,
    command: Option<Move>,
    waiting: Option<Waiting>,
    /// Why another round is wanted.
    wanted: Option<Cause>,
    cause: Option<Cause>,
}

impl<'m, const S: usize, const W: usize, const L: usize, const M: usize, const K: usize>
    Navigation<'m, S, W, L, M, K>
{
    /// Whether the robot has a planner, and with it errands.
    const PLANS: bool = L > 0;

    /// The work units of a tick unless [`set_budget`](Self::set_budget) says otherwise.
    pub const BUDGET: u32 = 1_000;

    /// Creates a robot of the mission's team that has been switched on for the `epoch`-th time.
    ///
    /// # Errors
    /// As [`start`](Self::start).
    pub fn new(mission: &'m Mission<'m, W>, member: Member, epoch: u32) -> Result<Self, MissionError> {
        let mut new = Self::idle();
        new.start(mission, member, epoch)?;
        Ok(new)
    }

    /// Creates a robot without a mission, which does and says nothing until its
    /// [`start`](Self::start).
    ///
    /// A robot takes kilobytes: where the stack is small, let one that lies in a `static` begin as
    /// this one, and start it there.
    #[inline(always)] // built where it is to be, not on the stack
    #[must_use]
    pub const fn idle() -> Self {
        Self {
            mission: Mission::NONE,
            member: Member::ALONE,
            epoch: 0,
            budget: Self::BUDGET,
            left: Self::BUDGET,
            localisation: Localisation::idle(),
            obstacles: Obstacles::NONE,
            readings: Readings::NONE,
            strangers: Strangers::NONE,
            outlook: OwnOutlook::NONE,
            watched: CellSet::EMPTY,
            seen: CellSet::EMPTY,
            mates_in_view: CellSet::EMPTY,
            waypoints: Waypoints::NONE,
            handover: Handover::NONE,
            charges: false,
            goal_values: [1.0; MAX_GOALS],
            rounds: None,
            policies: Policies::new(),
            listing: None,
            weighed: WeighedPolicies::NONE,
            moving: false,
            has_twin: false,
            under_way: None,
            progress: Progress::NONE,
            is_held: false,
            trial: None,
            command: None,
            waiting: None,
            wanted: None,
            cause: None,
        }
    }

    /// Starts a robot that has no mission yet, switched on for the `epoch`-th time. The first time
    /// it takes its start in the mission for likely; later only its localiser tells where it is.
    ///
    /// # Errors
    /// [`MissionError`] when the mission does not fit the sizes, the robot is not in its team, or
    /// it has been started already; it is then as it was.
    pub fn start(
        &mut self,
        mission: &'m Mission<'m, W>,
        member: Member,
        epoch: u32,
    ) -> Result<(), MissionError> {
        mission.check::<S>()?;
        if !Intention::<W, K>::has_room_for(mission.unknowns) {
            return Err(MissionError::UnknownCount);
        }
        if !Self::PLANS && !mission.needs_no_planner() {
            return Err(MissionError::NoPlanner);
        }
        if member.team() != mission.starts.len() {
            return Err(MissionError::TeamSize);
        }
        if !self.mission.starts.is_empty() {
            return Err(MissionError::Started);
        }
        let robot = member.robot();
        let start = mission.starts.get(robot.index()).copied().ok_or(MissionError::NoSuchRobot)?;
        // A robot that has started before was wherever it was: its localiser knows, the mission
        // does not.
        let start = Some(start).filter(|_| epoch <= 1);
        self.localisation.start(&mission.map, start, mission.sensor_of(robot), mission.learning);
        (self.mission, self.member, self.epoch) = (mission, member, epoch);
        Ok(())
    }

    /// Sets the most work units of a tick. A unit is one layer sweep or cancel of the planner, one
    /// call of the search, or one distance table; what is left is done in the next tick.
    pub const fn set_budget(&mut self, units: u32) {
        self.budget = units;
    }

    /// Sets the preference for each goal, in the order of the mission: 1 at the most, lower by a
    /// nat for a goal that serves e times less often. Other values count as 1.
    ///
    /// It counts in each of the 32 ticks for which a robot is taken to stand on its goal: for a
    /// goal that is better by a tenth of a nat, the team is up to 3 ticks later.
    pub fn set_goal_preferences(&mut self, values: &[f32; MAX_GOALS]) {
        self.goal_values = values.map(|value| if value > 0.0 && value <= 1.0 { value } else { 1.0 });
    }

    /// Tells the robot whether to charge its battery before anything else.
    pub const fn set_charging(&mut self, charges: bool) {
        self.charges = charges;
    }

    /// Checks a teammate's message against the mission.
    ///
    /// # Errors
    /// [`Invalid`] with the first value that does not fit.
    pub fn accepts(&self, intention: &Intention<W, K>) -> Result<(), Invalid> {
        intention.check(self.member.team(), self.mission.map.len())
    }

    /// Returns a hash of the mission and of all that the robot's plans depend on. Robots with
    /// another one reject each other's frames.
    #[must_use]
    pub fn mission_id(&self) -> u64 {
        let generator = Policies::<S, W, L, M, K>::fingerprint(self.mission);
        Fnv1a::EMPTY.write(&self.mission.id().to_le_bytes()).write(&generator.to_le_bytes()).finish()
    }

    /// Returns the move to make now.
    #[must_use]
    pub const fn command(&self) -> Option<Move> {
        self.command
    }

    /// Returns the belief about its own position.
    #[must_use]
    pub const fn localisation(&self) -> &Localisation<S> {
        &self.localisation
    }

    /// Returns the cells of which any robot has told that they are blocked: those that are worth a
    /// look.
    pub fn watched(&self) -> impl Iterator<Item = Cell> + '_ {
        self.watched.iter()
    }

    /// Returns the cells that the robot takes for blocked by what it has seen itself.
    pub fn hazards(&self) -> impl Iterator<Item = Cell> + '_ {
        self.obstacles.blocked()
    }

    /// Returns the joint policies of the present round, as far as they are made.
    #[must_use]
    pub fn policies(&self) -> &[TeamPlan] {
        self.policies.plans()
    }

    /// Returns the first cell on what is left of the robot's path from where it sees something that
    /// no member knew when the plan was made.
    #[must_use]
    pub fn look_out(&self) -> Option<Cell> {
        let (path, moves) = self.course()?;
        self.policies.look_out(&self.mission.map, path, moves)
    }

    /// Returns the probability of each world, by what all members had read when the round began and
    /// this robot has read since. A world is a value for each unknown, the last of which changes
    /// fastest; there is none where nothing is unknown.
    #[must_use]
    pub fn worlds(&self) -> Vec<f32, MAX_WORLDS> {
        self.belief()
    }

    /// Returns the posterior over the joint policies, and what each costs; empty before the choice.
    #[must_use]
    pub const fn weighed(&self) -> &WeighedPolicies<K> {
        &self.weighed
    }

    /// Returns the rounds; `None` until the robot first knows where it stands.
    #[must_use]
    pub const fn rounds(&self) -> Option<&Rounds<Fact<W>, K>> {
        self.rounds.as_ref()
    }

    /// Returns what the robot waits for.
    #[must_use]
    pub const fn waiting(&self) -> Option<Waiting> {
        self.waiting
    }

    /// Returns why the robot opened its round, if it did.
    #[must_use]
    pub const fn cause(&self) -> Option<Cause> {
        self.cause
    }

    /// Returns why the robots do not come to all their targets by this plan.
    #[must_use]
    pub fn failure(&self) -> Option<crate::grid::joint::Failure> {
        self.policies.failure()
    }

    pub(super) fn on_map(&self) -> Option<OnMap<'_, W, K>> {
        let view = self.rounds.as_ref()?.proposal().view;
        Some(self.policies.on_map(self.mission, view))
    }

    pub(super) const fn mission(&self) -> &'m Mission<'m, W> {
        self.mission
    }

    pub(super) const fn robot(&self) -> RobotId {
        self.member.robot()
    }

    pub(super) fn is_blocked(&self, cell: Cell) -> bool {
        self.obstacles.is_blocked(cell)
    }

    /// Whether a teammate has answered this start; one that has not may be a recording.
    fn has_answered(&self, robot: RobotId) -> bool {
        self.rounds.as_ref().is_some_and(|rounds| rounds.protocol().has_answered(robot))
    }

    /// The cell that the robot stands on, between no two others.
    pub(super) fn standing(&self) -> Option<Cell> {
        self.localisation.here().filter(|_| !self.moving && self.under_way.is_none())
    }

    /// What the robot is for now.
    pub(super) fn purpose(&self) -> Purpose {
        if self.is_stuck() {
            return Purpose::Stand;
        }
        if self.charges {
            let charger = self.mission.charger(self.robot()).filter(|_| Self::PLANS);
            return charger.map_or(Purpose::Stand, Purpose::Charge);
        }
        if !Self::PLANS {
            return Purpose::Goal;
        }
        self.waypoints.next(|cell| self.is_blocked(cell)).map_or(Purpose::Goal, Purpose::Visit)
    }

    fn fact(&self, anchor: Cell, purpose: Purpose) -> Fact<W> {
        let shares = self.mission.decider().shares();
        let readings = if shares { self.told() } else { AnnouncedReadings::new() };
        let evidence = self.evidence(Intention::<W, K>::places_beside(readings.len()));
        Fact { anchor, purpose, evidence, readings }
    }

    /// The evidence about at most so many cells that the robot announces now: about obstacles, and
    /// before that the cells on which it may be while it is in doubt.
    fn evidence(&self, most: usize) -> Announced {
        match self.trail() {
            [] => self.obstacles.strongest(most),
            trail => self.obstacles.with_claims(trail).strongest(most),
        }
    }

    /// What the robot tells of the unknowns that it has read: nothing as long as it has to tell
    /// where it may be.
    fn told(&self) -> AnnouncedReadings {
        let values = unknown::values(self.mission.unknowns);
        if self.trail().is_empty() { self.readings.announced(values) } else { AnnouncedReadings::new() }
    }

    /// The cells on which a robot in doubt may be, where there are others whom that concerns.
    fn trail(&self) -> &[Cell] {
        if self.member.team() == 1 { &[] } else { self.progress.trail() }
    }
}
