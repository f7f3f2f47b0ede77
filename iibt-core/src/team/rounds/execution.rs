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
        self.has_moves_left(list)
            && self.others().all(|robot| self.obstacle(robot, teammates, list).is_none())
    }

    /// Whether the robot has yet to make a step of the chosen policy.
    pub(super) fn has_moves_left<L: JointPolicies>(&self, list: &L) -> bool {
        self.course(list).is_some_and(|(_, step, moves)| step < moves)
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
            return Some(self.missing(teammates));
        }
        self.first(self.obstacles(teammates, list))
    }

    /// Why members keep this robot from going on, one after the other.
    pub(super) fn obstacles<L>(
        &self,
        teammates: &Teammates<'_, F, K>,
        list: &L,
    ) -> impl Iterator<Item = Waiting>
    where
        L: JointPolicies<Claim = F::Claim>,
    {
        let course = self.course(list);
        self.others().filter_map(move |robot| self.obstacle_on(course, robot, teammates, list))
    }

    /// What the robot waits for before it has scored.
    pub(super) fn missing(&self, teammates: &Teammates<'_, F, K>) -> Waiting {
        self.common(teammates).err().unwrap_or(Waiting::List)
    }

    /// What the robot waits for after that, by the obstacles that its teammates are.
    pub(super) fn first(&self, obstacles: impl Iterator<Item = Waiting>) -> Option<Waiting> {
        let first = obstacles.min_by_key(|obstacle| obstacle.is_in_plan());
        if self.is_vetoed() { Some(Waiting::Policy) } else { first }
    }

    /// Why a member keeps this robot from going on, if it does.
    pub fn obstacle<L>(&self, robot: RobotId, teammates: &Teammates<'_, F, K>, list: &L) -> Option<Waiting>
    where
        L: JointPolicies<Claim = F::Claim>,
    {
        self.obstacle_on(self.course(list), robot, teammates, list)
    }

    /// The chosen policy, the steps that this robot has made in it, and all that it is to make.
    fn course<L: JointPolicies>(&self, list: &L) -> Option<(usize, u16, u16)> {
        let policy = self.policy()?;
        Some((policy, self.step(), list.moves(policy, self.member().robot())))
    }

    fn obstacle_on<L>(
        &self,
        course: Option<(usize, u16, u16)>,
        robot: RobotId,
        teammates: &Teammates<'_, F, K>,
        list: &L,
    ) -> Option<Waiting>
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
        let differs = !self.follows(heard);
        match heard.message.answer.digest() {
            None => Some(Waiting::Scores(robot)),
            // One of the two has taken a fact to last that did not, and gives again.
            Some(_) if F::LASTS && !self.has_decided() && differs => Some(Waiting::Scores(robot)),
            Some(_) if differs => Some(Waiting::Outdated(robot)),
            Some(_) if !self.has_decided() => {
                Some(Waiting::Scores(robot)).filter(|_| heard.message.answer.scores().is_none())
            }
            Some(_) => self.plan_obstacle(course?, robot, heard.message.answer.step(), list),
        }
    }

    /// Why a member that follows the same plan keeps this robot from going on.
    fn plan_obstacle<L>(
        &self,
        (policy, step, moves): (usize, u16, u16),
        robot: RobotId,
        reported: u16,
        list: &L,
    ) -> Option<Waiting>
    where
        L: JointPolicies<Claim = F::Claim>,
    {
        let (own, theirs) = (self.member().robot(), || list.moves(policy, robot));
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
