//! What a robot makes of the running plan by what it has read since: inference at every tick.

use super::super::outlook::{Done, after};
use super::super::policies::{HAS_UNKNOWNS, TeamPlan, ahead, moves_of};
use super::super::prospects::{Certainty, Robots};
use super::super::unknown::MAX_WORLDS;
use super::super::{AnnouncedReadings, Fact};
use super::Navigation;
use crate::bounded::up_to;
use crate::grid::CellSet;
use crate::inference::Eighths;
use crate::team::rounds::Teammates;
use heapless::Vec;

/// How much likelier another plan must be than what is left of this one, in nats: e times.
const ODDS: f32 = 1.0;

/// The ticks after a choice in which the robot does not want another because of what it has read,
/// unless it has made a move.
const REST: u8 = 10;

/// The ticks after which a robot no longer waits for what others may have read at the end of a
/// plan.
const PATIENCE: u8 = 3;

/// The probability with which a cell is blocked from which on a robot does not go there.
const SHUT: f32 = 0.9;

/// What a robot makes of the running plan.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct OwnOutlook {
    /// What it had read, and how many moves all had made, when it last weighed the rest of the
    /// plan.
    weighed: Option<(AnnouncedReadings, u16)>,
    /// Whether another plan is better by what it knows now.
    is_outdated: bool,
    /// The ticks since the choice.
    ticks: u8,
    /// The ticks since all members have reported that they have made all their moves.
    idle: u8,
}

impl OwnOutlook {
    pub(super) const NONE: Self = Self { weighed: None, is_outdated: false, ticks: 0, idle: 0 };
}

