//! A task described by tables: the lines of Algorithm 1.

use super::announcement::{Announcement, TableMessage};
use super::definition::{Aim, Fact, HiddenFactor, Holds, MAX_SENSORS, Operator, Role};
use super::error::TablesError;
use super::joint::{MAX_POLICIES, holds_of_teammate};
use super::model::{prior, track};
use super::rounds::TeamRounds;
use super::tables::Tables;
use crate::iibt::{Condition, Literal, Logic, Task};
use crate::inference::{Beliefs, ObservationError, Preference};
use crate::math;
use crate::team::{Invalid, MAX_TEAM, Message, Peers, RobotId};
use crate::time::Instant;
use core::marker::PhantomData;

/// The readings of a robot in one tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Percept {
    /// The time of the tick. A percept counts once, however many nodes see it.
    pub at: Instant,
    /// The reading of each sensor, `None` for one that is silent.
    pub readings: [Option<u8>; MAX_SENSORS],
    /// Whether an operator is under way. Readings count once it has ended.
    pub busy: bool,
}

/// A command to the robot's body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Command {
    /// The operator to begin.
    pub operator: u8,
    /// The state that it leads to, if that is the target.
    pub target: Option<u8>,
}

/// The possible decisions of a robot in a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Plan {
    /// Let the operator under way end.
    Continue,
    /// Take another reading: the robot is not sure of its factors.
    Look,
    /// Carry out the robot's part of the joint policy with this number.
    Take(u16),
}

/// C of all robots as one robot has it, raises included, and the target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wanted<const S: usize, const N: usize> {
    /// C of each robot's semantic state.
    pub rows: [Preference<S>; N],
    /// The target.
    pub target: Option<u8>,
}

/// The candidates of a robot's own decision: all operators of all robots, less what teammates have
/// excluded by announcing another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Offered<const N: usize> {
    pub(super) target: Option<u8>,
    /// The operator that each teammate has under way, if it was heard.
    pub(super) announced: [Option<u8>; N],
}

/// The last decision: its input and its result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointDecision<const S: usize, const N: usize, const P: usize> {
    /// C of each robot at the time, raises included.
    pub preferences: [[f32; S]; N],
    /// q(s) of each robot.
    pub beliefs: [[f32; S]; N],
    /// The posterior over all joint policies, by their numbers.
    pub posterior: [f32; P],
    /// The joint policy that the team has chosen. As long as it has not, the most probable one in
    /// which the teammates do what they have announced.
    pub choice: u16,
}

/// What a robot wanted, and what it was sure of, when nothing was missing for its own choice.
#[derive(Clone, Copy, Debug)]
pub(super) struct Settled<const S: usize> {
    /// C of its semantic state, raises included.
    pub(super) preference: [f32; S],
    /// q(s).
    pub(super) states: [f32; S],
    pub(super) target: Option<u8>,
    /// The operator of its choice.
    pub(super) operator: u8,
}

/// A robot's part of a task written as tables.
///
/// `S`, `N` and `P` are the [`states`](Tables::states), [`robots`](Tables::robots) and
/// [`policies`](Tables::policies) of the tables, or more. `X` is what the robots add to their
/// [`TableMessage`] for uses of their own.
///
/// A team decides in [rounds](crate::team::rounds); a robot that is alone decides by itself.
#[derive(Clone, Debug)]
pub struct TableTask<'a, const S: usize, const N: usize, const P: usize, X = ()> {
    pub(super) tables: &'a Tables<'a>,
    pub(super) role: &'a Role<'a>,
    pub(super) own: usize,
    pub(super) aim: &'a Aim<'a>,
    beliefs: Beliefs<S, 1>,
    surprise: Result<f32, ObservationError>,
    /// What each teammate in the view has announced.
    said: [Option<Announcement>; N],
    observed: Option<Instant>,
    busy: bool,
    /// The command under way.
    pending: Option<Command>,
    command: Option<Command>,
    /// The robot's own decision: the last one, or the one that it works on.
    pub(super) decision: Option<JointDecision<S, N, P>>,
    /// How many joint policies are scored for a decision that it works on.
    pub(super) thinking: Option<u16>,
    /// Whether the decision was made in this tick.
    pub(super) is_current: bool,
    /// The operator that the robot would choose by itself.
    intends: u8,
    /// What it wanted when it was last sure, and nothing was missing for it.
    pub(super) wanted: Option<Settled<S>>,
    budget: u32,
    /// The work units that are left in this tick.
    pub(super) left: u32,
    /// The work units of earlier ticks.
    worked: u32,
    /// Whether a node has asked for a choice since the last percept.
    is_asked: bool,
    /// Whether the choice of this tick is what the team has decided, or needs no teammate.
    is_agreed: bool,
    pub(super) rounds: TeamRounds<'a, N>,
    addition: PhantomData<fn(X)>,
}

