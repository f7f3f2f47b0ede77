//! A team that flies: every robot's rounds, tick by tick, on a radio that loses frames.

use super::task::{List, Place, Places};
use iibt_core::team::rounds::{
    Claim, Event, Heard, JointPolicies, Own, Proposal, RoundMessage, Rounds, Score, Scores, Teammates,
    Timing, View, Waiting, Want,
};
use iibt_core::team::{Member, RobotId, Stamp};
use std::rc::Rc;

/// The number of policies.
pub(super) const K: usize = 2;

pub(super) type Message = RoundMessage<Place, K>;

/// The list that follows from a round and its facts.
pub(super) type Generate = Rc<dyn Fn(&Proposal<Places>, &[(RobotId, Place)]) -> Rc<List>>;

/// Pseudo-random numbers: SplitMix64.
#[derive(Clone, Debug)]
pub(super) struct Random(pub(super) u64);

impl Random {
    pub(super) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    pub(super) fn below(&mut self, count: usize) -> usize {
        (self.bits() % count as u64) as usize
    }

    pub(super) fn happens(&mut self, probability: f64) -> bool {
        (self.bits() as f64) < probability * u64::MAX as f64
    }
}

/// One robot with all that its rounds need.
pub(super) struct Robot {
    pub(super) rounds: Rounds<Place, K>,
    pub(super) list: Rc<List>,
    pub(super) heard: Vec<Option<Sent>>,
    pub(super) at: Places,
    pub(super) errand: u8,
    pub(super) is_moving: bool,
    pub(super) is_alive: bool,
    pub(super) want: Option<Want>,
    pub(super) stamp: Stamp,
    pub(super) sent: Option<Rc<Said>>,
    pub(super) scores: [Score; K],
    /// Ticks that a list or a step takes.
    pub(super) listing: u32,
    pub(super) pace: u32,
    pub(super) events: Vec<Event>,
    worked: u32,
    driven: u32,
}

/// A message, and a number that stands for it.
#[derive(Debug)]
pub(super) struct Said {
    pub(super) message: Message,
    pub(super) number: u64,
}

/// What was sent, with its stamp.
pub(super) type Sent = (Stamp, Rc<Said>);

pub(super) fn teammates(heard: &[Option<Sent>]) -> Teammates<'_, Place, K> {
    let all = (0..).map(RobotId).zip(heard);
    all.filter_map(|(robot, heard)| {
        let (stamp, said) = heard.as_ref()?;
        Some((robot, Heard { stamp: *stamp, message: &said.message }))
    })
    .collect()
}

impl Robot {
    pub(super) fn new(rounds: Rounds<Place, K>, epoch: u32) -> Self {
        let fact = *rounds.protocol().fact();
        Self {
            list: Rc::default(),
            heard: vec![None; rounds.protocol().member().team()],
            at: fact.at,
            errand: fact.errand,
            is_moving: false,
            is_alive: true,
            want: None,
            stamp: Stamp { epoch, sequence: 0 },
            sent: None,
            scores: [Score::default(); K],
            listing: 0,
            pace: 1,
            events: Vec::new(),
            worked: 0,
            driven: 0,
            rounds,
        }
    }

    fn id(&self) -> RobotId {
        self.rounds.protocol().member().robot()
    }

    /// Ends a move that was begun, decides what it can, and begins a move that it may.
    fn tick(&mut self, generate: &Generate) {
        self.end_move();
        let mates = teammates(&self.heard);
        let fact = Place { at: self.at, errand: self.errand };
        let own = Own { fact: &fact, is_standing: !self.is_moving, expected: View::EMPTY };
        let (event, waiting) = self.rounds.tick(own, &mates, &*self.list);
        assert_eq!(waiting, self.rounds.waiting(&mates, &*self.list));
        let want = self.want.filter(|_| event.is_none() && own.is_standing);
        let event = event.or_else(|| self.rounds.ask(want?, &fact));
        if matches!(event, Some(Event::Opened(_) | Event::Joined(_))) {
            (self.want, self.worked) = (None, 0);
        }
        self.events.extend(event);
        if let Some(digest) = self.rounds.protocol().wanted(&mates) {
            self.worked += 1;
            if self.worked > self.listing {
                let facts: Vec<_> =
                    self.rounds.protocol().facts(&mates).map(|(id, fact)| (id, *fact)).collect();
                self.list = generate(self.rounds.proposal(), &facts);
                let scores: Scores<K> = self.scores.iter().copied().take(self.list.len()).collect();
                let protocol = self.rounds.protocol_mut();
                protocol.give(digest, scores, &*self.list, &mates).expect("the digest was asked for");
            }
        }
        if !self.is_moving && self.rounds.may_move(&mates, &*self.list) {
            (self.is_moving, self.driven) = (true, 0);
            self.at = self.list.between(self.policy(), self.id(), self.rounds.protocol().step());
        }
        let listed = (self.worked * K as u32 / (self.listing + 1)) as u8;
        let message = self.rounds.protocol().message(&mates, listed, 1.0);
        self.sent = Some(Rc::new(Said { message, number: 0 }));
        self.stamp.sequence += 1;
    }

