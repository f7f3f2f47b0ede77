//! Navigation as the task of the inference node: the lines of Algorithm 1.

use super::candidates::Place;
use super::{Candidate, Cause, MAX_KNOWN_HAZARDS, Navigation, Plan, RULES, VISITED, intentions};
use crate::bounded::up_to;
use crate::grid::{Cell, Path};
use crate::iibt::rules::raise_for;
use crate::iibt::{Literal, Task};
use crate::team::{Intention, MAX_HAZARDS, MAX_TEAM, Status};
use heapless::Vec;

impl<const S: usize, const W: usize, const P: usize> Task for Navigation<'_, S, W, P> {
    type Policy = Plan;

    fn prepare(&mut self) {
        self.preference = self.decision.world().preference();
    }

    fn observe(&mut self) {
        for hazard in self.percept.hazards.clone() {
            self.see(hazard);
        }
        let told: Vec<Cell, { MAX_TEAM * MAX_HAZARDS }> =
            up_to(intentions(&self.roster).flat_map(|peer| peer.hazards.iter().copied()));
        for &hazard in &told {
            self.remember(hazard);
        }
    }

    fn update(&mut self) {
        self.track();
        self.keep_up();
        if self.has_arrived() {
            self.agreement.arrive();
        }
    }

    fn candidates(&mut self) {
        self.situation = self.find_situation();
        self.candidates.clear();
        let Some(situation) = &self.situation else { return };
        let place = Place { robot: self.robot, from: situation.here, via: &situation.via };
        self.generator.fill(self.mission, situation, place, &mut self.candidates);
        if self.candidates.is_empty() {
            // There is room: the list is empty.
            let _ = self.candidates.push(Candidate { path: Path::at(situation.here), goal: None });
        }
    }

    fn intentions(&mut self) {
        self.choice = None;
        if let Some(situation) = self.situation.take() {
            self.deliberate(&situation);
            self.choice = self.decision.choose();
            self.situation = Some(situation);
        }
    }

    fn infer(&mut self) -> Option<Plan> {
        if self.stopping && self.has_arrived() {
            return Some(Plan::Stop);
        }
        if self.agreement.status() != Status::Deciding {
            return Some(Plan::Follow);
        }
        if self.situation.is_none() {
            return Some(Plan::Wait);
        }
        self.choice.map(|choice| Plan::Take(choice.policy))
    }

    fn is_stop(&self, plan: Plan) -> bool {
        plan == Plan::Stop
    }

    fn unmet(&self, plan: Plan) -> Option<Literal> {
        plan.precondition().unmet(self.logic(plan))
    }

    fn raise(&mut self, missing: Literal) {
        let Some(raise) = raise_for(&RULES, missing) else { return };
        let amount = raise.amount(self.preference.largest());
        let cause = if missing.variable == VISITED { Cause::WayPoint } else { Cause::Obstacle };
        match cause {
            Cause::WayPoint => self.want_waypoints(amount),
            _ => self.avoid(amount),
        }
        if self.choice.is_none()
            && let Some(here) = self.here()
        {
            self.open_round(here, cause);
        }
    }

    fn connected(&self) -> bool {
        let map = &self.mission.map;
        let sound = |peer: &Intention| peer.fits(map.len()) && peer.path.is_open(map);
        // A teammate that speaks of another map cannot be planned with.
        self.roster.all_connected(self.percept.now) && intentions(&self.roster).all(sound)
    }

    fn execute(&mut self, plan: Plan) {
        match plan {
            Plan::Take(index) => {
                if let Some(&candidate) = self.candidates.get(index) {
                    self.commit(candidate);
                }
            }
            Plan::Follow => self.follow(),
            Plan::Stop | Plan::Wait => {}
        }
    }

    fn roll_back(&mut self) {
        self.preference.roll_back();
    }

    fn wait(&mut self) {
        self.command = None;
    }

    fn reaches_stop(&self, plan: Plan) -> bool {
        let done = self.agreement.step() + usize::from(self.begun);
        // A path without moves is done when it is announced.
        let chosen = plan != Plan::Wait && self.agreement.status() != Status::Deciding;
        chosen && done == self.agreement.path().len()
    }

    fn promote_stop(&mut self) {
        self.stopping = true;
    }
}

impl<const S: usize, const W: usize, const P: usize> Navigation<'_, S, W, P> {
    /// Begins the next step of the path, if it is time for it.
    fn follow(&mut self) {
        let peers = intentions(&self.roster);
        if let Some(here) = self.here() {
            self.command = self.agreement.next_move(&self.mission.map, self.mission.paces(), here, peers);
            self.commanded = self.command;
            self.begun = self.command.is_some();
        } else if self.percept.moving {
            self.begun |= self.agreement.may_go_on(self.mission.paces(), peers);
        }
    }

    /// Wants the obstacles on the chosen path by so much more, which is less.
    fn avoid(&mut self, amount: f32) {
        let (path, done) = match self.choice.and_then(|choice| self.candidates.get(choice.policy)) {
            Some(taken) => (taken.path, 0),
            None => (*self.agreement.path(), self.agreement.step()),
        };
        let hazards: Vec<Cell, MAX_KNOWN_HAZARDS> = up_to(self.hazards_on(&path, done));
        for &hazard in &hazards {
            self.preference.raise(hazard.index(), amount);
        }
    }
}
