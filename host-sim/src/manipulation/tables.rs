//! The paper's section 6.2 as tables: a bottle, a plate, and two robots.

use super::terms::{Order, Preset};
use bumpalo::Bump;
use iibt_core::iibt::table::{
    Accuracy, Aim, Effect, Fact, Given, HiddenFactor, Holds, JointOutcome, Labels, Operator, Postcondition,
    Reads, Remedy, Role, Sensor, Tables, TablesError, To, Wish,
};

/// The number of robots. Robot 0 handles the bottle, robot 1 the plate.
pub const TEAM: usize = 2;

/// The hidden factor where a robot is.
pub const PLACE: u8 = 0;
/// At none of the goals.
pub const ELSEWHERE: u8 = 0;
/// Goal A, where the bottle is.
pub const GOAL_A: u8 = 1;
/// Goal B, where the plate is.
pub const GOAL_B: u8 = 2;
/// Goal C, where the robots meet.
pub const GOAL_C: u8 = 3;

/// The hidden factor what a robot holds.
pub const GRIP: u8 = 1;
/// The robot holds nothing.
pub const EMPTY: u8 = 0;
/// The robot holds its object.
pub const HOLDS: u8 = 1;
/// The robot has placed its object.
pub const PLACED: u8 = 2;

/// The semantic state of a robot that is where its object is, s^i (table 4).
pub const LOC: u8 = 0;
/// The robot holds its object.
pub const HOLD: u8 = 1;
/// The robot has placed its object.
pub const PUT: u8 = 2;
/// None of these.
pub const FREE: u8 = 3;

/// moveTo(place), an operator of U; joint policy π has the number 4 a1 + a2.
pub const MOVE_TO: u8 = 0;
/// pick(object).
pub const PICK: u8 = 1;
/// place(object).
pub const PUT_DOWN: u8 = 2;
/// The operator that does nothing.
pub const IDLE: u8 = 3;

/// The aim IsHolding(object).
pub const TO_HOLD: u8 = 0;
/// The aim IsPlaced(object).
pub const TO_PLACE: u8 = 1;

/// The facts. What is not held is fetched before it is brought anywhere, so holding comes first.
const HOLDING: u8 = 0;
const AT_SOURCE: u8 = 1;
pub(super) const AT_MEETING: u8 = 2;
const AT_TARGET: u8 = 3;
const IS_PLACED: u8 = 4;
const HAS_OBJECT: u8 = 5;
const PEER_IDLE: u8 = 6;
const PEER_HAS: u8 = 7;
const PEER_THERE: u8 = 8;
const PEER_HOLDS: u8 = 9;

/// C of a teammate that is to be free.
const FREED: &[f32] = &[0.0, 0.0, 0.0, 1.0];

/// Equation 8 with its columns normalised: 0.9 of 0.975. As printed they sum to 0.975 and are no
/// distributions.
pub const SENSOR: f32 = 0.9 / 0.975;

/// An action, and the probability of its success by which a robot judges the outcome.
const ACTION: Operator = Operator { success: 0.9, ..Operator::IDLE };

/// A robot that takes its object from `source`, acts when the facts `turn` hold, and can place it
/// by `places`.
macro_rules! role {
    ($name:literal, $source:expr, $peer:expr, [$($turn:ident),*], $labels:expr, $places:expr, $outcome:expr, $wish:expr) => {
        Role {
            name: $name,
            states: Labels { names: &["loc", "hold", "place", "free"], factors: &[GRIP, PLACE], table: $labels },
            sensors: &[
                Sensor::even("localiser", Reads::Factor(PLACE), SENSOR),
                Sensor::even("state", Reads::State, SENSOR),
            ],
            operators: &[
                Operator {
                    name: "moveTo",
                    requires: &[$($turn),*],
                    forbids: &[AT_TARGET],
                    brings: Postcondition::Reset(LOC, 1.0, FREE),
                    effects: &[Effect { given: &[], factor: PLACE, to: To::Target }],
                    ..ACTION
                },
                Operator {
                    name: "pick",
                    requires: &[AT_SOURCE, $($turn),*],
                    forbids: &[HOLDING],
                    brings: Postcondition::Reset(HOLD, 1.0, FREE),
                    effects: &[Effect {
                        given: &[Given::own(GRIP, EMPTY), Given::own(PLACE, $source)],
                        ..Effect::set(GRIP, HOLDS)
                    }],
                    ..ACTION
                },
                Operator {
                    name: "place",
                    requires: &[AT_MEETING, HOLDING, PEER_THERE, PEER_HOLDS, PEER_IDLE],
                    forbids: &[IS_PLACED],
                    brings: Postcondition::Reset(PUT, 1.0, FREE),
                    effects: $places,
                    ..ACTION
                },
                Operator { brings: Postcondition::Reset(FREE, 1.0, FREE), ..Operator::IDLE },
            ],
            idle: IDLE,
            facts: &[
                Fact::sure("IsHolding", GRIP, &[HOLDS]),
                Fact::sure("IsReached(source)", PLACE, &[$source]),
                Fact::sure("IsReached(goal C)", PLACE, &[GOAL_C]),
                Fact { name: "IsReached(target)", holds: Holds::AtTarget { factor: PLACE } },
                Fact::sure("IsPlaced", GRIP, &[PLACED]),
                Fact::sure("has its object", GRIP, &[HOLDS, PLACED]),
                Fact::doing("teammate idle", $peer, &[IDLE]),
                Fact::announced("teammate has its object", $peer, GRIP, &[HOLDS, PLACED]),
                Fact::announced("teammate at goal C", $peer, PLACE, &[GOAL_C]),
                Fact::announced("teammate holds", $peer, GRIP, &[HOLDS]),
            ],
            // f_L: every precondition that is missing is wanted above all else, l = max(C) + 1.
            // Nothing that a robot can do makes its teammate free or ready, so it wants to be free
            // itself until then.
            remedies: &[
                Remedy::above_all(HOLDING, HOLD),
                Remedy { target: Some($source), ..Remedy::above_all(AT_SOURCE, LOC) },
                Remedy { target: Some(GOAL_C), ..Remedy::above_all(AT_MEETING, LOC) },
                Remedy::above_all(IS_PLACED, PUT),
                Remedy::above_all(PEER_IDLE, FREE),
                Remedy::above_all(PEER_HAS, FREE),
                Remedy::above_all(PEER_THERE, FREE),
                Remedy::above_all(PEER_HOLDS, FREE),
            ],
            aims: &[
                Aim {
                    teammates: $wish,
                    target: Some($source),
                    ..Aim::new("hold", &[HAS_OBJECT], &[0.0, 1.0, 0.0, 0.0])
                },
                Aim {
                    teammates: $wish,
                    target: Some(GOAL_C),
                    ..Aim::new("place", &[IS_PLACED], &[0.0, 0.0, 1.0, 0.0])
                },
            ],
            outcome: $outcome,
            ..Role::of(&[
                HiddenFactor::known("place", &["elsewhere", "goal A", "goal B", "goal C"]),
                HiddenFactor::known("grip", &["empty", "holds", "placed"]),
            ])
        }
    };
}