    /// Drives to one of the places between which it has started again.
    pub(super) fn centre(&mut self) {
        if !self.is_moving {
            self.at = Places(1 << self.at.0.trailing_zeros());
        }
    }

    fn end_move(&mut self) {
        self.driven += 1;
        if self.is_moving && self.driven >= self.pace {
            self.rounds.protocol_mut().advance();
            self.is_moving = false;
            let step = self.rounds.protocol().step();
            self.at = self.list.place(self.policy(), self.id(), step);
        }
    }

    fn policy(&self) -> usize {
        self.rounds.protocol().policy().expect("it is on its way")
    }

    /// Whether its path is done.
    pub(super) fn has_arrived(&self) -> bool {
        let protocol = self.rounds.protocol();
        !self.is_moving
            && protocol.policy().is_some_and(|policy| protocol.step() >= self.list.moves(policy, self.id()))
    }
}

/// The probability that a frame is lost.
pub(super) struct Radio {
    pub(super) loss: f64,
    pub(super) random: Random,
    /// Links that are dead for good: from, to.
    pub(super) dead: Vec<(usize, usize)>,
}

impl Radio {
    pub(super) fn new(loss: f64, seed: u64) -> Self {
        Self { loss, random: Random(seed), dead: Vec::new() }
    }
}

pub(super) struct Team {
    pub(super) robots: Vec<Robot>,
    pub(super) generate: Generate,
    pub(super) radio: Radio,
    pub(super) ticks: u32,
}

impl Team {
    /// A team that starts, each robot on its place.
    pub(super) fn new(places: &[u8], generate: Generate, radio: Radio) -> Self {
        let start = |(robot, &place): (u8, &u8)| {
            let member = Member::new(RobotId(robot), places.len()).expect("the team is small");
            Robot::new(Rounds::new(member, 1, 7, Place::at(place), Timing::DEFAULT), 1)
        };
        Self { robots: (0..).zip(places).map(start).collect(), generate, radio, ticks: 0 }
    }

    /// Each robot hears what was sent in the tick before, decides, acts and sends; nobody shares a
    /// place.
    pub(super) fn tick(&mut self) {
        self.deliver();
        for robot in self.robots.iter_mut().filter(|robot| robot.is_alive) {
            robot.tick(&self.generate);
        }
        self.ticks += 1;
        for (index, robot) in self.robots.iter().enumerate() {
            let other = self.robots[..index].iter().position(|other| other.at.overlaps(&robot.at));
            assert_eq!(other, None, "robot {index} collides in tick {}", self.ticks);
        }
    }

    /// Ticks until something holds; `None` if it does not within `limit`.
    pub(super) fn fly(&mut self, limit: u32, mut is_done: impl FnMut(&Self) -> bool) -> Option<u32> {
        (0..limit).find(|_| {
            self.tick();
            is_done(self)
        })
    }

    /// Whether all that are alive are members of one round, know its plan and have done it.
    pub(super) fn has_arrived(&self) -> bool {
        let alive = || self.robots.iter().filter(|robot| robot.is_alive);
        let members: View = alive().map(Robot::id).collect();
        let round = alive().map(|robot| robot.rounds.proposal().round).max();
        alive().all(|robot| {
            let proposal = robot.rounds.proposal();
            robot.has_arrived()
                && Some(proposal.round) == round
                && members.difference(proposal.view).is_empty()
        })
    }

    /// What each robot waits for.
    pub(super) fn waiting(&self) -> Vec<Option<Waiting>> {
        let waiting = |robot: &Robot| robot.rounds.waiting(&teammates(&robot.heard), &*robot.list);
        self.robots.iter().map(waiting).collect()
    }

    fn deliver(&mut self) {
        let sent: Vec<_> = self.robots.iter_mut().map(|robot| (robot.stamp, robot.sent.take())).collect();
        for (from, (stamp, message)) in sent.into_iter().enumerate() {
            for (to, robot) in self.robots.iter_mut().enumerate() {
                let is_dead = self.radio.dead.contains(&(from, to));
                let is_lost = self.radio.random.happens(self.radio.loss);
                if from != to && !is_dead && !is_lost && message.is_some() {
                    robot.heard[from] = message.clone().map(|message| (stamp, message));
                }
            }
        }
    }
}
