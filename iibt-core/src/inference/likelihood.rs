//! A, the likelihood P(o | s), in the forms that sensors have.

use crate::math;

/// How likely each of `O` outcomes is in each of `S` states.
///
/// The methods beyond [`probability`](Self::probability) have defaults that work for any form and cost
/// `O * S`; a form with structure replaces them.
pub trait Likelihood<const S: usize, const O: usize> {
    /// P(o = `outcome` | s = `state`); zero outside the table.
    fn probability(&self, outcome: usize, state: usize) -> f32;

    /// The predicted outcomes q(o) = Σ_s A(o, s) q(s).
    fn predict(&self, belief: &[f32; S]) -> [f32; O] {
        core::array::from_fn(|outcome| {
            belief.iter().enumerate().map(|(state, q)| self.probability(outcome, state) * q).sum()
        })
    }

    /// Multiplies every entry of `belief` with the likelihood of `outcome`: Bayes' rule without its sum.
    fn weigh(&self, outcome: usize, belief: &mut [f32; S]) {
        for (state, q) in belief.iter_mut().enumerate() {
            *q *= self.probability(outcome, state);
        }
    }

    /// The ambiguity Σ_s q(s) H[A(·, s)], in nats.
    fn ambiguity(&self, belief: &[f32; S]) -> f32 {
        let column = |state| -> f32 {
            -(0..O).map(|outcome| math::p_ln_p(self.probability(outcome, state))).sum::<f32>()
        };
        belief.iter().enumerate().map(|(state, q)| q * column(state)).sum()
    }
}

/// A full table, `O` rows of `S` columns; every column is a distribution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dense<const S: usize, const O: usize>([[f32; S]; O]);

impl<const S: usize, const O: usize> Dense<S, O> {
    /// A table, checked.
    ///
    /// # Panics
    /// When there are no states or outcomes, or a column is no distribution. In a `const` or `static` this
    /// fails the build:
    ///
    /// ```compile_fail,E0080
    /// use iibt_core::inference::likelihood::Dense;
    /// const A: Dense<2, 2> = Dense::new([[0.97, 0.2], [0.0, 0.8]]);
    /// # let _ = A;
    /// ```
    #[must_use]
    pub const fn new(table: [[f32; S]; O]) -> Self {
        assert!(S > 0, "A, the likelihood, has no states");
        assert!(O > 0, "A, the likelihood, has no outcomes");
        let mut state = 0;
        while state < S {
            let mut column = [0.0; O];
            let mut outcome = 0;
            while outcome < O {
                column[outcome] = table[outcome][state];
                outcome += 1;
            }
            assert!(math::is_distribution(&column), "a column of A, the likelihood, is no distribution");
            state += 1;
        }
        Self(table)
    }
}

impl<const S: usize, const O: usize> Likelihood<S, O> for Dense<S, O> {
    fn probability(&self, outcome: usize, state: usize) -> f32 {
        self.0.get(outcome).and_then(|row| row.get(state)).copied().unwrap_or(0.0)
    }
}

/// A sensor that reads the state itself, and errs evenly: A = off + (correct - off) I.
///
/// Three numbers whatever the number of states, and every method costs `S` at the most. The noise is spread over
/// the first `states` states; the others, which a table of fixed size may have left over, read themselves.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct IdentityNoise<const S: usize> {
    correct: f32,
    off: f32,
    states: usize,
}

impl<const S: usize> IdentityNoise<S> {
    /// A sensor that is right with probability `correct`; each other reading has an equal share of the rest.
    ///
    /// # Panics
    /// When there are fewer than two states or `correct` is no probability; in a `const` this fails the build.
    #[must_use]
    pub const fn new(correct: f32) -> Self {
        assert!(S > 1, "A, the likelihood of an identity with noise, needs two states");
        assert!(correct >= 0.0 && correct <= 1.0, "A, the likelihood: `correct` is no probability");
        Self::among(correct, S)
    }

    /// The same with numbers that are only known at run time: `correct` is held to 0..=1, where NaN is a sensor
    /// that knows nothing, and `states` to 2..=S.
    #[must_use]
    pub const fn among(correct: f32, states: usize) -> Self {
        const { assert!(S > 1, "A, the likelihood of an identity with noise, needs two states") }
        let states = if states > S { S } else { states };
        let states = if states < 2 { 2 } else { states };
        let correct = if correct.is_nan() { 1.0 / states as f32 } else { correct.clamp(0.0, 1.0) };
        Self { correct, off: (1.0 - correct) / (states - 1) as f32, states }
    }

    /// The probability of the right reading.
    #[must_use]
    pub const fn correct(&self) -> f32 {
        self.correct
    }

    /// The probability of each single wrong reading.
    #[must_use]
    pub const fn off(&self) -> f32 {
        self.off
    }

    /// The entropy of every column with noise.
    fn column_entropy(&self) -> f32 {
        -math::p_ln_p(self.correct) - (self.states - 1) as f32 * math::p_ln_p(self.off)
    }
}

