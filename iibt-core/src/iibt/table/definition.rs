//! The tables of a role: states, operators, sensors, facts and aims.

use crate::iibt::Literal;
use crate::iibt::rules::Raise;

/// The most hidden factors of one role.
pub const MAX_FACTORS: usize = 8;
/// The most states of one hidden factor, and the most semantic states of one role.
pub const MAX_STATES: usize = 15;
/// The most sensors of one role.
pub const MAX_SENSORS: usize = 8;
/// The most operators of one role.
pub const MAX_OPERATORS: usize = 16;
/// The most facts of one role.
pub const MAX_FACTS: usize = 16;

/// One robot's part of the task. References to facts, states and operators are indices into this
/// role's tables.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Role<'a> {
    /// The robot's name.
    pub name: &'a str,
    /// The hidden factors that it tracks, 1 to [`MAX_FACTORS`].
    pub factors: &'a [HiddenFactor<'a>],
    /// The semantic states that decisions and preferences are about, s^i in the paper.
    pub states: Labels<'a>,
    /// A: its sensors, read in each tick, 1 to [`MAX_SENSORS`].
    pub sensors: &'a [Sensor<'a>],
    /// U with table 5: its operators, 1 to [`MAX_OPERATORS`]; a joint policy has one of each robot.
    pub operators: &'a [Operator<'a>],
    /// The operator that stands for doing nothing: it has neither preconditions nor effects.
    pub idle: u8,
    /// The logic variables, at most [`MAX_FACTS`]. Where several preconditions are missing, the
    /// first fact of this table is seen to first.
    pub facts: &'a [Fact<'a>],
    /// f_L: the preferences while a precondition is missing.
    pub remedies: &'a [Remedy],
    /// The aims of this robot's inference nodes, at least one.
    pub aims: &'a [Aim<'a>],
    /// The outcome of the robots' states together.
    pub outcome: Option<JointOutcome<'a>>,
}

/// A hidden factor: a part of the robot's state or surroundings that it can only infer from
/// readings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HiddenFactor<'a> {
    /// Its name.
    pub name: &'a str,
    /// The names of its states, 1 to [`MAX_STATES`].
    pub states: &'a [&'a str],
    /// D: the probability of each state at the start.
    pub prior: &'a [f32],
}

/// A function of factors: a label for each combination of their states.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Labels<'a> {
    /// The names of the labels, 1 to [`MAX_STATES`].
    pub names: &'a [&'a str],
    /// The factors that it depends on.
    pub factors: &'a [u8],
    /// The label of each combination, the last factor's states running fastest.
    pub table: &'a [u8],
}

/// A sensor: its quantity and accuracy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensor<'a> {
    /// Its name.
    pub name: &'a str,
    /// The quantity that it reads.
    pub reads: Reads<'a>,
    /// Its accuracy.
    pub accuracy: Accuracy<'a>,
}

/// The quantity that a sensor reads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reads<'a> {
    /// The state of this factor.
    Factor(u8),
    /// The semantic state.
    State,
    /// Another function of factors.
    Labels(Labels<'a>),
}

/// The probability of each reading given the truth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Accuracy<'a> {
    /// Right with this probability; each wrong reading has an equal share of the rest.
    Even(f32),
    /// P(reading | truth): a row per reading, a column per truth, each column a distribution.
    Table(&'a [f32]),
}

/// An action with its preconditions and postconditions: a row of the paper's table 5.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Operator<'a> {
    /// Its name.
    pub name: &'a str,
    /// The facts that must hold before it is begun.
    pub requires: &'a [u8],
    /// The facts that must not hold.
    pub forbids: &'a [u8],
    /// Its effect on the robot's semantic state when joint policies are compared.
    pub brings: Postcondition,
    /// Its effects on the hidden factors when it succeeds; the first effect whose condition is met
    /// counts for its factor.
    pub effects: &'a [Effect<'a>],
    /// B: the probability that it succeeds. When it fails, no factor changes.
    pub success: f32,
    /// ln E up to a constant: its log prior probability, in nats.
    pub habit: f32,
}

/// The result of an operator when joint policies are compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Postcondition {
    /// The state stays as it is.
    Nothing,
    /// This state with this probability, else the state stays as it is.
    State(u8, f32),
    /// The first state with this probability, else the second, whatever was before.
    Reset(u8, f32, u8),
}

/// The effect of an operator on one factor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effect<'a> {
    /// The conditions under which it happens.
    pub given: &'a [Given],
    /// The factor that changes.
    pub factor: u8,
    /// Its new state.
    pub to: To,
}

/// A condition on a factor in the world.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Given {
    /// A teammate's number where the factor is a teammate's. A robot does not track it: it takes it
    /// to be as the operator's preconditions ask.
    pub robot: Option<u8>,
    /// The factor.
    pub factor: u8,
    /// The state that it must be in.
    pub state: u8,
}

