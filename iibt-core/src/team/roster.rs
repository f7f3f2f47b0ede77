//! The roster: the last message of each teammate, and its age.

use super::frame::{Header, MAX_PLAIN, check, unseal};
use super::{
    Context, Counters, DecodeError, Envelope, FrameAuth, Freshness, Invalid, Limits, MAX_TEAM, Member,
    Message, Peers, RobotId, Stamp,
};
use crate::time::Instant;
use core::cmp::Ordering;

/// The newest message of every teammate of one robot.
///
/// Only what is newer than the newest message of its sender gets in, so the roster is the replay
/// window as well. It keeps what a lost peer said last: forgetting it would let a recording of it
/// in again. [`at`](Self::at) reads it at an instant.
///
/// ```
/// use iibt_core::team::{
///     Envelope, Heard, Limits, Member, Message, Refused, RobotId, Roster, Stamp,
/// };
/// use iibt_core::time::{Duration, Instant};
/// use serde::{Deserialize, Serialize};
///
/// #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
/// struct Ping(u8);
///
/// impl Message for Ping {
///     const SCHEMA: &'static str = "ping: count u8";
///     const MAX_BYTES: usize = 1;
/// }
///
/// let limits = Limits::for_beacons(Duration(100))?;
/// let mut roster = Roster::new(Member::new(RobotId(0), 2)?, limits);
/// let envelope = |sequence, count| {
///     let stamp = Stamp { epoch: 1, sequence };
///     Envelope { sender: RobotId(1), stamp, message: Ping(count) }
/// };
/// assert_eq!(roster.hear(envelope(5, 3), Instant(10)), Ok(Heard::First));
/// assert_eq!(roster.hear(envelope(5, 3), Instant(20)), Err(Refused::Duplicate));
/// assert_eq!(roster.hear(envelope(4, 2), Instant(30)), Err(Refused::Outdated)); // a replay
/// assert_eq!(roster.hear(envelope(6, 4), Instant(40)), Ok(Heard::Update));
/// assert_eq!(roster.peer(RobotId(1)).map(|peer| peer.message().0), Some(4));
/// assert_eq!((roster.counters().accepted, roster.counters().refused()), (2, 2));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias = "neighbour table")]
#[doc(alias = "membership")]
#[derive(Clone, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Roster<M> {
    member: Member,
    limits: Limits,
    /// In the places that `places` gives.
    peers: [Option<Peer<M>>; MAX_TEAM],
    /// The place of each robot; in that of this one the next message is read, so that it is where
    /// it stays once it is accepted.
    places: [u8; MAX_TEAM],
    /// When the lost peers were marked the last time.
    expired: Option<Instant>,
    /// The stamp and the end of the newest frame of this robot.
    sent: Option<(Stamp, [u8; TAIL])>,
    counters: Counters,
}

/// The bytes at the end of a frame that tell it from others: those of its tag.
const TAIL: usize = 8;

/// A teammate that has been heard.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Peer<M> {
    envelope: Envelope<M>,
    heard: Instant,
    /// Set once the peer is lost, so that it does not seem fresh again when the clock has gone half
    /// around.
    lost: bool,
}

/// The place of an accepted message in its sender's order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Heard {
    /// The first message of this peer since this robot started.
    First,
    /// The first message of a newer epoch: the peer has restarted.
    Restart,
    /// A newer message of the same epoch.
    Update,
}

/// The reason why a message was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Refused {
    /// The bytes are not a frame.
    #[error("no frame: {0}")]
    Frame(DecodeError),
    /// An echo: a frame that this robot has sent, or may have sent before it started.
    #[error("from this robot itself")]
    Own,
    /// A frame with the number of this robot that it has not sent: another robot has its number.
    #[error("from another robot with the number of this one")]
    Twin,
    /// The team has no such robot.
    #[error("from a robot outside the team")]
    Unknown,
    /// The robot's task does not accept it.
    #[error("not accepted: {0}")]
    Foreign(Invalid),
    /// The newest message of this peer again.
    #[error("received before")]
    Duplicate,
    /// A message older than the newest of this peer: replayed or overtaken.
    #[error("older than what the robot said before")]
    Outdated,
}

impl<M: Message> Roster<M> {
    /// Creates the roster of a robot that has received nothing.
    #[must_use]
    pub const fn new(member: Member, limits: Limits) -> Self {
        let (peers, places) = ([const { None }; MAX_TEAM], [0, 1, 2, 3, 4, 5, 6, 7]);
        Self { member, limits, peers, places, expired: None, sent: None, counters: Counters::NONE }
    }

