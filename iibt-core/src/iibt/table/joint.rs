//! The joint policies of a round: made from the tables and the facts of its members, alike in every
//! robot.

use super::announcement::Announcement;
use super::definition::{Fact, Holds, Operator, Role};
use super::tables::Tables;
use crate::iibt::{cheapest_policy, weigh};
use crate::inference::{Eighths, WeighedPolicies, worth_of_nats};
use crate::team::RobotId;
use crate::team::rounds::{JointPolicies, Score};
use heapless::Vec;

/// The most joint policies that a team weighs in a round.
pub const MAX_POLICIES: usize = 16;

/// The numbers of the joint policies of a round, in the order in which equals are chosen.
pub(super) type List = Vec<u16, MAX_POLICIES>;

/// Whether a fact about a teammate holds, by the members' announcements and by what they are doing;
/// `None` for a fact about the robot itself.
///
/// Of a robot that has announced nothing, nothing holds.
pub(super) fn holds_of_teammate<const N: usize>(
    fact: &Fact<'_>,
    said: &[Option<Announcement>; N],
    doing: impl Fn(usize) -> u8,
) -> Option<bool> {
    let of = |robot: u8| said.get(usize::from(robot)).copied().flatten();
    match fact.holds {
        Holds::Sure { .. } | Holds::AtTarget { .. } => None,
        Holds::Announced { robot, factor, states } => {
            let state = of(robot).and_then(|said| said.state(usize::from(factor)));
            Some(state.is_some_and(|state| states.contains(&state)))
        }
        Holds::Doing { robot, operators } => {
            Some(of(robot).is_some() && operators.contains(&doing(usize::from(robot))))
        }
    }
}

/// The list of a round while it is made: one joint policy after the other.
#[derive(Clone, Debug, Default)]
pub(super) struct Listing {
    list: List,
    /// The first joint policy that is not yet looked at.
    next: u16,
    is_done: bool,
}

impl Listing {
    /// Looks at more joint policies, one for each work unit; returns whether the list is done.
    ///
    /// What is known must be the same in every call. The list does not depend on how the work was
    /// cut.
    pub(super) fn work<const N: usize>(&mut self, known: &Known<'_, N>, budget: &mut u32) -> bool {
        while !self.is_done {
            let Some(left) = budget.checked_sub(1) else { return false };
            *budget = left;
            known.offer(self.next, &mut self.list);
            self.next = self.next.saturating_add(1);
            self.is_done = usize::from(self.next) >= known.tables.policies();
            if self.is_done {
                // There is room for one more.
                let _ = self.list.push(known.stay());
            }
        }
        true
    }

    /// The joint policies, once the list is done.
    pub(super) fn policies(&self) -> &[u16] {
        if self.is_done { &self.list } else { &[] }
    }
}

/// The joint policies of a round in which the robots have announced these facts, by their numbers:
/// those that all preconditions allow, at most [`MAX_POLICIES`]. First come those in which the most
/// robots do what they intend; the last one leaves all as they are.
///
/// `facts` has an entry for each robot, `None` for one that is no member of the round. Costs a look
/// at each of the [`policies`](Tables::policies) of the tables.
///
/// ```
/// use iibt_core::iibt::table::*;
///
/// const VALVE: Role = Role {
///     sensors: &[Sensor::even("position", Reads::Factor(0), 0.9)],
///     operators: &[Operator::IDLE, Operator { forbids: &[0], ..Operator::bringing("turn", 1, 0.8) }],
///     facts: &[Fact::sure("closed", 0, &[1])],
///     aims: &[Aim::new("close", &[0], &[0.0, 1.0])],
///     ..Role::of(&[HiddenFactor::known("valve", &["open", "closed"])])
/// };
/// static VALVES: Tables =
///     Tables::new(&[Role { name: "inlet", ..VALVE }, Role { name: "outlet", ..VALVE }]);
///
/// // The inlet is closed, and idle; the outlet is open, and its robot would turn it.
/// let facts = [Announcement::new([Some(1)], 0, 0), Announcement::new([Some(0)], 0, 1)];
/// let policies = joint_policies(&VALVES, &facts.map(Some));
/// let parts = |policy| [0, 1].map(|robot| VALVES.part(policy, robot));
/// assert!(policies.iter().map(|&policy| parts(policy)).eq([[0, 1], [0, 0]]));
/// ```
#[must_use]
pub fn joint_policies<const N: usize>(
    tables: &Tables<'_>,
    facts: &[Option<Announcement>; N],
) -> Vec<u16, MAX_POLICIES> {
    let mut listing = Listing::default();
    let mut unlimited = u32::MAX;
    listing.work(&Known { tables, said: facts }, &mut unlimited);
    listing.list
}

