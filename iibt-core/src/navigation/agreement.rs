//! Agreement on one joint plan over a lossy radio, and its execution.
//!
//! A plan is made in a *round*. In a round every robot stands still and announces one path from
//! where it stands. The robots choose one after another, beginning with the robot that opened the
//! round; each knows the paths chosen before its own. A robot that knows every path of the round
//! announces a digest of the plan. When all teammates have announced the same digest, it begins to
//! move.
//!
//! While it moves, a robot enters a cell only when every teammate that the plan puts there earlier
//! has announced that it has left it. The last move has a barrier: a robot makes it only when all
//! others have at most their last move to make. The robots keep the order of the plan rather than
//! its clock, and arrive together. A robot that needs another plan opens a new round, which all
//! others join standing still.
//!
//! A slow robot's move takes several steps: its path has as many waits, less one, before the move.
//! The robot sets out at the first of them, under the same rule for the cell it enters. It counts
//! the waits while it is between the two cells, and the move once it stands in the new one. The
//! order of the plan is kept.
//!
//! A robot that has to act outside the plan, for example to charge, requests mutual exclusion: it
//! opens a round in which it announces that it is away. It does not choose, so no other robot can
//! choose in that round. Each teammate grants the request with a digest of the round and of the
//! requester's epoch. With the grants of all teammates the robot alone may move. The grant is
//! released by a newer round, in which no robot moves before the one that was away has joined,
//! standing still.
//!
//! Safety needs no clock and no reliable radio. A robot relies only on what its teammates have
//! announced themselves, and that stays true: a path never changes within a round, moves are never
//! undone, and a robot that has left a round moves again only when all have left it. Where two
//! paths share a cell, the plan orders them, and the second robot waits until the first has
//! announced that it has left. No plan puts two robots in one cell in one step or lets them swap
//! cells, so no cycle of waiting arises. Lost, late and repeated frames cost time only. Two robots
//! can share or swap a cell only if a localiser is wrong about the cell a robot stands in.

use super::{Paces, Round, Said, Stage};
use crate::grid::{Cell, Map, Move, Path};
use crate::team::RobotId;
use core::hash::Hasher;
use siphasher::sip::SipHasher24;

/// One robot's place in the team's joint decision.
///
/// ```
/// use iibt_core::grid::{Cell, Map, Path};
/// use iibt_core::navigation::{Agreement, Intention, Paces, Said, Stage};
/// use iibt_core::team::{Envelope, RobotId, Stamp};
///
/// let said = |robot: &Agreement, sender| {
///     let message = Intention {
///         round: robot.round(),
///         stage: robot.stage(),
///         plan: robot.plan(),
///         goal: robot.goal(),
///         path: *robot.path(),
///         step: robot.step() as u8,
///         probability: robot.probability(),
///         hazards: heapless::Vec::new(),
///     };
///     Said { sender: RobotId(sender), stamp: Stamp { epoch: 1, sequence: 0 }, message }
/// };
/// let map = Map::<1>::new(4, 2)?;
/// let mut first = Agreement::new(RobotId(0), 2, 1, Cell(0));
/// let mut second = Agreement::new(RobotId(1), 2, 1, Cell(4));
/// assert!(first.is_my_turn([&said(&second, 1)].into_iter()));
/// assert!(!second.is_my_turn([&said(&first, 0)].into_iter())); // not before the first has chosen
///
/// let way = |cells: &[Cell]| Path::through(&map, cells).ok_or("no neighbours");
/// first.announce(way(&[Cell(0), Cell(1)])?, Some(Cell(1)), 0.9);
/// assert!(second.is_my_turn([&said(&first, 0)].into_iter()));
/// second.announce(way(&[Cell(4), Cell(5)])?, Some(Cell(5)), 0.9);
/// first.agree([&said(&second, 1)].into_iter());
/// second.agree([&said(&first, 0)].into_iter());
/// assert!(first.is_agreed() && first.plan() == second.plan()); // the digests are equal
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias = "two-phase commit")]
#[doc(alias = "consensus")]
#[doc(alias = "commit protocol")]
#[doc(alias = "mutual exclusion")]
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Agreement {
    robot: RobotId,
    size: u8,
    epoch: u32,
    round: Round,
    stage: Stage,
    path: Path,
    goal: Option<Cell>,
    probability: f32,
    step: u8,
    plan: u32,
}

impl Round {
    /// Returns the robot that opens this round in a team of `size` and decides first.
    #[must_use]
    pub const fn opener(self, size: u8) -> RobotId {
        RobotId(if size == 0 { 0 } else { (self.0 % size as u16) as u8 })
    }