    /// Receives a frame, without its delimiters, at an instant; the task may refuse its message.
    ///
    /// Costs one [`decode`](super::decode) and one pass over the roster.
    ///
    /// # Errors
    /// [`Refused`], counted; the peers' messages are as they were.
    pub fn receive(
        &mut self,
        frame: &[u8],
        auth: &impl FrameAuth,
        context: Context,
        now: Instant,
        accepts: impl FnOnce(&M) -> Result<(), Invalid>,
    ) -> Result<Heard, Refused> {
        let mut room = [0; MAX_PLAIN + 1];
        let outcome = match unseal(frame, auth, context, &mut room) {
            Ok((header, content)) => match self.read(&header, content, now, accepts) {
                Err(Refused::Own) if !self.may_have_sent(header.stamp(), frame) => Err(Refused::Twin),
                outcome => outcome,
            },
            Err(error) => Err(Refused::Frame(error)),
        };
        self.counters.count(outcome);
        outcome
    }

    /// Notes a frame that this robot sends, with its delimiters or without:
    /// [`receive`](Self::receive) tells an echo from the frame of another robot with the same
    /// number.
    ///
    /// Frames are noted in the order of their stamps.
    pub fn note_sent(&mut self, stamp: Stamp, frame: &[u8]) {
        self.sent = Some((stamp, tail(frame)));
    }

    /// Whether another robot with the number of this one has been heard since this one started.
    ///
    /// Neither can know which of them the teammates hear.
    #[must_use]
    pub const fn has_twin(&self) -> bool {
        self.counters.twin > 0
    }

    /// Receives a message that needs no check of authenticity.
    ///
    /// # Errors
    /// [`Refused`], counted, for any reason but [`Refused::Frame`] and [`Refused::Foreign`]; the
    /// peers' messages are as they were.
    pub fn hear(&mut self, envelope: Envelope<M>, now: Instant) -> Result<Heard, Refused> {
        let outcome = self.judge(envelope.sender, envelope.stamp, now);
        if outcome.is_ok()
            && let Some(place) = self.place(envelope.sender)
        {
            *place = Some(Peer { envelope, heard: now, lost: false });
        }
        self.counters.count(outcome);
        outcome
    }

    /// Marks the peers that are lost now, so that they stay [`Freshness::Lost`] until heard again.
    ///
    /// Must be called at least every 2^30 ticks (12 days at 1 kHz), or else a clock that has gone
    /// half around makes a lost peer fresh again; every tick is a good time.
    pub fn expire(&mut self, now: Instant) {
        if self.expired.replace(now) == Some(now) {
            return;
        }
        let limits = self.limits;
        for peer in self.peers.iter_mut().flatten() {
            peer.lost = peer.freshness(limits, now) == Freshness::Lost;
        }
    }

