//! Checks that the tables of a task fit together, by the compiler for a `const`.

use super::definition::{
    Accuracy, Effect, Given, Holds, Labels, MAX_FACTORS, MAX_FACTS, MAX_OPERATORS, MAX_SENSORS, MAX_STATES,
    Postcondition, Reads, Remedy, Role, To, Wish,
};
use super::error::TablesError;
use crate::iibt::rules::Raise;
use crate::math;
use crate::team::MAX_TEAM;

/// The row of a table and the reason why it is refused.
type Flaw = Option<(usize, &'static str)>;

/// The tolerance for the sum of a column, as in the tables of `inference`.
const TOLERANCE: f32 = 1e-4;

/// Iterates over the rows of a list, which a `for` loop cannot do in a `const fn`.
macro_rules! each {
    ($at:ident in $rows:expr, $body:block) => {
        let mut $at = 0;
        while $at < $rows.len() {
            $body
            $at += 1;
        }
    };
}

/// Returns the flaw of a row if there is one: a condition and what it means, or what a check of
/// part of the row found.
macro_rules! refuse {
    ($wrong:expr, $at:expr, $reason:expr) => {
        if $wrong {
            return Some(($at, $reason));
        }
    };
    ($part:expr, $at:expr) => {
        if let Some(reason) = $part {
            return Some(($at, reason));
        }
    };
}

/// The first table of a role with a flaw, as an error. A table is looked at when those that it
/// refers to fit.
macro_rules! first_flaw {
    ($number:expr, $($table:literal: $flaw:expr),+ $(,)?) => {{
        $(if let Some((row, reason)) = $flaw {
            let (role, row) = (Some($number as u8), Some(row as u16));
            return Some(TablesError { role, table: $table, row, reason });
        })+
        None
    }};
}

/// Refuses the first row with an empty or repeated name.
macro_rules! refuse_unnamed {
    ($rows:expr) => {
        each!(at in $rows, {
            refuse!($rows[at].name.is_empty(), at, "its name is empty");
            let (before, _) = $rows.split_at(at);
            each!(other in before, {
                refuse!(same(before[other].name, $rows[at].name), at, "its name is taken");
            });
        });
    };
}

/// The first error of the tables.
pub(super) const fn check(roles: &[Role]) -> Result<(), TablesError> {
    if let Some((row, reason)) = team(roles) {
        return Err(TablesError { row: Some(row as u16), ..TablesError::of_team("roles", reason) });
    }
    each!(number in roles, {
        if let Some(error) = check_states(&roles[number], number) {
            return Err(error);
        }
    });
    each!(number in roles, {
        if let Some(error) = check_role(roles, number) {
            return Err(error);
        }
    });
    Ok(())
}

const fn team(roles: &[Role]) -> Flaw {
    refuse!(roles.is_empty() || roles.len() > MAX_TEAM, roles.len(), "a team has 1 to 8 robots");
    let mut policies = 1;
    each!(number in roles, {
        policies *= roles[number].operators.len();
        refuse!(policies > u16::MAX as usize, number, "there are more than 65,535 joint policies");
    });
    refuse_unnamed!(roles);
    None
}

/// Checks the parts that other tables refer to.
const fn check_states(role: &Role, number: usize) -> Option<TablesError> {
    first_flaw!(number,
        "factors": factors(role),
        "states": labels(&role.states, role),
        "operators": operator_names(role),
    )
}

/// Checks the parts that refer to the states of this role and of others.
const fn check_role(roles: &[Role], number: usize) -> Option<TablesError> {
    let role = &roles[number];
    first_flaw!(number,
        "sensors": sensors(role),
        "facts": facts(roles, number),
        "operators": operators(roles, number),
        "idle": idle(role),
        "remedies": remedies(role),
        "aims": aims(roles, number),
        "outcome": outcome(roles, role),
    )
}

const fn factors(role: &Role) -> Flaw {
    let rows = role.factors;
    refuse!(rows.is_empty() || rows.len() > MAX_FACTORS, rows.len(), "a role has 1 to 8 factors");
    each!(at in rows, {
        refuse!(names(rows[at].states), at);
        refuse!(rows[at].prior.len() != rows[at].states.len(), at, "its prior lacks an entry per state");
        refuse!(!math::is_distribution(rows[at].prior), at, "its prior is no distribution");
    });
    refuse_unnamed!(rows);
    None
}

/// The row that is wrong is the entry of the label table.
const fn labels(labels: &Labels, role: &Role) -> Flaw {
    refuse!(names(labels.names), 0);
    let of = labels.factors;
    refuse!(of.is_empty() || of.len() > MAX_FACTORS, of.len(), "labels depend on 1 to 8 factors");
    let mut entries = 1;
    each!(at in of, {
        refuse!(of[at] as usize >= role.factors.len(), at, "labels depend on a factor that does not exist");
        refuse!(contains(of.split_at(at).0, of[at]), at, "labels depend on one factor twice");
        entries *= role.factors[of[at] as usize].states.len();
    });
    let table = labels.table;
    refuse!(entries != table.len(), table.len(), "the label table lacks an entry per combination of states");
    each!(at in table, {
        refuse!(table[at] as usize >= labels.names.len(), at, "this entry of the label table is no label");
    });
    None
}

const fn operator_names(role: &Role) -> Flaw {
    let rows = role.operators;
    refuse!(rows.is_empty() || rows.len() > MAX_OPERATORS, rows.len(), "a role has 1 to 16 operators");
    refuse_unnamed!(rows);
    None
}

const fn sensors(role: &Role) -> Flaw {
    let rows = role.sensors;
    refuse!(rows.is_empty() || rows.len() > MAX_SENSORS, rows.len(), "a role has 1 to 8 sensors");
    each!(at in rows, {
        let outcomes = match &rows[at].reads {
            Reads::Factor(factor) => {
                refuse!(*factor as usize >= role.factors.len(), at, "it reads a factor that does not exist");
                role.factors[*factor as usize].states.len()
            }
            Reads::State => role.states.names.len(),
            Reads::Labels(read) => {
                if let Some((_, reason)) = labels(read, role) {
                    return Some((at, reason));
                }
                read.names.len()
            }
        };
        refuse!(outcomes < 2, at, "it has less than two readings");
        match rows[at].accuracy {
            Accuracy::Even(right) => refuse!(!is_probability(right), at, "its accuracy is no probability"),
            Accuracy::Table(table) => refuse!(columns(table, outcomes), at),
        }
    });
    refuse_unnamed!(rows);
    None
}

const fn columns(table: &[f32], outcomes: usize) -> Option<&'static str> {
    if table.len() != outcomes * outcomes {
        return Some("its table does not have a row per reading and a column per truth");
    }
    let mut sums = [0.0; MAX_STATES];
    each!(at in table, {
        if !is_probability(table[at]) {
            return Some("its table has an entry that is no probability");
        }
        sums[at % outcomes] += table[at];
    });
    let (sums, _) = sums.split_at(outcomes);
    each!(column in sums, {
        if !(sums[column] > 1.0 - TOLERANCE && sums[column] < 1.0 + TOLERANCE) {
            return Some("a column of its table does not sum to one");
        }
    });
    None
}

