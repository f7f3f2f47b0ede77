//! Whether the tables of a task fit together, worked out by the compiler for a `const`.

use super::definition::{
    Accuracy, Effect, Given, Holds, Labels, MAX_FACTORS, MAX_FACTS, MAX_OPERATORS, MAX_SENSORS, MAX_STATES,
    Postcondition, Reads, Role, To, Wish,
};
use super::error::TablesError;
use crate::iibt::rules::Raise;
use crate::math;
use crate::team::MAX_TEAM;

/// The row of a table and what is wrong with it.
type Flaw = Option<(usize, &'static str)>;

/// How far a column may be from summing to one, as in the tables of `inference`.
const TOLERANCE: f32 = 1e-4;

/// The first empty or repeated name of a table's rows.
macro_rules! unnamed {
    ($rows:expr) => {{
        let (rows, mut at, mut flaw) = ($rows, 0, None);
        while at < rows.len() && flaw.is_none() {
            let mut before = 0;
            while before < at {
                if same(rows[before].name, rows[at].name) {
                    flaw = Some((at, "its name is taken"));
                }
                before += 1;
            }
            if rows[at].name.is_empty() {
                flaw = Some((at, "its name is empty"));
            }
            at += 1;
        }
        flaw
    }};
}

/// The first table of a role with a flaw, as an error. A table is looked at when those that it refers to fit.
macro_rules! first_flaw {
    ($number:expr, $($table:literal: $flaw:expr),+ $(,)?) => {{
        $(if let Some((row, reason)) = $flaw {
            let (role, row) = (Some($number as u8), Some(row as u16));
            return Some(TablesError { role, table: $table, row, reason });
        })+
        None
    }};
}

/// The first thing that does not fit.
pub(super) const fn check(roles: &[Role]) -> Result<(), TablesError> {
    if roles.is_empty() || roles.len() > MAX_TEAM {
        return Err(TablesError::of_team("roles", "a team has 1 to 8 robots"));
    }
    if let Some((row, reason)) = unnamed!(roles) {
        return Err(TablesError { row: Some(row as u16), ..TablesError::of_team("roles", reason) });
    }
    let mut number = 0;
    while number < roles.len() {
        if let Some(error) = check_states(&roles[number], number) {
            return Err(error);
        }
        number += 1;
    }
    let (mut number, mut policies) = (0, 1);
    while number < roles.len() {
        if let Some(error) = check_role(roles, number) {
            return Err(error);
        }
        policies *= roles[number].operators.len();
        if policies > u16::MAX as usize {
            return Err(TablesError::of_team("roles", "there are more than 65,535 joint policies"));
        }
        number += 1;
    }
    Ok(())
}

/// What other roles may refer to.
const fn check_states(role: &Role, number: usize) -> Option<TablesError> {
    first_flaw!(number,
        "factors": factors(role),
        "states": labels(&role.states, role),
        "operators": unnamed_or_too_many_operators(role),
    )
}

/// What refers to the role's own states, and to those of others.
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
    if rows.is_empty() || rows.len() > MAX_FACTORS {
        return Some((rows.len(), "a role has 1 to 8 factors"));
    }
    let mut at = 0;
    while at < rows.len() {
        if let Some(reason) = names(rows[at].states) {
            return Some((at, reason));
        }
        if rows[at].prior.len() != rows[at].states.len() {
            return Some((at, "its prior does not have an entry per state"));
        }
        if !math::is_distribution(rows[at].prior) {
            return Some((at, "its prior is no distribution"));
        }
        at += 1;
    }
    unnamed!(rows)
}

