//! A team of the state machines that fly, and everything that radio, drivers and resets may do.

use super::grid::Grid;
use super::task::{List, Place, Places};
use super::team::{K, Said, Sent, teammates};
use iibt_core::team::rounds::{Claim, JointPolicies, Protocol, Score, Scores, View, Waiting};
use iibt_core::team::{MAX_TEAM, Member, RobotId, Stamp};
use std::hash::{Hash, Hasher};
use std::rc::Rc;

/// The last messages of a robot that may still be heard.
const MEMORY: usize = 20;

/// One robot.
#[derive(Clone)]
pub(super) struct Body {
    pub(super) protocol: Protocol<Place, K>,
    pub(super) list: Rc<List>,
    pub(super) at: Places,
    pub(super) is_moving: bool,
    /// The messages of its last changes, those of earlier lives included.
    pub(super) sent: Vec<Sent>,
    pub(super) heard: Vec<Option<Sent>>,
    pub(super) stamp: Stamp,
    /// Numbers for its own state and for each message in `sent`.
    number: u64,
}

/// A whole team, and what may still be done to it.
#[derive(Clone)]
pub(super) struct World {
    pub(super) bodies: Vec<Body>,
    pub(super) openings: u8,
    /// By robot.
    pub(super) restarts: [u8; MAX_TEAM],
}

/// What can happen next.
#[derive(Clone, Copy, Debug)]
pub(super) enum Action {
    /// A robot hears the message that another sent at this place of its history; with the last
    /// value false, it hears another message before it does anything.
    Hear(usize, usize, usize, bool),
    /// It opens a round with these members.
    Open(usize, View),
    /// It gives scores that favour a policy.
    Give(usize, usize),
    /// It begins a move, or ends one.
    Begin(usize),
    End(usize),
    /// It starts again.
    Restart(usize),
    /// Between two places after a restart, it drives to one of them.
    Centre(usize, Places),
}

impl World {
    pub(super) fn new(places: &[u8], openings: u8, restarts: &[u8]) -> Self {
        let body = |(robot, &place): (u8, &u8)| {
            let member = Member::new(RobotId(robot), places.len()).expect("the team is small");
            let mut body = Body {
                protocol: Protocol::new(member, 1, 7, Place::at(place)),
                list: Rc::default(),
                at: Places::at(place),
                is_moving: false,
                sent: Vec::new(),
                heard: vec![None; places.len()],
                stamp: Stamp { epoch: 1, sequence: 0 },
                number: 0,
            };
            body.send();
            body
        };
        let mut left = [0; MAX_TEAM];
        left[..restarts.len()].copy_from_slice(restarts);
        Self { bodies: (0..).zip(places).map(body).collect(), openings, restarts: left }
    }

    /// All that can happen next.
    pub(super) fn actions(&self, grid: &Grid) -> Vec<Action> {
        let mut actions = Vec::new();
        for (robot, body) in self.bodies.iter().enumerate() {
            for (other, sender) in self.bodies.iter().enumerate().filter(|&(other, _)| other != robot) {
                let newest = body.heard[other].as_ref().map(|(stamp, _)| *stamp);
                let newer = |&(_, sent): &(usize, &Sent)| Some(sent.0) > newest;
                let sent = sender.sent.iter().enumerate().filter(newer);
                actions.extend(sent.map(|(place, _)| Action::Hear(robot, other, place, true)));
            }
            if body.is_moving {
                actions.push(Action::End(robot));
            } else if self.openings > 0 {
                actions.extend(self.views(body).map(|view| Action::Open(robot, view)));
            }
            let mates = teammates(&body.heard);
            if body.protocol.wanted(&mates).is_some() {
                actions.extend([Action::Give(robot, 0), Action::Give(robot, 1)]);
            }
            if !body.is_moving && body.protocol.may_move(&mates, &*body.list) {
                actions.push(Action::Begin(robot));
            }
            if self.restarts[robot] > 0 {
                actions.push(Action::Restart(robot));
            }
            if !body.is_moving && body.at.0.count_ones() > 1 {
                let cells =
                    (0..grid.width * grid.height).map(Places::at).filter(|cell| body.at.contains(cell));
                actions.extend(cells.map(|cell| Action::Centre(robot, cell)));
            }
        }
        actions
    }

