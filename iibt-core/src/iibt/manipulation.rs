//! The task of two robots that fetch an object each and join them: the paper's section 6.2.
//!
//! ```text
//! Percept ─► place, grip ─► states ─► logic ─► preferences ─► 16 joint policies ─► command
//!   frames ─► roster ─► announcement ──┴─────────────────────┘        └─► announcement ─► frame
//! ```
//!
//! [`Manipulation`] is the [`Task`] that the inference nodes of figure 14 run; each node has an [`Aim`]. Its
//! plain leaves, to go somewhere and to ask whether the robot is there, are methods. Every robot decides for itself, from its
//! own readings and its teammate's announcements.
//!
//! | symbol | here |
//! |---|---|
//! | s^i, four semantic states | [`State`] |
//! | U, π with the number 4 a1 + a2 | [`Deed`], [`Joint`] |
//! | A of equation 8, its columns normalised | [`Preset::sensor`] |
//! | B | two: in a decision an action brings its state about whatever was before, because that is what the reported numbers say; what came of an action is followed by place and grip |
//! | C, equations 10 to 12 | [`Aim`], then raised by [`RULES`] |
//! | table 5 | [`Deed::precondition`], [`RULES`] |
//! | l^i, the logic variables | [`REACHED`], [`HOLDING`], [`PLACED`], [`TEAMMATE_FREE`], [`TEAMMATE_READY`] |
//!
//! A robot acts on what it is sure of ([`Manipulation::CONFIDENCE`]) and looks again until it is.

mod announcement;
mod decision;
mod deed;
mod mission;
mod model;
mod task;
mod tracking;

pub use announcement::Announcement;
pub use decision::Decision;
pub use deed::{
    Command, Deed, HOLDING, JOINT, Joint, PLACED, REACHED, RULES, STATES, State, TEAMMATE_FREE,
    TEAMMATE_READY, evidence,
};
pub use mission::{Ending, Mission, MissionError, Order, Place, Preset, Role, TEAM};
pub use model::{RESULT_PREFERENCE, RESULTS};

use self::model::{EMPTY, HOLDS, Own, PLACED as IS_PLACED, state};
use self::tracking::Tracking;
use super::Logic;
use crate::inference::{ObservationError, Preference};
use crate::math;
use crate::team::{Peers, RobotId};
use crate::tree;

/// What a robot senses in one tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Percept {
    /// The localiser's reading, which may be wrong.
    pub place: Option<Place>,
    /// The semantic reading, which may be wrong: O^i of equation 9, the index of its one.
    pub state: Option<State>,
    /// Whether an action is under way. Readings count once it has ended.
    pub busy: bool,
}

/// What an inference node is for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Aim {
    /// IsHolding(object).
    #[default]
    Hold,
    /// IsPlaced(object).
    Place,
}

/// What a robot can decide to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Plan {
    /// Let the action under way end.
    Continue,
    /// Take another reading: the robot is not sure of its state.
    Look,
    /// Do one's part of this joint policy.
    Take(Joint),
}

impl Aim {
    /// The action that reaches it.
    #[must_use]
    pub const fn deed(self) -> Deed {
        match self {
            Self::Hold => Deed::Pick,
            Self::Place => Deed::Place,
        }
    }
}

/// A robot's part of a handling mission.
#[derive(Clone, Debug)]
pub struct Manipulation {
    mission: Mission,
    role: Role,
    robot: RobotId,
    /// What the teammate has announced, while that is fresh.
    teammate: Option<Announcement>,
    connected: bool,
    aim: Aim,
    percept: Percept,
    /// Whether the percept was not taken in yet.
    fresh: bool,
    tracking: Tracking,
    decision: Option<Decision>,
    /// Where a move would lead.
    heading: Place,
    /// What is under way.
    pending: Option<Command>,
    command: Option<Command>,
}

impl Manipulation {
    /// The least probability of the place, and of the grip, that a robot takes for true, for it to act on that.
    pub const CONFIDENCE: f32 = 0.999;

