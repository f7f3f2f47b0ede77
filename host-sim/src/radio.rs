//! The radio: the only way between robots. It carries bytes and knows nothing of what they mean.

use crate::random::{Random, Stream};
use crate::scenario;
use iibt_core::team::Key;
use serde::Serialize;
use std::iter::Sum;

/// The key of every simulated team that is given no other. It keeps nothing secret.
pub const KEY: Key = Key::new(*b"simulated robots");

/// A broadcast channel: every frame goes to every teammate, and each copy is lost, delayed or
/// doubled by itself.
#[derive(Debug)]
pub(crate) struct RadioChannel {
    terms: scenario::Radio,
    team: usize,
    loss: Random,
    /// Whether each link, from a sender to a receiver, is in its bad state; `None` before its first
    /// frame.
    bad: Vec<Option<bool>>,
    duplicate: Random,
    jitter: Random,
    noise: Random,
    silent: Vec<bool>,
    flying: Vec<Copy>,
    traffic: Vec<Traffic>,
}

/// The traffic of one robot's frames.
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

impl RadioChannel {
    pub(crate) fn new(terms: scenario::Radio, team: usize, seed: u64) -> Self {
        Self {
            terms,
            team,
            loss: Random::of(seed, Stream::Loss),
            bad: vec![None; team * team],
            duplicate: Random::of(seed, Stream::Duplicate),
            jitter: Random::of(seed, Stream::Jitter),
            noise: Random::of(seed, Stream::Noise),
            silent: vec![false; team],
            flying: Vec::new(),
            traffic: vec![Traffic::default(); team],
        }
    }

    /// Turns a robot's transmitter off or on.
    pub(crate) fn silence(&mut self, robot: usize, silent: bool) {
        self.silent[robot] = silent;
    }

    /// Takes a frame that `sender` sends in tick `now`.
    pub(crate) fn send(&mut self, now: u32, sender: usize, frame: &[u8]) {
        if self.silent[sender] {
            return;
        }
        self.traffic[sender].sent += 1;
        for receiver in (0..self.team).filter(|&receiver| receiver != sender) {
            if self.loses(sender, receiver) {
                self.traffic[sender].lost += 1;
                continue;
            }
            let copies = 1 + usize::from(self.duplicate.bernoulli(self.terms.duplicate));
            for _ in 0..copies {
                let due = now + self.terms.delay + self.jitter.below(self.terms.jitter as usize + 1) as u32;
                self.flying.push(Copy { due, sender, receiver, bytes: frame.to_vec() });
            }
        }
    }

    /// Draws whether a link loses its next frame.
    ///
    /// With bursts, a Markov chain with two states (Gilbert 1960): it leaves the bad one with a
    /// probability of one over the mean length, and enters it so often that the share is right.
    fn loses(&mut self, sender: usize, receiver: usize) -> bool {
        let share = self.terms.loss;
        if self.terms.burst == 0 {
            return self.loss.bernoulli(share);
        }
        let link = &mut self.bad[sender * self.team + receiver];
        let length = f64::from(self.terms.burst).max(share / (1.0 - share));
        let is_bad = match *link {
            None => self.loss.bernoulli(share),
            Some(true) => !self.loss.bernoulli(1.0 / length),
            Some(false) => self.loss.bernoulli(share / (1.0 - share) / length),
        };
        *link = Some(is_bad);
        is_bad
    }

    /// Returns what arrives in tick `now`, in the order it was sent, then the noise: receiver and
    /// bytes.
    pub(crate) fn arrivals(&mut self, now: u32) -> Vec<(usize, Vec<u8>)> {
        let due: Vec<Copy> = self.flying.extract_if(.., |copy| copy.due <= now).collect();
        let mut arrivals = Vec::new();
        for copy in due {
            self.traffic[copy.sender].delivered += 1;
            let stray = self.noise.bytes(self.terms.stray).into_iter().map(|byte| byte.max(1));
            arrivals.push((copy.receiver, stray.chain(copy.bytes).collect()));
        }
        if self.terms.garbage > 0 {
            arrivals.extend((0..self.team).map(|robot| (robot, self.noise.bytes(self.terms.garbage))));
        }
        arrivals
    }

