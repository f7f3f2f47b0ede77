//! The truth: the hidden states of all robots, what their sensors read of them, and which actions
//! fail.

use crate::random::{Random, Stream};
use iibt_core::iibt::table::{Accuracy, Command, MAX_SENSORS, Reads, Role, Tables};

/// The true world, as far as the tables leave it open: by robot, then by factor or operator.
#[derive(Clone, Debug, PartialEq)]
pub struct Truth {
    /// The state of each factor at the start; `None` is drawn from its prior.
    pub start: Vec<Vec<Option<u8>>>,
    /// The ticks that each operator takes.
    pub ticks: Vec<Vec<u32>>,
    /// The probability that each operator fails.
    pub fails: Vec<Vec<f64>>,
    /// The probability that a reading is wrong, in place of the sensors' tables.
    pub wrong: Option<f64>,
    /// The goals of the task.
    pub goals: Vec<Goal>,
}

/// A factor of a robot that is to be in one of some states.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Goal {
    /// The robot.
    pub robot: usize,
    /// Its factor.
    pub factor: usize,
    /// The states.
    pub states: Vec<u8>,
}

impl Truth {
    /// The world as the tables have it: every operator takes a tick.
    #[must_use]
    pub fn of(tables: &Tables<'_>) -> Self {
        let roles = || tables.roles().iter();
        let fails = |role: &Role<'_>| {
            role.operators.iter().map(|operator| 1.0 - f64::from(operator.success)).collect()
        };
        Self {
            start: roles().map(|role| vec![None; role.factors.len()]).collect(),
            ticks: roles().map(|role| vec![1; role.operators.len()]).collect(),
            fails: roles().map(fails).collect(),
            wrong: None,
            goals: Vec::new(),
        }
    }
}

/// The world while a task is flown.
#[derive(Debug)]
pub(crate) struct TaskWorld<'t> {
    tables: &'t Tables<'t>,
    truth: &'t Truth,
    states: Vec<Vec<usize>>,
    /// Each robot's command and the ticks that remain.
    doing: Vec<Option<(Command, u32)>>,
    readings: Vec<Random>,
    failures: Vec<Random>,
}

