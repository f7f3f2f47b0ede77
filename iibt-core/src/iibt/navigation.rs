//! The task of a team that goes to different goals on a grid and arrives together.
//!
//! ```text
//! Percept ─► belief ─► logic ─► preferences ─► candidates ─► decision ─► agreement ─► command
//!   frames ─► roster ─► intentions ──────────────┴──────────────┘            └─► intention ─► frame
//! ```
//!
//! [`Navigation`] is the [`Task`] that the interactive inference node runs. It chooses only when it is its turn
//! in the team's [`Agreement`]; until then its one candidate is to wait, and afterwards to follow what it
//! announced.

mod assignment;
mod candidates;
mod decision;
mod mission;
mod plans;

pub use candidates::Candidate;
pub use decision::Decision;
pub use mission::{MAX_GOALS, Mission, MissionError};
pub use plans::{ARRIVED, OBSTACLE, Plan, RULES};

use self::candidates::{Generator, Situation};
use self::decision::Party;
use super::rules::raise_for;
use super::{Literal, Logic, Task};
use crate::grid::{Cell, Map, Move, Path, first_conflict};
use crate::inference::{Belief, Choice, IdentityNoise, Impossible, NextState, Preference};
use crate::team::{Agreement, Intention, MAX_HAZARDS, MAX_TEAM, Peer, RobotId, Roster, Status};
use crate::time::Instant;
use heapless::Vec;

/// What a robot senses in one tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Percept {
    /// The time.
    pub now: Instant,
    /// The localiser's reading, which may be wrong.
    pub reading: Option<Cell>,
    /// A blocked cell in view.
    pub hazard: Option<Cell>,
    /// Whether the robot is between two cells.
    pub moving: bool,
}

/// A robot's part of a navigation mission: `S` cells at the most, in maps of `W` words, and `P` candidates.
#[derive(Clone, Debug)]
pub struct Navigation<'m, const S: usize, const W: usize, const P: usize> {
    mission: &'m Mission<'m, W>,
    robot: RobotId,
    roster: Roster,
    agreement: Agreement,
    sensor: IdentityNoise<S>,
    tracking: NextState<S, 5>,
    belief: Belief<S>,
    surprise: Result<f32, Impossible>,
    preference: Preference<S>,
    hazards: Vec<Cell, MAX_KNOWN_HAZARDS>,
    percept: Percept,
    candidates: Vec<Candidate, P>,
    teammates: Vec<Candidate, P>,
    generator: Generator<S, W>,
    decision: Decision<S, P>,
    choice: Option<Choice>,
    /// What the drive was told at the last tick, and what it is told now.
    commanded: Option<Move>,
    command: Option<Move>,
    /// How many rounds this robot has opened in vain since it last moved.
    objections: u8,
    stopping: bool,
}

/// The most obstacles a robot keeps in mind beside those on its map.
pub const MAX_KNOWN_HAZARDS: usize = 16;

impl<'m, const S: usize, const W: usize, const P: usize> Navigation<'m, S, W, P> {
    /// The least probability of the cell a robot takes itself to be in, for it to act on that.
    pub const CONFIDENCE: f32 = 0.9;

    /// How likely a move is taken to fail, when the robot works out where it is.
    const SLIP: f32 = 0.05;

    /// How likely a robot takes itself to be anywhere at all, so that no reading can ever be impossible.
    const DOUBT: f32 = 1e-6;

    /// A robot at the start of its mission.
    ///
    /// # Errors
    /// [`MissionError`] when the mission does not fit the sizes or the robot is not in it.
    pub fn new(mission: &'m Mission<'m, W>, robot: RobotId, epoch: u32, roster: Roster) -> Result<Self, MissionError> {
        mission.check::<S>()?;
        let start = mission.starts.get(robot.index()).copied().ok_or(MissionError::NoSuchRobot)?;
        Ok(Self {
            mission,
            robot,
            agreement: Agreement::new(robot, mission.team(), epoch, start),
            roster,
            sensor: IdentityNoise::new(mission.sensor),
            tracking: mission.transition(),
            belief: mission.belief(),
            surprise: Ok(0.0),
            preference: mission.preference(),
            hazards: Vec::new(),
            percept: Percept::default(),
            candidates: Vec::new(),
            teammates: Vec::new(),
            generator: Generator::new(),
            decision: Decision::new(mission),
            choice: None,
            commanded: None,
            command: None,
            objections: 0,
            stopping: false,
        })
    }