impl<const S: usize, const W: usize, const L: usize, const M: usize, const K: usize>
    Navigation<'_, S, W, L, M, K>
{
    /// The belief over the worlds: by the facts of the round, but for what this robot has read
    /// since.
    pub(super) fn belief(&self) -> Vec<f32, MAX_WORLDS> {
        self.policies.prospects().belief_after(self.mission, self.robot(), &self.told())
    }

    /// Whether another plan is better by what the robot knows now.
    pub(in crate::navigation) const fn is_outdated(&self) -> bool {
        self.outlook.is_outdated
    }

    /// Whether the team's work is not known to be done where its plan ends: it is unlikely, or this
    /// robot may find out from where it stands, or it knows that its own goal is not the one. Any
    /// other leaves it to those that can tell.
    pub(in crate::navigation) fn is_unsure(&self) -> bool {
        let Some(ends) = self.ends().filter(|_| self.policies.is_branching()) else { return false };
        let (prospects, belief) = (self.policies.prospects(), self.belief());
        let here = self.standing().filter(|&cell| prospects.has_sight(cell));
        match prospects.are_done(self.mission, &belief, &ends) {
            Certainty::Known => false,
            Certainty::Likely => {
                let may_tell = |cell| prospects.is_informative(self.mission, cell, &belief);
                let is_in_vain = |cell| prospects.is_in_vain(self.mission, &belief, cell);
                here.is_some_and(may_tell) || self.standing().is_some_and(is_in_vain)
            }
            Certainty::Unlikely => true,
        }
    }

    /// Where the members that go to goals end by the plan.
    fn ends(&self) -> Option<Robots> {
        let plan = self.plan()?;
        Some(up_to(self.policies.seekers().paths(plan).map(|path| path.end(&self.mission.map))))
    }

    /// Weighs what is left of the running plan against another decision, if the robot has read
    /// something since it last did so, or the plan has come to its end.
    pub(super) fn weigh_rest(&mut self, teammates: &Teammates<'_, Fact<W>, K>) {
        if !HAS_UNKNOWNS || self.mission.unknowns.is_empty() {
            return;
        }
        self.outlook.ticks = self.outlook.ticks.saturating_add(1);
        let is_idle = self.has_decided() && self.are_all_done(teammates);
        self.outlook.idle = if is_idle { self.outlook.idle.saturating_add(1) } else { 0 };
        let told = self.told();
        let Some(moves) = self.course().map(|(_, moves)| moves) else { return };
        let has_news = self.has_untold();
        let may_ask = moves > 0 || self.outlook.ticks >= REST;
        if !may_ask || !(has_news || self.outlook.idle >= PATIENCE) {
            self.outlook.is_outdated = false;
            return;
        }
        let moves = self.made(teammates).map_or(0, |done| done.moves.iter().sum());
        let question = Some((told, moves));
        if self.outlook.weighed != question {
            // What it has not told may make sure those that are not.
            let may_help = self.outlook.idle >= PATIENCE && has_news && self.is_unsure();
            self.outlook.is_outdated = may_help || self.finds_better(teammates);
            self.outlook.weighed = question;
        }
    }

    /// The cells of which the robot knows from what it has read that they are blocked.
    pub(super) fn shut(&self) -> CellSet<W> {
        if !HAS_UNKNOWNS || self.mission.unknowns.is_empty() {
            return CellSet::EMPTY;
        }
        self.policies.prospects().blocked(self.mission, &self.belief(), SHUT)
    }

    /// Whether the robot has read something since its fact was frozen.
    fn has_untold(&self) -> bool {
        self.announced().is_some_and(|fact| fact.readings != self.told())
    }

    /// How much later each policy is by what the robot has read since its fact was frozen, in
    /// eighths of a tick, beside the one that gains most by it.
    ///
    /// It goes into the delays, the largest of which counts: what all members see counts once.
    /// Where the tick has no room for it, the robot leaves it to the next decision.
    pub(super) fn later(&self) -> Vec<Eighths, K> {
        let decider = self.mission.decider();
        if !HAS_UNKNOWNS || !self.has_untold() || !decider.infers() || !decider.shares() {
            return Vec::new();
        }
        let (prospects, seekers, belief) =
            (self.policies.prospects(), self.policies.seekers(), self.belief());
        let plans = self.policies.plans().iter().zip(self.policies.expected());
        if (self.left as usize) < plans.len() * belief.len() {
            return Vec::new();
        }
        let shifts = plans.map(|(plan, before)| {
            let now = prospects.expected(self.mission, plan, seekers, Done::NOTHING, &belief);
            i32::from(now.total()) - i32::from(before.total())
        });
        let shifts: Vec<i32, K> = up_to(shifts);
        let least = shifts.iter().copied().min().unwrap_or(0);
        up_to(shifts.iter().map(|shift| (shift - least) as Eighths))
    }

    /// The moves that each member has made, by what it has reported; of a plan that is being
    /// followed.
    fn made(&self, teammates: &Teammates<'_, Fact<W>, K>) -> Option<Done> {
        let rounds = self.rounds.as_ref()?;
        let (own, view) = (self.robot(), rounds.proposal().view);
        let mut done = Done { own: view.place(own), ..Done::NOTHING };
        for (robot, moves) in view.iter().zip(&mut done.moves) {
            let step = teammates.get(robot).map_or(0, |heard| heard.message.answer.step());
            *moves = if robot == own { rounds.protocol().step() } else { step };
        }
        Some(done)
    }

    /// Where the members are, by what they have reported.
    pub(super) fn members_at(&self, teammates: &Teammates<'_, Fact<W>, K>) -> CellSet<W> {
        let mut cells: CellSet<W> = [self.localisation.position().0].into_iter().collect();
        match self.plan().zip(self.made(teammates)) {
            Some((plan, done)) => {
                let paths = plan.paths().iter().zip(done.moves);
                paths.for_each(|(path, made)| _ = cells.insert(after(&self.mission.map, path, made)));
            }
            None => teammates.iter().for_each(|(_, heard)| _ = cells.insert(heard.message.fact.anchor)),
        }
        cells
    }

    fn are_all_done(&self, teammates: &Teammates<'_, Fact<W>, K>) -> bool {
        let Some((plan, done)) = self.plan().zip(self.made(teammates)) else { return false };
        plan.paths().iter().zip(done.moves).all(|(path, made)| made >= moves_of(path))
    }

    /// The plan that is being followed.
    fn plan(&self) -> Option<&TeamPlan> {
        let policy = self.rounds.as_ref()?.protocol().policy()?;
        self.policies.plans().get(policy)
    }

    /// Whether another decision is better than what is left of the plan, by more than it costs.
    fn finds_better(&self, teammates: &Teammates<'_, Fact<W>, K>) -> bool {
        let belief = self.belief();
        let (prospects, map) = (self.policies.prospects(), &self.mission.map);
        if !self.policies.is_branching() {
            // All robots go to the goals of the world that was the likeliest.
            let assumed = prospects.likeliest();
            return belief.get(assumed).is_some_and(|&p| p < 0.5);
        }
        let Some((plan, done)) = self.plan().zip(self.made(teammates)) else { return false };
        let shut = prospects.blocked(self.mission, &belief, SHUT);
        let mut left = plan.paths().iter().zip(done.moves).flat_map(|(path, made)| ahead(path, map, made));
        if left.any(|(_, cell)| shut.contains(cell)) {
            return true;
        }
        let (seekers, decider) = (self.policies.seekers(), self.mission.decider());
        if !decider.infers() {
            return self.ends().is_some_and(|ends| prospects.is_refuted(decider, seekers, &ends, &belief));
        }
        let rest = prospects.expected(self.mission, plan, seekers, done, &belief);
        let anew = prospects.anew(self.mission, &seekers.cells(map, plan, &done), &belief);
        let ticks = 0.125 * (f32::from(rest.total()) - f32::from(anew.total()));
        let odds = ODDS + self.mission.habit;
        // A team that has nothing left to do loses nothing.
        let is_kept = !self.are_all_done(teammates) && self.mission.precision * ticks <= odds;
        ticks > 0.0 && !is_kept
    }
}
