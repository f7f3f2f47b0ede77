//! The robot's turn in a round: choose, then announce or object.

use super::candidates::{Place, Situation, TimedPath, are_clear};
use super::decision::{RobotCandidates, Timing};
use super::motion::SURE;
use super::{Candidate, Cause, Intention, MAX_GOALS, Navigation, Said, Stage, intentions};
use crate::bounded::up_to;
use crate::grid::{Cell, Map, Path};
use crate::inference::Preference;
use crate::math;
use crate::team::{MAX_TEAM, Peers, RobotId};
use heapless::Vec;

/// The number of failed rounds per robot of the team before a robot takes a path that does not
/// bring all of them to goals together.
const ROUNDS_PER_ROBOT: u8 = 3;

impl<const S: usize, const W: usize, const P: usize> Navigation<'_, S, W, P> {
    /// Returns the map with the cells of negative preference blocked.
    fn passable(&self, preference: &Preference<S>) -> Map<W> {
        let disliked = |state: &usize| preference.get(*state).is_some_and(|worth| worth < 0.0);
        self.mission
            .map
            .avoiding((0..self.mission.map.len()).filter(disliked).map(|state| Cell(state as u16)))
    }

    /// Returns the paths that teammates have announced in this round.
    fn announced(&self, peers: Peers<'_, Intention>) -> Vec<TimedPath, MAX_TEAM> {
        let chosen = self.partners(peers).filter(|peer| peer.message.stage != Stage::Deciding);
        up_to(chosen.map(|peer| self.timed_path(peer.sender, peer.message.path)))
    }

    fn timed_path(&self, robot: RobotId, path: Path) -> TimedPath {
        TimedPath { path, pace: self.mission.paces().of(robot) }
    }

    /// Returns the teammates that are in this round.
    fn partners<'a>(
        &self,
        peers: Peers<'a, Intention>,
    ) -> impl Iterator<Item = &'a Said> + Clone + use<'a, S, W, P> {
        let round = self.agreement.round();
        intentions(peers).filter(move |peer| peer.message.round == round)
    }

    /// Returns the situation to decide in; `None` while it is not this robot's turn.
    pub(super) fn find_situation(
        &mut self,
        preference: &Preference<S>,
        peers: Peers<'_, Intention>,
    ) -> Option<Situation<W>> {
        let here = self.turn(peers)?;
        let (map, announced, via) = (self.passable(preference), self.announced(peers), self.via(preference));
        let waiting = self.partners(peers).filter(|peer| peer.message.stage == Stage::Deciding);
        let undecided = up_to(core::iter::once(here).chain(waiting.map(|peer| peer.message.path.start)));
        let starts =
            self.partners(peers).map(|peer| self.timed_path(peer.sender, Path::at(peer.message.path.start)));
        let own = self.timed_path(self.robot, Path::at(here));
        let team: Vec<TimedPath, MAX_TEAM> = up_to(core::iter::once(own).chain(starts));
        let best = self.best_goals();
        let arrivals =
            self.generator.arrivals(self.mission, &map, (&team, &via), &announced, &best, self.failed_rounds);
        Some(Situation { here, map, via, undecided, announced, arrivals })
    }

    /// Returns the most preferred goals, as many as there are robots, and those that tie with the
    /// last of them.
    fn best_goals(&self) -> Vec<Cell, MAX_GOALS> {
        let (goals, world) = (self.mission.goals, self.decision.world());
        let better = |cell: Cell| {
            goals.iter().filter(|&&other| world.preference_for(other) > world.preference_for(cell)).count()
        };
        up_to(goals.iter().copied().filter(|&goal| better(goal) < self.mission.starts.len()))
    }

    /// Returns where the robot stands if it is its turn to choose.
    fn turn(&self, peers: Peers<'_, Intention>) -> Option<Cell> {
        self.here().filter(|_| self.agreement.is_my_turn(intentions(peers)))
    }

    /// Returns C for a decision: no preference for a goal that a teammate has claimed.
    fn wanted(&self, preference: &Preference<S>, peers: Peers<'_, Intention>) -> Preference<S> {
        let mut wanted = *preference;
        for claimed in self.partners(peers).filter_map(|peer| peer.message.goal) {
            // A cell that this map does not have is no goal either.
            let worth = wanted.get(claimed.index()).map_or(0.0, |worth| worth.max(0.0));
            let _ = wanted.raise(claimed.index(), -worth);
        }
        wanted
    }

    /// Returns the longest policy in this decision and the earliest arrival.
    fn timing(&self, situation: &Situation<W>) -> Timing {
        let ours = self.candidates.iter().map(|candidate| candidate.path.len());
        let listed = (0..self.mission.team()).flat_map(|robot| self.mission.listed_lengths(RobotId(robot)));
        let horizon = ours.chain(listed).chain(situation.arrivals.iter().copied()).max().unwrap_or(0);
        Timing { horizon, earliest: situation.arrivals.first().copied().unwrap_or(0) }
    }

    /// Evaluates the robot's own candidates jointly with those of each teammate: the path that the
    /// teammate announced, or else all that it might choose.
    pub(super) fn deliberate(
        &mut self,
        situation: &Situation<W>,
        preference: &Preference<S>,
        peers: Peers<'_, Intention>,
    ) {
        let (here, timing) = (situation.here, self.timing(situation));
        let (wanted, odds) = (self.wanted(preference, peers), self.motion.odds());
        let known = |peer: &Said| (peer.sender, peer.message.path, peer.message.stage != Stage::Deciding);
        let partners: Vec<(RobotId, Path, bool), MAX_TEAM> = up_to(self.partners(peers).map(known));
        let mut own = self.belief;
        for (robot, path, _) in &partners {
            self.decision.set_peer_reliability(self.mission.peer_sensor_of(*robot));
            let pair = self.decision.beliefs(own.as_flat(), here, path.start);
            math::assign(own.as_flat_mut(), self.decision.world().cells(pair.as_flat()));
        }
        self.decision.clear();
        for &(robot, path, chosen) in &partners {
            self.decision.set_peer_reliability(self.mission.peer_sensor_of(robot));
            let mut pair = self.decision.beliefs(self.belief.as_flat(), here, path.start);
            math::assign(pair.as_flat_mut(), self.decision.world().cells(own.as_flat()));
            self.propose(situation, robot, path, chosen);
            let ours = RobotCandidates { preference: &wanted, candidates: &self.candidates, odds: &odds };
            let theirs = RobotCandidates { preference: &wanted, candidates: &self.teammates, odds: &SURE };
            self.decision.join(&pair, ours, theirs, timing);
        }
        if partners.is_empty() {
            let ours = RobotCandidates { preference: &wanted, candidates: &self.candidates, odds: &odds };
            self.decision.decide_alone(own.as_flat(), ours, timing);
        }
    }

    /// Fills a teammate's candidates: its announced path, or what this robot would consider in its
    /// place.
    fn propose(&mut self, situation: &Situation<W>, robot: RobotId, path: Path, chosen: bool) {
        if chosen {
            self.teammates.clear();
        } else {
            let place = Place { robot, from: path.start, via: &[] };
            self.generator.fill(self.mission, situation, place, &mut self.teammates);
        }
        if self.teammates.is_empty() {
            // There is room: the list is empty.
            let _ = self.teammates.push(Candidate { path, goal: None });
        }
    }

    /// Announces the chosen path, or opens another round when it is incompatible with those
    /// announced before.
    ///
    /// After enough failed rounds a robot takes the best path there is, which may be to stay. If
    /// that path is in the way of a teammate it tries again, at most 255 times in a row.
    pub(super) fn commit(&mut self, candidate: Candidate, peers: Peers<'_, Intention>) {
        let announced = self.announced(peers);
        let fits =
            candidate.goal.is_some() && announced.iter().all(|other| self.goes_with(&candidate.path, other));
        let is_clear = |path: &Path| announced.iter().all(|other| self.is_clear(path, other));
        let (clear, stay) = (is_clear(&candidate.path), Path::at(candidate.path.start));
        let tries = if clear || is_clear(&stay) { ROUNDS_PER_ROBOT * self.mission.team() } else { u8::MAX };
        if !fits && self.failed_rounds < tries {
            self.open_round(candidate.path.start, Cause::Misfit);
        } else if clear {
            let probability = self.choice.map_or(0.0, |choice| choice.joint);
            self.agreement.announce(candidate.path, candidate.goal, probability);
        } else {
            self.agreement.announce(stay, None, 1.0);
        }
    }

    fn is_clear(&self, path: &Path, other: &TimedPath) -> bool {
        are_clear(&self.mission.map, &self.timed_path(self.robot, *path), other)
    }

    /// Returns whether two robots that follow these paths arrive in the same step on different
    /// cells, without a conflict.
    fn goes_with(&self, path: &Path, other: &TimedPath) -> bool {
        let together = other.path.is_empty() || other.path.len() == path.len();
        let apart = path.end(&self.mission.map) != other.path.end(&self.mission.map);
        together && apart && self.is_clear(path, other)
    }
}
