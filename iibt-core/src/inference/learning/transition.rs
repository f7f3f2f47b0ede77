//! B, learned: the actual effects of actions.

use super::columns::Columns;
use super::origin::Origin;
use super::{Dirichlet, Rates, fit};
use crate::actions::{Action, Actions};
use crate::inference::Shape;
use crate::inference::likelihood::TableError;
use crate::inference::transition::{Transition, stay};
use crate::math;

/// Dirichlet counts of B, the transition of one factor with `S` states and `U` actions, whose
/// conditions (its own state, and those of the factors that it is coupled to) have `C` combinations
/// of states; `C` is `S` for a factor by itself. They are a transition themselves, with the
/// expected probabilities, so that a model can hold them.
///
/// Memory: `U` times 4 `S C` + 12 `C` bytes; the prior stays where it is. A prediction costs one
/// multiplication for each entry of the columns with belief, and novelty one for each column.
///
/// ```
/// use iibt_core::inference::learning::{Rates, TransitionCounts};
/// use iibt_core::inference::{NextState, Transition};
///
/// // Two cells; action 0 goes to the second, or so it should.
/// static DRIVE: NextState = NextState::with_slip(&[1, 1], 2, 0.1);
/// let mut drive = TransitionCounts::<2, 2, 1>::new(&DRIVE, 10.0, DRIVE.shape(), Rates::DEFAULT)?;
/// for _ in 0..10 {
///     assert!(drive.learn(0, &[&[1.0, 0.0]], &[1.0, 0.0]));
/// }
/// assert!((drive.probability(0, 0, &[0]) - 0.55).abs() < 1e-6);
/// # Ok::<(), iibt_core::inference::TableError>(())
/// ```
#[derive(Clone)]
pub struct TransitionCounts<'a, const S: usize, const C: usize, const U: usize> {
    actions: [Columns<S, C>; U],
    origin: Origin<'a, dyn Transition + 'a>,
    shape: Shape,
    rates: Rates,
}