const fn facts(roles: &[Role], own: usize) -> Flaw {
    let rows = roles[own].facts;
    refuse!(rows.len() > MAX_FACTS, rows.len(), "a role has at most 16 facts");
    each!(at in rows, {
        if let Holds::Announced { robot, .. } | Holds::Doing { robot, .. } = rows[at].holds {
            refuse!(!is_teammate(roles, own, robot), at, "it is about a robot that is no teammate");
        }
        match rows[at].holds {
            Holds::Sure { factor, states } => refuse!(no_states(&roles[own], factor, states), at),
            Holds::AtTarget { factor } => refuse!(no_states(&roles[own], factor, &[]), at),
            Holds::Announced { robot, factor, states } => {
                refuse!(no_states(&roles[robot as usize], factor, states), at);
            }
            Holds::Doing { robot, operators } => {
                let all = are_below(operators, roles[robot as usize].operators.len());
                refuse!(!all, at, "it is about an operator that the teammate does not have");
            }
        }
    });
    refuse_unnamed!(rows);
    None
}

const fn no_states(role: &Role, factor: u8, states: &[u8]) -> Option<&'static str> {
    if factor as usize >= role.factors.len() {
        return Some("its factor does not exist");
    }
    if !are_below(states, role.factors[factor as usize].states.len()) {
        return Some("its factor does not have this state");
    }
    None
}

const fn operators(roles: &[Role], own: usize) -> Flaw {
    let (role, rows) = (&roles[own], roles[own].operators);
    each!(at in rows, {
        let row = &rows[at];
        let (states, p) = match row.brings {
            Postcondition::Nothing => ([0, 0], 1.0),
            Postcondition::State(state, p) => ([state, state], p),
            Postcondition::Reset(state, p, other) => ([state, other], p),
        };
        refuse!(!are_below(&states, role.states.names.len()), at, "it brings about a state that does not exist");
        refuse!(!is_probability(p), at, "what it brings about has no probability");
        refuse!(!is_probability(row.success), at, "its success is no probability");
        refuse!(!row.habit.is_finite(), at, "its habit is not finite");
        let known = are_below(row.requires, role.facts.len()) && are_below(row.forbids, role.facts.len());
        refuse!(!known, at, "a precondition is no fact");
        each!(fact in row.forbids, {
            refuse!(contains(row.requires, row.forbids[fact]), at, "it both requires and forbids one fact");
        });
        each!(effect in row.effects, {
            refuse!(misfit(roles, own, &row.effects[effect]), at);
        });
    });
    None
}

