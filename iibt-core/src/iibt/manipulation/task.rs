//! Handling as the task of the inference node: the lines of Algorithm 1.

use super::decision::Question;
use super::deed::{Command, Deed, Joint, RULES, evidence};
use super::{Aim, Manipulation, Plan};
use crate::iibt::rules::raise_for;
use crate::iibt::{Literal, Task};

impl Task for Manipulation {
    type Policy = Plan;

    fn prepare(&mut self) {
        self.heading = self.place_of(self.aim.deed());
        self.preferences = self.wanted();
    }

    /// The readings came with [`perceive`](Manipulation::perceive).
    fn observe(&mut self) {}

    fn update(&mut self) {
        self.track();
    }

    /// All four actions, always: which of them may be done, the preconditions say.
    fn candidates(&mut self) {}

    fn intentions(&mut self) {
        self.decision = None;
        if self.percept.busy {
            return;
        }
        let question = Question {
            preset: self.mission.preset,
            own: self.robot.index(),
            states: self.tracking.states(),
            teammate: self.teammate(),
            preferences: &self.preferences,
            placer: self.may(Deed::Place).then_some(self.robot.index()),
        };
        self.decision = question.decide();
    }

    fn infer(&mut self) -> Option<Plan> {
        if self.percept.busy {
            return Some(Plan::Continue);
        }
        if !self.is_sure() {
            return Some(Plan::Look);
        }
        if self.has_reached(self.aim) {
            // Nothing was decided: what the posterior is about is done.
            self.decision = None;
            return Some(Plan::Stop);
        }
        self.decision.as_ref().map(|decision| Plan::Take(decision.choice))
    }

    fn is_stop(&self, plan: Plan) -> bool {
        plan == Plan::Stop
    }

    fn unmet(&self, plan: Plan) -> Option<Literal> {
        let deed = self.deed_of(plan);
        deed.precondition().unmet(self.logic(deed))
    }

    fn raise(&mut self, missing: Literal) {
        let Some(raise) = raise_for(&RULES, missing) else { return };
        if missing.variable == super::REACHED {
            self.heading = self.place_of(self.chosen());
        }
        let largest = self.preferences.iter().map(|row| row.largest()).fold(0.0, f32::max);
        let amount = raise.amount(largest);
        if let Some(own) = self.preferences.get_mut(self.robot.index()) {
            own.raise(evidence(missing) as usize, amount);
        }
    }

    fn connected(&self) -> bool {
        self.roster.all_connected(self.percept.now) && self.teammate().is_some()
    }

    fn execute(&mut self, plan: Plan) {
        match self.deed_of(plan) {
            Deed::Idle => {}
            deed => self.begin(Command { deed, place: self.place_of(deed) }),
        }
    }

    fn roll_back(&mut self) {
        self.preferences.iter_mut().for_each(|row| row.roll_back());
    }

    fn wait(&mut self) {
        self.command = None;
    }

    fn reaches_stop(&self, plan: Plan) -> bool {
        self.deed_of(plan) == self.aim.deed()
    }

    /// Nothing is noted: whether the aim is reached, the next readings tell, and then the choice is to stop.
    fn promote_stop(&mut self) {}
}

impl Manipulation {
    /// This robot's part of a plan.
    fn deed_of(&self, plan: Plan) -> Deed {
        match plan {
            Plan::Take(joint) => joint.deed(self.robot.index()),
            Plan::Stop | Plan::Continue | Plan::Look => Deed::Idle,
        }
    }

    /// This robot's part of the last choice.
    fn chosen(&self) -> Deed {
        self.decision.as_ref().map_or(Deed::Idle, |decision| decision.choice.deed(self.robot.index()))
    }

    /// Whether an action's precondition holds now.
    fn may(&self, deed: Deed) -> bool {
        deed.precondition().unmet(self.logic(deed)).is_none()
    }

    /// The posterior probability of the last choice; one before the first.
    pub(super) fn probability(&self) -> f32 {
        let of = |decision: &super::Decision| decision.posterior.get(decision.choice.number()).copied();
        self.decision.as_ref().and_then(of).map_or(1.0, |p| p.clamp(0.0, 1.0))
    }

    /// The joint policy chosen last.
    #[must_use]
    pub fn choice(&self) -> Option<Joint> {
        self.decision.as_ref().map(|decision| decision.choice)
    }

    pub(super) fn has_reached(&self, aim: Aim) -> bool {
        let logic = self.logic(aim.deed());
        match aim {
            Aim::Hold => logic.is(super::HOLDING) || logic.is(super::PLACED),
            Aim::Place => logic.is(super::PLACED),
        }
    }
}
