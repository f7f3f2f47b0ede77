//! The tables as models of `inference`: the only file that knows how those are built and used.

use super::Command;
use super::definition::{
    Accuracy, HiddenFactor, JointOutcome, Labels, MAX_FACTORS, MAX_OPERATORS, MAX_SENSORS, MAX_STATES,
    Postcondition, Reads, Role,
};
use super::tables::Tables;
use crate::actions::Action;
use crate::bounded::up_to;
use crate::inference::likelihood::DenseLikelihood;
use crate::inference::{
    Beliefs, Candidates, Control, Evaluation, Evidence, Factor, Habits, IdentityNoise, Likelihood, Modality,
    Model, ObservationError, Policy, Problem, Scoring, Shape, Transition,
};
use crate::team::MAX_TEAM;
use heapless::Vec;

/// B of one hidden factor under the operators, given the factors that their effects depend on.
struct Dynamics<'a> {
    role: &'a Role<'a>,
    target: Option<u8>,
    /// The factor itself, then those that it depends on.
    conditions: Vec<usize, MAX_FACTORS>,
}

impl<'a> Dynamics<'a> {
    fn new(role: &'a Role<'a>, target: Option<u8>, factor: usize) -> Self {
        let mut conditions = Vec::new();
        let effects = role.operators.iter().flat_map(|operator| operator.effects);
        let own = effects.filter(|effect| usize::from(effect.factor) == factor);
        let given = own.flat_map(|effect| effect.given).filter(|given| given.robot.is_none());
        for factor in core::iter::once(factor).chain(given.map(|given| usize::from(given.factor))) {
            if !conditions.contains(&factor) {
                // There is room for every factor once.
                let _ = conditions.push(factor);
            }
        }
        Self { role, target, conditions }
    }

    fn shape(&self) -> Option<Shape> {
        let mut states = Vec::<_, MAX_FACTORS>::new();
        for &factor in &self.conditions {
            states.push(self.role.factors.get(factor)?.states.len()).ok()?;
        }
        Shape::new(*states.first()?, &states)
    }
}

impl Transition for Dynamics<'_> {
    fn probability(&self, action: Action, next: usize, states: &[usize]) -> f32 {
        let (Some(&factor), Some(&now)) = (self.conditions.first(), states.first()) else { return 0.0 };
        let stays = if next == now { 1.0 } else { 0.0 };
        let Some(operator) = self.role.operators.get(usize::from(action)) else { return stays };
        let is = |robot: Option<u8>, factor: usize| {
            let at = self.conditions.iter().position(|&condition| condition == factor)?;
            states.get(at).copied().filter(|_| robot.is_none())
        };
        match operator.becomes(factor, self.target, &is) {
            Some(to) => {
                let reached = if next == to { 1.0 } else { 0.0 };
                operator.success * reached + (1.0 - operator.success) * stays
            }
            None => stays,
        }
    }
}

/// B of a decision: the results of a role's operators.
struct Brought<'a>(&'a Role<'a>);

impl Transition for Brought<'_> {
    fn probability(&self, action: Action, next: usize, states: &[usize]) -> f32 {
        let is = |state: u8| if next == usize::from(state) { 1.0 } else { 0.0 };
        let stays = if states.first() == Some(&next) { 1.0 } else { 0.0 };
        match self.0.operators.get(usize::from(action)).map(|operator| operator.brings) {
            Some(Postcondition::State(state, p)) => p * is(state) + (1.0 - p) * stays,
            Some(Postcondition::Reset(state, p, other)) => p * is(state) + (1.0 - p) * is(other),
            Some(Postcondition::Nothing) | None => stays,
        }
    }
}

/// P(reading | what is read).
enum Noise<'a> {
    Even(IdentityNoise),
    Table(DenseLikelihood<'a>),
}

impl<'a> Noise<'a> {
    fn new(accuracy: Accuracy<'a>, outcomes: usize) -> Option<Self> {
        Some(match accuracy {
            Accuracy::Even(right) => Self::Even(IdentityNoise::among(right, outcomes)),
            Accuracy::Table(table) => {
                Self::Table(DenseLikelihood::try_new(table, outcomes, &[outcomes]).ok()?)
            }
        })
    }

    fn form(&self) -> &dyn Likelihood {
        match self {
            Self::Even(even) => even,
            Self::Table(table) => table,
        }
    }
}

/// A of a sensor: the label of the factors' states, read with noise.
struct Reading<'a> {
    noise: Noise<'a>,
    /// The function of factors that is read; else the state itself.
    labels: Option<(&'a Labels<'a>, &'a [HiddenFactor<'a>])>,
    factors: Vec<usize, MAX_FACTORS>,
    shape: Shape,
}

