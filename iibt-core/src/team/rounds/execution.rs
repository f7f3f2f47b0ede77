//! When the next step may begin, and whom a robot waits for.

use super::super::RobotId;
use super::{Answer, Fact, Heard, JointPolicies, Protocol, Teammates, Waiting};

impl<F: Fact, const K: usize> Protocol<F, K> {
    /// Whether the robot may begin its next step now: it occupies both ends until it calls
    /// [`advance`](Self::advance).
    ///
    /// The robots keep the order of the plan, not its clock.
    pub fn may_move<L>(&self, teammates: &Teammates<'_, F, K>, list: &L) -> bool
    where
        L: JointPolicies<Claim = F::Claim>,
    {
        let moves = self.policy().map_or(0, |policy| list.moves(policy, self.member().robot()));
        self.step() < moves && self.others().all(|robot| self.obstacle(robot, teammates, list).is_none())
    }

    /// What the robot waits for; `None` if it [may move](Self::may_move), or has nothing more to
    /// do.
    ///
    /// A member that does not follow the plan is named before one that has yet to make its moves.
    pub fn waiting<L>(&self, teammates: &Teammates<'_, F, K>, list: &L) -> Option<Waiting>
    where
        L: JointPolicies<Claim = F::Claim>,
    {
        if self.digest().is_none() {
            return Some(self.common(teammates).err().unwrap_or(Waiting::List));
        }
        let impossible = self.is_vetoed().then_some(Waiting::Policy);
        let obstacles = self.others().filter_map(|robot| self.obstacle(robot, teammates, list));
        // A single pass: an ordinary tick is mostly this.
        impossible.or_else(|| obstacles.min_by_key(|obstacle| obstacle.is_in_plan()))
    }

    /// Why a member keeps this robot from going on, if it does.
    pub fn obstacle<L>(&self, robot: RobotId, teammates: &Teammates<'_, F, K>, list: &L) -> Option<Waiting>
    where
        L: JointPolicies<Claim = F::Claim>,
    {
        let heard = self.newest(robot, teammates);
        if heard.is_some_and(|heard| self.has_restarted(robot, heard)) {
            return Some(Waiting::Outdated(robot));
        }
        if let Err(missing) = self.is_in_round(robot, teammates) {
            return Some(missing);
        }
        let (heard, _) = heard.zip(self.digest())?;
        match heard.message.answer.digest() {
            None => Some(Waiting::Scores(robot)),
            // One of the two has taken a fact to last that did not, and gives again.
            Some(_) if F::LASTS && !self.has_decided() && !self.follows(heard) => {
                Some(Waiting::Scores(robot))
            }
            Some(_) if !self.follows(heard) => Some(Waiting::Outdated(robot)),
            Some(_) => self.plan_obstacle(robot, heard, list),
        }
    }

    /// Why a member that has scored the same list keeps this robot from going on.
    fn plan_obstacle<L>(&self, robot: RobotId, heard: Heard<'_, F, K>, list: &L) -> Option<Waiting>
    where
        L: JointPolicies<Claim = F::Claim>,
    {
        if !self.has_decided() {
            return Some(Waiting::Scores(robot)).filter(|_| heard.message.answer.scores().is_none());
        }
        let (own, policy) = (self.member().robot(), self.policy()?);
        let (step, reported) = (self.step(), heard.message.answer.step());
        let (moves, theirs) = (list.moves(policy, own), || list.moves(policy, robot));
        let is_last = step.saturating_add(1) == moves && list.is_together(policy);
        if step >= moves {
            Some(Waiting::Arrival(robot)).filter(|_| reported < theirs())
        } else if !list.is_clear(policy, own, step, robot, reported) {
            Some(Waiting::Order(robot))
        } else {
            Some(Waiting::Barrier(robot)).filter(|_| is_last && reported.saturating_add(1) < theirs())
        }
    }

    /// How far a robot is, for the question whether it goes on: its round, its stage, its count.
    pub(super) fn progress(heard: Heard<'_, F, K>) -> (u32, u8, u16) {
        let (stage, count) = match heard.message.answer {
            Answer::Listing(done) => (0, done.into()),
            Answer::Scored { .. } => (1, 0),
            Answer::Decided { step, .. } => (2, step),
        };
        (heard.message.proposal.round, stage, count)
    }
}