impl<'a, const S: usize, const C: usize, const U: usize> TransitionCounts<'a, S, C, U> {
    /// Begins with a table, each column of which counts as `concentration` moves: held to
    /// [`LEAST`](super::LEAST)..=[`MOST`](super::MOST), and one for NaN. A column of the table
    /// without a positive number begins with one count, shared out evenly.
    ///
    /// # Errors
    /// [`TableError::Length`] when `shape`, the table's, has not `S` values and `C` columns, or its
    /// first condition has not `S` states.
    pub fn new(
        prior: &'a (dyn Transition + 'a),
        concentration: f32,
        shape: Shape,
        rates: Rates,
    ) -> Result<Self, TableError> {
        Self::from_origin(Origin::table(prior, concentration), shape, rates)
    }

    /// Begins with these counts: a matrix per action, in it a row per next state and a column per
    /// combination of states, the factor's own state running slowest.
    ///
    /// # Errors
    /// [`TableError::Length`] as for [`new`](Self::new) and when there are not as many counts,
    /// [`TableError::Entry`] with the place of a count that is negative, NaN or above
    /// [`MOST`](super::MOST), and [`TableError::Column`] for one without counts.
    pub fn from_counts(prior: &'a [f32], shape: Shape, rates: Rates) -> Result<Self, TableError> {
        Self::from_origin(Origin::counts(prior, &shape, U)?, shape, rates)
    }

    fn from_origin(
        origin: Origin<'a, dyn Transition + 'a>,
        shape: Shape,
        rates: Rates,
    ) -> Result<Self, TableError> {
        const { assert!(U > 0 && U <= Actions::CODES as usize, "B has 1 to 16 actions") }
        if shape.values() != S || shape.states(0) != S || shape.columns() != Some(C) {
            return Err(TableError::Length(S.saturating_mul(C)));
        }
        let actions = core::array::from_fn(|action| {
            Columns::new(&shape, |at, states| prior_column::<S, C>(&origin, action, at, states))
        });
        Ok(Self { actions, origin, shape, rates })
    }

    /// Learns from a move by `action`: the beliefs `before` about the conditions, the factor itself
    /// first, and the belief `after` about the factor, its observation taken in: b(s', s) := b(s',
    /// s) + η ξ(s', s), with the posterior over both states of the move
    ///
    /// ξ(s', s) = q(s') B(s', s) q(s) / Σ_s B(s', s) q(s).
    ///
    /// This is exact (Baum and Welch's ξ, filtered) when `after` is what Bayes' rule makes of the
    /// prediction by these counts. The usual outer product q(s') q(s), which is
    /// [`learn_outer`](Self::learn_outer), takes the two states for independent, so a robot that is
    /// unsure where it is learns that its actions scatter; with certain beliefs the two are the
    /// same. Where the counts rule out a next state that is believed in, the outer product is
    /// taken.
    ///
    /// A robot that is often unsure should forget a little, since its first moves are told by
    /// counts that are still wrong.
    ///
    /// Forgetting works on all actions at every move. Returns `false`, and learns nothing, when
    /// there is no such action or the beliefs are no distributions. Costs a visit of each column
    /// with belief; of all where there is forgetting.
    pub fn learn(&mut self, action: Action, before: &[&[f32]], after: &[f32]) -> bool {
        let Some((masses, after)) = self.sound(before, after) else { return false };
        let Some(columns) = self.actions.get(usize::from(action)) else { return false };
        let mut share = columns.predict(&masses);
        share.iter_mut().zip(&after).for_each(|(share, after)| *share = after / *share);
        self.absorb(action, &masses, |column| {
            let mut moved = after;
            for ((moved, share), p) in moved.iter_mut().zip(&share).zip(column.expected()) {
                if share.is_finite() {
                    *moved = share * p;
                }
            }
            moved
        });
        true
    }

    /// Learns by the outer product of the beliefs, b(s', s) := b(s', s) + η q(s') q(s), as in
    /// pymdp, and in SPM, which leaves counts of zero at zero.
    ///
    /// Returns `false`, and learns nothing, as [`learn`](Self::learn) does.
    pub fn learn_outer(&mut self, action: Action, before: &[&[f32]], after: &[f32]) -> bool {
        let Some((masses, after)) = self.sound(before, after) else { return false };
        let known = usize::from(action) < U;
        if known {
            self.absorb(action, &masses, |_| after);
        }
        known
    }

    /// The mass of each column and the belief after, when they are distributions.
    fn sound(&self, before: &[&[f32]], after: &[f32]) -> Option<([f32; C], [f32; S])> {
        if !fit(&self.shape, before) || after.len() != S || !math::is_distribution(after) {
            return None;
        }
        let mut to = [0.0; S];
        math::assign(&mut to, after);
        Some((Columns::<S, C>::masses(before), to))
    }

    fn absorb(&mut self, taken: Action, masses: &[f32; C], moved: impl Fn(&Dirichlet<S>) -> [f32; S]) {
        let origin = &self.origin;
        for (action, columns) in self.actions.iter_mut().enumerate() {
            let masses = if action == usize::from(taken) { masses } else { &[0.0; C] };
            let prior = |at, states: &[usize]| prior_column::<S, C>(origin, action, at, states);
            columns.learn(&self.shape, self.rates, masses, prior, &moved);
        }
    }

    /// The counts of one action and combination of states; `None` outside the table.
    #[must_use]
    pub fn counts(&self, action: Action, states: &[usize]) -> Option<&Dirichlet<S>> {
        self.actions.get(usize::from(action))?.get(self.shape.column(states)?)
    }

    /// Its shape.
    #[must_use]
    pub const fn shape(&self) -> Shape {
        self.shape
    }

    /// Forgets everything learned.
    pub fn reset(&mut self) {
        let origin = &self.origin;
        for (action, columns) in self.actions.iter_mut().enumerate() {
            *columns =
                Columns::new(&self.shape, |at, states| prior_column::<S, C>(origin, action, at, states));
        }
    }
}

fn prior_column<const S: usize, const C: usize>(
    origin: &Origin<dyn Transition + '_>,
    action: usize,
    at: usize,
    states: &[usize],
) -> Dirichlet<S> {
    origin.column::<S, C>(action, at, |table, next| table.probability(action as Action, next, states))
}

