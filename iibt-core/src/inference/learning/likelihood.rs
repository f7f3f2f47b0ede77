//! A, learned: the actual accuracy of a sensor.

use super::columns::Columns;
use super::origin::Origin;
use super::{Dirichlet, Rates, fit, observed};
use crate::inference::likelihood::{Likelihood, TableError};
use crate::inference::{Evidence, Shape, Terms};
use crate::math::{self, Prediction};

/// Dirichlet counts of A, the likelihood of one modality with `O` outcomes, whose conditions have
/// `C` combinations of states. They are a likelihood themselves, with the expected probabilities,
/// so that a model can hold them.
///
/// Memory: 4 `O C` + 12 `C` bytes; the prior stays where it is. The entropy and the novelty of a
/// column are worked out when it is learned, so a prediction costs one multiplication for each
/// entry, and novelty one for each column.
///
/// A model borrows its tables. It is a few slices, so it is built for each decision, and the counts
/// learn in between:
///
/// ```
/// use iibt_core::inference::learning::{LikelihoodCounts, Rates};
/// use iibt_core::inference::{
///     Beliefs, Evidence, Factor, IdentityNoise, Likelihood, Modality, Model, NextState,
/// };
///
/// static MOTION: NextState = NextState::new(&[0, 1], 2);
/// static PRINTED: IdentityNoise = IdentityNoise::new(0.9, 2);
///
/// // What the data sheet says counts as ten observations.
/// let mut sensor =
///     LikelihoodCounts::<2, 2>::new(&PRINTED, 10.0, PRINTED.shape(), Rates::DEFAULT)?;
/// for _ in 0..20 {
///     let beliefs = {
///         let factors = [Factor::new(&MOTION, MOTION.shape(), &[1.0, 0.0])];
///         let modalities = [Modality::new(&sensor, sensor.shape(), &[0], &[0.0, 1.0])];
///         let model = Model::try_new(&factors, &modalities).expect("it fits");
///         let mut beliefs = Beliefs::<2, 1>::prior(&model);
///         beliefs.update(&model, &[Evidence::Outcome(1)]).expect("it is possible");
///         beliefs
///     };
///     // The robot knows where it is, and the sensor says otherwise.
///     assert!(sensor.learn(Evidence::Outcome(1), &[beliefs.as_flat()]));
/// }
/// assert!(sensor.probability(1, &[0]) > 0.6);
/// # Ok::<(), iibt_core::inference::TableError>(())
/// ```
#[derive(Clone)]
pub struct LikelihoodCounts<'a, const O: usize, const C: usize> {
    columns: Columns<O, C>,
    origin: Origin<'a, dyn Likelihood + 'a>,
    shape: Shape,
    rates: Rates,
}

impl<'a, const O: usize, const C: usize> LikelihoodCounts<'a, O, C> {
    /// Begins with a table, each column of which counts as `concentration` observations: held to
    /// [`LEAST`](super::LEAST)..=[`MOST`](super::MOST), and one for NaN. A column of the table
    /// without a positive number begins with one count, shared out evenly.
    ///
    /// # Errors
    /// [`TableError::Length`] when `shape`, the table's, has not `O` values and `C` columns.
    pub fn new(
        prior: &'a (dyn Likelihood + 'a),
        concentration: f32,
        shape: Shape,
        rates: Rates,
    ) -> Result<Self, TableError> {
        Self::from_origin(Origin::table(prior, concentration), shape, rates)
    }

    /// Begins with these counts: a row per outcome, in each row a column per combination of states,
    /// the last condition's states running fastest.
    ///
    /// # Errors
    /// [`TableError::Length`] as for [`new`](Self::new) and when there are not as many counts,
    /// [`TableError::Entry`] with the place of a count that is negative, NaN or above
    /// [`MOST`](super::MOST), and [`TableError::Column`] for one without counts.
    pub fn from_counts(prior: &'a [f32], shape: Shape, rates: Rates) -> Result<Self, TableError> {
        Self::from_origin(Origin::counts(prior, &shape, 1)?, shape, rates)
    }

    fn from_origin(
        origin: Origin<'a, dyn Likelihood + 'a>,
        shape: Shape,
        rates: Rates,
    ) -> Result<Self, TableError> {
        if shape.values() != O || shape.columns() != Some(C) {
            return Err(TableError::Length(O.saturating_mul(C)));
        }
        let columns = Columns::new(&shape, |at, states| prior_column::<O, C>(&origin, at, states));
        Ok(Self { columns, origin, shape, rates })
    }

    /// Learns from an observation, under the beliefs about the conditions in the order of the
    /// shape, best those *after* the observation: a(o, s) := a(o, s) + η q(o | s) Π q(s).
    ///
    /// Of an outcome that was seen, q(o | s) is one. A soft observation weighs the outcomes that
    /// are expected in each state, q(o | s) ∝ w(o) A(o, s): its weights are what the reading says
    /// about the outcome, and not a share of outcomes, so equal weights leave the expected table as
    /// it is. (Adding w(o) itself, as is usual, would add the reader's noise to the sensor's.)
    /// Where A rules out all that it speaks for, q(o | s) = w(o): an entry with count zero is
    /// learned only when it is seen where it was held impossible, while SPM never learns it.
    ///
    /// Returns `false`, and learns nothing, when the observation is missing or makes no sense, or
    /// the beliefs are no distributions over the conditions. Costs a visit of each column with
    /// belief; of all where there is forgetting.
    pub fn learn(&mut self, evidence: Evidence, beliefs: &[&[f32]]) -> bool {
        let Some(weights) = observed(evidence).filter(|_| fit(&self.shape, beliefs)) else { return false };
        let masses = Columns::<O, C>::masses(beliefs);
        let origin = &self.origin;
        self.columns.learn(
            &self.shape,
            self.rates,
            &masses,
            |at, states| prior_column::<O, C>(origin, at, states),
            |column| weighed(column, &weights),
        );
        true
    }

    /// The counts of one combination of states; `None` outside the table.
    #[must_use]
    pub fn counts(&self, states: &[usize]) -> Option<&Dirichlet<O>> {
        self.shape.column(states).and_then(|at| self.columns.get(at))
    }

    /// Its shape.
    #[must_use]
    pub const fn shape(&self) -> Shape {
        self.shape
    }

    /// Forgets everything learned.
    pub fn reset(&mut self) {
        let origin = &self.origin;
        self.columns = Columns::new(&self.shape, |at, states| prior_column::<O, C>(origin, at, states));
    }
}

