//! What a policy is expected to take where something unknown may be seen on the way: one level of
//! branching.

use super::costs::Eighths;

/// What is known of a policy before it is begun: until when it runs as it is, what can be seen
/// then, and what the rest takes in each of `H` worlds.
///
/// One way to go on is chosen when the reading is known, so a policy by which something is seen is
/// worth more than the same without its reading. That difference is the policy's epistemic value,
/// in ticks. It is zero where every reading leads on in the same way: information that changes
/// nothing is worth nothing.
///
/// ```
/// use iibt_core::inference::{ExpectedTime, Outlook};
///
/// // Two goals, 10 ticks apart, of which one serves. A sign two ticks away tells which, rightly in
/// // nine of ten cases; from there both goals are 5 ticks away.
/// let belief = [0.5, 0.5];
/// let readings = &[[0.9, 0.1], [0.1, 0.9]];
/// let sign = Outlook { until: 16, readings, ways: &[[40, 120], [120, 40]] };
/// let expected = sign.expected(&belief);
/// // The reading saves 80 - (0.9 x 40 + 0.1 x 120).
/// assert_eq!(expected, ExpectedTime { pragmatic: 16 + 80, epistemic: 32 });
/// assert_eq!(expected.total(), 64);
///
/// // A sign that lies as often as not is worth nothing.
/// let broken = Outlook { readings: &[[0.5; 2]; 2], ..sign };
/// assert_eq!(broken.expected(&belief), ExpectedTime { pragmatic: 96, epistemic: 0 });
/// ```
#[doc(alias = "expected value of sample information")]
#[doc(alias = "sophisticated inference")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outlook<'a, const H: usize> {
    /// The time until something is seen, or until the policy is done, in eighths of a tick.
    pub until: Eighths,
    /// P(reading | world) for each reading that may come then: each column sums to one. Without
    /// readings nothing is seen.
    pub readings: &'a [[f32; H]],
    /// The time from then on in each world, for each way to go on; without ways the policy ends
    /// there.
    pub ways: &'a [[Eighths; H]],
}

/// The expected time of a policy, in eighths of a tick, in two terms.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ExpectedTime {
    /// What it takes if what is seen changes nothing: the pragmatic value with its sign changed.
    pub pragmatic: Eighths,
    /// What it takes less because the way to go on follows what is seen: the epistemic value, at
    /// most the pragmatic term.
    pub epistemic: Eighths,
}

impl ExpectedTime {
    /// The expected time.
    #[must_use]
    pub const fn total(self) -> Eighths {
        self.pragmatic.saturating_sub(self.epistemic)
    }
}

impl<const H: usize> Outlook<'_, H> {
    /// The expected time under a belief over the worlds.
    ///
    /// Costs a multiplication for each reading, way and world. Times are rounded to the nearest
    /// eighth. Worlds without a probability count as impossible.
    #[must_use]
    pub fn expected(&self, belief: &[f32]) -> ExpectedTime {
        let blind = self.best(belief, None);
        let seeing: f32 = self.readings.iter().map(|reading| self.best(belief, Some(reading))).sum();
        let seeing = if self.readings.is_empty() { blind } else { seeing };
        // A cast saturates.
        let whole = |time: f32| (time + 0.5) as Eighths;
        let pragmatic = self.until.saturating_add(whole(blind));
        let epistemic = whole(blind).saturating_sub(whole(seeing));
        ExpectedTime { pragmatic, epistemic }
    }

    /// The expected time of the best way on, times the probability of the reading.
    fn best(&self, belief: &[f32], reading: Option<&[f32; H]>) -> f32 {
        let likelihood =
            |world: usize| reading.map_or(1.0, |reading| reading.get(world).copied().unwrap_or(0.0));
        let expected = |way: &[Eighths; H]| {
            let terms = belief.iter().zip(way).enumerate();
            terms.map(|(world, (p, &time))| p * likelihood(world) * f32::from(time)).sum::<f32>()
        };
        let best = self.ways.iter().map(expected).fold(f32::INFINITY, f32::min);
        if self.ways.is_empty() { 0.0 } else { best }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Random outlooks against the definition: the mean over worlds and readings of the way that is
    /// best once the reading is known.
    #[test]
    fn the_expected_time_is_that_of_the_best_way_after_each_reading() {
        let mut random = 1_u32;
        let mut draw = |below: u32| {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (random >> 8) % below
        };
        let mut branching = 0;
        for _ in 0..2000 {
            let mut belief = [0.0; 3].map(|_: f32| draw(100) as f32 + 1.0);
            let sum: f32 = belief.iter().sum();
            belief.iter_mut().for_each(|p| *p /= sum);
            let right = belief.map(|_| draw(101) as f32 / 100.0);
            let readings = [right, right.map(|p| 1.0 - p)];
            let ways = [[0; 3]; 3].map(|way| way.map(|_: u16| draw(400) as u16));
            let expected = Outlook { until: 24, readings: &readings, ways: &ways }.expected(&belief);
            let mean = |way: &[u16; 3], weights: [f32; 3]| -> f32 {
                way.iter().zip(weights).map(|(&time, p)| f32::from(time) * p).sum()
            };
            let best = |weights| ways.iter().map(|way| mean(way, weights)).fold(f32::INFINITY, f32::min);
            let after =
                |reading: [f32; 3]| best(core::array::from_fn(|world| belief[world] * reading[world]));
            let (blind, seeing) = (best(belief), after(readings[0]) + after(readings[1]));
            assert!((f32::from(expected.pragmatic) - 24.0 - blind).abs() < 0.51);
            assert!((f32::from(expected.total()) - 24.0 - seeing).abs() < 1.01);
            branching += usize::from(expected.epistemic > 0);
        }
        assert!((500..2000).contains(&branching), "{branching}");
    }

    #[test]
    fn nothing_seen_or_nothing_left_is_worth_nothing() {
        let ways = [[8, 80], [80, 8]];
        let nothing = Outlook { until: 5, readings: &[], ways: &ways }.expected(&[0.5, 0.5]);
        assert_eq!(nothing, ExpectedTime { pragmatic: 49, epistemic: 0 });
        let done = Outlook::<2> { until: 5, readings: &[[1.0, 0.0], [0.0, 1.0]], ways: &[] };
        assert_eq!(done.expected(&[0.5, 0.5]), ExpectedTime { pragmatic: 5, epistemic: 0 });
        let most = Outlook { until: u16::MAX, readings: &[], ways: &[[u16::MAX; 2]] };
        assert_eq!(most.expected(&[0.5, 0.5]).total(), u16::MAX);
    }
}