    /// Takes in what was sensed since the last tick. Call it once before the node's tick.
    pub fn perceive(&mut self, percept: Percept) {
        self.percept = percept;
        self.command = None;
    }

    /// The teammates.
    #[must_use]
    pub const fn roster(&self) -> &Roster {
        &self.roster
    }

    /// The teammates, to tell it what they say.
    pub const fn roster_mut(&mut self) -> &mut Roster {
        &mut self.roster
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
        let (state, probability) = self.belief.most_likely();
        (Cell(state as u16), probability)
    }

    /// The surprise F = -ln P(o) of the last reading, in nats, or that it was impossible.
    ///
    /// # Errors
    /// [`Impossible`] when the reading had probability zero; the belief was left as it was.
    pub const fn surprise(&self) -> Result<f32, Impossible> {
        self.surprise
    }

    /// The last decision: its posterior and the candidates it was made among.
    #[must_use]
    pub const fn decision(&self) -> &Decision<S, P> {
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

    /// What this robot tells its teammates; the sender adds stamp and clock.
    #[must_use]
    pub fn intention(&self) -> Intention {
        let newest = self.hazards.len().saturating_sub(MAX_HAZARDS);
        Intention {
            robot: self.robot,
            epoch: 0,
            sequence: 0,
            tick: self.percept.now,
            round: self.agreement.round(),
            status: self.agreement.status(),
            plan: self.agreement.plan(),
            goal: self.agreement.goal(),
            path: *self.agreement.path(),
            step: self.agreement.step() as u8,
            probability: self.agreement.probability(),
            hazards: self.hazards.iter().skip(newest).copied().collect(),
        }
    }

    /// The logic variables for a plan as things stand now.
    #[must_use]
    pub fn logic(&self, plan: Plan) -> Logic {
        let blocked = match plan {
            Plan::Take(index) => self.candidates.get(index).is_some_and(|taken| self.meets_hazard(&taken.path, 0)),
            Plan::Follow => self.meets_hazard(self.agreement.path(), self.agreement.step()),
            Plan::Stop | Plan::Wait => false,
        };
        Logic::NONE.with(OBSTACLE, blocked).with(ARRIVED, self.has_arrived())
    }

    fn has_arrived(&self) -> bool {
        let end = self.agreement.path().end(&self.mission.map);
        self.agreement.is_complete() && self.here() == Some(end) && self.mission.goals.contains(&end)
    }

    /// The cell the robot stands in, if it stands still and is sure of it.
    fn here(&self) -> Option<Cell> {
        let (cell, probability) = self.position();
        (!self.percept.moving && probability >= Self::CONFIDENCE).then_some(cell)
    }

    /// Whether the rest of a path leads into an obstacle that is in mind.
    fn meets_hazard(&self, path: &Path, done: usize) -> bool {
        self.hazards_on(path, done).next().is_some()
    }

    fn hazards_on<'a>(&'a self, path: &'a Path, done: usize) -> impl Iterator<Item = Cell> + 'a {
        path.cells(&self.mission.map).skip(done + 1).filter(|cell| self.hazards.contains(cell))
    }

    fn remember(&mut self, hazard: Cell) {
        let new = self.mission.map.is_free(hazard) && !self.hazards.contains(&hazard);
        if new && self.position().0 != hazard {
            // Beyond what it can keep in mind, the robot learns of an obstacle again when it sees it.
            let _ = self.hazards.push(hazard);
        }
    }

    /// q(s) after the last command and the new reading.
    fn track(&mut self) {
        if self.percept.moving {
            return;
        }
        let before = self.belief;
        if let Some(step) = self.commanded {
            self.belief.predict(&self.tracking, step.code());
            self.belief.mix(&before, Self::SLIP);
        }
        self.belief.mix(&self.mission.belief(), Self::DOUBT);
        if let Some(reading) = self.percept.reading {
            self.surprise = self.belief.update(&self.sensor, reading.index());
        }
    }

    /// Follows the team's agreement as far as the robot's place and the teammates' intentions carry it.
    fn keep_up(&mut self) {
        let waited = self.commanded == Some(Move::Wait);
        let Some(here) = self.here() else { return };
        self.commanded = None;
        let peers = intentions(&self.roster);
        let before = self.agreement.step();
        self.agreement.advance(&self.mission.map, here, waited);
        if self.agreement.step() != before {
            self.objections = 0;
        }
        if self.agreement.join(here, peers.clone()) {
            self.stopping = false;
        }
        self.agreement.agree(peers.clone());
        if self.agreement.is_contradicted(peers) {
            self.agreement.open(here);
        }
    }

    /// The map as the preferences make it: what is disliked is not entered.
    fn passable(&self) -> Map<W> {
        let disliked = |state: &usize| self.preference.get(*state) < 0.0;
        self.mission.map.avoiding((0..self.mission.map.len()).filter(disliked).map(|state| Cell(state as u16)))
    }

    /// The paths that teammates have announced in this round.
    fn announced(&self) -> Vec<Path, MAX_TEAM> {
        self.partners().filter(|peer| peer.status != Status::Deciding).map(|peer| peer.path).collect()
    }

    /// The teammates that are in this round.
    fn partners(&self) -> impl Iterator<Item = &Intention> + Clone {
        let round = self.agreement.round();
        intentions(&self.roster).filter(move |peer| peer.round == round)
    }

    fn situation<'a>(&mut self, here: Cell, announced: &'a [Path]) -> Situation<'a, W> {
        let map = self.passable();
        let cells: Vec<Cell, MAX_TEAM> =
            core::iter::once(here).chain(self.partners().map(|peer| peer.path.start)).collect();
        let arrivals = self.generator.arrivals(self.mission, &map, &cells, announced);
        Situation { map, announced, arrivals }
    }

    /// Whether it is this robot's turn to choose, and where it stands.
    fn turn(&self) -> Option<Cell> {
        self.here().filter(|_| self.agreement.is_my_turn(intentions(&self.roster)))
    }

    /// C for a decision: a goal that a teammate has claimed is worth nothing.
    fn wanted(&self) -> Preference<S> {
        let mut wanted = self.preference;
        for claimed in self.partners().filter_map(|peer| peer.goal) {
            wanted.raise(claimed.index(), -wanted.get(claimed.index()).max(0.0));
        }
        wanted
    }

    /// The longest policy in this decision.
    fn horizon(&self, situation: &Situation<'_, W>) -> usize {
        let ours = self.candidates.iter().map(|candidate| candidate.path.len());
        let listed = (0..self.mission.starts.len()).flat_map(|robot| self.mission.listed_lengths(robot));
        ours.chain(listed).chain(situation.arrivals.iter().copied()).max().unwrap_or(0)
    }

    /// Joint candidates: the robot's own, with those of each teammate, which are the path it announced or
    /// else all that it might choose.
    fn deliberate(&mut self, here: Cell) {
        let announced = self.announced();
        let situation = self.situation(here, &announced);
        let horizon = self.horizon(&situation);
        let wanted = self.wanted();
        let partners: Vec<(usize, Path, bool), MAX_TEAM> = self
            .partners()
            .map(|peer| (peer.robot.index(), peer.path, peer.status != Status::Deciding))
            .collect();
        let mut own = self.belief;
        for (_, path, _) in &partners {
            own = self.decision.beliefs(&own, here, path.start).0;
        }
        self.decision.begin(Party { belief: &own, preference: &wanted, candidates: &self.candidates }, horizon);
        for (robot, path, chosen) in partners {
            let (_, belief) = self.decision.beliefs(&self.belief, here, path.start);
            self.propose(&situation, robot, path, chosen);
            self.decision.join(
                Party { belief: &own, preference: &wanted, candidates: &self.candidates },
                Party { belief: &belief, preference: &wanted, candidates: &self.teammates },
                horizon,
            );
        }
    }

    /// What a teammate may do: what it announced, or whatever this robot would consider in its place.
    fn propose(&mut self, situation: &Situation<'_, W>, robot: usize, path: Path, chosen: bool) {
        if chosen {
            self.teammates.clear();
        } else {
            self.generator.fill(self.mission, situation, (robot, path.start), &mut self.teammates);
        }
        if self.teammates.is_empty() {
            // There is room: the list is empty.
            let _ = self.teammates.push(Candidate { path, goal: None });
        }
    }

    /// Announces the chosen path, or opens another round when it does not go with those announced before.
    fn commit(&mut self, candidate: Candidate) {
        let announced = self.announced();
        let fits = announced.iter().all(|other| self.goes_with(&candidate.path, other));
        let clear = announced.iter().all(|other| self.is_clear(&candidate.path, other));
        if !fits && self.objections < self.mission.team() {
            self.objections += 1;
            self.agreement.open(candidate.path.start);
        } else if clear {
            let probability = self.choice.map_or(0.0, |choice| choice.joint);
            self.agreement.announce(candidate.path, candidate.goal, probability);
        } else {
            self.agreement.announce(Path::at(candidate.path.start), None, 1.0);
        }
    }

    fn is_clear(&self, path: &Path, other: &Path) -> bool {
        first_conflict(&self.mission.map, path, other).is_none()
    }

    /// Whether two robots that follow these paths arrive in the same step on different cells, safely.
    fn goes_with(&self, path: &Path, other: &Path) -> bool {
        let together = other.is_empty() || other.len() == path.len();
        together && path.end(&self.mission.map) != other.end(&self.mission.map) && self.is_clear(path, other)
    }
}