    /// A robot at the start of its mission: elsewhere, with an empty grip.
    ///
    /// # Errors
    /// [`MissionError::NoSuchRobot`] when the mission has no such robot.
    pub fn new(mission: Mission, robot: RobotId) -> Result<Self, MissionError> {
        let role = mission.role(robot.index()).ok_or(MissionError::NoSuchRobot)?;
        let (meeting, to) = (mission.meeting(), Place::Elsewhere);
        let own =
            Own { sensor: mission.preset.sensor, source: role.source, meeting, ending: role.ending, to };
        Ok(Self {
            mission,
            role,
            robot,
            teammate: None,
            connected: false,
            aim: Aim::Hold,
            percept: Percept::default(),
            fresh: false,
            tracking: Tracking::new(own),
            decision: None,
            heading: role.source,
            pending: None,
            command: None,
        })
    }

    /// Takes in what was sensed and heard since the last tick. Call it once before the tree's tick.
    pub fn perceive(&mut self, percept: Percept, peers: Peers<'_, Announcement>) {
        self.teammate = peers.fresh().next().map(|peer| *peer.message());
        self.connected = peers.all_connected();
        self.percept = percept;
        self.fresh = true;
        self.command = None;
        self.decision = None;
    }

    /// Turns to what an inference node is for.
    pub fn pursue(&mut self, aim: Aim) {
        self.aim = aim;
    }

    /// The plain leaf IsReached(place): whether the robot is sure to be there.
    pub fn is_reached(&mut self, place: Place) -> bool {
        self.track();
        !self.percept.busy && self.place() == Some(place)
    }

    /// The plain leaf MoveTo(place), one tick: success when the robot is sure to be there. It leaves for the meeting place when the
    /// teammate is connected and, in [`Order::InTurn`], holds its object too; it fails when the robot is sure to have nothing
    /// to bring there, so that the tree begins again.
    pub fn go(&mut self, place: Place) -> tree::Status {
        self.track();
        self.decision = None;
        if self.percept.busy || !self.is_sure() {
            return tree::Status::Running;
        }
        if place == self.mission.meeting() && sure(&self.tracking.grips()) == Some(EMPTY) {
            return tree::Status::Failure;
        }
        if self.place() == Some(place) {
            return tree::Status::Success;
        }
        if self.connected && (place != self.mission.meeting() || self.leaves()) {
            self.begin(Command { deed: Deed::MoveTo, place });
        }
        tree::Status::Running
    }

    /// Takes the last percept in and says where the robot is and what it is, if it is sure of both. With [`act`](Self::act), this is
    /// all that a conventional tree needs to work on the same belief.
    pub fn settled(&mut self) -> Option<(Place, State)> {
        self.track();
        let place = self.place().filter(|_| !self.percept.busy)?;
        let grip = sure(&self.tracking.grips())?;
        Some((place, state(grip, place as usize, self.role.source)))
    }

    /// Begins an action that somebody else has chosen.
    pub fn act(&mut self, command: Command) {
        self.begin(command);
    }

    /// Begins nothing more; an action under way ends by itself.
    pub fn halt(&mut self) {
        self.command = None;
    }

    /// What the body is to do now, told once; `None` for nothing new.
    #[must_use]
    pub const fn command(&self) -> Option<Command> {
        self.command
    }

    /// What the inference node is for now.
    #[must_use]
    pub const fn aim(&self) -> Aim {
        self.aim
    }

    /// The decision of this tick, if one was made.
    #[must_use]
    pub const fn decision(&self) -> Option<&Decision> {
        self.decision.as_ref()
    }

    /// q(s) of this robot over the semantic states.
    #[must_use]
    pub fn states(&self) -> [f32; STATES] {
        self.tracking.states()
    }

    /// q(place) of this robot, in the order of [`Place::ALL`].
    #[must_use]
    pub fn places(&self) -> [f32; 4] {
        self.tracking.places()
    }

    /// F of the last readings, the surprise -ln P(o), in nats.
    ///
    /// # Errors
    /// [`ObservationError`] when they had probability zero; the belief was left as it was.
    pub const fn surprise(&self) -> Result<f32, ObservationError> {
        self.tracking.surprise()
    }

