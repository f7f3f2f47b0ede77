//! The lines of Algorithm 1 for a navigating robot: facts, the list, the choice, the next move.
//!
//! What the paper calls a preference is here what the robot is for: any goal, unless an unmet
//! precondition asks for a way-point or the charger first. Raising it opens a round; it falls back
//! once a plan that serves it is followed.

use super::{Cause, Fact, GridPercept, Intention, Navigation, Purpose};
use crate::iibt::{Condition, Literal, Logic, Task};
use crate::team::Peers;

/// The logic variable that is true while a blocked cell is on what is left of the plan.
pub const BLOCKED: u8 = 0;
/// The logic variable that is true while the robot is where its path says.
pub const ON_COURSE: u8 = 1;
/// The logic variable that is true while the battery is full enough, or the plan leads to the
/// charger.
pub const CHARGED: u8 = 2;
/// The logic variable that is true while the plan leads to the next way-point, if there is one.
pub const VISITED: u8 = 3;
/// The logic variable that is true unless the plan serves an errand that is done.
pub const SERVED: u8 = 4;
/// The logic variable that is false at the end of a plan that misses a goal.
pub const REACHED: u8 = 5;
/// The logic variable that is false while the robot's readings do not follow its moves.
pub const PROGRESS: u8 = 6;
/// The logic variable that is false while another plan is better by what the robot has read since.
pub const CURRENT: u8 = 7;

/// What must hold for a joint policy to be followed.
pub const PRECONDITION: Condition = Condition {
    all: Logic::of(&[ON_COURSE, CHARGED, VISITED, SERVED, REACHED, PROGRESS, CURRENT]),
    none: Logic::of(&[BLOCKED]),
};

/// The joint policy that all members have chosen, by its number in their list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct JointPolicy(pub usize);

impl<const S: usize, const W: usize, const L: usize, const M: usize, const K: usize>
    Navigation<'_, S, W, L, M, K>
{
    /// Returns the logic variables as of now, for the plan that is being followed.
    #[must_use]
    pub fn logic(&self) -> Logic {
        let announced = self.announced().map_or(Purpose::Goal, |fact| fact.purpose);
        let wanted = self.purpose();
        let serves = |is_kind: fn(&Purpose) -> bool| !is_kind(&wanted) || announced == wanted;
        Logic::NONE
            .with(BLOCKED, self.is_plan_blocked())
            .with(ON_COURSE, self.is_on_course())
            .with(CHARGED, serves(|purpose| matches!(purpose, Purpose::Charge(_) | Purpose::Stand)))
            .with(VISITED, serves(|purpose| matches!(purpose, Purpose::Visit(_))))
            .with(SERVED, serves(|purpose| *purpose == Purpose::Goal))
            .with(REACHED, !self.is_complete() || !self.misses_a_goal())
            .with(PROGRESS, !self.is_stuck())
            .with(CURRENT, !self.is_outdated())
    }

    /// Whether the plan leaves a goal out that it should reach.
    fn misses_a_goal(&self) -> bool {
        self.failure().is_some() || self.short_by() > 0
    }

    /// The goals that the plan leaves out, of those that it should reach.
    pub(super) fn short_by(&self) -> usize {
        let policy = self.rounds().and_then(|rounds| rounds.protocol().policy());
        policy.and_then(|policy| self.policies().get(policy)).map_or(0, |plan| plan.short_by())
    }

    /// Whether the robot has done all it is for: it is sure to stand at the end of a plan that
    /// leads all robots to goals, has no errand, and takes none over from a lost teammate.
    #[must_use]
    pub fn has_arrived(&self) -> bool {
        let is_bound = self.purpose() == Purpose::Goal
            && self.announced().is_some_and(|fact: &Fact<W>| fact.purpose == Purpose::Goal);
        is_bound
            && self.is_complete()
            && self.is_on_course()
            && self.standing().is_some()
            && !self.is_in_doubt()
            && !self.misses_a_goal()
            && !self.is_unsure()
            && !self.may_take_over()
    }
}

impl<const S: usize, const W: usize, const L: usize, const M: usize, const K: usize> Task
    for Navigation<'_, S, W, L, M, K>
{
    type Percept = GridPercept;
    type Message = Intention<W, K>;
    type Preference = Purpose;
    type Candidates = ();
    type Policy = JointPolicy;

    fn observe(&mut self, percept: &GridPercept, peers: Peers<'_, Self::Message>) {
        self.take_in(percept, peers);
    }

    fn is_done(&self) -> bool {
        self.has_arrived()
    }

    fn is_connected(&self, _: Peers<'_, Self::Message>) -> bool {
        self.members_follow()
    }

    fn preference(&self) -> Purpose {
        Purpose::Goal
    }

    fn candidates(&mut self, purpose: &Purpose, peers: Peers<'_, Self::Message>) {
        self.ask(*purpose, peers);
        self.list(peers);
    }

    fn infer(&mut self, (): &(), _: &Purpose, peers: Peers<'_, Self::Message>) -> Option<JointPolicy> {
        self.choose(peers).map(JointPolicy)
    }

    fn unmet(&self, _: JointPolicy, (): &()) -> Option<Literal> {
        PRECONDITION.unmet(self.logic())
    }

    fn raise(&mut self, missing: Literal, (): &(), purpose: &mut Purpose) {
        let cause = match missing.variable {
            _ if self.is_stuck() && !self.has_told_that_it_is_stuck() => Cause::NoProgress,
            BLOCKED => Cause::Obstacle,
            ON_COURSE => Cause::Position,
            CHARGED => Cause::Battery,
            VISITED => Cause::WayPoint,
            SERVED => Cause::Free,
            PROGRESS => return,
            CURRENT => Cause::Reading,
            // Another round would come to the same as long as nothing new is known.
            _ if self.has_news() => Cause::Shortfall,
            _ => return,
        };
        *purpose = self.purpose();
        self.want(cause);
    }

    fn execute(&mut self, _: JointPolicy, (): &(), _: Peers<'_, Self::Message>) {
        self.follow();
    }

    fn wait(&mut self) {
        self.stand();
        self.try_move();
    }
}
