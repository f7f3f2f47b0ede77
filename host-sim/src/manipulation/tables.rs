//! The paper's section 6.2 as tables: a bottle, a plate, and two robots.

use bumpalo::Bump;
use iibt_core::iibt::Literal;
use iibt_core::iibt::rules::Raise;
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
pub const TO_HOLD: usize = 0;
/// The aim IsPlaced(object).
pub const TO_PLACE: usize = 1;

/// The facts. What is not held is fetched before it is brought anywhere, so holding comes first.
const HOLDING: u8 = 0;
const AT_SOURCE: u8 = 1;
const AT_MEETING: u8 = 2;
const AT_TARGET: u8 = 3;
const IS_PLACED: u8 = 4;
const HAS_OBJECT: u8 = 5;
const PEER_IDLE: u8 = 6;
const PEER_HAS: u8 = 7;
const PEER_THERE: u8 = 8;
const PEER_HOLDS: u8 = 9;

const STATES: [&str; 4] = ["loc", "hold", "place", "free"];
const FREED: &[f32] = &[0.0, 0.0, 0.0, 1.0];

/// Equation 8 with its columns normalised: 0.9 of 0.975. As printed they sum to 0.975 and are no
/// distributions.
pub const SENSOR: f32 = 0.9 / 0.975;

/// The modelled probability that an action succeeds, in state inference.
const RELIABILITY: f32 = 0.9;

/// f_L: a missing precondition is preferred above everything else, l = max(C) + 1. Nothing that a
/// robot can do makes its teammate free or ready, so it wants to be free itself until then.
const fn above_all(variable: u8, state: u8, target: Option<u8>) -> Remedy {
    Remedy { missing: Literal { variable, value: true }, state, raise: Raise::AboveAll, target }
}

const fn aim(
    name: &'static str,
    done: &'static [u8],
    preference: &'static [f32],
    teammates: Wish<'static>,
    target: u8,
) -> Aim<'static> {
    Aim { name, done, preference, teammates, target: Some(target) }
}

/// A robot that takes its object from `source`, acts when the facts `turn` hold, and can place it
/// by `places`.
macro_rules! role {
    ($name:literal, $source:expr, $peer:expr, $turn:tt, $labels:expr, $places:expr, $outcome:expr, $wish:expr) => {
        Role {
            name: $name,
            factors: &[
                HiddenFactor {
                    name: "place",
                    states: &["elsewhere", "goal A", "goal B", "goal C"],
                    prior: &[1.0, 0.0, 0.0, 0.0],
                },
                HiddenFactor { name: "grip", states: &["empty", "holds", "placed"], prior: &[1.0, 0.0, 0.0] },
            ],
            states: Labels { names: &STATES, factors: &[GRIP, PLACE], table: $labels },
            sensors: &[
                Sensor { name: "localiser", reads: Reads::Factor(PLACE), accuracy: Accuracy::Even(SENSOR) },
                Sensor { name: "state", reads: Reads::State, accuracy: Accuracy::Even(SENSOR) },
            ],
            operators: &[
                Operator {
                    name: "moveTo",
                    requires: &$turn,
                    forbids: &[AT_TARGET],
                    brings: Postcondition::Reset(LOC, 1.0, FREE),
                    effects: &[Effect { given: &[], factor: PLACE, to: To::Target }],
                    success: RELIABILITY,
                    ..Operator::IDLE
                },
                Operator {
                    name: "pick",
                    requires: role!(@with AT_SOURCE, $turn),
                    forbids: &[HOLDING],
                    brings: Postcondition::Reset(HOLD, 1.0, FREE),
                    effects: &[Effect {
                        given: &[Given::own(GRIP, EMPTY), Given::own(PLACE, $source)],
                        factor: GRIP,
                        to: To::State(HOLDS),
                    }],
                    success: RELIABILITY,
                    ..Operator::IDLE
                },
                Operator {
                    name: "place",
                    requires: &[AT_MEETING, HOLDING, PEER_THERE, PEER_HOLDS, PEER_IDLE],
                    forbids: &[IS_PLACED],
                    brings: Postcondition::Reset(PUT, 1.0, FREE),
                    effects: $places,
                    success: RELIABILITY,
                    ..Operator::IDLE
                },
                Operator { brings: Postcondition::Reset(FREE, 1.0, FREE), ..Operator::IDLE },
            ],
            idle: IDLE,
            facts: &[
                Fact { name: "IsHolding", holds: Holds::Sure { factor: GRIP, states: &[HOLDS] } },
                Fact { name: "IsReached(source)", holds: Holds::Sure { factor: PLACE, states: &[$source] } },
                Fact { name: "IsReached(goal C)", holds: Holds::Sure { factor: PLACE, states: &[GOAL_C] } },
                Fact { name: "IsReached(target)", holds: Holds::AtTarget { factor: PLACE } },
                Fact { name: "IsPlaced", holds: Holds::Sure { factor: GRIP, states: &[PLACED] } },
                Fact { name: "has its object", holds: Holds::Sure { factor: GRIP, states: &[HOLDS, PLACED] } },
                Fact { name: "teammate idle", holds: Holds::Doing { robot: $peer, operators: &[IDLE] } },
                Fact {
                    name: "teammate has its object",
                    holds: Holds::Announced { robot: $peer, factor: GRIP, states: &[HOLDS, PLACED] },
                },
                Fact {
                    name: "teammate at goal C",
                    holds: Holds::Announced { robot: $peer, factor: PLACE, states: &[GOAL_C] },
                },
                Fact {
                    name: "teammate holds",
                    holds: Holds::Announced { robot: $peer, factor: GRIP, states: &[HOLDS] },
                },
            ],
            remedies: &[
                above_all(HOLDING, HOLD, None),
                above_all(AT_SOURCE, LOC, Some($source)),
                above_all(AT_MEETING, LOC, Some(GOAL_C)),
                above_all(IS_PLACED, PUT, None),
                above_all(PEER_IDLE, FREE, None),
                above_all(PEER_HAS, FREE, None),
                above_all(PEER_THERE, FREE, None),
                above_all(PEER_HOLDS, FREE, None),
            ],
            aims: &[
                aim("hold", &[HAS_OBJECT], &[0.0, 1.0, 0.0, 0.0], $wish, $source),
                aim("place", &[IS_PLACED], &[0.0, 0.0, 1.0, 0.0], $wish, GOAL_C),
            ],
            outcome: $outcome,
        }
    };
    (@with $fact:ident, [$($turn:ident),*]) => { &[$fact, $($turn),*] };
}