/// The new state of a factor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum To {
    /// This state.
    State(u8),
    /// The target: the state that the last remedy, or else the aim, names.
    Target,
}

/// A logic variable, l in the paper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fact<'a> {
    /// Its name.
    pub name: &'a str,
    /// The condition under which it is true.
    pub holds: Holds<'a>,
}

/// The condition under which a logic variable is true.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Holds<'a> {
    /// The robot is sure that its factor is in one of these states.
    Sure {
        /// The factor.
        factor: u8,
        /// The states.
        states: &'a [u8],
    },
    /// The robot is sure that this factor is in the state that is the target.
    AtTarget {
        /// The factor.
        factor: u8,
    },
    /// A teammate has announced that it is sure of one of these states.
    Announced {
        /// The teammate's number.
        robot: u8,
        /// Its factor.
        factor: u8,
        /// The states.
        states: &'a [u8],
    },
    /// A teammate has announced that one of these operators is under way.
    Doing {
        /// The teammate's number.
        robot: u8,
        /// Its operators, its idle one included.
        operators: &'a [u8],
    },
}

/// A row of f_L: the preferences while a precondition is missing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Remedy {
    /// The missing literal; its variable is a fact.
    pub missing: Literal,
    /// The own semantic state whose preference is raised.
    pub state: u8,
    /// The size of the raise.
    pub raise: Raise,
    /// The state that becomes the target.
    pub target: Option<u8>,
}

/// The aim of an inference node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aim<'a> {
    /// Its name.
    pub name: &'a str,
    /// The facts that hold when it is reached: the precondition of stopping.
    pub done: &'a [u8],
    /// C over the own semantic states.
    pub preference: &'a [f32],
    /// C over the teammates' states.
    pub teammates: Wish<'a>,
    /// The target until a remedy names another.
    pub target: Option<u8>,
}

/// The preferences of a robot for its teammates' states.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Wish<'a> {
    /// To be in the state to which their announced operator leads.
    AsAnnounced,
    /// For each robot by its number, C over its states; the own row is not read.
    Rows(&'a [&'a [f32]]),
}

/// An outcome that the states of all robots determine together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointOutcome<'a> {
    /// The names of the outcomes.
    pub names: &'a [&'a str],
    /// C over the outcomes.
    pub preference: &'a [f32],
    /// The outcome of each combination of the robots' semantic states, the last robot's running
    /// fastest.
    pub table: &'a [u8],
    /// The outcome counts only while the preconditions of this own operator hold.
    pub possible: Option<u8>,
}

impl<'a> Role<'a> {
    /// A role that has only factors, for the other tables to be filled in: a struct update.
    ///
    /// Its semantic states are the states of the first factor, and its first operator is the idle
    /// one.
    #[must_use]
    pub const fn of(factors: &'a [HiddenFactor<'a>]) -> Self {
        let states = match factors {
            [first, ..] => Labels::of_factor(0, first.states),
            [] => Labels::of_factor(0, &[]),
        };
        Self {
            name: "",
            factors,
            states,
            sensors: &[],
            operators: &[Operator::IDLE],
            idle: 0,
            facts: &[],
            remedies: &[],
            aims: &[],
            outcome: None,
        }
    }

    /// How many states all factors have together.
    #[must_use]
    pub const fn tracked(&self) -> usize {
        let (mut sum, mut factor) = (0, 0);
        while factor < self.factors.len() {
            sum += self.factors[factor].states.len();
            factor += 1;
        }
        sum
    }
}

