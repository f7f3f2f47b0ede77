//! A model described by its numbers: written out for the oracle, and put together from the core's
//! forms.

use super::Tables;
use iibt_core::actions::Action;
use iibt_core::inference::{
    Blocks, Control, Evidence, Factor, IdentityNoise, Likelihood, Modality, Model, NextState, OutcomeTable,
    Shape, Transition, likelihood, transition,
};

/// A described model.
#[derive(Clone, Debug)]
pub struct Description {
    /// The hidden factors.
    pub factors: Vec<Hidden>,
    /// The modalities.
    pub modalities: Vec<Sense>,
}

/// A hidden factor.
#[derive(Clone, Debug)]
pub struct Hidden {
    /// D.
    pub prior: Vec<f32>,
    /// The other factors that its transition depends on.
    pub coupled_to: Vec<usize>,
    /// The action sequence that moves it.
    pub control: Option<usize>,
    /// How many actions it knows.
    pub actions: usize,
    /// B.
    pub motion: Motion,
}

/// A transition; tables have a row per next state and a column per combination of states, action
/// after action.
#[derive(Clone, Debug)]
pub enum Motion {
    /// The core's dense form.
    Dense(Vec<f32>),
    /// Next states and the slip.
    NextState(Vec<u16>, f32),
    /// A weighted sum of what depends on one factor each.
    Blocks(Vec<(f32, Motion)>),
    /// A form of the user's.
    Own(Vec<f32>),
}

/// A modality.
#[derive(Clone, Debug)]
pub struct Sense {
    /// How many outcomes it has.
    pub outcomes: usize,
    /// The factors it depends on.
    pub factors: Vec<usize>,
    /// A.
    pub sensor: Sensor,
    /// C.
    pub preference: Vec<f32>,
}

/// A likelihood; tables have a row per outcome and a column per combination of states.
#[derive(Clone, Debug)]
pub enum Sensor {
    /// The core's dense form.
    Dense(Vec<f32>),
    /// How often it is right.
    IdentityNoise(f32),
    /// Labels, kinds and columns.
    OutcomeTable(Vec<Vec<u8>>, Vec<u8>, Vec<f32>),
    /// A form of the user's.
    Own(Vec<f32>),
}

/// What was observed through one modality.
#[derive(Clone, Debug)]
pub enum Observed {
    /// Nothing.
    Missing,
    /// An outcome.
    Outcome(usize),
    /// A weight for each outcome.
    Soft(Vec<f32>),
}

impl Observed {
    /// As the core takes it.
    #[must_use]
    pub fn evidence(&self) -> Evidence<'_> {
        match self {
            Self::Missing => Evidence::Missing,
            Self::Outcome(outcome) => Evidence::Outcome(*outcome),
            Self::Soft(weights) => Evidence::Soft(weights),
        }
    }

    /// As the oracle takes it: a weight per outcome.
    #[must_use]
    pub fn weights(&self, outcomes: usize) -> Option<Vec<f64>> {
        let of = |outcome: usize| match self {
            Self::Missing => 1.0,
            Self::Outcome(seen) => f64::from(u8::from(*seen == outcome)),
            Self::Soft(weights) => weights.get(outcome).copied().map_or(0.0, f64::from),
        };
        (!matches!(self, Self::Missing)).then(|| (0..outcomes).map(of).collect())
    }
}

/// A form of the user's: it gives probabilities and nothing else.
struct Own<'a> {
    table: &'a [f32],
    values: usize,
    states: Vec<usize>,
}

impl Own<'_> {
    fn read(&self, matrix: usize, value: usize, states: &[usize]) -> f32 {
        let columns: usize = self.states.iter().product();
        self.table
            .get((matrix * self.values + value) * columns + column(states, &self.states))
            .copied()
            .unwrap_or(0.0)
    }
}

impl Likelihood for Own<'_> {
    fn probability(&self, outcome: usize, states: &[usize]) -> f32 {
        self.read(0, outcome, states)
    }
}

impl Transition for Own<'_> {
    fn probability(&self, action: Action, next: usize, states: &[usize]) -> f32 {
        self.read(usize::from(action), next, states)
    }
}

/// The number of a combination of states, the last running fastest.
fn column(states: &[usize], counts: &[usize]) -> usize {
    states.iter().zip(counts).fold(0, |at, (state, count)| at * count + state)
}

