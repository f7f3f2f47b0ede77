//! How robots come to one joint plan over a lossy radio, and follow it in step.
//!
//! A plan is made in a *round*. In a round every robot stands still and announces one path from where it
//! stands; they choose one after another, beginning with the robot that opened the round, each knowing the
//! paths before its own. Once a robot knows every path of the round it announces the plan's digest, and when
//! all teammates have announced the same digest it begins to move. From then on it makes move k + 1 only when
//! it knows that every teammate has made move k, and only into a cell that no teammate can be in. Whoever
//! needs another plan opens a new round, which everyone joins by standing still.
//!
//! Safety needs no clock and no reliable radio. Everything a robot relies on was said by the teammate itself
//! and stays true: a path never changes within a round, moves made are never unmade, and a robot that has left
//! a round does not move again before everybody has left it. Lost, late and repeated frames cost time only.
//! Two robots can share or swap a cell only if a localiser is wrong about the cell a robot stands in.

use super::{Intention, RobotId, Round, Status};
use crate::grid::{Cell, Map, Move, Path};
use core::hash::Hasher;
use siphasher::sip::SipHasher24;

/// One robot's place in the team's joint decision.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Agreement {
    robot: RobotId,
    size: u8,
    epoch: u32,
    round: Round,
    status: Status,
    path: Path,
    goal: Option<Cell>,
    probability: f32,
    step: u8,
    plan: u32,
}

impl Round {
    /// The robot that opens, and decides first in, this round of a team of `size`.
    #[must_use]
    pub const fn opener(self, size: u8) -> RobotId {
        RobotId(if size == 0 { 0 } else { (self.0 % size as u16) as u8 })
    }

    /// The next round that `robot` may open: numbers are shared out so that no two robots open the same one.
    /// `None` when the numbers are used up.
    #[must_use]
    pub fn next_of(self, robot: RobotId, size: u8) -> Option<Self> {
        let size = u16::from(size.max(1));
        let ahead = (u16::from(robot.0) + size - self.0 % size - 1) % size + 1;
        self.0.checked_add(ahead).map(Self)
    }

    /// How many robots decide before this one in this round.
    #[must_use]
    pub const fn rank(self, robot: RobotId, size: u8) -> u8 {
        let size = if size == 0 { 1 } else { size };
        (robot.0 % size + size - self.opener(size).0) % size
    }
}

impl Agreement {
    /// A robot of a team of `size` that has just started, standing at `here`.
    #[must_use]
    pub fn new(robot: RobotId, size: u8, epoch: u32, here: Cell) -> Self {
        Self {
            robot,
            size,
            epoch,
            round: Round(0),
            status: Status::Deciding,
            path: Path::at(here),
            goal: None,
            probability: 0.0,
            step: 0,
            plan: 0,
        }
    }

    /// The round it is in.
    #[must_use]
    pub const fn round(&self) -> Round {
        self.round
    }

    /// What it is doing.
    #[must_use]
    pub const fn status(&self) -> Status {
        self.status
    }

    /// Its path in this round; only where it stands while it has not chosen.
    #[must_use]
    pub const fn path(&self) -> &Path {
        &self.path
    }

    /// How many moves of the path are done.
    #[must_use]
    pub const fn step(&self) -> usize {
        self.step as usize
    }

    /// The goal it has chosen.
    #[must_use]
    pub const fn goal(&self) -> Option<Cell> {
        self.goal
    }

    /// The posterior probability of its choice.
    #[must_use]
    pub const fn probability(&self) -> f32 {
        self.probability
    }

    /// The digest of the joint plan it has agreed to; zero before it has.
    #[must_use]
    pub const fn plan(&self) -> u32 {
        self.plan
    }

    /// Whether it knows the whole plan of this round.
    #[must_use]
    pub const fn is_agreed(&self) -> bool {
        self.plan != 0
    }

    /// Whether all moves of its path are done.
    #[must_use]
    pub const fn is_complete(&self) -> bool {
        self.is_agreed() && self.step as usize == self.path.len()
    }

