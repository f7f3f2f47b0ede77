//! The task of a team that goes to different goals on a grid and arrives together.
//!
//! ```text
//! GridPercept ─► belief ─► logic ─► preferences ─► candidates ─► decision ─► agreement ─► command
//!   frames ─► roster ─► intentions ──────────────┴──────────────┘            └─► intention
//! ```
//!
//! [`Navigation`] is the [`Task`](crate::iibt::Task) that the interactive inference node runs. It
//! chooses only when it is its turn in the team's [`Agreement`]; until then its one candidate is to
//! wait, and afterwards to follow what it announced.

mod agreement;
mod alone;
mod assignment;
mod candidates;
mod cause;
mod decision;
mod deliberation;
mod experience;
mod intention;
mod mission;
mod motion;
mod paces;
mod plans;
mod report;
mod task;
mod tracking;
mod waypoints;
mod world;

pub use agreement::Agreement;
pub use candidates::{Candidate, Situation};
pub use cause::Cause;
pub use decision::NavigationDecision;
pub use experience::Experience;
pub use intention::{Intention, MAX_HAZARDS, Round, Said, Stage};
pub use mission::{MAX_GOALS, Mission, MissionError};
pub use paces::{MAX_PACE, Paces};
pub use plans::{ARRIVED, NavigationPlan, OBSTACLE, REACHABLE, RULES, VISITED};
pub use report::Report;
pub use waypoints::{MAX_WAYPOINTS, VisitError};

use self::candidates::Generator;
use self::motion::{MOVES, Motion};
use crate::bounded::up_to;
use crate::grid::{Cell, Move};
use crate::iibt::Logic;
use crate::inference::{Beliefs, Choice, ObservationError};
use crate::math;
use crate::team::{Invalid, Member, Peer, Peers, RobotId};
use heapless::Vec;

/// What a robot senses in one tick.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct GridPercept {
    /// The localiser's reading, which may be wrong.
    pub reading: Option<Cell>,
    /// Blocked cells in view.
    pub hazards: Vec<Cell, MAX_HAZARDS>,
    /// Whether the robot is between two cells.
    pub moving: bool,
}

/// A robot's part of a navigation mission: `S` cells at the most, in maps of `W` words, and `P`
/// candidates.
///
/// ```
/// use iibt_core::grid::{Cell, Map, Move, words};
/// use iibt_core::iibt::InferenceNode;
/// use iibt_core::navigation::{Mission, Navigation, GridPercept, Stage};
/// use iibt_core::team::{Limits, Member, RobotId, Roster};
/// use iibt_core::time::{Duration, Instant};
/// use iibt_core::tree::Status;
///
/// let map = Map::<{ words(5, 1) }>::new(5, 1)?;
/// let mission = Mission::new(map, &[Cell(0)], &[Cell(4)]); // one robot in a corridor
/// let member = Member::new(RobotId(0), 1)?;
/// let mut task = Navigation::<5, 1, 8>::new(&mission, member, 1)?;
/// let mut node = InferenceNode::new(Duration(100));
/// let roster = Roster::new(member, Limits::for_beacons(Duration(1))?);
///
/// let (mut cell, mut status, mut now) = (Cell(0), Status::Running, Instant(0));
/// while status == Status::Running && !now.has_reached(Instant(20)) {
///     let percept = GridPercept { reading: Some(cell), ..GridPercept::default() };
///     status = node.tick(&mut task, &percept, roster.at(now), now);
///     cell = map.neighbour(cell, task.command().unwrap_or(Move::Wait));
///     now = now.after(Duration(1));
/// }
/// assert_eq!((status, cell), (Status::Success, Cell(4)));
/// assert_eq!(task.intention().stage, Stage::Arrived);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias = "bottleneck assignment")]
#[doc(alias = "multi-robot navigation")]
#[derive(Clone, Debug)]
pub struct Navigation<'m, const S: usize, const W: usize, const P: usize> {
    mission: &'m Mission<'m, W>,
    robot: RobotId,
    agreement: Agreement,
    belief: Beliefs<S, 1>,
    motion: Motion,
    surprise: Result<f32, ObservationError>,
    hazards: Vec<Cell, MAX_KNOWN_HAZARDS>,
    waypoints: Vec<Cell, MAX_WAYPOINTS>,
    percept: GridPercept,
    candidates: Vec<Candidate, P>,
    teammates: Vec<Candidate, P>,
    generator: Generator<S, W>,
    decision: NavigationDecision<S, P>,
    choice: Option<Choice>,
    /// What the drive was told at the last tick, and what it is told now.
    commanded: Option<Move>,
    command: Option<Move>,
    /// Whether a step of the path was begun that is not counted yet.
    begun: bool,
    /// The number of rounds the team has begun since this robot last moved.
    failed_rounds: u8,
    /// Whether the robot acts outside the team's plan in this tick.
    alone: bool,
    /// The cell to which it steps aside.
    aside: Option<Cell>,
    /// The reason for which this robot opened the current round, if it did.
    cause: Option<Cause>,
}

