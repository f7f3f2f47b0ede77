//! The models behind a robot's belief and behind a decision.

use super::deed::{Deed, STATES, State};
use super::mission::{Ending, Place, Preset};
use crate::actions::Action;
use crate::inference::{
    Control, Factor, IdentityNoise, Likelihood, Modality, Model, OutcomeTable, Shape, Transition,
};

/// How many places there are.
pub(super) const PLACES: usize = Place::ALL.len();

/// The grip is empty.
pub(super) const EMPTY: usize = 0;
/// The object is in the grip.
pub(super) const HOLDS: usize = 1;
/// The object was placed.
pub(super) const PLACED: usize = 2;
/// How many states the grip has.
pub(super) const GRIPS: usize = 3;

/// How likely an action is taken to succeed, when the robot works out what came of it.
const RELIABILITY: f32 = 0.9;

/// How many outcomes a result has: success, failure, null, and one that is not used (equation 9).
pub const RESULTS: usize = 4;

/// C of the result: success is wanted (the third row of equation 10).
pub const RESULT_PREFERENCE: [f32; RESULTS] = [1.0, 0.0, 0.0, 0.0];

/// The semantic state that a grip at a place amounts to.
pub(super) const fn state(grip: usize, place: usize, source: Place) -> State {
    match grip {
        PLACED => State::Place,
        HOLDS => State::Hold,
        _ if place == source as usize => State::Loc,
        _ => State::Free,
    }
}

/// B of a decision: an action brings its state about, whatever was before; when it fails the robot is free.
struct Reset {
    success: f32,
}

impl Transition for Reset {
    fn probability(&self, action: Action, next: usize, _: &[usize]) -> f32 {
        let idle = Deed::Idle as usize;
        let brought = if usize::from(action) == next { self.success } else { 0.0 };
        brought + if next == idle { 1.0 - self.success } else { 0.0 }
    }
}

/// The result of a pair of states: null, whatever they are.
static NOTHING_YET: [u8; STATES * STATES] = [0; STATES * STATES];

/// The result when robot 0 may place: success when it has and robot 1 has kept still, failure when that has not.
#[rustfmt::skip]
static FIRST_PLACES: [u8; STATES * STATES] = [
    0, 0, 0, 0,
    0, 0, 0, 0,
    2, 2, 2, 1,
    0, 0, 0, 0,
];

/// The same when it is robot 1 that may place.
#[rustfmt::skip]
static SECOND_PLACES: [u8; STATES * STATES] = [
    0, 0, 2, 0,
    0, 0, 2, 0,
    0, 0, 2, 0,
    0, 0, 1, 0,
];

/// Null, success, failure, each certain.
#[rustfmt::skip]
static COLUMNS: [f32; 3 * RESULTS] = [
    0.0, 0.0, 1.0, 0.0,
    1.0, 0.0, 0.0, 0.0,
    0.0, 1.0, 0.0, 0.0,
];

static LABELS: [u8; STATES] = [0, 1, 2, 3];

/// The result as the states of both robots determine it; `placer` is the robot whose preconditions of placing hold.
fn result(placer: Option<usize>) -> Option<OutcomeTable<'static>> {
    static BOTH: [&[u8]; 2] = [&LABELS; 2];
    let kinds = match placer {
        None => &NOTHING_YET,
        Some(0) => &FIRST_PLACES,
        Some(_) => &SECOND_PLACES,
    };
    OutcomeTable::try_new(&BOTH, kinds, &COLUMNS, RESULTS).ok()
}

/// Puts the model of a decision together for `then`: a factor and a modality for each robot, and the result.
pub(super) fn with_decision<T>(
    preset: Preset,
    placer: Option<usize>,
    then: impl FnOnce(&Model) -> T,
) -> Option<T> {
    let prior = [1.0 / STATES as f32; STATES];
    let zeros = [0.0; STATES];
    let sensor = IdentityNoise::among(preset.sensor, STATES);
    let motion = Reset { success: preset.success };
    let result = result(placer)?;
    let shape = Shape::new(STATES, &[STATES])?;
    let factors = [Factor::try_new(&motion, shape, &prior)?; 2];
    let modalities = [
        Modality::try_new(&sensor, shape, &[0], &zeros)?,
        Modality::try_new(&sensor, shape, &[1], &zeros)?,
        Modality::try_new(&result, result.shape(), &[0, 1], &RESULT_PREFERENCE)?,
    ];
    Some(then(&Model::try_new(&factors, &modalities).ok()?))
}