    /// The traffic of each robot's frames so far.
    pub(crate) fn traffic(&self) -> &[Traffic] {
        &self.traffic
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn radio(loss: f64, delay: u32, duplicate: f64) -> RadioChannel {
        RadioChannel::new(scenario::Radio { loss, delay, duplicate, ..scenario::Radio::default() }, 3, 1)
    }

    #[test]
    fn a_frame_reaches_every_teammate_after_the_delay() {
        let mut radio = radio(0.0, 3, 0.0);
        radio.send(5, 1, b"hello");
        assert_eq!(radio.arrivals(7), []);
        assert_eq!(radio.arrivals(8), [(0, b"hello".to_vec()), (2, b"hello".to_vec())]);
        assert_eq!(radio.arrivals(9), []);
        assert_eq!(radio.traffic()[1], Traffic { sent: 1, delivered: 2, lost: 0 });
    }

    #[test]
    fn every_copy_is_lost_or_delivered() {
        let mut radio = radio(0.3, 1, 0.0);
        for tick in 0..1000 {
            radio.send(tick, 0, b"x");
        }
        let delivered = radio.arrivals(1000).len() as u32;
        let traffic = radio.traffic()[0];
        assert_eq!(
            (traffic.sent, traffic.delivered, traffic.delivered + traffic.lost),
            (1000, delivered, 2000)
        );
        assert!((540..660).contains(&traffic.lost), "{traffic:?}");
    }

    #[test]
    fn bursts_lose_their_share_in_runs_of_their_length_and_each_link_by_itself() {
        for (loss, burst) in [(0.3, 10), (0.4, 2), (0.1, 3)] {
            let terms = scenario::Radio { loss, burst, ..scenario::Radio::default() };
            let mut radio = RadioChannel::new(terms, 3, 1);
            let lost: Vec<[bool; 2]> = (0..40_000).map(|_| [1, 2].map(|to| radio.loses(0, to))).collect();
            let runs = lost.windows(2).filter(|pair| !pair[0][0] && pair[1][0]).count() as f64;
            let of = |is_lost: fn(&&[bool; 2]) -> bool| lost.iter().filter(is_lost).count() as f64;
            let (one, both) = (of(|lost| lost[0]), of(|lost| lost[0] && lost[1]));
            let share = one / 40_000.0;
            assert!((share - loss).abs() < 0.03, "{share} of {loss}");
            assert!((one / runs / f64::from(burst) - 1.0).abs() < 0.1, "{} of {burst}", one / runs);
            assert!((both / 40_000.0 - loss * loss).abs() < 0.03, "{both}");
        }
        let all = scenario::Radio { loss: 1.0, burst: 5, ..scenario::Radio::default() };
        let mut radio = RadioChannel::new(all, 2, 1);
        assert!((0..100).all(|_| radio.loses(0, 1)));
    }

    #[test]
    fn duplicates_arrive_twice() {
        let mut radio = radio(0.0, 1, 1.0);
        radio.send(0, 0, b"x");
        assert_eq!(radio.arrivals(1).len(), 4);
    }

    #[test]
    fn jitter_delays_every_copy_by_itself_and_a_silent_robot_is_not_heard() {
        let mut radio = RadioChannel::new(scenario::Radio { jitter: 3, ..scenario::Radio::default() }, 2, 1);
        (0..100).for_each(|_| radio.send(0, 0, b"x"));
        let arriving: Vec<_> = (0..6).map(|tick| radio.arrivals(tick).len()).collect();
        assert!(arriving[1..5].iter().all(|&copies| copies > 10), "{arriving:?}");
        assert_eq!((arriving[0], arriving[5], arriving.iter().sum::<usize>()), (0, 0, 100));
        radio.silence(0, true);
        radio.send(6, 0, b"x");
        assert!((7..12).all(|tick| radio.arrivals(tick).is_empty()));
    }

    #[test]
    fn noise_comes_before_frames_without_a_delimiter_and_in_every_tick_with_any_byte() {
        let terms = scenario::Radio { stray: 300, garbage: 500, ..scenario::Radio::default() };
        let mut radio = RadioChannel::new(terms, 2, 1);
        radio.send(0, 0, b"x");
        let arrivals = radio.arrivals(1);
        let (receiver, bytes) = &arrivals[0];
        assert_eq!((*receiver, bytes.len(), bytes.last()), (1, 301, Some(&b'x')));
        assert!(!bytes.contains(&0));
        let noise: Vec<_> = arrivals[1..].iter().map(|(robot, bytes)| (*robot, bytes.len())).collect();
        assert_eq!(noise, [(0, 500), (1, 500)]);
        assert!(arrivals[1..].iter().any(|(_, bytes)| bytes.contains(&0)));
    }
}
