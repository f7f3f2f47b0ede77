//! The joint policies of a round: made from the tables and the facts of its members, alike in every
//! robot.

use super::announcement::Announcement;
use super::definition::{Fact, Holds, Role};
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

/// A robot's part of a joint policy: the last robot's operators run fastest.
pub(super) fn operator_of(tables: &Tables<'_>, policy: u16, robot: usize) -> u8 {
    let later = tables.roles().iter().skip(robot + 1).map(|role| role.operators.len());
    let own = tables.role(robot).map_or(1, |role| role.operators.len().max(1));
    let rest = usize::from(policy) / later.product::<usize>().max(1);
    (rest % own) as u8
}

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

/// What a round is decided from: the tables, and the announcements of its members.
#[derive(Clone, Copy)]
pub(super) struct Known<'a, const N: usize> {
    pub(super) tables: &'a Tables<'a>,
    /// `None` for a robot that is no member.
    pub(super) said: &'a [Option<Announcement>; N],
}

impl<const N: usize> Known<'_, N> {
    /// The joint policies that all preconditions allow: at most [`MAX_POLICIES`], those in which
    /// the most robots do what they intend; the last one leaves all as they are.
    pub(super) fn list(&self) -> List {
        let policies = || (0..self.tables.policies()).map(|policy| policy as u16);
        let stays = |policy: u16| self.each(policy).all(|(robot, _, part)| part == self.under_way(robot));
        let mut list = List::new();
        for missed in 0..=self.tables.robots() {
            for policy in policies().filter(|&policy| self.missed(policy) == missed && !stays(policy)) {
                if list.len() + 1 < MAX_POLICIES && self.is_feasible(policy) {
                    // There is room for one more.
                    let _ = list.push(policy);
                }
            }
        }
        if let Some(stay) = policies().find(|&policy| stays(policy)) {
            let _ = list.push(stay);
        }
        list
    }

    /// The robots with their roles and their parts.
    fn each(&self, policy: u16) -> impl Iterator<Item = (usize, &Role<'_>, u8)> {
        let roles = self.tables.roles().iter().enumerate();
        roles.map(move |(robot, role)| (robot, role, operator_of(self.tables, policy, robot)))
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

    fn holds(&self, robot: usize, fact: &Fact<'_>, policy: u16) -> Option<bool> {
        if let Holds::Sure { factor, states } = fact.holds {
            let state = self.of(robot).and_then(|said| said.state(usize::from(factor)));
            return Some(state.is_some_and(|state| states.contains(&state)));
        }
        holds_of_teammate(fact, self.said, |robot| operator_of(self.tables, policy, robot))
    }
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
        let habit = |of: &super::definition::Operator<'_>| of.habit;
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
            roles.map(|(robot, role)| Self::unlikely(role, operator_of(self.tables, policy, robot))).sum();
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

/// What a robot's parts cost it, as prices in eighths of a nat against the cheapest in the list:
/// `value` is -G of a policy, or `None` if the robot cannot do its part.
pub(super) fn prices(list: &[u16], value: impl Fn(u16) -> Option<f32>) -> Vec<Score, MAX_POLICIES> {
    let best = list.iter().filter_map(|&policy| value(policy)).fold(f32::NEG_INFINITY, f32::max);
    let price = |policy: &u16| match value(*policy) {
        Some(value) => Score { delay: 0, price: Score::finite(worth_of_nats(best - value, 1.0)) },
        None => Score::CANNOT,
    };
    crate::bounded::up_to(list.iter().map(price))
}

#[cfg(test)]
mod tests {
    use super::super::{Aim, HiddenFactor, Operator, Reads, Sensor};
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
        Known { tables: &TWO, said: &said }.list()
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
        let list = Known { tables: &HANDY, said: &[intends(4), intends(3)] }.list();
        assert_eq!((list.len(), list.first(), list.last()), (MAX_POLICIES, Some(&(4 * 5 + 3)), Some(&0)));
        let one_of_them = |&policy: &u16| policy / 5 == 4 || policy % 5 == 3;
        assert_eq!(
            list.iter().filter(|policy| one_of_them(policy)).count(),
            9,
            "both, and each with the other's four"
        );
    }

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
        let value =
            |policy: u16| [Some(1.0), Some(1.5), None, Some(-99.0)].get(usize::from(policy)).copied()?;
        let prices = prices(&[0, 1, 2, 3], value).iter().map(|score| score.price).collect::<Vec<_, 4>>();
        assert_eq!(prices, [4, 0, Score::IMPOSSIBLE, Score::IMPOSSIBLE - 1]);
    }
}
