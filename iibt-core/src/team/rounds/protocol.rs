//! The rules that safety rests on: what one robot may join, open, score and decide.

use super::super::{MAX_TEAM, Member, RobotId};
use super::reach::{Location, Reach};
use super::{
    Answer, Choice, Claim, Digest, Fact, JointPolicies, Proposal, RoundMessage, Score, Scores, Teammates,
    View, Waiting,
};
use crate::bounded::up_to;

/// What happened in a tick, for the log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Event {
    /// The robot joined the round of this number.
    Joined(u32),
    /// It opened the round of this number.
    Opened(u32),
    /// It knows the choice: the number of the policy, or that all are impossible.
    Decided(Option<usize>),
}

/// One robot's place in the rounds: all that it says and does follows from this state and from the
/// newest messages of the others.
///
/// It has no clock: whatever the radio loses, delays or repeats, and whenever robots open rounds or
/// start again, no two plans meet. When to open a round is left to [`Rounds`](super::Rounds).
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Protocol<F: Fact, const K: usize> {
    pub(super) member: Member,
    pub(super) epoch: u32,
    pub(super) mission: u64,
    pub(super) proposal: Proposal<F::Claim>,
    pub(super) fact: F,
    pub(super) given: Option<Given<K>>,
    pub(super) located: [Location<F::Claim>; MAX_TEAM],
}

/// The scores that a robot has given in its round.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct Given<const K: usize> {
    pub(super) digest: Digest,
    pub(super) scores: Scores<K>,
    /// The epochs of the members, under the digest.
    pub(super) epochs: [u32; MAX_TEAM],
    pub(super) plan: Option<Plan>,
}

/// What all members decided, and how far this robot is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Plan {
    pub(super) policy: Option<u8>,
    pub(super) step: u16,
}

impl<F: Fact, const K: usize> Protocol<F, K> {
    /// The state of a robot that has just started, for the `epoch`-th time, and stands.
    ///
    /// The epoch must be larger than in any start before. `mission` stands for whatever else the
    /// list depends on: the mission and the sizes of its generator.
    #[must_use]
    pub const fn new(member: Member, epoch: u32, mission: u64, fact: F) -> Self {
        Self {
            member,
            epoch,
            mission,
            proposal: Proposal::first(member.team()),
            fact,
            given: None,
            located: [const { Location { reach: Reach::Anywhere, known: (0, 0) } }; MAX_TEAM],
        }
    }

    /// The robot and its team.
    #[must_use]
    pub const fn member(&self) -> Member {
        self.member
    }

    /// The round that the robot is in.
    #[must_use]
    pub const fn proposal(&self) -> &Proposal<F::Claim> {
        &self.proposal
    }

    /// Its fact, frozen when it joined.
    #[must_use]
    pub const fn fact(&self) -> &F {
        &self.fact
    }

    /// The digest of the list that it has scored.
    #[must_use]
    pub fn digest(&self) -> Option<Digest> {
        self.given.as_ref().map(|given| given.digest)
    }

    /// Whether it knows what all members decided.
    #[must_use]
    pub fn has_decided(&self) -> bool {
        self.plan().is_some()
    }

    /// Whether it knows that every policy is impossible for some member.
    #[must_use]
    pub fn is_vetoed(&self) -> bool {
        self.plan().is_some_and(|plan| plan.policy.is_none())
    }

    /// The policy that all members decided on; `None` before, and if all are impossible.
    #[must_use]
    pub fn policy(&self) -> Option<usize> {
        self.plan()?.policy.map(usize::from)
    }

    /// The number of steps of its path that are done.
    #[must_use]
    pub fn step(&self) -> u16 {
        self.plan().map_or(0, |plan| plan.step)
    }

    /// Hears the teammates; then joins a newer round, if the robot stands at the place of `fact`,
    /// or decides, if it can. `list` is the one that was scored in this round; before, it is not
    /// looked at.
    pub fn attend<L>(
        &mut self,
        fact: &F,
        is_standing: bool,
        teammates: &Teammates<'_, F, K>,
        list: &L,
    ) -> Option<Event>
    where
        L: JointPolicies<Claim = F::Claim>,
    {
        self.hear(teammates, list);
        self.take_back(teammates);
        if is_standing && self.join(fact, teammates) {
            Some(Event::Joined(self.proposal.round))
        } else if self.decide(list, teammates) {
            Some(Event::Decided(self.policy()))
        } else {
            None
        }
    }