impl<'a, const S: usize, const N: usize, const P: usize, X> TableTask<'a, S, N, P, X> {
    /// The work units of a tick unless [`set_budget`](Self::set_budget) says otherwise.
    pub const BUDGET: u32 = 1_000;

    /// Robot `robot` of the team at the start of the task, with its first aim, switched on for the
    /// `epoch`-th time: the epoch of its frames.
    ///
    /// # Errors
    /// [`TablesError`] when the tables have no such role, or need more room than `S`, `N` and `P`
    /// give.
    pub fn new(tables: &'a Tables<'a>, robot: RobotId, epoch: u32) -> Result<Self, TablesError> {
        let role = tables.role(robot.index());
        let role = role.ok_or(TablesError::of_team("roles", "there is none for this robot"))?;
        if tables.states() > S {
            return Err(TablesError::of_team("states", "there is not room for so many: see S"));
        }
        if tables.robots() > N || N > MAX_TEAM {
            return Err(TablesError::of_team("roles", "there is not room for so many: see N"));
        }
        if tables.policies() > P {
            return Err(TablesError::of_team("policies", "there is not room for so many: see P"));
        }
        let no_model = TablesError::of_team("factors", "they are no model");
        Ok(Self {
            tables,
            role,
            own: robot.index(),
            aim: role.aims.first().ok_or(no_model)?,
            beliefs: prior(role).ok_or(no_model)?,
            surprise: Ok(0.0),
            said: [None; N],
            observed: None,
            busy: false,
            pending: None,
            command: None,
            decision: None,
            thinking: None,
            is_current: false,
            intends: role.idle,
            wanted: None,
            budget: Self::BUDGET,
            left: Self::BUDGET,
            worked: 0,
            is_asked: false,
            is_agreed: false,
            rounds: TeamRounds::new(tables, robot, epoch, at_start(role, tables.confidence()))?,
            addition: PhantomData,
        })
    }

    /// Sets the most work units of a tick. A unit is one joint policy that is scored, for the
    /// robot's own decision or for the team's list, or looked at for the list; what is left is done
    /// in the next tick.
    ///
    /// What is decided does not depend on it, only when: a robot is as slow as its own decisions
    /// and the list, each [`policies`](Tables::policies) units. Teammates leave out a robot whose
    /// count does not change for 40 ticks, so a tick needs a 640th of them.
    pub const fn set_budget(&mut self, units: u32) {
        self.budget = units;
    }

    /// The work units of this tick so far.
    #[must_use]
    pub const fn work(&self) -> u32 {
        self.budget.saturating_sub(self.left)
    }

    /// Sets the aim by its number; returns whether there is one.
    pub fn pursue(&mut self, aim: u8) -> bool {
        let found = self.role.aims.get(usize::from(aim));
        self.aim = found.unwrap_or(self.aim);
        found.is_some()
    }

    /// The robot's role.
    #[must_use]
    pub const fn role(&self) -> &'a Role<'a> {
        self.role
    }

    /// Takes the readings of a tick into the belief, and no more: lines 5 and 6 for a robot that
    /// decides otherwise. Returns whether they were new.
    pub fn sense(&mut self, percept: &Percept) -> bool {
        if self.observed == Some(percept.at) {
            return false;
        }
        self.observed = Some(percept.at);
        self.worked = self.worked.wrapping_add(self.work());
        self.left = self.budget;
        (self.busy, self.command, self.is_current) = (percept.busy, None, false);
        if !percept.busy {
            let ended = self.pending.take();
            self.rounds.end();
            self.surprise = track(&mut self.beliefs, self.role, ended, &percept.readings);
        }
        true
    }

    /// Begins an operator that something else than the node has chosen: a plain leaf of the tree.
    pub fn begin(&mut self, command: Command) {
        (self.command, self.pending) = (Some(command), Some(command));
        (self.wanted, self.thinking) = (None, None);
    }

    /// Returns the command for the body, once; `None` for nothing new.
    #[must_use]
    pub const fn command(&self) -> Option<Command> {
        self.command
    }

