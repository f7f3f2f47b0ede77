//! Handling as the task of the inference node: the lines of Algorithm 1.

use super::announcement::Announcement;
use super::decision::Question;
use super::deed::{Command, Deed, Joint, RULES, STATES, evidence};
use super::mission::TEAM;
use super::{Aim, Manipulation, Percept, Plan};
use crate::iibt::rules::raise_for;
use crate::iibt::{Literal, Task};
use crate::inference::Preference;
use crate::team::Peers;

impl Task for Manipulation {
    type Percept = Percept;
    type Message = Announcement;
    /// C of robots 0 and 1.
    type Preference = [Preference<STATES>; TEAM];
    /// All four actions, always: which of them may be done, the preconditions say.
    type Candidates = ();
    type Policy = Plan;

    /// The readings came with [`perceive`](Manipulation::perceive).
    fn observe(&mut self, _: &Percept, _: Peers<'_, Announcement>) {
        self.heading = self.place_of(self.aim.deed());
        self.track();
    }

    fn is_done(&self) -> bool {
        !self.percept.busy && self.is_sure() && self.has_reached(self.aim)
    }

    fn preference(&self) -> Self::Preference {
        self.wanted()
    }

    fn candidates(&mut self, _: &Self::Preference, _: Peers<'_, Announcement>) {}

    fn infer(&mut self, (): &(), preferences: &Self::Preference, _: Peers<'_, Announcement>) -> Option<Plan> {
        self.decision = None;
        if self.percept.busy {
            return Some(Plan::Continue);
        }
        let question = Question {
            preset: self.mission.preset,
            own: self.robot.index(),
            states: self.tracking.states(),
            teammate: self.teammate(),
            preferences,
            placer: self.may(Deed::Place).then_some(self.robot.index()),
        };
        self.decision = question.decide();
        if !self.is_sure() {
            return Some(Plan::Look);
        }
        self.decision.as_ref().map(|decision| Plan::Take(decision.choice))
    }

    fn unmet(&self, plan: Plan, (): &()) -> Option<Literal> {
        let deed = self.deed_of(plan);
        deed.precondition().unmet(self.logic(deed))
    }

    fn raise(&mut self, missing: Literal, (): &(), preferences: &mut Self::Preference) {
        let Some(raise) = raise_for(&RULES, missing) else { return };
        if missing.variable == super::REACHED {
            self.heading = self.place_of(self.chosen());
        }
        let largest = preferences.iter().map(|row| row.largest()).fold(0.0, f32::max);
        let amount = raise.amount(largest);
        if let Some(own) = preferences.get_mut(self.robot.index()) {
            own.raise(evidence(missing) as usize, amount);
        }
    }

    fn execute(&mut self, plan: Plan, (): &(), _: Peers<'_, Announcement>) {
        match self.deed_of(plan) {
            Deed::Idle => {}
            deed => self.begin(Command { deed, place: self.place_of(deed) }),
        }
    }

    fn wait(&mut self) {
        self.command = None;
    }
}

impl Manipulation {
    /// This robot's part of a plan.
    fn deed_of(&self, plan: Plan) -> Deed {
        match plan {
            Plan::Take(joint) => joint.deed(self.robot.index()),
            Plan::Continue | Plan::Look => Deed::Idle,
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
