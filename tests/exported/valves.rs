//! Two robots close two valves in an order: written by `host-sim export`.

use iibt_core::iibt::Literal;
use iibt_core::iibt::rules::Raise;
use iibt_core::iibt::table::{
    Accuracy, Aim, Effect, Fact, Given, HiddenFactor, Holds, Labels, Operator, Postcondition, Reads, Remedy, Role, Sensor, TableTask, Tables, Wish, To,
};

/// The tables of the task.
pub static TABLES: Tables = Tables::new(&[
    Role {
        name: "R1",
        factors: &[
            HiddenFactor { name: "valve", states: &["open", "closed"], prior: &[0.5, 0.5] },
        ],
        states: Labels { names: &["open", "closed"], factors: &[0], table: &[0, 1] },
        sensors: &[
            Sensor { name: "position", reads: Reads::Factor(0), accuracy: Accuracy::Even(0.9) },
        ],
        operators: &[
            Operator { name: "turn", requires: &[1], forbids: &[0], brings: Postcondition::State(1, 0.8), effects: &[Effect { given: &[], factor: 0, to: To::State(1) }], success: 0.8, habit: 0.0 },
            Operator { name: "idle", requires: &[], forbids: &[], brings: Postcondition::Nothing, effects: &[], success: 1.0, habit: 0.0 },
        ],
        idle: 1,
        facts: &[
            Fact { name: "closed", holds: Holds::Sure { factor: 0, states: &[1] } },
            Fact { name: "R2 idle", holds: Holds::Doing { robot: 1, operators: &[1] } },
        ],
        remedies: &[
            Remedy { missing: Literal { variable: 1, value: true }, state: 0, raise: Raise::AboveAll, target: None },
        ],
        aims: &[
            Aim { name: "close", done: &[0], preference: &[0.0, 1.0], teammates: Wish::AsAnnounced, target: None },
        ],
        outcome: None,
    },
    Role {
        name: "R2",
        factors: &[
            HiddenFactor { name: "valve", states: &["open", "closed"], prior: &[0.5, 0.5] },
        ],
        states: Labels { names: &["open", "closed"], factors: &[0], table: &[0, 1] },
        sensors: &[
            Sensor { name: "position", reads: Reads::Factor(0), accuracy: Accuracy::Even(0.9) },
        ],
        operators: &[
            Operator { name: "turn", requires: &[1], forbids: &[0], brings: Postcondition::State(1, 0.8), effects: &[Effect { given: &[Given { robot: Some(0), factor: 0, state: 1 }], factor: 0, to: To::State(1) }], success: 0.8, habit: 0.0 },
            Operator { name: "idle", requires: &[], forbids: &[], brings: Postcondition::Nothing, effects: &[], success: 1.0, habit: 0.0 },
        ],
        idle: 1,
        facts: &[
            Fact { name: "closed", holds: Holds::Sure { factor: 0, states: &[1] } },
            Fact { name: "inlet closed", holds: Holds::Announced { robot: 0, factor: 0, states: &[1] } },
        ],
        remedies: &[
            Remedy { missing: Literal { variable: 1, value: true }, state: 0, raise: Raise::AboveAll, target: None },
        ],
        aims: &[
            Aim { name: "close", done: &[0], preference: &[0.0, 1.0], teammates: Wish::AsAnnounced, target: None },
        ],
        outcome: None,
    },
]);

/// The task of one of the robots.
pub type Task = TableTask<'static, { TABLES.states() }, { TABLES.robots() }, { TABLES.policies() }>;
