//! A robot's part in the rounds of its team.

use super::announcement::{Announcement, TableMessage};
use super::error::TablesError;
use super::joint::{Known, List, MAX_POLICIES, OnTables, operator_of};
use super::tables::Tables;
use crate::inference::WeighedPolicies;
use crate::team::rounds::{
    Digest, Event, Own, RoundMessage, Rounds, Score, Scores, Teammates, Timing, Waiting, Want,
};
use crate::team::{Member, Message, Peers, RobotId};

/// The rounds in which the robots of a task decide on one joint policy.
///
/// | | |
/// |---|---|
/// | fact | the [`Announcement`]: states, the operator under way, the one that the robot intends |
/// | list | at most [`MAX_POLICIES`] joint policies whose preconditions hold by the facts of all |
/// | scores | what each policy costs the robot by its own belief and C: -G in eighths of a nat |
/// | choice | the least sum of scores and -ln E / γ, the first of equals |
/// | claim | nothing |
///
/// A robot opens a round when it is sure of something else than it has announced, when its part is
/// done, successful or not, when it would choose what it has not told the team, and when a plain
/// leaf of its tree has begun an operator. An operator that is under way stays in every policy of
/// the list.
#[doc(alias = "joint decision")]
#[derive(Clone, Debug)]
pub struct TeamRounds<'a, const N: usize> {
    tables: &'a Tables<'a>,
    rounds: Rounds<Announcement, MAX_POLICIES>,
    /// The list of the round, and what it was made from.
    list: List,
    listed: Option<Digest>,
    weighed: WeighedPolicies<MAX_POLICIES>,
    /// How far the robot is with its part of the choice.
    part: Part,
    /// The operator that its scores speak for.
    scored_for: u8,
    waiting: Option<Waiting>,
}

/// How far a robot is with its part of the choice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    /// It has not begun.
    Due,
    UnderWay,
    Done,
}

impl<'a, const N: usize> TeamRounds<'a, N> {
    pub(super) fn new(
        tables: &'a Tables<'a>,
        robot: RobotId,
        epoch: u32,
        fact: Announcement,
    ) -> Result<Self, TablesError> {
        let too_large = TablesError::of_team("roles", "there are more than a team can have");
        let member = Member::new(robot, tables.robots()).map_err(|_| too_large)?;
        Ok(Self {
            tables,
            rounds: Rounds::new(member, epoch, tables.mission(), fact, Timing::DEFAULT),
            list: List::new(),
            listed: None,
            weighed: WeighedPolicies::default(),
            part: Part::Due,
            scored_for: fact.operator(),
            waiting: None,
        })
    }

    /// The state of the rounds.
    #[must_use]
    pub const fn state(&self) -> &Rounds<Announcement, MAX_POLICIES> {
        &self.rounds
    }

    /// The numbers of the joint policies of this round, as far as it is known.
    #[must_use]
    pub fn listed(&self) -> &[u16] {
        &self.list
    }

    /// The posterior over the joint policies of the list, and what each costs the team; empty
    /// before the choice.
    #[must_use]
    pub const fn weighed(&self) -> &WeighedPolicies<MAX_POLICIES> {
        &self.weighed
    }

    /// The joint policy that the team has chosen, by its number.
    #[must_use]
    pub fn policy(&self) -> Option<u16> {
        self.list.get(self.rounds.protocol().policy()?).copied()
    }

    /// Why the robot does not go on, and which teammate it waits for.
    #[must_use]
    pub const fn waiting(&self) -> Option<Waiting> {
        self.waiting
    }

    /// Whether the robot has no teammates: it decides without rounds.
    pub(super) const fn is_alone(&self) -> bool {
        self.tables.robots() == 1
    }

    /// The choice, as long as the robot's part is to be begun.
    pub(super) fn due(&self) -> Option<u16> {
        let is_under_way = self.fact().operator() != self.idle();
        self.policy().filter(|_| self.part == Part::Due && !is_under_way)
    }

    /// Whether a joint policy leaves the robot with what it had under way when it joined the round.
    pub(super) fn stays(&self, policy: u16) -> bool {
        self.part(policy) == self.fact().operator()
    }

    fn part(&self, policy: u16) -> u8 {
        operator_of(self.tables, policy, self.own())
    }

    fn own(&self) -> usize {
        self.rounds.protocol().member().robot().index()
    }

    fn idle(&self) -> u8 {
        self.tables.role(self.own()).map_or(0, |role| role.idle)
    }

    /// What the robot has announced for this round.
    const fn fact(&self) -> &Announcement {
        self.rounds.protocol().fact()
    }

    /// Notes that the robot begins its part.
    pub(super) const fn begin(&mut self) {
        self.part = Part::UnderWay;
    }

    /// Notes that an operator has ended.
    pub(super) const fn end(&mut self) {
        if matches!(self.part, Part::UnderWay) {
            self.part = Part::Done;
        }
    }

    /// Hears the teammates: joins a round, or learns the choice. Whatever it has under way, a robot
    /// can join: that goes into its fact.
    pub(super) fn attend<X: Message>(&mut self, fact: Announcement, peers: Peers<'_, TableMessage<X>>) {
        if self.is_alone() {
            return;
        }
        let (teammates, own) = (Teammates::from(peers), Own { fact: &fact, is_standing: true });
        let list = OnTables { tables: self.tables, policies: &self.list };
        let event = self.rounds.tick(own, &teammates, &list);
        self.note(event, &teammates);
    }

