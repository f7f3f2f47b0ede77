//! The roster: what each teammate said last, and how long ago.

use super::{
    Counters, DecodeError, FrameAuth, Freshness, Intention, Limits, MAX_TEAM, RobotId, Stamp, Status, decode,
};
use crate::time::{Duration, Instant};
use core::cmp::Ordering;

/// The newest intention of every teammate of one robot.
///
/// Only what is newer than the newest intention of its sender gets in, so the roster is the replay window as
/// well. It keeps what a lost peer said last: forgetting it would let a recording of it in again.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Roster {
    own: RobotId,
    team: u8,
    limits: Limits,
    peers: [Option<Peer>; MAX_TEAM],
    counters: Counters,
}

/// A teammate that has been heard.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Peer {
    intention: Intention,
    heard: Instant,
    /// Set once the peer is lost, so that it does not seem fresh again when the clock has gone half around.
    lost: bool,
}

/// What an accepted intention is to the roster.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Heard {
    /// The first of this peer since this robot started.
    First,
    /// The first of a newer epoch: the peer has started again.
    Restart,
    /// A newer one of the same epoch.
    Update,
}

/// Why an intention was not taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Refused {
    /// It was no frame.
    Frame(DecodeError),
    /// It claims to come from this very robot: an echo, or two robots with the same number.
    Own,
    /// The team has no such robot.
    Unknown,
    /// The newest one of this peer once more.
    Duplicate,
    /// Older than the newest one of this peer: replayed or overtaken.
    Outdated,
}

/// Why there is no such roster.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum RosterError {
    /// The team is larger than [`MAX_TEAM`].
    TeamTooLarge,
    /// The robot's number is not below the size of its team.
    NotInTeam,
}

impl Roster {
    /// The roster of robot `own` in a team of `team` robots, itself included, before it has heard anyone.
    ///
    /// # Errors
    /// [`RosterError`] when the team is too large or the robot not in it.
    pub const fn new(own: RobotId, team: usize, limits: Limits) -> Result<Self, RosterError> {
        if team > MAX_TEAM {
            return Err(RosterError::TeamTooLarge);
        }
        if own.index() >= team {
            return Err(RosterError::NotInTeam);
        }
        Ok(Self {
            own,
            team: team as u8,
            limits,
            peers: [const { None }; MAX_TEAM],
            counters: Counters::NONE,
        })
    }

    /// Takes in a frame, without its delimiter, that was received now. Costs one [`decode`] and one pass
    /// over the roster.
    ///
    /// # Errors
    /// [`Refused`], counted; the peers' intentions are as they were.
    pub fn receive(&mut self, frame: &[u8], auth: &impl FrameAuth, now: Instant) -> Result<Heard, Refused> {
        let outcome = match decode(frame, auth) {
            Ok(intention) => self.admit(intention, now),
            Err(error) => Err(Refused::Frame(error)),
        };
        self.counters.count(outcome);
        outcome
    }

    /// Takes in an intention that was received now and needs no check of authenticity.
    ///
    /// # Errors
    /// [`Refused`], counted, for any reason but [`Refused::Frame`]; the peers' intentions are as they were.
    pub fn hear(&mut self, intention: Intention, now: Instant) -> Result<Heard, Refused> {
        let outcome = self.admit(intention, now);
        self.counters.count(outcome);
        outcome
    }

    /// Writes off who is lost now, so that they stay [`Freshness::Lost`] until heard again. Must be called at
    /// least every 2^30 ticks (12 days at 1 kHz), or else a clock that has gone half around makes a lost peer
    /// fresh again; every tick is a good time.
    pub fn expire(&mut self, now: Instant) {
        let limits = self.limits;
        for peer in self.peers.iter_mut().flatten() {
            peer.lost = peer.freshness(limits, now) == Freshness::Lost;
        }
    }

    /// How far a robot's last intention can be relied on; [`Freshness::Unheard`] also for this robot itself
    /// and for robots outside the team.
    #[must_use]
    pub fn freshness(&self, robot: RobotId, now: Instant) -> Freshness {
        self.peer(robot).map_or(Freshness::Unheard, |peer| peer.freshness(self.limits, now))
    }