impl<'a> HiddenFactor<'a> {
    /// A factor of which nothing is known at the start: each state is equally likely.
    #[must_use]
    pub const fn unknown<const N: usize>(name: &'a str, states: &'a [&'a str; N]) -> Self {
        Self { name, states, prior: const { &[1.0 / N as f32; N] } }
    }

    /// A factor that is known to be in its first state at the start.
    #[must_use]
    pub const fn known<const N: usize>(name: &'a str, states: &'a [&'a str; N]) -> Self {
        let prior = const {
            let mut prior = [0.0; N];
            if let [first, ..] = prior.as_mut_slice() {
                *first = 1.0;
            }
            &{ prior }
        };
        Self { name, states, prior }
    }
}

impl<'a> Labels<'a> {
    /// The states of one factor, with the names that they have there.
    #[must_use]
    pub const fn of_factor(factor: u8, states: &'a [&'a str]) -> Self {
        Self { names: states, factors: run(NUMBERS, factor, 1), table: run(NUMBERS, 0, states.len()) }
    }

    /// The label of a combination of the states of all factors of the role; label zero outside the
    /// table.
    #[must_use]
    pub fn of(&self, factors: &[HiddenFactor<'_>], state: impl Fn(usize) -> usize) -> usize {
        let place = self.factors.iter().fold(0, |place, &factor| {
            let states = factors.get(usize::from(factor)).map_or(1, |factor| factor.states.len());
            place * states + state(usize::from(factor))
        });
        self.table.get(place).copied().map_or(0, usize::from)
    }
}

impl<'a> Sensor<'a> {
    /// A sensor that is right with this probability; each wrong reading has an equal share of the
    /// rest.
    #[must_use]
    pub const fn even(name: &'a str, reads: Reads<'a>, right: f32) -> Self {
        Self { name, reads, accuracy: Accuracy::Even(right) }
    }
}

impl<'a> Operator<'a> {
    /// An operator that brings the first factor into a state with this probability, where the
    /// semantic states are those of that factor, as in [`Role::of`].
    #[must_use]
    pub const fn bringing(name: &'a str, state: u8, success: f32) -> Self {
        const SETS: &[Effect<'static>] = &{
            let (mut sets, mut state) = ([Effect::set(0, 0); MAX_STATES], 0);
            while state < MAX_STATES {
                sets[state] = Effect::set(0, state as u8);
                state += 1;
            }
            sets
        };
        let (brings, effects) = (Postcondition::State(state, success), run(SETS, state, 1));
        Self { name, brings, effects, success, ..Self::IDLE }
    }

    /// The operator that does nothing and needs nothing.
    pub const IDLE: Self = Self {
        name: "idle",
        requires: &[],
        forbids: &[],
        brings: Postcondition::Nothing,
        effects: &[],
        success: 1.0,
        habit: 0.0,
    };

    /// The new state of a factor when the operator succeeds: `None` when it stays. `is` tells the
    /// state of a factor, of a teammate's where a number is given, and `None` where that is not
    /// known.
    #[must_use]
    pub fn becomes(
        &self,
        factor: usize,
        target: Option<u8>,
        is: &dyn Fn(Option<u8>, usize) -> Option<usize>,
    ) -> Option<usize> {
        let holds = |given: &Given| {
            is(given.robot, usize::from(given.factor)).is_none_or(|now| now == usize::from(given.state))
        };
        let applies =
            |effect: &&Effect<'_>| usize::from(effect.factor) == factor && effect.given.iter().all(holds);
        match self.effects.iter().find(applies)?.to {
            To::State(state) => Some(usize::from(state)),
            To::Target => target.map(usize::from),
        }
    }

    /// Whether it leads to the target.
    #[must_use]
    pub fn is_targeted(&self) -> bool {
        self.effects.iter().any(|effect| effect.to == To::Target)
    }

    /// Whether it may change a factor.
    #[must_use]
    pub fn changes(&self, factor: usize) -> bool {
        self.effects.iter().any(|effect| usize::from(effect.factor) == factor)
    }
}

impl<'a> Effect<'a> {
    /// Sets a factor to a state, whatever its state before.
    #[must_use]
    pub const fn set(factor: u8, state: u8) -> Self {
        Self { given: &[], factor, to: To::State(state) }
    }
}

impl<'a> Fact<'a> {
    /// The robot is sure that its factor is in one of these states.
    #[must_use]
    pub const fn sure(name: &'a str, factor: u8, states: &'a [u8]) -> Self {
        Self { name, holds: Holds::Sure { factor, states } }
    }

    /// A teammate has announced that it is sure of one of these states of its factor.
    #[must_use]
    pub const fn announced(name: &'a str, robot: u8, factor: u8, states: &'a [u8]) -> Self {
        Self { name, holds: Holds::Announced { robot, factor, states } }
    }

    /// A teammate has announced that one of these operators is under way.
    #[must_use]
    pub const fn doing(name: &'a str, robot: u8, operators: &'a [u8]) -> Self {
        Self { name, holds: Holds::Doing { robot, operators } }
    }
}

impl Remedy {
    /// While a fact is missing, prefer a semantic state above all else.
    #[must_use]
    pub const fn above_all(missing: u8, state: u8) -> Self {
        let missing = Literal { variable: missing, value: true };
        Self { missing, state, raise: Raise::AboveAll, target: None }
    }
}

impl<'a> Aim<'a> {
    /// An aim without a target whose teammates are to do what they announce.
    #[must_use]
    pub const fn new(name: &'a str, done: &'a [u8], preference: &'a [f32]) -> Self {
        Self { name, done, preference, teammates: Wish::AsAnnounced, target: None }
    }
}

impl Given {
    /// A factor of the robot itself is in this state.
    #[must_use]
    pub const fn own(factor: u8, state: u8) -> Self {
        Self { robot: None, factor, state }
    }

    /// A teammate's factor is in this state.
    #[must_use]
    pub const fn of(robot: u8, factor: u8, state: u8) -> Self {
        Self { robot: Some(robot), factor, state }
    }
}

/// The numbers of states and factors.
const NUMBERS: &[u8] = &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14];

/// `count` rows from one on, or as many as there are.
const fn run<T>(rows: &[T], from: u8, count: usize) -> &[T] {
    let Some((_, rest)) = rows.split_at_checked(from as usize) else { return &[] };
    let Some((run, _)) = rest.split_at_checked(count) else { return rest };
    run
}
