//! A task described by tables: the lines of Algorithm 1.

use super::announcement::Announcement;
use super::definition::{Aim, Fact, HiddenFactor, Holds, MAX_SENSORS, Operator, Postcondition, Role, Wish};
use super::error::TablesError;
use super::model::{Question, prior, track};
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

/// The candidates of a decision: all operators of all robots, less what teammates have excluded by
/// announcing another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Offered<const N: usize> {
    target: Option<u8>,
    /// The operator that each teammate has under way, if it was heard.
    announced: [Option<u8>; N],
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
    /// The most probable joint policy in which the teammates do what they have announced.
    pub choice: u16,
}

/// A robot's part of a task written as tables.
///
/// `S`, `N` and `P` are the [`states`](Tables::states), [`robots`](Tables::robots) and
/// [`policies`](Tables::policies) of the tables, or more. `X` is what the robots add to their
/// [`Announcement`] for uses of their own.
#[derive(Clone, Debug)]
pub struct TableTask<'a, const S: usize, const N: usize, const P: usize, X = ()> {
    tables: &'a Tables<'a>,
    role: &'a Role<'a>,
    own: usize,
    aim: &'a Aim<'a>,
    beliefs: Beliefs<S, 1>,
    surprise: Result<f32, ObservationError>,
    /// The last announcement of each teammate.
    said: [Option<Announcement>; N],
    observed: Option<Instant>,
    busy: bool,
    /// The command under way.
    pending: Option<Command>,
    command: Option<Command>,
    decision: Option<JointDecision<S, N, P>>,
    addition: PhantomData<fn(X)>,
}