    /// Joins the newest round that a teammate is in, if that is newer than its own; returns whether it did.
    ///
    /// Call it only while the robot stands still, `here`.
    pub fn join<'a>(&mut self, here: Cell, peers: impl Iterator<Item = &'a Intention>) -> bool {
        let newest = peers.map(|peer| peer.round).max().filter(|&round| round > self.round);
        if let Some(round) = newest {
            self.anchor(round, here);
        }
        newest.is_some()
    }

    /// Opens a new round, standing still `here`. Does nothing when the round numbers are used up.
    pub fn open(&mut self, here: Cell) {
        if let Some(round) = self.round.next_of(self.robot, self.size) {
            self.anchor(round, here);
        }
    }

    /// Whether this robot is the one to choose now: all teammates are in this round, and those that decide
    /// before it have chosen.
    pub fn is_my_turn<'a>(&self, mut peers: impl Iterator<Item = &'a Intention>) -> bool {
        let rank = self.round.rank(self.robot, self.size);
        let ready = |peer: &Intention| {
            let first = self.round.rank(peer.robot, self.size) < rank;
            peer.round == self.round && (!first || has_chosen(peer))
        };
        self.status == Status::Deciding && self.all_of(&mut peers, ready)
    }

    /// Announces the chosen path, which must begin where the robot stands. It keeps it for this round.
    pub fn announce(&mut self, path: Path, goal: Option<Cell>, probability: f32) {
        if self.status == Status::Deciding && path.start == self.path.start {
            (self.path, self.goal, self.probability) = (path, goal, probability);
            self.status = Status::Announced;
        }
    }

    /// Agrees to the joint plan once every teammate has announced its path of this round.
    pub fn agree<'a>(&mut self, peers: impl Iterator<Item = &'a Intention> + Clone) {
        let knows = self.all_of(&mut peers.clone(), |peer| peer.round == self.round && has_chosen(peer));
        if self.status == Status::Announced && knows {
            self.plan = self.digest(peers);
            self.status = Status::Agreed;
        }
    }

    /// Whether a teammate has agreed to another plan in this round: one of the two knows an outdated path,
    /// because somebody has started anew, and only another round can help.
    pub fn is_contradicted<'a>(&self, mut peers: impl Iterator<Item = &'a Intention> + Clone) -> bool {
        let restarted = self.is_agreed() && self.digest(peers.clone()) != self.plan;
        let other = |peer: &Intention| peer.round == self.round && peer.plan != 0 && peer.plan != self.plan;
        self.is_agreed() && (restarted || peers.any(other))
    }

    /// The next move of the path, when it is safe to make it now; `None` to stand still.
    #[must_use]
    pub fn next_move<'a, const W: usize>(
        &self,
        map: &Map<W>,
        mut peers: impl Iterator<Item = &'a Intention>,
    ) -> Option<Move> {
        let target = self.path.cell_at(map, self.step() + 1);
        let step = self.path.actions.get(self.step()).and_then(Move::from_code)?;
        let free =
            |peer: &Intention| self.keeps_pace(peer) && (step == Move::Wait || !may_be_in(map, peer, target));
        (self.is_agreed() && self.all_of(&mut peers, free)).then_some(step)
    }

    /// Counts the move that brought the robot from its last cell to `here`, or the wait when it `waited`;
    /// returns whether there was one.
    pub fn advance<const W: usize>(&mut self, map: &Map<W>, here: Cell, waited: bool) -> bool {
        let Some(step) = self.path.actions.get(self.step()).and_then(Move::from_code) else { return false };
        let done = if step == Move::Wait { waited } else { here == self.path.cell_at(map, self.step() + 1) };
        let counts = self.is_agreed() && done;
        self.step = self.step.saturating_add(u8::from(counts));
        counts
    }

    /// The cell in which the robot is, by its path and the moves that are done.
    #[must_use]
    pub fn place<const W: usize>(&self, map: &Map<W>) -> Cell {
        self.path.cell_at(map, self.step())
    }

    /// Says that the robot is where it wanted to be.
    pub fn arrive(&mut self) {
        if self.is_complete() {
            self.status = Status::Arrived;
        }
    }

    fn anchor(&mut self, round: Round, here: Cell) {
        *self = Self { round, ..Self::new(self.robot, self.size, self.epoch, here) };
    }

    /// Whether a condition holds for every one of the N - 1 teammates.
    fn all_of<'a>(
        &self,
        peers: &mut impl Iterator<Item = &'a Intention>,
        condition: impl Fn(&Intention) -> bool,
    ) -> bool {
        let mut met = 0;
        peers.all(|peer| {
            met += 1;
            condition(peer)
        }) && met + 1 == usize::from(self.size)
    }

    /// Whether a teammate follows the same plan and is at least as far as this robot.
    fn keeps_pace(&self, peer: &Intention) -> bool {
        let far_enough = peer.step >= self.step || usize::from(peer.step) >= peer.path.len();
        peer.round == self.round && peer.plan == self.plan && far_enough
    }

    /// A number that is the same for two robots exactly when they know the same paths of the same round.
    fn digest<'a>(&self, peers: impl Iterator<Item = &'a Intention> + Clone) -> u32 {
        let mut hasher = SipHasher24::new();
        for robot in 0..self.size {
            if robot == self.robot.0 {
                absorb(&mut hasher, self.round, self.epoch, &self.path);
            }
            for peer in peers.clone().filter(|peer| peer.robot.0 == robot) {
                absorb(&mut hasher, peer.round, peer.epoch, &peer.path);
            }
        }
        (hasher.finish() as u32).max(1)
    }
}

/// Byte by byte, because the derived `Hash` depends on the width of `usize`.
fn absorb(hasher: &mut SipHasher24, round: Round, epoch: u32, path: &Path) {
    hasher.write(&round.0.to_le_bytes());
    hasher.write(&epoch.to_le_bytes());
    hasher.write(&path.start.0.to_le_bytes());
    hasher.write(&[path.len() as u8]);
    path.actions.iter().for_each(|action| hasher.write(&[action]));
}

/// Whether a robot has announced its path of this round.
const fn has_chosen(peer: &Intention) -> bool {
    matches!(peer.status, Status::Announced | Status::Agreed | Status::Arrived)
}

/// Whether a teammate can be in `cell`: where it last said it was, or one move further.
fn may_be_in<const W: usize>(map: &Map<W>, peer: &Intention, cell: Cell) -> bool {
    let step = usize::from(peer.step);
    peer.path.cells(map).skip(step).take(2).any(|occupied| occupied == cell)
}