fn prior_column<const O: usize, const C: usize>(
    origin: &Origin<dyn Likelihood + '_>,
    at: usize,
    states: &[usize],
) -> Dirichlet<O> {
    origin.column::<O, C>(0, at, |table, outcome| table.probability(outcome, states))
}

/// The outcomes expected in a column, weighed with what a reading says of each.
fn weighed<const O: usize>(column: &Dirichlet<O>, weights: &[f32; O]) -> [f32; O] {
    let mut outcomes = column.expected();
    outcomes.iter_mut().zip(weights).for_each(|(p, weight)| *p *= weight);
    math::normalise(&mut outcomes).map_or(*weights, |_| outcomes)
}

impl<const O: usize, const C: usize> Likelihood for LikelihoodCounts<'_, O, C> {
    fn probability(&self, outcome: usize, states: &[usize]) -> f32 {
        self.counts(states).map_or(0.0, |column| column.probability(outcome))
    }

    fn expect(&self, _: &Shape, beliefs: &[&[f32]], preference: &[f32]) -> Terms {
        let masses = Columns::<O, C>::masses(beliefs);
        let prediction = Prediction::of(&self.columns.predict(&masses), preference, |p| p);
        let terms = Terms::of(&prediction, self.columns.ambiguity(&masses));
        Terms { novelty: self.columns.novelty(&masses), ..terms }
    }

    /// Σ_s q(s) I(o; θ_A(s)), each state's exactly, see [`Dirichlet::novelty`].
    fn novelty(&self, _: &Shape, beliefs: &[&[f32]]) -> f32 {
        self.columns.novelty(&Columns::<O, C>::masses(beliefs))
    }
}

impl<const O: usize, const C: usize> core::fmt::Debug for LikelihoodCounts<'_, O, C> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("LikelihoodCounts").field("shape", &self.shape).field("rates", &self.rates).finish()
    }
}

#[cfg(test)]
mod tests {
    use super::super::sampling::{Dice, one};
    use super::*;
    use crate::inference::IdentityNoise;
    use crate::inference::likelihood::DenseLikelihood;
    use std::vec::Vec;

    fn flat<'a>() -> LikelihoodCounts<'a, 3, 4> {
        let shape = Shape::new(3, &[2, 2]).unwrap();
        LikelihoodCounts::from_counts(&[0.5; 12], shape, Rates::DEFAULT).unwrap()
    }

    fn error(counts: &LikelihoodCounts<3, 4>, truth: &[[f32; 3]; 4]) -> f32 {
        let mut worst = 0.0_f32;
        counts.shape().for_each_column(|column, states| {
            for (outcome, p) in truth[column].iter().enumerate() {
                worst = worst.max((counts.probability(outcome, states) - p).abs());
            }
        });
        worst
    }

    /// Draws states and outcomes, and learns from them.
    fn teach(counts: &mut LikelihoodCounts<3, 4>, truth: &[[f32; 3]; 4], times: usize, dice: &mut Dice) {
        for _ in 0..times {
            let (first, second) = (dice.below(2), dice.below(2));
            let outcome = dice.draw(&truth[2 * first + second]);
            assert!(counts.learn(Evidence::Outcome(outcome), &[&one::<2>(first), &one::<2>(second)]));
        }
    }

