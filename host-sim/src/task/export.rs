//! A task file as Rust source: the same tables as a `const` for the robot.

use super::read::TableMission;
use iibt_core::iibt::rules::Raise;
use iibt_core::iibt::table::{
    Accuracy, Effect, Given, Holds, JointOutcome, Labels, Operator, Postcondition, Reads, Role, Tables, To,
    Wish,
};
use std::fmt::Debug;

impl TableMission<'_> {
    /// The tables as a module of Rust source, for a crate that depends on `iibt-core` and on
    /// nothing else.
    #[must_use]
    pub fn to_rust(&self) -> String {
        let title: String =
            self.title.chars().map(|sign| if sign.is_control() { ' ' } else { sign }).collect();
        let roles: String = self.tables.roles().iter().map(role).collect();
        let (precision, confidence) = (self.tables.precision(), self.tables.confidence());
        let tuned = [
            (precision != Tables::PRECISION).then(|| format!(".with_precision({precision:?})")),
            (confidence != Tables::CONFIDENCE).then(|| format!(".with_confidence({confidence:?})")),
        ];
        let mut tables = format!("Tables::new(&[\n{roles}])");
        for with in tuned.into_iter().flatten() {
            tables =
                format!("match {tables}{with} {{\n    Ok(tables) => tables,\n    Err(_) => panic!(),\n}}");
        }
        let body = format!(
            "/// The tables of the task.\npub static TABLES: Tables = {tables};\n\n\
             /// The task of one of the robots.\n\
             pub type Task = TableTask<'static, {{ TABLES.states() }}, {{ TABLES.robots() }}, {{ TABLES.policies() }}>;\n"
        );
        format!("//! {title}: written by `host-sim export`.\n\n{}\n{body}", uses(&body))
    }
}

/// The lines that import what the source uses.
fn uses(body: &str) -> String {
    const TABLE: [&str; 18] = [
        "Accuracy",
        "Aim",
        "Effect",
        "Fact",
        "Given",
        "HiddenFactor",
        "Holds",
        "JointOutcome",
        "Labels",
        "Operator",
        "Postcondition",
        "Reads",
        "Remedy",
        "Role",
        "Sensor",
        "TableTask",
        "Tables",
        "Wish",
    ];
    let is_used = |name: &str| [" {", "::", "<"].iter().any(|after| body.contains(&format!("{name}{after}")));
    let mut lines = String::new();
    for (path, name) in [("iibt", "Literal"), ("iibt::rules", "Raise")] {
        if is_used(name) {
            lines += &format!("use iibt_core::{path}::{name};\n");
        }
    }
    let mut names: Vec<&str> = TABLE.into_iter().filter(|name| is_used(name)).collect();
    names.extend(is_used("To").then_some("To"));
    lines + &format!("use iibt_core::iibt::table::{{\n    {},\n}};\n", names.join(", "))
}