    fn views<'a>(&self, body: &'a Body) -> impl Iterator<Item = View> + 'a {
        let team = self.bodies.len() as u8;
        let subset = move |bits: u16| {
            (0..team).map(RobotId).filter(|robot| bits & (1 << robot.0) != 0).collect::<View>()
        };
        (0..1 << team).map(subset).filter(|&view| body.protocol.may_open(view).is_ok())
    }

    /// What can come of an action: one world for each choice of what is left of old messages.
    pub(super) fn after(&self, action: Action, grid: &Grid, kept: usize) -> Vec<Self> {
        let mut world = self.clone();
        world.apply(action, grid);
        world.forget(kept)
    }

    /// How often an action is taken at random: so that much is heard, and openings and restarts
    /// come in between.
    pub(super) fn weight(&self, action: Action) -> usize {
        match action {
            Action::Hear(_, other, place, _) if place + 1 == self.bodies[other].sent.len() => 30,
            Action::Hear(..) => 5,
            Action::Give(..) | Action::Begin(_) | Action::End(_) | Action::Centre(..) => 30,
            Action::Open(..) | Action::Restart(_) => 1,
        }
    }

    pub(super) fn apply(&mut self, action: Action, grid: &Grid) {
        let robot = match action {
            Action::Hear(robot, other, place, attends) => {
                let message = self.bodies[other].sent[place].clone();
                self.bodies[robot].heard[other] = Some(message);
                if attends {
                    self.bodies[robot].attend();
                }
                robot
            }
            Action::Open(robot, view) => {
                let body = &mut self.bodies[robot];
                body.protocol.open(view, &Place { at: body.at, errand: 0 }).expect("it may");
                self.openings -= 1;
                robot
            }
            Action::Give(robot, favourite) => {
                self.bodies[robot].give(favourite, grid);
                robot
            }
            Action::Begin(robot) => {
                let body = &mut self.bodies[robot];
                body.at = body.list.between(body.policy(), body.id(), body.protocol.step());
                body.is_moving = true;
                robot
            }
            Action::End(robot) => {
                self.bodies[robot].end_move();
                robot
            }
            Action::Restart(robot) => {
                self.bodies[robot].restart();
                self.restarts[robot] -= 1;
                robot
            }
            Action::Centre(robot, place) => {
                self.bodies[robot].at = place;
                robot
            }
        };
        self.bodies[robot].send();
    }

    /// What can be left of the messages that will not be heard unless a robot starts again: `kept`
    /// of each sender, any of them. More would be no less, but too many to explore.
    fn forget(self, kept: usize) -> Vec<Self> {
        let mut worlds = vec![self];
        for sender in 0..worlds[0].bodies.len() {
            let old = worlds[0].outdated(sender, |_| true);
            let useless = worlds[0].outdated(sender, |other| worlds[0].restarts[other] == 0);
            for world in &mut worlds {
                world.bodies[sender].sent.drain(..useless);
            }
            for excess in (kept..old - useless).rev() {
                let without = |world: &Self, index: usize| {
                    let mut world = world.clone();
                    world.bodies[sender].sent.remove(index);
                    world
                };
                worlds =
                    worlds.iter().flat_map(|world| (0..=excess).map(|index| without(world, index))).collect();
            }
        }
        worlds
    }

    /// How many messages of a sender are older than what all others have heard, of which these will
    /// not start again. The last message is kept to tell whether the next differs.
    fn outdated(&self, sender: usize, is_final: impl Fn(usize) -> bool) -> usize {
        let others = self.bodies.iter().enumerate().filter(|&(other, _)| other != sender);
        let heard = others.map(|(other, body)| {
            body.heard[sender].as_ref().filter(|_| is_final(other)).map(|(stamp, _)| *stamp)
        });
        let oldest = heard.min().flatten();
        let sent = &self.bodies[sender].sent;
        sent.iter().take_while(|(stamp, _)| Some(*stamp) <= oldest).count().min(sent.len() - 1)
    }

    /// What is wrong, if anything is.
    pub(super) fn violation(&self) -> Option<String> {
        for (index, one) in self.bodies.iter().enumerate() {
            for (other, another) in self.bodies.iter().enumerate() {
                if index < other && one.at.overlaps(&another.at) {
                    return Some(format!("robots {index} and {other} share a place"));
                }
                if index < other && one.contradicts(another) {
                    return Some(format!("robots {index} and {other} follow two plans in one view"));
                }
                if index != other && one.outruns(another) {
                    return Some(format!(
                        "robot {index} makes its last move before {other} is ready for its own"
                    ));
                }
                if index != other && one.crosses(another) {
                    return Some(format!("the plan of {index} crosses robot {other}, which is left out"));
                }
            }
        }
        None
    }

    /// Whether the others, and they alone, could go on if this robot died now: they know where it
    /// can be, and are a quorum.
    pub(super) fn can_lose(&self, robot: usize) -> bool {
        let others = || self.bodies.iter().enumerate().filter(|&(other, _)| other != robot);
        let lost = RobotId(robot as u8);
        let view: View = others().map(|(_, body)| body.id()).collect();
        view.is_quorum(self.bodies.len()) && others().all(|(_, body)| body.protocol.reach(lost).is_some())
    }

    /// Whether a robot knows where another is that has not answered its start.
    pub(super) fn has_vouched(&self) -> bool {
        let robots = || (0..self.bodies.len() as u8).map(RobotId);
        let is_told =
            |body: &Body, robot| body.protocol.reach(robot).is_some() && !body.protocol.has_answered(robot);
        self.bodies.iter().any(|body| robots().any(|robot| is_told(body, robot)))
    }

    /// A number for the state: equal if and only if, but for accidents, all that follows is.
    pub(super) fn number(&self) -> u64 {
        let mut mixer = Mixer(0);
        (self.openings, self.restarts).hash(&mut mixer);
        for body in &self.bodies {
            (body.number, body.sent.len()).hash(&mut mixer);
            body.sent.iter().for_each(|(stamp, said)| (stamp.epoch, said.number).hash(&mut mixer));
            for (sender, heard) in self.bodies.iter().zip(&body.heard) {
                let newer = |stamp: Stamp| sender.sent.iter().filter(|sent| sent.0 > stamp).count();
                let heard = heard.as_ref().map(|(stamp, said)| (newer(*stamp), stamp.epoch, said.number));
                heard.hash(&mut mixer);
            }
        }
        mixer.finish()
    }
}

