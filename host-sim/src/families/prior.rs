//! Probabilities in hundredths, so that they add up to one exactly as they are written.

use crate::random::Random;
use std::cmp::Reverse;

/// The least probability of a value.
const LEAST: u64 = 3;

/// The probabilities of so many values: [`LEAST`] each, and the rest in proportion to squares of
/// uniform numbers. There are at most 33 values.
pub(super) fn skewed(random: &mut Random, values: usize) -> Vec<u64> {
    let weights: Vec<u64> = (0..values).map(|_| u64::from(random.bits() >> 16).pow(2) + 1).collect();
    let (all, rest) = (weights.iter().sum::<u64>(), 100 - LEAST * values as u64);
    let mut prior: Vec<u64> = weights.iter().map(|weight| LEAST + rest * weight / all).collect();
    // The hundredths that rounding down has left go to the largest remainders.
    let left = 100 - prior.iter().sum::<u64>();
    let mut order: Vec<usize> = (0..values).collect();
    order.sort_by_key(|&value| Reverse(rest * weights[value] % all));
    for &value in &order[..left as usize] {
        prior[value] += 1;
    }
    prior
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn priors_add_up_and_are_skewed() {
        let mut random = Random::new(1);
        let mut likeliest = Vec::new();
        for values in (1..=16).cycle().take(1600) {
            let prior = skewed(&mut random, values);
            assert_eq!((prior.len(), prior.iter().sum::<u64>()), (values, 100));
            assert!(prior.iter().all(|&p| p >= LEAST), "{prior:?}");
            likeliest.extend(prior.iter().max().filter(|_| values == 4));
        }
        // The largest of four squares has a mean share of 0.536 of all: of the 88 hundredths that
        // are left here.
        let mean = likeliest.iter().sum::<u64>() as f64 / likeliest.len() as f64;
        assert!((46.0..54.0).contains(&mean), "{mean}");
    }
}