/// The semantic states of empty, holding and placed at the four places.
const BOTTLE: &[u8] = &[FREE, LOC, FREE, FREE, HOLD, HOLD, HOLD, HOLD, PUT, PUT, PUT, PUT];
const PLATE: &[u8] = &[FREE, FREE, LOC, FREE, HOLD, HOLD, HOLD, HOLD, PUT, PUT, PUT, PUT];

/// The bottle is placed on the plate that robot 1 holds still at goal C.
const ON_PLATE: &[Effect] = &[Effect {
    given: &[
        Given::of(1, GRIP, HOLDS),
        Given::of(1, PLACE, GOAL_C),
        Given::own(GRIP, HOLDS),
        Given::own(PLACE, GOAL_C),
    ],
    ..Effect::set(GRIP, PLACED)
}];

/// The result (equation 9): null, success when robot 0 has placed and robot 1 has kept still,
/// failure when that has not.
const RESULT: Option<JointOutcome> = Some(JointOutcome {
    names: &["null", "success", "failure"],
    preference: &[0.0, 1.0, 0.0],
    table: &[0, 0, 0, 0, 0, 0, 0, 0, 2, 2, 2, 1, 0, 0, 0, 0],
    possible: Some(PUT_DOWN),
});

/// One after the other, as published: robot 0 is to be free and to have its bottle before robot 1
/// begins.
pub const IN_TURN: [Role; TEAM] = [
    role!("R1", GOAL_A, 1, [PEER_IDLE], BOTTLE, ON_PLATE, RESULT, Wish::Rows(&[&[], FREED])),
    role!("R2", GOAL_B, 0, [PEER_IDLE, PEER_HAS], PLATE, &[], None, Wish::Rows(&[FREED, &[]])),
];

/// Both fetch at once.
pub const TOGETHER: [Role; TEAM] = [
    role!("R1", GOAL_A, 1, [], BOTTLE, ON_PLATE, RESULT, Wish::AsAnnounced),
    role!("R2", GOAL_B, 0, [], PLATE, &[], None, Wish::AsAnnounced),
];

/// The tables with these numbers in them.
///
/// # Errors
/// [`TablesError`] when a number is out of its range.
pub fn tables(arena: &Bump, order: Order, preset: Preset) -> Result<Tables<'_>, TablesError> {
    let roles = match order {
        Order::InTurn => &IN_TURN,
        Order::Together => &TOGETHER,
    };
    let sensor = |sensor: &Sensor<'static>| Sensor { accuracy: Accuracy::Even(preset.sensor), ..*sensor };
    let brings = |operator: &Operator<'static>| match operator.brings {
        Postcondition::Reset(state, _, other) => {
            Operator { brings: Postcondition::Reset(state, preset.success, other), ..*operator }
        }
        _ => *operator,
    };
    let role = |role: &Role<'static>| Role {
        sensors: arena.alloc_slice_fill_iter(role.sensors.iter().map(sensor)),
        operators: arena.alloc_slice_fill_iter(role.operators.iter().map(brings)),
        ..*role
    };
    Tables::try_new(arena.alloc_slice_fill_iter(roles.iter().map(role)))?.with_precision(preset.precision)
}