impl<const S: usize, const C: usize, const U: usize> Transition for TransitionCounts<'_, S, C, U> {
    fn probability(&self, action: Action, next: usize, states: &[usize]) -> f32 {
        self.counts(action, states).map_or(0.0, |column| column.probability(next))
    }

    fn actions(&self) -> u8 {
        U as u8
    }

    fn predict(&self, _: &Shape, action: Action, beliefs: &[&[f32]], to: &mut [f32]) {
        match self.actions.get(usize::from(action)) {
            Some(columns) => math::assign(to, &columns.predict(&Columns::<S, C>::masses(beliefs))),
            None => stay(beliefs, to),
        }
    }

    /// Σ_s q(s) I(s'; θ_B(s, u)), each state's exactly, see [`Dirichlet::novelty`].
    fn novelty(&self, _: &Shape, action: Action, beliefs: &[&[f32]]) -> f32 {
        let columns = self.actions.get(usize::from(action));
        columns.map_or(0.0, |columns| columns.novelty(&Columns::<S, C>::masses(beliefs)))
    }
}

impl<const S: usize, const C: usize, const U: usize> core::fmt::Debug for TransitionCounts<'_, S, C, U> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("TransitionCounts").field("shape", &self.shape).field("rates", &self.rates).finish()
    }
}

#[cfg(test)]
mod tests {
    use super::super::sampling::{Dice, one};
    use super::*;
    use crate::inference::likelihood::IdentityNoise;
    use crate::inference::transition::DenseTransition;
    use crate::inference::{Beliefs, Evidence, PreferenceTiming, Problem, Scoring};
    use crate::inference::{Candidates, Evaluation, Factor, Likelihood, Modality, Model, NextState, Policy};
    use std::vec::Vec;

    /// Two actions over three states: round, and back.
    const TRUTH: [[f32; 9]; 2] =
        [[0.1, 0.0, 0.9, 0.9, 0.1, 0.0, 0.0, 0.9, 0.1], [0.3, 0.7, 0.0, 0.0, 0.3, 0.7, 0.7, 0.0, 0.3]];

    fn shape() -> Shape {
        Shape::new(3, &[3]).unwrap()
    }

    fn error(counts: &TransitionCounts<3, 3, 2>) -> f32 {
        let mut worst = 0.0_f32;
        for (action, table) in TRUTH.iter().enumerate() {
            for (at, p) in table.iter().enumerate() {
                worst = worst.max((counts.probability(action as Action, at / 3, &[at % 3]) - p).abs());
            }
        }
        worst
    }

    fn column(action: usize, state: usize) -> [f32; 3] {
        core::array::from_fn(|next| TRUTH[action][3 * next + state])
    }

    #[test]
    fn counts_come_to_the_table_that_moves_are_drawn_from() {
        let mut counts =
            TransitionCounts::<3, 3, 2>::from_counts(&[0.1; 18], shape(), Rates::DEFAULT).unwrap();
        let mut dice = Dice::new(21);
        let mut state = 0;
        for _ in 0..12_000 {
            let action = dice.below(2);
            let next = dice.draw(&column(action, state));
            assert!(counts.learn(action as Action, &[&one::<3>(state)], &one::<3>(next)));
            state = next;
        }
        // Some 2,000 a column: three standard errors of a fair coin.
        assert!(error(&counts) < 0.034, "{}", error(&counts));
    }