fn role(role: &Role<'_>) -> String {
    let factors = role.factors.iter().map(|of| {
        format!("HiddenFactor {{ name: {:?}, states: &{:?}, prior: &{:?} }}", of.name, of.states, of.prior)
    });
    let sensors = role.sensors.iter().map(|of| {
        let reads = match of.reads {
            Reads::Factor(factor) => format!("Reads::Factor({factor})"),
            Reads::State => "Reads::State".to_owned(),
            Reads::Labels(of) => format!("Reads::Labels({})", labels(&of)),
        };
        let accuracy = match of.accuracy {
            Accuracy::Even(right) => format!("Accuracy::Even({right:?})"),
            Accuracy::Table(table) => format!("Accuracy::Table(&{table:?})"),
        };
        format!("Sensor {{ name: {:?}, reads: {reads}, accuracy: {accuracy} }}", of.name)
    });
    let facts =
        role.facts.iter().map(|of| format!("Fact {{ name: {:?}, holds: {} }}", of.name, holds(&of.holds)));
    let remedies = role.remedies.iter().map(|of| {
        let raise = match of.raise {
            Raise::AboveAll => "Raise::AboveAll".to_owned(),
            Raise::By(amount) => format!("Raise::By({amount:?})"),
        };
        format!(
            "Remedy {{ missing: Literal {{ variable: {}, value: {} }}, state: {}, raise: {raise}, target: {:?} }}",
            of.missing.variable, of.missing.value, of.state, of.target
        )
    });
    let aims = role.aims.iter().map(|of| {
        let teammates = match of.teammates {
            Wish::AsAnnounced => "Wish::AsAnnounced".to_owned(),
            Wish::Rows(rows) => {
                let rows: Vec<String> = rows.iter().map(|row| format!("&{row:?}")).collect();
                format!("Wish::Rows(&[{}])", rows.join(", "))
            }
        };
        format!(
            "Aim {{ name: {:?}, done: &{:?}, preference: &{:?}, teammates: {teammates}, target: {:?} }}",
            of.name, of.done, of.preference, of.target
        )
    });
    format!(
        "    Role {{\n        name: {:?},\n        factors: {},\n        states: {},\n        sensors: {},\n        \
         operators: {},\n        idle: {},\n        facts: {},\n        remedies: {},\n        aims: {},\n        \
         outcome: {},\n    }},\n",
        role.name,
        rows(factors),
        labels(&role.states),
        rows(sensors),
        rows(role.operators.iter().map(operator)),
        role.idle,
        rows(facts),
        rows(remedies),
        rows(aims),
        role.outcome.as_ref().map_or_else(|| "None".to_owned(), outcome)
    )
}

fn operator(of: &Operator<'_>) -> String {
    let brings = match of.brings {
        Postcondition::Nothing => "Postcondition::Nothing".to_owned(),
        Postcondition::State(state, p) => format!("Postcondition::State({state}, {p:?})"),
        Postcondition::Reset(state, p, other) => format!("Postcondition::Reset({state}, {p:?}, {other})"),
    };
    let effects: Vec<String> = of.effects.iter().map(effect).collect();
    format!(
        "Operator {{ name: {:?}, requires: &{:?}, forbids: &{:?}, brings: {brings}, effects: &[{}], success: {:?}, \
         habit: {:?} }}",
        of.name,
        of.requires,
        of.forbids,
        effects.join(", "),
        of.success,
        of.habit
    )
}

fn effect(of: &Effect<'_>) -> String {
    let given =
        |of: &Given| format!("Given {{ robot: {:?}, factor: {}, state: {} }}", of.robot, of.factor, of.state);
    let to = match of.to {
        To::State(state) => format!("To::State({state})"),
        To::Target => "To::Target".to_owned(),
    };
    let given: Vec<String> = of.given.iter().map(given).collect();
    format!("Effect {{ given: &[{}], factor: {}, to: {to} }}", given.join(", "), of.factor)
}

fn holds(of: &Holds<'_>) -> String {
    match of {
        Holds::Sure { factor, states } => format!("Holds::Sure {{ factor: {factor}, states: &{states:?} }}"),
        Holds::AtTarget { factor } => format!("Holds::AtTarget {{ factor: {factor} }}"),
        Holds::Announced { robot, factor, states } => {
            format!("Holds::Announced {{ robot: {robot}, factor: {factor}, states: &{states:?} }}")
        }
        Holds::Doing { robot, operators } => {
            format!("Holds::Doing {{ robot: {robot}, operators: &{operators:?} }}")
        }
    }
}

fn labels(of: &Labels<'_>) -> String {
    format!("Labels {{ names: &{:?}, factors: &{:?}, table: &{:?} }}", of.names, of.factors, of.table)
}

fn outcome(of: &JointOutcome<'_>) -> String {
    let list = |of: &dyn Debug| format!("&{of:?}");
    format!(
        "Some(JointOutcome {{ names: {}, preference: {}, table: {}, possible: {:?} }})",
        list(&of.names),
        list(&of.preference),
        list(&of.table),
        of.possible
    )
}

fn rows(rows: impl Iterator<Item = String>) -> String {
    let rows: String = rows.map(|row| format!("            {row},\n")).collect();
    if rows.is_empty() { "&[]".to_owned() } else { format!("&[\n{rows}        ]") }
}