/// B of where a robot is: a move leads to `to`, or fails and changes nothing. Nothing else does.
struct Travel {
    to: Place,
}

impl Transition for Travel {
    fn probability(&self, action: Action, next: usize, states: &[usize]) -> f32 {
        let stays = if states.first() == Some(&next) { 1.0 } else { 0.0 };
        if action != Deed::MoveTo as Action {
            return stays;
        }
        let arrives = if next == self.to as usize { 1.0 } else { 0.0 };
        RELIABILITY * arrives + (1.0 - RELIABILITY) * stays
    }
}

/// B of what a robot holds, given where it is: it picks at its source and places at the meeting place, or fails and changes
/// nothing.
struct Grip {
    source: Place,
    meeting: Place,
}

impl Grip {
    /// What an action leads to when it succeeds.
    fn next(&self, action: Action, grip: usize, place: usize) -> usize {
        let is = |deed: Deed, from: usize, at: Place| {
            action == deed as Action && grip == from && place == at as usize
        };
        if is(Deed::Pick, EMPTY, self.source) {
            HOLDS
        } else if is(Deed::Place, HOLDS, self.meeting) {
            PLACED
        } else {
            grip
        }
    }
}

impl Transition for Grip {
    fn probability(&self, action: Action, next: usize, states: &[usize]) -> f32 {
        let &[grip, place] = states else { return 0.0 };
        let reached = if next == self.next(action, grip, place) { 1.0 } else { 0.0 };
        let stays = if next == grip { 1.0 } else { 0.0 };
        RELIABILITY * reached + (1.0 - RELIABILITY) * stays
    }
}

/// A of the semantic reading (equation 8): the state that grip and place amount to, read with even errors.
struct Reading {
    sensor: IdentityNoise,
    source: Place,
}

impl Likelihood for Reading {
    fn probability(&self, outcome: usize, states: &[usize]) -> f32 {
        let &[grip, place] = states else { return 0.0 };
        self.sensor.probability(outcome, &[state(grip, place, self.source) as usize])
    }
}

/// What a robot's own model depends on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Own {
    pub(super) sensor: f32,
    pub(super) source: Place,
    pub(super) meeting: Place,
    pub(super) ending: Ending,
    /// Where the move under way leads.
    pub(super) to: Place,
}

impl Own {
    /// Puts the model of this robot's body together for `then`: factors place and grip, which move together; modalities
    /// localiser and semantic reading.
    pub(super) fn with_model<T>(&self, then: impl FnOnce(&Model) -> T) -> Option<T> {
        let travel = Travel { to: self.to };
        let grip = Grip {
            source: self.source,
            meeting: if self.ending == Ending::Place { self.meeting } else { Place::Elsewhere },
        };
        let localiser = IdentityNoise::among(self.sensor, PLACES);
        let reading = Reading { sensor: IdentityNoise::among(self.sensor, STATES), source: self.source };
        let start = |state: usize| move |at: usize| if at == state { 1.0 } else { 0.0 };
        let places: [f32; PLACES] = core::array::from_fn(start(Place::Elsewhere as usize));
        let grips: [f32; GRIPS] = core::array::from_fn(start(EMPTY));
        let preferences = [0.0; STATES];
        let place = Shape::new(PLACES, &[PLACES])?;
        let factors = [
            Factor::try_new(&travel, place, &places)?,
            Factor::try_new(&grip, Shape::new(GRIPS, &[GRIPS, PLACES])?, &grips)?
                .coupled_to(&[0])
                .controlled_by(Control::Shared(0)),
        ];
        let modalities = [
            Modality::try_new(&localiser, place, &[0], &preferences)?,
            Modality::try_new(&reading, Shape::new(STATES, &[GRIPS, PLACES])?, &[1, 0], &preferences)?,
        ];
        Some(then(&Model::try_new(&factors, &modalities).ok()?))
    }
}