impl<'a> Reading<'a> {
    fn new(role: &'a Role<'a>, reads: &'a Reads<'a>, accuracy: Accuracy<'a>) -> Option<Self> {
        let labels = match reads {
            Reads::Factor(_) => None,
            Reads::State => Some(&role.states),
            Reads::Labels(labels) => Some(labels),
        };
        let (mut factors, mut states) = (Vec::new(), Vec::<_, MAX_FACTORS>::new());
        let mut depend = |factor: &u8| {
            let factor = usize::from(*factor);
            states.push(role.factors.get(factor)?.states.len()).ok()?;
            factors.push(factor).ok()
        };
        match (reads, labels) {
            (Reads::Factor(factor), _) => depend(factor)?,
            (_, labels) => labels?.factors.iter().try_for_each(depend)?,
        }
        let outcomes = labels.map_or(*states.first()?, |labels| labels.names.len());
        let shape = Shape::new(outcomes, &states)?;
        let labels = labels.map(|labels| (labels, role.factors));
        Some(Self { noise: Noise::new(accuracy, outcomes)?, labels, factors, shape })
    }
}

impl Likelihood for Reading<'_> {
    fn probability(&self, outcome: usize, states: &[usize]) -> f32 {
        let state = |factor: usize| {
            let at = self.factors.iter().position(|&of| of == factor);
            at.and_then(|at| states.get(at)).copied().unwrap_or(0)
        };
        match self.labels {
            Some((labels, factors)) => self.noise.form().probability(outcome, &[labels.of(factors, state)]),
            None => self.noise.form().probability(outcome, states),
        }
    }
}

/// The outcome that the states of all robots determine.
struct Together<'a> {
    outcome: &'a JointOutcome<'a>,
    tables: &'a Tables<'a>,
}

impl Likelihood for Together<'_> {
    fn probability(&self, outcome: usize, states: &[usize]) -> f32 {
        let roles = self.tables.roles().iter().zip(states);
        let place = roles.fold(0, |place, (role, state)| place * role.states.names.len() + state);
        let is = self.outcome.table.get(place).is_some_and(|&of| usize::from(of) == outcome);
        if is { 1.0 } else { 0.0 }
    }
}

/// Builds the model of a robot's hidden factors and sensors, and calls `then` with it.
fn with_own_model<T>(role: &Role<'_>, target: Option<u8>, then: impl FnOnce(&Model) -> T) -> Option<T> {
    let mut dynamics = Vec::<_, MAX_FACTORS>::new();
    for factor in 0..role.factors.len() {
        dynamics.push(Dynamics::new(role, target, factor)).ok()?;
    }
    let mut factors = Vec::<_, MAX_FACTORS>::new();
    for (dynamics, factor) in dynamics.iter().zip(role.factors) {
        let others = dynamics.conditions.get(1..)?;
        let factor = Factor::try_new(dynamics, dynamics.shape()?, factor.prior)?;
        factors.push(factor.coupled_to(others).controlled_by(Control::Shared(0))).ok()?;
    }
    let mut readings = Vec::<_, MAX_SENSORS>::new();
    for sensor in role.sensors {
        readings.push(Reading::new(role, &sensor.reads, sensor.accuracy)?).ok()?;
    }
    let indifferent = [0.0; MAX_STATES];
    let mut modalities = Vec::<_, MAX_SENSORS>::new();
    for reading in &readings {
        let preference = indifferent.get(..reading.shape.values())?;
        modalities.push(Modality::try_new(reading, reading.shape, &reading.factors, preference)?).ok()?;
    }
    Some(then(&Model::try_new(&factors, &modalities).ok()?))
}

/// The belief over a role's hidden factors before the first reading.
pub(super) fn prior<const S: usize>(role: &Role<'_>) -> Option<Beliefs<S, 1>> {
    with_own_model(role, None, |model| Beliefs::try_prior(model).ok())?
}

/// The least probability of every state in the belief, so that no reading is ever impossible.
const DOUBT: f32 = 1e-4;