/// What a round is decided from: the tables, and the announcements of its members.
#[derive(Clone, Copy)]
pub(super) struct Known<'a, const N: usize> {
    pub(super) tables: &'a Tables<'a>,
    /// `None` for a robot that is no member.
    pub(super) said: &'a [Option<Announcement>; N],
}

impl<const N: usize> Known<'_, N> {
    /// Puts a joint policy in its place in a list, if all preconditions allow it: behind those in
    /// which as many robots do what they intend. The last place is left for the one that leaves all
    /// as they are.
    fn offer(&self, policy: u16, list: &mut List) {
        if self.stay() == policy || !self.is_feasible(policy) {
            return;
        }
        let missed = self.missed(policy);
        let before = list.iter().filter(|&&other| self.missed(other) <= missed).count();
        let mut moved = policy;
        for place in list.iter_mut().skip(before) {
            core::mem::swap(place, &mut moved);
        }
        if list.len() + 1 < MAX_POLICIES {
            // There is room.
            let _ = list.push(moved);
        }
    }

    /// The joint policy that leaves all robots as they are.
    fn stay(&self) -> u16 {
        let roles = self.tables.roles().iter().enumerate();
        let number = roles.fold(0_usize, |number, (robot, role)| {
            number.saturating_mul(role.operators.len()).saturating_add(self.under_way(robot).into())
        });
        // The tables were checked: no number is larger.
        u16::try_from(number).unwrap_or(u16::MAX)
    }

    /// The robots with their roles and their parts.
    fn each(&self, policy: u16) -> impl Iterator<Item = (usize, &Role<'_>, u8)> {
        let roles = self.tables.roles().iter().enumerate();
        roles.map(move |(robot, role)| (robot, role, self.tables.part(policy, robot)))
    }

    /// The number of robots that do not do what they intend.
    fn missed(&self, policy: u16) -> usize {
        let intends = |robot| self.of(robot).map_or(self.idle(robot), |said| said.intends());
        self.each(policy).filter(|&(robot, _, part)| part != intends(robot)).count()
    }

    fn of(&self, robot: usize) -> Option<&Announcement> {
        self.said.get(robot)?.as_ref()
    }

    fn idle(&self, robot: usize) -> u8 {
        self.tables.role(robot).map_or(0, |role| role.idle)
    }

    /// The operator that a robot has under way; of a robot left out, none is known.
    fn under_way(&self, robot: usize) -> u8 {
        let said = self.of(robot).map(Announcement::operator);
        let known = said.filter(|&operator| self.operators(robot) > usize::from(operator));
        known.unwrap_or(self.idle(robot))
    }

    fn operators(&self, robot: usize) -> usize {
        self.tables.role(robot).map_or(0, |role| role.operators.len())
    }

    fn is_feasible(&self, policy: u16) -> bool {
        self.each(policy).all(|(robot, role, part)| {
            let (idle, under_way) = (role.idle, self.under_way(robot));
            if under_way != idle || self.of(robot).is_none() {
                return part == under_way;
            }
            part == idle || self.may_begin(robot, role, part, policy)
        })
    }

    /// Whether nothing that all know forbids a robot to begin its part of a policy.
    fn may_begin(&self, robot: usize, role: &Role<'_>, part: u8, policy: u16) -> bool {
        let Some(operator) = role.operators.get(usize::from(part)) else { return false };
        let is = |fact: &u8, value: bool| {
            let fact = role.facts.get(usize::from(*fact));
            // What only the robot itself knows speaks against nothing here: it goes into its
            // scores.
            fact.and_then(|fact| self.holds(robot, fact, policy)).is_none_or(|holds| holds == value)
        };
        operator.requires.iter().all(|fact| is(fact, true))
            && operator.forbids.iter().all(|fact| is(fact, false))
    }

    /// Whether nothing ties the others to what a robot does after its part of a choice: an outcome,
    /// a condition of what they do or, unless it `may_hold_up`, of what they could begin.
    ///
    /// As long as another can go on as well, the operator depends on no teammate, so that both may
    /// begin at once.
    pub(super) fn goes_on(&self, choice: u16, own: usize, operator: u8, may_hold_up: bool) -> bool {
        let is_untied = |(robot, role, part): (usize, &Role<'_>, u8)| {
            let is_possible = |of: u8| self.may_begin(robot, role, of, choice);
            let judges =
                role.outcome.as_ref().is_some_and(|outcome| outcome.possible.is_none_or(is_possible));
            let held_up = || (0..role.operators.len()).any(|of| !allows(role, of as u8, own, operator));
            !judges && allows(role, part, own, operator) && (may_hold_up || !held_up())
        };
        let waits = |(_, role, part): (usize, &Role<'_>, u8)| part == role.idle;
        self.others(choice, own).all(is_untied)
            && (self.others(choice, own).all(waits)
                || self.tables.role(own).is_some_and(|role| is_independent(role, operator)))
    }

    fn others(&self, policy: u16, own: usize) -> impl Iterator<Item = (usize, &Role<'_>, u8)> {
        self.each(policy).filter(move |&(robot, ..)| robot != own)
    }

    fn holds(&self, robot: usize, fact: &Fact<'_>, policy: u16) -> Option<bool> {
        if let Holds::Sure { factor, states } = fact.holds {
            let state = self.of(robot).and_then(|said| said.state(usize::from(factor)));
            return Some(state.is_some_and(|state| states.contains(&state)));
        }
        holds_of_teammate(fact, self.said, |robot| self.tables.part(policy, robot))
    }
}