    /// Returns the next round that `robot` may open; `None` when the numbers are used up.
    ///
    /// Every robot has round numbers of its own, so that no two robots open the same round.
    #[must_use]
    pub fn next_of(self, robot: RobotId, size: u8) -> Option<Self> {
        let size = u16::from(size.max(1));
        let ahead = (u16::from(robot.0) + size - self.0 % size - 1) % size + 1;
        self.0.checked_add(ahead).map(Self)
    }

    /// Returns the number of robots that decide before this one in this round.
    #[must_use]
    pub const fn rank(self, robot: RobotId, size: u8) -> u8 {
        let size = if size == 0 { 1 } else { size as u16 };
        ((robot.0 as u16 + size - self.0 % size) % size) as u8
    }
}

impl Agreement {
    /// Creates the state of a robot of a team of `size` that has just started and stands at `here`.
    #[must_use]
    pub fn new(robot: RobotId, size: u8, epoch: u32, here: Cell) -> Self {
        Self {
            robot,
            size,
            epoch,
            round: Round(0),
            stage: Stage::Deciding,
            path: Path::at(here),
            goal: None,
            probability: 0.0,
            step: 0,
            plan: 0,
        }
    }

    /// Returns the current round.
    #[must_use]
    pub const fn round(&self) -> Round {
        self.round
    }

    /// Returns the robot's stage in the round.
    #[must_use]
    pub const fn stage(&self) -> Stage {
        self.stage
    }

    /// Returns the robot's path in this round: no move while it has not chosen.
    #[must_use]
    pub const fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the number of moves of the path that are done.
    #[must_use]
    pub const fn step(&self) -> usize {
        self.step as usize
    }

    /// Returns the chosen goal.
    #[must_use]
    pub const fn goal(&self) -> Option<Cell> {
        self.goal
    }

    /// Returns the posterior probability of the choice.
    #[must_use]
    pub const fn probability(&self) -> f32 {
        self.probability
    }

    /// Returns the digest of the joint plan the robot has agreed to, or of the request it has
    /// granted; else zero.
    #[must_use]
    pub const fn plan(&self) -> u32 {
        self.plan
    }

    /// Returns whether the robot knows the whole plan of this round.
    #[must_use]
    pub const fn is_agreed(&self) -> bool {
        matches!(self.stage, Stage::Agreed | Stage::Arrived)
    }

    /// Returns whether all moves of the path are done.
    #[must_use]
    pub const fn is_complete(&self) -> bool {
        self.is_agreed() && self.step as usize == self.path.len()
    }