    /// What the robot would announce now: the fact of a round that begins now.
    #[must_use]
    pub fn announcement(&self) -> Announcement {
        let under_way = self.pending.map_or(self.role.idle, |command| command.operator);
        let moving = |factor| self.operator(under_way).is_some_and(|operator| operator.changes(factor));
        let sure = |factor: usize| self.sure(factor).filter(|_| !moving(factor));
        let states = (0..self.role.factors.len()).map(|factor| sure(factor).map(|state| state as u8));
        let intends = if self.pending.is_some() { under_way } else { self.intends };
        Announcement::new(states, under_way, intends)
    }

    /// Takes part in the team's round by what this tick has come to, and returns what to announce.
    ///
    /// Call it once a tick, after the tree.
    #[must_use]
    pub fn announce(&mut self, peers: Peers<'_, TableMessage<X>>) -> TableMessage
    where
        X: Message,
    {
        let is_thinking = self.thinking.is_some();
        let is_free = self.pending.is_none() && self.is_settled() && !is_thinking;
        self.rounds.ask(self.announcement(), is_free, peers);
        if !self.is_asked || self.wanted.is_none() && !is_thinking {
            self.rounds.stay(peers, &mut self.left);
        } else {
            // The others need not wait until it is sure again: it wants what it wanted.
            self.score(peers);
        }
        self.rounds.note_waiting(peers);
        TableMessage { round: self.rounds.message(peers, self.progress()), own: () }
    }

    /// A count that changes as long as the robot works, so that no teammate takes it for stuck.
    fn progress(&self) -> u8 {
        let step = (self.tables.policies() / MAX_POLICIES).max(1) as u32;
        (self.worked.wrapping_add(self.work()) / step % (MAX_POLICIES as u32 + 1)) as u8
    }

    /// The team's rounds: the list of joint policies, the posterior over them, what is waited for.
    #[must_use]
    pub const fn rounds(&self) -> &TeamRounds<'a, N> {
        &self.rounds
    }

    /// The decision of this tick, if one was made.
    #[must_use]
    pub const fn decision(&self) -> Option<&JointDecision<S, N, P>> {
        if self.is_current { self.decision.as_ref() } else { None }
    }

    /// This robot's part of a joint policy, by the number of its operator.
    #[must_use]
    pub fn part(&self, policy: u16) -> u8 {
        self.tables.part(policy, self.own)
    }

    /// The state of a factor, if it is probable enough to act on; `None` while an operator is under
    /// way.
    #[must_use]
    pub fn sure(&self, factor: usize) -> Option<usize> {
        let belief = self.belief(factor);
        let state = math::argmax(belief);
        let probability = belief.get(state).copied().unwrap_or(0.0);
        (probability >= self.tables.confidence()).then_some(state)
    }

    /// Whether the robot is sure of all its factors, and no operator is under way.
    #[must_use]
    pub fn is_settled(&self) -> bool {
        !self.busy && (0..self.role.factors.len()).all(|factor| self.sure(factor).is_some())
    }

