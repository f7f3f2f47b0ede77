//! Random models of fixed shape, made from a seed without a heap and with the same bits everywhere.
//!
//! Three factors, of which the last two move together, seen through three modalities, in every form
//! that the engine has but blocks. Columns have zeros, concentrated and even entries.

use iibt_core::inference::{
    Beliefs, Candidates, Evaluation, Evidence, Factor, IdentityNoise, Modality, Model, NextState,
    OutcomeTable, Policy, likelihood, transition,
};

/// The states of the factors.
pub const STATES: [usize; 3] = [5, 3, 4];

/// Room for the beliefs about a random model: the largest factor's states, and a group for each
/// factor.
pub type BeliefRoom = Beliefs<5, 3>;

/// Room for the evaluation of a random model.
pub type Trial = Evaluation<5, 3, 4, 2>;

/// The number of steps of a policy.
pub const STEPS: usize = 2;

const ACTIONS: usize = 2;

/// The outcomes of the last two modalities.
const OUTCOMES: [usize; 2] = [3, 3];

/// A generator of numbers (a linear congruential one, its upper half).
#[derive(Clone, Debug)]
pub(super) struct Chance(u64);

impl Chance {
    /// The numbers of a seed.
    pub(super) fn new(seed: u64) -> Self {
        let mut chance = Self(seed);
        // A linear congruential generator takes a few rounds to leave a small seed behind.
        let _ = [(); 4].map(|()| chance.bits());
        chance
    }

    pub(super) fn bits(&mut self) -> u32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 32) as u32
    }

    pub(super) fn below(&mut self, count: u32) -> u32 {
        self.bits() % count.max(1)
    }

    /// A number from 0 to 1, 1 excluded, of 16 bits: exact in single precision.
    fn unit(&mut self) -> f32 {
        (self.bits() >> 16) as f32 / 65_536.0
    }

    /// A weight: sometimes zero, often small.
    pub(super) fn weight(&mut self) -> f32 {
        match self.below(4) {
            0 => 0.0,
            1 => self.unit() * 0.01 + 0.001,
            _ => self.unit() + 0.05,
        }
    }

    /// Fills a table of `rows` values by columns of distributions.
    fn columns(&mut self, table: &mut [f32], rows: usize) {
        let columns = table.len() / rows.max(1);
        for column in 0..columns {
            let entries = || (column..).step_by(columns.max(1)).take(rows);
            let mut sum = 0.0;
            for at in entries() {
                let weight = self.weight();
                sum += weight;
                if let Some(entry) = table.get_mut(at) {
                    *entry = weight;
                }
            }
            for at in entries() {
                if let Some(entry) = table.get_mut(at) {
                    *entry = if sum > 0.0 { *entry / sum } else { 1.0 / rows as f32 };
                }
            }
        }
    }
}

/// The numbers of a random model, an observation and policies.
#[derive(Clone, Debug)]
pub struct RandomModel {
    priors: [[f32; 5]; 3],
    next: [u16; ACTIONS * 5],
    last_next: [u16; ACTIONS * 4],
    slip: f32,
    coupled: [[f32; 3 * 3 * 4]; ACTIONS],
    correct: f32,
    labels: [[u8; 5]; 2],
    kinds: [u8; 4],
    kind_columns: [[f32; 3]; 3],
    dense: [f32; 3 * 3 * 4],
    preferences: [[f32; 5]; 3],
    outcomes: [usize; 3],
    policies: [[Policy; 2]; 3],
}

impl RandomModel {
    /// The model of a seed.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        let chance = &mut Chance::new(seed);
        let mut model = Self {
            priors: [[0.0; 5]; 3],
            next: core::array::from_fn(|_| chance.below(5) as u16),
            last_next: core::array::from_fn(|_| chance.below(4) as u16),
            slip: if chance.below(2) == 0 { 0.0 } else { chance.unit() },
            coupled: [[0.0; 36]; ACTIONS],
            correct: chance.unit(),
            // Both labels are carried, by the first state and the second.
            labels: core::array::from_fn(|_| {
                core::array::from_fn(|state| match state {
                    0 | 1 => state as u8,
                    _ => chance.below(2) as u8,
                })
            }),
            kinds: core::array::from_fn(|_| chance.below(3) as u8),
            kind_columns: [[0.0; 3]; 3],
            dense: [0.0; 36],
            preferences: core::array::from_fn(|_| core::array::from_fn(|_| 6.0 * chance.unit() - 3.0)),
            outcomes: [5, 3, 3].map(|outcomes| chance.below(outcomes) as usize),
            policies: core::array::from_fn(|_| core::array::from_fn(|_| policy(chance))),
        };
        for (prior, states) in model.priors.iter_mut().zip(STATES) {
            chance.columns(prior.get_mut(..states).unwrap_or(&mut []), states);
        }
        model.coupled.iter_mut().for_each(|table| chance.columns(table, 3));
        model.kind_columns.iter_mut().for_each(|column| chance.columns(column, 3));
        chance.columns(&mut model.dense, 3);
        model
    }

    /// Puts the model together and hands it to `with`, with its policies and an observation; `None`
    /// when a table is not what it should be, which no seed is known for.
    pub fn build<T>(&self, with: impl FnOnce(&Model, Candidates, &[Evidence; 3]) -> T) -> Option<T> {
        let motion = NextState::try_new(&self.next, 5, self.slip).ok()?;
        let last = NextState::try_new(&self.last_next, 4, 0.0).ok()?;
        let coupled =
            transition::DenseTransition::try_new(self.coupled.as_flattened(), ACTIONS, &[3, 4]).ok()?;
        let [first_prior, second_prior, third_prior] = &self.priors;
        let factors = [
            Factor::try_new(&motion, motion.shape(), first_prior)?,
            Factor::try_new(&coupled, coupled.shape(), second_prior.get(..3)?)?.coupled_to(&[2]),
            Factor::try_new(&last, last.shape(), third_prior.get(..4)?)?,
        ];

        let sensor = IdentityNoise::among(self.correct, 5);
        let [first, third] = &self.labels;
        let labels = [first.as_slice(), third.get(..4)?];
        let result =
            OutcomeTable::try_new(&labels, &self.kinds, self.kind_columns.as_flattened(), OUTCOMES[0])
                .ok()?;
        let dense = likelihood::DenseLikelihood::try_new(&self.dense, OUTCOMES[1], &[3, 4]).ok()?;
        let [first, second, third] = &self.preferences;
        let modalities = [
            Modality::try_new(&sensor, sensor.shape(), &[0], first)?,
            Modality::try_new(&result, result.shape(), &[0, 2], second.get(..OUTCOMES[0])?)?,
            Modality::try_new(&dense, dense.shape(), &[1, 2], third.get(..OUTCOMES[1])?)?,
        ];

        let model = Model::try_new(&factors, &modalities).ok()?;
        let sequences = self.policies.each_ref().map(|list| list.as_slice());
        Some(with(&model, Candidates::all(&sequences), &self.outcomes.map(Evidence::Outcome)))
    }
}

fn policy(chance: &mut Chance) -> Policy {
    let mut policy = Policy::EMPTY;
    for _ in 0..STEPS {
        if policy.push(chance.below(ACTIONS as u32) as u8).is_err() {
            break;
        }
    }
    policy
}
