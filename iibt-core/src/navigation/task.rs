//! Navigation as the task of the inference node: the lines of Algorithm 1.

use super::candidates::{Place, Situation};
use super::{
    Candidate, Cause, GridPercept, Intention, MAX_HAZARDS, MAX_KNOWN_HAZARDS, Navigation, NavigationPlan,
    RULES, Stage, VISITED, intentions,
};
use crate::bounded::up_to;
use crate::grid::{Cell, Path};
use crate::iibt::rules::raise_for;
use crate::iibt::{Literal, Task};
use crate::inference::Preference;
use crate::team::{MAX_TEAM, Peers};
use heapless::Vec;

impl<const S: usize, const W: usize, const P: usize> Task for Navigation<'_, S, W, P> {
    type Percept = GridPercept;
    type Message = Intention;
    type Preference = Preference<S>;
    /// The situation in which the robot decides; `None` while it is not its turn. The paths are in
    /// [`candidates`](Navigation::candidates).
    type Candidates = Option<Situation<W>>;
    type Policy = NavigationPlan;

    fn observe(&mut self, percept: &GridPercept, peers: Peers<'_, Intention>) {
        self.perceive(percept, peers);
        self.track();
        self.follow_agreement(peers);
        if self.has_arrived() {
            self.agreement.arrive();
        }
    }

    fn is_done(&self) -> bool {
        self.has_arrived()
    }

    fn preference(&self) -> Preference<S> {
        self.decision.world().preference()
    }

    fn candidates(
        &mut self,
        preference: &Preference<S>,
        peers: Peers<'_, Intention>,
    ) -> Option<Situation<W>> {
        let situation = self.find_situation(preference, peers);
        self.candidates.clear();
        let situation = situation?;
        let place = Place { robot: self.robot, from: situation.here, via: &situation.via };
        self.generator.fill(self.mission, &situation, place, &mut self.candidates);
        if self.candidates.is_empty() {
            // There is room: the list is empty.
            let _ = self.candidates.push(Candidate { path: Path::at(situation.here), goal: None });
        }
        Some(situation)
    }

    fn infer(
        &mut self,
        situation: &Option<Situation<W>>,
        preference: &Preference<S>,
        peers: Peers<'_, Intention>,
    ) -> Option<NavigationPlan> {
        self.choice = None;
        if let Some(situation) = situation {
            self.deliberate(situation, preference, peers);
            self.choice = self.decision.choose();
        }
        if self.agreement.stage() != Stage::Deciding {
            return Some(NavigationPlan::Follow);
        }
        if situation.is_none() {
            return Some(NavigationPlan::Wait);
        }
        self.choice.map(|choice| NavigationPlan::Take(choice.policy))
    }

    fn unmet(&self, plan: NavigationPlan, _: &Option<Situation<W>>) -> Option<Literal> {
        plan.precondition().unmet(self.logic(plan))
    }

    fn raise(&mut self, missing: Literal, _: &Option<Situation<W>>, preference: &mut Preference<S>) {
        let Some(raise) = raise_for(&RULES, missing) else { return };
        let amount = raise.amount(preference.largest());
        let cause = if missing.variable == VISITED { Cause::WayPoint } else { Cause::Obstacle };
        match cause {
            Cause::WayPoint => self.want_waypoints(preference, amount),
            _ => self.avoid(preference, amount),
        }
        if self.choice.is_none()
            && let Some(here) = self.here()
        {
            self.open_round(here, cause);
        }
    }

    fn execute(&mut self, plan: NavigationPlan, _: &Option<Situation<W>>, peers: Peers<'_, Intention>) {
        match plan {
            NavigationPlan::Take(index) => {
                if let Some(&candidate) = self.candidates.get(index) {
                    self.commit(candidate, peers);
                }
            }
            NavigationPlan::Follow => self.follow(peers),
            NavigationPlan::Wait => {}
        }
    }

    fn wait(&mut self) {
        self.command = None;
    }
}

impl<const S: usize, const W: usize, const P: usize> Navigation<'_, S, W, P> {
    /// Takes in what was sensed since the last tick, and the obstacles that teammates have found.
    pub(super) fn perceive(&mut self, percept: &GridPercept, peers: Peers<'_, Intention>) {
        self.percept = percept.clone();
        (self.command, self.alone) = (None, false);
        for &hazard in &percept.hazards {
            self.remember_observed(hazard);
        }
        let told: Vec<Cell, { MAX_TEAM * MAX_HAZARDS }> =
            up_to(intentions(peers).flat_map(|peer| peer.message.hazards.iter().copied()));
        for &hazard in &told {
            self.remember(hazard);
        }
    }
    /// Begins the next step of the path, if the agreement allows it.
    fn follow(&mut self, peers: Peers<'_, Intention>) {
        let peers = intentions(peers);
        if let Some(here) = self.here() {
            self.command = self.agreement.next_move(&self.mission.map, self.mission.paces(), here, peers);
            self.commanded = self.command;
            self.begun = self.command.is_some();
        } else if self.percept.moving {
            self.begun |= self.agreement.may_go_on(self.mission.paces(), peers);
        }
    }

    /// Lowers the preference for each obstacle on the chosen path by `-amount`.
    fn avoid(&self, preference: &mut Preference<S>, amount: f32) {
        let (path, done) = match self.choice.and_then(|choice| self.candidates.get(choice.policy)) {
            Some(taken) => (taken.path, 0),
            None => (*self.agreement.path(), self.agreement.step()),
        };
        let hazards: Vec<Cell, MAX_KNOWN_HAZARDS> = up_to(self.hazards_on(&path, done));
        for &hazard in &hazards {
            // Every cell of the map is an outcome.
            let _ = preference.raise(hazard.index(), amount);
        }
    }
}