    /// A robot that filters with a sensor that errs, and learns its motion by `learn`.
    fn learn_while_unsure(
        learn: impl Fn(&mut TransitionCounts<3, 3, 2>, Action, &[&[f32]], &[f32]) -> bool,
    ) -> f32 {
        const PRIOR: [f32; 18] =
            [1.0, 1.0, 4.0, 4.0, 1.0, 1.0, 1.0, 4.0, 1.0, 1.0, 4.0, 1.0, 1.0, 1.0, 4.0, 4.0, 1.0, 1.0];
        let sensor = IdentityNoise::new(0.8, 3);
        // Early moves are told from a table that is still wrong; they are forgotten.
        let rates = Rates::new(1.0, 0.0004);
        let mut counts = TransitionCounts::<3, 3, 2>::from_counts(&PRIOR, shape(), rates).unwrap();
        let mut dice = Dice::new(22);
        let (mut state, mut belief) = (0, [1.0 / 3.0; 3]);
        for _ in 0..40_000 {
            let action = dice.below(2);
            state = dice.draw(&column(action, state));
            let seen = dice.draw(&[0, 1, 2].map(|outcome| sensor.probability(outcome, &[state])));
            let mut after = [0.0; 3];
            counts.predict(&shape(), action as Action, &[&belief], &mut after);
            after.iter_mut().enumerate().for_each(|(s, q)| *q *= sensor.probability(seen, &[s]));
            assert!(math::normalise(&mut after).is_some());
            assert!(learn(&mut counts, action as Action, &[&belief], &after));
            belief = after;
        }
        error(&counts)
    }

    #[test]
    fn an_unsure_robot_learns_its_motion_from_both_ends_of_a_move_and_not_from_the_outer_product() {
        // Measured: 0.04 and 0.37.
        let both_ends =
            learn_while_unsure(|counts, action, before, after| counts.learn(action, before, after));
        let outer =
            learn_while_unsure(|counts, action, before, after| counts.learn_outer(action, before, after));
        assert!(both_ends < 0.05, "{both_ends}");
        assert!(outer > 0.25, "{outer}");
    }

    #[test]
    fn what_a_move_adds_is_the_exact_posterior_over_both_its_states() {
        let mut dice = Dice::new(23);
        for _ in 0..500 {
            let prior: Vec<f32> = (0..18).map(|_| dice.between(0.1, 3.0)).collect();
            let mut counts = TransitionCounts::<3, 6, 1>::from_counts(
                &prior,
                Shape::new(3, &[3, 2]).unwrap(),
                Rates::DEFAULT,
            )
            .unwrap();
            let (own, other) = (dice.distribution(3), dice.distribution(2));
            let evidence = [dice.even() + 0.01, dice.even() + 0.01, dice.even() + 0.01];
            // P(s', s1, s2 | e), by enumeration in double precision.
            let mut joint = [[0.0_f64; 6]; 3];
            for (next, row) in joint.iter_mut().enumerate() {
                for (at, joint) in row.iter_mut().enumerate() {
                    let b = f64::from(counts.probability(0, next, &[at / 2, at % 2]));
                    *joint =
                        f64::from(evidence[next]) * b * f64::from(own[at / 2]) * f64::from(other[at % 2]);
                }
            }
            let total: f64 = joint.iter().flatten().sum();
            let after: Vec<f32> = joint.iter().map(|row| (row.iter().sum::<f64>() / total) as f32).collect();
            let before: Vec<_> = (0..6).map(|at| *counts.counts(0, &[at / 2, at % 2]).unwrap()).collect();
            assert!(counts.learn(0, &[&own, &other], &after));
            for (next, row) in joint.iter().enumerate() {
                for (at, joint) in row.iter().enumerate() {
                    let now = counts.counts(0, &[at / 2, at % 2]).unwrap().counts()[next];
                    let added = f64::from(now) - f64::from(before[at].counts()[next]);
                    assert!((added - joint / total).abs() < 3e-6, "{added} for {}", joint / total);
                }
            }
        }
    }

