//! The teammates as a robot knows them at an instant.

use super::{Freshness, Message, Peer, RobotId, Roster};
use crate::time::{Duration, Instant};

/// The last message of each teammate, and its freshness now.
///
/// ```
/// use iibt_core::team::{Envelope, Freshness, Limits, Member, Message, RobotId, Roster, Stamp};
/// use iibt_core::time::{Duration, Instant};
/// use serde::{Deserialize, Serialize};
///
/// #[derive(Clone, Serialize, Deserialize)]
/// struct Ping(u8);
///
/// impl Message for Ping {
///     const SCHEMA: &'static str = "ping: count u8";
///     const MAX_BYTES: usize = 1;
/// }
///
/// // Robot 0 of a team of two; a frame is due every 100 ms.
/// let limits = Limits::for_beacons(Duration(100))?;
/// let mut roster = Roster::new(Member::new(RobotId(0), 2)?, limits);
/// assert!(!roster.at(Instant(0)).all_connected());
///
/// let stamp = Stamp { epoch: 1, sequence: 0 };
/// roster.hear(Envelope { sender: RobotId(1), stamp, message: Ping(3) }, Instant(10))?;
/// let peers = roster.at(Instant(20));
/// assert!(peers.all_connected());
/// assert_eq!(peers.get(RobotId(1)).map(|peer| peer.message().0), Some(3));
/// assert_eq!(peers.age(RobotId(1)), Some(Duration(10)));
/// assert_eq!(roster.at(Instant(900)).freshness(RobotId(1)), Freshness::Stale);
/// assert!(!roster.at(Instant(900)).all_connected());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias = "neighbours")]
#[doc(alias = "blackboard")]
#[doc(alias = "shared state")]
#[derive(Debug)]
pub struct Peers<'a, M> {
    roster: &'a Roster<M>,
    now: Instant,
}

impl<M> Clone for Peers<'_, M> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<M> Copy for Peers<'_, M> {}

impl<'a, M: Message> Peers<'a, M> {
    pub(super) const fn new(roster: &'a Roster<M>, now: Instant) -> Self {
        Self { roster, now }
    }

    /// The instant.
    #[must_use]
    pub const fn now(self) -> Instant {
        self.now
    }

    /// The robot itself.
    #[must_use]
    pub const fn own(self) -> RobotId {
        self.roster.own()
    }

    /// Whether another robot with the number of this one has been heard; see
    /// [`Roster::has_twin`].
    #[must_use]
    pub const fn has_twin(self) -> bool {
        self.roster.has_twin()
    }

    /// The number of robots in the team, this one included.
    #[must_use]
    pub const fn team(self) -> usize {
        self.roster.team()
    }

    /// The teammates that have ever been heard, in the order of the robots.
    pub fn iter(self) -> impl Iterator<Item = &'a Peer<M>> + Clone {
        self.roster.peers()
    }

    /// A teammate, if it has ever been heard.
    #[must_use]
    pub fn get(self, robot: RobotId) -> Option<&'a Peer<M>> {
        self.roster.peer(robot)
    }

    /// The teammates whose last message is fresh, whether they take part or not.
    pub fn fresh(self) -> impl Iterator<Item = &'a Peer<M>> + Clone {
        let (limits, now) = (self.roster.limits(), self.now);
        self.iter().filter(move |peer| peer.freshness(limits, now) == Freshness::Fresh)
    }

    /// The freshness of a robot's last message; [`Freshness::Unheard`] also for this robot itself
    /// and for robots outside the team.
    #[must_use]
    pub fn freshness(self, robot: RobotId) -> Freshness {
        let limits = self.roster.limits();
        self.get(robot).map_or(Freshness::Unheard, |peer| peer.freshness(limits, self.now))
    }

    /// The time since a teammate was heard, `None` before it was. Exact until the teammate is lost,
    /// then at least [`Limits::lost_after`](super::Limits::lost_after).
    #[must_use]
    pub fn age(self, robot: RobotId) -> Option<Duration> {
        let peer = self.get(robot)?;
        let age = self.now.since(peer.heard());
        Some(if peer.is_lost() { age.max(self.roster.limits().lost_after()) } else { age })
    }

    /// The number of teammates that take part now: fresh, and [taking part](Message::takes_part).
    #[must_use]
    pub fn connected(self) -> usize {
        self.fresh().filter(|peer| peer.message().takes_part()).count()
    }

    /// Whether all N - 1 teammates in a team of N take part now.
    #[must_use]
    pub fn all_connected(self) -> bool {
        self.connected() + 1 == self.team()
    }
}