    /// q of one hidden factor.
    #[must_use]
    pub fn belief(&self, factor: usize) -> &[f32] {
        let (before, from) = self.role.factors.split_at_checked(factor).unwrap_or_default();
        let count = |factors: &[HiddenFactor<'_>]| factors.iter().map(|factor| factor.states.len()).sum();
        let (start, states): (usize, usize) = (count(before), count(from.get(..1).unwrap_or_default()));
        self.beliefs.as_flat().get(start..start + states).unwrap_or(&[])
    }

    /// q(s) of the semantic states, from the factors.
    #[must_use]
    pub fn states(&self) -> [f32; S] {
        let mut states = [0.0; S];
        let labels = &self.role.states;
        for (place, &label) in labels.table.iter().enumerate() {
            let (mut rest, mut mass) = (place, 1.0);
            for &factor in labels.factors.iter().rev() {
                let belief = self.belief(usize::from(factor));
                let count = belief.len().max(1);
                mass *= belief.get(rest % count).copied().unwrap_or(0.0);
                rest /= count;
            }
            if let Some(sum) = states.get_mut(usize::from(label)) {
                *sum += mass;
            }
        }
        states
    }

    /// A hash of the tables, for the firmware's `Robot::mission`.
    #[must_use]
    pub const fn mission(&self) -> u64 {
        self.tables.mission()
    }

    /// Checks a teammate's message against the tables, for the firmware's `Robot::accepts`.
    ///
    /// # Errors
    /// [`Invalid`] when no role has the states and the operators that it names, or its round is not
    /// one of this team.
    pub fn accepts(&self, said: &TableMessage<X>) -> Result<(), Invalid> {
        said.round.validate(self.tables.robots())?;
        if self.tables.roles().iter().any(|role| is_of(said.fact(), role)) {
            Ok(())
        } else {
            Err(Invalid("no role has these states and these operators"))
        }
    }

    /// F of the last readings, the surprise -ln P(o), in nats.
    ///
    /// # Errors
    /// [`ObservationError`] when they changed no belief.
    pub const fn surprise(&self) -> Result<f32, ObservationError> {
        self.surprise
    }

    /// What a teammate has announced for its newest round; `None` before it was heard, and while it
    /// is left out.
    #[must_use]
    pub fn teammate(&self, robot: usize) -> Option<Announcement> {
        self.said.get(robot).copied().flatten()
    }

    /// The facts that hold now, for a target.
    ///
    /// A teammate counts as doing its part of what the team has decided, else what it has
    /// announced.
    #[must_use]
    pub fn logic(&self, target: Option<u8>) -> Logic {
        self.logic_in(self.rounds.policy(), target)
    }

    /// The facts that hold while the teammates do their parts of a joint policy.
    fn logic_in(&self, policy: Option<u16>, target: Option<u8>) -> Logic {
        let facts = self.role.facts.iter().zip(0..);
        facts.fold(Logic::NONE, |logic, (fact, number)| logic.with(number, self.holds(fact, policy, target)))
    }

    fn holds(&self, fact: &Fact<'_>, policy: Option<u16>, target: Option<u8>) -> bool {
        let among = |list: &[u8], state: usize| list.iter().any(|&of| usize::from(of) == state);
        let doing = |robot: usize| match policy {
            Some(policy) => self.tables.part(policy, robot),
            None => self.teammate(robot).map_or(0, |said| said.operator()),
        };
        match fact.holds {
            Holds::Sure { factor, states } => {
                self.sure(usize::from(factor)).is_some_and(|state| among(states, state))
            }
            Holds::AtTarget { factor } => {
                self.sure(usize::from(factor)).is_some_and(|state| target.map(usize::from) == Some(state))
            }
            Holds::Announced { .. } | Holds::Doing { .. } => {
                holds_of_teammate(fact, &self.said, doing).unwrap_or(false)
            }
        }
    }

    fn operator(&self, operator: u8) -> Option<&'a Operator<'a>> {
        self.role.operators.get(usize::from(operator))
    }

    pub(super) fn unmet_of(&self, operator: u8, policy: Option<u16>, target: Option<u8>) -> Option<Literal> {
        let operator = self.operator(operator)?;
        let condition = Condition { all: Logic::of(operator.requires), none: Logic::of(operator.forbids) };
        condition.unmet(self.logic_in(policy, target))
    }

    /// What is missing for the own part of a joint policy.
    pub(super) fn unmet_in(&self, policy: u16, target: Option<u8>) -> Option<Literal> {
        self.unmet_of(self.part(policy), Some(policy), target)
    }
}

impl<const S: usize, const N: usize, const P: usize, X: Message> Task for TableTask<'_, S, N, P, X> {
    type Percept = Percept;
    type Message = TableMessage<X>;
    type Preference = Wanted<S, N>;
    type Candidates = Offered<N>;
    type Policy = Plan;

    fn observe(&mut self, percept: &Percept, peers: Peers<'_, TableMessage<X>>) {
        if self.sense(percept) {
            self.rounds.attend(self.announcement(), peers);
            let said = core::mem::replace(&mut self.said, self.rounds.said(peers));
            let is_asked = core::mem::take(&mut self.is_asked);
            self.wanted = self.wanted.filter(|_| is_asked);
            // What it thinks about is what was said.
            self.thinking = self.thinking.filter(|_| is_asked && said == self.said);
            if self.thinking.is_none() && !self.rounds.is_cut() {
                self.intends = self.role.idle;
            }
        }
    }

    fn is_done(&self) -> bool {
        let done = Condition { all: Logic::of(self.aim.done), none: Logic::NONE };
        self.is_settled() && done.unmet(self.logic(self.aim.target)).is_none()
    }

    fn preference(&self) -> Wanted<S, N> {
        let rows = core::array::from_fn(|robot| match self.tables.role(robot) {
            Some(_) if robot == self.own => row(self.aim.preference),
            Some(role) => self.wish(robot, role),
            None => row(&[]),
        });
        Wanted { rows, target: self.aim.target }
    }

    /// All operators, always: which of them may be begun, the preconditions say.
    fn candidates(&mut self, preference: &Wanted<S, N>, _: Peers<'_, TableMessage<X>>) -> Offered<N> {
        let announced = self.said.each_ref().map(|said| said.as_ref().map(Announcement::operator));
        Offered { target: preference.target, announced }
    }