impl<'t> TaskWorld<'t> {
    pub(crate) fn new(tables: &'t Tables<'t>, truth: &'t Truth, seed: u64) -> Self {
        let team = tables.robots();
        // A stream for each robot, so that one robot's actions leave the other's luck as it was.
        let streams = |purpose| {
            let stream = |robot| Random::of(seed.wrapping_mul(team as u64).wrapping_add(robot), purpose);
            (0..team as u64).map(stream).collect::<Vec<_>>()
        };
        let mut starts = streams(Stream::Start);
        let start = |(robot, role): (usize, &Role<'_>)| {
            let factors = role.factors.iter().zip(&truth.start[robot]);
            let draw = |(factor, start): (&iibt_core::iibt::table::HiddenFactor<'_>, &Option<u8>)| match start
            {
                Some(state) => usize::from(*state),
                None => drawn(&mut starts[robot], factor.prior.iter().copied()),
            };
            factors.map(draw).collect()
        };
        Self {
            tables,
            truth,
            states: tables.roles().iter().enumerate().map(start).collect(),
            doing: vec![None; team],
            readings: streams(Stream::Reading),
            failures: streams(Stream::Action),
        }
    }

    /// The true state of a robot's factor.
    pub(crate) fn state(&self, robot: usize, factor: usize) -> usize {
        self.states[robot][factor]
    }

    /// The true semantic state of a robot.
    pub(crate) fn semantic(&self, robot: usize) -> usize {
        let role = self.role(robot);
        role.states.of(role.factors, |factor| self.state(robot, factor))
    }

    pub(crate) fn is_busy(&self, robot: usize) -> bool {
        self.doing[robot].is_some()
    }

    /// Whether all goals are reached.
    pub(crate) fn is_accomplished(&self) -> bool {
        self.truth.goals.iter().all(|goal| self.is_reached(goal))
    }

    pub(super) fn tables(&self) -> &'t Tables<'t> {
        self.tables
    }

    /// The goals that are not reached, in words.
    pub(super) fn open_goals(&self) -> Vec<String> {
        let open = self.truth.goals.iter().filter(|goal| !self.is_reached(goal));
        let line = open.map(|goal| {
            let role = self.role(goal.robot);
            let factor = &role.factors[goal.factor];
            let state = factor.states[self.state(goal.robot, goal.factor)];
            format!("{}: \"{}\" is in truth \"{state}\"", role.name, factor.name)
        });
        line.collect()
    }

    fn is_reached(&self, goal: &Goal) -> bool {
        goal.states.contains(&(self.state(goal.robot, goal.factor) as u8))
    }

    /// The readings of a robot's sensors. Drawn in every tick, so that the luck of a tick does not
    /// depend on what was done before it.
    pub(crate) fn read(&mut self, robot: usize) -> [Option<u8>; MAX_SENSORS] {
        let mut readings = [None; MAX_SENSORS];
        let role = self.role(robot);
        for (reading, sensor) in readings.iter_mut().zip(role.sensors) {
            let state = |factor: usize| self.states[robot][factor];
            let (is, outcomes) = match &sensor.reads {
                Reads::Factor(factor) => {
                    let factor = usize::from(*factor);
                    (state(factor), role.factors[factor].states.len())
                }
                Reads::State => (role.states.of(role.factors, state), role.states.names.len()),
                Reads::Labels(labels) => (labels.of(role.factors, state), labels.names.len()),
            };
            let chance = &mut self.readings[robot];
            let even = |chance: &mut Random, wrong: f64| {
                let (errs, by) = (chance.bernoulli(wrong), chance.below(outcomes - 1));
                if errs { (is + 1 + by) % outcomes } else { is }
            };
            let read = match (self.truth.wrong, sensor.accuracy) {
                (Some(wrong), _) => even(chance, wrong),
                (None, Accuracy::Even(right)) => even(chance, 1.0 - f64::from(right)),
                (None, Accuracy::Table(table)) => {
                    drawn(chance, table.iter().skip(is).step_by(outcomes).copied())
                }
            };
            *reading = Some(read as u8);
        }
        readings
    }

    /// Begins an operator; one under way goes on instead.
    pub(crate) fn begin(&mut self, robot: usize, command: Command) {
        let ticks = self.truth.ticks[robot][usize::from(command.operator)];
        self.doing[robot].get_or_insert((command, ticks));
    }

    /// Advances the world by a tick.
    pub(crate) fn pass(&mut self) {
        for robot in 0..self.tables.robots() {
            let Some((command, left)) = self.doing[robot] else { continue };
            self.doing[robot] = (left > 1).then_some((command, left - 1));
            if left <= 1 {
                self.carry_out(robot, command);
            }
        }
    }

    /// Applies the effects of an operator that succeeds.
    fn carry_out(&mut self, robot: usize, command: Command) {
        let number = usize::from(command.operator);
        if self.failures[robot].bernoulli(self.truth.fails[robot][number]) {
            return;
        }
        let operator = &self.role(robot).operators[number];
        let is = |of: Option<u8>, factor: usize| match of.map(usize::from) {
            None => Some(self.state(robot, factor)),
            // A teammate at work holds nothing still.
            Some(teammate) if self.doing[teammate].is_some() => Some(usize::MAX),
            Some(teammate) => Some(self.state(teammate, factor)),
        };
        let after = |factor| {
            operator.becomes(factor, command.target, &is).unwrap_or_else(|| self.state(robot, factor))
        };
        self.states[robot] = (0..self.states[robot].len()).map(after).collect();
    }

    fn role(&self, robot: usize) -> &'t Role<'t> {
        &self.tables.roles()[robot]
    }
}

/// One of several outcomes, drawn by their probabilities.
fn drawn(chance: &mut Random, probabilities: impl Iterator<Item = f32>) -> usize {
    let mut left = 1.0;
    let mut last = 0;
    for (outcome, p) in probabilities.map(f64::from).enumerate() {
        if p > 0.0 {
            last = outcome;
            if chance.bernoulli(p / left) {
                return outcome;
            }
            left -= p;
        }
    }
    last
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outcomes_are_drawn_as_often_as_their_probabilities_say() {
        let mut chance = Random::of(3, Stream::Reading);
        let mut counts = [0; 4];
        (0..10_000).for_each(|_| counts[drawn(&mut chance, [0.5, 0.0, 0.2, 0.3].into_iter())] += 1);
        assert_eq!(counts[1], 0);
        for (count, expected) in counts.into_iter().zip([5_000i32, 0, 2_000, 3_000]) {
            assert!((count - expected).abs() < 200, "{counts:?}");
        }
        assert_eq!(drawn(&mut chance, [0.0, 1.0].into_iter()), 1);
    }
}