/// The facts of an operator's preconditions, with the values that they are to have.
fn preconditions<'a>(role: &Role<'a>, operator: u8) -> impl Iterator<Item = (&'a Fact<'a>, bool)> + use<'a> {
    let facts = role.facts;
    let operator = role.operators.get(usize::from(operator)).copied().unwrap_or(Operator::IDLE);
    let literals = operator.requires.iter().zip(core::iter::repeat(true));
    let literals = literals.chain(operator.forbids.iter().zip(core::iter::repeat(false)));
    literals.filter_map(move |(fact, value)| Some((facts.get(usize::from(*fact))?, value)))
}

/// Whether an operator can be under way while a teammate does `does`.
fn allows(role: &Role<'_>, operator: u8, teammate: usize, does: u8) -> bool {
    preconditions(role, operator).all(|(fact, value)| match fact.holds {
        Holds::Doing { robot, operators } if usize::from(robot) == teammate => {
            operators.contains(&does) == value
        }
        _ => true,
    })
}

/// Whether no precondition of an operator is about a teammate.
fn is_independent(role: &Role<'_>, operator: u8) -> bool {
    preconditions(role, operator)
        .all(|(fact, _)| matches!(fact.holds, Holds::Sure { .. } | Holds::AtTarget { .. }))
}

/// The joint policies of a round, as the rounds ask about them.
///
/// Robots with table tasks share no space: nothing is claimed, and no robot waits for another's
/// steps.
#[derive(Clone, Copy)]
pub(super) struct OnTables<'a> {
    pub(super) tables: &'a Tables<'a>,
    pub(super) policies: &'a [u16],
}

impl OnTables<'_> {
    /// The posterior over the policies by the scores of all members, with a precision of γ nats for
    /// each nat of C.
    pub(super) fn weigh<'s>(
        &self,
        members: impl Iterator<Item = (RobotId, &'s [Score])> + Clone,
    ) -> WeighedPolicies<MAX_POLICIES> {
        weigh(self, members, self.tables.precision())
    }

    /// -ln E of a robot's operator, against the likeliest of its role.
    fn unlikely(role: &Role<'_>, operator: u8) -> f32 {
        let habit = |of: &Operator<'_>| of.habit;
        let most = role.operators.iter().map(habit).fold(f32::NEG_INFINITY, f32::max);
        role.operators.get(usize::from(operator)).map_or(0.0, |operator| most - operator.habit)
    }
}