/// Updates the belief by an operator that has ended and the readings after it; returns F of the
/// readings.
pub(super) fn track<const S: usize>(
    beliefs: &mut Beliefs<S, 1>,
    role: &Role<'_>,
    ended: Option<Command>,
    readings: &[Option<u8>],
) -> Result<f32, ObservationError> {
    let target = ended.and_then(|command| command.target);
    let updated = with_own_model(role, target, |model| {
        if let Some(command) = ended {
            beliefs.predict(model, &[Some(command.operator)])?;
        }
        let mut doubt = *beliefs;
        for (factor, of) in role.factors.iter().enumerate() {
            doubt.set(model, factor, [1.0; MAX_STATES].get(..of.states.len()).unwrap_or(&[]))?;
        }
        beliefs.mix(&doubt, DOUBT);
        let mut evidence = [Evidence::Missing; MAX_SENSORS];
        for (evidence, reading) in evidence.iter_mut().zip(readings) {
            *evidence = reading.map_or(Evidence::Missing, |outcome| Evidence::Outcome(usize::from(outcome)));
        }
        let update = beliefs.update(model, evidence.get(..role.sensors.len()).unwrap_or(&[]))?;
        Ok(update.free_energy)
    });
    // Checked tables are a model.
    updated.unwrap_or(Ok(0.0))
}

/// Every operator as a policy of one step, by its code.
const EACH_ONCE: &[Policy; MAX_OPERATORS] = &{
    let (mut policies, mut code) = ([Policy::EMPTY; MAX_OPERATORS], 0);
    while code < MAX_OPERATORS {
        policies[code] = Policy::of(&[code as Action]);
        code += 1;
    }
    policies
};

/// Something for each semantic state of each robot.
pub(super) type Rows<const S: usize, const N: usize> = [[f32; S]; N];

/// What a joint decision is made from.
pub(super) struct Question<'q, 'a, const S: usize, const N: usize> {
    pub(super) tables: &'a Tables<'a>,
    pub(super) own: usize,
    /// q(s) of each robot.
    pub(super) beliefs: &'q Rows<S, N>,
    /// C of each robot.
    pub(super) preferences: &'q Rows<S, N>,
    /// The outcome of the states together, while it is possible.
    pub(super) outcome: Option<&'a JointOutcome<'a>>,
}

/// q(s) of all robots: the own, and those that were announced.
pub(super) fn believed<const S: usize, const N: usize>(
    tables: &Tables<'_>,
    (own, states): (usize, &[f32]),
    announced: &[Option<usize>; N],
) -> Option<Rows<S, N>> {
    let mut rows = None;
    with_model(tables, None, None, &mut |model| rows = believed_in(model, (own, states), announced))?;
    rows
}

fn believed_in<const S: usize, const N: usize>(
    model: &Model,
    (own, states): (usize, &[f32]),
    announced: &[Option<usize>; N],
) -> Option<Rows<S, N>> {
    let mut beliefs = Beliefs::<S, N>::try_prior(model).ok()?;
    let robots = model.factors().len();
    beliefs.set(model, own, states.get(..model.factors().get(own)?.states())?).ok()?;
    for (robot, announced) in announced.iter().enumerate().take(robots) {
        if let Some(state) = announced {
            // A message is read like a sensor; the flat prior leaves no outcome impossible that the
            // sensor can read.
            let _ = beliefs.observe(model, robot, Evidence::Outcome(*state));
        }
    }
    let mut rows = [[0.0; S]; N];
    for (robot, row) in rows.iter_mut().enumerate() {
        crate::math::assign(row, beliefs.part(model, robot));
    }
    Some(rows)
}

impl<const S: usize, const N: usize> Question<'_, '_, S, N> {
    /// Gives ln E - γ G of these joint policies to `note`, one after the other.
    pub(super) fn scores(&self, policies: impl Iterator<Item = u16> + Clone, note: &mut dyn FnMut(f32)) {
        // There may be room for more robots than the team has; the outcome, which comes after the
        // robots, keeps its own preference.
        let wanted = self.preferences.get(..self.tables.robots()).unwrap_or(self.preferences);
        with_model(self.tables, None, self.outcome, &mut |model| {
            self.each(model, wanted, policies.clone(), &mut |evaluation| {
                note(evaluation.scores().first().copied().unwrap_or(f32::NEG_INFINITY));
            });
        });
    }

    /// Gives -G of these joint policies by what this robot itself prefers: its own states, and the
    /// outcome. What the teammates prefer they say themselves.
    pub(super) fn own_values(&self, policies: impl Iterator<Item = u16> + Clone, note: &mut dyn FnMut(f32)) {
        let wanted = self.preferences.get(self.own..=self.own).unwrap_or(&[]);
        with_model(self.tables, Some(self.own), self.outcome, &mut |model| {
            self.each(model, wanted, policies.clone(), &mut |evaluation| {
                note(
                    evaluation
                        .terms()
                        .first()
                        .map_or(f32::NEG_INFINITY, |terms| -terms.expected_free_energy()),
                );
            });
        });
    }

