//! One robot of a navigating team, tick by tick.

use super::errands::Waypoints;
use super::fact::Fact;
use super::obstacles::Obstacles;
use super::policies::{OnMap, Policies, TeamPlan, moves_of};
use super::{
    Cause, Intention, Localisation, MAX_GOALS, MAX_OBSTACLES, Mission, MissionError, Purpose, VisitError,
};
use crate::bounded::up_to;
use crate::grid::{Cell, CellSet, Move, Path};
use crate::inference::{Eighths, WeighedPolicies, worth_of_nats};
use crate::team::rounds::{
    Digest, Event, JointPolicies, Own, RoundMessage, Rounds, Score, Scores, Teammates, Timing, Waiting, Want,
};
use crate::team::{Fnv1a, Freshness, Invalid, Member, Peers, RobotId};
use heapless::Vec;

/// The most obstacles that a robot takes in at a tick.
pub const MAX_HAZARDS: usize = 4;

/// The moves that a teammate may have begun since its newest message was sent, as long as that is
/// fresh.
const MOVES_UNHEARD: u16 = 6;

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
    /// Whether the last move is still going on; the reading is not used then.
    pub moving: bool,
}

/// The task of a robot in a navigating team: to reach goals with its teammates, by one joint plan.
///
/// For maps of up to `S` cells in `W` words, plans of less than `L` steps, searches of up to `M`
/// nodes and up to `K` joint policies. Robots of a team have the same `L`, `M` and `K`: what they
/// plan depends on them, and others reject their frames. The team has at most
/// [`MAX_TEAM`](crate::team::MAX_TEAM) robots.
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
    watched: CellSet<W>,
    waypoints: Waypoints,
    charges: bool,
    goal_values: [f32; MAX_GOALS],
    /// `None` until the robot first knows where it stands: it has nothing true to say before.
    rounds: Option<Rounds<Fact<W>, K>>,
    policies: Policies<W, L, M, K>,
    /// What the policies are being made from.
    listing: Option<Digest>,
    weighed: WeighedPolicies<K>,
    moving: bool,
    /// The cells between which the robot is, from the command until it knows where that has led.
    under_way: Option<(Cell, Cell)>,
    command: Option<Move>,
    waiting: Option<Waiting>,
    /// Why another round is wanted.
    wanted: Option<Cause>,
    cause: Option<Cause>,
}