    /// The logic variables as things stand now; [`REACHED`] is about the place where `deed` is done.
    #[must_use]
    pub fn logic(&self, deed: Deed) -> Logic {
        let grip = sure(&self.tracking.grips());
        let reached = self.place() == Some(self.place_of(deed));
        Logic::NONE
            .with(REACHED, reached)
            .with(HOLDING, grip == Some(HOLDS))
            .with(PLACED, grip == Some(IS_PLACED))
            .with(TEAMMATE_FREE, self.has_turn())
            .with(TEAMMATE_READY, self.is_teammate_ready())
    }

    /// What the teammate has announced, while that is fresh.
    #[must_use]
    pub const fn teammate(&self) -> Option<Announcement> {
        self.teammate
    }

    /// What this robot announces.
    #[must_use]
    pub fn announcement(&self) -> Announcement {
        let place = self.place().filter(|_| self.pending.is_none()).unwrap_or_default();
        let state = match sure(&self.tracking.grips()) {
            Some(grip) => state(grip, place as usize, self.role.source),
            None => State::Free,
        };
        Announcement { place, state, deed: self.pending.map_or(Deed::Idle, |command| command.deed) }
    }

    /// C as an aim has it (equation 10): its own state and, of the teammate, to be free, or to do what it announced when
    /// both fetch at once.
    fn wanted(&self) -> [Preference<STATES>; TEAM] {
        let teammate = match self.mission.order {
            Order::InTurn => Deed::Idle,
            Order::Together => self.teammate().map_or(Deed::Idle, |said| said.deed),
        };
        core::array::from_fn(|robot| {
            let deed = if robot == self.robot.index() { self.aim.deed() } else { teammate };
            Preference::from_fn(|state| if state == deed.brings() as usize { 1.0 } else { 0.0 })
        })
    }

    fn track(&mut self) {
        if !self.fresh || self.percept.busy {
            return;
        }
        self.fresh = false;
        let ended = self.pending.take();
        self.tracking.update(ended, self.percept.place, self.percept.state);
    }

    fn begin(&mut self, command: Command) {
        self.command = Some(command);
        self.pending = Some(command);
    }

    /// The place that the robot is sure to be at.
    fn place(&self) -> Option<Place> {
        sure(&self.tracking.places()).and_then(Place::of)
    }

    fn is_sure(&self) -> bool {
        self.place().is_some() && sure(&self.tracking.grips()).is_some()
    }

    /// Where an action is done.
    fn place_of(&self, deed: Deed) -> Place {
        match deed {
            Deed::Pick => self.role.source,
            Deed::Place => self.mission.meeting(),
            Deed::MoveTo | Deed::Idle => self.heading,
        }
    }

    /// Whether the teammate leaves the turn to this robot: it does nothing, and has what it fetches if it goes first.
    fn has_turn(&self) -> bool {
        match self.mission.order {
            Order::Together => true,
            Order::InTurn => self.teammate().is_some_and(|said| {
                said.deed == Deed::Idle && (self.robot.index() == 0 || has_object(said.state))
            }),
        }
    }

    /// Whether it is time to go to the meeting place.
    fn leaves(&self) -> bool {
        match self.mission.order {
            Order::Together => true,
            Order::InTurn => self.teammate().is_some_and(|said| has_object(said.state)),
        }
    }

    fn is_teammate_ready(&self) -> bool {
        let ready = Announcement { place: self.mission.meeting(), state: State::Hold, deed: Deed::Idle };
        self.teammate() == Some(ready)
    }
}

const fn has_object(state: State) -> bool {
    matches!(state, State::Hold | State::Place)
}

/// The state that is probable enough to be acted on.
fn sure(belief: &[f32]) -> Option<usize> {
    let state = math::argmax(belief);
    let probability = belief.get(state).copied().unwrap_or(0.0);
    (probability >= Manipulation::CONFIDENCE).then_some(state)
}
