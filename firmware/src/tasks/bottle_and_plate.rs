//! Two robots bring a bottle and a plate together: section 6.2: written by `host-sim export`.

use iibt_core::iibt::Literal;
use iibt_core::iibt::rules::Raise;
use iibt_core::iibt::table::{
    Accuracy, Aim, Effect, Fact, Given, HiddenFactor, Holds, JointOutcome, Labels, Operator, Postcondition, Reads, Remedy, Role, Sensor, TableTask, Tables, Wish, To,
};

/// The tables of the task.
pub static TABLES: Tables = Tables::new(&[
    Role {
        name: "R1",
        factors: &[
            HiddenFactor { name: "place", states: &["elsewhere", "goal A", "goal B", "goal C"], prior: &[1.0, 0.0, 0.0, 0.0] },
            HiddenFactor { name: "grip", states: &["empty", "holds", "placed"], prior: &[1.0, 0.0, 0.0] },
        ],
        states: Labels { names: &["loc", "hold", "place", "free"], factors: &[1, 0], table: &[3, 0, 3, 3, 1, 1, 1, 1, 2, 2, 2, 2] },
        sensors: &[
            Sensor { name: "localiser", reads: Reads::Factor(0), accuracy: Accuracy::Even(0.92307687) },
            Sensor { name: "state", reads: Reads::State, accuracy: Accuracy::Even(0.92307687) },
        ],
        operators: &[
            Operator { name: "moveTo", requires: &[6], forbids: &[3], brings: Postcondition::Reset(0, 1.0, 3), effects: &[Effect { given: &[], factor: 0, to: To::Target }], success: 0.9, habit: 0.0 },
            Operator { name: "pick", requires: &[1, 6], forbids: &[0], brings: Postcondition::Reset(1, 1.0, 3), effects: &[Effect { given: &[Given { robot: None, factor: 1, state: 0 }, Given { robot: None, factor: 0, state: 1 }], factor: 1, to: To::State(1) }], success: 0.9, habit: 0.0 },
            Operator { name: "place", requires: &[2, 0, 8, 9, 6], forbids: &[4], brings: Postcondition::Reset(2, 1.0, 3), effects: &[Effect { given: &[Given { robot: Some(1), factor: 1, state: 1 }, Given { robot: Some(1), factor: 0, state: 3 }, Given { robot: None, factor: 1, state: 1 }, Given { robot: None, factor: 0, state: 3 }], factor: 1, to: To::State(2) }], success: 0.9, habit: 0.0 },
            Operator { name: "idle", requires: &[], forbids: &[], brings: Postcondition::Reset(3, 1.0, 3), effects: &[], success: 1.0, habit: 0.0 },
        ],
        idle: 3,
        facts: &[
            Fact { name: "IsHolding", holds: Holds::Sure { factor: 1, states: &[1] } },
            Fact { name: "IsReached(source)", holds: Holds::Sure { factor: 0, states: &[1] } },
            Fact { name: "IsReached(goal C)", holds: Holds::Sure { factor: 0, states: &[3] } },
            Fact { name: "IsReached(target)", holds: Holds::AtTarget { factor: 0 } },
            Fact { name: "IsPlaced", holds: Holds::Sure { factor: 1, states: &[2] } },
            Fact { name: "has its object", holds: Holds::Sure { factor: 1, states: &[1, 2] } },
            Fact { name: "teammate idle", holds: Holds::Doing { robot: 1, operators: &[3] } },
            Fact { name: "teammate has its object", holds: Holds::Announced { robot: 1, factor: 1, states: &[1, 2] } },
            Fact { name: "teammate at goal C", holds: Holds::Announced { robot: 1, factor: 0, states: &[3] } },
            Fact { name: "teammate holds", holds: Holds::Announced { robot: 1, factor: 1, states: &[1] } },
        ],
        remedies: &[
            Remedy { missing: Literal { variable: 0, value: true }, state: 1, raise: Raise::AboveAll, target: None },
            Remedy { missing: Literal { variable: 1, value: true }, state: 0, raise: Raise::AboveAll, target: Some(1) },
            Remedy { missing: Literal { variable: 2, value: true }, state: 0, raise: Raise::AboveAll, target: Some(3) },
            Remedy { missing: Literal { variable: 4, value: true }, state: 2, raise: Raise::AboveAll, target: None },
            Remedy { missing: Literal { variable: 6, value: true }, state: 3, raise: Raise::AboveAll, target: None },
            Remedy { missing: Literal { variable: 7, value: true }, state: 3, raise: Raise::AboveAll, target: None },
            Remedy { missing: Literal { variable: 8, value: true }, state: 3, raise: Raise::AboveAll, target: None },
            Remedy { missing: Literal { variable: 9, value: true }, state: 3, raise: Raise::AboveAll, target: None },
        ],
        aims: &[
            Aim { name: "hold", done: &[5], preference: &[0.0, 1.0, 0.0, 0.0], teammates: Wish::Rows(&[&[], &[0.0, 0.0, 0.0, 1.0]]), target: Some(1) },
            Aim { name: "place", done: &[4], preference: &[0.0, 0.0, 1.0, 0.0], teammates: Wish::Rows(&[&[], &[0.0, 0.0, 0.0, 1.0]]), target: Some(3) },
        ],
        outcome: Some(JointOutcome { names: &["null", "success", "failure"], preference: &[0.0, 1.0, 0.0], table: &[0, 0, 0, 0, 0, 0, 0, 0, 2, 2, 2, 1, 0, 0, 0, 0], possible: Some(2) }),
    },
    Role {
        name: "R2",
        factors: &[
            HiddenFactor { name: "place", states: &["elsewhere", "goal A", "goal B", "goal C"], prior: &[1.0, 0.0, 0.0, 0.0] },
            HiddenFactor { name: "grip", states: &["empty", "holds", "placed"], prior: &[1.0, 0.0, 0.0] },
        ],
        states: Labels { names: &["loc", "hold", "place", "free"], factors: &[1, 0], table: &[3, 3, 0, 3, 1, 1, 1, 1, 2, 2, 2, 2] },
        sensors: &[
            Sensor { name: "localiser", reads: Reads::Factor(0), accuracy: Accuracy::Even(0.92307687) },
            Sensor { name: "state", reads: Reads::State, accuracy: Accuracy::Even(0.92307687) },
        ],
        operators: &[
            Operator { name: "moveTo", requires: &[6, 7], forbids: &[3], brings: Postcondition::Reset(0, 1.0, 3), effects: &[Effect { given: &[], factor: 0, to: To::Target }], success: 0.9, habit: 0.0 },
            Operator { name: "pick", requires: &[1, 6, 7], forbids: &[0], brings: Postcondition::Reset(1, 1.0, 3), effects: &[Effect { given: &[Given { robot: None, factor: 1, state: 0 }, Given { robot: None, factor: 0, state: 2 }], factor: 1, to: To::State(1) }], success: 0.9, habit: 0.0 },
            Operator { name: "place", requires: &[2, 0, 8, 9, 6], forbids: &[4], brings: Postcondition::Reset(2, 1.0, 3), effects: &[], success: 0.9, habit: 0.0 },
            Operator { name: "idle", requires: &[], forbids: &[], brings: Postcondition::Reset(3, 1.0, 3), effects: &[], success: 1.0, habit: 0.0 },
        ],
        idle: 3,
        facts: &[
            Fact { name: "IsHolding", holds: Holds::Sure { factor: 1, states: &[1] } },
            Fact { name: "IsReached(source)", holds: Holds::Sure { factor: 0, states: &[2] } },
            Fact { name: "IsReached(goal C)", holds: Holds::Sure { factor: 0, states: &[3] } },
            Fact { name: "IsReached(target)", holds: Holds::AtTarget { factor: 0 } },
            Fact { name: "IsPlaced", holds: Holds::Sure { factor: 1, states: &[2] } },
            Fact { name: "has its object", holds: Holds::Sure { factor: 1, states: &[1, 2] } },
            Fact { name: "teammate idle", holds: Holds::Doing { robot: 0, operators: &[3] } },
            Fact { name: "teammate has its object", holds: Holds::Announced { robot: 0, factor: 1, states: &[1, 2] } },
            Fact { name: "teammate at goal C", holds: Holds::Announced { robot: 0, factor: 0, states: &[3] } },
            Fact { name: "teammate holds", holds: Holds::Announced { robot: 0, factor: 1, states: &[1] } },
        ],
        remedies: &[
            Remedy { missing: Literal { variable: 0, value: true }, state: 1, raise: Raise::AboveAll, target: None },
            Remedy { missing: Literal { variable: 1, value: true }, state: 0, raise: Raise::AboveAll, target: Some(2) },
            Remedy { missing: Literal { variable: 2, value: true }, state: 0, raise: Raise::AboveAll, target: Some(3) },
            Remedy { missing: Literal { variable: 4, value: true }, state: 2, raise: Raise::AboveAll, target: None },
            Remedy { missing: Literal { variable: 6, value: true }, state: 3, raise: Raise::AboveAll, target: None },
            Remedy { missing: Literal { variable: 7, value: true }, state: 3, raise: Raise::AboveAll, target: None },
            Remedy { missing: Literal { variable: 8, value: true }, state: 3, raise: Raise::AboveAll, target: None },
            Remedy { missing: Literal { variable: 9, value: true }, state: 3, raise: Raise::AboveAll, target: None },
        ],
        aims: &[
            Aim { name: "hold", done: &[5], preference: &[0.0, 1.0, 0.0, 0.0], teammates: Wish::Rows(&[&[0.0, 0.0, 0.0, 1.0], &[]]), target: Some(2) },
            Aim { name: "bring", done: &[2, 0], preference: &[1.0, 0.0, 0.0, 0.0], teammates: Wish::Rows(&[&[0.0, 0.0, 0.0, 1.0], &[]]), target: Some(3) },
        ],
        outcome: None,
    },
]);

/// The task of one of the robots.
pub type Task = TableTask<'static, { TABLES.states() }, { TABLES.robots() }, { TABLES.policies() }>;