fn intentions(roster: &Roster) -> impl Iterator<Item = &Intention> + Clone {
    roster.peers().map(Peer::intention)
}

impl<const S: usize, const W: usize, const P: usize> Task for Navigation<'_, S, W, P> {
    type Policy = Plan;

    fn prepare(&mut self) {
        self.preference = self.mission.preference();
    }

    fn observe(&mut self) {
        let mut seen: Vec<Cell, { MAX_TEAM * MAX_HAZARDS + 1 }> = self.percept.hazard.into_iter().collect();
        seen.extend(intentions(&self.roster).flat_map(|peer| peer.hazards.iter().copied()));
        for hazard in seen {
            self.remember(hazard);
        }
    }

    fn update(&mut self) {
        self.track();
        self.keep_up();
        if self.has_arrived() {
            self.agreement.arrive();
        }
    }

    fn candidates(&mut self) {
        let Some(here) = self.turn() else {
            self.candidates.clear();
            return;
        };
        let announced = self.announced();
        let situation = self.situation(here, &announced);
        self.generator.fill(self.mission, &situation, (self.robot.index(), here), &mut self.candidates);
    }

    fn intentions(&mut self) {
        self.choice = None;
        if let Some(here) = self.turn().filter(|_| !self.candidates.is_empty()) {
            self.deliberate(here);
            self.choice = self.decision.choose();
        }
    }

    fn infer(&mut self) -> Option<Plan> {
        if self.stopping && self.has_arrived() {
            return Some(Plan::Stop);
        }
        if self.agreement.status() != Status::Deciding {
            return Some(Plan::Follow);
        }
        if self.turn().is_none() {
            return Some(Plan::Wait);
        }
        self.choice.map(|choice| Plan::Take(choice.policy))
    }

    fn is_stop(&self, plan: Plan) -> bool {
        plan == Plan::Stop
    }

    fn unmet(&self, plan: Plan) -> Option<Literal> {
        plan.precondition().unmet(self.logic(plan))
    }

    fn raise(&mut self, missing: Literal) {
        let Some(raise) = raise_for(&RULES, missing) else { return };
        let (path, done) = match self.choice.and_then(|choice| self.candidates.get(choice.policy)) {
            Some(taken) => (taken.path, 0),
            None => (*self.agreement.path(), self.agreement.step()),
        };
        let amount = raise.amount(self.preference.largest());
        let hazards: Vec<Cell, MAX_KNOWN_HAZARDS> = self.hazards_on(&path, done).take(MAX_KNOWN_HAZARDS).collect();
        for hazard in hazards {
            self.preference.raise(hazard.index(), amount);
        }
        if self.choice.is_none()
            && let Some(here) = self.here()
        {
            self.agreement.open(here);
        }
    }

    fn connected(&self) -> bool {
        self.roster.all_connected(self.percept.now)
    }

    fn execute(&mut self, plan: Plan) {
        match plan {
            Plan::Take(index) => {
                if let Some(&candidate) = self.candidates.get(index) {
                    self.commit(candidate);
                }
            }
            Plan::Follow if !self.percept.moving => {
                self.command = self.agreement.next_move(&self.mission.map, intentions(&self.roster));
                self.commanded = self.command;
            }
            _ => {}
        }
    }

    fn roll_back(&mut self) {
        self.preference.roll_back();
    }

    fn wait(&mut self) {
        self.command = None;
    }

    fn reaches_stop(&self, plan: Plan) -> bool {
        let done = self.agreement.step() + usize::from(self.command.is_some());
        plan == Plan::Follow && self.agreement.is_agreed() && done == self.agreement.path().len()
    }

    fn promote_stop(&mut self) {
        self.stopping = true;
    }
}