/// The row that is wrong is the entry of the label table.
const fn labels(labels: &Labels, role: &Role) -> Flaw {
    if let Some(reason) = names(labels.names) {
        return Some((0, reason));
    }
    if labels.factors.is_empty() || labels.factors.len() > MAX_FACTORS {
        return Some((labels.factors.len(), "labels depend on 1 to 8 factors"));
    }
    let (mut at, mut entries) = (0, 1);
    while at < labels.factors.len() {
        let factor = labels.factors[at] as usize;
        if factor >= role.factors.len() {
            return Some((at, "labels depend on a factor that does not exist"));
        }
        if contains(labels.factors.split_at(at).0, labels.factors[at]) {
            return Some((at, "labels depend on one factor twice"));
        }
        entries *= role.factors[factor].states.len();
        at += 1;
    }
    if entries != labels.table.len() {
        return Some((
            labels.table.len(),
            "the label table does not have an entry per combination of states",
        ));
    }
    not_below(labels.table, labels.names.len(), "this entry of the label table is no label")
}

const fn unnamed_or_too_many_operators(role: &Role) -> Flaw {
    if role.operators.is_empty() || role.operators.len() > MAX_OPERATORS {
        return Some((role.operators.len(), "a role has 1 to 16 operators"));
    }
    unnamed!(role.operators)
}

const fn sensors(role: &Role) -> Flaw {
    let rows = role.sensors;
    if rows.len() > MAX_SENSORS {
        return Some((rows.len(), "a role has at most 8 sensors"));
    }
    let mut at = 0;
    while at < rows.len() {
        let outcomes = match &rows[at].reads {
            Reads::Factor(factor) if (*factor as usize) < role.factors.len() => {
                role.factors[*factor as usize].states.len()
            }
            Reads::Factor(_) => return Some((at, "it reads a factor that does not exist")),
            Reads::State => role.states.names.len(),
            Reads::Labels(read) => match labels(read, role) {
                Some((_, reason)) => return Some((at, reason)),
                None => read.names.len(),
            },
        };
        if let Some(reason) = accuracy(&rows[at].accuracy, outcomes) {
            return Some((at, reason));
        }
        at += 1;
    }
    unnamed!(rows)
}

const fn accuracy(accuracy: &Accuracy, outcomes: usize) -> Option<&'static str> {
    match *accuracy {
        Accuracy::Even(_) if outcomes < 2 => Some("it errs evenly among less than two readings"),
        Accuracy::Even(right) if is_probability(right) => None,
        Accuracy::Even(_) => Some("its accuracy is no probability"),
        Accuracy::Table(table) if table.len() != outcomes * outcomes => {
            Some("its table does not have a row per reading and a column per truth")
        }
        Accuracy::Table(table) => {
            let mut column = 0;
            while column < outcomes {
                let (mut sum, mut row) = (0.0, 0);
                while row < outcomes {
                    let entry = table[row * outcomes + column];
                    if !is_probability(entry) {
                        return Some("its table has an entry that is no probability");
                    }
                    sum += entry;
                    row += 1;
                }
                if !(sum > 1.0 - TOLERANCE && sum < 1.0 + TOLERANCE) {
                    return Some("a column of its table does not sum to one");
                }
                column += 1;
            }
            None
        }
    }
}

const fn facts(roles: &[Role], own: usize) -> Flaw {
    let rows = roles[own].facts;
    if rows.len() > MAX_FACTS {
        return Some((rows.len(), "a role has at most 16 facts"));
    }
    let mut at = 0;
    while at < rows.len() {
        let flaw = match rows[at].holds {
            Holds::Sure { factor, states } => no_states(&roles[own], factor, states),
            Holds::AtTarget { factor } if (factor as usize) < roles[own].factors.len() => None,
            Holds::AtTarget { .. } => Some("its factor does not exist"),
            Holds::Announced { robot, .. } | Holds::Doing { robot, .. }
                if !is_teammate(roles, own, robot) =>
            {
                Some("it is about a robot that is no teammate")
            }
            Holds::Announced { robot, factor, states } => no_states(&roles[robot as usize], factor, states),
            Holds::Doing { robot, operators } => {
                match not_below(operators, roles[robot as usize].operators.len(), "") {
                    Some(_) => Some("it is about an operator that the teammate does not have"),
                    None => None,
                }
            }
        };
        if let Some(reason) = flaw {
            return Some((at, reason));
        }
        at += 1;
    }
    unnamed!(rows)
}