impl<const S: usize> Likelihood<S, S> for IdentityNoise<S> {
    fn probability(&self, outcome: usize, state: usize) -> f32 {
        let noisy = outcome < self.states && state < self.states;
        match outcome == state {
            _ if outcome >= S || state >= S => 0.0,
            true => {
                if noisy {
                    self.correct
                } else {
                    1.0
                }
            }
            false => {
                if noisy {
                    self.off
                } else {
                    0.0
                }
            }
        }
    }

    fn predict(&self, belief: &[f32; S]) -> [f32; S] {
        let background = self.off * belief.iter().take(self.states).sum::<f32>();
        let signal = self.correct - self.off;
        let mut outcomes = *belief;
        for q in outcomes.iter_mut().take(self.states) {
            *q = background + signal * *q;
        }
        outcomes
    }

    fn weigh(&self, outcome: usize, belief: &mut [f32; S]) {
        let right = belief.get(outcome).map(|q| q * self.probability(outcome, outcome));
        let wrong = if outcome < self.states { self.off } else { 0.0 };
        let (noisy, exact) = belief.split_at_mut_checked(self.states).unwrap_or_default();
        noisy.iter_mut().for_each(|q| *q *= wrong);
        exact.fill(0.0);
        if let (Some(q), Some(right)) = (belief.get_mut(outcome), right) {
            *q = right;
        }
    }

    fn ambiguity(&self, belief: &[f32; S]) -> f32 {
        self.column_entropy() * belief.iter().take(self.states).sum::<f32>()
    }
}

/// An outcome of two robots together that their states determine, by way of `L` labels: A(o | s1, s2) is one
/// where `o` is the outcome of the two states' labels.
///
/// One byte per state and one per pair of labels, instead of a table of `K * S * S` probabilities. Label
/// masses are summed once per belief, so a pair costs `L * L`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OutcomeTable<const S: usize, const L: usize, const K: usize> {
    labels: [u8; S],
    outcomes: [[u8; L]; L],
}

impl<const S: usize, const L: usize, const K: usize> OutcomeTable<S, L, K> {
    /// A table from the label of each state and the outcome of each pair of labels.
    ///
    /// # Panics
    /// When there are no states, labels or outcomes, a label is not below `L`, or an outcome not below `K`;
    /// in a `const` this fails the build.
    #[must_use]
    pub const fn new(labels: [u8; S], outcomes: [[u8; L]; L]) -> Self {
        assert!(S > 0, "an outcome table has no states");
        assert!(L > 0, "an outcome table has no labels");
        assert!(K > 0, "an outcome table has no outcomes");
        let mut state = 0;
        while state < S {
            assert!((labels[state] as usize) < L, "an outcome table's label is out of range");
            state += 1;
        }
        let mut pair = 0;
        while pair < L * L {
            assert!(
                (outcomes[pair / L][pair % L] as usize) < K,
                "an outcome table's outcome is out of range"
            );
            pair += 1;
        }
        Self { labels, outcomes }
    }

    /// A table worked out per state and per pair of labels; a label or outcome out of range counts as zero.
    #[must_use]
    pub fn from_fn(label: impl Fn(usize) -> usize, outcome: impl Fn(usize, usize) -> usize) -> Self {
        let within = |value: usize, limit: usize| if value < limit { value as u8 } else { 0 };
        Self {
            labels: core::array::from_fn(|state| within(label(state), L)),
            outcomes: core::array::from_fn(|first| {
                core::array::from_fn(|second| within(outcome(first, second), K))
            }),
        }
    }

    /// The outcome of two states; outcome zero outside the table.
    #[must_use]
    pub fn outcome(&self, first: usize, second: usize) -> usize {
        self.outcome_of_labels(self.label(first), self.label(second))
    }

    /// The label of a state; label zero outside the table.
    #[must_use]
    pub fn label(&self, state: usize) -> usize {
        usize::from(self.labels.get(state).copied().unwrap_or(0))
    }

    /// The mass that a belief gives each label. Costs `S`.
    #[must_use]
    pub fn label_masses(&self, belief: &[f32; S]) -> [f32; L] {
        let mut masses = [0.0; L];
        for (&label, q) in self.labels.iter().zip(belief) {
            if let Some(mass) = masses.get_mut(usize::from(label)) {
                *mass += q;
            }
        }
        masses
    }

    /// The predicted outcomes of two robots from their label masses. Costs `L * L`.
    #[must_use]
    pub fn predict(&self, first: &[f32; L], second: &[f32; L]) -> [f32; K] {
        let mut outcomes = [0.0; K];
        for (row, p) in self.outcomes.iter().zip(first) {
            for (&outcome, q) in row.iter().zip(second) {
                if let Some(mass) = outcomes.get_mut(usize::from(outcome)) {
                    *mass += p * q;
                }
            }
        }
        outcomes
    }