const fn misfit(roles: &[Role], own: usize, effect: &Effect) -> Option<&'static str> {
    let to = match effect.to {
        To::State(state) => state,
        To::Target => 0,
    };
    if no_states(&roles[own], effect.factor, &[to]).is_some() {
        return Some("an effect leads to a state that does not exist");
    }
    each!(at in effect.given, {
        let Given { robot, factor, state } = effect.given[at];
        let holder = match robot {
            Some(robot) if is_teammate(roles, own, robot) => robot as usize,
            Some(_) => return Some("an effect depends on a robot that is no teammate"),
            None => own,
        };
        if no_states(&roles[holder], factor, &[state]).is_some() {
            return Some("an effect depends on a state that does not exist");
        }
    });
    None
}

const fn idle(role: &Role) -> Flaw {
    let idle = role.idle as usize;
    refuse!(idle >= role.operators.len(), idle, "the idle operator does not exist");
    let row = &role.operators[idle];
    let acts = !row.requires.is_empty() || !row.forbids.is_empty() || !row.effects.is_empty();
    refuse!(acts, idle, "the idle operator has a precondition or an effect");
    None
}

const fn remedies(role: &Role) -> Flaw {
    let rows = role.remedies;
    each!(at in rows, {
        let Remedy { missing, state, raise, target } = rows[at];
        refuse!(missing.variable as usize >= role.facts.len(), at, "the missing literal is no fact");
        refuse!(state as usize >= role.states.names.len(), at, "the state that it raises does not exist");
        let finite = !matches!(raise, Raise::By(amount) if !amount.is_finite());
        refuse!(!finite, at, "its raise is not finite");
        refuse!(!is_target(role, target), at, "no operator can lead to its target");
    });
    None
}

const fn aims(roles: &[Role], own: usize) -> Flaw {
    let (role, rows) = (&roles[own], roles[own].aims);
    refuse!(rows.is_empty(), 0, "a role has at least one aim");
    each!(at in rows, {
        let row = &rows[at];
        refuse!(row.done.is_empty(), at, "nothing says when it is reached");
        refuse!(!are_below(row.done, role.facts.len()), at, "what says that it is reached is no fact");
        let fits = is_preference(row.preference, role.states.names.len());
        refuse!(!fits, at, "its preference lacks a finite entry per state");
        refuse!(!is_target(role, row.target), at, "no operator can lead to its target");
        if let Wish::Rows(wishes) = row.teammates {
            refuse!(wishes.len() != roles.len(), at, "its wishes lack a row per robot");
            each!(robot in wishes, {
                let fits = robot == own || is_preference(wishes[robot], roles[robot].states.names.len());
                refuse!(!fits, at, "a wish lacks a finite entry per state of the teammate");
            });
        }
    });
    refuse_unnamed!(rows);
    None
}

const fn outcome(roles: &[Role], role: &Role) -> Flaw {
    let Some(outcome) = &role.outcome else { return None };
    refuse!(names(outcome.names), 0);
    let fits = is_preference(outcome.preference, outcome.names.len());
    refuse!(!fits, 0, "its preference lacks a finite entry per outcome");
    let mut entries = 1usize;
    each!(robot in roles, {
        entries = entries.saturating_mul(roles[robot].states.names.len());
    });
    let table = outcome.table;
    refuse!(table.len() != entries, table.len(), "the table lacks an entry per combination of states");
    if let Some(operator) = outcome.possible {
        let exists = (operator as usize) < role.operators.len();
        refuse!(!exists, operator as usize, "the operator that makes it possible does not exist");
    }
    each!(at in table, {
        refuse!(table[at] as usize >= outcome.names.len(), at, "this entry is no outcome");
    });
    None
}

/// The flaw of a list of names, if there is one.
const fn names(names: &[&str]) -> Option<&'static str> {
    if names.is_empty() || names.len() > MAX_STATES {
        return Some("there are not 1 to 15 names");
    }
    each!(at in names, {
        if names[at].is_empty() {
            return Some("a name is empty");
        }
        let (before, _) = names.split_at(at);
        each!(other in before, {
            if same(before[other], names[at]) {
                return Some("a name is there twice");
            }
        });
    });
    None
}