    /// Joins the newest round of any teammate, if it is newer than the own; returns whether it did.
    ///
    /// Call it only while the robot stands still, `here`.
    pub fn join<'a>(&mut self, here: Cell, peers: impl Iterator<Item = &'a Said>) -> bool {
        let newest = peers.map(|peer| peer.message.round).max().filter(|&round| round > self.round);
        if let Some(round) = newest {
            self.anchor(round, here);
        }
        newest.is_some()
    }

    /// Opens a new round, standing still at `here`.
    ///
    /// Does nothing when the round numbers are used up: the team can then only follow the last plan
    /// to its end.
    pub fn open(&mut self, here: Cell) {
        if let Some(round) = self.round.next_of(self.robot, self.size) {
            self.anchor(round, here);
        }
    }

    /// Requests mutual exclusion: opens a round in which this robot is away and no robot chooses.
    ///
    /// Does nothing when the round numbers are used up.
    pub fn leave(&mut self, here: Cell) {
        let before = self.round;
        self.open(here);
        if self.round != before {
            self.stage = Stage::Away;
        }
    }

    /// Returns whether this robot has requested mutual exclusion in the current round.
    #[must_use]
    pub const fn is_away(&self) -> bool {
        matches!(self.stage, Stage::Away)
    }

    /// Sets the announced position of a robot that is away; it has no path to follow.
    pub const fn set_position(&mut self, here: Cell) {
        if self.is_away() {
            self.path = Path::at(here);
        }
    }

    /// Sets the announced target of a robot that is away; `None` when no way leads there.
    pub const fn set_target(&mut self, goal: Option<Cell>) {
        if self.is_away() {
            self.goal = goal;
        }
    }

    /// Returns the teammate that requests mutual exclusion in this round.
    pub fn teammate_away<'a>(&self, mut peers: impl Iterator<Item = &'a Said>) -> Option<&'a Said> {
        let opener = self.round.opener(self.size);
        peers.find(|peer| {
            peer.sender == opener && peer.message.round == self.round && peer.message.stage == Stage::Away
        })
    }

    /// Grants the request of the teammate that opened this round, or withdraws the grant; returns
    /// whether it is granted.
    ///
    /// Call it only while the robot stands still.
    pub fn grant<'a>(&mut self, peers: impl Iterator<Item = &'a Said>) -> bool {
        let away = self.teammate_away(peers).filter(|_| self.stage == Stage::Deciding);
        let leave = away.map(|peer| digest_of_leave(peer.message.round, peer.stamp.epoch));
        if self.stage == Stage::Deciding {
            self.plan = leave.unwrap_or(0);
        }
        leave.is_some()
    }

    /// Returns whether every teammate has granted this robot's request. They stand where their
    /// paths start, and this robot may drive around those cells until it joins another round.
    pub fn is_granted<'a>(&self, mut peers: impl Iterator<Item = &'a Said>) -> bool {
        let leave = digest_of_leave(self.round, self.epoch);
        self.is_away()
            && self.all_of(&mut peers, |peer| peer.message.round == self.round && peer.message.plan == leave)
    }

    /// Returns whether it is this robot's turn to choose: all teammates are in this round, and
    /// those that decide before it have chosen.
    pub fn is_my_turn<'a>(&self, mut peers: impl Iterator<Item = &'a Said>) -> bool {
        let rank = self.round.rank(self.robot, self.size);
        let ready = |peer: &Said| {
            let first = self.round.rank(peer.sender, self.size) < rank;
            peer.message.round == self.round && (!first || has_chosen(peer))
        };
        self.stage == Stage::Deciding && self.all_of(&mut peers, ready)
    }

    /// Announces the chosen path, which must begin where the robot stands. It stays fixed for this
    /// round.
    pub fn announce(&mut self, path: Path, goal: Option<Cell>, probability: f32) {
        if self.stage == Stage::Deciding && path.start == self.path.start {
            (self.path, self.goal, self.probability) = (path, goal, probability);
            self.stage = Stage::Announced;
        }
    }

    /// Agrees to the joint plan once every teammate has announced its path of this round.
    pub fn agree<'a>(&mut self, peers: impl Iterator<Item = &'a Said> + Clone) {
        let knows =
            self.all_of(&mut peers.clone(), |peer| peer.message.round == self.round && has_chosen(peer));
        if self.stage == Stage::Announced && knows {
            self.plan = self.digest(peers);
            self.stage = Stage::Agreed;
        }
    }

    /// Returns whether a teammate has agreed to another plan in this round.
    ///
    /// One of the two robots then knows an outdated path, because a robot has restarted; only
    /// another round helps.
    pub fn is_contradicted<'a>(&self, mut peers: impl Iterator<Item = &'a Said> + Clone) -> bool {
        let restarted = self.is_agreed() && self.digest(peers.clone()) != self.plan;
        let other = |peer: &Said| {
            peer.message.round == self.round && peer.message.plan != 0 && peer.message.plan != self.plan
        };
        self.is_agreed() && (restarted || peers.any(other))
    }

    /// Returns the next step if it is safe to begin it at `here` now; `None` to stand still.
    ///
    /// A slow robot begins a move with the first of the waits before it, or with a later one if the
    /// cell is not free yet.
    #[must_use]
    pub fn next_move<'a, const W: usize>(
        &self,
        map: &Map<W>,
        paces: Paces<'_>,
        here: Cell,
        peers: impl Iterator<Item = &'a Said> + Clone,
    ) -> Option<Move> {
        let planned = self.planned()?;
        let (step, at) = self.ahead(paces);
        let is_there = here != self.place(map);
        if !self.is_on_course(map, paces, here) || !self.may_go_on(paces, peers.clone()) {
            return None;
        }
        let target = self.path.cell_at(map, at);
        let mut clear = peers.map(|peer| has_left(map, peer, target, at));
        if step == Move::Wait || is_there {
            Some(Move::Wait)
        } else if clear.all(|clear| clear) {
            Some(step)
        } else {
            Some(Move::Wait).filter(|_| planned == Move::Wait)
        }
    }

    /// Returns whether the robot may begin the next step: the whole team follows this plan, and
    /// before the last move, the barrier, every teammate is as far as this robot.
    pub fn may_go_on<'a>(&self, paces: Paces<'_>, mut peers: impl Iterator<Item = &'a Said>) -> bool {
        let (_, at) = self.ahead(paces);
        let is_last = self.path.actions.iter().skip(at).all(|code| code == Move::Wait.code());
        let follows = |peer: &Said| {
            let shares = peer.message.round == self.round && peer.message.plan == self.plan;
            shares && (!is_last || self.is_abreast(peer))
        };
        self.is_agreed() && self.all_of(&mut peers, follows)
    }

    /// Returns whether the robot is at a cell of its plan: the current one or, for a slow robot,
    /// the next.
    #[must_use]
    pub fn is_on_course<const W: usize>(&self, map: &Map<W>, paces: Paces<'_>, here: Cell) -> bool {
        let next = || self.path.cell_at(map, self.ahead(paces).1);
        let is_early = || self.is_agreed() && self.is_slow(paces) && here == next();
        here == self.place(map) || is_early()
    }

    /// Counts the step that was `begun` when [`next_move`](Self::next_move) gave it: a wait, or a
    /// move that brought the robot to `here`. Returns whether there was one.
    pub fn advance<const W: usize>(
        &mut self,
        map: &Map<W>,
        paces: Paces<'_>,
        here: Cell,
        begun: bool,
    ) -> bool {
        let Some(step) = self.planned() else { return false };
        // A slow robot can be there before its teammates have begun the step.
        let arrived = here == self.path.cell_at(map, self.step() + 1) && (begun || !self.is_slow(paces));
        self.count(if step == Move::Wait { begun } else { arrived })
    }

    /// Counts a step of a slow robot that is between two cells: one of the waits before its move.
    pub fn advance_on_the_way(&mut self, begun: bool) -> bool {
        self.count(begun && self.planned() == Some(Move::Wait))
    }

    fn count(&mut self, done: bool) -> bool {
        let counts = self.is_agreed() && done;
        self.step = self.step.saturating_add(u8::from(counts));
        counts
    }

    /// Returns the path's next step; `None` at its end.
    fn planned(&self) -> Option<Move> {
        self.path.actions.get(self.step()).and_then(Move::from_code)
    }

    fn is_slow(&self, paces: Paces<'_>) -> bool {
        paces.of(self.robot).get() > 1
    }

    /// Returns the next move within the robot's pace and the number of steps done after it; else a
    /// wait, and the steps done now.
    fn ahead(&self, paces: Paces<'_>) -> (Move, usize) {
        let (done, pace) = (self.step(), paces.of(self.robot).get());
        let mut within = self.path.moves().enumerate().skip(done).take(pace);
        let next = within.find(|&(_, step)| step != Move::Wait);
        next.map_or((Move::Wait, done), |(at, step)| (step, at + 1))
    }

    /// Returns the cell in which the robot is according to its path and the moves that are done.
    #[must_use]
    pub fn place<const W: usize>(&self, map: &Map<W>) -> Cell {
        self.path.cell_at(map, self.step())
    }

    /// Marks the mission as done: the robot stands on its goal.
    pub fn arrive(&mut self) {
        if self.is_complete() {
            self.stage = Stage::Arrived;
        }
    }

    fn anchor(&mut self, round: Round, here: Cell) {
        *self = Self { round, ..Self::new(self.robot, self.size, self.epoch, here) };
    }

    /// Returns whether a condition holds for every one of the N - 1 teammates.
    fn all_of<'a>(
        &self,
        peers: &mut impl Iterator<Item = &'a Said>,
        condition: impl Fn(&Said) -> bool,
    ) -> bool {
        // Counted, because a teammate that was never heard is not among the peers.
        let mut met = 0;
        peers.all(|peer| {
            met += 1;
            condition(peer)
        }) && met + 1 == usize::from(self.size)
    }

    /// Returns whether a teammate is at least as far as this robot.
    const fn is_abreast(&self, peer: &Said) -> bool {
        peer.message.step >= self.step || peer.message.step as usize >= peer.message.path.len()
    }

    /// Returns a digest of the round and its paths: equal on two robots that know the same plan;
    /// two different plans share one with probability 2^-32.
    fn digest<'a>(&self, peers: impl Iterator<Item = &'a Said> + Clone) -> u32 {
        // In the order of the robots, so that every robot hashes the same bytes. The epochs are in
        // it because a teammate that has restarted no longer keeps the plan, even with an equal
        // path.
        let mut hasher = SipHasher24::new();
        for robot in 0..self.size {
            if robot == self.robot.0 {
                absorb(&mut hasher, self.round, self.epoch, &self.path);
            }
            for peer in peers.clone().filter(|peer| peer.sender.0 == robot) {
                absorb(&mut hasher, peer.message.round, peer.stamp.epoch, &peer.message.path);
            }
        }
        seal(&hasher)
    }
}

