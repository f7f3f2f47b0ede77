//! The task of a team that goes to different goals on a grid and arrives together.
//!
//! ```text
//! GridPercept ─► belief ─► logic ─► preferences ─► candidates ─► decision ─► agreement ─► command
//!   frames ─► roster ─► intentions ──────────────┴──────────────┘            └─► intention ─► frame
//! ```
//!
//! [`Navigation`] is the [`Task`](crate::iibt::Task) that the interactive inference node runs. It chooses only when it is its turn
//! in the team's [`Agreement`]; until then its one candidate is to wait, and afterwards to follow what it
//! announced.

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

/// A robot's part of a navigation mission: `S` cells at the most, in maps of `W` words, and `P` candidates.
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
    /// How many rounds the team has begun since this robot last moved.
    vain_rounds: u8,
    /// Whether the robot looks after itself in this tick.
    alone: bool,
    /// Where it steps aside to.
    aside: Option<Cell>,
    /// Why this robot opened the round it is in, if it did.
    cause: Option<Cause>,
}

/// The most obstacles a robot keeps in mind beside those on its map.
pub const MAX_KNOWN_HAZARDS: usize = 16;

impl<'m, const S: usize, const W: usize, const P: usize> Navigation<'m, S, W, P> {
    /// The least probability of the cell a robot takes itself to be in, for it to act on that: more than a move
    /// has without a reading that confirms it.
    pub const CONFIDENCE: f32 = 0.99;

    /// How likely a move is taken to fail, when the robot works out where it is.
    const SLIP: f32 = 0.05;

    /// How likely a robot takes itself to be anywhere at all, so that no reading can ever be impossible.
    const DOUBT: f32 = 1e-6;

    /// A robot at the start of its mission.
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
            vain_rounds: 0,
            alone: false,
            aside: None,
            cause: None,
        })
    }

    /// Has each goal of the mission, in the order of its list, worth so much from the next decision on, in place of one each: see
    /// [`Experience::values`]. A value that is not above zero and at most one counts as one.
    pub fn prefer(&mut self, values: &[f32; MAX_GOALS]) {
        self.decision.prefer(self.mission.goals, values);
    }

    /// Whether a teammate's intention speaks of this robot's map.
    ///
    /// # Errors
    /// [`Invalid`] when it names a cell that the map does not have, or its path leads through a wall.
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

    /// A number that is the same for two robots when their missions are.
    #[must_use]
    pub fn mission_id(&self) -> u64 {
        self.mission.id()
    }

    /// The team's joint decision as this robot knows it.
    #[must_use]
    pub const fn agreement(&self) -> &Agreement {
        &self.agreement
    }

    /// The move to make now; `None` to stand still.
    #[must_use]
    pub const fn command(&self) -> Option<Move> {
        self.command
    }

    /// Where the robot is most likely, and how likely that is.
    #[must_use]
    pub fn position(&self) -> (Cell, f32) {
        let belief = self.belief.as_flat();
        let state = math::argmax(belief);
        (Cell(state as u16), belief.get(state).copied().unwrap_or(0.0))
    }

    /// How likely the robot takes itself to be in a cell; zero outside the map.
    #[must_use]
    pub fn probability_of(&self, cell: Cell) -> f32 {
        self.belief.as_flat().get(cell.index()).copied().unwrap_or(0.0)
    }

    /// Why this robot opened the round that it is in; `None` when it has not, or when the mission began with it.
    #[must_use]
    pub const fn cause(&self) -> Option<Cause> {
        self.cause
    }

    /// The surprise F = -ln P(o) of the last reading, in nats, or that it was impossible.
    ///
    /// # Errors
    /// [`ObservationError`] when the reading had probability zero; the belief was left as it was.
    pub const fn surprise(&self) -> Result<f32, ObservationError> {
        self.surprise
    }

    /// How likely each move is taken to fail, in the order of [`Move::ALL`]: zero until it has failed, then what was learned.
    #[must_use]
    pub fn slips(&self) -> [f32; MOVES] {
        self.motion.slips()
    }

    /// The last decision: its posterior and the candidates it was made among.
    #[must_use]
    pub const fn decision(&self) -> &NavigationDecision<S, P> {
        &self.decision
    }

    /// The candidates of the last decision.
    #[must_use]
    pub fn candidates(&self) -> &[Candidate] {
        &self.candidates
    }

    /// The obstacles in mind, oldest first.
    #[must_use]
    pub fn hazards(&self) -> &[Cell] {
        &self.hazards
    }

    /// What this robot tells its teammates.
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

    /// The logic variables for a plan as things stand now.
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
            // To stay for want of any way is no way past the way-points.
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

/// The newest intention of each teammate that has been heard.
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

    /// The roster of robot 0 in a team of `team` that has heard nobody.
    pub(super) fn roster(team: usize) -> Roster<Intention> {
        Roster::new(member(0, team), Limits::for_beacons(Duration(1)).unwrap())
    }
}