    /// For each label of the first robot, the probability of `outcome` when the second robot's label masses
    /// are `second`: the message from the second robot and the outcome to the first. Costs `L * L`.
    #[must_use]
    pub fn message(&self, outcome: usize, second: &[f32; L]) -> [f32; L] {
        core::array::from_fn(|first| {
            let matches = |(label, _): &(usize, &f32)| self.outcome_of_labels(first, *label) == outcome;
            second.iter().enumerate().filter(matches).map(|(_, mass)| mass).sum()
        })
    }

    /// The same table seen from the second robot.
    #[must_use]
    pub fn transposed(&self) -> Self {
        let outcomes = core::array::from_fn(|second| {
            core::array::from_fn(|first| self.outcome_of_labels(first, second) as u8)
        });
        Self { labels: self.labels, outcomes }
    }

    fn outcome_of_labels(&self, first: usize, second: usize) -> usize {
        self.outcomes.get(first).and_then(|row| row.get(second)).copied().map_or(0, usize::from)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOISE: IdentityNoise<4> = IdentityNoise::new(0.7);
    const TABLE: Dense<4, 4> =
        Dense::new([[0.7, 0.1, 0.1, 0.1], [0.1, 0.7, 0.1, 0.1], [0.1, 0.1, 0.7, 0.1], [0.1, 0.1, 0.1, 0.7]]);
    const BELIEF: [f32; 4] = [0.1, 0.2, 0.3, 0.4];

    fn close(a: f32, b: f32) -> bool {
        (a - b).abs() < 1e-6
    }

    /// Every method of the structured form against the table.
    fn assert_same(structured: &IdentityNoise<4>, dense: &Dense<4, 4>) {
        let pairs = structured.predict(&BELIEF).into_iter().zip(dense.predict(&BELIEF));
        assert!(pairs.into_iter().all(|(a, b)| close(a, b)));
        assert!(close(structured.ambiguity(&BELIEF), dense.ambiguity(&BELIEF)));
        for outcome in 0..6 {
            let (mut ours, mut theirs) = (BELIEF, BELIEF);
            structured.weigh(outcome, &mut ours);
            dense.weigh(outcome, &mut theirs);
            assert!(ours.iter().zip(theirs).all(|(&a, b)| close(a, b)), "outcome {outcome}");
        }
    }

    #[test]
    fn an_identity_with_noise_equals_its_table() {
        assert_same(&NOISE, &TABLE);
    }

    #[test]
    fn a_sensor_known_at_run_time_is_held_to_the_range() {
        let cases = [(0.7, 0.7), (1.5, 1.0), (-1.0, 0.0), (f32::NAN, 0.25), (f32::INFINITY, 1.0)];
        for (given, expected) in cases {
            assert_eq!(IdentityNoise::<4>::among(given, 4), IdentityNoise::new(expected), "{given}");
        }
        assert_eq!(IdentityNoise::<4>::among(0.7, 99), NOISE);
        assert_eq!(IdentityNoise::<4>::among(0.7, 0), IdentityNoise::among(0.7, 2));
    }

    #[test]
    fn states_left_over_take_no_noise() {
        let few = IdentityNoise::<4>::among(0.7, 3);
        let table = Dense::<4, 4>::new([
            [0.7, 0.15, 0.15, 0.0],
            [0.15, 0.7, 0.15, 0.0],
            [0.15, 0.15, 0.7, 0.0],
            [0.0, 0.0, 0.0, 1.0],
        ]);
        assert_same(&few, &table);
    }

    #[test]
    fn the_outcome_table_is_a_sum_over_pairs_of_states() {
        const MEET: OutcomeTable<4, 3, 3> =
            OutcomeTable::new([0, 1, 0, 2], [[0, 2, 2], [2, 2, 1], [2, 1, 2]]);
        let labels = [0, 1, 0, 2];
        let outcome = |first: usize, second: usize| [[0, 2, 2], [2, 2, 1], [2, 1, 2]][first][second];
        assert_eq!(OutcomeTable::from_fn(|state| labels[state], outcome), MEET);

        let other = [0.4, 0.3, 0.2, 0.1];
        let mut expected = [0.0; 3];
        for (first, p) in BELIEF.iter().enumerate() {
            for (second, q) in other.iter().enumerate() {
                expected[MEET.outcome(first, second)] += p * q;
            }
        }
        let predicted = MEET.predict(&MEET.label_masses(&BELIEF), &MEET.label_masses(&other));
        assert!(predicted.iter().zip(expected).all(|(&a, b)| close(a, b)));
        for (outcome, &total) in expected.iter().enumerate() {
            let message = MEET.message(outcome, &MEET.label_masses(&other));
            let weighed: f32 = BELIEF.iter().enumerate().map(|(s, p)| p * message[MEET.label(s)]).sum();
            assert!(close(weighed, total));
        }
    }
}