impl Motion {
    /// P(s' | s, u).
    fn p(&self, action: usize, next: usize, states: &[usize], counts: &[usize], values: usize) -> f64 {
        match self {
            Self::Dense(table) | Self::Own(table) => {
                let columns: usize = counts.iter().product();
                table[(action * values + next) * columns + column(states, counts)].into()
            }
            Self::NextState(table, slip) => {
                let arrives = usize::from(table[action * values + states[0]]) == next;
                let stays = states[0] == next;
                (1.0 - f64::from(*slip)) * f64::from(u8::from(arrives))
                    + f64::from(*slip) * f64::from(u8::from(stays))
            }
            Self::Blocks(blocks) => {
                let parts = blocks.iter().zip(states).zip(counts);
                parts
                    .map(|(((weight, of), &state), &count)| {
                        f64::from(*weight) * of.p(action, next, &[state], &[count], values)
                    })
                    .sum()
            }
        }
    }
}

impl Sense {
    /// P(o | s).
    fn p(&self, outcome: usize, states: &[usize], counts: &[usize]) -> f64 {
        match &self.sensor {
            Sensor::Dense(table) | Sensor::Own(table) => {
                table[outcome * counts.iter().product::<usize>() + column(states, counts)].into()
            }
            Sensor::IdentityNoise(correct) if outcome == states[0] => f64::from(*correct),
            Sensor::IdentityNoise(correct) => (1.0 - f64::from(*correct)) / (counts[0] - 1) as f64,
            Sensor::OutcomeTable(labels, kinds, columns) => {
                let most = |of: &Vec<u8>| usize::from(of.iter().copied().max().unwrap_or(0)) + 1;
                let counts: Vec<usize> = labels.iter().map(most).collect();
                let carried: Vec<usize> =
                    labels.iter().zip(states).map(|(of, &state)| usize::from(of[state])).collect();
                let kind = usize::from(kinds[column(&carried, &counts)]);
                columns[kind * self.outcomes + outcome].into()
            }
        }
    }
}

impl Description {
    /// How many states each factor has.
    #[must_use]
    pub fn states(&self) -> Vec<usize> {
        self.factors.iter().map(|factor| factor.prior.len()).collect()
    }

    fn counts(&self, factors: &[usize]) -> Vec<usize> {
        factors.iter().map(|&factor| self.factors[factor].prior.len()).collect()
    }

    /// A factor and those that its motion depends on.
    fn conditions(&self, factor: usize) -> Vec<usize> {
        core::iter::once(factor).chain(self.factors[factor].coupled_to.iter().copied()).collect()
    }

    /// Every table written out.
    #[must_use]
    pub fn tables(&self) -> Tables {
        let mut tables = Tables { states: self.states(), likelihood: vec![], transition: vec![] };
        let joint: Vec<Vec<usize>> =
            (0..tables.joint_states()).map(|joint| tables.states_of(joint)).collect();
        let picked = |all: &[usize], of: &[usize]| of.iter().map(|&factor| all[factor]).collect::<Vec<_>>();
        for sense in &self.modalities {
            let counts = self.counts(&sense.factors);
            let of = |all: &Vec<usize>| {
                let states = picked(all, &sense.factors);
                (0..sense.outcomes).map(|outcome| sense.p(outcome, &states, &counts)).collect()
            };
            tables.likelihood.push(joint.iter().map(of).collect());
        }
        for (number, factor) in self.factors.iter().enumerate() {
            let conditions = self.conditions(number);
            let (counts, values) = (self.counts(&conditions), factor.prior.len());
            let of = |action: usize, all: &Vec<usize>| {
                let states = picked(all, &conditions);
                (0..values).map(|next| factor.motion.p(action, next, &states, &counts, values)).collect()
            };
            let matrix = |action| joint.iter().map(|all| of(action, all)).collect();
            tables.transition.push((0..factor.actions).map(matrix).collect());
        }
        tables
    }

    /// The same model with every form written out as the core's dense one.
    #[must_use]
    pub fn dense(&self) -> Self {
        let mut dense = self.clone();
        for (sense, of) in dense.modalities.iter_mut().zip(&self.modalities) {
            let counts = self.counts(&of.factors);
            let p = |outcome: usize, states: &[usize]| of.p(outcome, states, &counts) as f32;
            sense.sensor = Sensor::Dense(written_out(of.outcomes, &counts, p));
        }
        for (number, factor) in dense.factors.iter_mut().enumerate() {
            let (counts, values) = (self.counts(&self.conditions(number)), factor.prior.len());
            let motion = &self.factors[number].motion;
            let p = |action, next, states: &[usize]| motion.p(action, next, states, &counts, values) as f32;
            let matrix = |action| written_out(values, &counts, |next, states| p(action, next, states));
            factor.motion = Motion::Dense((0..factor.actions).flat_map(matrix).collect());
        }
        dense
    }