impl Body {
    fn id(&self) -> RobotId {
        self.protocol.member().robot()
    }

    fn policy(&self) -> usize {
        self.protocol.policy().expect("it is on its way")
    }

    fn attend(&mut self) {
        let fact = Place { at: self.at, errand: 0 };
        self.protocol.attend(&fact, !self.is_moving, &teammates(&self.heard), &*self.list);
    }

    fn give(&mut self, favourite: usize, grid: &Grid) {
        let mates = teammates(&self.heard);
        let digest = self.protocol.wanted(&mates).expect("the list is wanted");
        let facts: Vec<_> = self.protocol.facts(&mates).map(|(robot, fact)| (robot, *fact)).collect();
        self.list = grid.list(self.protocol.proposal(), &facts);
        let score = |policy| Score { delay: 0, price: u8::from(policy != favourite) };
        let scores: Scores<K> = (0..self.list.len()).map(score).collect();
        let given = self.protocol.give(digest, scores, &*self.list, &mates);
        // What it has heard since it last did anything can show that a robot left out may be
        // elsewhere.
        assert!(matches!(given, Ok(()) | Err(Waiting::Wall(_))), "{given:?}");
    }

    fn end_move(&mut self) {
        self.protocol.advance();
        self.is_moving = false;
        self.at = self.list.place(self.policy(), self.id(), self.protocol.step());
        self.attend();
    }

    fn restart(&mut self) {
        self.stamp = Stamp { epoch: self.stamp.epoch + 1, sequence: 0 };
        let fact = Place { at: self.at, errand: 0 };
        self.protocol = Protocol::new(self.protocol.member(), self.stamp.epoch, 7, fact);
        self.is_moving = false;
        self.heard.fill(None);
    }

