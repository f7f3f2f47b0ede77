//! A robot's part in the rounds of its team.

use super::announcement::{Announcement, TableMessage};
use super::error::TablesError;
use super::joint::{Known, List, Listing, MAX_POLICIES, OnTables, holds_of_teammate, prices};
use super::tables::Tables;
use crate::bounded::up_to;
use crate::inference::WeighedPolicies;
use crate::team::rounds::{
    Digest, Event, Own, RoundMessage, Rounds, Score, Scores, Teammates, Timing, View, Waiting, Want,
};
use crate::team::{Freshness, Member, Message, Peers, RobotId};
use heapless::Vec;

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
///
/// A robot that is done with its part goes on without a round where a round could decide nothing
/// else: the choice costs the others nothing, they are heard, and neither an outcome nor a
/// precondition ties them to what it does. It opens one all the same, at work, if what it has
/// brought about makes a fact of a teammate true or false.
#[doc(alias = "joint decision")]
#[derive(Clone, Debug)]
pub struct TeamRounds<'a, const N: usize> {
    tables: &'a Tables<'a>,
    rounds: Rounds<Announcement, MAX_POLICIES>,
    /// The list of the round, and what it is made from.
    listing: Listing,
    listed: Option<Digest>,
    /// -G of the first policies of the list.
    values: Vec<f32, MAX_POLICIES>,
    /// Whether there was not budget enough to score the list.
    is_cut: bool,
    weighed: WeighedPolicies<MAX_POLICIES>,
    /// The members that the choice costs nothing.
    content: View,
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
    /// It is done, and the robot is at work on what it does next.
    Ahead,
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
            listing: Listing::default(),
            listed: None,
            values: Vec::new(),
            is_cut: false,
            weighed: WeighedPolicies::default(),
            content: View::EMPTY,
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

    /// The numbers of the joint policies of this round; none before all are known.
    #[must_use]
    pub fn listed(&self) -> &[u16] {
        self.listing.policies()
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
        self.listed().get(self.rounds.protocol().policy()?).copied()
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
        self.tables.part(policy, self.own())
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

    /// Notes that the robot begins its part, or what it does after that.
    pub(super) fn begin(&mut self) {
        self.part = if self.due().is_some() { Part::UnderWay } else { Part::Ahead };
    }

    /// Notes that an operator has ended.
    pub(super) const fn end(&mut self) {
        if matches!(self.part, Part::UnderWay | Part::Ahead) {
            self.part = Part::Done;
        }
    }

    /// Whether the robot, which is free and would announce `fact`, may begin an operator without
    /// another round.
    pub(super) fn goes_on<X: Message>(
        &self,
        operator: u8,
        fact: &Announcement,
        peers: Peers<'_, TableMessage<X>>,
    ) -> bool {
        let (own, idle) = (self.own(), self.idle());
        let is_over = self.part == Part::Done || self.fact().operator() != idle;
        let mut others = self.rounds.proposal().view.iter().filter(|robot| robot.index() != own);
        // All that the others could have begun while it is idle was in the list, and cost more.
        let may_hold_up =
            self.fact().operator() == idle && self.listed().len() < MAX_POLICIES && !self.tells(fact);
        let said = self.facts(&Teammates::from(peers));
        let known = Known { tables: self.tables, said: &said };
        let has_part = self.policy().filter(|&choice| self.part(choice) != idle);
        let is_content = |robot| self.content.contains(robot) && peers.freshness(robot) == Freshness::Fresh;
        operator != idle
            && is_over
            && others.all(is_content)
            && has_part.is_some_and(|choice| known.goes_on(choice, own, operator, may_hold_up))
    }

    /// Hears the teammates: joins a round, or learns the choice. Whatever it has under way, a robot
    /// can join: that goes into its fact.
    pub(super) fn attend<X: Message>(&mut self, fact: Announcement, peers: Peers<'_, TableMessage<X>>) {
        if self.is_alone() {
            return;
        }
        // Where every joint policy has room in the list, what it intends need not be told anew: the
        // others have taken its fact to last.
        let is_lasting = self.tables.policies() < MAX_POLICIES && fact.is_as(self.fact());
        let fact = if is_lasting { *self.fact() } else { fact };
        let teammates = Teammates::from(peers);
        let own = Own { fact: &fact, is_standing: true, expected: View::EMPTY };
        let list = OnTables { tables: self.tables, policies: self.listing.policies() };
        let (event, _) = self.rounds.tick(own, &teammates, &list);
        self.note(event, &teammates);
    }

    fn note(&mut self, event: Option<Event>, teammates: &Teammates<'_, Announcement, MAX_POLICIES>) {
        match event {
            Some(Event::Joined(_) | Event::Opened(_)) => {
                self.part = Part::Due;
                self.restart(None);
                self.weighed = WeighedPolicies::default();
            }
            Some(Event::Decided(_)) => self.weigh(teammates),
            None => {}
        }
    }

    /// Begins with another list.
    fn restart(&mut self, digest: Option<Digest>) {
        (self.listed, self.is_cut) = (digest, false);
        self.listing = Listing::default();
        self.values.clear();
    }

    /// Keeps the posterior over the policies, for displays and logs.
    fn weigh(&mut self, teammates: &Teammates<'_, Announcement, MAX_POLICIES>) {
        let list = OnTables { tables: self.tables, policies: self.listing.policies() };
        let protocol = self.rounds.protocol();
        self.weighed = list.weigh(protocol.scores(teammates));
        let is_free = |scores: &[Score]| scores.get(protocol.policy()?).map(|score| score.price == 0);
        let free = protocol.scores(teammates).filter(|(_, scores)| is_free(scores) == Some(true));
        self.content = free.map(|(robot, _)| robot).collect();
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

    /// The facts of the members of the round.
    fn facts(&self, teammates: &Teammates<'_, Announcement, MAX_POLICIES>) -> [Option<Announcement>; N] {
        let mut said = [None; N];
        for (robot, fact) in self.rounds.protocol().facts(teammates) {
            if let Some(place) = said.get_mut(robot.index()) {
                *place = Some(*fact);
            }
        }
        said
    }

    /// Works on the list, once the facts of all members are known; returns whether it is done, or
    /// `None` if there is no list to score.
    fn prepare<X: Message>(&mut self, peers: Peers<'_, TableMessage<X>>, budget: &mut u32) -> Option<bool> {
        let teammates = Teammates::from(peers);
        let digest = self.rounds.protocol().wanted(&teammates).filter(|_| !self.is_alone())?;
        if self.listed != Some(digest) {
            self.restart(Some(digest));
        }
        let said = self.facts(&teammates);
        Some(self.listing.work(&Known { tables: self.tables, said: &said }, budget))
    }

    /// The policies of the list that come next to be valued, as many as the budget is enough for;
    /// `None` if there is no list to score.
    pub(super) fn unvalued<X: Message>(
        &mut self,
        peers: Peers<'_, TableMessage<X>>,
        budget: &mut u32,
    ) -> Option<List> {
        let is_listed = self.prepare(peers, budget);
        self.is_cut = is_listed == Some(false);
        is_listed.filter(|&is_listed| is_listed)?;
        let next = self.listed().iter().copied().skip(self.values.len());
        let next: List = up_to(next.take(usize::try_from(*budget).unwrap_or(usize::MAX)));
        *budget = budget.saturating_sub(next.len() as u32);
        Some(next)
    }

    /// Takes in -G of the policies that came next. Once all are known, gives the robot's scores: an
    /// operator speaks for those `possible`.
    pub(super) fn value<X: Message>(
        &mut self,
        values: &[f32],
        possible: &[u16],
        operator: u8,
        peers: Peers<'_, TableMessage<X>>,
    ) {
        // There is room for the whole list.
        let _ = self.values.extend_from_slice(values);
        self.is_cut = self.values.len() < self.listed().len();
        if self.is_cut {
            return;
        }
        let value = |(policy, value): (&u16, &f32)| Some(*value).filter(|_| possible.contains(policy));
        let scores = prices(self.listed().iter().zip(&self.values).map(value));
        let is_for = possible.iter().any(|&policy| self.part(policy) == operator);
        self.scored_for = if is_for { operator } else { self.fact().operator() };
        self.give(scores, peers);
    }

    /// Gives the robot's scores of the list, and learns the choice if they are the last.
    fn give<X: Message>(&mut self, scores: Scores<MAX_POLICIES>, peers: Peers<'_, TableMessage<X>>) {
        let (Some(digest), teammates) = (self.listed, Teammates::from(peers)) else { return };
        self.is_cut = false;
        let list = OnTables { tables: self.tables, policies: self.listing.policies() };
        // They belong to the facts of now: that was asked first.
        let _ = self.rounds.protocol_mut().give(digest, scores, &list, &teammates);
        if self.rounds.protocol().has_decided() {
            self.weigh(&teammates);
        }
    }

    /// Opens a round, if `fact` asks for one and the robot may.
    pub(super) fn ask<X: Message>(
        &mut self,
        fact: Announcement,
        is_free: bool,
        peers: Peers<'_, TableMessage<X>>,
    ) {
        if let Some(want) = self.want(&fact, is_free).filter(|_| !self.is_alone()) {
            let event = self.rounds.ask(want, &fact);
            self.note(event, &Teammates::from(peers));
        }
    }

    /// Scores the list of a round in which the robot's tree has nothing to decide: it goes on with
    /// what it does.
    pub(super) fn stay<X: Message>(&mut self, peers: Peers<'_, TableMessage<X>>, budget: &mut u32) {
        if self.prepare(peers, budget) == Some(true) {
            let score = |&policy: &u16| if self.stays(policy) { Score::default() } else { Score::CANNOT };
            let scores = up_to(self.listed().iter().map(score));
            self.scored_for = self.fact().operator();
            self.give(scores, peers);
        }
    }

    /// Whether the robot has scores to give that the budget of a tick was not enough for.
    pub(super) const fn is_cut(&self) -> bool {
        self.is_cut
    }

    /// Notes what the robot waits for.
    pub(super) fn note_waiting<X: Message>(&mut self, peers: Peers<'_, TableMessage<X>>) {
        let list = OnTables { tables: self.tables, policies: self.listing.policies() };
        let waiting = self.rounds.waiting(&Teammates::from(peers), &list);
        self.waiting = waiting.filter(|_| !self.is_alone());
    }

    /// Whether another decision is needed, by what the robot would announce now.
    fn want(&self, fact: &Announcement, is_free: bool) -> Option<Want> {
        let is_of_round = [self.idle(), self.fact().operator()].contains(&fact.operator());
        let has_begun_else = !matches!(self.part, Part::UnderWay | Part::Ahead) && !is_of_round;
        let is_told = self.part == Part::Ahead && self.tells(fact);
        let is_news =
            self.part == Part::Done || !fact.is_as(self.fact()) || self.is_overlooked(fact.intends());
        (has_begun_else || is_told || is_free && is_news).then_some(Want::Needed)
    }

    /// Whether what the robot would announce now makes a fact of a teammate true or false.
    fn tells(&self, fact: &Announcement) -> bool {
        let own = self.own();
        let said = |fact: &Announcement| core::array::from_fn(|robot| Some(*fact).filter(|_| robot == own));
        let (before, now): ([_; N], [_; N]) = (said(self.fact()), said(fact));
        let is_changed = |fact| {
            let holds = |said| holds_of_teammate(fact, said, |_| self.fact().operator());
            holds(&before) != holds(&now)
        };
        let roles = self.tables.roles().iter().enumerate();
        roles.filter(|&(robot, _)| robot != own).any(|(_, role)| role.facts.iter().any(is_changed))
    }

    /// Whether the robot would choose an operator that the choice does not have for it, and that
    /// its scores did not speak for: it was not sure then, or the list had no room.
    fn is_overlooked(&self, operator: u8) -> bool {
        let is_served = self.policy().is_some_and(|policy| self.part(policy) == operator);
        !is_served && self.scored_for != operator
    }

    /// What to announce; `done` changes as long as the robot works on its scores.
    pub(super) fn message<X: Message>(
        &self,
        peers: Peers<'_, TableMessage<X>>,
        done: u8,
    ) -> RoundMessage<Announcement, MAX_POLICIES> {
        let policy = self.rounds.protocol().policy();
        let probability = policy.map_or(0.0, |policy| self.weighed.probability(policy));
        self.rounds.protocol().message(&Teammates::from(peers), done, probability)
    }
}
