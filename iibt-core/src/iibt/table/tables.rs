//! A team's tables, checked as a whole.

use super::check::check;
use super::definition::{Fact, Holds, Operator, Role};
use super::error::TablesError;
use crate::team::Fnv1a;

/// A team's task, written as tables and checked as a whole.
///
/// In a `const` or `static` a mismatch fails the build with a message that names the table and the
/// index. See the [module](super) for a worked example.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tables<'a> {
    roles: &'a [Role<'a>],
    precision: f32,
    confidence: f32,
    mission: u64,
}

impl<'a> Tables<'a> {
    /// The precision γ of [`new`](Self::new): joint policies are compared as the paper's section
    /// 6.2 does.
    pub const PRECISION: f32 = 1.0;

    /// The confidence of [`new`](Self::new).
    pub const CONFIDENCE: f32 = 0.999;

    /// The tables of a team, a role for each robot in the order of their numbers.
    ///
    /// # Panics
    /// When something does not fit, with the text of the [`TablesError`]; in a `const` or `static`
    /// this fails the build.
    #[must_use]
    pub const fn new(roles: &'a [Role<'a>]) -> Self {
        match Self::try_new(roles) {
            Ok(tables) => tables,
            Err(error) => error.fail(),
        }
    }

    /// Checks tables that are only known at run time.
    ///
    /// # Errors
    /// The first [`TablesError`] found.
    pub const fn try_new(roles: &'a [Role<'a>]) -> Result<Self, TablesError> {
        match check(roles) {
            Ok(()) => {
                let (precision, confidence) = (Self::PRECISION, Self::CONFIDENCE);
                Ok(Self { roles, precision, confidence, mission: mission(roles, precision) })
            }
            Err(error) => Err(error),
        }
    }

    /// Sets the precision γ of the choice among joint policies.
    ///
    /// # Errors
    /// [`TablesError`] when it is negative or not finite.
    pub const fn with_precision(self, precision: f32) -> Result<Self, TablesError> {
        if precision >= 0.0 && precision.is_finite() {
            Ok(Self { precision, mission: mission(self.roles, precision), ..self })
        } else {
            Err(TablesError::of_team("precision", "it is negative or not finite"))
        }
    }

    /// Sets the least probability at which a robot is sure of a state and acts on it.
    ///
    /// # Errors
    /// [`TablesError`] when it is no probability above one half.
    pub const fn with_confidence(self, confidence: f32) -> Result<Self, TablesError> {
        if confidence > 0.5 && confidence < 1.0 {
            Ok(Self { confidence, ..self })
        } else {
            Err(TablesError::of_team("confidence", "it is not between 0.5 and 1, both excluded"))
        }
    }

    /// The roles, in the order of the robots' numbers.
    #[must_use]
    pub const fn roles(&self) -> &'a [Role<'a>] {
        self.roles
    }

    /// One robot's role.
    #[must_use]
    pub fn role(&self, robot: usize) -> Option<&'a Role<'a>> {
        self.roles.get(robot)
    }

    /// γ, the precision of the choice among joint policies.
    #[must_use]
    pub const fn precision(&self) -> f32 {
        self.precision
    }

    /// The least probability at which a robot is sure of a state.
    #[must_use]
    pub const fn confidence(&self) -> f32 {
        self.confidence
    }

    /// A hash of the names in these tables and of all that the joint policies of a round depend on,
    /// for the firmware's `Robot::mission`. Robots with other tables reject each other's frames.
    #[must_use]
    pub const fn mission(&self) -> u64 {
        self.mission
    }

    /// The number of robots: the `N` of a [`TableTask`](super::TableTask).
    #[must_use]
    pub const fn robots(&self) -> usize {
        self.roles.len()
    }

    /// The number of states of a belief: the `S` of a [`TableTask`](super::TableTask).
    #[must_use]
    pub const fn states(&self) -> usize {
        let (mut most, mut role) = (0, 0);
        while role < self.roles.len() {
            let (semantic, tracked) = (self.roles[role].states.names.len(), self.roles[role].tracked());
            most = if semantic > most { semantic } else { most };
            most = if tracked > most { tracked } else { most };
            role += 1;
        }
        most
    }

    /// A robot's part of a joint policy, by the numbers of policy, robot and operator: the last
    /// robot's operators run fastest.
    #[must_use]
    pub fn part(&self, policy: u16, robot: usize) -> u8 {
        let later = self.roles.iter().skip(robot + 1).map(|role| role.operators.len());
        let own = self.role(robot).map_or(1, |role| role.operators.len().max(1));
        let rest = usize::from(policy) / later.product::<usize>().max(1);
        (rest % own) as u8
    }

    /// The number of joint policies: the `P` of a [`TableTask`](super::TableTask).
    #[must_use]
    pub const fn policies(&self) -> usize {
        let (mut product, mut role) = (1, 0);
        while role < self.roles.len() {
            product *= self.roles[role].operators.len();
            role += 1;
        }
        product
    }
}

/// The hash of everything that announcements refer to, and that a team's list of joint policies
/// depends on.
const fn mission(roles: &[Role], precision: f32) -> u64 {
    let (mut hash, mut at) = (Fnv1a::EMPTY.write(&precision.to_le_bytes()), 0);
    while at < roles.len() {
        let (role, mut row) = (&roles[at], 0);
        hash = hash.write(role.name.as_bytes()).write(&[0, role.idle]);
        while row < role.factors.len() {
            let (states, mut state) = (role.factors[row].states, 0);
            while state < states.len() {
                hash = hash.write(states[state].as_bytes()).write(&[1]);
                state += 1;
            }
            row += 1;
        }
        row = 0;
        while row < role.operators.len() {
            hash = with_operator(hash, &role.operators[row]);
            row += 1;
        }
        row = 0;
        while row < role.facts.len() {
            hash = with_fact(hash, &role.facts[row]);
            row += 1;
        }
        at += 1;
    }
    hash.finish()
}

const fn with_operator(hash: Fnv1a, operator: &Operator) -> Fnv1a {
    let hash = hash.write(operator.name.as_bytes()).write(&operator.habit.to_le_bytes());
    hash.write(&[2]).write(operator.requires).write(&[u8::MAX]).write(operator.forbids)
}

const fn with_fact(hash: Fnv1a, fact: &Fact) -> Fnv1a {
    match fact.holds {
        Holds::Sure { factor, states } => hash.write(&[3, factor]).write(states),
        Holds::AtTarget { factor } => hash.write(&[4, factor]),
        Holds::Announced { robot, factor, states } => hash.write(&[5, robot, factor]).write(states),
        Holds::Doing { robot, operators } => hash.write(&[6, robot]).write(operators),
    }
}