    /// Sends what has changed; the oldest of more than [`MEMORY`] messages is gone.
    fn send(&mut self) {
        self.number = number(&(&self.protocol, self.at, self.is_moving));
        let message = self.protocol.message(&teammates(&self.heard), 0, 0.0);
        if self
            .sent
            .last()
            .is_none_or(|(stamp, last)| stamp.epoch != self.stamp.epoch || last.message != message)
        {
            self.sent.push((self.stamp, Rc::new(Said { number: number(&message), message })));
            self.stamp.sequence += 1;
            if self.sent.len() > MEMORY {
                self.sent.remove(0);
            }
        }
    }

    /// What its plan may still occupy: where it is, if it has none.
    fn ahead(&self) -> Places {
        let policy = self.protocol.policy();
        let rest = policy.map(|policy| self.list.claim(policy, self.id(), self.protocol.step()));
        rest.map_or(self.at, |rest| rest.union(&self.at))
    }

    /// What its plan has yet to enter.
    fn entered(&self) -> Places {
        Places(self.ahead().0 & !self.at.0)
    }

    fn contradicts(&self, other: &Self) -> bool {
        let views = (self.protocol.proposal().view, other.protocol.proposal().view);
        let both = self.protocol.has_decided() && other.protocol.has_decided();
        let plan = |body: &Self| (body.protocol.digest(), body.protocol.policy());
        both && views.0.contains(other.id()) && views.1.contains(self.id()) && plan(self) != plan(other)
    }

    /// Whether its plan has all make their last moves together, and it has yet to make the one
    /// before.
    pub(super) fn is_before_barrier(&self) -> bool {
        let policy = self.protocol.policy().filter(|&policy| self.list.is_together(policy));
        policy.is_some_and(|policy| self.protocol.step() + 1 < self.list.moves(policy, self.id()))
    }

    /// Whether it has begun the last move of a plan, which all make together, before another that
    /// has scored the same plan has made all its moves but the last.
    fn outruns(&self, other: &Self) -> bool {
        let plan = self.protocol.policy().filter(|&policy| self.list.is_together(policy));
        let Some(policy) = plan.filter(|_| self.protocol.digest() == other.protocol.digest()) else {
            return false;
        };
        let (moves, theirs) = (self.list.moves(policy, self.id()), self.list.moves(policy, other.id()));
        let begun = self.protocol.step() + u16::from(self.is_moving);
        moves > 0 && begun >= moves && other.protocol.step() + 1 < theirs
    }

    fn crosses(&self, other: &Self) -> bool {
        let is_member = self.protocol.proposal().view.contains(other.id());
        self.protocol.has_decided() && !is_member && self.entered().overlaps(&other.ahead())
    }
}

fn number(value: &impl Hash) -> u64 {
    let mut mixer = Mixer(0);
    value.hash(&mut mixer);
    mixer.finish()
}

/// A fast hash of small integers: multiply and fold.
struct Mixer(u64);

impl Hasher for Mixer {
    fn write(&mut self, bytes: &[u8]) {
        for chunk in bytes.chunks(8) {
            let mut word = [0; 8];
            word[..chunk.len()].copy_from_slice(chunk);
            self.write_u64(u64::from_le_bytes(word));
        }
    }

    fn write_u8(&mut self, value: u8) {
        self.write_u64(value.into());
    }

    fn write_u16(&mut self, value: u16) {
        self.write_u64(value.into());
    }

    fn write_u32(&mut self, value: u32) {
        self.write_u64(value.into());
    }

    fn write_u64(&mut self, value: u64) {
        let wide = u128::from(self.0.rotate_left(23) ^ value ^ 0x9e37_79b9_7f4a_7c15) * 0xd6e8_feb8_6659_fd93;
        self.0 = (wide as u64) ^ (wide >> 64) as u64;
    }

    fn write_usize(&mut self, value: usize) {
        self.write_u64(value as u64);
    }

    fn finish(&self) -> u64 {
        self.0
    }
}
