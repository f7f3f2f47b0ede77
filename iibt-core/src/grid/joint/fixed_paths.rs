//! One or two robots with targets of their own: their paths are fixed, and the others flow around
//! them.
//!
//! The first owner takes its shortest path and is there 0 to 16 steps before the end of the plan,
//! the second one takes the shortest around that path; then the other way round. All that are left,
//! with their goals or without, are a flow in which the cells of a fixed path are closed one step
//! before it is there, while it is there, and one step after. A plan that is longer begins with
//! waits of all, unless some of the robots begin with a prefix.

use super::super::{Cell, CellSet};
use super::attempt::{Attempt, Choice, Kind};
use super::flow::Query;
use super::flow_planner::{FlowPlanner, Outcome, Stage};
use super::network::Turn;
use super::prefix::Entry;
use super::{Failure, Problem, Target};
use crate::actions::HORIZON;

/// How many robots can have targets of their own.
const MOST_OWNERS: usize = 2;

/// How many steps before the end of a plan the first owner can be on its target.
pub(super) const LONGEST_REST: usize = 16;

/// The work units after which no other fixed path is tried.
pub(super) const MOST_UNITS: u32 = 2_000;

/// Which owner's path is fixed first, how long before the end it is there, and how many steps that
/// takes at least.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Precedence {
    pub(super) second_first: bool,
    pub(super) rest: usize,
    pub(super) steps: usize,
}

impl<const W: usize, const L: usize, const N: usize> FlowPlanner<W, L, N> {
    /// Begins with the path of the first owner.
    pub(super) fn with_owners(&mut self, problem: &Problem<'_, W>) -> Stage {
        if problem.owned().count() > MOST_OWNERS {
            return self.beyond_flow(problem);
        }
        self.precedence = Precedence::default();
        self.fix_owner(problem, 0)
    }

    /// Looks for the path of an owner around those that are fixed before.
    fn fix_owner(&mut self, problem: &Problem<'_, W>, row: usize) -> Stage {
        let Some((from, target)) = self.owner(problem, row) else { return self.flow_around(problem, false) };
        self.attempt = Attempt { kind: Kind::Owner(row), turn: Turn::Both, is_second: row > 0 };
        self.flow.unfix(row);
        self.flow.network.set_rules(Turn::Both, CellSet::EMPTY);
        let goals = [target].into_iter().collect();
        let first = if row == 0 { 0 } else { self.precedence.steps };
        let latest = if row == 0 { self.below_found() } else { self.latest_around(problem) };
        self.flow.begin(problem, [from], Query { goals, need: 1, first, latest });
        Stage::Flow
    }

    /// Fixes the path that was found, and goes on with the next owner or with the others.
    pub(super) fn owner_searched(&mut self, problem: &Problem<'_, W>, row: usize, found: bool) -> Stage {
        let is_alone = row == 0 && problem.prefixes.is_empty();
        if !found && is_alone && self.found.is_none() && self.flow.is_exhausted() {
            return Stage::Done(Outcome::None(Failure::NoWay));
        }
        if !found {
            return if row == 0 { self.end_of_rests(problem) } else { self.next_rest(problem) };
        }
        let rest = if row == 0 { self.precedence.rest } else { 0 };
        self.precedence.steps = self.flow.steps + rest;
        if self.precedence.steps > self.below_found() {
            return self.end_of_rests(problem);
        }
        self.flow.fix(rest);
        self.fix_owner(problem, row + 1)
    }

    /// Looks for a flow of the others around the fixed paths.
    fn flow_around(&mut self, problem: &Problem<'_, W>, is_second: bool) -> Stage {
        let black_last = self.choice.turn.unwrap_or_default();
        let turn = if is_second { black_last.other() } else { black_last };
        self.attempt = Attempt { kind: Kind::Around, turn, is_second };
        self.flow.network.set_rules(turn, CellSet::EMPTY);
        let first = self.precedence.steps.max(self.fewest_steps);
        let latest = self.latest_around(problem);
        let query = Query { goals: self.goals, need: self.need, first, latest };
        self.flow.begin(problem, problem.free_entries(), query);
        Stage::Flow
    }

    /// The most steps of a plan around the fixed paths, whose robots cannot wait before a prefix.
    fn latest_around(&self, problem: &Problem<'_, W>) -> usize {
        let latest = self.below_found();
        if problem.prefixes.is_empty() { latest } else { latest.min(self.precedence.steps) }
    }

    /// After a search for a flow around the fixed paths.
    pub(super) fn searched_around(&mut self, problem: &Problem<'_, W>) -> Stage {
        if self.attempt.is_second || self.choice.turn.is_some() {
            return self.next_rest(problem);
        }
        self.flow_around(problem, true)
    }

    fn next_rest(&mut self, problem: &Problem<'_, W>) -> Stage {
        if self.precedence.rest >= LONGEST_REST || self.spent > MOST_UNITS {
            return self.end_of_rests(problem);
        }
        self.precedence.rest += 1;
        self.fix_owner(problem, 0)
    }

    /// Goes on with the path of the other owner first.
    fn end_of_rests(&mut self, problem: &Problem<'_, W>) -> Stage {
        let is_last = self.precedence.second_first || problem.owned().nth(1).is_none();
        if is_last || self.spent > MOST_UNITS {
            return self.end_of_owners(problem);
        }
        self.precedence = Precedence { second_first: true, ..Precedence::default() };
        self.fix_owner(problem, 0)
    }

    fn end_of_owners(&mut self, problem: &Problem<'_, W>) -> Stage {
        if self.found.is_some() {
            return Stage::Choose;
        }
        if self.choice != Choice::BEST {
            return Stage::Done(Outcome::None(Failure::NotFound));
        }
        if self.need == 0 || self.spent > MOST_UNITS {
            return self.beyond_flow(problem);
        }
        self.lower_need();
        self.with_owners(problem)
    }

    /// What follows when no fixed path of the owners leaves the others a way: the searches for all
    /// robots at once. They are for the best plan only, not for others beside it, and know no
    /// prefixes.
    fn beyond_flow(&self, problem: &Problem<'_, W>) -> Stage {
        if self.choice == Choice::BEST && problem.prefixes.is_empty() {
            Stage::Done(Outcome::Beyond)
        } else {
            Stage::Done(Outcome::None(Failure::NotFound))
        }
    }

    /// The most steps with which a plan is better than the one that was found.
    fn below_found(&self) -> usize {
        let found = self.found.map_or(HORIZON, |found| found.steps.saturating_sub(1));
        found.min(self.choice.latest.unwrap_or(HORIZON))
    }

    /// Where the owner comes into the flow whose path has this number stands and what it owns.
    fn owner(&self, problem: &Problem<'_, W>, row: usize) -> Option<(Entry, Cell)> {
        let all = problem.errands.iter().enumerate();
        let mut owners = all.filter_map(|(robot, errand)| match errand.target {
            Target::Own(cell) => Some((problem.entry(robot, errand), cell)),
            Target::Any | Target::Stand => None,
        });
        owners.nth(self.row_of_owner(problem, row)).filter(|_| row < MOST_OWNERS)
    }

    /// The number of an owner's fixed path, and of a path's owner.
    pub(super) fn row_of_owner(&self, problem: &Problem<'_, W>, owner: usize) -> usize {
        if self.precedence.second_first { problem.owned().count().abs_diff(owner + 1) } else { owner }
    }
}
