//! Where each teammate may be.

use super::super::RobotId;
use super::protocol::Plan;
use super::{Claim, Fact, Heard, JointPolicies, Protocol, Teammates};

/// Where a teammate may be.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct Location<C> {
    pub(super) reach: Reach<C>,
    /// Epoch and round of the newest message that was taken into account.
    pub(super) known: (u32, u32),
}

/// What a robot knows of where a teammate may be.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) enum Reach<C> {
    /// Anywhere: this robot does not know what it was told before it started.
    Anywhere,
    /// Here, as the members of a round know that left the teammate out. No message of its own has
    /// answered this start.
    Vouched(C),
    /// Here, by the teammate's own answer and what it has said since.
    Answered(C),
}

impl<C> Reach<C> {
    pub(super) const fn claim(&self) -> Option<&C> {
        match self {
            Self::Anywhere => None,
            Self::Vouched(claim) | Self::Answered(claim) => Some(claim),
        }
    }

    const fn is_answered(&self) -> bool {
        matches!(self, Self::Answered(_))
    }

    /// The same knowledge with another claim; where a robot that was anywhere is now is known
    /// from the members only.
    fn with(&self, claim: C) -> Self {
        if self.is_answered() { Self::Answered(claim) } else { Self::Vouched(claim) }
    }
}

impl<F: Fact, const K: usize> Protocol<F, K> {
    /// Where a teammate may be; `None`: anywhere.
    #[must_use]
    pub fn reach(&self, robot: RobotId) -> Option<&F::Claim> {
        self.located.get(robot.index())?.reach.claim()
    }

    /// Whether a teammate has answered this start: it has scored a list whose digest holds this
    /// robot's epoch, so it is alive, and no recording. Until then its round and its fact count
    /// only to make the question that it answers.
    #[doc(alias = "challenge")]
    #[must_use]
    pub fn has_answered(&self, robot: RobotId) -> bool {
        self.located.get(robot.index()).is_some_and(|location| location.reach.is_answered())
    }

    /// Takes in where the teammates may be by what they say. The list is the one that was scored in
    /// this round.
    pub(super) fn hear<L>(&mut self, teammates: &Teammates<'_, F, K>, list: &L)
    where
        L: JointPolicies<Claim = F::Claim>,
    {
        for (robot, heard) in teammates.iter() {
            self.locate(robot, heard, list);
        }
    }

    /// Takes in where one teammate may be.
    fn locate<L>(&mut self, robot: RobotId, heard: Heard<'_, F, K>, list: &L)
    where
        L: JointPolicies<Claim = F::Claim>,
    {
        let message = heard.message;
        let rest = self.follows(heard).then(|| self.rest(robot, heard, list));
        let Some(location) = self.located.get_mut(robot.index()) else { return };
        let stamp = (heard.stamp.epoch, message.proposal.round);
        if stamp < location.known {
            return;
        }
        // A robot that has just started believes no message before one that answers its new epoch:
        // the teammate may be on a plan that it has heard of in its life before.
        let anchor = || message.fact.anchor();
        let is_news = stamp > location.known && location.reach.is_answered();
        location.known = stamp;
        if let Some(reach) = rest.or_else(|| is_news.then(anchor)) {
            location.reach = Reach::Answered(reach);
        }
    }

    /// What a teammate that follows may still occupy: the rest of its path, or of all paths as long
    /// as the choice is not known.
    fn rest<L>(&self, robot: RobotId, heard: Heard<'_, F, K>, list: &L) -> F::Claim
    where
        L: JointPolicies<Claim = F::Claim>,
    {
        let (anchor, step) = (heard.message.fact.anchor(), heard.message.answer.step());
        match self.plan() {
            Some(Plan { policy: Some(policy), .. }) => list.claim((*policy).into(), robot, step),
            Some(Plan { policy: None, .. }) => anchor,
            None => any_of(list, robot, step, anchor),
        }
    }

    /// Takes in that every other member may follow any policy, and that those left out are within
    /// their walls.
    pub(super) fn widen<L>(&mut self, list: &L)
    where
        L: JointPolicies<Claim = F::Claim>,
    {
        let (own, team) = (self.member.robot(), self.member.team());
        for (robot, location) in (0..).map(RobotId).zip(&mut self.located) {
            if let Some(wall) = self.proposal.wall(robot, team) {
                location.reach = location.reach.with(wall);
            } else if robot != own
                && robot.index() < team
                && let Some(reach) = location.reach.claim().cloned()
            {
                location.reach = location.reach.with(any_of(list, robot, 0, reach));
            }
        }
    }
}

/// What a robot may occupy on any path of a list from a step on, and `more`.
fn any_of<L: JointPolicies>(list: &L, robot: RobotId, step: u16, more: L::Claim) -> L::Claim {
    (0..list.len()).fold(more, |reach, policy| reach.union(&list.claim(policy, robot, step)))
}