const fn no_states(role: &Role, factor: u8, states: &[u8]) -> Option<&'static str> {
    if factor as usize >= role.factors.len() {
        return Some("its factor does not exist");
    }
    match not_below(states, role.factors[factor as usize].states.len(), "") {
        Some(_) => Some("its factor does not have this state"),
        None => None,
    }
}

const fn operators(roles: &[Role], own: usize) -> Flaw {
    let (role, mut at) = (&roles[own], 0);
    while at < role.operators.len() {
        let row = &role.operators[at];
        let states = role.states.names.len();
        let brings = match row.brings {
            Postcondition::Nothing => true,
            Postcondition::State(state, p) => (state as usize) < states && is_probability(p),
            Postcondition::Reset(state, p, other) => {
                (state as usize) < states && (other as usize) < states && is_probability(p)
            }
        };
        if !brings {
            return Some((at, "it brings about a state that does not exist, or with no probability"));
        }
        if !is_probability(row.success) {
            return Some((at, "its success is no probability"));
        }
        let mut place = 0;
        while place < row.requires.len() + row.forbids.len() {
            let required = place < row.requires.len();
            let fact = if required { row.requires[place] } else { row.forbids[place - row.requires.len()] };
            if fact as usize >= role.facts.len() {
                return Some((at, "a precondition is no fact"));
            }
            if !required && contains(row.requires, fact) {
                return Some((at, "it both requires and forbids one fact"));
            }
            place += 1;
        }
        let mut effect = 0;
        while effect < row.effects.len() {
            if let Some(reason) = effect_flaw(roles, own, &row.effects[effect]) {
                return Some((at, reason));
            }
            effect += 1;
        }
        at += 1;
    }
    None
}

const fn effect_flaw(roles: &[Role], own: usize, effect: &Effect) -> Option<&'static str> {
    let factors = roles[own].factors;
    if effect.factor as usize >= factors.len() {
        return Some("an effect changes a factor that does not exist");
    }
    if let To::State(state) = effect.to
        && state as usize >= factors[effect.factor as usize].states.len()
    {
        return Some("an effect leads to a state that its factor does not have");
    }
    let mut at = 0;
    while at < effect.given.len() {
        let Given { robot, factor, state } = effect.given[at];
        let role = match robot {
            Some(robot) if !is_teammate(roles, own, robot) => {
                return Some("an effect depends on a robot that is no teammate");
            }
            Some(robot) => &roles[robot as usize],
            None => &roles[own],
        };
        if no_states(role, factor, &[state]).is_some() {
            return Some("an effect depends on a state that does not exist");
        }
        at += 1;
    }
    None
}

const fn idle(role: &Role) -> Flaw {
    let idle = role.idle as usize;
    if idle >= role.operators.len() {
        return Some((idle, "the idle operator does not exist"));
    }
    let row = &role.operators[idle];
    if row.requires.is_empty() && row.forbids.is_empty() && row.effects.is_empty() {
        None
    } else {
        Some((idle, "the idle operator has a precondition or an effect"))
    }
}

const fn remedies(role: &Role) -> Flaw {
    let mut at = 0;
    while at < role.remedies.len() {
        let row = &role.remedies[at];
        if row.missing.variable as usize >= role.facts.len() {
            return Some((at, "the missing literal is no fact"));
        }
        if row.state as usize >= role.states.names.len() {
            return Some((at, "the state that it raises does not exist"));
        }
        if let Raise::By(amount) = row.raise
            && !amount.is_finite()
        {
            return Some((at, "its raise is not finite"));
        }
        if !is_target(role, row.target) {
            return Some((at, "no operator can lead to its target"));
        }
        at += 1;
    }
    None
}