/// Whether some operator leads to the target, and its factor has this state.
const fn is_target(role: &Role, target: Option<u8>) -> bool {
    let Some(target) = target else { return true };
    let mut found = false;
    each!(operator in role.operators, {
        let effects = role.operators[operator].effects;
        each!(at in effects, {
            if matches!(effects[at].to, To::Target) {
                if no_states(role, effects[at].factor, &[target]).is_some() {
                    return false;
                }
                found = true;
            }
        });
    });
    found
}

const fn is_teammate(roles: &[Role], own: usize, robot: u8) -> bool {
    (robot as usize) < roles.len() && robot as usize != own
}

const fn is_preference(values: &[f32], states: usize) -> bool {
    each!(at in values, {
        if !values[at].is_finite() {
            return false;
        }
    });
    values.len() == states
}

const fn is_probability(p: f32) -> bool {
    p >= 0.0 && p <= 1.0
}

const fn are_below(list: &[u8], limit: usize) -> bool {
    each!(at in list, {
        if list[at] as usize >= limit {
            return false;
        }
    });
    true
}

const fn contains(list: &[u8], entry: u8) -> bool {
    each!(at in list, {
        if list[at] == entry {
            return true;
        }
    });
    false
}

const fn same(one: &str, other: &str) -> bool {
    let (one, other) = (one.as_bytes(), other.as_bytes());
    if one.len() != other.len() {
        return false;
    }
    each!(at in one, {
        if one[at] != other[at] {
            return false;
        }
    });
    true
}

#[cfg(test)]
mod tests {
    use super::super::definition::{Aim, Fact, HiddenFactor, JointOutcome, Operator, Sensor};
    use super::super::tables::Tables;
    use super::*;
    use crate::iibt::Literal;
    use std::string::{String, ToString};

    const TURN: Operator = Operator {
        name: "turn",
        requires: &[1],
        forbids: &[0],
        brings: Postcondition::State(1, 0.9),
        effects: &[Effect { given: &[], factor: 0, to: To::Target }],
        ..Operator::IDLE
    };
    const VALVE: HiddenFactor = HiddenFactor { name: "valve", states: &["open", "shut"], prior: &[0.5, 0.5] };
    const READ: Sensor = Sensor { name: "gauge", reads: Reads::Factor(0), accuracy: Accuracy::Even(0.9) };
    const SHUT: Fact = Fact { name: "shut", holds: Holds::Sure { factor: 0, states: &[1] } };
    const FREE: Fact = Fact { name: "R2 idle", holds: Holds::Doing { robot: 1, operators: &[1] } };
    const WAIT: Remedy = Remedy {
        missing: Literal { variable: 1, value: true },
        state: 0,
        raise: Raise::AboveAll,
        target: Some(1),
    };
    const CLOSE: Aim = Aim {
        name: "close",
        done: &[0],
        preference: &[0.0, 1.0],
        teammates: Wish::Rows(&[&[], &[0.0, 0.0]]),
        target: Some(1),
    };
    const SAFE: JointOutcome = JointOutcome {
        names: &["leaks", "safe"],
        preference: &[0.0, 1.0],
        table: &[0, 0, 0, 1],
        possible: Some(0),
    };
    const SOUND: Role = Role {
        name: "R1",
        factors: &[VALVE],
        states: Labels { names: &["open", "shut"], factors: &[0], table: &[0, 1] },
        sensors: &[READ],
        operators: &[TURN, Operator::IDLE],
        idle: 1,
        facts: &[SHUT, FREE],
        remedies: &[WAIT],
        aims: &[CLOSE],
        outcome: Some(SAFE),
    };
    const OTHER: Role = Role {
        name: "R2",
        facts: &[SHUT, SHUT_R1],
        aims: &[Aim { teammates: Wish::AsAnnounced, ..CLOSE }],
        outcome: None,
        ..SOUND
    };
    const SHUT_R1: Fact =
        Fact { name: "R1 shut", holds: Holds::Announced { robot: 0, factor: 0, states: &[1] } };

    fn refusal(role: Role) -> String {
        Tables::try_new(&[role, OTHER]).map_or_else(|error| error.to_string(), |_| String::new())
    }

    /// The error of a role in which one row replaces another.
    macro_rules! said {
        ($table:ident: $($row:expr),* => $reason:literal) => {
            assert_eq!(refusal(Role { $table: &[$($row),*], ..SOUND }), concat!("roles[0].", $reason));
        };
    }

