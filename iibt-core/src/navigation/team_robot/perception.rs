//! What a robot senses and hears: where it is, what is in its view, and what is left to visit.

use super::super::claim::Cells;
use super::super::policies::HAS_UNKNOWNS;
use super::super::progress::destination;
use super::super::prospects::of;
use super::super::strangers::{Sighting, likelihoods};
use super::super::unknown::{Effect, MAX_VALUES, Place};
use super::super::{Fact, GridPercept, Intention};
use super::{MAX_HAZARDS, Navigation};
use crate::bounded::up_to;
use crate::grid::{Cell, CellSet};
use crate::team::rounds::{Answer, RoundMessage, Rounds, Teammates, Timing};
use crate::team::{Peers, RobotId};
use heapless::Vec;

/// The ticks of silence after which a member may be anywhere.
const LONGEST_SILENCE: u16 = 8;

/// What an obstacle in view speaks against the values by which its cell is free, in nats: the
/// sensor is right in nineteen of twenty cases.
const OBSTACLE_SEEN: f32 = 3.0;

impl<const S: usize, const W: usize, const L: usize, const M: usize, const K: usize>
    Navigation<'_, S, W, L, M, K>
{
    /// Lines 5 and 6: takes in what was sensed and heard.
    pub(in crate::navigation) fn take_in(
        &mut self,
        percept: &GridPercept,
        peers: Peers<'_, Intention<W, K>>,
    ) {
        (self.command, self.left, self.waiting) = (None, self.budget, None);
        (self.moving, self.has_twin) = (percept.moving, peers.has_twin());
        let teammates = Teammates::from(peers);
        let busy = self.busy(&teammates);
        if Self::PLANS {
            self.waypoints.pass(busy);
        }
        self.locate(percept.reading);
        self.watch(&percept.sightings, &teammates);
        self.look(percept, peers, &teammates);
        self.read(percept, &teammates);
        if let Some(here) = self.standing() {
            if Self::PLANS {
                let obstacles = &self.obstacles;
                self.waypoints.tick_off(here, |cell| obstacles.is_blocked(cell));
            }
            if self.rounds.is_none() {
                let fact = self.fact(here, self.purpose());
                let number = self.mission_id();
                self.rounds = Some(Rounds::new(self.member, self.epoch, number, fact, Timing::DEFAULT));
            }
        }
        self.attend(&teammates, busy);
        self.weigh_rest(&teammates);
        self.mind_doubt(&teammates);
        if Self::PLANS {
            self.hand_over(peers, &teammates);
        }
    }

    fn locate(&mut self, reading: Option<Cell>) {
        if self.moving {
            return;
        }
        let map = &self.mission.map;
        self.localisation.update(map, reading);
        let Some(here) = self.localisation.here() else { return };
        let (obstacles, passage) = (&self.obstacles, self.under_way.take());
        let slip = passage.map_or(1.0, |passage| self.localisation.chance_of_slip(passage.step));
        self.progress.settle(here, passage, slip, |from, step| destination(map, obstacles, from, step));
        self.localisation.learn(map, here, |cell| obstacles.is_blocked(cell));
        if passage.is_some_and(|passage| passage.is_planned && here == passage.to)
            && let Some(rounds) = &mut self.rounds
        {
            rounds.protocol_mut().advance();
        }
    }

    /// Takes in where strangers are: how they move tells where they go, and one that has stood for
    /// a while is an obstacle until it goes on.
    fn watch(&mut self, sightings: &[Sighting], teammates: &Teammates<'_, Fact<W>, K>) {
        if !HAS_UNKNOWNS {
            return;
        }
        let unknowns = self.mission.unknowns;
        for (number, unknown) in of(self.mission, Effect::Takes) {
            let sighting = sightings.iter().find(|sighting| usize::from(sighting.unknown) == number);
            let now = sighting.map(|sighting| sighting.at);
            let was_parked = self.strangers.is_parked(number);
            let before = self.strangers.note(number, now);
            let (Some(before), Some(now)) = (before, now) else { continue };
            if self.strangers.is_parked(number) {
                self.obstacles.look(now, true);
            } else if was_parked {
                self.obstacles.look(before, false);
            }
            // As many work units as distance tables.
            self.left = self.left.saturating_sub(unknown.values().into());
            let members = self.members_at(teammates);
            let nats = likelihoods::<S, W>(unknown, &self.mission.map, (before, now), &members);
            if let Some(nats) = nats.filter(|_| !self.is_in_doubt()) {
                self.readings.add(unknowns, number, &nats);
            }
        }
    }

    /// Takes in what is in view.
    fn look(
        &mut self,
        percept: &GridPercept,
        peers: Peers<'_, Intention<W, K>>,
        teammates: &Teammates<'_, Fact<W>, K>,
    ) {
        let strangers = self.strangers.reach(self.mission.unknowns, &self.readings, &self.mission.map);
        self.seen = percept.hazards.iter().copied().collect::<CellSet<W>>().union(&strangers);
        self.mates_in_view = CellSet::EMPTY;
        if !percept.hazards.is_empty() {
            self.look_at_hazards(percept, teammates);
        }
        for &cell in percept.clear.iter().filter(|&&cell| self.watched.contains(cell)) {
            self.obstacles.look(cell, false);
        }
        self.obstacles.forget(self.mission.forgets);
        let protocol = self.rounds.as_ref().map(|rounds| rounds.protocol());
        let is_believed =
            |robot| protocol.is_some_and(|it| it.proposal().view.contains(robot) && it.has_answered(robot));
        let members = peers.iter().filter(|peer| is_believed(peer.sender()));
        let told = members.flat_map(|peer| peer.message().rounds.fact.evidence.iter());
        let of = |cell| told.clone().filter(move |known| known.cell == cell).map(|known| known.weight);
        let is_vetoed = protocol.is_some_and(|protocol| protocol.is_vetoed());
        self.obstacles.yield_to(of, is_vetoed);
        let told = peers.iter().flat_map(|peer| peer.message().rounds.fact.evidence.iter());
        let told = told.filter(|known| known.weight > 0).map(|known| known.cell);
        self.watched = told.chain(self.obstacles.suspected()).collect();
    }

    /// Counts what was read of the unknowns: not while the robot may be elsewhere than it believes.
    fn read(&mut self, percept: &GridPercept, teammates: &Teammates<'_, Fact<W>, K>) {
        let may_read = HAS_UNKNOWNS && !self.is_in_doubt();
        let Some(here) = self.standing().filter(|_| may_read) else { return };
        for &reading in &percept.readings {
            self.readings.count(self.mission.unknowns, reading, here, self.mission.decider().counting());
        }
        self.read_obstacles(percept, here, teammates);
    }

    /// Counts an obstacle on a cell that may be blocked, where the robot reads nothing else of it:
    /// one that stands before a door knows at last that it is shut.
    fn read_obstacles(&mut self, percept: &GridPercept, here: Cell, teammates: &Teammates<'_, Fact<W>, K>) {
        let unknowns = self.mission.unknowns;
        for (number, unknown) in of(self.mission, Effect::Blocks) {
            if unknown.sights.iter().any(|sight| sight.from == here) {
                continue;
            }
            let is_seen = |place: &&Place| percept.hazards.contains(&place.cell);
            let seen = unknown.cells.iter().find(is_seen);
            if let Some(place) = seen.filter(|place| !self.may_be_teammate(place.cell, teammates)) {
                let nats = |value: u8| if value == place.value { 0.0 } else { -OBSTACLE_SEEN };
                let nats: Vec<f32, MAX_VALUES> = up_to((0..unknown.values()).map(nats));
                self.readings.add(unknowns, number, &nats);
            }
        }
    }

    /// What is seen where a teammate may be, may be the teammate; but not in the cell that the plan
    /// lets this robot enter now.
    fn look_at_hazards(&mut self, percept: &GridPercept, teammates: &Teammates<'_, Fact<W>, K>) {
        let entering = self.may_enter(teammates).map(|(_, to)| to);
        let own = self.localisation.position().0;
        // What is seen of an unknown is a reading.
        let is_stranger = |cell: Cell| self.strangers.seen().any(|(_, at)| at == cell);
        let is_news = |cell: &&Cell| {
            let is_known = **cell == own || self.is_doubtful(**cell) || is_stranger(**cell);
            self.mission.map.is_free(**cell) && !is_known
        };
        let news: Vec<Cell, MAX_HAZARDS> = up_to(percept.hazards.iter().filter(is_news).copied());
        for &cell in &news {
            if entering != Some(cell) && self.may_be_teammate(cell, teammates) {
                self.mates_in_view.insert(cell);
            } else {
                self.obstacles.look(cell, true);
            }
        }
    }

    /// Whether a cell is one of an unknown that may block it.
    fn is_doubtful(&self, cell: Cell) -> bool {
        let mut blocks = of(self.mission, Effect::Blocks);
        blocks.any(|(_, unknown)| unknown.cells.iter().any(|place| place.cell == cell))
    }

    /// Whether a teammate may be on a cell now. A robot that was left out knows nothing of the
    /// others' plans.
    pub(super) fn may_be_teammate(&self, cell: Cell, teammates: &Teammates<'_, Fact<W>, K>) -> bool {
        let own = self.robot();
        let proposal = self.rounds.as_ref().map(|rounds| rounds.proposal());
        let round = proposal.map_or(0, |proposal| proposal.round);
        let newer = teammates.iter().map(|(_, heard)| &heard.message.proposal);
        let mut known = newer.filter(|newer| newer.round >= round).chain(proposal);
        let is_left_out = known.any(|proposal| !proposal.view.contains(own));
        let others = (0..).map(RobotId).zip(self.mission.starts).filter(|&(robot, _)| robot != own);
        let mut may_be = others.map(|(robot, &start)| match teammates.get(robot) {
            Some(heard) => self.may_be(cell, robot, heard.message),
            None => start == cell,
        });
        is_left_out || may_be.any(|may_be| may_be)
    }

    /// Whether a teammate that was heard may be on a cell: on what is left of all paths that it may
    /// follow, or farther by a step for each tick of silence, in which it may have joined a round
    /// that leaves this robot out. It may be anywhere after a longer silence, if it follows a plan
    /// of which this robot does not know the list, or may have begun to follow one since this robot
    /// gave its first scores.
    fn may_be(&self, cell: Cell, robot: RobotId, message: &RoundMessage<Fact<W>, K>) -> bool {
        let Some(rounds) = &self.rounds else { return message.fact.anchor == cell };
        let protocol = rounds.protocol();
        let silence = rounds.silence(robot);
        let is_member = rounds.proposal().view.contains(robot);
        let is_unknown = silence > LONGEST_SILENCE || !message.proposal.view.contains(self.robot());
        let has_begun = protocol.digest().is_some() || matches!(message.answer, Answer::Decided { .. });
        // The rounds have not heard the newest message yet: it may tell of a place farther on.
        let is_near = |at: Cell| self.mission.map.manhattan(at, cell) <= silence;
        match protocol.reach(robot) {
            _ if is_member && is_unknown => true,
            None if has_begun => true,
            _ if message.fact.anchor == cell => true,
            Some(Cells(reach)) if is_member => reach.iter().any(is_near),
            // Members that know more of a robot left out agree to its wall by deciding.
            Some(Cells(reach)) => !protocol.has_decided() || reach.contains(cell),
            None => false,
        }
    }
}