impl JointPolicies for OnTables<'_> {
    type Claim = ();

    fn len(&self) -> usize {
        self.policies.len()
    }

    /// Nothing: what a policy is worth, its robots know best. It is in their scores.
    fn cost(&self, _: usize) -> u16 {
        0
    }

    /// -ln E / γ of all robots' operators.
    fn habit(&self, policy: usize) -> Eighths {
        let Some(&policy) = self.policies.get(policy) else { return 0 };
        let roles = self.tables.roles().iter().enumerate();
        let nats: f32 =
            roles.map(|(robot, role)| Self::unlikely(role, self.tables.part(policy, robot))).sum();
        worth_of_nats(nats, self.tables.precision())
    }

    fn claim(&self, _: usize, _: RobotId, _: u16) {}

    /// None that others would have to wait for.
    fn moves(&self, _: usize, _: RobotId) -> u16 {
        0
    }

    fn is_clear(&self, _: usize, _: RobotId, _: u16, _: RobotId, _: u16) -> bool {
        true
    }

    fn choose<'s>(&self, members: impl Iterator<Item = (RobotId, &'s [Score])> + Clone) -> Option<usize> {
        cheapest_policy(self, members)
    }
}

/// What a robot's parts cost it, as prices in eighths of a nat against the cheapest in the list, by
/// -G of each policy, or `None` if the robot cannot do its part.
pub(super) fn prices(values: impl Iterator<Item = Option<f32>> + Clone) -> Vec<Score, MAX_POLICIES> {
    let best = values.clone().flatten().fold(f32::NEG_INFINITY, f32::max);
    let price = |value: Option<f32>| match value {
        Some(value) => Score { delay: 0, price: Score::finite(worth_of_nats(best - value, 1.0)) },
        None => Score::CANNOT,
    };
    crate::bounded::up_to(values.map(price))
}

#[cfg(test)]
mod tests {
    use super::super::{Aim, HiddenFactor, JointOutcome, Reads, Sensor};
    use super::*;

    const IDLE: u8 = 0;
    const TURN: u8 = 1;