impl<'a, const S: usize, const N: usize, const P: usize, X> TableTask<'a, S, N, P, X> {
    /// Robot `robot` of the team at the start of the task, with its first aim.
    ///
    /// # Errors
    /// [`TablesError`] when the tables have no such role, or need more room than `S`, `N` and `P`
    /// give.
    pub fn new(tables: &'a Tables<'a>, robot: RobotId) -> Result<Self, TablesError> {
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
            addition: PhantomData,
        })
    }

    /// Sets the aim by its number; returns whether there is one.
    pub fn pursue(&mut self, aim: usize) -> bool {
        let found = self.role.aims.get(aim);
        self.aim = found.unwrap_or(self.aim);
        found.is_some()
    }

    /// The robot's role.
    #[must_use]
    pub const fn role(&self) -> &'a Role<'a> {
        self.role
    }

    /// Begins an operator that something else than the node has chosen: a plain leaf of the tree.
    pub fn begin(&mut self, command: Command) {
        (self.command, self.pending) = (Some(command), Some(command));
    }

    /// Returns the command for the body, once; `None` for nothing new.
    #[must_use]
    pub const fn command(&self) -> Option<Command> {
        self.command
    }

    /// The announcement of this robot to its teammates.
    #[must_use]
    pub fn announcement(&self) -> Announcement {
        let operator = self.pending.map_or(self.role.idle, |command| command.operator);
        let moving = |factor| self.operator(operator).is_some_and(|operator| operator.changes(factor));
        let sure = |factor: usize| self.sure(factor).filter(|_| !moving(factor));
        let states = (0..self.role.factors.len()).map(|factor| sure(factor).map(|state| state as u8));
        Announcement::new(states, operator, self.probability())
    }

    /// The decision of this tick, if one was made.
    #[must_use]
    pub const fn decision(&self) -> Option<&JointDecision<S, N, P>> {
        self.decision.as_ref()
    }

    /// This robot's part of a joint policy, by the number of its operator.
    #[must_use]
    pub fn part(&self, policy: u16) -> u8 {
        operator_of(self.tables, policy, self.own)
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
    /// [`Invalid`] when no role has the states and the operator that it names.
    pub fn accepts(&self, said: &Announcement<X>) -> Result<(), Invalid> {
        if self.tables.roles().iter().any(|role| is_of(said, role)) {
            Ok(())
        } else {
            Err(Invalid("no role has these states and this operator"))
        }
    }

    /// F of the last readings, the surprise -ln P(o), in nats.
    ///
    /// # Errors
    /// [`ObservationError`] when they changed no belief.
    pub const fn surprise(&self) -> Result<f32, ObservationError> {
        self.surprise
    }

    /// The last announcement of a teammate, while it is fresh.
    #[must_use]
    pub fn teammate(&self, robot: usize) -> Option<Announcement> {
        self.said.get(robot).copied().flatten()
    }

    /// The facts that hold now, for a target.
    #[must_use]
    pub fn logic(&self, target: Option<u8>) -> Logic {
        let facts = self.role.facts.iter().zip(0..);
        facts.fold(Logic::NONE, |logic, (fact, number)| logic.with(number, self.holds(fact, target)))
    }

    fn holds(&self, fact: &Fact<'_>, target: Option<u8>) -> bool {
        let among = |list: &[u8], state: usize| list.iter().any(|&of| usize::from(of) == state);
        let said = |robot: u8| self.teammate(usize::from(robot));
        match fact.holds {
            Holds::Sure { factor, states } => {
                self.sure(usize::from(factor)).is_some_and(|state| among(states, state))
            }
            Holds::AtTarget { factor } => {
                self.sure(usize::from(factor)).is_some_and(|state| target.map(usize::from) == Some(state))
            }
            Holds::Announced { robot, factor, states } => said(robot)
                .and_then(|said| said.state(usize::from(factor)))
                .is_some_and(|state| states.contains(&state)),
            Holds::Doing { robot, operators } => {
                said(robot).is_some_and(|said| operators.contains(&said.operator()))
            }
        }
    }

    fn operator(&self, operator: u8) -> Option<&'a Operator<'a>> {
        self.role.operators.get(usize::from(operator))
    }

    fn unmet_of(&self, operator: u8, target: Option<u8>) -> Option<Literal> {
        let operator = self.operator(operator)?;
        let condition = Condition { all: Logic::of(operator.requires), none: Logic::of(operator.forbids) };
        condition.unmet(self.logic(target))
    }

    fn part_of(&self, plan: Plan) -> u8 {
        match plan {
            Plan::Take(policy) => self.part(policy),
            Plan::Continue | Plan::Look => self.role.idle,
        }
    }

    /// The posterior probability of the last choice; one before the first.
    fn probability(&self) -> f32 {
        let of =
            |decision: &JointDecision<S, N, P>| decision.posterior.get(usize::from(decision.choice)).copied();
        self.decision.as_ref().and_then(of).unwrap_or(1.0)
    }

    /// The semantic state in a teammate's announcement.
    fn announced_state(&self, robot: usize) -> Option<usize> {
        let (said, role) = (self.teammate(robot)?, self.tables.role(robot)?);
        let known = |factor: &u8| said.state(usize::from(*factor)).is_some();
        let state = |factor| said.state(factor).map_or(0, usize::from);
        role.states.factors.iter().all(known).then(|| role.states.of(role.factors, state))
    }

    /// C of a teammate.
    fn wish(&self, robot: usize, role: &Role<'_>) -> Preference<S> {
        match self.aim.teammates {
            Wish::Rows(rows) => row(rows.get(robot).copied().unwrap_or(&[])),
            Wish::AsAnnounced => {
                let operator = self.teammate(robot).map_or(role.idle, |said| said.operator());
                let brings = role.operators.get(usize::from(operator)).map(|operator| operator.brings);
                let Some(Postcondition::State(state, _) | Postcondition::Reset(state, ..)) = brings else {
                    return row(&[]);
                };
                Preference::from_fn(|of| if of == usize::from(state) { 1.0 } else { 0.0 })
            }
        }
    }

    /// The best of the joint policies in which the teammates do what they announced; the first of
    /// equals.
    fn best(&self, posterior: &[f32; P], announced: &[Option<u8>; N]) -> Option<u16> {
        let mut best: Option<(u16, f32)> = None;
        for (policy, &p) in (0..).zip(posterior.iter().take(self.tables.policies())) {
            let fits = |(robot, announced): (usize, &Option<u8>)| {
                announced.is_none_or(|announced| announced == operator_of(self.tables, policy, robot))
            };
            if best.is_none_or(|(_, most)| p > most) && announced.iter().enumerate().all(fits) {
                best = Some((policy, p));
            }
        }
        best.map(|(policy, _)| policy)
    }

    fn decide(&self, offered: &Offered<N>, wanted: &Wanted<S, N>) -> Option<JointDecision<S, N, P>> {
        let states = self.states();
        let possible = |operator: u8| self.unmet_of(operator, offered.target).is_none();
        let outcome = self.role.outcome.as_ref().filter(|outcome| outcome.possible.is_none_or(possible));
        let question = Question {
            tables: self.tables,
            own: self.own,
            states: states.get(..self.role.states.names.len())?,
            announced: &core::array::from_fn(|robot| self.announced_state(robot)),
            preferences: &wanted.rows,
            outcome,
        };
        let (beliefs, posterior) = question.answer()?;
        let choice = self.best(&posterior, &offered.announced)?;
        let preferences = wanted.rows.each_ref().map(Preference::values);
        Some(JointDecision { preferences, beliefs, posterior, choice })
    }
}