const fn aims(roles: &[Role], own: usize) -> Flaw {
    let role = &roles[own];
    if role.aims.is_empty() {
        return Some((0, "a role has at least one aim"));
    }
    let mut at = 0;
    while at < role.aims.len() {
        let row = &role.aims[at];
        if row.done.is_empty() {
            return Some((at, "nothing says when it is reached"));
        }
        if not_below(row.done, role.facts.len(), "").is_some() {
            return Some((at, "what says that it is reached is no fact"));
        }
        if !is_preference(row.preference, role.states.names.len()) {
            return Some((at, "its preference does not have a finite entry per state"));
        }
        if !is_target(role, row.target) {
            return Some((at, "no operator can lead to its target"));
        }
        if let Wish::Rows(wishes) = row.teammates {
            if wishes.len() != roles.len() {
                return Some((at, "its wishes do not have a row per robot"));
            }
            let mut robot = 0;
            while robot < roles.len() {
                if robot != own && !is_preference(wishes[robot], roles[robot].states.names.len()) {
                    return Some((at, "a wish does not have a finite entry per state of the teammate"));
                }
                robot += 1;
            }
        }
        at += 1;
    }
    unnamed!(role.aims)
}

const fn outcome(roles: &[Role], role: &Role) -> Flaw {
    let Some(outcome) = &role.outcome else { return None };
    if let Some(reason) = names(outcome.names) {
        return Some((0, reason));
    }
    if !is_preference(outcome.preference, outcome.names.len()) {
        return Some((0, "its preference does not have a finite entry per outcome"));
    }
    let (mut entries, mut robot) = (1usize, 0);
    while robot < roles.len() {
        entries = entries.saturating_mul(roles[robot].states.names.len());
        robot += 1;
    }
    if outcome.table.len() != entries {
        return Some((outcome.table.len(), "the table does not have an entry per combination of states"));
    }
    if let Some(operator) = outcome.possible
        && operator as usize >= role.operators.len()
    {
        return Some((operator as usize, "the operator that makes it possible does not exist"));
    }
    not_below(outcome.table, outcome.names.len(), "this entry is no outcome")
}

/// What is wrong with a list of names.
const fn names(names: &[&str]) -> Option<&'static str> {
    if names.is_empty() || names.len() > MAX_STATES {
        return Some("there are not 1 to 15 names");
    }
    let mut at = 0;
    while at < names.len() {
        let mut before = 0;
        while before < at {
            if same(names[before], names[at]) {
                return Some("a name is there twice");
            }
            before += 1;
        }
        if names[at].is_empty() {
            return Some("a name is empty");
        }
        at += 1;
    }
    None
}

/// Whether some operator leads to the target's factor, and that has the state.
const fn is_target(role: &Role, target: Option<u8>) -> bool {
    let Some(target) = target else { return true };
    let (mut operator, mut found) = (0, false);
    while operator < role.operators.len() {
        let (effects, mut at) = (role.operators[operator].effects, 0);
        while at < effects.len() {
            if let To::Target = effects[at].to {
                found = true;
                let factor = effects[at].factor as usize;
                if factor >= role.factors.len() || target as usize >= role.factors[factor].states.len() {
                    return false;
                }
            }
            at += 1;
        }
        operator += 1;
    }
    found
}

const fn is_teammate(roles: &[Role], own: usize, robot: u8) -> bool {
    (robot as usize) < roles.len() && robot as usize != own
}

const fn is_preference(values: &[f32], states: usize) -> bool {
    let mut at = 0;
    while at < values.len() {
        if !values[at].is_finite() {
            return false;
        }
        at += 1;
    }
    values.len() == states
}

const fn is_probability(p: f32) -> bool {
    p >= 0.0 && p <= 1.0
}

/// The first entry that is not below `limit`.
const fn not_below(list: &[u8], limit: usize, reason: &'static str) -> Flaw {
    let mut at = 0;
    while at < list.len() {
        if list[at] as usize >= limit {
            return Some((at, reason));
        }
        at += 1;
    }
    None
}

const fn contains(list: &[u8], entry: u8) -> bool {
    let mut at = 0;
    while at < list.len() {
        if list[at] == entry {
            return true;
        }
        at += 1;
    }
    false
}

const fn same(one: &str, other: &str) -> bool {
    let (one, other) = (one.as_bytes(), other.as_bytes());
    let mut at = 0;
    while at < one.len() && at < other.len() && one[at] == other[at] {
        at += 1;
    }
    one.len() == at && other.len() == at
}
