//! What a robot believes of its own body: where it is and what it holds.

use super::deed::{Command, Deed, STATES, State};
use super::mission::Place;
use super::model::{GRIPS, Own, PLACES, state};
use crate::actions::Action;
use crate::inference::{Beliefs, Evidence, ObservationError};
use crate::math;

const PLACE: usize = 0;
const GRIP: usize = 1;

/// q over place and grip, the last action's effect and every reading included.
#[derive(Clone, Debug)]
pub(super) struct Tracking {
    own: Own,
    beliefs: Beliefs<PLACES, 2>,
    surprise: Result<f32, ObservationError>,
}

impl Tracking {
    /// How likely a robot takes itself to be in any state at all, so that no reading is ever impossible.
    const DOUBT: f32 = 1e-4;

    pub(super) fn new(own: Own) -> Self {
        let beliefs =
            own.with_model(|model| Beliefs::try_prior(model).ok()).flatten().unwrap_or(Beliefs::EMPTY);
        Self { own, beliefs, surprise: Ok(0.0) }
    }

    /// Takes in an action that has ended and the readings after it.
    pub(super) fn update(&mut self, ended: Option<Command>, place: Option<Place>, state: Option<State>) {
        if let Some(Command { deed: Deed::MoveTo, place }) = ended {
            self.own.to = place;
        }
        let (beliefs, surprise) = (&mut self.beliefs, &mut self.surprise);
        self.own.with_model(|model| {
            if let Some(command) = ended {
                let _ = beliefs.predict(model, &[Some(command.deed as Action)]);
            }
            let mut doubt = *beliefs;
            let _ = doubt.set(model, PLACE, &[1.0; PLACES]);
            let _ = doubt.set(model, GRIP, &[1.0; GRIPS]);
            beliefs.mix(&doubt, Self::DOUBT);
            let place = place.map_or(Evidence::Missing, |place| Evidence::Outcome(place as usize));
            let state = state.map_or(Evidence::Missing, |state| Evidence::Outcome(state as usize));
            *surprise = beliefs.update(model, &[place, state]).map(|update| update.free_energy);
        });
    }

    /// F of the last readings, in nats.
    pub(super) const fn surprise(&self) -> Result<f32, ObservationError> {
        self.surprise
    }

    /// q(place).
    pub(super) fn places(&self) -> [f32; PLACES] {
        self.copy(PLACE)
    }

    /// q(grip).
    pub(super) fn grips(&self) -> [f32; GRIPS] {
        self.copy(GRIP)
    }

    fn copy<const N: usize>(&self, factor: usize) -> [f32; N] {
        let mut copy = [0.0; N];
        self.own.with_model(|model| math::assign(&mut copy, self.beliefs.of(model, factor)));
        copy
    }

    /// q(s) over the semantic states: what place and grip amount to.
    pub(super) fn states(&self) -> [f32; STATES] {
        let (places, grips) = (self.places(), self.grips());
        let mut states = [0.0; STATES];
        for (grip, q) in grips.iter().enumerate() {
            for (place, p) in places.iter().enumerate() {
                if let Some(sum) = states.get_mut(state(grip, place, self.own.source) as usize) {
                    *sum += q * p;
                }
            }
        }
        states
    }
}