    /// The time since a peer was heard, `None` before it was. Exact until the peer is lost, then at least
    /// `lost_after`.
    #[must_use]
    pub fn age(&self, robot: RobotId, now: Instant) -> Option<Duration> {
        let peer = self.peer(robot)?;
        let age = now.since(peer.heard);
        Some(if peer.lost { age.max(self.limits.lost_after()) } else { age })
    }

    /// How many peers take part now: fresh, and not [`Status::Away`].
    #[must_use]
    pub fn connected(&self, now: Instant) -> usize {
        self.fresh(now).filter(|intention| intention.status != Status::Away).count()
    }

    /// Whether all the N-1 peers of a team of N take part now.
    #[must_use]
    pub fn all_connected(&self, now: Instant) -> bool {
        self.connected(now) + 1 == self.team()
    }

    /// The fresh intentions, whatever their status, in the order of the robots.
    pub fn fresh(&self, now: Instant) -> impl Iterator<Item = &Intention> {
        let is_fresh = move |peer: &&Peer| peer.freshness(self.limits, now) == Freshness::Fresh;
        self.peers().filter(is_fresh).map(Peer::intention)
    }

    /// The peers that have been heard, in the order of the robots.
    pub fn peers(&self) -> impl Iterator<Item = &Peer> + Clone {
        self.peers.iter().flatten()
    }

    /// One peer, if it has been heard.
    #[must_use]
    pub fn peer(&self, robot: RobotId) -> Option<&Peer> {
        self.peers.get(robot.index())?.as_ref()
    }

    /// Whose roster this is.
    #[must_use]
    pub const fn own(&self) -> RobotId {
        self.own
    }

    /// The number of robots in the team, this one included.
    #[must_use]
    pub const fn team(&self) -> usize {
        self.team as usize
    }

    /// What became of everything received so far.
    #[must_use]
    pub const fn counters(&self) -> &Counters {
        &self.counters
    }

    fn admit(&mut self, intention: Intention, now: Instant) -> Result<Heard, Refused> {
        self.expire(now);
        if intention.robot == self.own {
            return Err(Refused::Own);
        }
        if intention.robot.index() >= self.team() {
            return Err(Refused::Unknown);
        }
        let place = self.peers.get_mut(intention.robot.index()).ok_or(Refused::Unknown)?;
        let heard = judge(place.as_ref().map(|peer| peer.intention.stamp()), intention.stamp())?;
        *place = Some(Peer { intention, heard: now, lost: false });
        Ok(heard)
    }
}

/// What a stamp is to a receiver whose newest of the same sender is `newest`.
fn judge(newest: Option<Stamp>, stamp: Stamp) -> Result<Heard, Refused> {
    let Some(newest) = newest else {
        return Ok(Heard::First);
    };
    match stamp.cmp(&newest) {
        Ordering::Less => Err(Refused::Outdated),
        Ordering::Equal => Err(Refused::Duplicate),
        Ordering::Greater if stamp.epoch > newest.epoch => Ok(Heard::Restart),
        Ordering::Greater => Ok(Heard::Update),
    }
}

impl Peer {
    /// The newest thing it said.
    #[must_use]
    pub const fn intention(&self) -> &Intention {
        &self.intention
    }

    /// When that was heard, on this robot's clock.
    #[must_use]
    pub const fn heard(&self) -> Instant {
        self.heard
    }

    fn freshness(&self, limits: Limits, now: Instant) -> Freshness {
        if self.lost { Freshness::Lost } else { limits.freshness(now.since(self.heard)) }
    }
}

impl core::fmt::Display for Refused {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Frame(error) => write!(f, "no frame: {error}"),
            Self::Own => f.write_str("from this robot itself"),
            Self::Unknown => f.write_str("from a robot outside the team"),
            Self::Duplicate => f.write_str("received before"),
            Self::Outdated => f.write_str("older than what the robot said before"),
        }
    }
}

