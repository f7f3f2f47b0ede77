//! The radio: the only way between robots. It carries bytes and knows nothing of what they mean.

use crate::chance::{Chance, Purpose};
use crate::scenario;
use iibt_core::team::Key;
use serde::Serialize;
use std::collections::VecDeque;
use std::iter::Sum;

/// The key of every team. It keeps nothing secret: the radio is simulated.
pub(crate) const KEY: Key = Key::new(*b"simulated robots");

/// Every frame goes to every teammate, each copy with its own luck.
#[derive(Debug)]
pub(crate) struct Radio {
    terms: scenario::Radio,
    team: usize,
    loss: Chance,
    duplicate: Chance,
    flying: VecDeque<Copy>,
    traffic: Vec<Traffic>,
}

/// What became of one robot's frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Traffic {
    /// The frames it has sent.
    pub sent: u32,
    /// The copies of them that reached a teammate, duplicates included.
    pub delivered: u32,
    /// The copies that were lost on the way; a frame has one for every teammate.
    pub lost: u32,
}

impl<'t> Sum<&'t Self> for Traffic {
    fn sum<I: Iterator<Item = &'t Self>>(parts: I) -> Self {
        parts.fold(Self::default(), |sum, part| Self {
            sent: sum.sent + part.sent,
            delivered: sum.delivered + part.delivered,
            lost: sum.lost + part.lost,
        })
    }
}

#[derive(Debug)]
struct Copy {
    due: u32,
    sender: usize,
    receiver: usize,
    bytes: Vec<u8>,
}

impl Radio {
    pub(crate) fn new(terms: scenario::Radio, team: usize, seed: u64) -> Self {
        Self {
            terms,
            team,
            loss: Chance::new(seed, Purpose::Loss),
            duplicate: Chance::new(seed, Purpose::Duplicate),
            flying: VecDeque::new(),
            traffic: vec![Traffic::default(); team],
        }
    }

    /// Takes a frame that `sender` sends in tick `now`.
    pub(crate) fn send(&mut self, now: u32, sender: usize, frame: &[u8]) {
        self.traffic[sender].sent += 1;
        for receiver in (0..self.team).filter(|&receiver| receiver != sender) {
            if self.loss.strikes(self.terms.loss) {
                self.traffic[sender].lost += 1;
                continue;
            }
            let copies = 1 + usize::from(self.duplicate.strikes(self.terms.duplicate));
            for _ in 0..copies {
                let due = now + self.terms.delay;
                self.flying.push_back(Copy { due, sender, receiver, bytes: frame.to_vec() });
            }
        }
    }

    /// Hands out what arrives in tick `now`, oldest first, as the receiver and the bytes.
    pub(crate) fn arrivals(&mut self, now: u32) -> impl Iterator<Item = (usize, Vec<u8>)> + '_ {
        std::iter::from_fn(move || {
            let copy = self.flying.pop_front_if(|copy| copy.due <= now)?;
            self.traffic[copy.sender].delivered += 1;
            Some((copy.receiver, copy.bytes))
        })
    }

    /// What became of each robot's frames so far.
    pub(crate) fn traffic(&self) -> &[Traffic] {
        &self.traffic
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn radio(loss: f64, delay: u32, duplicate: f64) -> Radio {
        Radio::new(scenario::Radio { loss, delay, duplicate }, 3, 1)
    }

    fn arriving(radio: &mut Radio, now: u32) -> Vec<(usize, Vec<u8>)> {
        radio.arrivals(now).collect()
    }

    #[test]
    fn a_frame_reaches_every_teammate_after_the_delay() {
        let mut radio = radio(0.0, 3, 0.0);
        radio.send(5, 1, b"hello");
        assert_eq!(arriving(&mut radio, 7), []);
        assert_eq!(arriving(&mut radio, 8), [(0, b"hello".to_vec()), (2, b"hello".to_vec())]);
        assert_eq!(arriving(&mut radio, 9), []);
        assert_eq!(radio.traffic()[1], Traffic { sent: 1, delivered: 2, lost: 0 });
    }

    #[test]
    fn every_copy_is_lost_or_delivered() {
        let mut radio = radio(0.3, 1, 0.0);
        for tick in 0..1000 {
            radio.send(tick, 0, b"x");
        }
        let delivered = arriving(&mut radio, 1000).len() as u32;
        let traffic = radio.traffic()[0];
        assert_eq!(
            (traffic.sent, traffic.delivered, traffic.delivered + traffic.lost),
            (1000, delivered, 2000)
        );
        assert!((540..660).contains(&traffic.lost), "{traffic:?}");
    }

    #[test]
    fn duplicates_arrive_twice() {
        let mut radio = radio(0.0, 1, 1.0);
        radio.send(0, 0, b"x");
        assert_eq!(arriving(&mut radio, 1).len(), 4);
    }
}