    /// The teammates at an instant.
    #[must_use]
    pub const fn at(&self, now: Instant) -> Peers<'_, M> {
        Peers::new(self, now)
    }

    /// The peers that have been heard, in the order of the robots.
    pub fn peers(&self) -> impl Iterator<Item = &Peer<M>> + Clone {
        (0..MAX_TEAM as u8).filter_map(|robot| self.peer(RobotId(robot)))
    }

    /// One peer, if it has been heard.
    #[must_use]
    pub fn peer(&self, robot: RobotId) -> Option<&Peer<M>> {
        if robot == self.own() { None } else { self.stored(robot) }
    }

    /// The robot that owns this roster.
    #[must_use]
    pub const fn own(&self) -> RobotId {
        self.member.robot()
    }

    /// The number of robots in the team, this one included.
    #[must_use]
    pub const fn team(&self) -> usize {
        self.member.team()
    }

    /// The ages at which a peer stops being fresh and is lost.
    #[must_use]
    pub const fn limits(&self) -> Limits {
        self.limits
    }

    /// The counts of everything received so far.
    #[must_use]
    pub const fn counters(&self) -> &Counters {
        &self.counters
    }

    /// Reads the message of an authentic frame as [`decode`](super::decode) does, but straight into
    /// its place: wherever it is handed on by value, a large message is copied.
    fn read(
        &mut self,
        header: &Header,
        content: &[u8],
        now: Instant,
        accepts: impl FnOnce(&M) -> Result<(), Invalid>,
    ) -> Result<Heard, Refused> {
        let (sender, stamp, own) = (header.sender, header.stamp(), self.own());
        let read = match self.place(own) {
            Some(Some(Peer { envelope, .. })) => envelope.message.read_into(content),
            Some(place) => M::read(content).map(|(message, rest)| {
                *place =
                    Some(Peer { envelope: Envelope { sender, stamp, message }, heard: now, lost: false });
                rest
            }),
            None => None,
        };
        let body = || Refused::Frame(DecodeError::Body);
        let (rest, new) = read.zip(self.stored(own)).ok_or_else(body)?;
        check(header, new.message(), rest).map_err(Refused::Frame)?;
        let heard = self.judge(sender, stamp, now)?;
        accepts(self.stored(own).ok_or_else(body)?.message()).map_err(Refused::Foreign)?;
        if let Some(Some(peer)) = self.place(own) {
            (peer.envelope.sender, peer.envelope.stamp) = (sender, stamp);
            (peer.heard, peer.lost) = (now, false);
        }
        if let Ok([own, theirs]) = self.places.get_disjoint_mut([own.index(), sender.index()]) {
            core::mem::swap(own, theirs);
        }
        Ok(heard)
    }

    /// Whether this robot may have sent a frame with its number: not one that is newer than its
    /// newest, nor another one with the same stamp. What it sent in a life before it does not know.
    fn may_have_sent(&self, stamp: Stamp, frame: &[u8]) -> bool {
        self.sent.is_none_or(|(newest, end)| stamp < newest || (stamp == newest && end == tail(frame)))
    }

    /// What is in the place of a robot.
    fn stored(&self, robot: RobotId) -> Option<&Peer<M>> {
        let &place = self.places.get(robot.index())?;
        self.peers.get(usize::from(place))?.as_ref()
    }

    fn place(&mut self, robot: RobotId) -> Option<&mut Option<Peer<M>>> {
        let &place = self.places.get(robot.index())?;
        self.peers.get_mut(usize::from(place))
    }

    /// Whether a message is newer than what is there of its sender, and how.
    fn judge(&mut self, sender: RobotId, stamp: Stamp, now: Instant) -> Result<Heard, Refused> {
        self.expire(now);
        if sender == self.own() {
            return Err(Refused::Own);
        }
        if sender.index() >= self.team() {
            return Err(Refused::Unknown);
        }
        judge(self.stored(sender).map(|peer| peer.envelope.stamp), stamp)
    }
}

/// The end of a frame, without a delimiter.
fn tail(frame: &[u8]) -> [u8; TAIL] {
    let frame = frame.strip_suffix(&[0]).unwrap_or(frame);
    frame.last_chunk().copied().unwrap_or_default()
}

/// The place of a stamp for a receiver whose newest of the same sender is `newest`.
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

impl<M> Peer<M> {
    /// Its newest message with sender and number.
    #[must_use]
    pub const fn envelope(&self) -> &Envelope<M> {
        &self.envelope
    }

    /// The teammate.
    #[must_use]
    pub const fn sender(&self) -> RobotId {
        self.envelope.sender
    }

    /// Its newest message.
    #[must_use]
    pub const fn message(&self) -> &M {
        &self.envelope.message
    }

    /// The instant at which that was received, on this robot's clock.
    #[must_use]
    pub const fn heard(&self) -> Instant {
        self.heard
    }

    /// Whether it has been lost since it was heard.
    pub(super) const fn is_lost(&self) -> bool {
        self.lost
    }

