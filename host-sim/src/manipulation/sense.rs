//! What a robot with a conventional tree takes for true of its place and state.

use iibt_core::iibt::Manipulation;
use iibt_core::iibt::manipulation::{Announcement, Command, Percept, Place, State};
use iibt_core::team::Peers;

/// Readings made reliable in one way or another.
#[derive(Debug)]
pub(super) enum Sense {
    /// What enough equal readings in a row have said.
    Debounced(Debounced<Place>, Debounced<State>),
    /// What the inference nodes' own belief was last sure of.
    Believed { belief: Box<Manipulation>, last: (Place, State), is_settled: bool },
}

impl Sense {
    pub(super) fn debounced(enough: u8) -> Self {
        Self::Debounced(Debounced::new(Place::Elsewhere, enough), Debounced::new(State::Free, enough))
    }

    pub(super) fn believed(belief: Manipulation) -> Self {
        let last = (Place::Elsewhere, State::Free);
        Self::Believed { belief: Box::new(belief), last, is_settled: false }
    }

    pub(super) fn perceive(&mut self, percept: Percept, peers: Peers<'_, Announcement>) {
        match self {
            Self::Debounced(place, state) => {
                place.read(percept.place);
                state.read(percept.state);
            }
            Self::Believed { belief, last, is_settled } => {
                belief.perceive(percept, peers);
                let settled = belief.settled();
                *is_settled = settled.is_some();
                *last = settled.unwrap_or(*last);
            }
        }
    }

    /// Nothing is settled until there are readings from after `begun`, if anything, has ended.
    pub(super) fn unsettle(&mut self, begun: Option<Command>) {
        match self {
            Self::Debounced(place, state) => (place.run, state.run) = (0, 0),
            Self::Believed { belief, is_settled, .. } => {
                *is_settled = false;
                if let Some(command) = begun {
                    belief.act(command);
                }
            }
        }
    }

    pub(super) fn is_settled(&self) -> bool {
        match self {
            Self::Debounced(place, state) => place.is_settled() && state.is_settled(),
            Self::Believed { is_settled, .. } => *is_settled,
        }
    }

    /// The place that was settled last.
    pub(super) fn place(&self) -> Place {
        match self {
            Self::Debounced(place, _) => place.value,
            Self::Believed { last, .. } => last.0,
        }
    }

    /// The state that was settled last.
    pub(super) fn state(&self) -> State {
        match self {
            Self::Debounced(_, state) => state.value,
            Self::Believed { last, .. } => last.1,
        }
    }
}

/// A value that changes when enough readings in a row agree on another.
#[derive(Clone, Copy, Debug)]
pub(super) struct Debounced<T> {
    value: T,
    last: Option<T>,
    /// How many equal readings there were in a row.
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