    #[test]
    fn predictions_are_those_of_a_dense_table_with_the_same_numbers() {
        let mut dice = Dice::new(24);
        let prior: Vec<f32> = (0..16).map(|_| dice.between(0.0, 2.0)).collect();
        let shape = Shape::new(2, &[2, 2]).unwrap();
        let mut counts =
            TransitionCounts::<2, 4, 2>::from_counts(&prior, shape, Rates::new(0.7, 0.01)).unwrap();
        for step in 0..300_u16 {
            let beliefs = [dice.distribution(2), dice.distribution(2)];
            let beliefs = [&beliefs[0][..], &beliefs[1]];
            let action = (step % 2) as Action;
            assert!(counts.learn(action, &beliefs, &dice.distribution(2)));
            let table: Vec<f32> = (0..16)
                .map(|at| counts.probability((at / 8) as Action, at / 4 % 2, &[at / 2 % 2, at % 2]))
                .collect();
            let dense = DenseTransition::try_new(&table, 2, &[2, 2]).expect("its columns are distributions");
            let (mut ours, mut theirs) = ([0.0; 2], [0.0; 2]);
            counts.predict(&shape, action, &beliefs, &mut ours);
            dense.predict(&shape, action, &beliefs, &mut theirs);
            assert!(ours.iter().zip(theirs).all(|(a, b)| (a - b).abs() < 1e-6));
            counts.predict(&shape, 9, &beliefs, &mut ours);
            assert_eq!(&ours[..], beliefs[0]);
        }
    }

    #[test]
    fn forgetting_follows_an_actuator_that_changes_and_brings_the_novelty_of_others_back() {
        let motion = NextState::new(&[1, 1, 0, 0], 2);
        let mut counts =
            TransitionCounts::<2, 2, 2>::new(&motion, 1.0, motion.shape(), Rates::new(1.0, 0.02)).unwrap();
        let mut dice = Dice::new(25);
        for _ in 0..100 {
            counts.learn(1, &[&[0.0, 1.0]], &dice.one_of(&[0.5, 0.5]));
        }
        let known = counts.novelty(&motion.shape(), 1, &[&[0.0, 1.0]]);
        for slip in [0.0, 0.9] {
            for _ in 0..300 {
                counts.learn(0, &[&[1.0, 0.0]], &dice.one_of(&[slip, 1.0 - slip]));
            }
            assert!((counts.probability(0, 0, &[0]) - slip).abs() < 0.15);
        }
        assert!(counts.probability(1, 0, &[1]) > 0.99);
        // The prior is sure of the other action again, so there is nothing new in it.
        assert!(known > 0.0 && counts.novelty(&motion.shape(), 1, &[&[0.0, 1.0]]) < known);
        counts.reset();
        assert_eq!(counts.probability(0, 1, &[0]), 1.0);
    }

    #[test]
    fn novelty_falls_with_moves_made() {
        let mut counts =
            TransitionCounts::<3, 3, 2>::from_counts(&[0.3; 18], shape(), Rates::DEFAULT).unwrap();
        let beliefs: [&[f32]; 1] = [&[0.2, 0.5, 0.3]];
        let untried = counts.novelty(&shape(), 1, &beliefs);
        let mut dice = Dice::new(26);
        let mut last = untried;
        for _ in 0..5 {
            for _ in 0..300 {
                let state = dice.below(3);
                counts.learn(0, &[&one::<3>(state)], &dice.one_of(&column(0, state)));
            }
            let now = counts.novelty(&shape(), 0, &beliefs);
            assert!(now > 0.0 && now < last);
            last = now;
        }
        assert_eq!(counts.novelty(&shape(), 1, &beliefs), untried);
        assert_eq!(counts.novelty(&shape(), 2, &beliefs), 0.0);
    }

    #[test]
    fn what_makes_no_sense_teaches_nothing_and_every_number_stays_finite() {
        let odd = [
            f32::NAN,
            f32::INFINITY,
            f32::NEG_INFINITY,
            -1.0,
            0.0,
            0.0,
            1e-45,
            1e-38,
            0.5,
            0.5,
            1.0,
            f32::MAX,
        ];
        let mut dice = Dice::new(27);
        let prior = [0.0, 1.0, 1.0, 1e-30, f32::MIN_POSITIVE, 1.0, 1.0, 0.0];
        let shape = Shape::new(2, &[2]).unwrap();
        let mut counts =
            TransitionCounts::<2, 2, 2>::from_counts(&prior, shape, Rates::new(f32::MAX, 0.1)).unwrap();
        for turn in 0..20_000 {
            let mut pick = || odd[dice.below(odd.len())];
            let (before, after) = ([pick(), pick()], [pick(), pick()]);
            let action = dice.below(3) as Action;
            let sound = action < 2 && math::is_distribution(&before) && math::is_distribution(&after);
            let learned = if turn % 2 == 0 {
                counts.learn(action, &[&before], &after)
            } else {
                counts.learn_outer(action, &[&before], &after)
            };
            assert_eq!(learned, sound);
            for at in 0..4 {
                let column = counts.counts(at / 2, &[usize::from(at % 2)]).unwrap();
                assert!(math::is_distribution(&column.expected()), "{column:?}");
            }
            let novelty = counts.novelty(&shape, action, &[&[0.5, 0.5]]);
            assert!(novelty.is_finite() && novelty >= 0.0);
        }
        assert!(!counts.learn(0, &[], &[1.0, 0.0]) && !counts.learn(0, &[&[1.0, 0.0]], &[1.0]));
    }