impl core::fmt::Display for RosterError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::TeamTooLarge => write!(f, "a team has at most {MAX_TEAM} robots"),
            Self::NotInTeam => f.write_str("the robot's number is not below the size of its team"),
        }
    }
}

impl core::error::Error for Refused {}
impl core::error::Error for RosterError {}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{Cell, Path};
    use crate::team::Round;
    use std::vec::Vec;

    const LIMITS: Limits = match Limits::new(Duration(10), Duration(20)) {
        Ok(limits) => limits,
        Err(_) => panic!(),
    };

    /// The roster of robot 0 in a team of `team`.
    fn roster(team: usize) -> Roster {
        Roster::new(RobotId(0), team, LIMITS).unwrap()
    }

    fn said(robot: u8, epoch: u32, sequence: u32, status: Status) -> Intention {
        Intention {
            robot: RobotId(robot),
            epoch,
            sequence,
            tick: Instant(0),
            round: Round(0),
            status,
            plan: 0,
            goal: None,
            path: Path::at(Cell(0)),
            step: 0,
            probability: 1.0,
            hazards: heapless::Vec::new(),
        }
    }

    fn by(robot: u8, sequence: u32) -> Intention {
        said(robot, 1, sequence, Status::Announced)
    }

    #[test]
    fn takes_only_what_is_newer() {
        let mut roster = roster(2);
        let heard = [
            ((1, 5), Ok(Heard::First)),
            ((1, 5), Err(Refused::Duplicate)),
            ((1, 4), Err(Refused::Outdated)),
            ((1, 6), Ok(Heard::Update)),
            ((1, 900), Ok(Heard::Update)),
            ((3, 0), Ok(Heard::Restart)),
            ((3, 0), Err(Refused::Duplicate)),
            ((1, 901), Err(Refused::Outdated)),
            ((2, u32::MAX), Err(Refused::Outdated)),
            ((3, u32::MAX), Ok(Heard::Update)),
            ((3, 0), Err(Refused::Outdated)),
            ((4, 0), Ok(Heard::Restart)),
            ((u32::MAX, u32::MAX), Ok(Heard::Restart)),
            ((0, 0), Err(Refused::Outdated)),
        ];
        for ((epoch, sequence), expected) in heard {
            let outcome = roster.hear(said(1, epoch, sequence, Status::Announced), Instant(0));
            assert_eq!(outcome, expected, "epoch {epoch} sequence {sequence}");
        }
        assert_eq!((roster.counters().accepted, roster.counters().refused()), (7, 7));
    }

    #[test]
    fn peers_do_not_share_a_replay_window() {
        let mut roster = roster(3);
        assert_eq!(roster.hear(by(1, 9), Instant(0)), Ok(Heard::First));
        assert_eq!(roster.hear(by(2, 3), Instant(0)), Ok(Heard::First));
        assert_eq!(roster.hear(by(1, 3), Instant(0)), Err(Refused::Outdated));
    }

    #[test]
    fn refuses_itself_and_strangers() {
        let mut roster = roster(3);
        assert_eq!(roster.hear(by(0, 1), Instant(0)), Err(Refused::Own));
        for stranger in [3, 7, 8, 255] {
            assert_eq!(roster.hear(by(stranger, 1), Instant(0)), Err(Refused::Unknown), "robot {stranger}");
        }
        assert_eq!(roster.peers().count(), 0);
    }

    #[test]
    fn keeps_the_newest_intention_and_its_time() {
        let mut roster = roster(3);
        roster.hear(by(2, 1), Instant(5)).unwrap();
        roster.hear(by(1, 4), Instant(6)).unwrap();
        roster.hear(by(2, 2), Instant(7)).unwrap();
        roster.hear(by(2, 1), Instant(8)).unwrap_err();
        let kept: Vec<_> = roster
            .peers()
            .map(|peer| (peer.intention().robot.0, peer.intention().sequence, peer.heard().0))
            .collect();
        assert_eq!(kept, [(1, 4, 6), (2, 2, 7)]);
    }

    #[test]
    fn ages_from_fresh_over_stale_to_lost_even_across_the_wrap() {
        for start in [0, 1000, u32::MAX - 15, u32::MAX] {
            let heard = Instant(start);
            let mut roster = roster(2);
            assert_eq!(roster.freshness(RobotId(1), heard), Freshness::Unheard);
            assert_eq!(roster.age(RobotId(1), heard), None);
            roster.hear(by(1, 1), heard).unwrap();
            for (age, expected) in [
                (0, Freshness::Fresh),
                (10, Freshness::Fresh),
                (11, Freshness::Stale),
                (20, Freshness::Stale),
                (21, Freshness::Lost),
                (1 << 30, Freshness::Lost),
            ] {
                let now = heard.after(Duration(age));
                assert_eq!(roster.freshness(RobotId(1), now), expected, "{age} ticks after {start}");
                assert_eq!(roster.age(RobotId(1), now), Some(Duration(age)));
            }
        }
    }

    #[test]
    fn who_is_lost_stays_lost_until_heard() {
        let mut roster = roster(3);
        roster.hear(by(1, 1), Instant(0)).unwrap();
        roster.expire(Instant(20));
        assert_eq!(roster.freshness(RobotId(1), Instant(20)), Freshness::Stale);
        roster.expire(Instant(21));
        let much_later = Instant(u32::MAX - 3);
        assert_eq!(roster.freshness(RobotId(1), much_later), Freshness::Lost);
        assert_eq!(roster.age(RobotId(1), much_later), Some(Duration(20)));
        assert_eq!(roster.connected(much_later), 0);

        roster.hear(by(1, 1), much_later).unwrap_err();
        assert_eq!(roster.freshness(RobotId(1), much_later), Freshness::Lost, "by a replay");
        roster.hear(by(1, 2), much_later).unwrap();
        assert_eq!(roster.freshness(RobotId(1), much_later), Freshness::Fresh);
    }

    #[test]
    fn hearing_one_peer_writes_off_the_others() {
        let mut roster = roster(3);
        roster.hear(by(1, 1), Instant(0)).unwrap();
        roster.hear(by(2, 1), Instant(21)).unwrap();
        assert_eq!(roster.freshness(RobotId(1), Instant(1 << 31).after(Duration(1))), Freshness::Lost);
    }

    #[test]
    fn connected_are_the_fresh_who_are_not_away() {
        let mut roster = roster(4);
        roster.hear(by(1, 1), Instant(0)).unwrap();
        roster.hear(by(2, 1), Instant(5)).unwrap();
        assert_eq!(roster.connected(Instant(5)), 2);
        assert!(!roster.all_connected(Instant(5)), "one is unheard");

        roster.hear(by(3, 1), Instant(6)).unwrap();
        assert!(roster.all_connected(Instant(10)));
        assert_eq!(roster.connected(Instant(11)), 2, "one is stale");
        assert!(!roster.all_connected(Instant(11)));

        roster.hear(said(1, 1, 2, Status::Away), Instant(11)).unwrap();
        assert_eq!(roster.connected(Instant(11)), 2, "one is away");
        assert_eq!(roster.fresh(Instant(11)).count(), 3);
        roster.hear(said(1, 1, 3, Status::Deciding), Instant(12)).unwrap();
        assert!(roster.all_connected(Instant(12)));
    }

    #[test]
    fn a_team_of_one_is_always_connected() {
        assert!(roster(1).all_connected(Instant(0)));
    }

    #[test]
    fn refuses_an_impossible_team() {
        let error = |own, team| Roster::new(RobotId(own), team, LIMITS).err();
        assert_eq!(error(0, MAX_TEAM), None);
        assert_eq!(error(0, MAX_TEAM + 1), Some(RosterError::TeamTooLarge));
        assert_eq!(error(2, 2), Some(RosterError::NotInTeam));
        assert_eq!(error(0, 0), Some(RosterError::NotInTeam));
    }
}