#[rustfmt::skip]
const BOTTLE: &[u8] = &[
    FREE, LOC, FREE, FREE,
    HOLD, HOLD, HOLD, HOLD,
    PUT, PUT, PUT, PUT,
];
#[rustfmt::skip]
const PLATE: &[u8] = &[
    FREE, FREE, LOC, FREE,
    HOLD, HOLD, HOLD, HOLD,
    PUT, PUT, PUT, PUT,
];

/// The bottle is placed on the plate that robot 1 holds still at goal C.
const ON_PLATE: &[Effect] = &[Effect {
    given: &[
        Given::of(1, GRIP, HOLDS),
        Given::of(1, PLACE, GOAL_C),
        Given::own(GRIP, HOLDS),
        Given::own(PLACE, GOAL_C),
    ],
    factor: GRIP,
    to: To::State(PLACED),
}];

/// The result (equation 9): null, success when robot 0 has placed and robot 1 has kept still,
/// failure when that has not.
const RESULT: Option<JointOutcome> = Some(JointOutcome {
    names: &["null", "success", "failure"],
    preference: &[0.0, 1.0, 0.0],
    table: &[0, 0, 0, 0, 0, 0, 0, 0, 2, 2, 2, 1, 0, 0, 0, 0],
    possible: Some(PUT_DOWN),
});

/// The teammate is to be free.
const FREE_R1: Wish = Wish::Rows(&[FREED, &[]]);
const FREE_R2: Wish = Wish::Rows(&[&[], FREED]);

/// One after the other, as published: robot 0 is to be free and to have its bottle before robot 1
/// begins.
pub const IN_TURN: [Role; TEAM] = [
    role!("R1", GOAL_A, 1, [PEER_IDLE], BOTTLE, ON_PLATE, RESULT, FREE_R2),
    role!("R2", GOAL_B, 0, [PEER_IDLE, PEER_HAS], PLATE, &[], None, FREE_R1),
];

/// Both fetch at once.
pub const TOGETHER: [Role; TEAM] = [
    role!("R1", GOAL_A, 1, [], BOTTLE, ON_PLATE, RESULT, Wish::AsAnnounced),
    role!("R2", GOAL_B, 0, [], PLATE, &[], None, Wish::AsAnnounced),
];

/// The order of fetching.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Order {
    /// One after the other; both leave for the meeting place together.
    #[default]
    InTurn,
    /// Both at once.
    Together,
}

/// The parameters of the joint decision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preset {
    /// The probability that a reading is right; each other reading has an equal share of the rest.
    pub sensor: f32,
    /// The probability, when policies are compared, that an action brings about its state; else the
    /// robot is free.
    pub success: f32,
    /// γ, the precision.
    pub precision: f32,
}

impl Preset {
    /// No tuning: actions are judged by their results, and γ is one.
    pub const DEFAULT: Self = Self { sensor: SENSOR, success: 1.0, precision: 1.0 };

    /// The reported probabilities to a thousandth. The pair of success and precision is one of
    /// several that give them.
    pub const CALIBRATED: Self = Self { success: 0.863, precision: 1.381, ..Self::DEFAULT };
}

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