    #[test]
    fn a_robot_whose_drive_degrades_takes_the_other_route() {
        // From the start (0) to the goal (3) by cell 1 with the good drive or by cell 2 with the
        // slow one.
        #[rustfmt::skip]
        let routes = [
            0.05, 0.0, 1.0, 0.0,  0.95, 0.05, 0.0, 0.0,  0.0, 0.0, 0.0, 0.0,  0.0, 0.95, 0.0, 1.0,
            0.20, 1.0, 0.0, 0.0,  0.0, 0.0, 0.0, 0.0,  0.80, 0.0, 0.20, 0.0,  0.0, 0.0, 0.80, 1.0,
        ];
        let prior = DenseTransition::new(&routes, 2, &[4]);
        let mut drive =
            TransitionCounts::<4, 4, 2>::new(&prior, 20.0, prior.shape(), Rates::new(1.0, 0.01)).unwrap();
        let sensor = IdentityNoise::new(0.99, 4);
        let sequences = [Policy::new(&[0, 0]).unwrap(), Policy::new(&[1, 1]).unwrap()];
        let choose = |drive: &TransitionCounts<4, 4, 2>| {
            let factors = [Factor::new(drive, drive.shape(), &[1.0, 0.0, 0.0, 0.0])];
            let modalities = [Modality::new(&sensor, sensor.shape(), &[0], &[0.0, 0.0, 0.0, 3.0])];
            let model = Model::new(&factors, &modalities);
            let beliefs = Beliefs::<4, 1>::prior(&model);
            let among: [&[Policy]; 1] = [&sequences];
            let scoring = Scoring { timing: PreferenceTiming::EveryStep, ..Scoring::DEFAULT };
            let problem = Problem::new(&model, &beliefs, Candidates::all(&among), scoring);
            let mut evaluation = Evaluation::<4, 1, 2, 2>::new();
            evaluation.evaluate(&problem).unwrap();
            let [first, second] = [0, 1].map(|policy| evaluation.terms()[policy].utility);
            (evaluation.best(), first - second)
        };
        let (choice, lead) = choose(&drive);
        assert_eq!(choice, Some(0));
        assert!(lead > 0.0);

        // Now the good drive holds its place seven times in ten; the robot sees what becomes of its
        // moves.
        let mut dice = Dice::new(28);
        for _ in 0..60 {
            let moved = dice.even() < 0.3;
            let seen = dice.draw(&[0, 1, 2, 3].map(|o| sensor.probability(o, &[usize::from(moved)])));
            let factors = [Factor::new(&drive, drive.shape(), &[1.0, 0.0, 0.0, 0.0])];
            let modalities = [Modality::new(&sensor, sensor.shape(), &[0], &[0.0; 4])];
            let model = Model::new(&factors, &modalities);
            let before = Beliefs::<4, 1>::prior(&model);
            let mut after = before;
            after.predict(&model, &[Some(0)]).unwrap();
            if after.update(&model, &[Evidence::Outcome(seen)]).is_ok() {
                let (before, after) = (before.as_flat(), after.as_flat());
                assert!(drive.learn(0, &[before], after));
            }
        }
        let (choice, lead) = choose(&drive);
        assert_eq!(choice, Some(1));
        assert!(lead < 0.0);
    }
}