/// The most obstacles a robot remembers beside those on its map.
pub const MAX_KNOWN_HAZARDS: usize = 16;

impl<'m, const S: usize, const W: usize, const P: usize> Navigation<'m, S, W, P> {
    /// The least probability of the most likely cell for the robot to act on it: more than a move
    /// has without a reading that confirms it.
    pub const CONFIDENCE: f32 = 0.99;

    /// The failure probability of a move in the robot's motion model for localisation.
    const SLIP: f32 = 0.05;

    /// The least probability of every cell in the belief, so that no reading is impossible.
    const DOUBT: f32 = 1e-6;

    /// Creates the task of one robot at the start of its mission.
    ///
    /// # Errors
    /// [`MissionError`] when the mission does not fit the sizes or the robot is not in it.
    pub fn new(mission: &'m Mission<'m, W>, member: Member, epoch: u32) -> Result<Self, MissionError> {
        mission.check::<S>()?;
        if member.team() != mission.starts.len() {
            return Err(MissionError::TeamSize);
        }
        let robot = member.robot();
        let decision = NavigationDecision::new(mission, robot);
        let start = mission.starts.get(robot.index()).copied().ok_or(MissionError::NoSuchRobot)?;
        Ok(Self {
            mission,
            robot,
            agreement: Agreement::new(robot, mission.team(), epoch, start),
            belief: decision.world().initial(),
            motion: Motion::new(mission.learning),
            surprise: Ok(0.0),
            hazards: Vec::new(),
            waypoints: Vec::new(),
            percept: GridPercept::default(),
            candidates: Vec::new(),
            teammates: Vec::new(),
            generator: Generator::new(),
            decision,
            choice: None,
            commanded: None,
            command: None,
            begun: false,
            failed_rounds: 0,
            alone: false,
            aside: None,
            cause: None,
        })
    }

    /// Sets the preference for each goal, in the order of the mission's list, from the next
    /// decision on.
    ///
    /// The default is one each; [`Experience::values`] gives learned ones. A value outside `(0, 1]`
    /// counts as one.
    pub fn set_goal_preferences(&mut self, values: &[f32; MAX_GOALS]) {
        self.decision.set_goal_preferences(self.mission.goals, values);
    }

    /// Checks that a teammate's intention fits this robot's map.
    ///
    /// # Errors
    /// [`Invalid`] when it names a cell that the map does not have, or its path leads through a
    /// wall.
    pub fn accepts(&self, intention: &Intention) -> Result<(), Invalid> {
        let map = &self.mission.map;
        if !intention.fits(map.len()) {
            return Err(Invalid("a cell is outside this robot's map"));
        }
        if !intention.path.is_open(map) {
            return Err(Invalid("the path leads through a wall of this robot's map"));
        }
        Ok(())
    }

    /// Returns a hash of the mission: equal on two robots exactly when their missions are equal, up
    /// to collisions of the hash.
    #[must_use]
    pub fn mission_id(&self) -> u64 {
        self.mission.id()
    }

    /// Returns this robot's state of the team's agreement.
    #[must_use]
    pub const fn agreement(&self) -> &Agreement {
        &self.agreement
    }

    /// Returns the move to make now; `None` to stand still.
    #[must_use]
    pub const fn command(&self) -> Option<Move> {
        self.command
    }