    /// Joins the newest round that a teammate is in, if it is newer than the own; returns whether
    /// it did.
    ///
    /// Call it only while the robot stands at the place of `fact`.
    fn join(&mut self, fact: &F, teammates: &Teammates<'_, F, K>) -> bool {
        let heard = teammates.iter().filter(|&(robot, heard)| self.is_current(robot, heard));
        let newest = heard.map(|(_, heard)| &heard.message.proposal).max_by_key(|proposal| proposal.round);
        let newer = newest.filter(|proposal| proposal.round > self.proposal.round);
        if let Some(proposal) = newer {
            self.enter(proposal.clone(), fact);
        }
        newer.is_some()
    }

    /// Opens a round with these members.
    ///
    /// Call it only while the robot stands at the place of `fact`.
    ///
    /// # Errors
    /// What is in the way, as of [`may_open`](Self::may_open); nothing has changed.
    pub fn open(&mut self, view: View, fact: &F) -> Result<(), Waiting> {
        let round = self.may_open(view)?;
        let left_out = View::full(self.member.team()).difference(view);
        let walls = left_out.iter().map(|robot| self.wall_of(robot).to_wire(left_out.len()));
        self.enter(Proposal { round, view, walls: up_to(walls) }, fact);
        Ok(())
    }

    /// Returns the number of the round that the robot could open with these members.
    ///
    /// # Errors
    /// What the robot waits for if it may not: the view is [no quorum](Waiting::Quorum) or [without
    /// it](Waiting::Members), a robot left out may be [anywhere](Waiting::Unheard), or [no number
    /// is left](Waiting::Rounds).
    pub fn may_open(&self, view: View) -> Result<u32, Waiting> {
        self.is_seated(view)?;
        let left_out = View::full(self.member.team()).difference(view);
        if let Some(robot) = left_out.iter().find(|&robot| self.reach(robot).is_none()) {
            return Err(Waiting::Unheard(robot));
        }
        self.next_round().ok_or(Waiting::Rounds)
    }

    /// Returns the digest of the list to work on now, from [these facts](Self::facts) with [these
    /// walls](Proposal::left_out). Whenever it changes, the work begins again.
    #[must_use]
    pub fn wanted(&self, teammates: &Teammates<'_, F, K>) -> Option<Digest> {
        if self.given.is_some() { None } else { self.common(teammates).ok() }
    }

    /// Gives this robot's scores of the list that belongs to a digest.
    ///
    /// A robot gives once for a digest, and does not change what it gave.
    ///
    /// # Errors
    /// What is missing: [the list](Waiting::List) if this one belongs to other facts. Nothing was
    /// given then.
    pub fn give<L>(
        &mut self,
        digest: Digest,
        scores: Scores<K>,
        list: &L,
        teammates: &Teammates<'_, F, K>,
    ) -> Result<(), Waiting>
    where
        L: JointPolicies<Claim = F::Claim>,
    {
        // What was heard since the last tick counts first, or else it would later narrow what the
        // scores widen.
        self.hear(teammates, list);
        if self.given.is_some() || self.common(teammates)? != digest {
            return Err(Waiting::List);
        }
        // Before anything is sent: once the scores are out, a teammate may follow any policy.
        self.widen(list);
        self.given = Some(Given { digest, scores, epochs: self.epochs(teammates), plan: None });
        self.decide(list, teammates);
        Ok(())
    }

