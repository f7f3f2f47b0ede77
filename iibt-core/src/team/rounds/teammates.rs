//! The teammates' newest messages, as the rounds read them.

use super::super::{MAX_TEAM, Message, Peers, RobotId, Stamp};
use super::{Fact, RoundMessage};

/// The newest message of a teammate.
#[derive(Debug)]
pub struct Heard<'a, F: Fact, const K: usize> {
    /// Its number: epoch and sequence.
    pub stamp: Stamp,
    /// What it says of the round.
    pub message: &'a RoundMessage<F, K>,
}

impl<F: Fact, const K: usize> Clone for Heard<'_, F, K> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<F: Fact, const K: usize> Copy for Heard<'_, F, K> {}

/// The newest message of each teammate that was heard, by robot.
///
/// Made from the [`Peers`] of any message that holds a [`RoundMessage`].
#[derive(Debug)]
pub struct Teammates<'a, F: Fact, const K: usize>([Option<Heard<'a, F, K>>; MAX_TEAM]);

impl<F: Fact, const K: usize> Clone for Teammates<'_, F, K> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<F: Fact, const K: usize> Copy for Teammates<'_, F, K> {}

impl<'a, F: Fact, const K: usize> Teammates<'a, F, K> {
    /// The newest message of a robot; `None` if it was not heard.
    #[must_use]
    pub fn get(&self, robot: RobotId) -> Option<Heard<'a, F, K>> {
        *self.0.get(robot.index())?
    }

    /// The robots that were heard, with their messages.
    pub fn iter(&self) -> impl Iterator<Item = (RobotId, Heard<'a, F, K>)> + Clone {
        (0..).map(RobotId).zip(&self.0).filter_map(|(robot, heard)| Some((robot, (*heard)?)))
    }
}

impl<'a, F: Fact, const K: usize> FromIterator<(RobotId, Heard<'a, F, K>)> for Teammates<'a, F, K> {
    fn from_iter<I: IntoIterator<Item = (RobotId, Heard<'a, F, K>)>>(heard: I) -> Self {
        let mut teammates = Self([None; MAX_TEAM]);
        for (robot, heard) in heard {
            if let Some(place) = teammates.0.get_mut(robot.index()) {
                *place = Some(heard);
            }
        }
        teammates
    }
}

impl<'a, M, F: Fact, const K: usize> From<Peers<'a, M>> for Teammates<'a, F, K>
where
    M: Message + AsRef<RoundMessage<F, K>>,
{
    fn from(peers: Peers<'a, M>) -> Self {
        let heard = |envelope: &'a super::super::Envelope<M>| {
            (envelope.sender, Heard { stamp: envelope.stamp, message: envelope.message.as_ref() })
        };
        peers.iter().map(|peer| heard(peer.envelope())).collect()
    }
}