    const TRUTH: [[f32; 3]; 4] = [[0.7, 0.2, 0.1], [0.1, 0.8, 0.1], [0.3, 0.3, 0.4], [0.0, 0.0, 1.0]];

    #[test]
    fn counts_come_to_the_table_that_outcomes_are_drawn_from() {
        let mut counts = flat();
        teach(&mut counts, &TRUTH, 16_000, &mut Dice::new(11));
        // 4,000 a column: three standard errors of a fair coin.
        assert!(error(&counts, &TRUTH) < 0.024, "{}", error(&counts, &TRUTH));
    }

    #[test]
    fn forgetting_follows_a_sensor_that_changes() {
        let changed = [TRUTH[1], TRUTH[0], TRUTH[3], TRUTH[2]];
        let mut remembering = flat();
        let mut forgetting = LikelihoodCounts { rates: Rates::new(1.0, 0.002), ..flat() };
        let mut dice = Dice::new(12);
        for counts in [&mut remembering, &mut forgetting] {
            teach(counts, &TRUTH, 8000, &mut dice);
            teach(counts, &changed, 4000, &mut dice);
        }
        // 125 a column are remembered: three standard errors.
        assert!(error(&forgetting, &changed) < 0.14, "{}", error(&forgetting, &changed));
        assert!(error(&remembering, &changed) > 0.4, "{}", error(&remembering, &changed));
    }

    #[test]
    fn without_experience_forgetting_ends_at_the_prior() {
        let prior = IdentityNoise::new(0.8, 2);
        let mut counts =
            LikelihoodCounts::<2, 2>::new(&prior, 4.0, prior.shape(), Rates::new(5.0, 0.2)).unwrap();
        let before = counts.columns.get(1).copied().unwrap();
        counts.learn(Evidence::Outcome(0), &[&[0.0, 1.0]]);
        assert_ne!(counts.columns.get(1), Some(&before));
        for _ in 0..200 {
            counts.learn(Evidence::Outcome(0), &[&[1.0, 0.0]]);
        }
        let after = counts.counts(&[1]).unwrap();
        assert!(after.counts().iter().zip(before.counts()).all(|(a, b)| (a - b).abs() < 1e-5));
        counts.reset();
        assert_eq!(counts.columns.get(0).map(Dirichlet::total), Some(4.0));
    }

    #[test]
    fn predictions_are_those_of_a_dense_table_with_the_same_numbers() {
        let mut dice = Dice::new(13);
        let mut counts = flat();
        for _ in 0..300 {
            let beliefs = [dice.distribution(2), dice.distribution(2)];
            counts.learn(Evidence::Soft(&dice.distribution(3)), &[&beliefs[0], &beliefs[1]]);

            let shape = counts.shape();
            let mut table = [0.0; 12];
            shape.for_each_column(|column, states| {
                (0..3).for_each(|outcome| table[4 * outcome + column] = counts.probability(outcome, states));
            });
            let dense = DenseLikelihood::try_new(&table, 3, &[2, 2]).expect("its columns are distributions");
            let preference = [dice.between(-3.0, 3.0), 0.0, dice.between(-3.0, 3.0)];
            let beliefs = [&beliefs[0][..], &beliefs[1]];
            let [ours, theirs] =
                [&counts as &dyn Likelihood, &dense].map(|of| of.expect(&shape, &beliefs, &preference));
            assert!((ours.utility - theirs.utility).abs() < 1e-5);
            assert!((ours.entropy() - theirs.entropy()).abs() < 1e-5);
            assert!((ours.ambiguity - theirs.ambiguity).abs() < 1e-5);
        }
    }

    #[test]
    fn novelty_is_the_average_over_the_states_and_falls_with_data() {
        let mut counts = flat();
        let beliefs: [&[f32]; 2] = [&[0.25, 0.75], &[0.5, 0.5]];
        let mut dice = Dice::new(14);
        let mut last = f32::INFINITY;
        for _ in 0..6 {
            let mut average = 0.0;
            counts.shape().for_each_column(|_, states| {
                let mass = beliefs[0][states[0]] * beliefs[1][states[1]];
                average += mass * counts.counts(states).unwrap().novelty();
            });
            let novelty = counts.novelty(&counts.shape(), &beliefs);
            assert!((novelty - average).abs() < 1e-6 && novelty >= 0.0 && novelty < last);
            last = novelty;
            teach(&mut counts, &TRUTH, 200, &mut dice);
        }
    }