    /// Returns the most likely cell and its probability.
    #[must_use]
    pub fn position(&self) -> (Cell, f32) {
        let belief = self.belief.as_flat();
        let state = math::argmax(belief);
        (Cell(state as u16), belief.get(state).copied().unwrap_or(0.0))
    }

    /// Returns the probability that the robot is in a cell, q(s); zero outside the map.
    #[must_use]
    pub fn probability_of(&self, cell: Cell) -> f32 {
        self.belief.as_flat().get(cell.index()).copied().unwrap_or(0.0)
    }

    /// Returns why this robot opened the current round; `None` when another robot did, or when the
    /// mission began with it.
    #[must_use]
    pub const fn cause(&self) -> Option<Cause> {
        self.cause
    }

    /// Returns the surprise F = -ln P(o) of the last reading, in nats.
    ///
    /// # Errors
    /// [`ObservationError`] when the reading had probability zero; the belief was left as it was.
    pub const fn surprise(&self) -> Result<f32, ObservationError> {
        self.surprise
    }

    /// Returns the failure probability of each move, in the order of [`Move::ALL`]: zero before the
    /// first failure, then the learned value.
    #[must_use]
    pub fn slips(&self) -> [f32; MOVES] {
        self.motion.slips()
    }

    /// Returns the last decision: its posterior and the candidates it was made among.
    #[must_use]
    pub const fn decision(&self) -> &NavigationDecision<S, P> {
        &self.decision
    }

    /// Returns the candidates of the last decision.
    #[must_use]
    pub fn candidates(&self) -> &[Candidate] {
        &self.candidates
    }

    /// Returns the remembered obstacles, oldest first.
    #[must_use]
    pub fn hazards(&self) -> &[Cell] {
        &self.hazards
    }

    /// Returns the message that this robot announces.
    #[must_use]
    pub fn intention(&self) -> Intention {
        let newest = self.hazards.len().saturating_sub(MAX_HAZARDS);
        Intention {
            round: self.agreement.round(),
            stage: self.stage(),
            plan: self.agreement.plan(),
            goal: self.agreement.goal(),
            path: *self.agreement.path(),
            step: self.agreement.step() as u8,
            probability: self.agreement.probability(),
            hazards: up_to(self.hazards.iter().skip(newest).copied()),
        }
    }

    /// Returns the logic variables for a plan in the current state.
    #[must_use]
    pub fn logic(&self, plan: NavigationPlan) -> Logic {
        let blocked = match plan {
            NavigationPlan::Take(index) => {
                self.candidates.get(index).is_some_and(|taken| self.meets_hazard(&taken.path, 0))
            }
            NavigationPlan::Follow => self.meets_hazard(self.agreement.path(), self.agreement.step()),
            NavigationPlan::Wait => false,
        };
        let visited = match plan {
            // A path that stays because no way leads on does not visit the way-points either.
            NavigationPlan::Take(index) => self
                .candidates
                .get(index)
                .is_none_or(|taken| taken.goal.is_none() || self.visits_all(&taken.path, 0)),
            NavigationPlan::Follow => self.visits_all(self.agreement.path(), self.agreement.step()),
            NavigationPlan::Wait => true,
        };
        let reachable = plan != NavigationPlan::Follow || self.agreement.goal().is_some();
        let logic = Logic::NONE.with(OBSTACLE, blocked).with(ARRIVED, self.has_arrived());
        logic.with(REACHABLE, reachable).with(VISITED, visited)
    }
}

/// Returns the newest intention of each teammate that has been heard.
fn intentions<'a>(peers: Peers<'a, Intention>) -> impl Iterator<Item = &'a Said> + Clone {
    peers.iter().map(Peer::envelope)
}

#[cfg(test)]
mod testing {
    use super::Intention;
    use crate::team::{Limits, Member, RobotId, Roster};
    use crate::time::Duration;

    pub(super) fn member(robot: u8, team: usize) -> Member {
        Member::new(RobotId(robot), team).unwrap()
    }

    /// The roster of robot 0 in a team of `team` that has received nothing.
    pub(super) fn roster(team: usize) -> Roster<Intention> {
        Roster::new(member(0, team), Limits::for_beacons(Duration(1)).unwrap())
    }
}