impl<const S: usize, const N: usize, const P: usize, X: Message> Task for TableTask<'_, S, N, P, X> {
    type Percept = Percept;
    type Message = Announcement<X>;
    type Preference = Wanted<S, N>;
    type Candidates = Offered<N>;
    type Policy = Plan;

    fn observe(&mut self, percept: &Percept, peers: Peers<'_, Announcement<X>>) {
        if self.observed == Some(percept.at) {
            return;
        }
        self.observed = Some(percept.at);
        (self.busy, self.command, self.decision) = (percept.busy, None, None);
        self.said = [None; N];
        for peer in peers.fresh() {
            if let Some(slot) = self.said.get_mut(peer.sender().index()) {
                *slot = Some(peer.message().with(()));
            }
        }
        if !percept.busy {
            let ended = self.pending.take();
            self.surprise = track(&mut self.beliefs, self.role, ended, &percept.readings);
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
    fn candidates(&mut self, preference: &Wanted<S, N>, peers: Peers<'_, Announcement<X>>) -> Offered<N> {
        let mut offered = Offered { target: preference.target, announced: [None; N] };
        for peer in peers.fresh() {
            if let Some(slot) = offered.announced.get_mut(peer.sender().index()) {
                *slot = Some(peer.message().operator());
            }
        }
        offered
    }

    fn infer(
        &mut self,
        offered: &Offered<N>,
        preference: &Wanted<S, N>,
        _: Peers<'_, Announcement<X>>,
    ) -> Option<Plan> {
        self.decision = None;
        if self.busy {
            return Some(Plan::Continue);
        }
        if !self.is_settled() {
            return Some(Plan::Look);
        }
        self.decision = self.decide(offered, preference);
        self.decision.as_ref().map(|decision| Plan::Take(decision.choice))
    }

    fn unmet(&self, plan: Plan, offered: &Offered<N>) -> Option<Literal> {
        self.unmet_of(self.part_of(plan), offered.target)
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

    fn execute(&mut self, plan: Plan, offered: &Offered<N>, _: Peers<'_, Announcement<X>>) {
        let operator = self.part_of(plan);
        if operator != self.role.idle {
            let target =
                offered.target.filter(|_| self.operator(operator).is_some_and(Operator::is_targeted));
            self.begin(Command { operator, target });
        }
    }

    fn wait(&mut self) {
        self.command = None;
    }
}

fn row<const S: usize>(values: &[f32]) -> Preference<S> {
    Preference::from_fn(|state| values.get(state).copied().unwrap_or(0.0))
}

/// A robot's part of a joint policy: the last robot's operators run fastest.
fn operator_of(tables: &Tables<'_>, policy: u16, robot: usize) -> u8 {
    let later = tables.roles().iter().skip(robot + 1).map(|role| role.operators.len());
    let own = tables.role(robot).map_or(1, |role| role.operators.len().max(1));
    let rest = usize::from(policy) / later.product::<usize>().max(1);
    (rest % own) as u8
}

/// Whether a role has all that an announcement names.
fn is_of<X>(said: &Announcement<X>, role: &Role<'_>) -> bool {
    let known = |(number, factor): (usize, &HiddenFactor<'_>)| {
        said.state(number).is_none_or(|state| usize::from(state) < factor.states.len())
    };
    usize::from(said.operator()) < role.operators.len() && role.factors.iter().enumerate().all(known)
}