/// Returns the digest that grants the request of the robot that opened a round in this epoch.
fn digest_of_leave(round: Round, epoch: u32) -> u32 {
    let mut hasher = SipHasher24::new();
    absorb(&mut hasher, round, epoch, &Path::default());
    seal(&hasher)
}

/// Returns a digest that is never zero.
#[inline(never)]
fn seal(hasher: &SipHasher24) -> u32 {
    (hasher.finish() as u32).max(1)
}

/// Hashes byte by byte, because the derived `Hash` depends on the width of `usize`.
#[inline(never)]
fn absorb(hasher: &mut SipHasher24, round: Round, epoch: u32, path: &Path) {
    hasher.write(&round.0.to_le_bytes());
    hasher.write(&epoch.to_le_bytes());
    hasher.write(&path.start.0.to_le_bytes());
    hasher.write(&[path.len() as u8]);
    path.actions.iter().for_each(|action| hasher.write(&[action]));
}

/// Returns whether a robot has announced its path of this round.
const fn has_chosen(peer: &Said) -> bool {
    matches!(peer.message.stage, Stage::Announced | Stage::Agreed | Stage::Arrived)
}

/// Returns whether a teammate has left `cell` for good in the plan up to `step`. Where it comes to
/// the cell in a later step, it waits for this robot.
fn has_left<const W: usize>(map: &Map<W>, peer: &Said, cell: Cell, step: usize) -> bool {
    let path = || peer.message.path.cells(map).enumerate();
    let visits = path().take(step + 1).filter(|&(_, visited)| visited == cell);
    let Some((visit, _)) = visits.last() else { return true };
    path()
        .skip(visit)
        .find(|&(_, next)| next != cell)
        .is_some_and(|(gone, _)| usize::from(peer.message.step) >= gone)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::navigation::Intention;
    use crate::team::Stamp;
    use heapless::Vec;

    /// A corridor of eight cells.
    fn corridor() -> Map<1> {
        Map::new(8, 1).unwrap()
    }

    fn path(cells: &[u16]) -> Path {
        let cells: Vec<Cell, 8> = cells.iter().copied().map(Cell).collect();
        Path::through(&corridor(), &cells).unwrap()
    }

    /// The message that a robot announces.
    fn said(agreement: &Agreement) -> Said {
        let message = Intention {
            round: agreement.round,
            stage: agreement.stage,
            plan: agreement.plan,
            goal: agreement.goal,
            path: agreement.path,
            step: agreement.step,
            probability: agreement.probability,
            hazards: Vec::new(),
        };
        let stamp = Stamp { epoch: agreement.epoch, sequence: 0 };
        Said { sender: agreement.robot, stamp, message }
    }

    fn changed(said: &Said, change: impl FnOnce(&mut Said)) -> Said {
        let mut said = said.clone();
        change(&mut said);
        said
    }

    fn announcing(robot: u8, size: u8, cells: &[u16]) -> Agreement {
        let path = path(cells);
        let mut agreement = Agreement::new(RobotId(robot), size, 1, path.start);
        agreement.announce(path, None, 1.0);
        agreement
    }

    /// Two robots that have agreed to follow these paths.
    fn agreed(first: &[u16], second: &[u16]) -> (Agreement, Agreement) {
        let (mut one, mut other) = (announcing(0, 2, first), announcing(1, 2, second));
        one.agree([&said(&other)].into_iter());
        other.agree([&said(&one)].into_iter());
        assert!(one.is_agreed() && one.plan() == other.plan());
        (one, other)
    }

    fn step_of(robot: &Agreement, peer: &Said) -> Option<Move> {
        robot.next_move(&corridor(), Paces::EVEN, robot.place(&corridor()), [peer].into_iter())
    }

    #[test]
    fn rounds_are_shared_out_among_the_robots() {
        for size in 1..=8 {
            let mut openers = [0; 8];
            for round in 0..64 {
                for robot in 0..size {
                    let next = Round(round).next_of(RobotId(robot), size).unwrap();
                    assert!(next > Round(round) && next <= Round(round + u16::from(size)));
                    assert_eq!(next.opener(size), RobotId(robot));
                }
                openers[Round(round).opener(size).index()] += 1;
                let ranks: Vec<u8, 8> =
                    (0..size).map(|robot| Round(round).rank(RobotId(robot), size)).collect();
                assert_eq!(ranks[Round(round).opener(size).index()], 0);
                assert!((0..size).all(|rank| ranks.contains(&rank)), "{ranks:?}");
            }
        }
        assert_eq!(Round(u16::MAX).next_of(RobotId(0), 2), None);
        assert_eq!(Round(u16::MAX - 1).next_of(RobotId(1), 2), Some(Round(u16::MAX)));
        assert_eq!(Round(1).rank(RobotId(254), 255), 253);
        assert_eq!((Round(7).opener(0), Round(7).rank(RobotId(3), 0)), (RobotId(0), 0));
    }

    #[test]
    fn a_robot_that_is_away_has_the_floor_once_all_have_acknowledged_it_in_this_round() {
        let [mut away, mut second, mut third] =
            [0, 1, 2].map(|robot| Agreement::new(RobotId(robot), 3, 1, Cell(2 * u16::from(robot))));
        away.leave(Cell(0));
        assert_eq!((away.round(), away.stage(), away.goal()), (Round(3), Stage::Away, None));
        assert!(!away.is_granted([&said(&second), &said(&third)].into_iter()), "nobody knows");
        for robot in [&mut second, &mut third] {
            let here = robot.path.start;
            assert!(robot.join(here, [&said(&away)].into_iter()));
            assert!(robot.grant([&said(&away)].into_iter()));
            assert!(!robot.is_agreed() && !robot.is_my_turn([&said(&away)].into_iter()));
        }
        assert!(!away.is_granted([&said(&second)].into_iter()), "one is unheard");
        assert!(away.is_granted([&said(&second), &said(&third)].into_iter()));
        away.set_position(Cell(1));
        assert_eq!((away.place(&corridor()), away.step()), (Cell(1), 0));

        third.open(Cell(4));
        assert!(!away.is_granted([&said(&second), &said(&third)].into_iter()), "one is in a newer round");
        assert!(away.join(Cell(1), [&said(&third)].into_iter()) && !away.is_away());
    }

    #[test]
    fn what_was_acknowledged_before_a_restart_counts_no_more() {
        let mut away = Agreement::new(RobotId(0), 2, 1, Cell(0));
        let mut teammate = Agreement::new(RobotId(1), 2, 1, Cell(4));
        away.leave(Cell(0));
        teammate.join(Cell(4), [&said(&away)].into_iter());
        teammate.grant([&said(&away)].into_iter());
        let mut restarted = Agreement::new(RobotId(0), 2, 2, Cell(0));
        restarted.leave(Cell(0));
        assert_eq!(restarted.round(), away.round());
        assert!(away.is_granted([&said(&teammate)].into_iter()));
        assert!(!restarted.is_granted([&said(&teammate)].into_iter()));
        teammate.grant([&said(&restarted)].into_iter());
        assert!(restarted.is_granted([&said(&teammate)].into_iter()));
    }

    #[test]
    fn an_acknowledgement_is_taken_back_when_the_robot_is_back() {
        let mut away = Agreement::new(RobotId(0), 2, 1, Cell(0));
        let mut teammate = Agreement::new(RobotId(1), 2, 1, Cell(4));
        away.leave(Cell(0));
        teammate.join(Cell(4), [&said(&away)].into_iter());
        assert!(teammate.grant([&said(&away)].into_iter()) && teammate.plan() != 0);
        assert_eq!(
            teammate.teammate_away([&said(&away)].into_iter()).map(|peer| peer.sender),
            Some(RobotId(0))
        );
        away.stage = Stage::Deciding;
        assert!(!teammate.grant([&said(&away)].into_iter()) && teammate.plan() == 0);
    }

    #[test]
    fn whose_turn_it_is() {
        let mut waiting = Agreement::new(RobotId(1), 3, 1, Cell(4));
        waiting.round = Round(1); // opened by this robot, then come robots 2 and 0
        let peer = |robot, round, status| {
            let mut agreement = Agreement::new(RobotId(robot), 3, 1, Cell(0));
            (agreement.round, agreement.stage) = (Round(round), status);
            said(&agreement)
        };
        let turn = |agreement: &Agreement, peers: &[Said]| agreement.is_my_turn(peers.iter());
        let (zero, two) = (peer(0, 1, Stage::Deciding), peer(2, 1, Stage::Deciding));
        assert!(turn(&waiting, &[zero.clone(), two.clone()]), "it chooses first");
        assert!(!turn(&waiting, core::slice::from_ref(&zero)), "a teammate is unheard");
        assert!(!turn(&waiting, &[zero.clone(), peer(2, 0, Stage::Announced)]), "one is in another round");
        waiting.announce(Path::at(Cell(4)), None, 1.0);
        assert!(!turn(&waiting, &[zero, two]), "it has chosen");

        let mut last = Agreement::new(RobotId(0), 3, 1, Cell(4));
        last.round = Round(1);
        let after = |first, second| turn(&last, &[peer(1, 1, first), peer(2, 1, second)]);
        assert!(after(Stage::Announced, Stage::Announced) && after(Stage::Agreed, Stage::Arrived));
        assert!(!after(Stage::Announced, Stage::Deciding) && !after(Stage::Deciding, Stage::Announced));
        assert!(!after(Stage::Announced, Stage::Away));
    }

    #[test]
    fn a_path_is_kept_for_the_round_and_begins_where_the_robot_stands() {
        let mut robot = Agreement::new(RobotId(0), 2, 1, Cell(3));
        robot.announce(path(&[2, 3]), None, 1.0);
        assert_eq!(robot.stage(), Stage::Deciding, "it does not stand on 2");
        robot.announce(path(&[3, 4]), Some(Cell(4)), 0.5);
        robot.announce(path(&[3, 2]), None, 1.0);
        let said = (robot.stage(), *robot.path(), robot.goal(), robot.probability());
        assert_eq!(said, (Stage::Announced, path(&[3, 4]), Some(Cell(4)), 0.5));
    }

    #[test]
    fn agrees_when_it_knows_every_path_of_its_round() {
        let peer = said(&announcing(1, 2, &[5, 6]));
        let plan = |peer: &[Said]| {
            let mut robot = announcing(0, 2, &[1, 2]);
            robot.agree(peer.iter());
            robot.plan()
        };
        assert_ne!(plan(core::slice::from_ref(&peer)), 0);
        assert_eq!(plan(&[]), 0);
        assert_eq!(plan(&[changed(&peer, |said| said.message.round = Round(1))]), 0);
        assert_eq!(plan(&[changed(&peer, |said| said.message.stage = Stage::Deciding)]), 0);
        let mut deciding = Agreement::new(RobotId(0), 2, 1, Cell(1));
        deciding.agree([&peer].into_iter());
        assert!(!deciding.is_agreed(), "it has not chosen itself");
        let mut alone = announcing(0, 1, &[1, 2]);
        alone.agree([].into_iter());
        assert!(alone.is_agreed(), "a team of one");
    }

    #[test]
    fn plans_are_equal_only_where_all_that_counts_is() {
        let peer = said(&announcing(1, 2, &[5, 6]));
        let plan = |own: &[u16], peer: &Said| announcing(0, 2, own).digest([peer].into_iter());
        let usual = plan(&[1, 2], &peer);
        let same = changed(&peer, |said| (said.message.step, said.stamp.sequence) = (1, 9));
        assert_eq!(plan(&[1, 2], &same), usual);
        assert_eq!(announcing(1, 2, &[5, 6]).digest([&said(&announcing(0, 2, &[1, 2]))].into_iter()), usual);
        let others = [
            plan(&[2, 3], &peer),
            plan(&[1, 2, 3], &peer),
            plan(&[1, 0], &peer),
            plan(&[1, 2], &changed(&peer, |said| said.stamp.epoch = 2)),
            plan(&[1, 2], &changed(&peer, |said| said.message.round = Round(2))),
            plan(&[1, 2], &changed(&peer, |said| said.message.path = path(&[6, 7]))),
            plan(&[1, 2], &changed(&peer, |said| said.message.path = path(&[5, 6, 6]))),
        ];
        assert!(others.iter().all(|&other| other != usual && other != 0));
        let mut again = announcing(0, 2, &[1, 2]);
        again.epoch = 2;
        assert_ne!(again.digest([&peer].into_iter()), usual, "its own restart counts too");
    }

    #[test]
    fn another_plan_of_the_same_round_contradicts() {
        let (one, other) = agreed(&[1, 2], &[5, 6]);
        let contradicts = |peer: Said| one.is_contradicted([&peer].into_iter());
        assert!(!contradicts(said(&other)));
        assert!(!contradicts(changed(&said(&other), |said| said.message.plan = 0)), "it has not agreed yet");
        assert!(contradicts(changed(&said(&other), |said| said.message.plan = one.plan() ^ 1)));
        assert!(contradicts(changed(&said(&other), |said| said.stamp.epoch = 2)), "it has started anew");
        let undecided = announcing(0, 2, &[1, 2]);
        assert!(!undecided.is_contradicted([&said(&other)].into_iter()));
    }

    #[test]
    fn moves_only_with_everybody_in_the_plan_and_waits_for_all_before_its_last_move() {
        let (one, other) = agreed(&[1, 2, 3], &[5, 6, 7]);
        let peer = said(&other);
        assert_eq!(step_of(&one, &peer), Some(Move::Right));
        assert_eq!(step_of(&one, &changed(&peer, |said| said.message.step = 1)), Some(Move::Right));
        assert_eq!(step_of(&one, &changed(&peer, |said| said.message.plan = 0)), None);
        assert_eq!(step_of(&one, &changed(&peer, |said| said.message.plan = peer.message.plan ^ 1)), None);
        assert_eq!(step_of(&one, &changed(&peer, |said| said.message.round = Round(2))), None);
        assert_eq!(
            one.next_move(&corridor(), Paces::EVEN, Cell(1), [].into_iter()),
            None,
            "a teammate is unheard"
        );
        assert_eq!(
            one.next_move(&corridor(), Paces::EVEN, Cell(2), [&peer].into_iter()),
            None,
            "it is off its path"
        );
        assert_eq!(step_of(&announcing(0, 2, &[1, 2, 3]), &peer), None, "it has not agreed");
        let undecided = said(&announcing(1, 2, &[5, 6, 7]));
        assert_eq!(step_of(&announcing(0, 2, &[1, 2, 3]), &undecided), None, "nobody has agreed");

        let ahead = Agreement { step: 1, ..one };
        assert_eq!(step_of(&ahead, &peer), None, "the teammate is a move behind, and this is the last");
        let (farther, other) = agreed(&[1, 2, 3, 4], &[7, 6, 6, 5]);
        let behind = said(&other);
        assert_eq!(
            step_of(&Agreement { step: 1, ..farther.clone() }, &behind),
            Some(Move::Right),
            "its last is yet to come"
        );
        assert_eq!(step_of(&Agreement { step: 2, ..farther }, &behind), None);
        assert_eq!(step_of(&ahead, &changed(&peer, |said| said.message.step = 1)), Some(Move::Right));
        let done = Agreement { step: 2, ..ahead };
        assert_eq!(step_of(&done, &changed(&peer, |said| said.message.step = 2)), None);
        let (one, other) = agreed(&[1, 2, 3], &[5, 6]);
        let arrived = changed(&said(&other), |said| said.message.step = 1);
        assert_eq!(
            step_of(&Agreement { step: 1, ..one }, &arrived),
            Some(Move::Right),
            "it waits for nobody"
        );
    }

    /// A robot's path, a teammate's, how many moves that has done, and what the robot may do.
    type Case = (&'static [u16], &'static [u16], u8, Option<Move>);

    #[test]
    fn enters_a_cell_in_the_order_of_the_plan() {
        let cases: [Case; 12] = [
            (&[1, 2, 2], &[3, 4, 4], 0, Some(Move::Right)),
            (&[1, 2, 2], &[3, 2, 2], 0, None),              // both want it
            (&[1, 2, 2], &[2, 1, 1], 0, None),              // they would swap
            (&[1, 2, 2], &[2, 3, 3], 0, None),              // the other may still be there
            (&[1, 2, 2], &[2, 3, 3], 1, Some(Move::Right)), // it has left
            (&[1, 2, 2], &[2], 0, None),                    // it stays there
            (&[1, 2, 2], &[2, 2, 2], 2, None),              // it has waited there, and stays
            (&[1, 2, 2], &[2, 2, 3], 1, None),              // it is still there when this robot comes
            (&[1, 2, 1], &[4, 3, 2], 1, Some(Move::Right)), // it comes later, and waits until this robot has left
            (&[1, 2, 1], &[2, 3, 2], 0, None),              // it comes back, but has not left yet
            (&[1, 2, 1], &[2, 3, 2], 1, Some(Move::Right)),
            (&[1, 1, 1], &[2, 1, 1], 0, Some(Move::Wait)), // waiting enters nothing
        ];
        for (own, theirs, done, expected) in cases {
            let (one, other) = agreed(own, theirs);
            let peer = changed(&said(&other), |said| said.message.step = done);
            assert_eq!(step_of(&one, &peer), expected, "{own:?} {theirs:?} {done}");
        }
    }

    #[test]
    fn counts_the_moves_that_were_made() {
        let (map, (mut robot, _)) = (corridor(), agreed(&[1, 2, 2, 3], &[6, 7]));
        let mut undecided = announcing(0, 2, &[1, 2, 2, 3]);
        assert!(!undecided.advance(&map, Paces::EVEN, Cell(2), false), "nothing is agreed");
        // Where the robot is, whether it waited, and how many moves are done then.
        let ticks = [(1, false, 0), (1, true, 0), (2, false, 1), (2, false, 1), (2, true, 2), (3, false, 3)];
        for (here, waited, done) in ticks {
            let before = robot.step();
            assert_eq!(robot.advance(&map, Paces::EVEN, Cell(here), waited), done != before);
            assert_eq!(robot.step(), done, "on {here}, waited: {waited}");
            robot.arrive();
            assert_eq!(robot.stage() == Stage::Arrived, done == 3);
        }
        assert!(robot.is_complete() && robot.place(&map) == Cell(3));
        assert!(!robot.advance(&map, Paces::EVEN, Cell(3), true), "there is nothing left");
    }

    #[test]
    fn a_new_round_begins_where_the_robot_stands_and_forgets_the_last() {
        let (mut one, other) = agreed(&[1, 2], &[5, 6]);
        let mut peer = said(&other);
        assert!(!one.join(Cell(1), [&peer].into_iter()), "the same round");
        peer.message.round = Round(3);
        assert!(one.join(Cell(2), [&peer].into_iter()));
        let fresh = Agreement { round: Round(3), ..Agreement::new(RobotId(0), 2, 1, Cell(2)) };
        assert_eq!(one, fresh);
        peer.message.round = Round(2);
        assert!(!one.join(Cell(2), [&peer].into_iter()), "an older round");
        one.open(Cell(4));
        assert_eq!(one, Agreement { round: Round(4), ..Agreement::new(RobotId(0), 2, 1, Cell(4)) });
        one.round = Round(u16::MAX);
        one.open(Cell(5));
        assert_eq!((one.round(), one.path().start), (Round(u16::MAX), Cell(4)), "no numbers are left");
    }
}