    /// Puts the model together from the core's forms and hands it to `with`.
    pub fn build<T>(&self, with: impl FnOnce(&Model) -> T) -> T {
        let labels: Vec<Vec<&[u8]>> = self.modalities.iter().map(Sense::labels).collect();
        let sensors: Vec<Box<dyn Likelihood + '_>> =
            self.modalities.iter().zip(&labels).map(|(sense, labels)| self.sensor(sense, labels)).collect();
        let single: Vec<Vec<Box<dyn Transition + '_>>> =
            (0..self.factors.len()).map(|factor| self.blocks(factor)).collect();
        let rows: Vec<Vec<(f32, &dyn Transition)>> = self
            .factors
            .iter()
            .zip(&single)
            .map(|(factor, single)| factor.weights().into_iter().zip(single.iter().map(|of| &**of)).collect())
            .collect();
        let motions: Vec<Box<dyn Transition + '_>> =
            rows.iter().enumerate().map(|(factor, row)| self.motion(factor, row)).collect();
        let factors: Vec<Factor> =
            motions.iter().enumerate().map(|(at, of)| self.factor(at, &**of)).collect();
        let modalities: Vec<Modality> = self
            .modalities
            .iter()
            .zip(&sensors)
            .map(|(sense, sensor)| {
                let shape = shape(sense.outcomes, &self.counts(&sense.factors));
                Modality::new(&**sensor, shape, &sense.factors, &sense.preference)
            })
            .collect();
        with(&Model::new(&factors, &modalities))
    }

    fn sensor<'a>(&'a self, sense: &'a Sense, labels: &'a [&'a [u8]]) -> Box<dyn Likelihood + 'a> {
        let states = self.counts(&sense.factors);
        match &sense.sensor {
            Sensor::Dense(table) => {
                Box::new(likelihood::DenseLikelihood::new(table, sense.outcomes, &states))
            }
            Sensor::IdentityNoise(correct) => Box::new(IdentityNoise::new(*correct, sense.outcomes)),
            Sensor::OutcomeTable(_, kinds, columns) => {
                Box::new(OutcomeTable::new(labels, kinds, columns, sense.outcomes))
            }
            Sensor::Own(table) => Box::new(Own { table, values: sense.outcomes, states }),
        }
    }

    /// The blocks of a factor's motion; none for one of another form.
    fn blocks(&self, factor: usize) -> Vec<Box<dyn Transition + '_>> {
        let Motion::Blocks(blocks) = &self.factors[factor].motion else { return vec![] };
        let values = self.factors[factor].prior.len();
        let conditions = self.conditions(factor);
        let single = blocks.iter().zip(conditions);
        single.map(|((_, of), from)| of.build(values, &self.counts(&[from]), &[])).collect()
    }

    fn motion<'a>(&'a self, factor: usize, row: &'a [(f32, &'a dyn Transition)]) -> Box<dyn Transition + 'a> {
        let of = &self.factors[factor];
        of.motion.build(of.prior.len(), &self.counts(&self.conditions(factor)), row)
    }

    fn factor<'a>(&'a self, number: usize, motion: &'a dyn Transition) -> Factor<'a> {
        let factor = &self.factors[number];
        let shape = shape(factor.prior.len(), &self.counts(&self.conditions(number)));
        Factor::new(motion, shape, &factor.prior).coupled_to(&factor.coupled_to).controlled_by(
            match factor.control {
                None => Control::None,
                Some(control) if control == number => Control::Own,
                Some(control) => Control::Shared(control as u8),
            },
        )
    }
}

impl Motion {
    fn build<'a>(
        &'a self,
        values: usize,
        states: &[usize],
        row: &'a [(f32, &'a dyn Transition)],
    ) -> Box<dyn Transition + 'a> {
        match self {
            Self::Dense(table) => {
                let matrix = values * states.iter().product::<usize>();
                Box::new(transition::DenseTransition::new(table, table.len() / matrix, states))
            }
            Self::NextState(table, slip) => Box::new(NextState::with_slip(table, values, *slip)),
            Self::Blocks(_) => Box::new(Blocks::new(row, states)),
            Self::Own(table) => Box::new(Own { table, values, states: states.to_vec() }),
        }
    }
}

impl Hidden {
    fn weights(&self) -> Vec<f32> {
        match &self.motion {
            Motion::Blocks(blocks) => blocks.iter().map(|(weight, _)| *weight).collect(),
            _ => vec![],
        }
    }
}

impl Sense {
    fn labels(&self) -> Vec<&[u8]> {
        match &self.sensor {
            Sensor::OutcomeTable(labels, ..) => labels.iter().map(Vec::as_slice).collect(),
            _ => vec![],
        }
    }
}

fn shape(values: usize, states: &[usize]) -> Shape {
    Shape::new(values, states).expect("a shape that fits")
}

/// A table, row by row, from what its entries are.
fn written_out(values: usize, counts: &[usize], p: impl Fn(usize, &[usize]) -> f32) -> Vec<f32> {
    let mut table = vec![];
    for value in 0..values {
        shape(values, counts).for_each_column(|_, states| table.push(p(value, states)));
    }
    table
}