    /// Decides, if every member's scores of the same list are known; returns whether it did.
    fn decide<L>(&mut self, list: &L, teammates: &Teammates<'_, F, K>) -> bool
    where
        L: JointPolicies<Claim = F::Claim>,
    {
        let Some(plan) = self.decided(list, teammates) else { return false };
        if let Some(given) = &mut self.given {
            given.plan = Some(plan);
        }
        self.hear(teammates, list);
        true
    }

    /// Counts a step of the path, once the robot is at its end.
    pub fn advance(&mut self) {
        if let Some(plan) = self.given.as_mut().and_then(|given| given.plan.as_mut()) {
            plan.step = plan.step.saturating_add(1);
        }
    }

    /// What to announce now. `listed` policies of the list are done; the choice has this
    /// probability.
    #[must_use]
    pub fn message(
        &self,
        teammates: &Teammates<'_, F, K>,
        listed: u8,
        probability: f32,
    ) -> RoundMessage<F, K> {
        let answer = match &self.given {
            None => Answer::Listing(listed.min(K as u8)),
            Some(Given { digest, scores, plan: None, .. }) => {
                Answer::Scored { digest: *digest, scores: scores.clone() }
            }
            Some(Given { digest, scores, plan: Some(plan), .. }) => Answer::Decided {
                digest: *digest,
                scores: Some(scores.clone()).filter(|_| !self.all_have_decided(teammates)),
                choice: plan.policy.map(|policy| Choice::new(policy, probability)),
                step: plan.step,
            },
        };
        RoundMessage { proposal: self.proposal.clone(), fact: self.fact.clone(), answer }
    }

    /// The other members of the round.
    pub(super) fn others(&self) -> impl Iterator<Item = RobotId> + Clone + use<F, K> {
        self.proposal.view.without(self.member.robot()).iter()
    }

    /// Whether the robot is in a view that may decide.
    pub(super) fn is_seated(&self, view: View) -> Result<(), Waiting> {
        let team = self.member.team();
        if !view.contains(self.member.robot()) {
            return Err(Waiting::Members);
        }
        match View::full(team).difference(view).iter().next() {
            Some(robot) if !view.is_quorum(team) => Err(Waiting::Quorum(robot)),
            _ => Ok(()),
        }
    }

    /// Whether every robot that is left out is where the round says: what a member must know before
    /// it takes part. For one that may be anywhere it relies on the members' check of the walls,
    /// [if they have made it](Self::is_vouched).
    pub(super) fn accepts_walls(&self, is_vouched: bool) -> Result<(), Waiting> {
        let left_out = View::full(self.member.team()).difference(self.proposal.view);
        for robot in left_out.iter() {
            let reach = self.reach(robot);
            if reach.is_none() && is_vouched {
                continue;
            }
            let Some(reach) = reach else { return Err(Waiting::Unheard(robot)) };
            let wall = self.proposal.wall(robot, self.member.team());
            if !wall.is_some_and(|wall| wall.contains(reach)) {
                return Err(Waiting::Wall(robot));
            }
        }
        Ok(())
    }

    fn decided<L>(&self, list: &L, teammates: &Teammates<'_, F, K>) -> Option<Plan>
    where
        L: JointPolicies<Claim = F::Claim>,
    {
        self.given.as_ref().filter(|given| given.plan.is_none())?;
        if self.scores(teammates).count() < self.proposal.view.len() {
            return None;
        }
        let policy = list.choose(self.scores(teammates));
        Some(Plan { policy: policy.and_then(|policy| u8::try_from(policy).ok()), step: 0 })
    }

    /// The scores of the members that have scored the list that this robot has scored, as far as
    /// they are still sent.
    pub fn scores<'a>(
        &'a self,
        teammates: &Teammates<'a, F, K>,
    ) -> impl Iterator<Item = (RobotId, &'a [Score])> + Clone {
        let teammates = *teammates;
        let scored = move |robot| {
            if robot == self.member.robot() {
                return Some((robot, self.given.as_ref()?.scores.as_slice()));
            }
            let heard = self.newest(robot, &teammates).filter(|&heard| self.follows(heard))?;
            Some((robot, heard.message.answer.scores()?.as_slice()))
        };
        self.proposal.view.iter().filter_map(scored)
    }

    fn all_have_decided(&self, teammates: &Teammates<'_, F, K>) -> bool {
        self.others().all(|robot| {
            let heard = self.newest(robot, teammates).filter(|&heard| self.follows(heard));
            heard.is_some_and(|heard| matches!(heard.message.answer, Answer::Decided { .. }))
        })
    }

    pub(super) fn plan(&self) -> Option<&Plan> {
        self.given.as_ref()?.plan.as_ref()
    }

    fn enter(&mut self, proposal: Proposal<F::Claim>, fact: &F) {
        self.proposal = proposal;
        self.fact = fact.clone();
        self.given = None;
    }

    /// The claim of a robot to be left out: with that of the present round, if this robot refuses
    /// it, so that no two robots refuse each other's for ever.
    fn wall_of(&self, robot: RobotId) -> F::Claim {
        let reach = self.reach(robot).cloned().unwrap_or(F::Claim::EMPTY);
        match self.proposal.wall(robot, self.member.team()) {
            Some(wall) if self.accepts_walls(false).is_err() => wall.union(&reach),
            _ => reach,
        }
    }

    /// The next number of this robot above the present round. Every robot has numbers of its own,
    /// so that no two robots open the same round.
    fn next_round(&self) -> Option<u32> {
        let team = self.member.team().max(1) as u32;
        let ahead = (u32::from(self.member.robot().0) + team - self.proposal.round % team - 1) % team + 1;
        self.proposal.round.checked_add(ahead)
    }
}