    /// A robot that turns its valve by habit, while the other is idle.
    const fn valve(name: &'static str, facts: &'static [Fact<'static>]) -> Role<'static> {
        const OPERATORS: &[Operator<'static>] =
            &[Operator::IDLE, Operator { requires: &[1], habit: 1.0, ..Operator::bringing("turn", 1, 0.9) }];
        const FACTORS: &[HiddenFactor<'static>] = &[HiddenFactor::known("valve", &["open", "closed"])];
        const AIMS: &[Aim<'static>] = &[Aim::new("close", &[0], &[0.0, 1.0])];
        const SENSORS: &[Sensor<'static>] = &[Sensor::even("eye", Reads::Factor(0), 0.9)];
        Role { name, facts, sensors: SENSORS, operators: OPERATORS, aims: AIMS, ..Role::of(FACTORS) }
    }

    static TWO: Tables = Tables::new(&[
        valve("one", &[Fact::sure("closed", 0, &[1]), Fact::doing("other idle", 1, &[IDLE])]),
        valve("two", &[Fact::sure("closed", 0, &[1]), Fact::doing("other idle", 0, &[IDLE])]),
    ]);

    fn said(operator: u8) -> Option<Announcement> {
        Some(Announcement::new([Some(0)], operator, TURN))
    }

    fn list(said: [Option<Announcement>; 2]) -> List {
        joint_policies(&TWO, &said)
    }

    #[test]
    fn a_list_has_what_the_facts_allow_and_at_last_all_as_it_is() {
        assert_eq!(list([said(IDLE), said(IDLE)]), [1, 2, 0], "not both at once");
        assert_eq!(list([said(TURN), said(IDLE)]), [2], "one goes on, so the other may not begin");
        assert_eq!(list([said(IDLE), None]), [0], "nothing is known of a robot left out");
        assert_eq!(list([said(9), said(IDLE)]), [1, 2, 0], "an operator that its role does not have");
    }

    /// A robot with five operators: 25 joint policies for two.
    const fn handy(name: &'static str) -> Role<'static> {
        const fn named(name: &'static str) -> Operator<'static> {
            Operator { name, ..Operator::bringing("", 1, 0.9) }
        }
        const OPERATORS: &[Operator<'static>] =
            &[Operator::IDLE, named("a"), named("b"), named("c"), named("d")];
        Role { name, operators: OPERATORS, ..valve(name, FACTS) }
    }

    const FACTS: &[Fact<'static>] = &[Fact::sure("closed", 0, &[1])];

    static HANDY: Tables = Tables::new(&[handy("one"), handy("two")]);

    #[test]
    fn a_list_without_room_for_all_has_what_the_robots_intend() {
        let intends = |operator| Some(Announcement::new([Some(0)], IDLE, operator));
        let said = [intends(4), intends(3)];
        let list = joint_policies(&HANDY, &said);
        for units in 1..=26 {
            let (mut listing, mut ticks) = (Listing::default(), 1);
            while !listing.work(&Known { tables: &HANDY, said: &said }, &mut { units }) {
                assert!(listing.policies().is_empty(), "not before it is done");
                ticks += 1;
            }
            assert_eq!((listing.policies(), ticks), (&list[..], 25_u32.div_ceil(units)), "{units} a tick");
        }
        assert_eq!((list.len(), list.first(), list.last()), (MAX_POLICIES, Some(&(4 * 5 + 3)), Some(&0)));
        let one_of_them = |&policy: &u16| policy / 5 == 4 || policy % 5 == 3;
        assert_eq!(
            list.iter().filter(|policy| one_of_them(policy)).count(),
            9,
            "both, and each with the other's four"
        );
    }

    #[test]
    fn a_robot_goes_on_where_nothing_ties_the_others_to_what_it_does() {
        let fact = |operator| Some(Announcement::new([Some(0)], operator, TURN));
        let goes_on = |tables: &Tables<'_>, choice, may_hold_up| {
            Known { tables, said: &[fact(IDLE), fact(IDLE)] }.goes_on(choice, 0, TURN, may_hold_up)
        };
        assert!(goes_on(&TWO, 2, true), "the other does nothing");
        assert!(!goes_on(&TWO, 2, false), "the other could begin as soon as this one is idle");
        assert!(!goes_on(&TWO, 3, true), "the other turns only while this one is idle");
        assert!(goes_on(&HANDY, 5 + 3, false), "neither depends on the other");
        assert!(!goes_on(&JUDGED, 2, true), "what comes of it concerns the other");
        assert!(goes_on(&LATER, 2, true), "as yet nothing comes of it");
    }

    const UNEVEN: JointOutcome<'static> = JointOutcome {
        names: &["even", "uneven"],
        preference: &[0.0, -3.0],
        table: &[0, 1, 1, 0],
        possible: None,
    };

    static LATER: Tables = Tables::new(&[
        valve("one", &[Fact::sure("closed", 0, &[1]), Fact::doing("other idle", 1, &[IDLE])]),
        Role {
            outcome: Some(JointOutcome { possible: Some(TURN), ..UNEVEN }),
            ..valve("two", &[Fact::sure("closed", 0, &[1]), Fact::doing("other idle", 0, &[IDLE])])
        },
    ]);

    static JUDGED: Tables = Tables::new(&[
        valve("one", &[Fact::sure("closed", 0, &[1]), Fact::doing("other idle", 1, &[IDLE])]),
        Role {
            outcome: Some(UNEVEN),
            ..valve("two", &[Fact::sure("closed", 0, &[1]), Fact::doing("other idle", 0, &[IDLE])])
        },
    ]);

    #[test]
    fn the_habits_of_all_robots_count_in_eighths_of_a_nat_over_the_precision() {
        let keen = TWO.with_precision(2.0).expect("it is a precision");
        for (tables, eighths) in [(&TWO, 8), (&keen, 4)] {
            let policies = OnTables { tables, policies: &[0, 1, 2, 3] };
            let habits = [0, 1, 2, 3].map(|policy| policies.habit(policy));
            assert_eq!(habits, [2 * eighths, eighths, eighths, 0]);
            let even = [Score::default(); 4];
            let choice = policies.choose([(RobotId(0), &even[..]), (RobotId(1), &even[..])].into_iter());
            assert_eq!(choice, Some(3), "the likeliest, where nothing else speaks");
        }
    }

    #[test]
    fn prices_are_against_the_cheapest_and_what_cannot_be_done_is_impossible() {
        let values = [Some(1.0), Some(1.5), None, Some(-99.0)].into_iter();
        let prices = prices(values).iter().map(|score| score.price).collect::<Vec<_, 4>>();
        assert_eq!(prices, [4, 0, Score::IMPOSSIBLE, Score::IMPOSSIBLE - 1]);
    }
}
