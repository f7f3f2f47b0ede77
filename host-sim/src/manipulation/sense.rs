//! The place and state that a robot with a conventional tree accepts from its readings.

use super::tables::{ELSEWHERE, FREE, PLACE};
use crate::task::HostTask;
use iibt_core::iibt::table::{Command, Percept, Tables};

/// A filter of readings.
#[derive(Debug)]
pub(super) enum Sense<'t> {
    /// The value that enough equal readings in a row have confirmed.
    Debounced(Debounced<u8>, Debounced<u8>),
    /// The value that the inference nodes' belief was last sure of.
    Believed(Box<Believed<'t>>),
}

/// The belief, and the place and semantic state that it was last sure of.
#[derive(Debug)]
pub(super) struct Believed<'t> {
    tables: &'t Tables<'t>,
    robot: usize,
    belief: HostTask<'t>,
    last: (u8, u8),
    is_settled: bool,
}

impl<'t> Believed<'t> {
    fn perceive(&mut self, percept: &Percept) {
        self.belief.sense(percept);
        self.is_settled = self.belief.is_settled();
        if self.is_settled {
            let sure = |factor| self.belief.sure(factor).unwrap_or(0);
            let role = &self.tables.roles()[self.robot];
            self.last = (sure(PLACE.into()) as u8, role.states.of(role.factors, sure) as u8);
        }
    }
}

impl<'t> Sense<'t> {
    pub(super) fn debounced(enough: u8) -> Self {
        Self::Debounced(Debounced::new(ELSEWHERE, enough), Debounced::new(FREE, enough))
    }

    pub(super) fn believed(tables: &'t Tables<'t>, robot: usize, belief: HostTask<'t>) -> Self {
        let last = (ELSEWHERE, FREE);
        Self::Believed(Box::new(Believed { tables, robot, belief, last, is_settled: false }))
    }

    pub(super) fn perceive(&mut self, percept: &Percept) {
        match self {
            Self::Debounced(place, state) => {
                let [read_place, read_state, ..] = percept.readings;
                place.read(read_place);
                state.read(read_state);
            }
            Self::Believed(of) => of.perceive(percept),
        }
    }

    /// Unsettles place and state, until there are readings after the end of `begun`.
    pub(super) fn unsettle(&mut self, begun: Option<Command>) {
        match self {
            Self::Debounced(place, state) => (place.run, state.run) = (0, 0),
            Self::Believed(of) => {
                of.is_settled = false;
                if let Some(command) = begun {
                    of.belief.begin(command);
                }
            }
        }
    }

    pub(super) fn is_settled(&self) -> bool {
        match self {
            Self::Debounced(place, state) => place.is_settled() && state.is_settled(),
            Self::Believed(of) => of.is_settled,
        }
    }

    /// The place that was settled last.
    pub(super) fn place(&self) -> u8 {
        match self {
            Self::Debounced(place, _) => place.value,
            Self::Believed(of) => of.last.0,
        }
    }

    /// The state that was settled last.
    pub(super) fn state(&self) -> u8 {
        match self {
            Self::Debounced(_, state) => state.value,
            Self::Believed(of) => of.last.1,
        }
    }
}

/// A value that changes when enough readings in a row agree on another.
#[derive(Clone, Copy, Debug)]
pub(super) struct Debounced<T> {
    value: T,
    last: Option<T>,
    /// The number of equal readings in a row.
    run: u8,
    enough: u8,
}

impl<T: Copy + PartialEq> Debounced<T> {
    fn new(value: T, enough: u8) -> Self {
        Self { value, last: None, run: 0, enough: enough.max(1) }
    }

    fn read(&mut self, reading: Option<T>) {
        let Some(reading) = reading else { return };
        let again = self.run > 0 && self.last == Some(reading);
        self.run = if again { self.run.saturating_add(1) } else { 1 };
        self.last = Some(reading);
        if self.is_settled() {
            self.value = reading;
        }
    }

    fn is_settled(&self) -> bool {
        self.run >= self.enough
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_changes_when_enough_readings_in_a_row_agree() {
        let mut value = Debounced::new(0, 3);
        let mut after = |reading| {
            value.read(reading);
            (value.value, value.is_settled())
        };
        let readings = [Some(1), Some(1), Some(2), Some(1), None, Some(1), Some(1), Some(2)];
        let expected =
            [(0, false), (0, false), (0, false), (0, false), (0, false), (0, false), (1, true), (1, false)];
        assert_eq!(readings.map(&mut after), expected);
    }
}