    /// Algorithm 2 for joint policies, one after the other, with these preferences for the first
    /// modalities of the model.
    fn each(
        &self,
        model: &Model,
        wanted: &[[f32; S]],
        policies: impl Iterator<Item = u16>,
        note: &mut dyn FnMut(&Evaluation<S, N, 1, 1>),
    ) {
        let Some(beliefs) = self.beliefs(model) else { return };
        let states = model.modalities().iter().map(|modality| modality.preference().len());
        let preferences: Vec<&[f32], MAX_TEAM> =
            up_to(wanted.iter().zip(states).map(|(values, states)| values.get(..states).unwrap_or(&[])));
        let scoring = Scoring { precision: self.tables.precision(), ..Scoring::DEFAULT };
        let mut evaluation = Evaluation::new();
        for policy in policies {
            let (mut sequences, mut habits) = (Vec::<&[Policy], MAX_TEAM>::new(), Vec::<_, MAX_TEAM>::new());
            for (robot, role) in self.tables.roles().iter().enumerate() {
                let part = usize::from(self.tables.part(policy, robot));
                // There is room for every robot of the team.
                let _ = sequences.push(EACH_ONCE.get(part..=part).unwrap_or(&[]));
                let _ = habits.push([role.operators.get(part).map_or(0.0, |operator| operator.habit)]);
            }
            let ln_e: Vec<&[f32], MAX_TEAM> = up_to(habits.iter().map(<[f32; 1]>::as_slice));
            let candidates = Candidates { habits: Habits::PerSequence(&ln_e), ..Candidates::all(&sequences) };
            let problem =
                Problem { preferences: &preferences, ..Problem::new(model, &beliefs, candidates, scoring) };
            if evaluation.evaluate(&problem).is_ok() {
                note(&evaluation);
            }
        }
    }

    fn beliefs(&self, model: &Model) -> Option<Beliefs<S, N>> {
        let mut beliefs = Beliefs::<S, N>::try_prior(model).ok()?;
        for (robot, (row, factor)) in self.beliefs.iter().zip(model.factors()).enumerate() {
            beliefs.set(model, robot, row.get(..factor.states())?).ok()?;
        }
        Some(beliefs)
    }
}

/// Builds the model of a decision, and calls `then` with it: a factor and a modality for each
/// robot, or only the modality of one, and the outcome.
fn with_model(
    tables: &Tables<'_>,
    only: Option<usize>,
    outcome: Option<&JointOutcome<'_>>,
    then: &mut dyn FnMut(&Model),
) -> Option<()> {
    let roles = tables.roles();
    let mut parts = Vec::<_, MAX_TEAM>::new();
    for role in roles {
        let states = role.states.names.len();
        let reads = role.sensors.iter().find(|sensor| sensor.reads == Reads::State);
        let accuracy = reads.map_or(Accuracy::Even(1.0), |sensor| sensor.accuracy);
        let prior = [1.0 / states as f32; MAX_STATES];
        let part = (Brought(role), Noise::new(accuracy, states)?, Shape::new(states, &[states])?, prior);
        parts.push(part).ok()?;
    }
    const NUMBERS: [usize; MAX_TEAM] = [0, 1, 2, 3, 4, 5, 6, 7];
    let mut states = Vec::<_, MAX_TEAM>::new();
    for role in roles {
        states.push(role.states.names.len()).ok()?;
    }
    let together = outcome.map(|outcome| Together { outcome, tables });
    let indifferent = [0.0; MAX_STATES];
    let (mut factors, mut modalities) = (Vec::<_, MAX_TEAM>::new(), Vec::<_, { MAX_TEAM + 1 }>::new());
    for ((brought, noise, shape, prior), number) in parts.iter().zip(NUMBERS.chunks(1)) {
        let states = shape.values();
        factors.push(Factor::try_new(brought, *shape, prior.get(..states)?)?).ok()?;
        if only.is_some_and(|only| number != [only]) {
            continue;
        }
        let modality = Modality::try_new(noise.form(), *shape, number, indifferent.get(..states)?)?;
        modalities.push(modality).ok()?;
    }
    if let Some(together) = &together {
        let shape = Shape::new(together.outcome.names.len(), &states)?;
        let numbers = NUMBERS.get(..roles.len())?;
        modalities.push(Modality::try_new(together, shape, numbers, together.outcome.preference)?).ok()?;
    }
    then(&Model::try_new(&factors, &modalities).ok()?);
    Some(())
}