impl<'m, const S: usize, const W: usize, const L: usize, const M: usize, const K: usize>
    Navigation<'m, S, W, L, M, K>
{
    /// The work units of a tick unless [`set_budget`](Self::set_budget) says otherwise.
    pub const BUDGET: u32 = 1_000;

    /// Creates a robot of the mission's team that has been switched on for the `epoch`-th time.
    ///
    /// # Errors
    /// [`MissionError`] when the mission does not fit the sizes or the robot is not in its team.
    pub fn new(mission: &'m Mission<'m, W>, member: Member, epoch: u32) -> Result<Self, MissionError> {
        mission.check::<S>()?;
        if member.team() != mission.starts.len() {
            return Err(MissionError::TeamSize);
        }
        let robot = member.robot();
        let start = mission.starts.get(robot.index()).copied().ok_or(MissionError::NoSuchRobot)?;
        let localisation = Localisation::new(&mission.map, start, mission.sensor_of(robot), mission.learning);
        Ok(Self {
            mission,
            member,
            epoch,
            budget: Self::BUDGET,
            left: Self::BUDGET,
            localisation,
            obstacles: Obstacles::default(),
            watched: CellSet::EMPTY,
            waypoints: Waypoints::default(),
            charges: false,
            goal_values: [1.0; MAX_GOALS],
            rounds: None,
            policies: Policies::new(),
            listing: None,
            weighed: WeighedPolicies::default(),
            moving: false,
            under_way: None,
            command: None,
            waiting: None,
            wanted: None,
            cause: None,
        })
    }

    /// Sets the most work units of a tick. A unit is one layer sweep or cancel of the planner, one
    /// call of the search, or one distance table; what is left is done in the next tick.
    pub const fn set_budget(&mut self, units: u32) {
        self.budget = units;
    }

    /// Sets the preference for each goal, in the order of the mission: 1 at the most, lower by a nat
    /// for a goal that serves e times less often. Other values count as 1.
    pub fn set_goal_preferences(&mut self, values: &[f32; MAX_GOALS]) {
        self.goal_values = values.map(|value| if value > 0.0 && value <= 1.0 { value } else { 1.0 });
    }

    /// Tells the robot to visit a cell before it goes to a goal, after those it was told before.
    ///
    /// # Errors
    /// [`VisitError`] when no robot can be there or it has enough to visit.
    pub fn visit(&mut self, cell: Cell) -> Result<(), VisitError> {
        if !self.mission.map.is_free(cell) || self.is_blocked(cell) {
            return Err(VisitError::Blocked(cell));
        }
        self.waypoints.push(cell)
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
        let generator = Policies::<W, L, M, K>::fingerprint(self.mission);
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

    /// Returns the way-points to visit, the next one first.
    #[must_use]
    pub fn waypoints(&self) -> &[Cell] {
        self.waypoints.all()
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

    /// The path that the robot follows, and the moves made of it.
    pub(super) fn course(&self) -> Option<(&Path, u16)> {
        let rounds = self.rounds.as_ref()?;
        let path = self.on_map()?.path(rounds.protocol().policy()?, self.member.robot())?;
        Some((path, rounds.protocol().step()))
    }

    pub(super) fn on_map(&self) -> Option<OnMap<'_, W, K>> {
        let view = self.rounds.as_ref()?.proposal().view;
        Some(OnMap { mission: self.mission, plans: self.policies.plans(), view })
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

    /// The cell that the robot stands on, between no two others.
    pub(super) fn standing(&self) -> Option<Cell> {
        self.localisation.here().filter(|_| !self.moving && self.under_way.is_none())
    }

    /// What the robot is for now.
    pub(super) fn purpose(&self) -> Purpose {
        if self.charges {
            return self.mission.charger(self.robot()).map_or(Purpose::Stand, Purpose::Charge);
        }
        self.waypoints.next(|cell| self.is_blocked(cell)).map_or(Purpose::Goal, Purpose::Visit)
    }

    fn fact(&self, anchor: Cell, purpose: Purpose) -> Fact<W> {
        Fact { anchor, purpose, evidence: self.obstacles.announced() }
    }

    /// Lines 5 and 6: takes in what was sensed and heard.
    pub(super) fn take_in(&mut self, percept: &GridPercept, peers: Peers<'_, Intention<W, K>>) {
        (self.command, self.left, self.waiting) = (None, self.budget, None);
        self.moving = percept.moving;
        self.locate(percept.reading);
        self.look(percept, peers);
        if let Some(here) = self.standing() {
            let obstacles = &self.obstacles;
            self.waypoints.tick_off(here, |cell| obstacles.is_blocked(cell));
            if self.rounds.is_none() {
                let fact = self.fact(here, self.purpose());
                let number = self.mission_id();
                self.rounds = Some(Rounds::new(self.member, self.epoch, number, fact, Timing::DEFAULT));
            }
        }
        self.attend(peers);
    }

    fn locate(&mut self, reading: Option<Cell>) {
        if self.moving {
            return;
        }
        let map = &self.mission.map;
        self.localisation.update(map, reading);
        let Some(here) = self.localisation.here() else { return };
        let obstacles = &self.obstacles;
        self.localisation.learn(map, here, |cell| obstacles.is_blocked(cell));
        if let Some((from, to)) = self.under_way.take()
            && here == to
            && from != to
            && let Some(rounds) = &mut self.rounds
        {
            rounds.protocol_mut().advance();
        }
    }

    /// Takes in what is in view.
    fn look(&mut self, percept: &GridPercept, peers: Peers<'_, Intention<W, K>>) {
        if !percept.hazards.is_empty() {
            self.look_at_hazards(percept, peers);
        }
        for &cell in percept.clear.iter().filter(|&&cell| self.watched.contains(cell)) {
            self.obstacles.look(cell, false);
        }
        self.obstacles.forget(self.mission.forgets);
        let told = peers.iter().flat_map(|peer| peer.message().as_ref().fact.evidence.iter());
        let told = told.filter(|known| known.weight > 0).map(|known| known.cell);
        self.watched = told.chain(self.obstacles.blocked()).collect();
    }

    /// Where a teammate may be, it may be the teammate that is seen; but not in the cell that the plan
    /// lets this robot enter now.
    fn look_at_hazards(&mut self, percept: &GridPercept, peers: Peers<'_, Intention<W, K>>) {
        let mates = self.places_of_teammates(peers);
        let entering = self.may_enter(&Teammates::from(peers)).map(|(_, to)| to);
        let own = self.localisation.position().0;
        for &cell in &percept.hazards {
            let may_be_mate = mates.contains(cell) && entering != Some(cell);
            if self.mission.map.is_free(cell) && cell != own && !may_be_mate {
                self.obstacles.look(cell, true);
            }
        }
    }

    /// The cells that teammates may be on now, by their newest messages: those of the next moves
    /// too, because a message is from before. One that was not heard may be on its start.
    fn places_of_teammates(&self, peers: Peers<'_, Intention<W, K>>) -> CellSet<W> {
        let teammates = Teammates::from(peers);
        let starts = (0..).map(RobotId).zip(self.mission.starts);
        let places = starts.filter(|&(robot, _)| robot != self.robot()).map(|(robot, &start)| {
            let Some(heard) = teammates.get(robot) else { return [start].into_iter().collect() };
            let anchor = crate::team::rounds::Fact::anchor(&heard.message.fact).0;
            let is_fresh = peers.freshness(robot) == Freshness::Fresh;
            self.next_places(robot, heard.message, is_fresh).unwrap_or(anchor)
        });
        places.fold(CellSet::EMPTY, |all, place| all.union(&place))
    }

    /// The cells of the next moves of a teammate that follows the same plan; of all that are left, if
    /// it was not heard lately.
    fn next_places(
        &self,
        robot: RobotId,
        message: &RoundMessage<Fact<W>, K>,
        is_fresh: bool,
    ) -> Option<CellSet<W>> {
        let (rounds, list) = self.rounds.as_ref().zip(self.on_map())?;
        let policy = rounds.protocol().policy().filter(|_| list.view.contains(robot))?;
        if message.proposal.round != rounds.proposal().round {
            return None;
        }
        let step = message.answer.step();
        let rest = list.claim(policy, robot, step).0;
        // What is claimed after the last move is where the path ends.
        let far = step.saturating_add(MOVES_UNHEARD);
        let is_far = is_fresh && list.moves(policy, robot) >= far;
        Some(if is_far { rest.without(&list.claim(policy, robot, far).0) } else { rest })
    }

    /// Hears the teammates; joins a round, opens one where there is trouble, or learns the choice.
    fn attend(&mut self, peers: Peers<'_, Intention<W, K>>) {
        let teammates = Teammates::from(peers);
        let standing = self.standing();
        let anchor = standing.unwrap_or(self.localisation.position().0);
        let fact = self.fact(anchor, self.purpose());
        let Some(rounds) = &mut self.rounds else { return };
        let list = OnMap::<W, K> {
            mission: self.mission,
            plans: self.policies.plans(),
            view: rounds.proposal().view,
        };
        let own = Own { fact: &fact, is_standing: standing.is_some() };
        let mut event = (rounds.tick(own, &teammates, &list), Cause::Teammate);
        // Where all policies were impossible for some member, there is none whose precondition could
        // ask for another round.
        let protocol = rounds.protocol();
        let is_void = protocol.has_decided() && protocol.policy().is_none() && *protocol.fact() != fact;
        if is_void && event.0.is_none() && own.is_standing {
            event = (rounds.ask(Want::Needed, &fact), Cause::Shortfall);
        }
        self.note(event.0, event.1, &teammates);
        self.note_waiting(&teammates);
    }

    fn note(&mut self, event: Option<Event>, cause: Cause, teammates: &Teammates<'_, Fact<W>, K>) {
        match event {
            Some(Event::Joined(_)) => self.begin_round(None),
            Some(Event::Opened(_)) => self.begin_round(Some(cause)),
            Some(Event::Decided(_)) => self.weigh(teammates),
            None => {}
        }
    }

    fn begin_round(&mut self, cause: Option<Cause>) {
        self.cause = cause;
        self.listing = None;
        self.weighed = WeighedPolicies::default();
    }

    /// Keeps the posterior over the policies, for displays and logs.
    fn weigh(&mut self, teammates: &Teammates<'_, Fact<W>, K>) {
        let Some((rounds, list)) = self.rounds.as_ref().zip(self.on_map()) else { return };
        self.weighed = list.weigh(rounds.protocol().scores(teammates));
    }

    /// Lines 18 and 19: wants another round because of an unmet precondition.
    pub(super) const fn want(&mut self, cause: Cause) {
        self.wanted = Some(cause);
    }

    /// Line 20: opens the round that is wanted, if it may.
    pub(super) fn ask(&mut self, purpose: Purpose, peers: Peers<'_, Intention<W, K>>) {
        let (Some(cause), Some(here)) = (self.wanted.take(), self.standing()) else { return };
        let fact = self.fact(here, purpose);
        let Some(rounds) = &mut self.rounds else { return };
        let want = if cause == Cause::Shortfall { Want::Better } else { Want::Needed };
        let Some(event) = rounds.ask(want, &fact) else { return };
        let teammates = Teammates::from(peers);
        self.note(Some(event), cause, &teammates);
        self.note_waiting(&teammates);
    }

    /// Lines 7 and 20: works on the list of this round, within the budget of the tick.
    pub(super) fn list(&mut self, peers: Peers<'_, Intention<W, K>>) {
        let teammates = Teammates::from(peers);
        let Some(rounds) = &self.rounds else { return };
        let Some(digest) = rounds.protocol().wanted(&teammates) else { return };
        if self.listing != Some(digest) {
            self.policies.clear();
            self.listing = Some(digest);
        }
        let protocol = rounds.protocol();
        let facts =
            |robot| protocol.facts(&teammates).find_map(|(other, fact)| (other == robot).then_some(fact));
        self.policies.advance(self.mission, rounds.proposal(), facts, &mut self.left);
    }

    /// Lines 8 to 12 and 21 to 25: gives this robot's scores of the finished list, and returns the
    /// policy that all have chosen, once every score is known.
    pub(super) fn choose(&mut self, peers: Peers<'_, Intention<W, K>>) -> Option<usize> {
        let teammates = Teammates::from(peers);
        if self.policies.is_done()
            && let Some(digest) = self.listing
            && let Some(scores) = self.scores()
            && let Some(rounds) = &mut self.rounds
            && rounds.protocol().wanted(&teammates) == Some(digest)
        {
            let list = OnMap::<W, K> {
                mission: self.mission,
                plans: self.policies.plans(),
                view: rounds.proposal().view,
            };
            let protocol = rounds.protocol_mut();
            if protocol.give(digest, scores, &list, &teammates).is_ok() && protocol.has_decided() {
                self.weigh(&teammates);
            }
            self.note_waiting(&teammates);
        }
        self.rounds.as_ref()?.protocol().policy()
    }

    /// What each policy costs this robot alone.
    fn scores(&self) -> Option<Scores<K>> {
        let list = self.on_map()?;
        let score = |policy| list.path(policy, self.robot()).map_or(Score::CANNOT, |path| self.score(path));
        Some(up_to((0..list.len()).map(score)))
    }

    /// What a path costs this robot: the ticks by which its drive makes it late, and what its goal
    /// is worth less than others.
    fn score(&self, path: &Path) -> Score {
        let map = &self.mission.map;
        if path.cells(map).skip(1).any(|cell| self.is_blocked(cell)) {
            return Score::CANNOT;
        }
        let slips = self.localisation.slips();
        let pace = f32::from(self.mission.pace_of(self.robot()) - 1);
        let extra = |step: Move| {
            let slip = slips.get(usize::from(step.code())).copied().unwrap_or(0.0).min(0.9);
            if step == Move::Wait { 0.0 } else { pace + (1.0 + pace) * slip / (1.0 - slip) }
        };
        let delay: f32 = path.moves().map(extra).sum();
        let end = path.end(map);
        let value = self.mission.goals.iter().zip(self.goal_values).find(|&(&goal, _)| goal == end);
        let missed = value.map_or(0.0, |(_, value)| 1.0 - value);
        let missed = worth_of_nats(missed, self.mission.precision.max(0.1));
        Score { delay: in_a_frame((8.0 * delay + 0.5) as Eighths), price: in_a_frame(missed) }
    }

    /// Line 32: begins the next move of the path, if it is the robot's turn.
    pub(super) fn follow(&mut self) {
        let next = self.next_cell().filter(|_| self.waiting.is_none());
        if let (Some((step, to)), Some(here)) = (next, self.standing())
            && !self.is_blocked(to)
        {
            self.command = Some(step);
            self.localisation.begin(step);
            self.under_way = Some((here, to));
        }
    }

    /// The next move and where it leads, if it is the robot's turn.
    fn may_enter(&self, teammates: &Teammates<'_, Fact<W>, K>) -> Option<(Move, Cell)> {
        let (rounds, list) = self.rounds.as_ref().zip(self.on_map())?;
        self.next_cell().filter(|_| rounds.protocol().may_move(teammates, &list))
    }

    /// The next move of the path and where it leads, if the robot is where the path says.
    fn next_cell(&self) -> Option<(Move, Cell)> {
        let (path, moves) = self.course()?;
        let list = self.on_map()?;
        let policy = self.rounds.as_ref()?.protocol().policy()?;
        let (at, step) = list.next_move(policy, self.robot(), moves)?;
        let map = &self.mission.map;
        (self.standing() == Some(path.cell_at(map, at))).then(|| (step, path.cell_at(map, at + 1)))
    }

    /// Whether the robot stands where its path says, or is between two cells of it.
    pub(super) fn is_on_course(&self) -> bool {
        let (Some((path, moves)), Some(here)) = (self.course(), self.standing()) else { return true };
        here == self.cell_after(path, moves)
    }

    /// Whether all moves are made.
    pub(super) fn is_complete(&self) -> bool {
        self.course().is_some_and(|(path, moves)| moves >= moves_of(path))
    }

    fn cell_after(&self, path: &Path, moves: u16) -> Cell {
        path.cell_at(&self.mission.map, super::report::steps_after(path, moves))
    }

    /// Whether a cell that the robot takes for blocked is on what is left of any member's path.
    pub(super) fn is_plan_blocked(&self) -> bool {
        let (Some(rounds), Some(list)) = (&self.rounds, self.on_map()) else { return false };
        let Some(policy) = rounds.protocol().policy() else { return false };
        if self.obstacles.blocked().next().is_none() {
            return false;
        }
        let own = self.robot();
        list.view.iter().any(|robot| {
            let step = if robot == own { rounds.protocol().step() } else { 0 };
            let rest = list.claim(policy, robot, step).0;
            self.obstacles.blocked().any(|cell| rest.contains(cell))
        })
    }

    /// The purpose that the robot has announced for this round.
    pub(super) fn announced(&self) -> Option<&Fact<W>> {
        self.rounds.as_ref().map(|rounds| rounds.protocol().fact())
    }

    /// Whether more is known about obstacles than this round was decided from.
    pub(super) fn has_news(&self) -> bool {
        self.announced().is_some_and(|fact| fact.evidence != self.obstacles.announced())
    }

    /// Returns what to announce after a tick of the node; `None` until the robot knows where it
    /// stands.
    #[must_use]
    pub fn intention(&self, peers: Peers<'_, Intention<W, K>>) -> Option<Intention<W, K>> {
        let rounds = self.rounds.as_ref()?;
        let policy = rounds.protocol().policy();
        let probability = policy.map_or(0.0, |policy| self.weighed.probability(policy));
        let probability = (255.0 * probability + 0.5) as u8; // a cast saturates
        let listed = self.policies.plans().len() as u8;
        Some(Intention(rounds.protocol().message(&Teammates::from(peers), listed, probability)))
    }

    /// Line 35: stands.
    pub(super) const fn stand(&mut self) {
        self.command = None;
    }

    /// Notes what the robot waits for: whenever it has heard or done something.
    fn note_waiting(&mut self, teammates: &Teammates<'_, Fact<W>, K>) {
        let waiting = self.rounds.as_ref().zip(self.on_map());
        self.waiting = waiting.and_then(|(rounds, list)| rounds.waiting(teammates, &list));
    }

    /// Whether every other member of the round follows the same plan, by its newest message. How old
    /// that is does not matter: what a robot that falls silent may still do is in the plan.
    pub(super) fn members_follow(&self) -> bool {
        self.waiting.is_none_or(Waiting::is_in_plan)
    }
}

/// A time in what a frame holds; a cost that is finite is never "cannot".
fn in_a_frame(time: Eighths) -> u8 {
    u8::try_from(time).unwrap_or(u8::MAX).min(Score::IMPOSSIBLE - 1)
}