    /// The robot's own choice, until nothing is missing for that; then it scores the policies of
    /// the round, and takes what the team has chosen.
    fn infer(
        &mut self,
        offered: &Offered<N>,
        preference: &Wanted<S, N>,
        peers: Peers<'_, TableMessage<X>>,
    ) -> Option<Plan> {
        (self.is_current, self.is_asked) = (false, true);
        self.is_agreed = self.busy || !self.is_settled() || self.rounds.is_alone();
        if self.busy {
            return Some(Plan::Continue);
        }
        if !self.is_settled() {
            return Some(Plan::Look);
        }
        // What it has decided is scored before it decides again.
        if self.wanted.is_some() && self.rounds.is_cut() {
            self.score(peers);
            if self.rounds.is_cut() {
                return None;
            }
        }
        let choice = self.think(offered, preference)?;
        if self.unmet_in(choice, offered.target).is_some() || self.rounds.is_alone() {
            return Some(Plan::Take(choice));
        }
        self.intends = self.part(choice);
        let own = preference.rows.get(self.own).map_or([0.0; S], Preference::values);
        let (states, operator) = (self.states(), self.intends);
        self.wanted = Some(Settled { preference: own, states, target: offered.target, operator });
        self.score(peers);
        Some(Plan::Take(self.agreed(choice, offered.target, peers)))
    }

    fn unmet(&self, plan: Plan, offered: &Offered<N>) -> Option<Literal> {
        match plan {
            Plan::Take(policy) => self.unmet_in(policy, offered.target),
            Plan::Continue | Plan::Look => None,
        }
    }

    fn raise(&mut self, missing: Literal, _: &Offered<N>, preference: &mut Wanted<S, N>) {
        let Some(remedy) = self.role.remedies.iter().find(|remedy| remedy.missing == missing) else { return };
        let largest = preference.rows.iter().map(Preference::largest).fold(0.0, f32::max);
        preference.target = remedy.target.or(preference.target);
        if let Some(own) = preference.rows.get_mut(self.own) {
            // The role's tables were checked: it has the state, and no amount is infinite.
            let _ = own.raise(usize::from(remedy.state), remedy.raise.amount(largest));
        }
    }

    fn is_connected(&self, _: Peers<'_, TableMessage<X>>) -> bool {
        self.is_agreed
    }

    fn execute(&mut self, plan: Plan, offered: &Offered<N>, _: Peers<'_, TableMessage<X>>) {
        let Plan::Take(policy) = plan else { return };
        let operator = self.part(policy);
        if operator != self.role.idle {
            let target =
                offered.target.filter(|_| self.operator(operator).is_some_and(Operator::is_targeted));
            self.begin(Command { operator, target });
            self.rounds.begin();
        }
    }

    fn wait(&mut self) {
        self.command = None;
    }
}

impl<const S: usize, const N: usize, const P: usize, X: Message> TableTask<'_, S, N, P, X> {
    /// What the robot may begin by what the team has decided, if there is something; else its own
    /// choice.
    fn agreed(&mut self, own: u16, target: Option<u8>, peers: Peers<'_, TableMessage<X>>) -> u16 {
        let due = self.rounds.due().filter(|&policy| self.unmet_in(policy, target).is_none());
        self.is_agreed = due.is_some() || self.rounds.goes_on(self.intends, &self.announcement(), peers);
        let choice = due.unwrap_or(own);
        if let Some(decision) = &mut self.decision {
            decision.choice = choice;
        }
        choice
    }
}

pub(super) fn row<const S: usize>(values: &[f32]) -> Preference<S> {
    Preference::from_fn(|state| values.get(state).copied().unwrap_or(0.0))
}

/// What a robot is sure of at the start.
fn at_start(role: &Role<'_>, confidence: f32) -> Announcement {
    let known = |factor: &HiddenFactor<'_>| {
        let state = math::argmax(factor.prior);
        factor.prior.get(state).filter(|&&p| p >= confidence).map(|_| state as u8)
    };
    Announcement::new(role.factors.iter().map(known), role.idle, role.idle)
}

/// Whether a role has all that an announcement names.
fn is_of(said: &Announcement, role: &Role<'_>) -> bool {
    let known = |(number, factor): (usize, &HiddenFactor<'_>)| {
        said.state(number).is_none_or(|state| usize::from(state) < factor.states.len())
    };
    usize::from(said.operator().max(said.intends())) < role.operators.len()
        && role.factors.iter().enumerate().all(known)
}
