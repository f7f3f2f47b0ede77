//! Chance: every random draw of a flight, from one seed.

use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

/// What draws are for. Each purpose has a stream of its own, so that more draws of one kind leave the others
/// as they were.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u64)]
pub(crate) enum Purpose {
    /// Whether a frame is lost.
    Loss = 1,
    /// Whether a frame arrives twice.
    Duplicate = 2,
    /// What a localiser reads.
    Localiser = 3,
    /// Whether a worn drive makes a move.
    Wear = 4,
    /// Whether a move fails.
    Slip = 5,
    /// What trouble a campaign adds to a mission.
    Disturbance = 6,
    /// Where robots start and where they are wanted, in missions that are drawn.
    Place = 7,
    /// Whether a robot is served at its goal.
    Service = 8,
    /// What a robot that handles things reads of its state.
    Reading = 16,
    /// Whether an action of such a robot fails.
    Deed = 17,
    /// The hidden states at the start.
    Start = 18,
}

/// A stream of draws.
#[derive(Clone, Debug)]
pub(crate) struct Chance(Pcg32);

impl Chance {
    pub(crate) fn new(seed: u64, purpose: Purpose) -> Self {
        Self(Pcg32::new(seed, purpose as u64))
    }

    /// True with `probability`.
    pub(crate) fn strikes(&mut self, probability: f64) -> bool {
        f64::from(self.0.next_u32()) < probability * 4_294_967_296.0
    }

    /// A number below `count`, or zero.
    pub(crate) fn below(&mut self, count: u16) -> u16 {
        ((u64::from(self.0.next_u32()) * u64::from(count)) >> 32) as u16
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn draws(seed: u64, purpose: Purpose) -> Vec<u16> {
        let mut chance = Chance::new(seed, purpose);
        (0..32).map(|_| chance.below(1000)).collect()
    }

    #[test]
    fn a_seed_repeats_and_a_purpose_is_apart() {
        assert_eq!(draws(7, Purpose::Loss), draws(7, Purpose::Loss));
        assert_ne!(draws(7, Purpose::Loss), draws(8, Purpose::Loss));
        assert_ne!(draws(7, Purpose::Loss), draws(7, Purpose::Duplicate));
    }

    #[test]
    fn strikes_as_often_as_asked() {
        for (probability, least, most) in [(0.0, 0, 0), (0.3, 2_800, 3_200), (1.0, 10_000, 10_000)] {
            let mut chance = Chance::new(1, Purpose::Loss);
            let struck = (0..10_000).filter(|_| chance.strikes(probability)).count();
            assert!((least..=most).contains(&struck), "{probability}: {struck}");
        }
    }

    #[test]
    fn draws_stay_below_the_count() {
        let mut chance = Chance::new(1, Purpose::Localiser);
        assert!((0..1000).all(|_| chance.below(7) < 7));
        assert_eq!(chance.below(0), 0);
    }
}