    #[test]
    fn equal_weights_say_nothing_and_certain_ones_are_an_outcome() {
        let mut soft = flat();
        teach(&mut soft, &TRUTH, 200, &mut Dice::new(15));
        let mut hard = soft.clone();
        let before: Vec<f32> = (0..3).map(|outcome| soft.probability(outcome, &[1, 0])).collect();
        assert!(soft.learn(Evidence::Soft(&[2.0; 3]), &[&[0.0, 1.0], &[1.0, 0.0]]));
        for (outcome, p) in before.iter().enumerate() {
            assert!((soft.probability(outcome, &[1, 0]) - p).abs() < 1e-6);
        }
        soft = hard.clone();
        soft.learn(Evidence::Soft(&[0.0, 3.0, 0.0]), &[&[0.5, 0.5], &[0.5, 0.5]]);
        hard.learn(Evidence::Outcome(1), &[&[0.5, 0.5], &[0.5, 0.5]]);
        assert_eq!(soft.columns.get(2), hard.columns.get(2));
    }

    #[test]
    fn an_outcome_held_impossible_is_believed_when_it_is_seen() {
        let prior = IdentityNoise::new(1.0, 2);
        let mut counts = LikelihoodCounts::<2, 2>::new(&prior, 1.0, prior.shape(), Rates::DEFAULT).unwrap();
        assert!(counts.learn(Evidence::Outcome(1), &[&[1.0, 0.0]]));
        assert_eq!(counts.probability(1, &[0]), 0.5);
        assert!(counts.learn(Evidence::Soft(&[1.0, 0.0]), &[&[0.0, 1.0]]));
        assert_eq!(counts.probability(0, &[1]), 0.5);
    }

    #[test]
    fn what_makes_no_sense_teaches_nothing_and_every_number_stays_finite() {
        let odd = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0, 0.0, 1e-45, 0.5, 0.5, 1.0, f32::MAX];
        let mut dice = Dice::new(16);
        let mut counts = LikelihoodCounts { rates: Rates::new(1e30, 0.1), ..flat() };
        for _ in 0..20_000 {
            let mut pick = || odd[dice.below(odd.len())];
            let (first, second, soft) = ([pick(), pick()], [pick(), pick()], [pick(), pick(), pick()]);
            let sound = math::is_distribution(&first) && math::is_distribution(&second);
            let learned = counts.learn(Evidence::Soft(&soft), &[&first, &second]);
            assert!(!learned || sound);
            let expected = counts.expect(&counts.shape(), &[&[0.5, 0.5], &[1.0, 0.0]], &[1.0, 0.0, -1.0]);
            assert!(
                expected.utility.is_finite()
                    && expected.entropy().is_finite()
                    && expected.ambiguity.is_finite()
            );
            let novelty = counts.novelty(&counts.shape(), &[&[0.5, 0.5], &[1.0, 0.0]]);
            assert!(novelty.is_finite() && novelty >= 0.0);
            counts.shape().for_each_column(|_, states| {
                assert!(math::is_distribution(&counts.counts(states).unwrap().expected()));
            });
        }
        assert!(!counts.learn(Evidence::Missing, &[&[0.5, 0.5], &[0.5, 0.5]]));
        assert!(!counts.learn(Evidence::Outcome(3), &[&[0.5, 0.5], &[0.5, 0.5]]));
        assert!(!counts.learn(Evidence::Outcome(0), &[&[0.5, 0.5]]));
        assert_eq!(counts.probability(0, &[0]), 0.0);
        assert_eq!(counts.probability(0, &[0, 2]), 0.0);
    }

    #[test]
    fn memory_is_four_bytes_a_count_and_twelve_a_column() {
        let table = size_of::<LikelihoodCounts<49, 49>>() - size_of::<LikelihoodCounts<1, 1>>();
        assert_eq!(table, 4 * (49 * 49 - 1) + 12 * 48);
    }

    #[test]
    fn tables_that_do_not_fit_are_refused_with_the_place() {
        let shape = Shape::new(2, &[2]).unwrap();
        let new =
            |counts: &[f32]| LikelihoodCounts::<2, 2>::from_counts(counts, shape, Rates::DEFAULT).map(|_| ());
        assert_eq!(new(&[1.0; 3]), Err(TableError::Length(3)));
        assert_eq!(new(&[1.0, 1.0, f32::NAN, 1.0]), Err(TableError::Entry(2)));
        assert_eq!(new(&[1.0, -1.0, 1.0, 1.0]), Err(TableError::Entry(1)));
        assert_eq!(new(&[1.0, 0.0, 1.0, 0.0]), Err(TableError::Column(1, 0.0)));
        let wide = IdentityNoise::new(0.5, 3);
        let refused = LikelihoodCounts::<2, 2>::new(&wide, 1.0, wide.shape(), Rates::DEFAULT).map(|_| ());
        assert_eq!(refused, Err(TableError::Length(4)));
    }
}