    pub(super) fn freshness(&self, limits: Limits, now: Instant) -> Freshness {
        if self.lost { Freshness::Lost } else { limits.freshness(now.since(self.heard)) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::team::{Key, MAX_FRAME, SipHash64, encode};
    use crate::time::Duration;
    use serde::{Deserialize, Serialize};
    use std::vec::Vec;

    /// Whether a robot takes part.
    #[derive(Clone, Debug, Serialize, Deserialize)]
    struct Here(bool);

    impl Message for Here {
        const SCHEMA: &'static str = "here: bool";
        const MAX_BYTES: usize = 1;

        fn takes_part(&self) -> bool {
            self.0
        }
    }

    const LIMITS: Limits = match Limits::new(Duration(10), Duration(20)) {
        Ok(limits) => limits,
        Err(_) => panic!(),
    };

    /// The roster of robot 0 in a team of `team`.
    fn roster(team: usize) -> Roster<Here> {
        Roster::new(Member::new(RobotId(0), team).unwrap(), LIMITS)
    }

    fn said(robot: u8, epoch: u32, sequence: u32, takes_part: bool) -> Envelope<Here> {
        Envelope { sender: RobotId(robot), stamp: Stamp { epoch, sequence }, message: Here(takes_part) }
    }

    fn by(robot: u8, sequence: u32) -> Envelope<Here> {
        said(robot, 1, sequence, true)
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
            let outcome = roster.hear(said(1, epoch, sequence, true), Instant(0));
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
    fn tells_an_echo_from_another_robot_with_its_number() {
        let (auth, context) = (SipHash64::new(Key::new([7; 16])), Context::of::<Here>(0, 0));
        let mut roster = roster(3);
        let mut room = [[0; MAX_FRAME]; 5];
        let sent = [(2, 6, true), (2, 7, true), (2, 7, false), (2, 8, true), (3, 0, true)];
        let frame = |(said, room): (&Envelope<Here>, &mut [u8; MAX_FRAME])| {
            encode(said, &auth, context, room).unwrap().to_vec()
        };
        let said = sent.map(|(epoch, sequence, takes_part)| said(0, epoch, sequence, takes_part));
        let frames: Vec<Vec<u8>> = said.iter().zip(&mut room).map(frame).collect();
        let heard = |roster: &mut Roster<Here>, frame: usize| {
            let bytes = frames[frame].strip_prefix(&[0]).and_then(|frame| frame.strip_suffix(&[0])).unwrap();
            roster.receive(bytes, &auth, context, Instant(0), |_| Ok(())).unwrap_err()
        };
        assert_eq!(heard(&mut roster, 4), Refused::Own, "from before it sends: it cannot tell");
        (0..2).for_each(|frame| roster.note_sent(said[frame].stamp, &frames[frame]));
        assert_eq!([0, 1].map(|frame| heard(&mut roster, frame)), [Refused::Own; 2]);
        assert!(!roster.has_twin());
        assert_eq!([2, 3, 4].map(|frame| heard(&mut roster, frame)), [Refused::Twin; 3]);
        assert!(roster.has_twin() && roster.counters().twin == 3);
    }

    #[test]
    fn keeps_the_newest_message_and_its_time() {
        let mut roster = roster(3);
        roster.hear(by(2, 1), Instant(5)).unwrap();
        roster.hear(by(1, 4), Instant(6)).unwrap();
        roster.hear(by(2, 2), Instant(7)).unwrap();
        roster.hear(by(2, 1), Instant(8)).unwrap_err();
        let kept: Vec<_> = roster
            .peers()
            .map(|peer| (peer.sender().0, peer.envelope().stamp.sequence, peer.heard().0))
            .collect();
        assert_eq!(kept, [(1, 4, 6), (2, 2, 7)]);
    }

    #[test]
    fn ages_from_fresh_over_stale_to_lost_even_across_the_wrap() {
        for start in [0, 1000, u32::MAX - 15, u32::MAX] {
            let heard = Instant(start);
            let mut roster = roster(2);
            assert_eq!(roster.at(heard).freshness(RobotId(1)), Freshness::Unheard);
            assert_eq!(roster.at(heard).age(RobotId(1)), None);
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
                assert_eq!(roster.at(now).freshness(RobotId(1)), expected, "{age} ticks after {start}");
                assert_eq!(roster.at(now).age(RobotId(1)), Some(Duration(age)));
            }
        }
    }

    #[test]
    fn who_is_lost_stays_lost_until_heard() {
        let mut roster = roster(3);
        roster.hear(by(1, 1), Instant(0)).unwrap();
        roster.expire(Instant(20));
        assert_eq!(roster.at(Instant(20)).freshness(RobotId(1)), Freshness::Stale);
        roster.expire(Instant(21));
        let much_later = Instant(u32::MAX - 3);
        assert_eq!(roster.at(much_later).freshness(RobotId(1)), Freshness::Lost);
        assert_eq!(roster.at(much_later).age(RobotId(1)), Some(Duration(20)));
        assert_eq!(roster.at(much_later).connected(), 0);

        roster.hear(by(1, 1), much_later).unwrap_err();
        assert_eq!(roster.at(much_later).freshness(RobotId(1)), Freshness::Lost, "by a replay");
        roster.hear(by(1, 2), much_later).unwrap();
        assert_eq!(roster.at(much_later).freshness(RobotId(1)), Freshness::Fresh);
    }

    #[test]
    fn hearing_one_peer_writes_off_the_others() {
        let mut roster = roster(3);
        roster.hear(by(1, 1), Instant(0)).unwrap();
        roster.hear(by(2, 1), Instant(21)).unwrap();
        assert_eq!(roster.at(Instant(1 << 31).after(Duration(1))).freshness(RobotId(1)), Freshness::Lost);
    }

    #[test]
    fn connected_are_the_fresh_who_are_not_away() {
        let mut roster = roster(4);
        roster.hear(by(1, 1), Instant(0)).unwrap();
        roster.hear(by(2, 1), Instant(5)).unwrap();
        assert_eq!(roster.at(Instant(5)).connected(), 2);
        assert!(!roster.at(Instant(5)).all_connected(), "one is unheard");

        roster.hear(by(3, 1), Instant(6)).unwrap();
        assert!(roster.at(Instant(10)).all_connected());
        assert_eq!(roster.at(Instant(11)).connected(), 2, "one is stale");
        assert!(!roster.at(Instant(11)).all_connected());

        roster.hear(said(1, 1, 2, false), Instant(11)).unwrap();
        assert_eq!(roster.at(Instant(11)).connected(), 2, "one is away");
        assert_eq!(roster.at(Instant(11)).fresh().count(), 3);
        roster.hear(said(1, 1, 3, true), Instant(12)).unwrap();
        assert!(roster.at(Instant(12)).all_connected());
    }

    #[test]
    fn a_team_of_one_is_always_connected() {
        assert!(roster(1).at(Instant(0)).all_connected());
    }

    #[test]
    fn what_the_task_does_not_accept_changes_nothing() {
        let auth = SipHash64::new(Key::new([7; 16]));
        let context = Context::of::<Here>(0, 0);
        let mut roster = roster(2);
        let mut buffer = [0; MAX_FRAME];
        let frame = encode(&by(1, 1), &auth, context, &mut buffer).unwrap();
        let frame = &frame[1..frame.len() - 1];
        let refusal = Invalid("of another kind");
        let refused = roster.receive(frame, &auth, context, Instant(0), |_| Err(refusal));
        assert_eq!(refused, Err(Refused::Foreign(refusal)));
        assert_eq!((roster.counters().foreign, roster.peers().count()), (1, 0));
        assert_eq!(roster.receive(frame, &auth, context, Instant(0), |_| Ok(())), Ok(Heard::First));
        let other = Context::of::<Here>(0, 1);
        let refused = roster.receive(frame, &auth, other, Instant(0), |_| Ok(()));
        assert_eq!(refused, Err(Refused::Frame(DecodeError::Tag)), "another mission");
    }
    /// Frames are read in the place of another message, those that are refused too.
    #[test]
    fn a_frame_is_kept_as_its_message_is_and_a_refused_one_leaves_no_trace() {
        let auth = crate::team::SipHash64::new(crate::team::Key::new([7; 16]));
        let context = Context::of::<Here>(0, 0);
        let (mut by_frames, mut by_messages) = (roster(4), roster(4));
        let mut random = 1_u32;
        let mut draw = |below: u32| {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (random >> 16) % below
        };
        for tick in 0..2000 {
            let (robot, epoch, sequence) = (draw(5) as u8, draw(2) + tick / 300, draw(40) + tick / 30);
            let message = said(robot, epoch, sequence, draw(2) == 1);
            let mut buffer = [0; crate::team::MAX_FRAME];
            let frame = crate::team::encode(&message, &auth, context, &mut buffer).unwrap();
            let is_accepted = draw(4) > 0;
            let accepts = |_: &Here| if is_accepted { Ok(()) } else { Err(Invalid("not now")) };
            let inside = &frame[1..frame.len() - 1];
            let received = by_frames.receive(inside, &auth, context, Instant(tick), accepts);
            if is_accepted {
                assert_eq!(received, by_messages.hear(message, Instant(tick)), "tick {tick}");
            } else {
                by_messages.expire(Instant(tick));
                assert!(received.is_err());
            }
            let kept = |roster: &Roster<Here>| std::format!("{:?}", roster.peers().collect::<Vec<_>>());
            assert_eq!(kept(&by_frames), kept(&by_messages), "tick {tick}");
        }
        assert!(by_frames.counters().accepted > 100);
    }
}
