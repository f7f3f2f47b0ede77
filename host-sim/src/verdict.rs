//! The verdict on a flight: whether its mission was accomplished, and whether its robots came
//! together.
//!
//! It is the same for every kind of robot and judges from the truth: where robots stand, what was
//! asked of them, and what the referee counted.

use crate::referee::Collisions;
use crate::scenario::{Floor, Scenario};
use iibt_core::grid::Cell;
use serde::Serialize;

/// How a flight ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// The mission is accomplished, and the robots that moved came to their last cells at most
    /// [`TOGETHER`] apart; one tick more for each further robot where goals lie behind each other.
    Together,
    /// The mission is accomplished, but the robots came one after the other.
    Apart,
    /// The mission was accomplished before anything moved.
    NothingToDo,
    /// The limit was reached first, without a collision.
    Unfinished,
    /// Robots shared or swapped cells, or ran into something.
    Collided,
}

/// The most ticks between the first and the last arrival that count as together.
pub const TOGETHER: u32 = 1;

impl Outcome {
    /// Returns whether the mission is accomplished.
    #[must_use]
    pub const fn is_success(self) -> bool {
        matches!(self, Self::Together | Self::Apart | Self::NothingToDo)
    }
}

/// What a flight is judged by.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Evidence<'f> {
    pub scenario: &'f Scenario,
    pub collisions: Collisions,
    /// Free and blocked cells at the end.
    pub floor: &'f Floor,
    /// The cells of all robots at first and after every tick.
    pub history: &'f [Vec<Cell>],
    /// Whether each robot is between two cells.
    pub moving: &'f [bool],
    /// Whether each robot takes part at the end: goals that others hold do not count.
    pub members: &'f [bool],
    /// The goals that do not serve, and those that strangers take.
    pub useless: &'f [Cell],
    /// Whether a robot that takes part has a way-point left.
    pub has_errand: bool,
}

impl Evidence<'_> {
    /// Returns the verdict.
    pub(crate) fn outcome(&self) -> Outcome {
        // First, because a mission with a collision is not accomplished wherever the robots end.
        if self.collisions.total() > 0 {
            return Outcome::Collided;
        }
        if !self.is_accomplished() {
            return Outcome::Unfinished;
        }
        match self.spread() {
            None => Outcome::NothingToDo,
            Some(spread) if spread <= self.most_apart() => Outcome::Together,
            Some(_) => Outcome::Apart,
        }
    }

    /// Whether every errand is done and as many goals as needed are held by robots that take part,
    /// each by one that stands.
    pub(crate) fn is_accomplished(&self) -> bool {
        let taking_part = self.members.iter().filter(|&&member| member).count();
        let need = self.scenario.need.min(taking_part);
        let stands = self.members.iter().zip(self.moving).all(|(&member, &moving)| !member || !moving);
        need > 0 && stands && !self.has_errand && self.held().count() >= need
    }

    /// The goals that robots hold: each stands on its own, or on any that no robot that takes part
    /// owns.
    fn held(&self) -> impl Iterator<Item = Cell> + '_ {
        let robots = &self.scenario.robots;
        let is_owned = |goal| {
            robots.iter().zip(self.members).any(|(robot, &is_member)| is_member && robot.goal == Some(goal))
        };
        let holds = move |robot: usize, cell| match robots[robot].goal {
            Some(own) => own == cell,
            None => self.scenario.goals.contains(&cell) && !is_owned(cell),
        };
        let cells = self.history.last().into_iter().flatten().copied().enumerate();
        let serves = |cell: Cell| !self.useless.contains(&cell);
        let held =
            cells.filter(move |&(robot, cell)| self.members[robot] && holds(robot, cell) && serves(cell));
        held.map(|(_, cell)| cell)
    }

    /// The ticks between the first and the last arrival of the robots that moved and take part;
    /// `None` when none did.
    fn spread(&self) -> Option<u32> {
        let robots = (0..self.members.len()).filter(|&robot| self.members[robot]);
        let arrivals = robots.filter_map(|robot| arrival(self.history, robot));
        Some(arrivals.clone().max()? - arrivals.min()?)
    }

    /// The most ticks between arrivals that count as together.
    fn most_apart(&self) -> u32 {
        let robots = self.members.iter().filter(|&&member| member).count() as u32;
        if self.has_goals_in_series() { robots.saturating_sub(1).max(TOGETHER) } else { TOGETHER }
    }

    /// Whether a held goal cannot be reached without passing another one, as in a dead end.
    fn has_goals_in_series(&self) -> bool {
        let starts: Vec<Cell> = self.history.first().into_iter().flatten().copied().collect();
        self.held().any(|goal| {
            let others: Vec<Cell> = self.held().filter(|&other| other != goal).collect();
            !reaches(self.floor, &starts, goal, &others)
        })
    }
}

/// Returns the tick after which a robot stood where it stands at the end; `None` if it never moved.
pub(crate) fn arrival(history: &[Vec<Cell>], robot: usize) -> Option<u32> {
    let end = history.last()?[robot];
    history.iter().rposition(|cells| cells[robot] != end).map(|last| last as u32 + 1)
}