    fn note(&mut self, event: Option<Event>, teammates: &Teammates<'_, Announcement, MAX_POLICIES>) {
        match event {
            Some(Event::Joined(_) | Event::Opened(_)) => {
                (self.listed, self.part) = (None, Part::Due);
                self.list.clear();
                self.weighed = WeighedPolicies::default();
            }
            Some(Event::Decided(_)) => self.weigh(teammates),
            None => {}
        }
    }

    /// Keeps the posterior over the policies, for displays and logs.
    fn weigh(&mut self, teammates: &Teammates<'_, Announcement, MAX_POLICIES>) {
        let list = OnTables { tables: self.tables, policies: &self.list };
        self.weighed = list.weigh(self.rounds.protocol().scores(teammates));
    }

    /// What the other members have announced, by their newest messages.
    pub(super) fn said<X: Message>(&self, peers: Peers<'_, TableMessage<X>>) -> [Option<Announcement>; N] {
        let (view, teammates) = (self.rounds.proposal().view, Teammates::from(peers));
        core::array::from_fn(|robot| {
            let robot = RobotId(robot as u8);
            let heard = teammates.get(robot).filter(|_| view.contains(robot));
            heard.map(|heard| heard.message.fact)
        })
    }

    /// Makes the list, once the facts of all members are known; returns whether the robot's scores
    /// of it are missing.
    pub(super) fn prepare<X: Message>(&mut self, peers: Peers<'_, TableMessage<X>>) -> bool {
        let teammates = Teammates::from(peers);
        let Some(digest) = self.rounds.protocol().wanted(&teammates) else { return false };
        if self.listed != Some(digest) {
            let mut said = [None; N];
            for (robot, fact) in self.rounds.protocol().facts(&teammates) {
                if let Some(place) = said.get_mut(robot.index()) {
                    *place = Some(*fact);
                }
            }
            self.list = Known { tables: self.tables, said: &said }.list();
            self.listed = Some(digest);
        }
        true
    }

    /// Gives the robot's scores of the list, which speak for an operator, and learns the choice if
    /// they are the last.
    pub(super) fn give<X: Message>(
        &mut self,
        scores: Scores<MAX_POLICIES>,
        operator: u8,
        peers: Peers<'_, TableMessage<X>>,
    ) {
        let (Some(digest), teammates) = (self.listed, Teammates::from(peers)) else { return };
        let list = OnTables { tables: self.tables, policies: &self.list };
        let is_open =
            |(&policy, score): (&u16, &Score)| self.part(policy) == operator && *score != Score::CANNOT;
        let is_for = self.list.iter().zip(&scores).any(is_open);
        if self.rounds.protocol_mut().give(digest, scores, &list, &teammates).is_ok() {
            self.scored_for = if is_for { operator } else { self.fact().operator() };
        }
        if self.rounds.protocol().has_decided() {
            self.weigh(&teammates);
        }
    }

    /// Opens a round, if `fact` asks for one and the robot is free; and scores the list of a round
    /// in which its tree has nothing to decide: it goes on with what it does.
    pub(super) fn conclude<X: Message>(
        &mut self,
        fact: Announcement,
        is_free: bool,
        peers: Peers<'_, TableMessage<X>>,
    ) {
        if self.is_alone() {
            return;
        }
        if let Some(want) = self.want(&fact, is_free) {
            let event = self.rounds.ask(want, &fact);
            self.note(event, &Teammates::from(peers));
        }
        if self.prepare(peers) {
            let score = |&policy: &u16| if self.stays(policy) { Score::default() } else { Score::CANNOT };
            let scores = self.list.iter().map(score).collect();
            self.give(scores, self.fact().operator(), peers);
        }
        let list = OnTables { tables: self.tables, policies: &self.list };
        self.waiting = self.rounds.waiting(&Teammates::from(peers), &list);
    }

    /// Whether another decision is needed, by what the robot would announce now.
    fn want(&self, fact: &Announcement, is_free: bool) -> Option<Want> {
        let is_of_round = [self.idle(), self.fact().operator()].contains(&fact.operator());
        let has_begun_else = self.part != Part::UnderWay && !is_of_round;
        let is_news =
            self.part == Part::Done || !fact.is_as(self.fact()) || self.is_overlooked(fact.intends());
        (has_begun_else || is_free && is_news).then_some(Want::Needed)
    }

    /// Whether the robot would choose an operator that the choice does not have for it, and that
    /// its scores did not speak for: it was not sure then, or the list had no room.
    fn is_overlooked(&self, operator: u8) -> bool {
        let is_served = self.policy().is_some_and(|policy| self.part(policy) == operator);
        !is_served && self.scored_for != operator
    }

    /// What to announce.
    pub(super) fn message<X: Message>(
        &self,
        peers: Peers<'_, TableMessage<X>>,
    ) -> RoundMessage<Announcement, MAX_POLICIES> {
        let policy = self.rounds.protocol().policy();
        let probability = policy.map_or(0.0, |policy| self.weighed.probability(policy));
        self.rounds.protocol().message(&Teammates::from(peers), self.list.len() as u8, probability)
    }
}
