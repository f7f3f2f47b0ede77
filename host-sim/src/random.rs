//! The generator of random numbers: every draw of a simulation, from one seed.

use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

/// The purpose of a draw, which has a stream of its own. Each purpose has a stream of its own, so
/// that more draws of one kind leave the others as they were.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u64)]
pub(crate) enum Stream {
    /// Whether a frame is lost.
    Loss = 1,
    /// Whether a frame arrives twice.
    Duplicate = 2,
    /// The reading of a localiser.
    Localiser = 3,
    /// Whether a worn drive makes a move.
    DriveFault = 4,
    /// Whether a move fails.
    Slip = 5,
    /// The disturbances that a campaign adds to a mission.
    Disturbance = 6,
    /// The starts and goals of missions that are drawn.
    Place = 7,
    /// Whether a robot is served at its goal.
    Service = 8,
    /// The delay of a frame.
    Jitter = 9,
    /// The garbage bytes on the link.
    Noise = 10,
    /// The faults of a flight with [`Faults`](crate::Faults).
    Fault = 11,
    /// The maps, starts and goals of random missions.
    Mission = 12,
    /// Random missions with something unknown.
    Family = 13,
    /// The readings of a robot that works on a table task.
    Reading = 16,
    /// Whether an action of such a robot fails.
    Action = 17,
    /// The hidden states at the start.
    Start = 18,
    /// The values of the unknowns of a mission.
    Unknown = 19,
    /// What robots read of them.
    Sight = 20,
    /// The ways of strangers.
    Stranger = 21,
}

/// A generator of random numbers (PCG-32): the same seed draws the same numbers on every machine.
///
/// ```
/// let (mut one, mut other) = (host_sim::Random::new(7), host_sim::Random::new(7));
/// assert_eq!(one.bits(), other.bits());
/// assert!(one.below(6) < 6 && !one.bernoulli(0.0) && one.bernoulli(1.0));
/// ```
#[derive(Clone, Debug)]
pub struct Random(Pcg32);

impl Random {
    /// The numbers of a seed.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self(Pcg32::new(seed, 0))
    }

    pub(crate) fn of(seed: u64, stream: Stream) -> Self {
        Self(Pcg32::new(seed, stream as u64))
    }

    /// The next 32 bits.
    pub fn bits(&mut self) -> u32 {
        self.0.next_u32()
    }

    /// True with `probability`.
    pub fn bernoulli(&mut self, probability: f64) -> bool {
        f64::from(self.bits()) < probability * 4_294_967_296.0
    }

    /// A number below `count`, of which 2³² are told apart; zero when `count` is.
    pub fn below(&mut self, count: usize) -> usize {
        ((u64::from(self.bits()) * count as u64) >> 32) as usize
    }

    /// The next `count` bytes.
    pub fn bytes(&mut self, count: usize) -> Vec<u8> {
        (0..count).map(|_| self.bits() as u8).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn draws(seed: u64, stream: Stream) -> Vec<usize> {
        let mut random = Random::of(seed, stream);
        (0..32).map(|_| random.below(1000)).collect()
    }

    #[test]
    fn a_seed_repeats_and_a_stream_is_apart() {
        assert_eq!(draws(7, Stream::Loss), draws(7, Stream::Loss));
        assert_ne!(draws(7, Stream::Loss), draws(8, Stream::Loss));
        assert_ne!(draws(7, Stream::Loss), draws(7, Stream::Duplicate));
    }

    #[test]
    fn is_true_as_often_as_asked() {
        for (probability, least, most) in [(0.0, 0, 0), (0.3, 2_800, 3_200), (1.0, 10_000, 10_000)] {
            let mut random = Random::new(1);
            let count = (0..10_000).filter(|_| random.bernoulli(probability)).count();
            assert!((least..=most).contains(&count), "{probability}: {count}");
        }
    }

    #[test]
    fn draws_stay_below_the_count() {
        let mut random = Random::new(1);
        assert!((0..1000).all(|_| random.below(7) < 7));
        assert_eq!(random.below(0), 0);
    }
}