/// Whether a way leads from one of the starts to a cell past the closed ones.
fn reaches(floor: &Floor, starts: &[Cell], to: Cell, closed: &[Cell]) -> bool {
    let near = floor.avoiding(closed.iter().copied()).connected(to);
    starts.iter().any(|start| near.contains(*start) && !closed.contains(start))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Judges robots of a scenario by their cells over time.
    struct Case {
        scenario: Scenario,
        members: Vec<bool>,
        has_errand: bool,
    }

    fn case(map: &str, more: &str) -> Case {
        let text = format!("title = 't'\nmap = '''\n{}\n'''\n{more}", map.replace(' ', "\n"));
        let scenario = Scenario::parse("drawn", &text).unwrap();
        let members = vec![true; scenario.robots.len()];
        Case { scenario, members, has_errand: false }
    }

    impl Case {
        fn outcome(&self, history: &[&[u16]]) -> Outcome {
            let history: Vec<Vec<Cell>> =
                history.iter().map(|cells| cells.iter().copied().map(Cell).collect()).collect();
            let moving = vec![false; self.members.len()];
            let evidence = Evidence {
                scenario: &self.scenario,
                collisions: Collisions::default(),
                floor: &self.scenario.map,
                history: &history,
                moving: &moving,
                members: &self.members,
                useless: &[],
                has_errand: self.has_errand,
            };
            evidence.outcome()
        }
    }

    #[test]
    fn together_is_at_most_a_tick_apart_among_those_that_moved() {
        let floor = case("1...G 2...G .....", "");
        let two: [&[u16]; 5] = [&[0, 5], &[1, 6], &[2, 7], &[3, 8], &[4, 9]];
        assert_eq!(floor.outcome(&two), Outcome::Together);
        assert_eq!(floor.outcome(&[&[3, 7], &[4, 8], &[4, 9]]), Outcome::Together);
        assert_eq!(floor.outcome(&[&[3, 6], &[4, 7], &[4, 8], &[4, 9]]), Outcome::Apart);
        assert_eq!(floor.outcome(&[&[4, 6], &[4, 7], &[4, 8], &[4, 9]]), Outcome::Together);
        assert_eq!(floor.outcome(&[&[4, 9], &[4, 9]]), Outcome::NothingToDo);
        assert_eq!(floor.outcome(&[&[4, 8], &[4, 8]]), Outcome::Unfinished);
    }

    #[test]
    fn goals_behind_each_other_may_take_a_tick_more_for_each_robot() {
        let dead_end = case("123GGG", "");
        let series: [&[u16]; 6] = [&[0, 1, 2], &[0, 1, 3], &[1, 2, 4], &[2, 3, 5], &[2, 4, 5], &[3, 4, 5]];
        assert_eq!(dead_end.outcome(&series), Outcome::Together);
        let mut late = series.to_vec();
        late.insert(5, &[2, 4, 5]);
        assert_eq!(dead_end.outcome(&late), Outcome::Apart);
    }

    #[test]
    fn as_many_goals_as_needed_are_held_by_those_that_take_part() {
        let mut one_of_two = case("1..G 2..G ....", "need = 1");
        assert_eq!(one_of_two.outcome(&[&[2, 4], &[3, 4]]), Outcome::Together);
        one_of_two.members[0] = false;
        assert_eq!(one_of_two.outcome(&[&[2, 4], &[3, 4]]), Outcome::Unfinished);
        let mut both = case("1..G 2..G ....", "");
        both.members[0] = false;
        assert_eq!(both.outcome(&[&[0, 6], &[0, 7]]), Outcome::Together, "the other is lost");
        both.has_errand = true;
        assert_eq!(both.outcome(&[&[0, 6], &[0, 7]]), Outcome::Unfinished);
    }

    #[test]
    fn an_owned_goal_is_held_by_its_owner_only() {
        let owned = case("1.. 2.. ...", "goals = [2]\n[[robot]]\n[[robot]]\ngoal = 5");
        assert_eq!(owned.outcome(&[&[1, 4], &[2, 5]]), Outcome::Together);
        assert_eq!(owned.outcome(&[&[4, 1], &[5, 2]]), Outcome::Unfinished);
    }

    #[test]
    fn the_goal_of_a_robot_that_takes_no_part_is_anybodys() {
        let mut owned = case("1.. 2.. ...", "goals = [2]\n[[robot]]\n[[robot]]\ngoal = 5");
        owned.members[1] = false;
        assert_eq!(owned.outcome(&[&[4, 3], &[5, 3]]), Outcome::Together);
    }

    #[test]
    fn a_collision_spoils_everything() {
        let floor = case("1G ..", "");
        let history = [vec![Cell(0)], vec![Cell(1)]];
        let collisions = Collisions { swapped: 1, ..Collisions::default() };
        let evidence = Evidence {
            scenario: &floor.scenario,
            collisions,
            floor: &floor.scenario.map,
            history: &history,
            moving: &[false],
            members: &[true],
            useless: &[],
            has_errand: false,
        };
        assert_eq!(evidence.outcome(), Outcome::Collided);
    }
}