    #[test]
    fn a_mismatch_is_named_with_its_table_and_row() {
        assert_eq!(refusal(SOUND), "");
        said!(factors: HiddenFactor { prior: &[0.5, 0.4], ..VALVE } => "factors[0]: its prior is no distribution");
        said!(factors: HiddenFactor { prior: &[1.0], ..VALVE } => "factors[0]: its prior lacks an entry per state");
        said!(factors: VALVE, VALVE => "factors[1]: its name is taken");
        said!(factors: HiddenFactor { name: "", ..VALVE } => "factors[0]: its name is empty");
        said!(factors: HiddenFactor { states: &["a", "a"], ..VALVE } => "factors[0]: a name is there twice");
        said!(sensors: => "sensors[0]: a role has 1 to 8 sensors");
        said!(sensors: Sensor { accuracy: Accuracy::Even(1.1), ..READ } => "sensors[0]: its accuracy is no probability");
        said!(sensors: READ, Sensor { name: "eye", reads: Reads::Factor(3), ..READ }
            => "sensors[1]: it reads a factor that does not exist");
        said!(sensors: Sensor { accuracy: Accuracy::Table(&[0.9, 0.2, 0.1, 0.7]), ..READ }
            => "sensors[0]: a column of its table does not sum to one");
        said!(sensors: Sensor { accuracy: Accuracy::Table(&[0.9, 0.2]), ..READ }
            => "sensors[0]: its table does not have a row per reading and a column per truth");
        said!(operators: Operator { requires: &[2], ..TURN }, Operator::IDLE => "operators[0]: a precondition is no fact");
        said!(operators: Operator { requires: &[0], ..TURN }, Operator::IDLE
            => "operators[0]: it both requires and forbids one fact");
        said!(operators: Operator { brings: Postcondition::State(2, 0.9), ..TURN }, Operator::IDLE
            => "operators[0]: it brings about a state that does not exist");
        said!(operators: Operator { success: f32::NAN, ..TURN }, Operator::IDLE
            => "operators[0]: its success is no probability");
        said!(operators: Operator { habit: f32::NEG_INFINITY, ..TURN }, Operator::IDLE
            => "operators[0]: its habit is not finite");
        said!(operators: Operator { effects: &[Effect::set(1, 0)], ..TURN }, Operator::IDLE
            => "operators[0]: an effect leads to a state that does not exist");
        said!(operators: TURN, TURN => "operators[1]: its name is taken");
        said!(facts: SHUT, Fact { holds: Holds::Doing { robot: 0, operators: &[1] }, ..FREE }
            => "facts[1]: it is about a robot that is no teammate");
        said!(facts: SHUT, Fact { holds: Holds::Doing { robot: 1, operators: &[2] }, ..FREE }
            => "facts[1]: it is about an operator that the teammate does not have");
        said!(facts: Fact { holds: Holds::Sure { factor: 0, states: &[2] }, ..SHUT }, FREE
            => "facts[0]: its factor does not have this state");
        said!(remedies: Remedy { target: Some(2), ..WAIT } => "remedies[0]: no operator can lead to its target");
        said!(remedies: Remedy { state: 2, ..WAIT } => "remedies[0]: the state that it raises does not exist");
        said!(aims: Aim { preference: &[1.0], ..CLOSE } => "aims[0]: its preference lacks a finite entry per state");
        said!(aims: Aim { done: &[], ..CLOSE } => "aims[0]: nothing says when it is reached");
        said!(aims: Aim { teammates: Wish::Rows(&[&[]]), ..CLOSE } => "aims[0]: its wishes lack a row per robot");
        let outcome = Some(JointOutcome { table: &[0, 0, 0, 2], ..SAFE });
        assert_eq!(refusal(Role { outcome, ..SOUND }), "roles[0].outcome[3]: this entry is no outcome");
        assert_eq!(
            refusal(Role { idle: 0, ..SOUND }),
            "roles[0].idle[0]: the idle operator has a precondition or an effect"
        );
        let states = Labels { table: &[0, 2], ..SOUND.states };
        assert_eq!(
            refusal(Role { states, ..SOUND }),
            "roles[0].states[1]: this entry of the label table is no label"
        );
        assert_eq!(refusal(OTHER), "roles[1]: its name is taken");
        assert_eq!(Tables::try_new(&[]).unwrap_err().to_string(), "roles[0]: a team has 1 to 8 robots");
    }

    #[test]
    #[should_panic = "roles[1].facts[1]: it is about a robot that is no teammate"]
    fn the_compilers_message_is_the_same() {
        let _ = Tables::new(&[SOUND, Role { facts: &[SHUT, FREE], ..OTHER }]);
    }
}
